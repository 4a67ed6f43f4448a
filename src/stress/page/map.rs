//! The map of limits: where single settings break.

use super::{machine, table};
use crate::stress::limits::{LimitsRun, Point, Sweep};
use crate::validate::report::number;

pub(super) fn map(limits: &LimitsRun) -> String {
    let mut text = format!(
        "## Limits\n\nOne setting swept, all else by default, in two scenes of 240 to 300 particles: a column of sand of a = 0.9 that \
         collapses (0.4 s, 4.2 sqrt(H/g)), and a level fill in a box that must stay at rest with sleep off (0.4 s). *Reach* is \
         the outermost particle at the end [m], *kinetic* the kinetic energy at the end over M g H, *creep* how far the fill's centre \
         of mass moved in the second half over dp. Measured on {}.",
        machine(&limits.machine)
    );
    for sweep in &limits.sweeps {
        text.push_str(&format!(
            "\n\n**{}**, {} ({}): {}\n\n{}",
            sweep.scene,
            sweep.key,
            sweep.about,
            distance(sweep),
            points(sweep)
        ));
    }
    text
}

/// How far the default is from where it breaks.
fn distance(sweep: &Sweep) -> String {
    let fine = |p: &&Point| p.failed.is_empty();
    let ok: Vec<f64> = sweep.points.iter().filter(fine).map(|p| p.value).collect();
    let below = sweep
        .points
        .iter()
        .filter(|p| p.value < sweep.default && !p.failed.is_empty())
        .map(|p| p.value)
        .fold(f64::NEG_INFINITY, f64::max);
    let above = sweep
        .points
        .iter()
        .filter(|p| p.value > sweep.default && !p.failed.is_empty())
        .map(|p| p.value)
        .fold(f64::INFINITY, f64::min);
    let edge = |limit: f64| {
        if limit.is_finite() {
            format!("breaks at {}", number(limit))
        } else {
            "does not break".to_owned()
        }
    };
    let passes = ok.len();
    format!(
        "{passes} of {} values pass; the default {} {} below and {} above",
        sweep.points.len(),
        number(sweep.default),
        edge(below),
        edge(above)
    )
}

fn points(sweep: &Sweep) -> String {
    let rows: Vec<Vec<String>> = sweep
        .points
        .iter()
        .map(|p| {
            let f = &p.figures;
            vec![
                number(p.value),
                if p.failed.is_empty() {
                    "passes".to_owned()
                } else {
                    format!("**{}**", p.failed.join(", "))
                },
                number(f.reach),
                format!("{:.1e}", f.kinetic),
                format!("{:.1e}", f.creep),
                f.internal_steps.to_string(),
                format!("{:.2}", f.cpu),
            ]
        })
        .collect();
    table(
        &[
            "value",
            "checks",
            "reach [m]",
            "kinetic",
            "creep",
            "steps",
            "CPU s",
        ],
        &rows,
    )
}
