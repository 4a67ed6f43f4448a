//! What lies on what at the start: the weight above a place makes its density (docs/theory.md, "Start").
//!
//! Only bodies that touch press on each other, by way of others or themselves: not through the air, and not through a shelf or a shut gate
//! that parts all of one from the other. What is joined beside a shelf counts as above it, as in a fluid it does.

use super::{Body, Point, Scene};
use crate::math::dot;
use crate::shape::Lattice;
use crate::state::CellGrid;

/// Halvings of a spacing that find where a body ends.
const BISECTIONS: u32 = 20;

/// Places of two bodies that are nearer than this over the spacing touch [1]: a row's own distance, and some for lattices that do not fit.
/// A wall of four tenths of a spacing keeps them further apart.
const TOUCH: f64 = 1.35;

/// The starting loads of a scene.
pub(super) struct Loads<'a> {
    scene: &'a Scene,
    /// Axis of "up".
    up: usize,
    /// A number for each body, the same for those that touch.
    piles: Vec<usize>,
}

impl<'a> Loads<'a> {
    /// Of a scene in D dimensions whose bodies have these places.
    pub(super) fn new<const D: usize>(scene: &'a Scene, up: usize, lattices: &[Lattice]) -> Self {
        Self {
            scene,
            up,
            piles: piles::<D>(scene, lattices),
        }
    }

    /// Weight of what lies above a place in a body and touches that, by way of others or itself [Pa].
    pub(super) fn above(&self, body: usize, place: &Point) -> f64 {
        let up = self.up;
        let g = self.scene.domain.gravity[up];
        let direction = if g < 0.0 { 1.0 } else { -1.0 };
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
                rho * g.abs() * filled(other, place, (up, direction), along)
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
    let domain = &scene.domain;
    let periods =
        std::array::from_fn(|k| domain.periodic[k].then_some((domain.lower[k], domain.upper[k])));
    let cells = CellGrid::build(&points, near, &periods);
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
                let (mut low, mut high) = (0.0, step);
                for _ in 0..BISECTIONS {
                    let middle = 0.5 * (low + high);
                    if inside(from + middle) == was {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                if was { low } else { step - low }
            }
        };
        was = is;
    }
    length
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
        let loads = Loads::new::<2>(&scene, 1, &lattices);
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
