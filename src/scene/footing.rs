//! Which piles stand on something at the start: what hangs in the air falls, and nothing in it presses on anything (docs/theory.md, "Start").

use super::Scene;
use super::piles::{Piles, TOUCH, periods};
use super::ways::pressing_gravity;
use crate::math::norm;
use crate::shape::Lattice;
use crate::solver::Scheme;
use crate::state::CellGrid;

/// Cosine to gravity of the way to a wall point that bears a place [1]: those of a face beside a place that stands along gravity have less
/// wherever they lie on it, and a slope of up to 83 deg has some with more.
const BELOW: f64 = 0.75;

/// Of each body, whether its pile has a wall or shut gate below it; `walls` are their points.
pub(super) fn footing<const D: usize>(
    scene: &Scene,
    piles: &Piles<'_>,
    lattices: &[Lattice],
    walls: &[[f64; D]],
) -> Vec<bool> {
    let domain = &scene.domain;
    let gravity = pressing_gravity(scene);
    let size = norm(&gravity);
    // The papers' schemes start as printed, and along a period what a plug leans on is not known.
    let falls_round = (0..3).any(|k| domain.periodic[k] && domain.gravity[k] != 0.0 && size == 0.0);
    if scene.numerics.scheme != Scheme::Implicit || falls_round {
        return vec![true; lattices.len()];
    }
    let near = TOUCH * scene.numerics.spacing;
    let cells = CellGrid::build(walls, near, &periods::<D>(scene));
    let stands = |x: &[f64; D]| {
        let mut found = false;
        cells.for_each_within(x, near, |_, image, distance| {
            let down: f64 = (0..D).map(|k| (image[k] - x[k]) * gravity[k]).sum();
            found |= down > BELOW * distance * size;
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
