//! Pressure at a point, that of a linear fit ([`super::fit`]), at least 0.

use super::fit::fit_at;
use super::{Reading, View};

/// A point where pressure is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureProbe<const D: usize> {
    /// The point [m].
    pub at: [f64; D],
}

impl<const D: usize> PressureProbe<D> {
    /// One value: pressure [Pa].
    #[must_use]
    pub fn sample(&self, view: &View<D>) -> Reading {
        match fit_at(view, &self.at, |j, _| [view.pressure[j]]) {
            Ok([pressure]) => Reading::valid(vec![pressure.max(0.0)]),
            Err(why) => Reading::none(1, why),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Validity;
    use super::super::view::bed::Bed;
    use super::*;

    #[test]
    fn hydrostatic_pressure_inside_the_bed_is_linear_in_depth() {
        let bed = Bed::<2>::new(1.6, 16, 0.0);
        // 0.004 is between the floor and the first row's centre.
        for y in [0.004, 0.01, 0.05, 0.07, 0.083, 0.1, 0.15] {
            let reading = bed.look(|view| PressureProbe { at: [0.21, y] }.sample(view));
            let expected = bed.pressure_at(y);
            assert!(
                (reading.values[0] - expected).abs() < 1e-9 * bed.pressure_at(0.0),
                "{reading:?} for {expected}"
            );
        }
    }

    /// In the corner of floor and wall particles lie on one side as well, and there is no surface.
    #[test]
    fn hydrostatic_pressure_is_linear_down_into_a_corner() {
        let bed = Bed::<2>::with_side_wall(1.6, 16);
        for at in [
            [0.001, 0.001],
            [0.002, 0.004],
            [0.004, 0.001],
            [0.001, 0.05],
        ] {
            let reading = bed.look(|view| PressureProbe { at }.sample(view));
            let expected = bed.pressure_at(at[1]);
            assert!(
                (reading.values[0] - expected).abs() < 1e-9 * bed.pressure_at(0.0),
                "{at:?}: {reading:?} for {expected}"
            );
        }
    }

    #[test]
    fn air_wall_and_elsewhere_say_so() {
        let bed = Bed::<2>::new(1.6, 4, 0.0);
        let sample = |at: [f64; 2]| bed.look(|view| PressureProbe { at }.sample(view)).validity;
        assert_eq!(sample([0.2, 0.02]), Validity::Valid);
        assert_eq!(sample([0.2, 0.2]), Validity::Empty);
        assert_eq!(sample([0.2, -0.02]), Validity::Blocked);
        assert_eq!(sample([0.2, 9.0]), Validity::Outside);
        // Beyond the rows of points that stand for the wall.
        assert_eq!(sample([0.2, -0.0499]), Validity::Blocked);
    }
}
