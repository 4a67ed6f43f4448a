//! Which piles stand on something at the start: what hangs in the air falls, and nothing in it presses on anything (docs/theory.md, "Start").

use super::Scene;
use super::piles::{Piles, periods};
use super::ways::{SHARE, pressing_gravity};
use crate::math::norm;
use crate::shape::Lattice;
use crate::solver::Scheme;
use crate::state::CellGrid;

/// How near a place lies to a point of what bears it, over the spacing [1]: one spacing on a lattice's lowest row, with a point beside it.
const NEAR: f64 = 1.5;

/// A point of a wall or gate that what is there at the start may stand on or lie under.
#[derive(Clone, Copy, Debug)]
pub(super) struct Support<const D: usize> {
    pub(super) place: [f64; D],
    pub(super) normal: [f64; D],
    /// Share of a spacing that it stands for [1].
    pub(super) weight: f64,
}

/// Of each body, whether its pile has a wall or shut gate below it, level or on a slope of up to 84 deg.
pub(super) fn footing<const D: usize>(
    scene: &Scene,
    piles: &Piles<'_>,
    lattices: &[Lattice],
    walls: &[Support<D>],
) -> Vec<bool> {
    let gravity = pressing_gravity(scene);
    let size = norm(&gravity);
    // The papers' schemes start as printed, and along a period it is not known what a plug leans on.
    if scene.numerics.scheme != Scheme::Implicit || size == 0.0 {
        return vec![true; lattices.len()];
    }
    let near = NEAR * scene.numerics.spacing;
    let places: Vec<[f64; D]> = walls.iter().map(|w| w.place).collect();
    let cells = CellGrid::build(&places, near, &periods::<D>(scene));
    let stands = |x: &[f64; D]| {
        let mut found = false;
        cells.for_each_within(x, near, |n, image, _| {
            let normal = &walls[n].normal;
            let away: f64 = (0..D).map(|k| (x[k] - image[k]) * normal[k]).sum();
            let down: f64 = (0..D).map(|k| normal[k] * gravity[k]).sum();
            // Plates have a face on either side.
            found |= -down * away.signum() > SHARE * size;
        });
        found
    };
    let own = |lattice: &Lattice| {
        let mut places = lattice.points.iter();
        places.any(|p| stands(&std::array::from_fn(|k| p[k])))
    };
    let own: Vec<bool> = lattices.iter().map(own).collect();
    piles.any(&own)
}
