//! The domain: extent, periodic sides, width and gravity.

use super::Lift;
use crate::math::length;
use crate::scene::raw::{Axis, Gravity, RawDomain};
use crate::scene::types::{Dimension, Domain, Point};
use crate::solver::SHORTEST_PERIOD;

impl Lift<'_> {
    pub(super) fn domain(&mut self) -> Option<Domain> {
        let raw = &self.raw.domain.as_ref()?.value;
        let corners = self.corners(raw.lower.as_ref(), raw.upper.as_ref());
        let gravity = self.gravity(raw);
        let width = self.width(raw);
        if self.axisymmetric() {
            self.check_axis(raw);
        }
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

    /// Nothing lies at r < 0, gravity acts along the axis, and a radius does not repeat itself.
    fn check_axis(&mut self, raw: &RawDomain) {
        if let Some(lower) = &raw.lower
            && let Some(&radius) = lower.value.values.first()
            && radius < 0.0
        {
            self.problems.report(
                &lower.place,
                format!("x = {radius} m"),
                "x >= 0: in axisymmetric scenes x is the radius",
                "begin the domain at the axis, x = 0",
            );
        }
        if let Some(slope) = &raw.slope {
            self.problems.report(
                &slope.place,
                "slope in an axisymmetric scene",
                "gravity along the axis of symmetry",
                "delete slope, or set dimension = 2",
            );
        }
        if let Some(gravity) = &raw.gravity
            && let Gravity::Vector(vector) = &gravity.value
            && vector.values.first().is_some_and(|&g| g != 0.0)
        {
            self.problems.report(
                &gravity.place,
                "gravity across the axis of symmetry",
                "a vector [0, y], along the axis",
                "write gravity = \"9.81 m/s^2\"",
            );
        }
        for axis in raw.periodic.iter().flat_map(|list| &list.value.0) {
            if axis.value == Axis::X {
                self.problems.report(
                    &axis.place,
                    "\"x\", the radius, in an axisymmetric scene",
                    "\"y\"",
                    "delete it",
                );
            }
        }
    }

    /// Width belongs to planar scenes.
    fn width(&mut self, raw: &RawDomain) -> Option<f64> {
        let width = raw.width.as_ref()?;
        if self.dimension == Dimension::Two {
            return Some(width.value.0);
        }
        if raw.given.contains(&"width") {
            self.problems.report(
                &width.place,
                format!("width in a scene with {}", self.dimension_key()),
                "width only in planar scenes, where dimension = 2",
                "delete it; axisymmetric scenes hold whole rings",
            );
        }
        Some(1.0)
    }

    /// Size and slope, or a vector.
    fn gravity(&mut self, raw: &RawDomain) -> Option<Point> {
        let gravity = raw.gravity.as_ref()?;
        match &gravity.value {
            Gravity::Size(size) if *size < 0.0 => {
                self.problems.report(
                    &gravity.place,
                    format!("a size of {size} m/s^2"),
                    "0 or more: a size acts downwards",
                    format!("write {}, or a vector for another direction", -size),
                );
                None
            }
            Gravity::Size(size) => {
                let slope = raw.slope.as_ref().map_or(0.0, |s| s.value.0);
                let (sin, cos) = slope.sin_cos();
                Some(match self.dimension {
                    Dimension::Two | Dimension::Axisymmetric => [size * sin, -size * cos, 0.0],
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
                    format!("\"z\" in {}", self.kind()),
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
        let least = SHORTEST_PERIOD * ratio.value.0 * spacing;
        if period < least {
            self.problems.report(
                &at.place,
                format!("a period of {period} m along {name}"),
                format!("at least {least} m, {SHORTEST_PERIOD} smoothing lengths"),
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
        self.domain.as_ref().map_or(0.0, |d| length(&d.gravity))
    }
}
