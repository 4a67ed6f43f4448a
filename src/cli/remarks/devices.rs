//! Schedules and devices that do nothing, or not what they look like.

use super::length;
use crate::math::{dot, norm};
use crate::scene::{InputTarget, OutflowPlace, Scene, Wall, WallGeometry};

/// Share of its volume by which material may be squeezed by its weight before forces are those of a spring [1].
const SQUEEZED: f64 = 0.05;

/// Spacings across an outlet below which its rate was not measured: over 8 to 16 of them it is already too low (docs/limits.md) [1].
const LEAST_OUTLET: f64 = 8.0;

/// Remarks on schedules, inflows, gates, steered walls and outflows, none for most scenes.
pub(super) fn devices(scene: &Scene) -> Vec<String> {
    let all = schedules(scene).into_iter().chain(idle_inflows(scene));
    let all = all.chain(high_inflows(scene)).chain(narrow_gates(scene));
    all.chain(idle_drives(scene))
        .chain(thin_outflows(scene))
        .collect()
}

/// The name of an input, what it starts at in the scene and the key that says so, if a schedule sets that aside: a wall's speed at the start is
/// what it has, whatever it is told then.
fn input(scene: &Scene, target: InputTarget) -> (String, f64, &'static str) {
    match target {
        InputTarget::WallDrive(k) => {
            let mut names = scene
                .drives()
                .map(|(w, d)| format!("wall.{}.{}", w.name, d.input()));
            (names.nth(k).unwrap_or_default(), 0.0, "start")
        }
        InputTarget::GateOpening(k) => {
            let gate = &scene.gates[k];
            (format!("gate.{}.opening", gate.name), gate.start, "start")
        }
        InputTarget::InflowRate(k) => {
            let inflow = &scene.inflows[k];
            (format!("inflow.{}.rate", inflow.name), inflow.rate, "rate")
        }
    }
}

/// Schedules that change nothing before the end, and those that set aside what the scene says of the start.
fn schedules(scene: &Scene) -> Vec<String> {
    let until = scene.run.until;
    let told = scene.schedules.iter().filter_map(|schedule| {
        let (name, start, key) = input(scene, schedule.input);
        let first = schedule.points.first()?;
        if first.0 > until {
            return Some(format!(
                "note: schedule of {name}: its first point is at {} s, behind run.until, {until} s: all the time it is {}, the value of\n  \
                 that point. Check its times, or run for longer.",
                first.0, first.1
            ));
        }
        let at_once = schedule.value_at(0.0);
        // What is left out is 0 and says nothing.
        (start != 0.0 && start.to_bits() != at_once.to_bits()).then(|| {
            format!(
                "note: schedule of {name}: it is {at_once} from 0 s on, and {key} = {start} counts for nothing in `sandgate run`: before its\n  \
                 first point a schedule holds that one's value. Let it begin with [0, {start}], or delete {key}."
            )
        })
    });
    told.collect()
}

fn idle_inflows(scene: &Scene) -> Vec<String> {
    let inflows = scene.inflows.iter().enumerate();
    let idle = inflows.filter(|(k, inflow)| {
        let target = InputTarget::InflowRate(*k);
        let mut schedules = scene.schedules.iter();
        let is_fed = schedules.any(|s| s.input == target && s.points.iter().any(|p| p.1 > 0.0));
        inflow.rate <= 0.0 && !is_fed
    });
    let told = idle.map(|(_, inflow)| {
        let name = &inflow.name;
        format!(
            "note: inflow {name}: it lets in nothing in `sandgate run`: its rate is 0 and no schedule raises it. Give inflows.{name}.rate\n  \
             or a schedule of inflow.{name}.rate, unless an orchestrator is to set it."
        )
    });
    told.collect()
}

/// Inflows that could fill a scene deeper than its sound speed, which follows from what is there at the start, is for.
fn high_inflows(scene: &Scene) -> Vec<String> {
    let (up, g) = (scene.up(), norm(&scene.domain.gravity));
    let (c0, wide) = (scene.numerics.sound_speed, |x: &[f64; 2]| [x[0], x[1], 0.0]);
    let lowest = |wall: &Wall| match &wall.geometry {
        WallGeometry::Polyline { points, .. } => {
            let heights = points.iter().map(|x| dot(&wide(x), &up));
            heights.fold(f64::INFINITY, f64::min)
        }
        WallGeometry::Box { lower, upper } => dot(lower, &up).min(dot(upper, &up)),
        WallGeometry::Plane { point, .. } => dot(point, &up),
    };
    let floor = scene.walls.iter().map(lowest).fold(f64::INFINITY, f64::min);
    let told = scene.inflows.iter().filter_map(|inflow| {
        let depth = dot(&inflow.from, &up).max(dot(&inflow.to, &up)) - floor;
        let squeezed = g * depth / (c0 * c0);
        (depth.is_finite() && squeezed > SQUEEZED).then(|| {
            format!(
                "note: inflow {}: its face is {} above the lowest wall, and material as deep would be squeezed by {:.0} % of its volume by its\n  \
                 weight: the sound speed, {:.3} m/s, is for {} of it. If it gets much deeper than that, give numerics.expected_speed = {:.3}.",
                inflow.name,
                length(depth),
                100.0 * squeezed,
                c0,
                length(0.01 * c0 * c0 / g),
                (g * depth).sqrt(),
            )
        })
    });
    told.collect()
}

/// Gates too narrow for grains to pass as they should.
fn narrow_gates(scene: &Scene) -> Vec<String> {
    let has_grains = scene.materials.iter().any(|m| !m.material.is_fluid());
    let gates = scene.gates.iter().filter(|_| has_grains);
    let told = gates.filter_map(|gate| {
        let way: [f64; 3] = std::array::from_fn(|k| gate.to[k] - gate.from[k]);
        let spacings = norm(&way) / scene.numerics.spacing;
        (spacings < LEAST_OUTLET - 1e-9).then(|| {
            format!(
                "note: gate {}: open it is {:.1} spacings wide; narrow outlets let grains out too slowly (docs/limits.md), and nothing is\n  \
                 measured below {LEAST_OUTLET}. Use 15 or more: lower numerics.spacing, or take it for a switch and not for a valve.",
                gate.name, spacings,
            )
        })
    });
    told.collect()
}

fn idle_drives(scene: &Scene) -> Vec<String> {
    let drives = scene.drives().enumerate();
    let idle = drives.filter(|(k, (_, drive))| {
        let target = InputTarget::WallDrive(*k);
        let mut schedules = scene.schedules.iter();
        let is_told = schedules.any(|s| s.input == target && s.points.iter().any(|p| p.1 != 0.0));
        drive.start_value() == 0.0 && !is_told
    });
    let told = idle.map(|(_, (wall, drive))| {
        let name = &wall.name;
        format!(
            "note: wall {name}: it stands still in `sandgate run`: no schedule sets wall.{name}.{}, which is 0 at the start. Give one, unless\n  \
             an orchestrator is to set it.",
            drive.input()
        )
    });
    told.collect()
}

/// Boxes that a particle may be through within a step.
fn thin_outflows(scene: &Scene) -> Vec<String> {
    let spacing = scene.numerics.spacing;
    let told = scene.outflows.iter().filter_map(|outflow| {
        let axes = 0..scene.dimension.axes();
        let OutflowPlace::Box { lower, upper } = outflow.place else {
            return None;
        };
        let sides = axes.map(|k| upper[k] - lower[k]);
        let thickness = sides.fold(f64::INFINITY, f64::min);
        (thickness < spacing * (1.0 - 1e-9)).then(|| {
            format!(
                "note: outflow {}: it is {} thick, less than a spacing, {}: what is fast may pass through it between two steps.\n  \
                 Make it a spacing thick or more.",
                outflow.name,
                length(thickness),
                length(spacing),
            )
        })
    });
    told.collect()
}
