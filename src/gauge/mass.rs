//! Mass in a box: what of a bed is still there, what a basin holds.

use super::{Reading, View};

/// A box in which mass is counted.
#[derive(Clone, Debug, PartialEq)]
pub struct MassBox<const D: usize> {
    /// Lower corner [m].
    pub lower: [f64; D],
    /// Upper corner [m].
    pub upper: [f64; D],
}

impl<const D: usize> MassBox<D> {
    /// One value: mass of the particles whose centres, or their images across periodic sides, are in the box, lower sides included
    /// [kg]; exact. An empty box holds 0.
    #[must_use]
    pub fn sample(&self, view: &View<D>) -> Reading {
        let inside = |x: &[f64; D]| (0..D).all(|a| self.spans(view, a, x[a]));
        let rows = view.position.iter().zip(view.mass);
        let mass = rows
            .filter(|(x, _)| inside(x))
            .fold(0.0, |sum, (_, m)| sum + m);
        Reading::valid(vec![mass])
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
}
