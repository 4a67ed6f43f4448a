//! The ways up along which weight may rest at the start.
//!
//! Gravity mostly points against the last axis, or along a bed that the slope's lower end is on. There the way up leads along the bed for as
//! long as the layer is, though it lies across it: both axes are asked, and the one that gives a place less counts. Where the domain repeats
//! along an axis there may be no top at all: a chute that is full all round falls, and bears nothing.
//!
//! A bin that stands askew in the domain has none of its axes: their ways end at its sides. There the way against gravity counts.

use super::{Point, Scene};
use crate::math::norm;

/// Share of gravity's largest part along axes that do not repeat from which another part counts, too [1]. A vertical tank that stands askew by
/// a few degrees is no slope: its free sides say nothing of what its floor bears. Slopes up to 84 deg are.
pub(super) const SHARE: f64 = 0.1;

/// A straight way up from a place.
pub(super) struct Way {
    /// Unit vector.
    pub(super) direction: Point,
    /// Gravity's part against it [m/s^2].
    pub(super) gravity: f64,
    /// The periodic axis that it goes along: it never leaves the domain.
    pub(super) period: Option<usize>,
    /// The longest it may be [m].
    pub(super) longest: f64,
}

/// The ways up of a scene.
pub(super) struct Ways {
    /// Along axes, the one with most of gravity first. None where gravity has no part along those that could be asked.
    pub(super) axes: Vec<Way>,
    /// Against gravity, but for its part along axes that repeat, which presses on nothing; `None` where that is along an axis.
    pub(super) against_gravity: Option<Way>,
}

impl Ways {
    /// Of a scene; `up` is the axis that gravity mostly points along.
    pub(super) fn of(scene: &Scene, up: usize) -> Self {
        let axes = load_axes(scene, up);
        Self {
            axes: axes.iter().map(|axis| Way::along(scene, *axis)).collect(),
            against_gravity: Way::against_gravity(scene),
        }
    }

    /// Ways along axes that do not repeat.
    pub(super) fn fixed(&self) -> impl Iterator<Item = &Way> {
        self.axes.iter().filter(|way| way.period.is_none())
    }
}

impl Way {
    fn along(scene: &Scene, axis: usize) -> Self {
        let domain = &scene.domain;
        let mut direction = [0.0; 3];
        direction[axis] = if domain.gravity[axis] < 0.0 {
            1.0
        } else {
            -1.0
        };
        Self {
            direction,
            gravity: domain.gravity[axis].abs(),
            period: domain.periodic[axis].then_some(axis),
            longest: domain.upper[axis] - domain.lower[axis],
        }
    }

    fn against_gravity(scene: &Scene) -> Option<Self> {
        let (domain, gravity) = (&scene.domain, pressing_gravity(scene));
        let size = norm(&gravity);
        (gravity.iter().filter(|part| **part != 0.0).count() > 1).then(|| Self {
            direction: gravity.map(|part| -part / size),
            gravity: size,
            period: None,
            longest: (0..3).map(|k| domain.upper[k] - domain.lower[k]).sum(),
        })
    }

    /// The point so far up from a place; on an axis that repeats its image in the domain.
    pub(super) fn point(&self, scene: &Scene, place: &Point, way: f64) -> Point {
        let mut x: Point = std::array::from_fn(|k| place[k] + self.direction[k] * way);
        if let Some(axis) = self.period {
            let lower = scene.domain.lower[axis];
            let beyond = (x[axis] - lower).rem_euclid(self.longest);
            // What rounds to a whole period is the next one's beginning.
            x[axis] = lower + if beyond < self.longest { beyond } else { 0.0 };
        }
        x
    }

    /// How far up from a place in a box with these corners its end is [m]; below 0 where it has been left before.
    pub(super) fn height(&self, place: &Point, (lower, upper): &(Point, Point)) -> f64 {
        let along = (0..3).filter(|k| self.direction[*k] != 0.0);
        let ends = along.map(|k| {
            let end = if self.direction[k] > 0.0 {
                upper
            } else {
                lower
            };
            (end[k] - place[k]) / self.direction[k]
        });
        ends.fold(f64::INFINITY, f64::min)
    }
}

/// Gravity without its parts along axes that repeat: what is driven along a period leans on nothing [m/s^2].
pub(super) fn pressing_gravity(scene: &Scene) -> Point {
    let domain = &scene.domain;
    std::array::from_fn(|k| {
        let presses = k < scene.dimension.axes() && !domain.periodic[k];
        if presses { domain.gravity[k] } else { 0.0 }
    })
}

/// Axes to ask, the one with most of gravity first; `up` is the one that gravity mostly points along.
fn load_axes(scene: &Scene, up: usize) -> Vec<usize> {
    let domain = &scene.domain;
    let last = scene.dimension.axes() - 1;
    // A bed lies across the last axis on slopes of up to 45 deg, and the side of a column is as free as the end of a layer.
    if up == last && !domain.periodic[up] {
        return vec![up];
    }
    let part = |axis: &usize| domain.gravity[*axis].abs();
    let mut axes: Vec<usize> = (0..=last).rev().collect();
    let fixed = axes.iter().filter(|axis| !domain.periodic[**axis]);
    let largest = fixed.map(part).fold(0.0, f64::max);
    axes.retain(|axis| part(axis) > 0.0 && part(axis) >= SHARE * largest);
    axes.sort_by(|a, b| part(b).total_cmp(&part(a)));
    axes
}
