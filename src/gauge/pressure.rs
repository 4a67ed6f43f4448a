//! Pressure at a point: the Shepard mean of particles, sum V p W / sum V W.

use super::{Reading, Validity, View};

/// Shepard sum below which no mean is given: less than a quarter of a lone grain's weight at its own centre.
const DRY: f64 = 0.05;

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
        if view.is_outside(&self.at) {
            return Reading::none(1, Validity::Outside);
        }
        if view.is_covered(&self.at) {
            return Reading::none(1, Validity::Blocked);
        }
        let (mut weights, mut sum) = (0.0, 0.0);
        view.for_each_particle(&self.at, |j, r| {
            let weight = view.volume(j) * view.kernel.w(r);
            weights += weight;
            sum += weight * view.pressure[j];
        });
        if weights < DRY {
            return Reading::none(1, Validity::Empty);
        }
        Reading::valid(vec![sum / weights])
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::bed::Bed;
    use super::*;

    #[test]
    fn hydrostatic_pressure_inside_the_bed_is_linear_in_depth() {
        let bed = Bed::<2>::new(1.6, 16, 0.0);
        for y in [0.05, 0.07, 0.083, 0.1] {
            let reading = bed.look(|view| PressureProbe { at: [0.21, y] }.sample(view));
            let expected = bed.pressure_at(y);
            // A symmetric mean of a linear field is exact but for the lattice's phase.
            assert!(
                (reading.values[0] - expected).abs() < 0.01 * bed.pressure_at(0.0),
                "{reading:?} for {expected}"
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
    }
}
