//! Walls and gates of a scene by their surfaces, where they are now: what gauges must not take for material.

use crate::boundary::RigidMotion;
use crate::gauge::Solid;
use crate::math::Vector;
use crate::scene::{self, Gate, Scene, moved, plate, solid};

/// The walls at time 0 and how they move, and the gates.
pub(super) struct Solids<const D: usize> {
    walls: Vec<(Solid<D>, Option<RigidMotion<D>>)>,
    gates: Vec<Gate>,
    /// Lower and upper side of each periodic axis [m].
    sides: [Option<(f64, f64)>; D],
}

impl<const D: usize> Solids<D> {
    pub(super) fn new(scene: &Scene, sides: [Option<(f64, f64)>; D]) -> Self {
        let walls = scene.walls.iter().map(|wall| {
            let motion = scene::rigid_motion(&wall.velocity, wall.rotation.as_ref());
            let solid = solid(&wall.geometry, scene.numerics.spacing);
            (solid, wall.rigid.then_some(motion))
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

    /// All of them after each wall has moved for one of `times` [s], the gates at these openings.
    pub(super) fn at(&self, times: &[f64], openings: impl Iterator<Item = f64>) -> Vec<Solid<D>> {
        let walls = self.walls.iter().zip(times);
        let walls = walls.flat_map(|((solid, motion), time)| match motion {
            None => vec![solid.clone()],
            Some(motion) => moved(solid, motion, *time).images(&self.sides),
        });
        let gates = self.gates.iter().zip(openings);
        walls.chain(gates.map(|(g, o)| plate(g, o))).collect()
    }
}
