//! Whether a scene's particles and walls have room in memory, asked before any of them is made: where memory is not to be had in
//! the middle of that, a process ends.

use crate::boundary::ROWS;
use crate::math::{dot, norm, sub};
#[cfg(feature = "cli")]
use crate::scene::Dimension;
use crate::scene::{Body, Gate, Point, Scene, WallGeometry};
use crate::solver::Scheme;

/// Memory that a particle takes with its neighbour lists, sums and solves, in the plane and in space [B]: as measured, 5.2 and 12.3 kB.
const PARTICLE: [f64; 2] = [5_000.0, 12_000.0];
/// Memory that a point of a wall takes while the walls are made, in the plane and in space [B]: as measured, up to 220 and 290 with
/// a million points, and room for tables that have just grown.
const POINT: [f64; 2] = [300.0, 400.0];

/// Asks for the memory that a scene's particles and walls take, and gives it back.
///
/// # Errors
/// A sentence: there is not so much.
pub(super) fn check_memory<const D: usize>(scene: &Scene) -> Result<(), String> {
    let kind = usize::from(D == 3);
    let (particles, points) = (particles::<D>(scene), points::<D>(scene));
    let bytes = particles * PARTICLE[kind] + points * POINT[kind];
    let mut room: Vec<u8> = Vec::new();
    // What is more than a number holds is refused, too.
    let had = room.try_reserve_exact(bytes as usize);
    // Or the compiler leaves out what nobody reads.
    std::hint::black_box(&room);
    had.map_err(|_| {
        format!(
            "{particles:.0} particles and {points:.0} points of walls take about {:.1} GB of memory, and so much is not to be had: use a \
             coarser spacing (a smaller solver.resolution_scale), smaller bodies or a smaller domain",
            bytes / 1e9
        )
    })
}

#[cfg(feature = "cli")]
impl Scene {
    /// About how many particles its bodies start as, known without making them.
    pub(crate) fn about_particles(&self) -> f64 {
        match self.dimension {
            Dimension::Two | Dimension::Axisymmetric => particles::<2>(self),
            Dimension::Three => particles::<3>(self),
        }
    }
}

/// Particles of all bodies, but for those that a lattice has more or less at a rim.
fn particles<const D: usize>(scene: &Scene) -> f64 {
    let measure = |body: &Body| {
        let level = body.level.map(|height| (scene.up(), height));
        body.shape.measure(level, D, false).unwrap_or_else(|| {
            let (lower, upper) = body.shape.bounds();
            (0..D).map(|k| upper[k] - lower[k]).product()
        })
    };
    let filled: f64 = scene.bodies.iter().map(measure).sum();
    (filled / scene.numerics.spacing.powi(D as i32)).ceil()
}

/// Points of all walls and gates; rather too many than too few.
fn points<const D: usize>(scene: &Scene) -> f64 {
    let walls = scene.walls.iter();
    let walls = walls.map(|wall| wall_points::<D>(scene, &wall.geometry));
    let gates = scene.gates.iter().map(|gate| gate_points::<D>(scene, gate));
    walls.chain(gates).sum::<f64>().ceil()
}

fn wall_points<const D: usize>(scene: &Scene, geometry: &WallGeometry) -> f64 {
    let dp = scene.numerics.spacing;
    let rows = match scene.numerics.scheme {
        Scheme::PaperB(_) => 1.0,
        Scheme::Implicit | Scheme::PaperA(_) => ROWS as f64,
    };
    // What a wall has beyond its ends.
    let beyond = 2.0 * ROWS as f64;
    match geometry {
        WallGeometry::Polyline { points, closed } => {
            let last = points.first().filter(|_| *closed);
            let corners: Vec<&[f64; 2]> = points.iter().chain(last).collect();
            let sides: Vec<[f64; 2]> = corners.windows(2).map(|c| sub(c[1], c[0])).collect();
            let length: f64 = sides.iter().map(norm).sum();
            // A row at a depth is longer at a corner by twice the depth times the tangent of half the angle.
            let turn = |a: &[f64; 2], b: &[f64; 2]| {
                let angle = (a[0] * b[1] - a[1] * b[0]).atan2(dot(a, b));
                (0.5 * angle).tan().abs().min(4.0)
            };
            let turns: f64 = sides.windows(2).map(|s| turn(&s[0], &s[1])).sum();
            rows * (length / dp + rows * turns + beyond)
        }
        WallGeometry::Box { lower, upper } => {
            let count = |k: usize| ((upper[k] - lower[k]) / dp).max(1.0);
            let inner = |k: usize| (count(k) - 2.0 * rows).max(0.0);
            (0..D).map(count).product::<f64>() - (0..D).map(inner).product::<f64>()
        }
        WallGeometry::Plane { normal, .. } => {
            let (lower, upper) = (&scene.domain.lower, &scene.domain.upper);
            // The domain as seen along the axis that the normal is nearest to, and the share of it that the plane is longer.
            let along = (0..D).fold(0, |best, k| {
                if normal[k].abs() > normal[best].abs() {
                    k
                } else {
                    best
                }
            });
            let across = (0..D).filter(|k| *k != along);
            let count = |k: usize| {
                let margin = if scene.domain.periodic[k] {
                    0.0
                } else {
                    beyond
                };
                (upper[k] - lower[k]) / dp + margin
            };
            let seen: f64 = across.map(count).product();
            rows * seen / normal[along].abs()
        }
    }
}

fn gate_points<const D: usize>(scene: &Scene, gate: &Gate) -> f64 {
    let dp = scene.numerics.spacing;
    let length = |from: &Point, to: &Point| norm(&sub(to, from)) / dp + 1.0;
    let across = if D == 3 {
        length(&[0.0; 3], &gate.span)
    } else {
        1.0
    };
    length(&gate.from, &gate.to) * across * (gate.thickness / dp + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Dimension, build, parse};

    /// What is asked for is at least nine tenths of what is made, and no more than half as much again.
    #[test]
    fn what_is_estimated_is_about_what_is_made() {
        let near = |estimate: f64, made: usize| {
            let share = estimate / made as f64;
            assert!((0.9..1.5).contains(&share), "{estimate} for {made}");
        };
        for text in [
            include_str!("../../../cases/silo_gate.toml"),
            include_str!("../../../cases/rotating_drum.toml"),
            include_str!("../../../cases/dam_break_obstacle.toml"),
            include_str!("../../../cases/column_collapse_axisymmetric.toml"),
            include_str!("../../../cases/column_collapse_3d.toml"),
            include_str!("../../../tests/scenes/devices_3d.toml"),
        ] {
            let scene = parse("scene.toml", text).unwrap();
            let (estimates, made) = match scene.dimension {
                Dimension::Three => {
                    let (plan, state) = build::<3>(&scene).unwrap();
                    let gates: usize = plan.plates.iter().map(|p| p.shut().count()).sum();
                    let made = (state.grains.len(), plan.walls.len() + gates);
                    ((particles::<3>(&scene), points::<3>(&scene)), made)
                }
                Dimension::Two | Dimension::Axisymmetric => {
                    let (plan, state) = build::<2>(&scene).unwrap();
                    let gates: usize = plan.plates.iter().map(|p| p.shut().count()).sum();
                    let made = (state.grains.len(), plan.walls.len() + gates);
                    ((particles::<2>(&scene), points::<2>(&scene)), made)
                }
            };
            near(estimates.0, made.0);
            near(estimates.1, made.1);
            #[cfg(feature = "cli")]
            near(scene.about_particles(), made.0);
        }
    }
}
