//! What lies on what at the start: the weight above a place makes its density (docs/theory.md, "Start").
//!
//! Only bodies that touch (`piles.rs`) press on each other, by way of others or themselves: not through the air, and not through a shelf or a shut gate
//! that parts all of one from the other. What is joined beside a shelf counts as above it, as in a fluid it does.
//!
//! "Above" is against gravity's part along one axis. Of several (`load_axes.rs`) the one that gives a place least counts: a layer on a steep
//! slope lies on its bed, not on its lower end.

use super::load_axes::load_axes;
use super::piles::{Piles, holds, periods};
use super::roof::pressures_under_roofs;
use super::{Body, Point, Scene};
use crate::math::dot;
use crate::shape::Lattice;
use crate::state::CellGrid;

/// Halvings of a spacing that find where a body ends.
const BISECTIONS: u32 = 20;

/// How near a wall point lies to half a spacing above a top where that is a roof, over the spacing [1]: a row of points half a
/// spacing behind the roof is as near whatever its phase, a wall beside the top is not.
const ROOF: f64 = 0.75;

/// The starting loads of a scene.
pub(super) struct Loads<'a, const D: usize> {
    scene: &'a Scene,
    /// Axes along which weight may rest, the one that gravity mostly points along first.
    axes: Vec<usize>,
    piles: Piles<'a>,
    /// Points of walls and gates at which the way up may end.
    walls: CellGrid<D>,
    /// Pressures of places of fluids under a roof, for each body [Pa]; see [`pressures_under_roofs`].
    roofed: Vec<Vec<Option<f64>>>,
}

impl<'a, const D: usize> Loads<'a, D> {
    /// Of a scene in D dimensions whose bodies have these places, before walls and gates with these points; `up` is the axis that gravity
    /// mostly points along.
    pub(super) fn new(
        scene: &'a Scene,
        up: usize,
        lattices: &[Lattice],
        walls: &[[f64; D]],
    ) -> Self {
        let near = ROOF * scene.numerics.spacing;
        let mut loads = Self {
            scene,
            axes: load_axes(scene, up),
            piles: Piles::of::<D>(scene, lattices),
            walls: CellGrid::build(walls, near, &periods::<D>(scene)),
            roofed: Vec::new(),
        };
        loads.roofed = pressures_under_roofs(&loads, lattices);
        loads
    }

    /// Pressure at `x`, which belongs to one of a body's places and lies near it [Pa].
    pub(super) fn at(&self, body: usize, (number, place): (usize, &Point), x: &Point) -> f64 {
        match self.roofed[body].get(number) {
            Some(Some(pressure)) => {
                let material = self.scene.bodies[body].material;
                let rho = self.scene.materials[material].material.rest_density();
                (pressure + self.head(rho, place, x)).max(0.0)
            }
            _ => self.above(body, x),
        }
    }

    pub(super) fn scene(&self) -> &Scene {
        self.scene
    }

    /// Whether there are walls or gates at which the way up may end.
    pub(super) fn has_walls(&self) -> bool {
        !self.walls.is_empty()
    }

    /// What a fluid of this density at rest bears more at `low` than at `high` [Pa].
    pub(super) fn head(&self, rho: f64, high: &[f64], low: &[f64]) -> f64 {
        let axes = self.axes.iter().filter(|axis| !self.repeats(**axis));
        axes.map(|&k| rho * self.gravity(k) * (self.direction(k) * (high[k] - low[k])))
            .sum()
    }

    /// Whether a place is under a roof, whichever way is up.
    pub(super) fn under_roof(&self, body: usize, place: &Point) -> bool {
        let mut ways = self.axes.iter().filter(|axis| !self.repeats(**axis));
        let all = ways.clone().all(|&k| self.ends_at_wall(k, body, place));
        all && ways.next().is_some()
    }

    /// Weight of what lies above a place in a body and touches that, by way of others or itself [Pa].
    pub(super) fn above(&self, body: usize, place: &Point) -> f64 {
        let mut fixed = self.axes.iter().filter(|axis| !self.repeats(**axis));
        match (&self.axes[..], fixed.next()) {
            ([only], Some(_)) => self.weight(*only, body, place),
            (axes, first) => {
                let open = axes.iter().filter_map(|&k| self.borne(k, body, place));
                open.reduce(f64::min)
                    .or_else(|| first.map(|&k| self.weight(k, body, place)))
                    .unwrap_or(0.0)
            }
        }
    }

    /// As [`Loads::above`], along an axis; `None` where nothing says what a place bears along it: its way up goes round a period and never
    /// ends, or ends at a wall.
    fn borne(&self, axis: usize, body: usize, place: &Point) -> Option<f64> {
        let endless = self.repeats(axis) && self.is_round(axis, body, place);
        if endless || self.ends_at_wall(axis, body, place) {
            return None;
        }
        if !self.repeats(axis) {
            return Some(self.weight(axis, body, place));
        }
        let way = self.top_above(axis, body, place);
        let weight = |other: &Body| self.gravity(axis) * self.mass(axis, other, place, way);
        Some(self.piles.around(body).map(weight).sum())
    }

    /// Whether a place's pile fills the whole period along an axis; touching bodies may leave half a spacing.
    fn is_round(&self, axis: usize, body: usize, place: &Point) -> bool {
        let (period, spacing) = (self.extent(axis), self.scene.numerics.spacing);
        let inside = |way: f64| self.piles.fill(body, &self.along(axis, place, way));
        filled(&inside, period, spacing) > period - 0.5 * spacing
    }

    /// Whether what touches a place ends at a wall or gate above it.
    fn ends_at_wall(&self, axis: usize, body: usize, place: &Point) -> bool {
        if !self.has_walls() {
            return false;
        }
        let dp = self.scene.numerics.spacing;
        let way = self.top_above(axis, body, place) + 0.5 * dp;
        let mut top: [f64; D] = std::array::from_fn(|k| place[k]);
        top[axis] += self.direction(axis) * way;
        let mut wall = false;
        self.walls
            .for_each_within(&top, ROOF * dp, |_, _, _| wall = true);
        wall
    }

    /// Way from a place of a body up to where what touches that ends the first time [m].
    fn top_above(&self, axis: usize, body: usize, place: &Point) -> f64 {
        let inside = |way: f64| self.piles.fill(body, &self.along(axis, place, way));
        // Bodies that touch may leave a gap of less than half a spacing.
        let step = 0.5 * self.scene.numerics.spacing;
        let most = self.extent(axis);
        let mut way = 0.0;
        while way < most && inside(way + step) {
            way += step;
        }
        first_change(&inside, way, step)
    }

    /// Weight of all of a pile that lies above a place along an axis that does not repeat [Pa].
    fn weight(&self, axis: usize, body: usize, place: &Point) -> f64 {
        let direction = self.direction(axis);
        let upwards = self.scene.up();
        let weight = |other: &Body| {
            let (lower, upper) = other.shape.bounds();
            let top = if direction > 0.0 { upper } else { lower };
            let mut height = direction * (top[axis] - place[axis]);
            if let Some(level) = other.level {
                let room = level - dot(&upwards, place);
                // Across "up" all or nothing of the way is below the level.
                if upwards[axis] != 0.0 || room <= 0.0 {
                    height = height.min(room);
                }
            }
            let rho = self.scene.materials[other.material].material.rest_density();
            if height > 0.0 && height.is_finite() {
                let inside = |way: f64| other.shape.contains(&self.along(axis, place, way));
                let spacing = self.scene.numerics.spacing;
                rho * self.gravity(axis) * filled(&inside, height, spacing)
            } else {
                0.0
            }
        };
        self.piles.around(body).map(weight).sum()
    }

    /// Mass of a body on the way up from a place, over the area across it [kg/m^2].
    fn mass(&self, axis: usize, body: &Body, place: &Point, way: f64) -> f64 {
        let rho = self.scene.materials[body.material].material.rest_density();
        let inside = |way: f64| holds(self.scene, body, &self.along(axis, place, way));
        rho * filled(&inside, way, self.scene.numerics.spacing)
    }

    /// The point so far up from a place; on an axis that repeats its image in the domain.
    fn along(&self, axis: usize, place: &Point, way: f64) -> Point {
        let mut x = *place;
        x[axis] += self.direction(axis) * way;
        if self.repeats(axis) {
            let lower = self.scene.domain.lower[axis];
            let beyond = (x[axis] - lower).rem_euclid(self.extent(axis));
            // What rounds to a whole period is the next one's beginning.
            x[axis] = lower
                + if beyond < self.extent(axis) {
                    beyond
                } else {
                    0.0
                };
        }
        x
    }

    /// Gravity's size along an axis [m/s^2].
    fn gravity(&self, axis: usize) -> f64 {
        self.scene.domain.gravity[axis].abs()
    }

    /// 1 where up is along an axis, -1 where it is against it.
    fn direction(&self, axis: usize) -> f64 {
        if self.scene.domain.gravity[axis] < 0.0 {
            1.0
        } else {
            -1.0
        }
    }

    fn repeats(&self, axis: usize) -> bool {
        self.scene.domain.periodic[axis]
    }

    /// Of the domain [m].
    fn extent(&self, axis: usize) -> f64 {
        self.scene.domain.upper[axis] - self.scene.domain.lower[axis]
    }
}

/// How much of a way of length `height` lies `inside` [m].
fn filled(inside: &impl Fn(f64) -> bool, height: f64, spacing: f64) -> f64 {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    /// Load at a place of the last of the bodies of a scene with this domain, before walls with these points [Pa].
    fn load(domain: &str, bodies: &str, place: [f64; 2], walls: &[[f64; 2]]) -> f64 {
        let text = format!(
            r#"
name = "loads"
[domain]
{domain}
[numerics]
spacing = "5 mm"
[materials.m]
law = "fluid"
density = 1000
consistency = 1
{bodies}
[run]
step = 0.01
until = 1
"#
        );
        let scene = scene::parse("loads", &text).unwrap_or_else(|e| panic!("{e}"));
        let lattices: Vec<_> = scene
            .bodies
            .iter()
            .map(|b| crate::shape::lattice(&b.shape, None, b.shape.bounds().0, 0.005, 2, false))
            .collect();
        let up = (0..2).find(|k| scene.up()[*k] != 0.0).unwrap();
        let loads = Loads::new(&scene, up, &lattices, walls);
        loads.above(scene.bodies.len() - 1, &[place[0], place[1], 0.0])
    }

    /// Load on the floor of a scene whose last body lies lowest, 20 mm deep, below `others` [Pa].
    fn on_the_floor(others: &str) -> f64 {
        let domain = "lower = [0, -0.1]\nupper = [0.1, 0.4]\ngravity = 10";
        load(
            domain,
            &(others.to_owned() + &body("z", 0.0, 0.02)),
            [0.05, 0.0],
            &[],
        )
    }

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() < 1e-3, "{a} for {b}");
    }

    fn body(name: &str, from: f64, to: f64) -> String {
        format!(
            "[bodies.{name}]\nmaterial = \"m\"\nbox = {{ lower = [0, {from}], upper = [0.1, {to}] }}\n"
        )
    }

    #[test]
    fn what_touches_presses_and_what_does_not_does_not() {
        close(on_the_floor(""), 200.0);
        close(on_the_floor(&body("a", 0.02, 0.05)), 500.0);
        let tower = body("a", 0.05, 0.1) + &body("b", 0.02, 0.05);
        close(on_the_floor(&tower), 1000.0);
        // In the air, and the thinnest shelf between.
        close(on_the_floor(&body("a", 0.03, 0.05)), 200.0);
        close(on_the_floor(&body("a", 0.025, 0.05)), 200.0);
    }

    #[test]
    fn what_repeats_along_gravity_has_no_top_but_where_it_ends() {
        let chute = |gravity: &str, bodies: &str, place| {
            let domain = format!(
                "lower = [-0.05, 0]\nupper = [0.15, 0.4]\nperiodic = [\"y\"]\ngravity = {gravity}"
            );
            load(&domain, bodies, place, &[])
        };
        let full = body("a", 0.0, 0.4);
        close(chute("[0, -10]", &full, [0.05, 0.1]), 0.0);
        let halves = body("a", 0.0, 0.2) + &body("b", 0.2, 0.4);
        close(chute("[0, -10]", &halves, [0.05, 0.3]), 0.0);
        // What leans on a side does so whatever it does along the chute.
        close(chute("[0.3, -10]", &full, [0.05, 0.1]), 15.0);
        // A plug ends, also beyond the seam: 0.1 m up to 0.4, and 0.05 m on from 0.
        close(chute("[0, -10]", &body("a", 0.2, 0.4), [0.05, 0.3]), 1000.0);
        let across = body("a", 0.0, 0.05) + &body("b", 0.2, 0.4);
        close(chute("[0, -10]", &across, [0.05, 0.3]), 1500.0);
        // Against the axis.
        close(chute("[0, 10]", &body("a", 0.2, 0.4), [0.05, 0.3]), 1000.0);
    }

    #[test]
    fn a_layer_on_a_steep_slope_lies_on_its_bed() {
        let on = |gravity: &str, place, walls: &[[f64; 2]]| {
            let domain = format!("lower = [-0.1, -0.1]\nupper = [0.4, 0.2]\ngravity = {gravity}");
            let layer =
                "[bodies.a]\nmaterial = \"m\"\nbox = { lower = [0, 0], upper = [0.3, 0.05] }\n";
            load(&domain, layer, place, walls)
        };
        close(on("[8, -6]", [0.2, 0.01], &[]), 240.0);
        // Near its upper end that bears less.
        close(on("[8, -6]", [0.02, 0.01], &[]), 160.0);
        // Under a lid it bears what is up the slope.
        let lid: Vec<[f64; 2]> = (0..60)
            .map(|n| [0.0025 + 0.005 * f64::from(n), 0.0525])
            .collect();
        close(on("[8, -6]", [0.2, 0.01], &lid), 1600.0);
        // Up to 45 deg, and beside what is all but along an axis, there is one.
        close(on("[6, -8]", [0.02, 0.01], &[]), 320.0);
        close(on("[8, -0.7]", [0.2, 0.01], &[]), 1600.0);
        close(on("[0.1, -10]", [0.002, 0.01], &[]), 400.0);
    }
}
