//! `negative_controls`: runs that a wrong solver would pass, and what must hold whatever the material.

use super::columns::{SERIES, scene as column_scene};
use crate::scene;
use crate::solver::Solver;
use crate::validate::template::{Template, point};
use crate::validate::{Effort, Member, Metric, Recording, Report, Results, Rule, Snapshot, Study};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "negative_controls",
    title: "Negative controls: too rough, too smooth, free fall, a moving frame, a turning block",
    about: "What shows that the other studies can fail: the column a = 0.90 with far too much and far too little friction, at \
six and four sqrt(H0/g); a block without a floor, which must fall at g; and the same column seen from a frame that moves at \
100 m/s (the floor and the sand move together), whose front after 0.2 s must be where it was; and a block of sand with a \
cohesion of 3 kPa that flies and turns at 5 rad/s, by one radian: rigid rotation makes no stress and does not slow down \
(docs/theory.md, T1). What (T1) would cost sand without cohesion in Bagnold's flow, \
[inclined_plane](inclined_plane.md) says.",
    members,
    analyse,
};

const GRAVITY: f64 = 9.81;
/// Column a = 0.90 of [A] Table 3 [m].
const R0: f64 = 0.0972;
const H0: f64 = 0.0875;
const BOOST: f64 = 100.0;
/// Time of the comparison between frames [s].
const SEEN_AT: f64 = 0.2;
/// Spacing of the turning block, 8 and 20 rows [m], and its angular velocity [rad/s].
const TURNING: [(&str, f64); 2] = [("turning", 5e-3), ("turning_fine", 2e-3)];
/// The same block in the plain form.
const PLAIN: &str = "turning_plain";
const SPIN: f64 = 5.0;
const TURNING_BLOCK: &str = include_str!("../../../cases/validation/spin.toml");
const BLOCK: &str = include_str!("../../../cases/validation/free_fall.toml");

fn fall() -> f64 {
    (H0 / GRAVITY).sqrt()
}

fn spacing(effort: Effort) -> f64 {
    effort.pick(3.02e-3, 8e-3)
}

fn column(
    name: &str,
    effort: Effort,
    reach: f64,
    until: f64,
    friction: Option<[f64; 2]>,
) -> Result<Member, String> {
    let mut template = column_scene([R0, H0], spacing(effort), reach)?
        .with("run.step", fall() / 10.0)
        .with("run.until", until);
    if let Some([mu_s, mu_2]) = friction {
        template = template
            .with("materials.sand.static_friction_angle", mu_s.atan())
            .with("materials.sand.dynamic_friction_angle", mu_2.atan());
    }
    Ok(Member::new(
        name.to_owned(),
        template.text()?,
        &SERIES,
        Vec::new(),
    ))
}

/// The column in a frame that moves at `speed` along the floor. Only the right front is read: the domain reaches as far as
/// the sand goes.
fn frame(name: &str, effort: Effort, speed: f64) -> Result<Member, String> {
    let reach = 5.0 * R0;
    let mut template = column_scene([R0, H0], spacing(effort), reach)?
        .with("domain.upper", point(reach + speed * SEEN_AT, 1.5 * H0))
        // The same in both frames; left out, it would follow the speed of the body.
        .with("numerics.sound_speed", 10.0 * (GRAVITY * H0).sqrt())
        .with("bodies.column.velocity", point(speed, 0.0))
        .with("run.step", SEEN_AT / 20.0)
        .with("run.until", SEEN_AT);
    if speed != 0.0 {
        // The floor comes along as a whole: of a belt, which is the default, only the surface would.
        template = template
            .with("walls.floor.motion", "rigid")
            .with("walls.floor.velocity", point(speed, 0.0));
    }
    Ok(Member::new(
        name.to_owned(),
        template.text()?,
        &["gauge.front_right.front"],
        Vec::new(),
    ))
}

fn turning_block(spacing: f64, rotation: &str) -> Result<String, String> {
    Template::new(TURNING_BLOCK)?
        .with("numerics.spacing", spacing)
        .with("numerics.rotation", rotation)
        .text()
}

fn turning(name: &str, spacing: f64, rotation: &str) -> Result<Member, String> {
    Ok(Member::new(
        name.to_owned(),
        turning_block(spacing, rotation)?,
        &["energy.kinetic"],
        vec![0.0, 0.2],
    ))
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let block = Template::new(BLOCK)?.with("run.until", 0.5).text()?;
    let [(coarse, at), (fine, at_fine)] = TURNING;
    Ok(vec![
        turning(coarse, at, "cohesive")?,
        turning(fine, at_fine, "cohesive")?,
        turning(PLAIN, at, "off")?,
        column("rough", effort, 4.0 * R0, 6.0 * fall(), Some([2.0, 2.5]))?,
        column(
            "smooth",
            effort,
            12.0 * R0,
            4.0 * fall(),
            Some([0.01, 0.02]),
        )?,
        frame("at_rest", effort, 0.0)?,
        frame("moving", effort, BOOST)?,
        Member::new(
            "free_fall".to_owned(),
            block,
            &["energy.kinetic"],
            vec![0.5],
        ),
    ])
}

fn run_out(results: &Results, name: &str) -> Option<f64> {
    let recording = results.finished(name)?;
    let sides = [
        recording.last("gauge.front_left.front")?,
        recording.last("gauge.front_right.front")?,
    ];
    Some((0.5 * (sides[0] + sides[1]) - R0) / R0)
}

/// Mean acceleration of a block since the start, over g; and the largest deviation of any particle.
fn acceleration(recording: &Recording) -> Option<(f64, f64)> {
    let last = recording.snapshots.last()?;
    let of = |v: &[f32; 3]| -f64::from(v[1]) / (GRAVITY * last.time);
    let all: Vec<f64> = last.velocity.iter().map(of).collect();
    let mean = crate::validate::statistics::mean(&all)?;
    Some((
        mean,
        all.iter().fold(0.0, |most, a| (a - 1.0).abs().max(most)),
    ))
}

/// Largest gamma over omega of any particle of the turning block as it starts.
fn strain_of_rotation(spacing: f64, rotation: &str) -> Option<f64> {
    let text = turning_block(spacing, rotation).ok()?;
    let scene = scene::parse("spin.toml", &text).ok()?;
    let (plan, mut state) = scene::build::<2>(&scene).ok()?;
    let mut solver = Solver::new(plan, 1);
    solver.start(&mut state);
    Some(solver.shear_rates().fold(0.0, f64::max) / SPIN)
}

/// Angular momentum and angular velocity of the end over those of the start.
fn turned(recording: &Recording) -> Option<[f64; 2]> {
    let spin = |shot: &Snapshot| {
        let (mut spin, mut second) = (0.0, 0.0);
        for (x, v) in shot.position.iter().zip(&shot.velocity) {
            let [x, y] = [f64::from(x[0]), f64::from(x[1])];
            spin += x * f64::from(v[1]) - y * f64::from(v[0]);
            second += x * x + y * y;
        }
        (spin, second)
    };
    let (first, last) = (
        recording.snapshots.first().map(spin)?,
        recording.snapshots.last().map(spin)?,
    );
    let rate = |(spin, second): (f64, f64)| spin / second;
    Some([last.0 / first.0, rate(last) / rate(first)])
}

fn turning_metrics(results: &Results) -> Vec<Metric> {
    let found = |name: &str| results.finished(name).and_then(turned);
    let mut metrics = Vec::new();
    for ((name, spacing), rows) in TURNING.iter().zip([8, 20]) {
        let block = format!("turning block of {rows} rows of {} mm", 1e3 * spacing);
        metrics.push(Metric::new(
            format!("{block}: gamma over omega"),
            found(name).and_then(|_| strain_of_rotation(*spacing, "cohesive")),
            Rule::AtMost(1e-10),
            "rigid rotation makes no strain and so no stress; the largest of all particles at the start, before it spreads",
        ));
        metrics.push(Metric::new(
            format!("{block}: angular momentum after 1 rad"),
            found(name).map(|f| f[0]),
            Rule::Near(1.0, 2e-3),
            "kept; the first of two acoustic steps moves particles at speeds that the solve has not seen",
        ));
        metrics.push(Metric::new(
            format!("{block}: angular velocity then"),
            found(name).map(|f| f[1]),
            Rule::Report(Some(1.0)),
            "it spreads by its own centrifugal force and what the start's lattice presses",
        ));
    }
    let plain = "the block of 8 rows with rotation = \"off\"";
    metrics.push(Metric::new(
        format!("{plain}: gamma over omega"),
        found(PLAIN).and_then(|_| strain_of_rotation(TURNING[0].1, "off")),
        Rule::Report(None),
        "what free faces add in the plain form",
    ));
    metrics.push(Metric::new(
        format!("{plain}: angular velocity after 1 rad"),
        found(PLAIN).map(|f| f[1]),
        Rule::Report(Some(1.0)),
        "angular momentum is given back, but its faces shear",
    ));
    metrics
}

fn analyse(results: &Results) -> Result<Report, String> {
    let law = 1.24 * 0.90;
    let frames = results.finished("at_rest").zip(results.finished("moving"));
    let shift = frames.and_then(|(rest, moving)| {
        let there = moving.last("gauge.front_right.front")? - BOOST * SEEN_AT;
        Some((there - rest.last("gauge.front_right.front")?).abs() / H0)
    });
    let moved = results
        .finished("at_rest")
        .and_then(|r| Some(r.last("gauge.front_right.front")? / R0 - 1.0));
    let block = results.finished("free_fall").and_then(acceleration);
    let mut metrics = vec![
        Metric::new(
            "mu_s = 2.0, mu_2 = 2.5: run-out",
            run_out(results, "rough"),
            Rule::AtMost(0.3),
            "a vertical face still slumps to 63 deg; a run-out like that of sand would mean that friction does nothing",
        ),
        Metric::new(
            "mu_s = 0.01, mu_2 = 0.02: run-out",
            run_out(results, "smooth"),
            Rule::AtLeast(2.0 * law),
            "twice the law for sand: what runs out less is held by something that is not friction",
        ),
        Metric::new(
            "free fall: mean acceleration over g",
            block.map(|b| b.0),
            Rule::Near(1.0, 1e-6),
            "exact; velocities are kept in single precision, 1e-7",
        ),
        Metric::new(
            "free fall: largest deviation of a particle, over g",
            block.map(|b| b.1),
            Rule::Report(Some(0.0)),
            "the block starts with the pressure of its weight and relaxes",
        ),
        Metric::new(
            "frame at 100 m/s: front after 0.2 s, difference over H0",
            shift,
            Rule::AtMost(1e-3),
            "exact invariance; rounding of 100 m/s grows in the flow",
        ),
        Metric::new(
            "the same: way of the front over r0",
            moved,
            Rule::Report(None),
            "it did move",
        ),
    ];
    metrics.extend(turning_metrics(results));
    Ok(Report {
        metrics,
        ..Report::default()
    })
}
