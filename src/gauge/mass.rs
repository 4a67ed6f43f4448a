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
    /// One value: mass of the particles whose centres are in the box, lower sides included [kg]; exact. An empty box holds 0.
    #[must_use]
    pub fn sample(&self, view: &View<D>) -> Reading {
        let inside = |x: &[f64; D]| (0..D).all(|a| x[a] >= self.lower[a] && x[a] < self.upper[a]);
        let rows = view.position.iter().zip(view.mass);
        let mass = rows
            .filter(|(x, _)| inside(x))
            .fold(0.0, |sum, (_, m)| sum + m);
        Reading::valid(vec![mass])
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::bed::Bed;
    use super::*;

    #[test]
    fn boxes_side_by_side_hold_all_the_mass() {
        let bed = Bed::<2>::new(1.6, 8, 0.1);
        let (half, whole) = (0.437 * bed.length(), 2.0 * bed.length());
        let mass = |from: f64, to: f64| {
            let counted = MassBox {
                lower: [from, -1.0],
                upper: [to, 1.0],
            };
            bed.look(|view| counted.sample(view)).values[0]
        };
        let all = mass(-1.0, whole);
        assert!(mass(-1.0, half) > 0.3 * all && mass(half, whole) > 0.3 * all);
        let sum = mass(-1.0, half) + mass(half, whole);
        assert!((sum - all).abs() < 1e-12 * all);
        assert_eq!(mass(whole, whole + 1.0), 0.0);
    }
}
