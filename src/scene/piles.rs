//! Bodies that touch at the start, by way of others: what lies on what.

use super::{Body, Point, Scene};
use crate::math::dot;
use crate::shape::Lattice;
use crate::state::CellGrid;

/// Places of two bodies that are nearer than this over the spacing touch [1]: a row's own distance, and some for lattices that do not fit.
/// A wall of four tenths of a spacing keeps them further apart.
pub(super) const TOUCH: f64 = 1.35;

/// Which bodies touch.
pub(super) struct Piles<'a> {
    scene: &'a Scene,
    /// A number for each body, the same for those that touch.
    numbers: Vec<usize>,
}

impl<'a> Piles<'a> {
    /// Of a scene in D dimensions whose bodies have these places.
    pub(super) fn of<const D: usize>(scene: &'a Scene, lattices: &[Lattice]) -> Self {
        Self {
            scene,
            numbers: touching::<D>(scene, lattices),
        }
    }

    /// The bodies that touch one, and that one.
    pub(super) fn around(&self, body: usize) -> impl Iterator<Item = &Body> {
        let bodies = self.scene.bodies.iter().zip(&self.numbers);
        let own = self.numbers[body];
        bodies.filter(move |(_, n)| **n == own).map(|(b, _)| b)
    }

    /// Of each body, whether this is so of one in its pile.
    pub(super) fn any(&self, of: &[bool]) -> Vec<bool> {
        let pile_of =
            |number: &usize| (self.numbers.iter().zip(of)).any(|(n, is)| n == number && *is);
        self.numbers.iter().map(pile_of).collect()
    }

    /// Whether a point lies in a body or what touches that.
    pub(super) fn fill(&self, body: usize, x: &Point) -> bool {
        self.around(body).any(|other| holds(self.scene, other, x))
    }
}

/// Whether a point lies in a body, below its level.
pub(super) fn holds(scene: &Scene, body: &Body, x: &Point) -> bool {
    let height = dot(&scene.up(), x);
    body.shape.contains(x) && body.level.is_none_or(|level| height <= level)
}

/// Lower and upper end of each periodic axis [m].
pub(super) fn periods<const D: usize>(scene: &Scene) -> [Option<(f64, f64)>; D] {
    let domain = &scene.domain;
    std::array::from_fn(|k| domain.periodic[k].then_some((domain.lower[k], domain.upper[k])))
}

/// The least number of the bodies that each one touches, by way of others.
fn touching<const D: usize>(scene: &Scene, lattices: &[Lattice]) -> Vec<usize> {
    let mut piles: Vec<usize> = (0..lattices.len()).collect();
    if lattices.len() < 2 {
        return piles;
    }
    let owner: Vec<usize> = (0..lattices.len())
        .flat_map(|n| std::iter::repeat_n(n, lattices[n].points.len()))
        .collect();
    let points: Vec<[f64; D]> = lattices
        .iter()
        .flat_map(|l| &l.points)
        .map(|p| std::array::from_fn(|k| p[k]))
        .collect();
    let near = TOUCH * scene.numerics.spacing;
    let cells = CellGrid::build(&points, near, &periods::<D>(scene));
    for (x, &own) in points.iter().zip(&owner) {
        cells.for_each_within(x, near, |j, _, _| {
            let (a, b) = (piles[own], piles[owner[j]]);
            if a != b {
                let (kept, gone) = (a.min(b), a.max(b));
                for pile in piles.iter_mut().filter(|pile| **pile == gone) {
                    *pile = kept;
                }
            }
        });
    }
    piles
}
