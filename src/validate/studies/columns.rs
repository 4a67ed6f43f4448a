//! `columns`: the six columns of [A] Table 3 in the plane, default scheme, five seeds each.

pub(super) mod axisymmetric;
mod convergence;
mod figures;
pub(super) mod paper_a;

use crate::validate::report::number;
use crate::validate::statistics::{first_reaching, mean, spread};
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{Effort, Member, Metric, Recording, Report, Results, Rule, Study, Table};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "columns",
    title: "Collapse of sand columns, planar: run-out, height, stopping, convergence",
    about: "The six columns of Table 3 of Minatti and Paris [A] (Appl. Math. Modelling 39 (2015) 363-376): sand of 0.32 mm, \
half-width r0 = 97.2 mm, height H0 = a r0, planar, released at t = 0 on a floor of the same roughness. The default scheme; five seeds \
of the jittered start each, of which means and spread are taken (spread: standard deviation over mean), at half of [A]'s particle \
spacing, by which run-outs are judged, and at [A]'s own, 15 to 60 to the height, which is too coarse for them; one seed at a quarter.\n\n\
Run-out is (r - r0)/r0 of the front, the mean of both sides, at twice the stopping time 3 sqrt(H0/g) unless said otherwise. \
It is judged against the published *planar* law, (1.2 to 1.8) a below a = 2.3 and (1.9 to 2.3) a^(2/3) above (channel \
experiments: Lube et al. 2005, Phys. Rev. E 72, 041301; Lajeunesse et al. 2005, Phys. Fluids 17, 103302; the band is what \
secondary sources make of their prefactors). Lube's *axisymmetric* law 1.24 a, 1.6 sqrt(a) above a = 1.7 (Lube, Huppert, \
Sparks and Hallworth 2004, J. Fluid Mech. 508, 175-199), against which [A] compares its planar runs, stands beside it.",
    members,
    analyse,
};

const GRAVITY: f64 = 9.81;
/// Half-width [m].
const R0: f64 = 0.0972;
const TEMPLATE: &str = include_str!("../../../cases/validation/column.toml");
/// Kept at every communication point.
pub(super) const SERIES: [&str; 4] = [
    "gauge.front_left.front",
    "gauge.front_right.front",
    "gauge.depth_centre.depth",
    "energy.kinetic",
];
/// Snapshots, over sqrt(H0/g).
const PICTURES: [f64; 5] = [0.0, 1.0, 2.0, 3.0, 6.0];
/// Stopping time over sqrt(H0/g): Lube's and Lajeunesse's.
const STOPPING: f64 = 3.0;

/// A row of [A] Table 3.
#[derive(Clone, Copy)]
struct Column {
    aspect: f64,
    /// H0 [m].
    height: f64,
    /// dp [m].
    spacing: f64,
}

const COLUMNS: [Column; 6] = [
    column(0.19, 18.5e-3, 1.20e-3),
    column(0.55, 53.5e-3, 2.20e-3),
    column(0.90, 87.5e-3, 3.02e-3),
    column(1.60, 155.5e-3, 3.24e-3),
    column(2.75, 267.3e-3, 4.86e-3),
    column(3.00, 291.6e-3, 4.86e-3),
];

const fn column(aspect: f64, height: f64, spacing: f64) -> Column {
    Column {
        aspect,
        height,
        spacing,
    }
}

impl Column {
    /// Time scale sqrt(H0/g) [s].
    fn fall(&self) -> f64 {
        (self.height / GRAVITY).sqrt()
    }

    fn name(&self, kind: &str, seed: u32) -> String {
        format!("a{:.2}_{kind}seed{seed}", self.aspect)
    }

    /// Smallest and largest published planar run-out.
    fn planar_band(&self) -> (f64, f64) {
        let a = self.aspect;
        if a < 2.3 {
            (1.2 * a, 1.8 * a)
        } else {
            (1.9 * a.powf(2.0 / 3.0), 2.3 * a.powf(2.0 / 3.0))
        }
    }

    /// Lube's axisymmetric run-out.
    fn axisymmetric(&self) -> f64 {
        let a = self.aspect;
        if a < 1.7 { 1.24 * a } else { 1.6 * a.sqrt() }
    }

    /// Room for a run-out a quarter beyond the largest published planar one [m].
    fn reach(&self, spacing: f64) -> f64 {
        R0 * (1.0 + 1.25 * self.planar_band().1) + 10.0 * spacing
    }

    /// Times of the pictures, of the first seed only [s].
    fn pictures(&self, seed: u32) -> Vec<f64> {
        let times = PICTURES.iter().filter(|_| seed == 1);
        times.map(|t| t * self.fall()).collect()
    }

    /// When run-outs are taken: twice the stopping time [s].
    fn twice_stopping(&self) -> f64 {
        2.0 * STOPPING * self.fall()
    }

    fn template(&self, seed: u32, spacing: f64, until: f64) -> Result<Template, String> {
        let reach = self.reach(spacing);
        Ok(scene([R0, self.height], spacing, reach)?
            .with("numerics.seed", i64::from(seed))
            .with("run.step", self.fall() / 20.0)
            .with("run.until", until))
    }

    fn member(&self, name: String, seed: u32, spacing: f64, until: f64) -> Result<Member, String> {
        let text = self.template(seed, spacing, until)?.text()?;
        let pictures = self.pictures(seed);
        Ok(Member::new(name, text, &SERIES, pictures))
    }
}

/// The template with a column of this half-width and height, and room to run out to `reach` on both sides [m].
pub(super) fn scene(size: [f64; 2], spacing: f64, reach: f64) -> Result<Template, String> {
    let [half_width, height] = size;
    Ok(Template::new(TEMPLATE)?
        .with("domain.lower", point(-reach, -8.0 * spacing))
        .with("domain.upper", point(reach, 1.2 * height + 8.0 * spacing))
        .with("numerics.spacing", spacing)
        .with(
            "bodies.column.box",
            rectangle([-half_width, 0.0], [half_width, height]),
        )
        .with(
            "walls.floor.polyline",
            points(&[[-reach, 0.0], [reach, 0.0]]),
        ))
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let mut members = Vec::new();
    let seeds = effort.pick(5, 2);
    for column in COLUMNS {
        // To ten stopping times, for the creep of the pile.
        let until = effort.pick(10.0, 2.0) * STOPPING * column.fall();
        let spacing = effort.pick(1.0, 2.5) * column.spacing;
        for seed in 1..=seeds {
            members.push(column.member(column.name("", seed), seed, spacing, until)?);
        }
    }
    members.extend(convergence::members(effort)?);
    Ok(members)
}

/// Front over time, mean of the sides that were kept [m].
pub(super) fn front(recording: &Recording) -> Vec<(f64, f64)> {
    let right = recording.curve("gauge.front_right.front");
    let left = recording.curve("gauge.front_left.front");
    let left = if left.is_empty() { &right } else { &left };
    let pairs = left.iter().zip(&right);
    pairs.map(|(l, r)| (l.0, 0.5 * (l.1 + r.1))).collect()
}

/// Run-out at the communication point nearest to a time [s].
fn run_out(recording: &Recording, time: f64) -> Option<f64> {
    let far = |p: &(f64, f64)| (p.0 - time).abs();
    let front = front(recording);
    let nearest = front.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
    Some((nearest.1 - R0) / R0)
}

/// What the seeds of one column gave.
struct Seeds {
    run_outs: Vec<f64>,
    late: Vec<f64>,
    heights: Vec<f64>,
    stops: Vec<f64>,
}

fn seeds(results: &Results, column: &Column, kind: &str) -> Seeds {
    let prefix = column.name(kind, 0);
    let prefix = prefix.trim_end_matches('0');
    let twice = column.twice_stopping();
    let mut seeds = Seeds {
        run_outs: Vec::new(),
        late: Vec::new(),
        heights: Vec::new(),
        stops: Vec::new(),
    };
    for (_, recording) in results.starting(prefix) {
        seeds.run_outs.extend(run_out(recording, twice));
        seeds.late.extend(
            recording
                .time
                .last()
                .and_then(|&end| run_out(recording, end)),
        );
        seeds
            .heights
            .extend(recording.last("gauge.depth_centre.depth").map(|h| h / R0));
        // Stopped: 99 % of the way of the front done.
        let front = front(recording);
        let end = R0 + 0.99 * (front.last().map_or(R0, |p| p.1) - R0);
        seeds
            .stops
            .extend(first_reaching(&front, end).map(|t| t / column.fall()));
    }
    seeds
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    for column in &COLUMNS {
        report.metrics.extend(convergence::judge(results, column));
        report.metrics.extend(judge(results, column));
    }
    report.tables.push(other_laws(results));
    let laws = COLUMNS.iter().map(|c| (c, c.name("", 1), c.planar_band()));
    let fronts = figures::fronts(results, &laws.collect::<Vec<_>>())?;
    report.figures.push(fronts);
    for column in &COLUMNS {
        report
            .figures
            .extend(figures::pictures(results, column, &column.name("", 1)));
    }
    report.notes.push(
        "A planar column is another experiment than a round one: its material cannot spread sideways. The planar law is the \
         one that judges here; the axisymmetric one stands beside it because [A] compares with it."
            .to_owned(),
    );
    Ok(report)
}

fn judge(results: &Results, column: &Column) -> Vec<Metric> {
    let a = column.aspect;
    let found = seeds(results, column, "");
    let early = mean(&found.run_outs);
    let drift = mean(&found.late)
        .zip(early)
        .map(|(late, early)| (late / early - 1.0).abs());
    vec![
        Metric::new(
            format!("a = {a:.2}: run-out at [A]'s spacing, against Lube's axisymmetric law"),
            early,
            Rule::Report(Some(column.axisymmetric())),
            "Lube et al. 2004, round columns: another geometry, not judged",
        ),
        Metric::new(
            format!("a = {a:.2}: spread of run-outs at [A]'s spacing"),
            spread(&found.run_outs),
            Rule::AtMost(0.03),
            "as at half of it",
        ),
        Metric::new(
            format!("a = {a:.2}: change of run-out from 2 to 10 stopping times"),
            drift.filter(|_| results.effort == Effort::Full),
            Rule::AtMost(0.005),
            "a pile at rest does not creep",
        ),
    ]
}

/// Heights and stopping times beside published laws: for other geometries or from secondary sources, so not judged.
fn other_laws(results: &Results) -> Table {
    let text = |value: Option<f64>| value.map_or("-".to_owned(), number);
    let rows = COLUMNS.iter().map(|column| {
        let found = seeds(results, column, "");
        let a = column.aspect;
        let lube = if a < 1.0 { a } else { 0.88 * a.powf(1.0 / 6.0) };
        let planar = if a < 0.7 { a } else { a.cbrt() };
        vec![
            format!("{a:.2}"),
            text(mean(&found.heights)),
            number(planar),
            number(lube),
            text(mean(&found.stops)),
            "3 to 3.3".to_owned(),
            text(mean(&found.run_outs)),
            text(spread(&found.run_outs)),
        ]
    });
    let head = [
        "a",
        "height / r0",
        "Lajeunesse 2005, planar",
        "Lube 2004, axisymmetric",
        "stops at t sqrt(g/H0)",
        "experiments",
        "run-out",
        "spread",
    ];
    Table {
        title: "Heights and stopping times, means of seeds, beside published laws".to_owned(),
        head: head.map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn run_outs_of_known_fronts() {
        let mut recording = Recording::empty("key".to_owned());
        recording.time = vec![0.0, 1.0, 2.0];
        let column = |values: [f64; 3]| values.map(|v| vec![v * R0]).to_vec();
        let right = column([1.0, 2.0, 3.0]);
        recording
            .series
            .insert("gauge.front_right.front".to_owned(), right);
        // One side alone, as in axisymmetric runs, and both.
        assert!((run_out(&recording, 1.1).unwrap() - 1.0).abs() < 1e-12);
        let left = column([1.0, 1.5, 2.0]);
        recording
            .series
            .insert("gauge.front_left.front".to_owned(), left);
        assert!((run_out(&recording, 9.0).unwrap() - 1.5).abs() < 1e-12);
        assert_eq!(run_out(&Recording::empty("key".to_owned()), 1.0), None);
    }

    #[test]
    fn laws_are_the_published_ones() {
        assert!((COLUMNS[2].axisymmetric() - 1.116).abs() < 1e-12);
        assert!((COLUMNS[5].axisymmetric() - 2.771).abs() < 1e-3);
        let (low, high) = COLUMNS[2].planar_band();
        assert!((low - 1.08).abs() < 1e-12 && (high - 1.62).abs() < 1e-12);
        for column in COLUMNS {
            assert!((column.height / R0 / column.aspect - 1.0).abs() < 0.01);
        }
    }
}
