//! `silo`: discharge against D^1.5 over five openings.

pub(super) mod cohesion;
mod evidence;

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::csv;
use crate::validate::report::number;
use crate::validate::statistics::{first_reaching, interpolate, power_law};
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{
    Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Study, Table,
};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "silo",
    title: "Discharge of a flat-bottomed silo: Q = C sqrt(g) D^1.5",
    about: "Five openings D of a planar flat-bottomed silo, 3.5 D wide and filled to 4.5 D, at 20 particles across the opening. \
Material and openings are those of the Basilisk wiki's mu(I) silo (mu_s 0.32, mu_2 0.60, I0 0.40 with the bulk density, so \
0.40/sqrt(phi_max) here; d = L/30, D = 0.314 L to 0.939 L) with L = 0.1 m: D is 9 to 28 grains, and the grain does not grow \
with the opening. Q is the area that leaves per time: mass rate over bulk density and width, the mean while the fill falls \
from 80 to 50 %.\n\n\
C = Q/(sqrt(g) D^1.5) does not depend on D (Beverloo's law in the plane; Staron, Lagrée and Popinet, Phys. Fluids 24 (2012) \
103301, for mu(I)).",
    members,
    analyse,
};

const GRAVITY: f64 = 9.81;
const SERIES: [&str; 2] = ["gauge.discharge.mass", "mass.initial"];
const TEMPLATE: &str = include_str!("../../../cases/validation/silo.toml");
const TABLE: &str = include_str!("../../../cases/reference/silo_basilisk.csv");
/// Unit of length of the published table [m].
const UNIT: f64 = 0.1;
/// Grain diameter d [m].
const GRAIN: f64 = UNIT / 30.0;
/// Half-openings over the unit: those of the table, and one between.
const HALF_OPENINGS: [f64; 5] = [0.157, 0.235125, 0.31325, 0.391375, 0.4695];
/// Bulk density phi_max rho_s [kg/m^3].
const BULK_DENSITY: f64 = 0.6 * 2500.0;
/// Fill between which the rate is taken.
const FILLS: [f64; 2] = [0.8, 0.5];

fn opening(half: f64) -> f64 {
    2.0 * half * UNIT
}

fn name(half: f64) -> String {
    format!("d{:.0}", 1e4 * opening(half))
}

fn member(half: f64, effort: Effort) -> Result<Member, String> {
    let text = scene(opening(half), effort.pick(20.0, 8.0))?.text()?;
    Ok(Member::new(name(half), text, &SERIES, Vec::new()))
}

/// Largest speed that is expected at opening d [m/s].
fn speed(d: f64) -> f64 {
    (2.0 * GRAVITY * 3.0 * d).sqrt()
}

/// A silo of opening d [m] with so many particles across it.
fn scene(d: f64, across: f64) -> Result<Template, String> {
    let spacing = d / across;
    // The wall is four rows deep; the lips fall away below its first row.
    let lip = 5.0 * spacing;
    let (side, floor, bottom) = (1.75 * d, 0.5 * d, -3.0 * d);
    let top = 5.0 * d;
    let left = [
        [-side, top],
        [-side, 0.0],
        [-floor, 0.0],
        [-floor - 0.8 * lip, -lip],
    ];
    let right = [
        [floor + 0.8 * lip, -lip],
        [floor, 0.0],
        [side, 0.0],
        [side, top],
    ];
    let below = -lip - 2.0 * spacing;
    // From 1 to 0.4 of the fill at C = 1.1, the slowest expected, and a start of two sqrt(D/g).
    let scale = (d / GRAVITY).sqrt();
    let until = scale * (2.0 + 0.6 * 3.5 * 4.5 / 1.1);
    Ok(Template::new(TEMPLATE)?
        .with("domain.lower", point(-3.0 * d, bottom))
        .with("domain.upper", point(3.0 * d, top + d))
        .with("numerics.spacing", spacing)
        .with("numerics.expected_speed", speed(d))
        .with("materials.grains.static_friction_angle", 0.32_f64.atan())
        .with("materials.grains.dynamic_friction_angle", 0.60_f64.atan())
        .with(
            "materials.grains.inertial_number_scale",
            0.40 / 0.6_f64.sqrt(),
        )
        .with("materials.grains.grain_diameter", GRAIN)
        .with("materials.grains.grain_density", BULK_DENSITY / 0.6)
        .with("bodies.fill.box", rectangle([-side, 0.0], [side, 4.5 * d]))
        .with("walls.left.polyline", points(&left))
        .with("walls.right.polyline", points(&right))
        .with("outflows.drain.lower", point(-3.0 * d, bottom))
        .with("outflows.drain.upper", point(3.0 * d, -2.0 * d))
        .with("gauges.discharge.from", point(-3.0 * d, below))
        .with("gauges.discharge.to", point(3.0 * d, below))
        .with("run.step", scale / 20.0)
        .with("run.until", until))
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    HALF_OPENINGS
        .iter()
        .map(|&half| member(half, effort))
        .chain(evidence::members(effort))
        .collect()
}

/// Mean rate [kg/s] while the fill falls from one share of the whole to another; `None` if it does not get there.
fn rate(recording: &Recording, from: f64, to: f64) -> Option<f64> {
    let gone = recording.curve("gauge.discharge.mass");
    let whole = recording.last("mass.initial")?;
    let reached = |fill: f64| first_reaching(&gone, (1.0 - fill) * whole);
    let (start, end) = (reached(from)?, reached(to)?);
    Some((interpolate(&gone, end)? - interpolate(&gone, start)?) / (end - start))
}

/// Discharge coefficient C.
fn coefficient(recording: &Recording, half: f64) -> Option<f64> {
    let area = rate(recording, FILLS[0], FILLS[1])? / BULK_DENSITY;
    Some(area / (GRAVITY.sqrt() * opening(half).powf(1.5)))
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    let mut rates = Vec::new();
    for half in HALF_OPENINGS {
        let recording = results.finished(&name(half));
        let found = recording.and_then(|r| coefficient(r, half));
        let d = 1e3 * opening(half);
        report.metrics.push(Metric::new(
            format!("D = {d:.1} mm: C"),
            found,
            Rule::Near(1.45, 0.12),
            "fits of the published table lie from 1.435 to 1.504; the band holds them and a grid cell's offset",
        ).changed_by(evidence::changes(results, half)));
        let drift =
            recording.and_then(|r| Some(rate(r, 0.65, FILLS[1])? / rate(r, FILLS[0], 0.65)? - 1.0));
        report.metrics.push(Metric::new(
            format!("D = {d:.1} mm: rate from 65 to 50 % over that from 80 to 65 %, less 1"),
            drift,
            Rule::Report(Some(0.0)),
            "the fill does not matter while it is higher than 1.2 widths",
        ));
        rates.extend(found.map(|c| (opening(half), evidence::area_rate(c, half))));
    }
    let fit = (rates.len() == HALF_OPENINGS.len())
        .then(|| power_law(&rates))
        .flatten();
    report.metrics.push(
        Metric::new(
            "exponent of D over the five openings",
            fit.map(|f| f.0),
            Rule::Near(1.5, 0.05),
            "Beverloo's law in the plane, for openings of many grains",
        )
        .changed_by(evidence::changes_of_exponent(results)),
    );
    report.metrics.extend(evidence::offset(&rates));
    let published = csv::columns(TABLE, ["W", "Q"])?;
    report.tables.push(table(&published, results));
    report.tables.push(evidence::table(results));
    report.figures.push(figure(&published, &rates)?);
    report.notes.push(
        "The published runs resolve the narrowest opening by eight grid cells: their C falls from 1.69 to 1.52 as D grows, and \
         with an offset of one cell their fit is 1.435 (D + cell)^1.5. They are shown, not judged by."
            .to_owned(),
    );
    report.notes.push(evidence::NOTE.to_owned());
    Ok(report)
}

fn table(published: &[[f64; 2]], results: &Results) -> Table {
    let row = |half: &f64| {
        let found = results
            .finished(&name(*half))
            .and_then(|r| coefficient(r, *half));
        let known = published.iter().find(|row| row[0] == *half);
        let known = known.map(|[w, q]| q / (2.0 * w).powf(1.5));
        let text = |value: Option<f64>| value.map_or("-".to_owned(), number);
        vec![
            number(opening(*half) * 1e3),
            number(2.0 * half * 30.0),
            text(found),
            text(known),
        ]
    };
    Table {
        title: "C beside the published table".to_owned(),
        head: [
            "D [mm]",
            "D / d",
            "C computed",
            "C published, 26 cells a unit",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: HALF_OPENINGS.iter().map(row).collect(),
    }
}

fn figure(published: &[[f64; 2]], rates: &[(f64, f64)]) -> Result<Figure, String> {
    // The table's Q is over sqrt(g) L^1.5.
    let scale = GRAVITY.sqrt() * UNIT.powf(1.5);
    let known = published
        .iter()
        .map(|[w, q]| (opening(*w) * 1e3, q * scale));
    let law = (0..=40).map(|k| f64::from(k) / 40.0 * 0.1);
    let law = law.map(|d| (d * 1e3, 1.45 * GRAVITY.sqrt() * d.powf(1.5)));
    let found = rates.iter().map(|(d, q)| (d * 1e3, *q));
    let chart = Chart {
        x: "D [mm]".to_owned(),
        y: "Q [m2/s]".to_owned(),
        curves: vec![
            Curve::new("computed", found.collect(), Look::Dots, 0),
            Curve::new("published, grid-limited", known.collect(), Look::Dots, 1),
            Curve::new("1.45 sqrt(g) D^1.5", law.collect(), Look::Thin, 6),
        ],
    };
    Ok(Figure {
        name: "rates".to_owned(),
        caption: "Area rate over opening.".to_owned(),
        svg: chart.svg()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A silo that empties at the rate of C = 1.4 from t = 0.1 s on.
    #[test]
    fn the_coefficient_of_a_known_discharge_is_found() {
        let half = HALF_OPENINGS[2];
        let rate_known = 1.4 * GRAVITY.sqrt() * opening(half).powf(1.5) * BULK_DENSITY;
        let whole = 3.5 * 4.5 * opening(half).powi(2) * BULK_DENSITY;
        let mut recording = Recording::empty("key".to_owned());
        recording.outcome = crate::validate::Outcome::Finished;
        recording.time = (0..200).map(|k| f64::from(k) * 0.01).collect();
        let gone = recording
            .time
            .iter()
            .map(|t| vec![(rate_known * (t - 0.1).max(0.0)).min(whole)]);
        recording
            .series
            .insert("gauge.discharge.mass".to_owned(), gone.collect());
        recording
            .series
            .insert("mass.initial".to_owned(), vec![vec![whole]; 200]);
        let found = coefficient(&recording, half).unwrap();
        assert!((found - 1.4).abs() < 1e-9, "{found}");
        let slower = recording.series["gauge.discharge.mass"]
            .iter()
            .map(|m| vec![0.4 * m[0].min(0.7 * whole)]);
        let slower = slower.collect();
        recording
            .series
            .insert("gauge.discharge.mass".to_owned(), slower);
        assert_eq!(
            coefficient(&recording, half),
            None,
            "it never falls to 50 %"
        );
    }
}
