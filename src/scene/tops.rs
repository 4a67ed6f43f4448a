//! Where the way up from a place leaves what touches that, and whether it comes out there.
//!
//! It does not where a wall or gate is above, and it says nothing of what the place bears where it leaves through a side that stands along
//! gravity: what is beside that, higher up, rests on the place as well.

use super::piles::{Piles, periods};
use super::ways::{SHARE, Way};
use super::{Point, Scene};
use crate::state::CellGrid;

/// Halvings of a spacing that find where a body ends.
const BISECTIONS: u32 = 20;

/// How near a wall point lies to half a spacing above a top where that is a roof, over the spacing [1]: a row of points half a
/// spacing behind the roof is as near whatever its phase, a wall a quarter of a spacing and more beside the top is not.
const ROOF: f64 = 0.75;

/// How far beside a place what is under a roof is under it too, over the spacing [1]. Of places of oblique sides some are nearer to a wall than
/// a quarter of a spacing.
const BESIDE: f64 = 0.4;

/// The upper ends of the piles of a scene in D dimensions.
pub(super) struct Tops<'a, const D: usize> {
    scene: &'a Scene,
    pub(super) piles: Piles<'a>,
    /// Points of walls and gates at which the way up may end.
    walls: CellGrid<D>,
}

impl<'a, const D: usize> Tops<'a, D> {
    pub(super) fn new(scene: &'a Scene, piles: Piles<'a>, walls: &[[f64; D]]) -> Self {
        let near = ROOF * scene.numerics.spacing;
        Self {
            scene,
            piles,
            walls: CellGrid::build(walls, near, &periods::<D>(scene)),
        }
    }

    /// Whether there are walls or gates at which the way up may end.
    pub(super) fn has_walls(&self) -> bool {
        !self.walls.is_empty()
    }

    /// Way from a place of a body up to where what touches that ends the first time [m].
    pub(super) fn length(&self, way: &Way, body: usize, place: &Point) -> f64 {
        let inside = |along: f64| self.piles.fill(body, &way.point(self.scene, place, along));
        // Bodies that touch may leave a gap of less than half a spacing.
        let step = 0.5 * self.scene.numerics.spacing;
        let mut along = 0.0;
        while along < way.longest && inside(along + step) {
            along += step;
        }
        first_change(&inside, along, step)
    }

    /// Whether a place's pile fills the whole period that the way goes along; touching bodies may leave half a spacing.
    pub(super) fn is_round(&self, way: &Way, body: usize, place: &Point) -> bool {
        let (period, spacing) = (way.longest, self.scene.numerics.spacing);
        let inside = |along: f64| self.piles.fill(body, &way.point(self.scene, place, along));
        way.period.is_some() && filled(&inside, period, spacing) > period - 0.5 * spacing
    }

    /// Whether the way ends at a wall or gate. One that stands along the way touches it where the place is next to it, but not the ways a
    /// little further from it.
    pub(super) fn end_at_wall(&self, way: &Way, body: usize, place: &Point) -> bool {
        self.has_walls() && self.meets_wall(way, body, place) && {
            let aside = BESIDE * self.scene.numerics.spacing;
            let beside = (0..2 * D).map(|n| {
                let mut x = *place;
                x[n / 2] += if n % 2 == 0 { aside } else { -aside };
                x
            });
            beside
                .filter(|x| self.piles.fill(body, x))
                .all(|x| self.meets_wall(way, body, &x))
        }
    }

    fn meets_wall(&self, way: &Way, body: usize, place: &Point) -> bool {
        let dp = self.scene.numerics.spacing;
        let beyond = self.length(way, body, place) + 0.5 * dp;
        let above: [f64; D] = std::array::from_fn(|k| place[k] + way.direction[k] * beyond);
        let mut wall = false;
        self.walls
            .for_each_within(&above, ROOF * dp, |_, _, _| wall = true);
        wall
    }

    /// Whether the way leaves through a side that stands along gravity: from just inside of that, more lies above, which is against gravity, than a
    /// face would leave that leans by more than a share of it.
    pub(super) fn end_at_side(
        &self,
        way: &Way,
        against_gravity: &Way,
        body: usize,
        place: &Point,
    ) -> bool {
        let dp = self.scene.numerics.spacing;
        let length = self.length(way, body, place);
        let inside = way.point(self.scene, place, length - SHARE * dp);
        let higher = against_gravity.point(self.scene, &inside, dp);
        self.piles.fill(body, &higher)
    }
}

/// How much of a way of length `height` lies `inside` [m].
pub(super) fn filled(inside: &impl Fn(f64) -> bool, height: f64, spacing: f64) -> f64 {
    // Just short of the top, which belongs to no body.
    let end = height * (1.0 - 1e-9);
    let count = (height / spacing).ceil().max(1.0);
    let step = end / count;
    let mut length = 0.0;
    let mut was = inside(0.0);
    for n in 0..count as usize {
        let from = n as f64 * step;
        let is = inside(from + step);
        length += match (was, is) {
            (true, true) => step,
            (false, false) => 0.0,
            _ => {
                let change = first_change(inside, from, step) - from;
                if was { change } else { step - change }
            }
        };
        was = is;
    }
    length
}

/// Where, on a way of length `step` from `from`, a body ends or begins.
fn first_change(inside: &impl Fn(f64) -> bool, from: f64, step: f64) -> f64 {
    let was = inside(from);
    let (mut low, mut high) = (0.0, step);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if inside(from + middle) == was {
            low = middle;
        } else {
            high = middle;
        }
    }
    from + low
}
