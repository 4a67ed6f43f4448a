//! What lies on what at the start: the weight above a place makes its density (docs/theory.md, "Start").
//!
//! Only bodies that touch (`piles.rs`) press on each other, by way of others or themselves: not through the air, and not through a shelf or a shut gate
//! that parts all of one from the other. What stands on nothing (`footing.rs`) bears nothing. What is joined beside a shelf counts as above it, as in a fluid it does.
//!
//! "Above" is along an axis, against gravity's part along it. Of several (`ways.rs`) the one that gives a place least counts: a layer on a steep
//! slope lies on its bed, not on its lower end. Where none comes out at a free surface (`tops.rs`), as from a bin that stands askew in the
//! domain, it is against gravity.

use super::footing::{Support, footing};
use super::piles::{Piles, holds};
use super::roof::pressures_under_roofs;
use super::tops::{Tops, filled};
use super::ways::{Way, Ways, pressing_gravity};
use super::{Body, Point, Scene};
use crate::math::dot;
use crate::shape::Lattice;

/// The starting loads of a scene.
pub(super) struct Loads<'a, const D: usize> {
    scene: &'a Scene,
    ways: Ways,
    tops: Tops<'a, D>,
    /// Of each body, whether what it touches stands on something.
    standing: Vec<bool>,
    /// Pressures of places under a roof, for each body [Pa]; see [`pressures_under_roofs`].
    roofed: Vec<Vec<Option<f64>>>,
}

impl<'a, const D: usize> Loads<'a, D> {
    /// Of a scene in D dimensions whose bodies have these places, before walls and gates with these points; `up` is the axis that gravity
    /// mostly points along.
    pub(super) fn new(
        scene: &'a Scene,
        up: usize,
        lattices: &[Lattice],
        walls: &[Support<D>],
    ) -> Self {
        let whole = walls.iter().filter(|w| w.weight > 0.5);
        let points: Vec<[f64; D]> = whole.map(|w| w.place).collect();
        let piles = Piles::of::<D>(scene, lattices);
        let mut loads = Self {
            scene,
            ways: Ways::of(scene, up),
            standing: footing(scene, &piles, lattices, walls),
            tops: Tops::new(scene, piles, &points),
            roofed: Vec::new(),
        };
        loads.roofed = pressures_under_roofs(&loads, lattices);
        loads
    }

    /// Pressure at `x`, which belongs to one of a body's places and lies near it [Pa].
    pub(super) fn at(&self, body: usize, (number, place): (usize, &Point), x: &Point) -> f64 {
        if !self.standing[body] {
            return 0.0;
        }
        let pressure = match self.roofed[body].get(number) {
            Some(Some(pressure)) => *pressure,
            // A side along the way is what a place near it may be moved out of, to where nothing is above it.
            _ if self.ways.against_gravity.is_some() && !self.tops.piles.fill(body, x) => {
                self.above(body, place)
            }
            _ => return self.above(body, x),
        };
        let material = self.scene.bodies[body].material;
        let rho = self.scene.materials[material].material.rest_density();
        (pressure + self.head(rho, place, x)).max(0.0)
    }

    pub(super) fn scene(&self) -> &Scene {
        self.scene
    }

    /// Whether there are walls or gates at which the way up may end.
    pub(super) fn has_walls(&self) -> bool {
        self.tops.has_walls()
    }

    /// What a fluid of this density at rest bears more at `low` than at `high` [Pa].
    pub(super) fn head(&self, rho: f64, high: &[f64], low: &[f64]) -> f64 {
        let gravity = pressing_gravity(self.scene);
        let parts = gravity.iter().zip(high.iter().zip(low));
        parts.map(|(g, (high, low))| rho * g * (low - high)).sum()
    }

    /// Whether a place is under a roof, whichever way is up.
    pub(super) fn under_roof(&self, body: usize, place: &Point) -> bool {
        let mut fixed = self.ways.fixed().peekable();
        let upright = self.ways.against_gravity.as_ref();
        fixed.peek().is_some()
            && fixed.all(|way| self.is_closed(way, body, place))
            && upright.is_none_or(|way| self.tops.end_at_wall(way, body, place))
    }

    /// Weight of what lies above a place in a body and touches that, by way of others or itself [Pa].
    pub(super) fn above(&self, body: usize, place: &Point) -> f64 {
        let ways = &self.ways;
        let axes = ways.axes.iter();
        if let ([only], None) = (&ways.axes[..], &ways.against_gravity)
            && only.period.is_none()
        {
            return self.weight(only, body, place);
        }
        let open = axes.filter_map(|way| self.borne(way, body, place));
        let otherwise = || ways.against_gravity.iter().chain(ways.fixed()).next();
        open.reduce(f64::min)
            .or_else(|| otherwise().map(|way| self.weight(way, body, place)))
            .unwrap_or(0.0)
    }

    /// As [`Loads::above`], along a way; `None` where nothing says what a place bears along it: it goes round a period and never ends, or
    /// is closed.
    fn borne(&self, way: &Way, body: usize, place: &Point) -> Option<f64> {
        if self.tops.is_round(way, body, place) || self.is_closed(way, body, place) {
            return None;
        }
        if way.period.is_none() {
            return Some(self.weight(way, body, place));
        }
        let length = self.tops.length(way, body, place);
        let weight = |other: &Body| way.gravity * self.mass(way, other, place, length);
        Some(self.tops.piles.around(body).map(weight).sum())
    }

    /// Whether a way along an axis ends at a wall or gate, or at a side that stands along gravity.
    fn is_closed(&self, way: &Way, body: usize, place: &Point) -> bool {
        let upright = self.ways.against_gravity.as_ref();
        upright.is_some_and(|up| self.tops.end_at_side(way, up, body, place))
            || self.tops.end_at_wall(way, body, place)
    }

    /// Weight of all of a pile that lies above a place along a way that leaves the domain [Pa].
    fn weight(&self, way: &Way, body: usize, place: &Point) -> f64 {
        let upwards = dot(&self.scene.up(), &way.direction);
        let weight = |other: &Body| {
            let mut height = way.height(place, &other.shape.bounds());
            if let Some(level) = other.level {
                let room = level - dot(&self.scene.up(), place);
                // Across "up" all or nothing of the way is below the level.
                if upwards > 0.0 {
                    height = height.min(room / upwards);
                } else if room <= 0.0 {
                    height = height.min(room);
                }
            }
            let rho = self.scene.materials[other.material].material.rest_density();
            if height > 0.0 && height.is_finite() {
                let inside =
                    |along: f64| other.shape.contains(&way.point(self.scene, place, along));
                let spacing = self.scene.numerics.spacing;
                rho * way.gravity * filled(&inside, height, spacing)
            } else {
                0.0
            }
        };
        self.tops.piles.around(body).map(weight).sum()
    }

    /// Mass of a body on the way up from a place, over the area across it [kg/m^2].
    fn mass(&self, way: &Way, body: &Body, place: &Point, length: f64) -> f64 {
        let rho = self.scene.materials[body.material].material.rest_density();
        let inside = |along: f64| holds(self.scene, body, &way.point(self.scene, place, along));
        rho * filled(&inside, length, self.scene.numerics.spacing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    /// Load at a place of the last of the bodies of a scene with this domain, before walls with these points, if it stands on something [Pa].
    fn load(domain: &str, bodies: &str, place: [f64; 2], walls: &[[f64; 2]]) -> f64 {
        let place = [place[0], place[1], 0.0];
        let walls = &with_normal(walls, [0.0, 1.0]);
        asked(domain, bodies, walls, |loads, body| {
            loads.above(body, &place)
        })
    }

    fn with_normal(points: &[[f64; 2]], normal: [f64; 2]) -> Vec<Support<2>> {
        let of = |place: &[f64; 2]| Support {
            place: *place,
            normal,
            weight: 1.0,
        };
        points.iter().map(of).collect()
    }

    /// Of the loads of a scene and the number of its last body.
    fn asked(
        domain: &str,
        bodies: &str,
        walls: &[Support<2>],
        what: impl Fn(&Loads<'_, 2>, usize) -> f64,
    ) -> f64 {
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
        what(&loads, scene.bodies.len() - 1)
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
    fn what_hangs_in_the_air_bears_nothing() {
        let pressed = |bodies: &str, walls: &[Support<2>]| {
            let domain = "lower = [-0.1, -0.1]\nupper = [0.2, 0.4]\ngravity = 10";
            let low = [0.0525, 0.0025, 0.0];
            asked(domain, bodies, walls, |loads, body| {
                loads.at(body, (0, &low), &low)
            })
        };
        let row = |from: [f64; 2], step: [f64; 2], normal: [f64; 2]| {
            let at = |n: i32| [0, 1].map(|k| from[k] + f64::from(n) * step[k]);
            with_normal(&(-40..40).map(at).collect::<Vec<_>>(), normal)
        };
        let floor = |y: f64, up: f64| row([0.0, y], [0.005, 0.0], [0.0, up]);
        let block = body("z", 0.0, 0.02);
        close(pressed(&block, &floor(-0.0025, 1.0)), 175.0);
        close(pressed(&block, &[]), 0.0);
        close(pressed(&block, &floor(-0.0125, 1.0)), 0.0);
        // A plate bears on either side.
        close(pressed(&block, &floor(-0.0025, -1.0)), 175.0);
        // Beside walls, wherever their points are, and under a lid.
        for phase in 0..10 {
            let from = [-0.0025, 5e-4 * f64::from(phase)];
            let beside = row(from, [0.0, 0.005], [1.0, 0.0]);
            close(pressed(&block, &beside), 0.0);
            // A steep slope bears what lies on it.
            let steep = row(from, [0.0008, -0.005], [0.987, 0.158]);
            close(pressed(&block, &steep), 175.0);
        }
        close(pressed(&block, &floor(0.0225, -1.0)), 0.0);
        // On what stands, and what falls together.
        let pair = body("y", 0.02, 0.05) + &block;
        close(pressed(&pair, &floor(-0.0025, 1.0)), 475.0);
        close(pressed(&pair, &[]), 0.0);
        let apart = body("y", -0.05, -0.02) + &block;
        close(pressed(&apart, &floor(-0.0525, 1.0)), 0.0);
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
