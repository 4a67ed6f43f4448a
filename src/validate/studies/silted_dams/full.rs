//! The dam over 66 % silt at full size by both schemes, at one sound speed: what either costs, and how far they are apart.

use super::{difference, own_scheme, rubbing};
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{Effort, Figure, Member, Metric, Report, Results, Rule};

const TEMPLATE: &str = include_str!("../../../../cases/paper_b/silted_dam_66.toml");
/// Gauges at x/L = 0.5, 1.0, 1.7.
const PLACES: [&str; 3] = ["0_5", "1_0", "1_7"];
/// Where the dam stood, and the end of the tank [m].
const DAM: f64 = 1.52;
const TANK: f64 = 6.0;
/// Depths of silt, of all behind the dam, and of water before it [m].
const SILT: f64 = 0.2;
const DEPTH: f64 = 0.3;
const BEFORE: f64 = 0.05;

/// Spacings [mm]; the last is what the time is asked for.
fn spacings(effort: Effort) -> &'static [f64] {
    effort.pick(&[6.0, 3.0], &[30.0])
}

/// Names of the runs by [B]'s scheme and by the default.
fn names(spacing: f64) -> [String; 2] {
    ["paper_b", "default"].map(|scheme| format!("{scheme}_66_{spacing}mm"))
}

pub(super) fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let mut members = Vec::new();
    for &spacing in spacings(effort) {
        let dp = 1e-3 * spacing;
        let rows = |x: f64| (x / dp).round() * dp;
        let (dam, end, silt, full) = (rows(DAM), rows(TANK), rows(SILT), rows(DEPTH));
        let mut theirs = Template::new(TEMPLATE)?
            .with("numerics.spacing", dp)
            .with("numerics.sound_speed", "17.2 m/s")
            .with("bodies.silt.box", rectangle([0.0, 0.0], [dam, silt]))
            .with("bodies.reservoir.box", rectangle([0.0, silt], [dam, full]))
            .with(
                "bodies.downstream.box",
                rectangle([dam, 0.0], [end, rows(BEFORE)]),
            )
            .with(
                "walls.tank.polyline",
                points(&[[0.0, 1.5], [0.0, 0.0], [end, 0.0], [end, 1.5]]),
            )
            .with("gauges.silt_over_sill.upper", point(dam, 0.6))
            .with("run.until", effort.pick(2.0, 0.1));
        for section in ["water_out", "silt_out"] {
            theirs = theirs
                .with(&format!("gauges.{section}.from"), point(dam, 0.0))
                .with(&format!("gauges.{section}.to"), point(dam, 0.6));
        }
        let gauges: Vec<String> = PLACES
            .iter()
            .flat_map(|place| ["level", "silt"].map(|what| gauge(what, place)))
            .collect();
        let gauges: Vec<&str> = gauges.iter().map(String::as_str).collect();
        let own = rubbing(&own_scheme(&theirs));
        for (name, template) in names(spacing).into_iter().zip([theirs, own]) {
            members.push(Member::new(name, template.text()?, &gauges, Vec::new()));
        }
    }
    Ok(members)
}

fn gauge(what: &str, place: &str) -> String {
    format!("gauge.{what}_{place}.depth")
}

pub(super) fn judge(results: &Results, report: &mut Report) -> Result<(), String> {
    for &spacing in spacings(results.effort) {
        let found = names(spacing).map(|name| results.finished(&name));
        let both = found[0].zip(found[1]);
        report.metrics.push(Metric::new(
            format!(
                "66 % silt at {spacing} mm to 2 s: CPU time of `paper_b` over that of the default"
            ),
            both.map(|(theirs, own)| theirs.cpu / own.cpu),
            Rule::AtLeast(2.0),
            "2 asked, 3 aimed at, at 3 mm; both at 17.2 m/s",
        ));
        report.metrics.push(Metric::new(
            format!("66 % silt at {spacing} mm: steps of `paper_b` over those of the default"),
            both.map(|(theirs, own)| theirs.steps as f64 / own.steps as f64),
            Rule::Report(None),
            "what of it the bounds on the step make: viscosity, and half the Courant number",
        ));
        for (what, which) in [("level", "levels"), ("silt", "beds")] {
            let apart = |(theirs, own)| {
                let each = PLACES.map(|place| difference(own, theirs, &gauge(what, place)));
                each.into_iter().flatten().max_by(f64::total_cmp)
            };
            report.metrics.push(
                Metric::new(
                    format!("66 % silt at {spacing} mm: {which} of the default against `paper_b`, the largest rms over 2 s"),
                    both.and_then(apart),
                    Rule::Report(None),
                    "at x/L = 0.5, 1.0 and 1.7; a scheme against a scheme: neither is measured",
                )
                .unit("m"),
            );
        }
    }
    let done = |spacing: &f64| {
        names(*spacing)
            .iter()
            .all(|name| results.finished(name).is_some())
    };
    let Some(finest) = spacings(results.effort)
        .iter()
        .rfind(|spacing| done(spacing))
    else {
        return Ok(());
    };
    for (what, which) in [("level", "levels"), ("silt", "beds")] {
        report.figures.push(figure(results, *finest, what, which)?);
    }
    Ok(())
}

/// Levels or beds at the three places by both schemes.
fn figure(results: &Results, spacing: f64, what: &str, which: &str) -> Result<Figure, String> {
    let mut curves = Vec::new();
    for (name, (look, scheme)) in names(spacing)
        .iter()
        .zip([(Look::Thin, "paper_b"), (Look::Line, "default")])
    {
        let Some(found) = results.finished(name) else {
            continue;
        };
        for (k, place) in PLACES.into_iter().enumerate() {
            let label = format!("{scheme}: x/L = {}", place.replace('_', "."));
            curves.push(Curve::new(label, found.curve(&gauge(what, place)), look, k));
        }
    }
    Ok(Figure {
        name: which.to_owned(),
        caption: format!(
            "66 % silt at {spacing} mm: {which} by the default (thick) and by `paper_b` (thin)"
        ),
        svg: Chart {
            x: "time [s]".to_owned(),
            y: "depth [m]".to_owned(),
            curves,
        }
        .svg()?,
    })
}
