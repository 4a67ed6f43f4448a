//! Forces that gauges of walls and gates report, and the ways that they work along.

use crate::component::{Component, ValueReference};
use crate::scene::{ForceTarget, GaugeKind, Scene, Slip, Wall};

use super::balance::Before;

/// Gauges of forces: on what, and the handle of each component.
pub(super) fn gauges(
    scene: &Scene,
    component: &Component,
) -> Vec<(ForceTarget, Vec<ValueReference>)> {
    let handle = |gauge: &str, axis: &str| {
        let name = format!("gauge.{gauge}.force_{axis}");
        Some(component.variables().by_name(&name)?.reference)
    };
    let gauges = scene.gauges.iter();
    gauges
        .filter_map(|gauge| match &gauge.kind {
            GaugeKind::Force { on, .. } => {
                let axes = ["x", "y", "z"].into_iter();
                Some((*on, axes.filter_map(|a| handle(&gauge.name, a)).collect()))
            }
            _ => None,
        })
        .collect()
}

/// Way of what a force acts on in a step of h [m].
pub(super) fn way(
    scene: &Scene,
    target: ForceTarget,
    (before, now): (&Before, &Before),
    h: f64,
) -> [f64; 3] {
    match target {
        ForceTarget::Wall(i) => {
            let wall = &scene.walls[i];
            let time = match &wall.drive {
                Some(_) => now.wall_times[i] - before.wall_times[i],
                None => h,
            };
            working_velocity(wall).map(|v| v * time)
        }
        ForceTarget::Gate(i) => {
            let gate = &scene.gates[i];
            let moved = now.openings[i] - before.openings[i];
            std::array::from_fn(|k| (gate.to[k] - gate.from[k]) * moved)
        }
    }
}

/// Velocity of a wall that its force does work at [m/s]. A belt goes nowhere: what works is the shear along its surface, and
/// where that slips freely there is none. What its gauge has along it in a corner is pressure on points that stand still.
fn working_velocity(wall: &Wall) -> [f64; 3] {
    if !wall.rigid && wall.slip == Slip::FreeSlip {
        return [0.0; 3];
    }
    wall.velocity
}
