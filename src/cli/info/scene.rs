//! What a scene holds and what it leaves out, for people.

use crate::cli::remarks::remarks;
use crate::cli::run::short;
use crate::component::{Component, StaysAwake};
use crate::material::{Grains, Law, Material, MuI};
use crate::math::norm;
use crate::scene::{
    Dimension, ForceTarget, GaugeKind, OutflowPlace, Scene, Slip, Wall, WallGeometry,
};
use crate::solver::Scheme;

/// Particles, walls, devices, gauges and what is not used.
pub(super) fn describe(scene: &Scene, component: &Component) -> String {
    let mut text = match scene.title.trim() {
        "" => format!("{}\n", scene.name),
        title => format!("{}: {title}\n", scene.name),
    };
    let width = match scene.dimension {
        Dimension::Two => format!("planar, {} m wide", scene.domain.width),
        Dimension::Axisymmetric => "rings about the axis x = 0".to_owned(),
        Dimension::Three => "in space".to_owned(),
    };
    text.push_str(&format!(
        "particles  {} of spacing {} m, {width}; mass {} kg; {} wall and gate particles\n",
        component.statistics().particles,
        scene.numerics.spacing,
        component.ledger().initial,
        component.wall_points().len(),
    ));
    text.push_str(&format!("quality    {}\n", quality(scene)));
    text.push_str(&format!("sound      {}\n", sound(scene)));
    for (body, count) in scene.bodies.iter().zip(scene.body_particles()) {
        text.push_str(&format!(
            "  body     {}: {count} particles of {}\n",
            body.name, scene.materials[body.material].name,
        ));
    }
    for named in &scene.materials {
        let about = material(scene, &named.material);
        text.push_str(&format!("  material {}: {about}\n", named.name));
    }
    for name in &scene.unused_materials {
        text.push_str(&format!(
            "  material {name}: left out, nothing is made of it\n"
        ));
    }
    for line in parts(scene, component) {
        text.push_str(&format!("  {line}\n"));
    }
    text.push_str(&format!("sleep      {}\n", sleep(scene, component)));
    text.push_str(&format!("left out   {}\n", left_out(scene).join("; ")));
    for remark in remarks(scene) {
        text.push_str(&format!("{remark}\n"));
    }
    text
}

/// What resolution the scene's quality picked, and the tolerances beside it.
fn quality(scene: &Scene) -> String {
    let n = &scene.numerics;
    format!(
        "{}: {}, courant {}, solver_tolerance {} (docs/precision.md)",
        scene.quality.name(),
        match scene.quality.resolution() {
            1.0 => "the resolution that the scene gives".to_owned(),
            times => format!(
                "{times} times the resolution that the scene gives, or the nearest that fits its gates, circles and periods"
            ),
        },
        n.courant,
        n.solver_tolerance,
    )
}

/// The sound speed, and the height of material and the speed of which it is ten times as much.
fn sound(scene: &Scene) -> String {
    let c0 = scene.numerics.sound_speed;
    let g = norm(&scene.domain.gravity);
    let height = match g > 0.0 {
        true => format!("for material H = {} m high, ", short(c0 * c0 / (100.0 * g))),
        false => String::new(),
    };
    format!(
        "c0 = {} m/s: {height}for speeds up to {} m/s (c0 = 10 sqrt(g H), 10 v)",
        short(c0),
        short(0.1 * c0)
    )
}

/// Whether the scene sleeps once nothing moves.
fn sleep(scene: &Scene, component: &Component) -> String {
    let never = match component.stays_awake() {
        None => return "once nothing has moved for a while, until an input changes".to_owned(),
        Some(StaysAwake::SwitchedOff) => {
            "numerics.sleep is off, or the scheme has no sleep".to_owned()
        }
        Some(StaysAwake::NoWalls) => "there is no wall to rest on".to_owned(),
        Some(StaysAwake::MovingWalls) => "walls move".to_owned(),
        Some(StaysAwake::Creeping(k)) => {
            format!("material {} may creep on for long", scene.materials[k].name)
        }
    };
    format!("never: {never}")
}

/// The law of a material and what is added to it.
fn material(scene: &Scene, material: &Material) -> String {
    let mut text = law(material);
    if material.cohesion > 0.0 {
        let name = if material.is_fluid() {
            "yield stress"
        } else {
            "cohesion"
        };
        text.push_str(&format!("; {name} {:.4} Pa", material.cohesion));
    }
    text.push_str(&viscosity(scene, material));
    if material.is_saturated() {
        text.push_str(&format!(
            "; saturated by {} kg/m^3: {:.6} kg/m^3 in all",
            material.grains.pore_density,
            material.rest_density()
        ));
    }
    if let Some(speed) = material.sound_speed {
        text.push_str(&format!("; sound {speed} m/s"));
    }
    if material.bulk_friction > 0.0 {
        text.push_str(&format!("; bulk friction {}", material.bulk_friction));
    }
    text
}

fn law(material: &Material) -> String {
    let density = material.rest_density();
    match &material.law {
        Law::MuI(law) => format!("mu(I), {}", mu_i(law, &material.grains)),
        Law::BarkerGray(law) => format!(
            "Barker-Gray mu(I), {}; joined at I = {:.5}",
            mu_i(law.high(), &material.grains),
            law.joint()
        ),
        Law::Fluid => format!("fluid, {density:.6} kg/m^3"),
        Law::ConstantFriction(law) => {
            format!("constant friction, mu {:.4}; {density:.6} kg/m^3", law.mu)
        }
    }
}

fn mu_i(law: &MuI, grains: &Grains) -> String {
    let growth = if law.mu_inf > 0.0 {
        format!(", mu_inf {}", law.mu_inf)
    } else {
        String::new()
    };
    format!(
        "mu_s {:.4} to mu_2 {:.4}, I0 {:.4}{growth}; grains of {} m and {} kg/m^3, volume fraction {} to {}",
        law.mu_s,
        law.mu_2,
        law.inertial_number_scale,
        grains.diameter,
        grains.density,
        grains.phi_max,
        grains.phi_min,
    )
}

/// Viscous stress beside the law; nothing if there is none.
fn viscosity(scene: &Scene, material: &Material) -> String {
    let viscous = &material.viscous;
    if viscous.consistency <= 0.0 {
        return String::new();
    }
    if !viscous.is_linear() {
        return format!(
            "; {} Pa s^n with n = {}",
            viscous.consistency, viscous.flow_index
        );
    }
    let raised = raised_viscosity(scene, material).map_or(String::new(), |raised| {
        format!(", {raised:.3} where it is compressed or hardly moves (artificial_viscosity)")
    });
    format!("; viscosity {} Pa s{raised}", viscous.consistency)
}

/// What a Newton's fluid's viscosity is made up to where it is compressed or hardly moves [Pa s], if that is more than its own.
fn raised_viscosity(scene: &Scene, material: &Material) -> Option<f64> {
    let n = &scene.numerics;
    let dimensions = match scene.dimension {
        Dimension::Three => 3.0,
        Dimension::Two | Dimension::Axisymmetric => 2.0,
    };
    let h = n.smoothing_ratio * n.spacing;
    let computed = material.computed_viscosity(dimensions, h, n.sound_speed);
    (n.scheme == Scheme::Implicit && computed > material.viscous.consistency).then_some(computed)
}

/// Walls, devices and gauges, a line each.
fn parts(scene: &Scene, component: &Component) -> Vec<String> {
    let mut lines = Vec::new();
    for wall in &scene.walls {
        let shape = match &wall.geometry {
            WallGeometry::Polyline { points, closed } => {
                let kind = if *closed { "closed chain" } else { "chain" };
                format!("{kind} of {} points", points.len())
            }
            WallGeometry::Box { .. } => "box".to_owned(),
            WallGeometry::Plane { .. } => "plane".to_owned(),
        };
        lines.push(format!(
            "wall     {}: {shape}, {}{}",
            wall.name,
            slip(wall.slip),
            steering(wall)
        ));
    }
    let plates = scene.numerics.plate_speed();
    for gate in &scene.gates {
        let held = if gate.max_speed > plates {
            format!(" asked, held to {plates:.3} m/s by its step of 0.1 h")
        } else {
            String::new()
        };
        lines.push(format!(
            "gate     {}: opening {} at the start, at most {} m/s{held}, {}",
            gate.name,
            gate.start,
            gate.max_speed,
            slip(gate.slip)
        ));
    }
    for (k, inflow) in scene.inflows.iter().enumerate() {
        let against = match component.inflow_pushes(k) {
            true => "pushes what is before it, as its wall came forward with it",
            false => "comes in where there is room before its face",
        };
        lines.push(format!(
            "inflow   {}: {} kg/s at the start, at most {} kg/s of {}; {against}",
            inflow.name,
            short(inflow.rate),
            short(inflow.max_rate),
            scene.materials[inflow.material].name
        ));
    }
    for outflow in &scene.outflows {
        let place = match outflow.place {
            OutflowPlace::Box { .. } => "",
            OutflowPlace::Outside => ": of all that leaves the domain",
        };
        lines.push(format!("outflow  {}{place}", outflow.name));
    }
    for gauge in &scene.gauges {
        lines.push(format!(
            "gauge    {}: {}",
            gauge.name,
            gauge_kind(scene, &gauge.kind)
        ));
    }
    lines
}

/// How a wall is steered, behind a comma; nothing of others.
fn steering(wall: &Wall) -> String {
    let Some(drive) = &wall.drive else {
        return String::new();
    };
    let ((least, most), unit) = (drive.range(), drive.unit());
    let ramp = match drive.ramp > 0.0 {
        true => format!(", to full speed in {} s", short(drive.ramp)),
        false => String::new(),
    };
    format!(
        ", steered by wall.{}.{} from {} to {} {unit}{ramp}",
        wall.name,
        drive.input(),
        short(least),
        short(most)
    )
}

fn slip(slip: Slip) -> String {
    match slip {
        Slip::NoSlip => "no slip".to_owned(),
        Slip::FreeSlip => "free slip".to_owned(),
        Slip::Friction { coefficient } => format!("friction {coefficient}"),
    }
}

fn gauge_kind(scene: &Scene, kind: &GaugeKind) -> String {
    match kind {
        GaugeKind::Depth { .. } => "depth at a place".to_owned(),
        GaugeKind::Profile { count, .. } => format!("depth at {count} places"),
        GaugeKind::Discharge { .. } => "discharge through a section".to_owned(),
        GaugeKind::Force { on, about } => {
            let what = if about.is_some() {
                "force and moment on"
            } else {
                "force on"
            };
            match on {
                ForceTarget::Wall(wall) => format!("{what} wall {}", scene.walls[*wall].name),
                ForceTarget::Gate(gate) => format!("{what} gate {}", scene.gates[*gate].name),
            }
        }
        GaugeKind::Pressure { .. } => "pressure at a point".to_owned(),
        GaugeKind::Velocity { .. } => "velocity at a point".to_owned(),
        GaugeKind::InterfaceStress { .. } => "shear stress at the top of a material".to_owned(),
        GaugeKind::Front { .. } => "front position".to_owned(),
        GaugeKind::Mass { .. } => "mass in a box".to_owned(),
    }
}

/// What the scene does not use; none of it is computed, stored or allocated.
fn left_out(scene: &Scene) -> Vec<&'static str> {
    let domain = &scene.domain;
    let numerics = &scene.numerics;
    let unused = [
        (scene.dimension.axes() == 2, "the third dimension"),
        (scene.dimension != Dimension::Axisymmetric, "hoop strain"),
        (scene.materials.len() < 2, "further phases (one material)"),
        (
            scene.materials.iter().all(|m| m.material.cohesion == 0.0),
            "cohesion",
        ),
        (
            scene
                .materials
                .iter()
                .all(|m| m.material.bulk_friction == 0.0),
            "bulk friction",
        ),
        (domain.periodic == [false; 3], "periodic sides"),
        (scene.gates.is_empty(), "gates"),
        (scene.inflows.is_empty(), "inflows"),
        (scene.outflows.is_empty(), "outflows"),
        (scene.gauges.is_empty(), "gauges"),
        (scene.schedules.is_empty(), "input schedules"),
        (numerics.density_diffusion == 0.0, "density diffusion"),
        (
            numerics.artificial_viscosity == 0.0
                && !scene
                    .materials
                    .iter()
                    .any(|m| m.material.is_newtonian() && m.material.artificial_viscosity > 0.0),
            "artificial viscosity",
        ),
        (numerics.shifting == 0.0, "shifting"),
        (!scene.has_pore_pressure(), "pore pressure"),
        (numerics.pair_viscosity_share == 0.0, "pair viscosity"),
        (
            scene.log.particles_every == 0.0,
            "particle snapshots in the log",
        ),
    ];
    let list: Vec<_> = unused
        .iter()
        .filter(|(yes, _)| *yes)
        .map(|(_, what)| *what)
        .collect();
    if list.is_empty() {
        vec!["nothing"]
    } else {
        list
    }
}
