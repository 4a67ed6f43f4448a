//! Velocity at a point, that of a linear fit ([`super::fit`]): what a current meter reads.

use super::fit::fit_at;
use super::{Reading, View};

/// A point where velocity is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct VelocityProbe<const D: usize> {
    /// The point [m].
    pub at: [f64; D],
}

impl<const D: usize> VelocityProbe<D> {
    /// D values: velocity along each axis [m/s].
    #[must_use]
    pub fn sample(&self, view: &View<D>) -> Reading {
        let velocity = |j: usize, is_image: bool| {
            let mut v = view.velocity[j];
            if is_image {
                v[0] = -v[0];
            }
            v
        };
        match fit_at(view, &self.at, velocity) {
            Ok(velocity) => Reading::valid(velocity.to_vec()),
            Err(why) => Reading::none(D, why),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Validity;
    use super::super::view::bed::Bed;
    use super::*;
    use crate::math::Geometry;
    use crate::state::CellGrid;

    /// The bed's particles move at (3 + 2 y, x, 0), whatever the row a point is near.
    #[test]
    fn a_linear_flow_is_read_as_it_is_from_the_floor_to_the_surface() {
        for jitter in [0.0, 0.1] {
            let bed = Bed::<2>::new(1.6, 12, jitter);
            for y in [0.004, 0.01, 0.05, 0.07, 0.083, 0.119] {
                let at = [0.21, y];
                let reading = bed.look(|view| VelocityProbe { at }.sample(view));
                let off = [reading.values[0] - 3.0 - 2.0 * y, reading.values[1] - 0.21];
                assert!(off.iter().all(|d| d.abs() < 1e-9), "{y}: {reading:?}");
            }
        }
        let bed = Bed::<3>::new(1.6, 6, 0.0);
        let at = [0.07, 0.03, 0.06];
        let reading = bed.look(|view| VelocityProbe { at }.sample(view));
        let off = [
            reading.values[0] - 3.06,
            reading.values[1] - 0.07,
            reading.values[2],
        ];
        assert!(off.iter().all(|d| d.abs() < 1e-9), "{reading:?}");
    }

    /// v = (2 r, z) in rings: images across the axis move the other way along the radius.
    #[test]
    fn rings_move_apart_on_both_sides_of_their_axis() {
        let bed = Bed::<2>::with_side_wall(1.6, 12);
        for at in [[0.003, 0.05], [0.011, 0.07]] {
            let reading = bed.look(|view| {
                let velocity: Vec<_> = view.position.iter().map(|x| [2.0 * x[0], x[1]]).collect();
                VelocityProbe { at }.sample(&View {
                    velocity: &velocity,
                    geometry: Geometry::Axisymmetric,
                    solid: &CellGrid::build(&[], view.kernel.support(), &[None; 2]),
                    solids: &[],
                    ..*view
                })
            });
            let off = [reading.values[0] - 2.0 * at[0], reading.values[1] - at[1]];
            assert!(off.iter().all(|d| d.abs() < 1e-9), "{at:?}: {reading:?}");
        }
    }

    /// Where material has just arrived the line through what differs from particle to particle would say anything.
    #[test]
    fn beyond_a_free_surface_the_mean_is_read() {
        let bed = Bed::<2>::new(1.6, 4, 0.1).keep(|x| (0.1..0.2).contains(&x[0]));
        let mut read = 0;
        for ahead in [0.003, 0.006, 0.009, 0.012] {
            let at = [0.2 + ahead, 0.015];
            let reading = bed.look(|view| {
                // Slower at the front than behind it: the line ends below them all.
                let speed = |x: &[f64; 2]| [if x[0] > 0.19 { 1.0 } else { 2.0 }, 0.0];
                let velocity: Vec<_> = view.position.iter().map(speed).collect();
                VelocityProbe { at }.sample(&View {
                    velocity: &velocity,
                    ..*view
                })
            });
            if reading.validity == Validity::Valid {
                read += 1;
                assert!(
                    (1.0..=2.0).contains(&reading.values[0]),
                    "{ahead}: {reading:?}"
                );
            }
        }
        assert!(read >= 2, "{read} places were read");
    }

    #[test]
    fn air_and_walls_have_none() {
        let bed = Bed::<2>::new(1.6, 4, 0.0);
        let sample = |at: [f64; 2]| bed.look(|view| VelocityProbe { at }.sample(view));
        assert_eq!(sample([0.2, 0.2]), Reading::none(2, Validity::Empty));
        assert_eq!(sample([0.2, -0.02]), Reading::none(2, Validity::Blocked));
        assert_eq!(sample([0.2, 9.0]), Reading::none(2, Validity::Outside));
    }
}
