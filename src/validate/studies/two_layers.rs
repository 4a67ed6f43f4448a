//! `two_layers`: water over silt at rest, whose pressures are known exactly.

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::statistics::mean;
use crate::validate::template::Template;
use crate::validate::{Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Study};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "two_layers",
    title: "Water over silt at rest",
    about: "0.15 m of water over 0.15 m of saturated silt (1990 kg/m^3, 30 degrees) in a box 0.3 m wide, 20 sqrt(H/g) = 3.5 s, sleep \
off. Pressure grows by the weight of what lies above, pore pressure by the water's, and their difference is the buoyant weight \
(1990 - 1000) g a metre of silt. Gauges in the middle of the box, means over the second half; that it is still is judged by the kinetic \
energy and by how far the levels wander.\n\n\
Two things are of the order of a spacing: pressures are those of a surface 0.1 spacings higher, the row at a surface being half \
empty; and the friction law's mean pressure, of which the effective pressure is made, is the vertical one only where sand presses \
sideways as much as down, which water that trembles above it changes in time.",
    members,
    analyse,
};

const TEMPLATE: &str = include_str!("../../../cases/validation/two_layers.toml");
const GRAVITY: f64 = 9.81;
const HEIGHT: f64 = 0.3;
const BED: f64 = 0.15;
const WATER: f64 = 1000.0;
const SILT: f64 = 1990.0;
const UNTIL: f64 = 3.5;
const STEP: f64 = 0.05;
const KINETIC: &str = "energy.kinetic";

/// Rows over the height.
fn rows(effort: Effort) -> [u32; 3] {
    effort.pick([20, 40, 80], [8, 10, 12])
}

/// Pressure gauges and what they should read [Pa].
fn readings() -> [(&'static str, &'static str, f64, f64); 5] {
    let over = WATER * (HEIGHT - BED);
    let total = |y: f64| GRAVITY * (over + SILT * (BED - y));
    let buoyant = |y: f64| GRAVITY * (SILT - WATER) * (BED - y);
    [
        (
            "gauge.total_225.pressure",
            "in the water, 75 mm deep",
            GRAVITY * WATER * 0.075,
            0.01,
        ),
        (
            "gauge.total_75.pressure",
            "in the silt, 75 mm below its top",
            total(0.075),
            0.01,
        ),
        (
            "gauge.pore_75.pressure",
            "pore pressure there",
            GRAVITY * WATER * 0.225,
            0.01,
        ),
        (
            "gauge.effective_75.pressure",
            "effective pressure there",
            buoyant(0.075),
            0.03,
        ),
        (
            "gauge.effective_40.pressure",
            "effective pressure 110 mm below its top",
            buoyant(0.04),
            0.03,
        ),
    ]
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let mut series: Vec<&str> = readings().map(|r| r.0).to_vec();
    series.extend(["gauge.level.depth", "gauge.bed.depth", KINETIC]);
    let each = rows(effort).map(|rows| {
        let text = Template::new(TEMPLATE)?
            .with("numerics.spacing", HEIGHT / f64::from(rows))
            .with("run.step", STEP)
            .with("run.until", UNTIL)
            .text()?;
        Ok(Member::new(
            format!("rows_{rows}"),
            text,
            &series,
            Vec::new(),
        ))
    });
    each.into_iter().collect()
}

/// A variable at every communication point.
fn values(recording: &Recording, name: &str) -> Option<Vec<f64>> {
    let rows = recording.series.get(name)?.iter();
    rows.map(|row| row.first().copied()).collect()
}

/// Of the second half.
fn late(values: &[f64]) -> &[f64] {
    &values[values.len() / 2..]
}

fn judge(rows: u32, found: Option<&Recording>, metrics: &mut Vec<Metric>) {
    let series = |name: &str| found.and_then(|r| values(r, name));
    for (name, what, exact, allowed) in readings() {
        metrics.push(
            Metric::new(
                format!("{rows} rows: pressure {what}")
                    .replace("pressure pore", "pore")
                    .replace("pressure effective", "effective"),
                series(name).and_then(|v| mean(late(&v))),
                Rule::NearShare(exact, allowed),
                "weight of what lies above",
            )
            .unit("Pa"),
        );
    }
    for (name, what, exact) in [
        ("gauge.level.depth", "water level", HEIGHT),
        ("gauge.bed.depth", "level of the silt", BED),
    ] {
        let wander = series(name).map(|v| {
            let far = late(&v).iter().map(|level| (level - exact).abs());
            far.fold(0.0, f64::max) / HEIGHT
        });
        metrics.push(Metric::new(
            format!("{rows} rows: {what}, farthest from where it was filled, over H"),
            wander,
            Rule::AtMost(0.01),
            "it stands still",
        ));
    }
    // For each metre of width: m g H.
    let scale = 0.3 * GRAVITY * HEIGHT * (WATER * (HEIGHT - BED) + SILT * BED);
    metrics.push(Metric::new(
        format!("{rows} rows: largest kinetic energy of the second half over m g H"),
        series(KINETIC).map(|v| late(&v).iter().copied().fold(0.0, f64::max) / scale),
        Rule::AtMost(1e-5),
        "still: speeds below 0.5 % of sqrt(g H)",
    ));
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    let mut curves = Vec::new();
    for (k, rows) in rows(results.effort).into_iter().enumerate() {
        let found = results.finished(&format!("rows_{rows}"));
        judge(rows, found, &mut report.metrics);
        let Some(found) = found else { continue };
        for (j, (name, what, exact, _)) in readings().into_iter().enumerate() {
            let points = values(found, name).unwrap_or_default();
            let points = points.iter().enumerate();
            let points = points.map(|(n, p)| (STEP * n as f64, p / exact)).collect();
            let look = if k == 2 { Look::Line } else { Look::Thin };
            curves.push(Curve::new(format!("{what}, {rows} rows"), points, look, j));
        }
    }
    report.figures.push(Figure {
        name: "pressures".to_owned(),
        caption: "Pressures over the exact ones".to_owned(),
        svg: Chart {
            x: "time [s]".to_owned(),
            y: "pressure over the exact one [1]".to_owned(),
            curves,
        }
        .svg()?,
    });
    Ok(report)
}
