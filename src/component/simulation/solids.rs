//! Walls and gates of a scene by their surfaces, where they are now: what gauges must not take for material.

use crate::boundary::{ROWS, RigidMotion};
use crate::gauge::Solid;
use crate::math::{Vector, add, apply, norm, scale, sub};
use crate::scene::{self, Gate, Scene, WallGeometry, narrow};

/// The walls at time 0 and how they move, and the gates.
pub(super) struct Solids<const D: usize> {
    walls: Vec<(Solid<D>, Option<RigidMotion<D>>)>,
    gates: Vec<Gate>,
    /// Lower and upper side of each periodic axis [m].
    sides: [Option<(f64, f64)>; D],
}

impl<const D: usize> Solids<D> {
    pub(super) fn new(scene: &Scene, sides: [Option<(f64, f64)>; D]) -> Self {
        let depth = ROWS as f64 * scene.numerics.spacing;
        let walls = scene.walls.iter().map(|wall| {
            let motion = scene::rigid_motion(&wall.velocity, wall.rotation.as_ref());
            (solid(&wall.geometry, depth), wall.rigid.then_some(motion))
        });
        Self {
            walls: walls.collect(),
            gates: scene.gates.clone(),
            sides,
        }
    }

    /// Whether a place is behind the face of a wall that never moves.
    pub(super) fn holds(&self, at: &Vector<D>) -> bool {
        let standing = self.walls.iter().filter(|(_, motion)| motion.is_none());
        standing.into_iter().any(|(solid, _)| solid.holds(at, 0.0))
    }

    /// All of them after the walls have moved for `time` [s], the gates at these openings.
    pub(super) fn at(&self, time: f64, openings: impl Iterator<Item = f64>) -> Vec<Solid<D>> {
        let walls = self.walls.iter().flat_map(|(solid, motion)| match motion {
            None => vec![solid.clone()],
            Some(motion) => {
                let (turn, centre) = (motion.rotation_at(time), motion.centre_at(time));
                let place = |x: &Vector<D>| add(&centre, &apply(&turn, &sub(x, &motion.centre)));
                solid.moved(place).images(&self.sides)
            }
        });
        let gates = self.gates.iter().zip(openings);
        walls.chain(gates.map(|(g, o)| plate(g, o))).collect()
    }
}

fn solid<const D: usize>(geometry: &WallGeometry, depth: f64) -> Solid<D> {
    match geometry {
        WallGeometry::Polyline { points, closed } => Solid::Chain {
            points: points.iter().map(|x| narrow(&[x[0], x[1], 0.0])).collect(),
            closed: *closed,
            depth,
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
fn plate<const D: usize>(gate: &Gate, opening: f64) -> Solid<D> {
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
