//! The domain: extent, periodic sides, width and gravity.

use super::{Lift, length};
use crate::scene::raw::{Axis, Gravity, RawDomain};
use crate::scene::types::{Dimension, Domain, Point};

impl Lift<'_> {
    pub(super) fn domain(&mut self) -> Option<Domain> {
        let raw = &self.raw.domain.as_ref()?.value;
        let corners = self.corners(raw.lower.as_ref(), raw.upper.as_ref());
        let gravity = self.gravity(raw);
        let width = self.width(raw);
        let (lower, upper) = corners?;
        let periodic = self.periodic(raw, lower, upper);
        Some(Domain {
            lower,
            upper,
            periodic: periodic?,
            width: width?,
            gravity: gravity?,
        })
    }

    /// Width belongs to planar scenes.
    fn width(&mut self, raw: &RawDomain) -> Option<f64> {
        let width = raw.width.as_ref()?;
        if !self.planar() && raw.given.contains(&"width") {
            self.problems.report(
                &width.place,
                "width in a scene with dimension = 3",
                "width only in planar scenes",
                "delete it",
            );
        }
        Some(width.value.0)
    }

    /// Size and slope, or a vector.
    fn gravity(&mut self, raw: &RawDomain) -> Option<Point> {
        let gravity = raw.gravity.as_ref()?;
        match &gravity.value {
            Gravity::Size(size) => {
                let slope = raw.slope.as_ref().map_or(0.0, |s| s.value.0);
                let (sin, cos) = slope.sin_cos();
                Some(match self.dimension {
                    Dimension::Two => [size * sin, -size * cos, 0.0],
                    Dimension::Three => [size * sin, 0.0, -size * cos],
                })
            }
            Gravity::Vector(vector) => {
                if let Some(slope) = &raw.slope {
                    self.problems.report(
                        &slope.place,
                        "slope together with a gravity vector",
                        "one of the two",
                        "write gravity = \"9.81 m/s^2\" with slope, or delete slope",
                    );
                }
                let at = crate::scene::raw::At {
                    value: vector.clone(),
                    place: gravity.place.clone(),
                };
                self.vector(&at)
            }
        }
    }

    /// Periods: whole numbers of spacings (so that the lattice fits) and wide enough that no particle meets another
    /// one's image twice.
    fn periodic(&mut self, raw: &RawDomain, lower: Point, upper: Point) -> Option<[bool; 3]> {
        let mut periodic = [false; 3];
        let Some(list) = &raw.periodic else {
            return Some(periodic);
        };
        for at in &list.value.0 {
            let axis = match at.value {
                Axis::X => 0,
                Axis::Y => 1,
                Axis::Z => 2,
            };
            if axis >= self.axes() {
                self.problems.report(
                    &at.place,
                    "\"z\" in a planar scene",
                    "\"x\", \"y\"",
                    "delete it, or set dimension = 3",
                );
                return None;
            }
            if periodic[axis] {
                let found = format!("{:?} twice", Self::axis_name(axis));
                self.problems
                    .report(&at.place, found, "each axis once", "delete one");
            }
            periodic[axis] = true;
            self.check_period(at, axis, upper[axis] - lower[axis]);
        }
        Some(periodic)
    }

    fn check_period(&mut self, at: &crate::scene::raw::At<Axis>, axis: usize, period: f64) {
        let numerics = self.raw.numerics.as_ref().map(|n| &n.value);
        let ratio = numerics.and_then(|n| n.smoothing_ratio.as_ref());
        let (Some(spacing), Some(ratio)) = (self.spacing, ratio) else {
            return;
        };
        let name = Self::axis_name(axis);
        // Support and list skin on both sides of a particle.
        let least = 4.6 * ratio.value.0 * spacing;
        if period < least {
            self.problems.report(
                &at.place,
                format!("a period of {period} m along {name}"),
                format!("at least {least} m, 4.6 smoothing lengths"),
                "lengthen the domain along this axis, or refine numerics.spacing",
            );
        }
        let count = period / spacing;
        if (count - count.round()).abs() > 1e-6 * count {
            self.problems.report(
                &at.place,
                format!("a period of {period} m along {name}, {count} spacings"),
                format!("a whole number of spacings of {spacing} m"),
                format!(
                    "set the extent along {name} to {} m",
                    count.round().max(1.0) * spacing
                ),
            );
        }
    }

    /// Size of gravity [m/s^2].
    pub(super) fn gravity_size(&self) -> f64 {
        self.domain.as_ref().map_or(0.0, |d| length(d.gravity))
    }
}
