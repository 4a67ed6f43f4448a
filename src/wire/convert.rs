//! Component → messages: outputs, figures of a step, particles. Pure: nothing is kept but the plan of which variables
//! are outputs.

use super::foxglove::{
    FrameTransform, NumericType, PackedElementField, PointCloud, Pose, Quaternion, Vector3,
};
use super::messages::{Gauge, MassLedger, StepStats, Validity};
use crate::component::{self, Causality, Component, StepReport, ValueReference, VariableTable};
use crate::scene::Wall;
use nalgebra::{Unit, UnitQuaternion};
use prost_types::Timestamp;

/// The frame of all positions.
pub const WORLD: &str = "world";

/// Simulated time as whole nanoseconds, the way keys, `log_time` and messages have it; times before 0 give 0.
#[must_use]
pub fn nanoseconds(time: f64) -> u64 {
    // `as` saturates: negative and NaN give 0.
    (time * 1e9).round() as u64
}

/// Simulated time for viewers.
#[must_use]
pub fn timestamp(time: f64) -> Timestamp {
    let total = (time * 1e9).round() as i64;
    Timestamp {
        seconds: total.div_euclid(1_000_000_000),
        nanos: total.rem_euclid(1_000_000_000) as i32,
    }
}

/// One output of the table: what [`Gauge`] messages are made of.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Handle of the values.
    pub reference: ValueReference,
    /// Name in the table.
    pub name: String,
    /// SI unit.
    pub unit: &'static str,
    /// Number of values.
    pub len: usize,
    /// Handle of the flag that says whether it is a measurement.
    pub validity: Option<ValueReference>,
}

/// All outputs in order of reference: arrays whole (no element rows), validity flags with their gauge.
#[must_use]
pub fn outputs(table: &VariableTable) -> Vec<Output> {
    table
        .rows()
        .iter()
        .filter(|v| v.causality == Causality::Output && v.element_of.is_none())
        .filter(|v| !v.name.ends_with(".validity"))
        .map(|v| Output {
            reference: v.reference,
            name: v.name.clone(),
            unit: v.unit,
            len: v.len(),
            validity: v
                .name
                .rsplit_once('.')
                .and_then(|(device, _)| table.by_name(&format!("{device}.validity")))
                .map(|flag| flag.reference),
        })
        .collect()
}

/// The message of one output as the component stands.
///
/// # Errors
/// Those of [`Component::get`]: the output is of another component's table.
pub fn gauge(
    component: &Component,
    output: &Output,
    step: u64,
    sequence: u64,
) -> Result<Gauge, component::Error> {
    let mut values = vec![0.0; output.len];
    component.get(&[output.reference], &mut values)?;
    let mut flag = [0.0];
    if let Some(validity) = output.validity {
        component.get(&[validity], &mut flag)?;
    }
    Ok(Gauge {
        timestamp: Some(timestamp(component.time())),
        time: component.time(),
        step,
        sequence,
        name: output.name.clone(),
        unit: output.unit.to_owned(),
        values,
        validity: Validity::try_from(flag[0] as i32).unwrap_or(Validity::Blocked) as i32,
    })
}

/// Figures of the solver as the component stands; `report` of the step that led here, if one did.
#[must_use]
pub fn step_stats(component: &Component, report: Option<&StepReport>, sequence: u64) -> StepStats {
    let figures = component.statistics();
    let ledger = component.ledger();
    let saturated = |count: u64| u32::try_from(count).unwrap_or(u32::MAX);
    StepStats {
        timestamp: Some(timestamp(component.time())),
        time: component.time(),
        step: figures.communication_steps,
        sequence,
        substeps: report.map_or(0, |r| saturated(r.substeps)),
        smallest_step: report.map_or(0.0, |r| r.smallest_step),
        bound_by: report.map_or("", |r| r.bound_by.name()).to_owned(),
        iterations: report.map_or(0, |r| saturated(r.iterations)),
        particles: figures.particles,
        step_size: figures.step_size,
        kinetic_energy: figures.kinetic_energy,
        max_speed: figures.max_speed,
        share_dilute: figures.share_dilute,
        total_substeps: figures.steps,
        total_iterations: figures.iterations,
        ledger: Some(MassLedger {
            initial: ledger.initial,
            inflow: ledger.inflow,
            outflow: ledger.outflow,
            present: ledger.present,
        }),
        share_asleep: figures.share_asleep,
    }
}

/// Names of the packed fields of a particle, each f32, in order.
pub const PARTICLE_FIELDS: [&str; 10] = [
    "x",
    "y",
    "z",
    "vx",
    "vy",
    "vz",
    "pressure",
    "inertial_number",
    "phase",
    "asleep",
];

/// All particles as they are now, ten f32 each ([`PARTICLE_FIELDS`]).
#[must_use]
pub fn point_cloud(component: &Component) -> PointCloud {
    let view = component.particles();
    let stride = 4 * PARTICLE_FIELDS.len();
    let mut data = Vec::with_capacity(stride * view.position.len());
    for i in 0..view.position.len() {
        let [x, y, z] = view.position[i];
        let [vx, vy, vz] = view.velocity[i];
        let (phase, asleep) = (f32::from(view.phase[i]), f32::from(view.asleep[i]));
        let numbers = [
            x,
            y,
            z,
            vx,
            vy,
            vz,
            view.pressure[i],
            view.inertial_number[i],
            phase,
            asleep,
        ];
        for number in numbers {
            data.extend_from_slice(&number.to_le_bytes());
        }
    }
    PointCloud {
        timestamp: Some(timestamp(component.time())),
        frame_id: WORLD.to_owned(),
        pose: Some(pose([0.0; 3], IDENTITY)),
        point_stride: stride as u32,
        fields: PARTICLE_FIELDS
            .iter()
            .enumerate()
            .map(|(i, name)| PackedElementField {
                name: (*name).to_owned(),
                offset: 4 * i as u32,
                r#type: NumericType::Float32 as i32,
            })
            .collect(),
        data,
    }
}

/// Where the frames of gates and of walls that move as a whole are now: a plate moves from its closed place by its actual
/// opening, a wall as its scene says.
///
/// # Errors
/// Those of [`Component::get`].
pub fn frames(component: &Component) -> Result<Vec<FrameTransform>, component::Error> {
    let walls = component.scene().walls.iter().zip(component.wall_times());
    let rigid = walls.filter(|(wall, _)| wall.rigid);
    let mut frames: Vec<FrameTransform> = rigid
        .map(|(wall, time)| FrameTransform {
            timestamp: Some(timestamp(component.time())),
            ..wall_frame(wall, time)
        })
        .collect();
    for (i, gate) in component.scene().gates.iter().enumerate() {
        let mut opening = [0.0];
        component.get(&[component.variables().actual_opening(i)], &mut opening)?;
        let shift = |axis: usize| opening[0] * (gate.to[axis] - gate.from[axis]);
        frames.push(FrameTransform {
            timestamp: Some(timestamp(component.time())),
            parent_frame_id: WORLD.to_owned(),
            child_frame_id: format!("gate.{}", gate.name),
            translation: Some(Vector3 {
                x: shift(0),
                y: shift(1),
                z: shift(2),
            }),
            rotation: Some(IDENTITY),
        });
    }
    Ok(frames)
}

/// Frame of a wall that has moved for `time` [s]: turned by w t about the centre, which has come along.
fn wall_frame(wall: &Wall, time: f64) -> FrameTransform {
    let (angle, centre, [ax, ay, az]) = match wall.rotation {
        Some(r) => (r.rate * time, r.centre, r.axis),
        None => (0.0, [0.0; 3], [0.0, 0.0, 1.0]),
    };
    let axis = Unit::new_normalize(nalgebra::Vector3::new(ax, ay, az));
    let turn = UnitQuaternion::from_axis_angle(&axis, angle);
    let turned = turn * nalgebra::Vector3::from(centre);
    let shift = |k: usize| centre[k] + time * wall.velocity[k] - turned[k];
    FrameTransform {
        timestamp: None,
        parent_frame_id: WORLD.to_owned(),
        child_frame_id: format!("wall.{}", wall.name),
        translation: Some(Vector3 {
            x: shift(0),
            y: shift(1),
            z: shift(2),
        }),
        rotation: Some(Quaternion {
            x: turn.i,
            y: turn.j,
            z: turn.k,
            w: turn.w,
        }),
    }
}

/// No rotation.
pub(super) const IDENTITY: Quaternion = Quaternion {
    x: 0.0,
    y: 0.0,
    z: 0.0,
    w: 1.0,
};

/// A pose.
pub(super) fn pose([x, y, z]: [f64; 3], orientation: Quaternion) -> Pose {
    Pose {
        position: Some(Vector3 { x, y, z }),
        orientation: Some(orientation),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A point of a drum after a quarter turn about a centre that comes along.
    #[test]
    fn a_turning_wall_has_its_frame_where_it_is() {
        let wall = Wall {
            name: "drum".to_owned(),
            geometry: crate::scene::WallGeometry::Box {
                lower: [0.0; 3],
                upper: [1.0; 3],
            },
            slip: crate::scene::Slip::NoSlip,
            rigid: true,
            velocity: [0.5, 0.0, 0.0],
            rotation: Some(crate::scene::Rotation {
                rate: std::f64::consts::FRAC_PI_4,
                centre: [1.0, 2.0, 0.0],
                axis: [0.0, 0.0, 1.0],
            }),
            drive: None,
        };
        let frame = wall_frame(&wall, 2.0);
        let (t, q) = (frame.translation.unwrap(), frame.rotation.unwrap());
        let turn = UnitQuaternion::new_normalize(nalgebra::Quaternion::new(q.w, q.x, q.y, q.z));
        // One to the right of the centre: then above it, and the centre at x = 2.
        let x =
            turn * nalgebra::Vector3::new(2.0, 2.0, 0.0) + nalgebra::Vector3::new(t.x, t.y, t.z);
        assert!(
            (x - nalgebra::Vector3::new(2.0, 3.0, 0.0)).norm() < 1e-12,
            "{x}"
        );
    }

    #[test]
    fn times_become_the_nearest_nanosecond() {
        assert_eq!(nanoseconds(0.1 + 0.2), 300_000_000);
        assert_eq!(nanoseconds(-1.0), 0);
        assert_eq!(
            timestamp(1.25),
            Timestamp {
                seconds: 1,
                nanos: 250_000_000
            }
        );
        assert_eq!(
            timestamp(-0.25),
            Timestamp {
                seconds: -1,
                nanos: 750_000_000
            }
        );
    }
}
