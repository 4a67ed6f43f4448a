//! The column a = 0.90 in space, a quarter between planes of symmetry, beside rings of the same spacing.

use super::{COLUMNS, Column, R0, rings};
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::statistics::{interpolate, mean};
use crate::validate::template::Template;
use crate::validate::{Effort, Figure, Member, Metric, Recording, Results, Rule};

const TEMPLATE: &str = include_str!("../../../../../cases/validation/column_quarter.toml");
const SPACE: &str = "space_a0.90";
const RINGS: &str = "rings_a0.90";
/// Fronts of the quarter: along the planes of symmetry and between them.
const FRONTS: [&str; 3] = [
    "gauge.front_x.front",
    "gauge.front_y.front",
    "gauge.front_between.front",
];
/// The front of the rings.
const FRONT: &str = "gauge.front_right.front";
const CENTRE: &str = "gauge.depth_centre.depth";
/// When the two are compared, over sqrt(H0/g): both have stopped.
const END: f64 = 4.0;

const COLUMN: Column = COLUMNS[2];

/// dp such that the height is a whole number of rows, as boxes of rings are filled.
fn spacing(effort: Effort) -> f64 {
    COLUMN.height / effort.pick(38.0, 10.0)
}

pub(super) fn members(effort: Effort) -> Vec<Result<Member, String>> {
    vec![space(effort), ring(effort)]
}

fn member(name: &str, template: Template, fronts: &[&str]) -> Result<Member, String> {
    let text = template
        .with("run.step", COLUMN.fall() / 20.0)
        .with("run.until", END * COLUMN.fall())
        .text()?;
    let series = [fronts, &[CENTRE]].concat();
    Ok(Member::new(name.to_owned(), text, &series, Vec::new()))
}

fn space(effort: Effort) -> Result<Member, String> {
    let spacing = spacing(effort);
    let behind = -8.0 * spacing;
    let reach = 2.5 * R0 + 8.0 * spacing;
    let corner = |x: f64, z: f64| -> toml::Value { vec![x, x, z].into() };
    let template = Template::new(TEMPLATE)?
        .with("domain.lower", corner(behind, behind))
        .with("domain.upper", corner(reach, 1.2 * COLUMN.height))
        .with("numerics.spacing", spacing);
    let mut member = member(SPACE, template, &FRONTS)?;
    // Three times the neighbours.
    member.relative_cost = 5.0;
    Ok(member)
}

fn ring(effort: Effort) -> Result<Member, String> {
    member(RINGS, rings(&COLUMN, spacing(effort), 1)?, &[FRONT])
}

/// Mean of fronts over time [m].
fn position(recording: &Recording, fronts: &[&str]) -> Vec<(f64, f64)> {
    let curves: Vec<_> = fronts.iter().map(|front| recording.curve(front)).collect();
    let at = |k: usize| {
        let values: Option<Vec<f64>> = curves.iter().map(|c| c.get(k).map(|p| p.1)).collect();
        mean(&values?)
    };
    let times = recording.time.iter().enumerate();
    times.filter_map(|(k, t)| Some((*t, at(k)?))).collect()
}

fn run_out(recording: Option<&Recording>, fronts: &[&str]) -> Option<f64> {
    let curve = position(recording?, fronts);
    Some(interpolate(&curve, END * COLUMN.fall())? / R0 - 1.0)
}

pub(super) fn judge(results: &Results) -> Vec<Metric> {
    let (space, rings) = (results.finished(SPACE), results.finished(RINGS));
    let compare = |what: &str, space: Option<f64>, rings: Option<f64>| {
        let rule = rings.map_or(Rule::AtMost(0.0), |r| Rule::NearShare(r, 0.05));
        Metric::new(
            format!("a = 0.90 in space against rings of the same spacing: {what}"),
            rings.and(space),
            rule,
            "the same problem twice, 4 sqrt(H0/g) after its start; mean of three directions",
        )
    };
    let height = |r: Option<&Recording>| r?.last(CENTRE).map(|h| h / COLUMN.height);
    vec![
        compare("run-out", run_out(space, &FRONTS), run_out(rings, &[FRONT])),
        compare("height of the centre over H0", height(space), height(rings)),
    ]
}

pub(super) fn figure(results: &Results) -> Result<Figure, String> {
    let curve = |name: &str, title: &str, fronts: &[&str], colour| {
        let points = results.finished(name).map(|r| position(r, fronts));
        let points = points.unwrap_or_default().into_iter();
        let points = points.map(|(t, x)| (t / COLUMN.fall(), x / R0));
        Curve::new(title, points.collect(), Look::Line, colour)
    };
    let chart = Chart {
        x: "t / sqrt(H0/g)".to_owned(),
        y: "front / r0".to_owned(),
        curves: vec![
            curve(SPACE, "in space, mean of three directions", &FRONTS, 0),
            curve(RINGS, "rings", &[FRONT], 1),
        ],
    };
    Ok(Figure {
        name: "quarter".to_owned(),
        caption: "a = 0.90: front over time in space and of rings.".to_owned(),
        svg: chart.svg()?,
    })
}
