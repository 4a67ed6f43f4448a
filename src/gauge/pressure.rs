//! Pressure at a point: the value there of the straight line (plane) that fits the pressures of the particles around best,
//! weighted with V W. A mean alone would read what is a little above a point near the floor, where half the particles are
//! missing.
//!
//! Symbols: w = V W(|x - x_j|), d = x_j - x, bars means with w, C = mean (d - d_bar)(d - d_bar), b = C^-1 mean (d - d_bar) p;
//! p = p_bar - b . d_bar >= 0. Where too few particles tell b it is left out.

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
        // Walls are hollow deep inside, and corners between walls that meet are behind neither.
        if view.is_inside(&self.at) || view.is_covered(&self.at) {
            return Reading::none(1, Validity::Blocked);
        }
        match fit_at(view, &self.at) {
            Some(pressure) => Reading::valid(vec![pressure]),
            None => Reading::none(1, Validity::Empty),
        }
    }
}

/// Value at a place of the linear fit to what `view` shows as pressure; `None` where there is too little material.
fn fit_at<const D: usize>(view: &View<D>, at: &[f64; D]) -> Option<f64> {
    let mut weights = 0.0;
    let mut near: Vec<(f64, [f64; D], f64)> = Vec::new();
    view.for_each_particle(at, |j, x, r| {
        let weight = view.volume(j) * view.kernel.w(r);
        weights += weight;
        near.push((weight, crate::math::sub(&x, at), view.pressure[j]));
    });
    (weights >= DRY).then(|| fitted(&near, weights, view.spacing).max(0.0))
}

/// Value at d = 0 of the linear fit to rows of weight, place d [m] and pressure [Pa].
fn fitted<const D: usize>(near: &[(f64, [f64; D], f64)], weights: f64, spacing: f64) -> f64 {
    let (mut place, mut pressure) = ([0.0; D], 0.0);
    for (w, d, p) in near {
        for a in 0..D {
            place[a] += w / weights * d[a];
        }
        pressure += w / weights * p;
    }
    let (mut spread, mut together) = ([[0.0; D]; D], [0.0; D]);
    for (w, d, p) in near {
        let d = crate::math::sub(d, &place);
        crate::math::add_outer(&mut spread, w / weights, &d, &d);
        for a in 0..D {
            together[a] += w / weights * d[a] * (p - pressure);
        }
    }
    // Of a filled support the determinant is about (0.6 dp)^2D; a row along one line has none.
    if crate::math::determinant(&spread) < (0.04 * spacing * spacing).powi(D as i32) {
        return pressure;
    }
    let slope = crate::math::apply(&crate::math::inverse(&spread), &together);
    pressure - crate::math::dot(&slope, &place)
}

#[cfg(test)]
mod tests {
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
