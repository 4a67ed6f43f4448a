//! What lies on what at the start: the weight above a place makes its density (docs/theory.md, "Start").
//!
//! Only bodies that touch press on each other, by way of others or themselves: not through the air, and not through a shelf or a shut gate
//! that parts all of one from the other. What is joined beside a shelf counts as above it, as in a fluid it does.

use super::roof::pressures_under_roofs;
use super::{Body, Point, Scene};
use crate::math::dot;
use crate::shape::Lattice;
use crate::state::CellGrid;

/// Halvings of a spacing that find where a body ends.
const BISECTIONS: u32 = 20;

/// Places of two bodies that are nearer than this over the spacing touch [1]: a row's own distance, and some for lattices that do not fit.
/// A wall of four tenths of a spacing keeps them further apart.
pub(super) const TOUCH: f64 = 1.35;

/// The starting loads of a scene.
pub(super) struct Loads<'a> {
    scene: &'a Scene,
    /// Axis of "up".
    up: usize,
    /// A number for each body, the same for those that touch.
    piles: Vec<usize>,
    /// Pressures of places of fluids under a roof, for each body [Pa]; see [`pressures_under_roofs`].
    roofed: Vec<Vec<Option<f64>>>,
}

impl<'a> Loads<'a> {
    /// Of a scene in D dimensions whose bodies have these places, before walls and gates with these points.
    pub(super) fn new<const D: usize>(
        scene: &'a Scene,
        up: usize,
        lattices: &[Lattice],
        walls: &[[f64; D]],
    ) -> Self {
        let mut loads = Self {
            scene,
            up,
            piles: piles::<D>(scene, lattices),
            roofed: Vec::new(),
        };
        loads.roofed = pressures_under_roofs(&loads, lattices, walls);
        loads
    }

    /// Pressure at `x`, which belongs to one of a body's places and lies near it [Pa].
    pub(super) fn at(&self, body: usize, (number, place): (usize, &Point), x: &Point) -> f64 {
        match self.roofed[body].get(number) {
            Some(Some(pressure)) => {
                let material = self.scene.bodies[body].material;
                let rho = self.scene.materials[material].material.rest_density();
                let lower = self.direction() * (place[self.up] - x[self.up]);
                (pressure + rho * self.gravity() * lower).max(0.0)
            }
            _ => self.above(body, x),
        }
    }

    pub(super) fn scene(&self) -> &Scene {
        self.scene
    }

    /// Axis of "up".
    pub(super) fn up(&self) -> usize {
        self.up
    }

    /// Along that axis, gravity's size [m/s^2].
    pub(super) fn gravity(&self) -> f64 {
        self.scene.domain.gravity[self.up].abs()
    }

    /// 1 where up is along the axis, -1 where it is against it.
    pub(super) fn direction(&self) -> f64 {
        if self.scene.domain.gravity[self.up] < 0.0 {
            1.0
        } else {
            -1.0
        }
    }

    /// Way from a place of a body up to where what touches that ends the first time [m].
    pub(super) fn top_above(&self, body: usize, place: &Point) -> f64 {
        let upwards = self.scene.up();
        let pile = self.piles[body];
        let inside = |way: f64| {
            let mut x = *place;
            x[self.up] += self.direction() * way;
            let bodies = self.scene.bodies.iter().zip(&self.piles);
            bodies.filter(|(_, p)| **p == pile).any(|(body, _)| {
                body.shape.contains(&x) && body.level.is_none_or(|level| dot(&upwards, &x) <= level)
            })
        };
        // Bodies that touch may leave a gap of less than half a spacing.
        let step = 0.5 * self.scene.numerics.spacing;
        let domain = &self.scene.domain;
        let most = domain.upper[self.up] - domain.lower[self.up];
        let mut way = 0.0;
        while way < most && inside(way + step) {
            way += step;
        }
        first_change(&inside, way, step)
    }

    /// Weight of what lies above a place in a body and touches that, by way of others or itself [Pa].
    pub(super) fn above(&self, body: usize, place: &Point) -> f64 {
        let up = self.up;
        let g = self.gravity();
        let direction = self.direction();
        let upwards = self.scene.up();
        let weight = |other: &Body| {
            let (lower, upper) = other.shape.bounds();
            let top = if direction > 0.0 { upper } else { lower };
            let mut height = direction * (top[up] - place[up]);
            if let Some(level) = other.level {
                height = height.min(level - dot(&upwards, place));
            }
            let rho = self.scene.materials[other.material].material.rest_density();
            if height > 0.0 && height.is_finite() {
                let along = (height, self.scene.numerics.spacing);
                rho * g * filled(other, place, (up, direction), along)
            } else {
                0.0
            }
        };
        let others = self.scene.bodies.iter().zip(&self.piles);
        others
            .filter(|(_, pile)| **pile == self.piles[body])
            .map(|(other, _)| weight(other))
            .sum()
    }
}

/// Lower and upper end of each periodic axis [m].
pub(super) fn periods<const D: usize>(scene: &Scene) -> [Option<(f64, f64)>; D] {
    let domain = &scene.domain;
    std::array::from_fn(|k| domain.periodic[k].then_some((domain.lower[k], domain.upper[k])))
}

/// The least number of the bodies that each one touches, by way of others.
fn piles<const D: usize>(scene: &Scene, lattices: &[Lattice]) -> Vec<usize> {
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

/// How much of the way of length `height` from `place` along an axis lies in a body [m].
fn filled(
    body: &Body,
    place: &Point,
    (axis, direction): (usize, f64),
    (height, spacing): (f64, f64),
) -> f64 {
    let inside = |way: f64| {
        let mut x = *place;
        x[axis] += direction * way;
        body.shape.contains(&x)
    };
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
                let change = first_change(&inside, from, step) - from;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    /// Load on the floor of a scene whose last body lies lowest, 20 mm deep, below `others` [Pa].
    fn on_the_floor(others: &str) -> f64 {
        let text = format!(
            r#"
name = "loads"
[domain]
lower = [0, -0.1]
upper = [0.1, 0.4]
gravity = 10
[numerics]
spacing = "5 mm"
[materials.m]
law = "fluid"
density = 1000
consistency = 1
{others}
[bodies.z]
material = "m"
box = {{ lower = [0, 0], upper = [0.1, 0.02] }}
[run]
step = 0.01
until = 1
"#
        );
        let scene = scene::parse("loads", &text).unwrap();
        let lattices: Vec<_> = scene
            .bodies
            .iter()
            .map(|b| crate::shape::lattice(&b.shape, None, 0.005, 2, false))
            .collect();
        let loads = Loads::new::<2>(&scene, 1, &lattices, &[]);
        loads.above(scene.bodies.len() - 1, &[0.05, 0.0, 0.0])
    }

    fn body(name: &str, from: f64, to: f64) -> String {
        format!(
            "[bodies.{name}]\nmaterial = \"m\"\nbox = {{ lower = [0, {from}], upper = [0.1, {to}] }}\n"
        )
    }

    #[test]
    fn what_touches_presses_and_what_does_not_does_not() {
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-3, "{a} for {b}");
        close(on_the_floor(""), 200.0);
        close(on_the_floor(&body("a", 0.02, 0.05)), 500.0);
        let tower = body("a", 0.05, 0.1) + &body("b", 0.02, 0.05);
        close(on_the_floor(&tower), 1000.0);
        // In the air, and the thinnest shelf between.
        close(on_the_floor(&body("a", 0.03, 0.05)), 200.0);
        close(on_the_floor(&body("a", 0.025, 0.05)), 200.0);
    }
}
