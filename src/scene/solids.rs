//! Walls and gates by their surfaces.

use super::{Gate, WallGeometry, narrow};
use crate::boundary::{ROWS, RigidMotion};
use crate::gauge::Solid;
use crate::math::{Vector, add, apply, norm, scale, sub};

/// A wall at time 0 by its surface, in a scene of this particle spacing [m].
pub(crate) fn solid<const D: usize>(geometry: &WallGeometry, spacing: f64) -> Solid<D> {
    match geometry {
        WallGeometry::Polyline { points, closed } => Solid::Chain {
            points: points.iter().map(|x| narrow(&[x[0], x[1], 0.0])).collect(),
            closed: *closed,
            depth: ROWS as f64 * spacing,
        },
        WallGeometry::Box { lower, upper } => {
            let (lower, upper) = (narrow::<D>(lower), narrow::<D>(upper));
            let edge = |k| std::array::from_fn(|a| if a == k { upper[k] - lower[k] } else { 0.0 });
            Solid::Block {
                corner: lower,
                edges: std::array::from_fn(edge),
            }
        }
        WallGeometry::Plane { point, normal } => Solid::Behind {
            point: narrow(point),
            normal: narrow(normal),
        },
    }
}

/// What an opening leaves of a gate's plate: its face from `from` to `to`, its body behind it.
pub(crate) fn plate<const D: usize>(gate: &Gate, opening: f64) -> Solid<D> {
    let (from, to) = (narrow::<D>(&gate.from), narrow::<D>(&gate.to));
    let way = sub(&to, &from);
    let span = narrow::<D>(&gate.span);
    // Towards the material: in the plane to the left of the way, in space span x way.
    let normal: Vector<D> = std::array::from_fn(|k| match (D, k) {
        (2, 0) => -way[1],
        (2, _) => way[0],
        _ => {
            let (a, b) = ((k + 1) % D, (k + 2) % D);
            span[a] * way[b] - span[b] * way[a]
        }
    });
    let back = scale(-gate.thickness / norm(&normal), &normal);
    let left = scale(1.0 - opening, &way);
    Solid::Block {
        corner: add(&from, &scale(opening, &way)),
        edges: std::array::from_fn(|k| [left, back, span][k]),
    }
}

/// A wall that moves as a whole after `time` [s], of the one at time 0.
#[must_use]
pub(crate) fn moved<const D: usize>(
    solid: &Solid<D>,
    motion: &RigidMotion<D>,
    time: f64,
) -> Solid<D> {
    let (turn, centre) = (motion.rotation_at(time), motion.centre_at(time));
    solid.moved(|x| add(&centre, &apply(&turn, &sub(x, &motion.centre))))
}
