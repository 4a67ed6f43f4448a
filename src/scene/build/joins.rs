//! Boxes that meet other walls: `fill` closes the edges that two bodies share, `face` finds which faces of a box nothing covers.

mod face;
mod fill;

use crate::boundary::WallPoints;
use crate::math::Vector;

use super::narrow;
use crate::scene::{Scene, Wall, WallGeometry};

/// What stands and lies in a scene at its start, besides walls.
pub(super) struct Standing<'a, const D: usize> {
    /// Points of shut gates.
    pub(super) plates: Vec<Vector<D>>,
    /// Particles.
    pub(super) grains: &'a [Vector<D>],
    /// Where inflows let particles in.
    pub(super) slots: Vec<Vector<D>>,
    /// Lower and upper end of periodic axes [m].
    pub(super) sides: [Option<(f64, f64)>; D],
}

/// Fills what lies behind edges at which a fixed box meets another fixed wall, and gives points of all boxes the normal of the nearest
/// face that nothing covers.
pub(super) fn join_boxes<const D: usize>(
    scene: &Scene,
    points: &mut WallPoints<D>,
    standing: &Standing<'_, D>,
) {
    let solids = solids::<D>(scene);
    if solids.is_empty() {
        return;
    }
    let stays = |solid: &&Solid<D>| !scene.walls[usize::from(solid.group)].rigid;
    let fixed: Vec<&Solid<D>> = solids.iter().filter(stays).collect();
    for fill in fill::fills(scene, points, &fixed, standing) {
        let velocity = narrow(&scene.walls[usize::from(fill.group)].velocity);
        points.push(fill.place, velocity, fill.normal, 1.0, fill.group);
    }
    face::face_openly(scene, points, &solids, &standing.sides);
}

/// A box of a scene, and the lattice of its points.
struct Solid<const D: usize> {
    group: u16,
    lower: Vector<D>,
    upper: Vector<D>,
    count: [usize; D],
    step: Vector<D>,
}

/// A face of a box.
#[derive(Clone, Copy, PartialEq)]
struct Face {
    axis: usize,
    /// 1 at the upper end of its axis, -1 at the lower.
    side: f64,
}

impl Face {
    fn all<const D: usize>() -> impl Iterator<Item = Self> {
        (0..D).flat_map(|axis| [-1.0, 1.0].map(|side| Self { axis, side }))
    }

    fn normal<const D: usize>(self) -> Vector<D> {
        std::array::from_fn(|k| if k == self.axis { self.side } else { 0.0 })
    }
}

impl<const D: usize> Solid<D> {
    fn new(group: u16, lower: Vector<D>, upper: Vector<D>, spacing: f64) -> Self {
        let count: [usize; D] =
            std::array::from_fn(|k| ((upper[k] - lower[k]) / spacing).round().max(1.0) as usize);
        Self {
            group,
            step: std::array::from_fn(|k| (upper[k] - lower[k]) / count[k] as f64),
            lower,
            upper,
            count,
        }
    }

    /// Coordinate so many steps out of a face [m]; below 0 inside.
    fn out_of(&self, face: Face, steps: f64) -> f64 {
        let at = if face.side > 0.0 {
            self.upper[face.axis]
        } else {
            self.lower[face.axis]
        };
        at + face.side * steps * self.step[face.axis]
    }
}

/// The boxes of a scene, where they are at the start.
fn solids<const D: usize>(scene: &Scene) -> Vec<Solid<D>> {
    let solid = |(n, wall): (usize, &Wall)| match &wall.geometry {
        WallGeometry::Box { lower, upper } => Some(Solid::new(
            n as u16,
            narrow(lower),
            narrow(upper),
            scene.numerics.spacing,
        )),
        _ => None,
    };
    scene.walls.iter().enumerate().filter_map(solid).collect()
}
