//! Circles: polygons whose sides are two spacings long.

use super::Lift;
use crate::scene::raw::{At, RawCircle};

/// Least and largest radius of a circle, in spacings.
pub(in crate::scene) const CIRCLES: (f64, f64) = (4.0, 300.0);

impl Lift<'_> {
    /// Corners of a circle, anticlockwise: its inside is on their left. `instead` is what there is where circles are not.
    pub(super) fn circle(&mut self, at: &At<RawCircle>, instead: &str) -> Option<Vec<[f64; 2]>> {
        if !self.planar() || self.axisymmetric() {
            self.problems.report(
                &at.place,
                format!("a circle in {}", self.kind()),
                "circles only where dimension = 2",
                format!("use {instead}, or set dimension = 2"),
            );
            return None;
        }
        let centre = self.vector(at.value.centre.as_ref()?)?;
        let radius = at.value.radius.as_ref()?.value.0;
        let spacing = self.spacing?;
        let place = &at.value.radius.as_ref()?.place;
        let (least, most) = (CIRCLES.0 * spacing, CIRCLES.1 * spacing);
        if radius < least * (1.0 - 1e-9) || radius > most * (1.0 + 1e-9) {
            self.problems.report(
                place,
                format!("{radius} m"),
                format!("4 to 300 spacings, {least} to {most} m"),
                "choose another radius, refine or coarsen numerics.spacing",
            );
            return None;
        }
        for shift in [-radius, radius] {
            let corner = [centre[0] + shift, centre[1] + shift, 0.0];
            if !self.check_inside(place, corner) {
                return None;
            }
        }
        let count = (std::f64::consts::PI * radius / spacing).round();
        let corner = |n: usize| {
            let (sin, cos) = (std::f64::consts::TAU * n as f64 / count).sin_cos();
            [centre[0] + radius * cos, centre[1] + radius * sin]
        };
        Some((0..count as usize).map(corner).collect())
    }
}
