//! `surge`: fronts of collapsing columns of water against two laboratories' measurements.

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::report::MODEL;
use crate::validate::statistics::interpolate;
use crate::validate::template::{Template, rectangle};
use crate::validate::{Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Study};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "surge",
    title: "Surge fronts of collapsing columns of water",
    about: "Columns of water 1 m long and 2 m or 1 m high, let go at once over a dry, smooth floor without friction. Fronts against the \
experiments of Koshizuka and Oka (1996, doi 10.13182/NSE96-A24205; 2 m, brought to this size by Froude's law) and of Martin and Moyce \
(1952, doi 10.1098/rsta.1952.0006; the square column: a = 1 m, Z = x/a at T = t sqrt(g/a)). In the laboratory a diaphragm or gate goes \
first and floors are rough, so that measured fronts start later: times are compared as published, and once more less the one delay \
that makes the largest error smallest.\n\n\
Whether the scheme or the model (water without friction, gone at once) leaves the difference is told by what the result still depends \
on: the spacing, the sound speed, and the arbitrary start (two other seeds), each as the largest change of the front at a measured \
time.",
    members,
    analyse,
};

const TEMPLATE: &str = include_str!("../../../cases/validation/surge.toml");
const FRONT: &str = "gauge.front.front";
const STEP: f64 = 5e-3;

/// A column and its measured front.
struct Column {
    name: &'static str,
    source: &'static str,
    /// [m]
    height: f64,
    /// End [s].
    until: f64,
    /// Time and front; the time in units of `unit` seconds.
    measured: &'static [(f64, f64)],
    unit: f64,
}

impl Column {
    /// Time [s] and front [m] as measured.
    fn measured(&self) -> Vec<(f64, f64)> {
        let points = self.measured.iter();
        points.map(|(t, x)| (t * self.unit, *x)).collect()
    }
}

#[allow(clippy::approx_constant, reason = "a time was measured at 0.6366 s")]
const COLUMNS: [Column; 2] = [
    Column {
        name: "tall",
        source: "Koshizuka and Oka (1996)",
        height: 2.0,
        until: 0.76,
        measured: &[
            (0.0920, 1.128),
            (0.1907, 1.244),
            (0.2663, 1.464),
            (0.3221, 1.695),
            (0.3681, 1.903),
            (0.4140, 2.123),
            (0.4466, 2.365),
            (0.4958, 2.584),
            (0.5219, 2.804),
            (0.5646, 3.034),
            (0.5940, 3.219),
            (0.6366, 3.462),
            (0.6693, 3.704),
            (0.7021, 3.900),
            (0.7513, 4.132),
        ],
        unit: 1.0,
    },
    Column {
        name: "square",
        source: "Martin and Moyce (1952)",
        height: 1.0,
        until: 0.65,
        measured: &[
            (0.430, 1.108),
            (0.614, 1.218),
            (0.796, 1.437),
            (0.970, 1.671),
            (1.137, 1.893),
            (1.292, 2.109),
            (1.442, 2.334),
            (1.621, 2.564),
            (1.757, 2.787),
            (1.929, 3.001),
        ],
        // sqrt(a/g), a = 1 m.
        unit: 0.319_275_4,
    },
];

/// Particles along the column.
fn rows(effort: Effort) -> [u32; 3] {
    effort.pick([25, 50, 100], [8, 10, 12])
}

/// Name, key and value of what is changed at the middle spacing; what it shows.
const CHANGED: [(&str, &str, f64, &str); 3] = [
    // Twice the template's.
    ("stiff", "expected_speed", 12.0, "sound speed doubled"),
    ("seed_2", "seed", 2.0, "another seed"),
    ("seed_3", "seed", 3.0, "a third seed"),
];

fn template(column: &Column, rows: u32) -> Result<Template, String> {
    Ok(Template::new(TEMPLATE)?
        .with("numerics.spacing", 1.0 / f64::from(rows))
        .with(
            "bodies.column.box",
            rectangle([0.0, 0.0], [1.0, column.height]),
        )
        .with("run.step", STEP)
        .with("run.until", column.until))
}

fn member(name: String, template: &Template) -> Result<Member, String> {
    Ok(Member::new(name, template.text()?, &[FRONT], Vec::new()))
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let mut members = Vec::new();
    for column in &COLUMNS {
        for rows in rows(effort) {
            let name = format!("{}_{rows}", column.name);
            members.push(member(name, &template(column, rows)?)?);
        }
        for (name, key, value, _) in CHANGED {
            let base = template(column, rows(effort)[1])?;
            let changed = if key == "seed" {
                base.with("numerics.seed", value as i64)
            } else {
                base.with("numerics.expected_speed", value)
            };
            members.push(member(format!("{}_{name}", column.name), &changed)?);
        }
    }
    Ok(members)
}

/// Time [s] and front [m] at every communication point.
fn history(recording: &Recording) -> Option<Vec<(f64, f64)>> {
    let fronts = recording.series.get(FRONT)?.iter().enumerate();
    fronts
        .map(|(k, front)| Some((STEP * k as f64, *front.first()?)))
        .collect()
}

/// The same of a column's run, if it came to its end.
fn front(results: &Results, column: &Column, run: &str) -> Option<Vec<(f64, f64)>> {
    let found = results.finished(&format!("{}_{run}", column.name));
    found.and_then(history)
}

/// The error with the largest size, with its sign, of a front that starts `delay` [s] later.
fn largest_error(found: &[(f64, f64)], measured: &[(f64, f64)], delay: f64) -> Option<f64> {
    let errors = measured.iter().map(|(t, x)| {
        let front = interpolate(found, (t - delay).max(0.0))?;
        Some(front / x - 1.0)
    });
    let errors: Vec<f64> = errors.collect::<Option<_>>()?;
    errors
        .into_iter()
        .max_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// The delay [s] with the smallest such error, to a millisecond, and that error.
fn best_delay(found: &[(f64, f64)], measured: &[(f64, f64)]) -> Option<(f64, f64)> {
    let delays = (0..=150).map(|k| 1e-3 * f64::from(k));
    let tried = delays.filter_map(|d| Some((d, largest_error(found, measured, d)?)));
    tried.min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

/// Largest change of the front at a measured time, over the first one.
fn largest_change(
    one: &[(f64, f64)],
    other: &[(f64, f64)],
    measured: &[(f64, f64)],
) -> Option<f64> {
    let each = measured
        .iter()
        .map(|(t, _)| Some((interpolate(other, *t)? / interpolate(one, *t)? - 1.0).abs()));
    let each: Vec<f64> = each.collect::<Option<_>>()?;
    each.into_iter().max_by(f64::total_cmp)
}

/// Change from a spacing to the finest, from which that one's own is at most as far, and by each of [`CHANGED`].
fn changes(
    results: &Results,
    column: &Column,
    rows: u32,
    measured: &[(f64, f64)],
) -> Vec<Option<f64>> {
    let of = |name: &str| front(results, column, name);
    let change = |one: &str, other: &str| largest_change(&of(one)?, &of(other)?, measured);
    let [_, middle, fine] = self::rows(results.effort);
    let mut all = vec![change(&rows.min(middle).to_string(), &fine.to_string())];
    all.extend(CHANGED.map(|(name, ..)| change(&middle.to_string(), name)));
    all
}

/// What the result still depends on.
fn dependence(results: &Results, column: &Column, measured: &[(f64, f64)]) -> Vec<Metric> {
    let [_, middle, fine] = rows(results.effort);
    let finer = format!("{fine} particles for {middle}");
    let what = std::iter::once(finer).chain(CHANGED.map(|c| c.3.to_owned()));
    let each = what.zip(changes(results, column, middle, measured));
    let each = each.map(|(what, change)| {
        Metric::new(
            format!(
                "{} column, {what}: largest change of the front",
                column.name
            ),
            change,
            Rule::AtMost(MODEL),
            "what the scheme still has a part in",
        )
    });
    each.collect()
}

/// The front of a column of so many particles against the measured one.
fn against_measured(
    results: &Results,
    column: &Column,
    rows: u32,
    measured: &[(f64, f64)],
) -> [Metric; 3] {
    let found = front(results, column, &rows.to_string());
    let what = format!("{} column, {rows} particles along it", column.name);
    let changes = changes(results, column, rows, measured);
    let [coarse, ..] = self::rows(results.effort);
    // Fronts are asked of two hundred particles to a depth: the coarsest tell the way there.
    let rule = if rows > coarse {
        Rule::Between(-0.05, 0.05)
    } else {
        Rule::Report(None)
    };
    let error = Metric::new(
        format!("{what}: largest error of the front at a measured time"),
        found.as_ref().and_then(|f| largest_error(f, measured, 0.0)),
        rule,
        column.source,
    );
    let delayed = found.as_ref().and_then(|f| best_delay(f, measured));
    let delayed_error = Metric::new(
        format!("{what}: the same, delayed"),
        delayed.map(|d| d.1),
        rule,
        "a front that leads by the same time from first to last moves as fast as the measured one",
    );
    let delay = Metric::new(
        format!("{what}: that delay"),
        delayed.map(|d| d.0),
        Rule::Report(None),
        "the time that it takes to let go and to overcome the floor",
    );
    [
        error.changed_by(changes.clone()),
        delayed_error.changed_by(changes),
        delay.unit("s"),
    ]
}

/// Measured and computed fronts over time.
fn figure(results: &Results, column: &Column) -> Result<Figure, String> {
    let mut curves = vec![Curve::new(column.source, column.measured(), Look::Dots, 6)];
    for (k, rows) in rows(results.effort).into_iter().enumerate() {
        if let Some(found) = front(results, column, &rows.to_string()) {
            let name = format!("{rows} particles");
            curves.push(Curve::new(name, found, Look::Line, k));
        }
    }
    Ok(Figure {
        name: column.name.to_owned(),
        caption: format!("Front of the column {} m high", column.height),
        svg: Chart {
            x: "time [s]".to_owned(),
            y: "front [m]".to_owned(),
            curves,
        }
        .svg()?,
    })
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    for column in &COLUMNS {
        let measured = column.measured();
        for rows in rows(results.effort) {
            let metrics = against_measured(results, column, rows, &measured);
            report.metrics.extend(metrics);
        }
        report
            .metrics
            .extend(dependence(results, column, &measured));
        report.figures.push(figure(results, column)?);
    }
    Ok(report)
}
