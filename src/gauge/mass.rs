//! Mass in a box: what of a bed is still there, what a basin holds.

use super::{Reading, View};

/// Spacings that particles of a thin layer may be pressed into a wall.
pub const PRESSED_IN: f64 = 0.25;
/// Spacings between a side and a face that it lies on.
const FLUSH: f64 = 0.02;

/// A box in which mass is counted.
#[derive(Clone, Debug, PartialEq)]
pub struct MassBox<const D: usize> {
    /// Lower corner [m].
    pub lower: [f64; D],
    /// Upper corner [m].
    pub upper: [f64; D],
}

impl<const D: usize> MassBox<D> {
    /// One value: mass of the particles whose centres, or their images across periodic sides, are in the box, lower sides included,
    /// or behind a wall that a side lies on [kg]; exact. An empty box holds 0.
    #[must_use]
    pub fn sample(&self, view: &View<D>) -> Reading {
        let rows = view.position.iter().zip(view.mass);
        let mass = rows
            .filter(|(x, _)| self.holds(view, x))
            .fold(0.0, |sum, (_, m)| sum + m);
        Reading::valid(vec![mass])
    }

    /// Whether a particle is in the box, or beyond one of its sides, which is the face of a wall there, and pressed a little into
    /// that.
    fn holds(&self, view: &View<D>, x: &[f64; D]) -> bool {
        let mut beyond = (0..D).filter(|&a| !self.spans(view, a, x[a]));
        let (axis, others) = (beyond.next(), beyond.next());
        let (Some(a), None) = (axis, others) else {
            return axis.is_none();
        };
        let side = if x[a] < self.lower[a] {
            self.lower[a]
        } else {
            self.upper[a]
        };
        let out = x[a] - side;
        if view.periodic[a] || out.abs() > PRESSED_IN * view.spacing || !view.is_inside(x) {
            return false;
        }
        let off = FLUSH * view.spacing * out.signum();
        let at = |place: f64| std::array::from_fn(|k| if k == a { place } else { x[k] });
        view.is_inside(&at(side + off)) && !view.is_inside(&at(side - off))
    }

    /// Whether the box holds a coordinate, or an image of it. The sides move, not the particle: boxes side by side round alike.
    fn spans(&self, view: &View<D>, axis: usize, x: f64) -> bool {
        let (lower, upper) = (self.lower[axis], self.upper[axis]);
        let within = |shift: f64| x >= lower + shift && x < upper + shift;
        if !view.periodic[axis] {
            return within(0.0);
        }
        // A box meets the domain: of one narrower than a period no further image reaches it, and a wider one holds all, once.
        let period = view.upper[axis] - view.lower[axis];
        [0.0, period, -period].into_iter().any(within)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Solid;
    use super::super::view::bed::Bed;
    use super::*;

    #[test]
    fn boxes_side_by_side_hold_all_the_mass() {
        let bed = Bed::<2>::new(1.6, 8, 0.1);
        let (half, length) = (0.437 * bed.length(), bed.length());
        let mass = |from: f64, to: f64| {
            let counted = MassBox {
                lower: [from, -1.0],
                upper: [to, 1.0],
            };
            bed.look(|view| counted.sample(view)).values[0]
        };
        let all = mass(0.0, length);
        assert!(mass(0.0, half) > 0.3 * all && mass(half, length) > 0.3 * all);
        let sum = mass(0.0, half) + mass(half, length);
        assert!((sum - all).abs() < 1e-12 * all);
        let above = MassBox {
            lower: [0.0, 2.0 * bed.height()],
            upper: [length, 1.0],
        };
        assert_eq!(bed.look(|view| above.sample(view)).values[0], 0.0);
    }

    #[test]
    fn a_box_across_a_periodic_side_holds_what_is_beyond_it() {
        let bed = Bed::<2>::new(1.6, 8, 0.1);
        let length = bed.length();
        let mass = |from: f64, to: f64| {
            let counted = MassBox {
                lower: [from, -1.0],
                upper: [to, 1.0],
            };
            bed.look(|view| counted.sample(view)).values[0]
        };
        let parts = mass(0.75 * length, length) + mass(0.0, 0.25 * length);
        assert!(parts > 0.0);
        for shift in [0.0, -length] {
            let across = mass(0.75 * length + shift, 1.25 * length + shift);
            assert!((across - parts).abs() < 1e-12 * parts, "{across} {parts}");
        }
        let all = mass(0.0, length);
        let turned = mass(0.3 * length, 1.3 * length);
        assert!((turned - all).abs() < 1e-12 * all, "{turned} {all}");
        // A box with room to spare holds each particle once.
        for (from, to) in [(-1.0, 2.0), (-0.2, 1.1), (0.4, 2.7)] {
            let wide = mass(from * length, to * length);
            assert!((wide - all).abs() < 1e-12 * all, "{wide} {all}");
        }
    }

    /// The lowest row of a bed is pressed a tenth of a spacing into its floor.
    #[test]
    fn what_is_pressed_into_a_wall_is_in_the_box_that_lies_on_it() {
        let bed = Bed::<2>::new(1.6, 8, 0.0);
        let length = bed.length();
        let mass = |lower: [f64; 2], upper: [f64; 2], floor: Option<f64>| {
            bed.look(|view| {
                let lowest = view.position.iter().map(|x| x[1]);
                let lowest = lowest.fold(f64::INFINITY, f64::min);
                let face = lowest + 0.1 * view.spacing;
                let solids = floor.map(|below| Solid::Behind {
                    point: [0.0, face - below * view.spacing],
                    normal: [0.0, 1.0],
                });
                let solids: Vec<_> = solids.into_iter().collect();
                let counted = MassBox {
                    lower: [lower[0], lower[1] + face],
                    upper,
                };
                let view = View {
                    solids: &solids,
                    periodic: [false; 2],
                    ..*view
                };
                counted.sample(&view).values[0]
            })
        };
        let all = mass([-1.0, -1.0], [2.0, 1.0], Some(0.0));
        let on_floor = |from: f64, to: f64| mass([from, 0.0], [to, 1.0], Some(0.0));
        assert_eq!(on_floor(-1.0, 2.0), all);
        // Each particle once, also where two boxes meet on the floor.
        let half = 0.437 * length;
        let parts = on_floor(-1.0, half) + on_floor(half, 2.0);
        assert!((parts - all).abs() < 1e-12 * all, "{parts} of {all}");
        // Without a floor, or above it, a box ends where it ends.
        for floor in [None, Some(0.2)] {
            let above = mass([-1.0, 0.0], [2.0, 1.0], floor);
            assert!((above / all - 7.0 / 8.0).abs() < 1e-12, "{above} of {all}");
        }
    }
}
