//! `negative_controls`: runs that a wrong solver would pass, and what must hold whatever the material.

use super::columns::{SERIES, scene};
use crate::validate::template::{Template, point};
use crate::validate::{Effort, Member, Metric, Recording, Report, Results, Rule, Study};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "negative_controls",
    title: "Negative controls: too rough, too smooth, free fall, a moving frame",
    about: "What shows that the other studies can fail: the column a = 0.90 with far too much and far too little friction, at \
six and four sqrt(H0/g); a block without a floor, which must fall at g; and the same column seen from a frame that moves at \
100 m/s (the floor and the sand move together), whose front after 0.2 s must be where it was.",
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
    let mut template = scene([R0, H0], spacing(effort), reach)?
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
    let mut template = scene([R0, H0], spacing(effort), reach)?
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

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let block = Template::new(BLOCK)?.with("run.until", 0.5).text()?;
    Ok(vec![
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
    let metrics = vec![
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
    Ok(Report {
        metrics,
        ..Report::default()
    })
}
