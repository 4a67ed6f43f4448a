//! `film`: films of fluids with and without yield stress on a slope, against their exact profiles; one too thin to flow.

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::report::number;
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{
    Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Study, Table,
};

use super::yield_profile::Layer;

/// The study.
pub(super) const STUDY: Study = Study {
    name: "film",
    title: "Films of fluids on a slope against their exact profiles",
    about: "A film of a fluid of Herschel and Bulkley, tau = tau_0 + K gamma^n, on a slope of 3 degrees without slip, periodic along \
it (10 particles). Down to y_c = tau_0/(rho g sin 3 deg) below the surface it moves as a plug; the profile is that of half a channel \
(study `channel`) driven by G = rho g sin 3 deg. Starts at rest; velocity of all particles over the last quarter of the run, depth \
taken from the exact surface. L2: root of the mean square of u - exact over that of the exact u.\n\n\
A film of clay thinner than its plug stands still: 0.9 of it is judged, with sleep off.",
    members,
    analyse,
};

const SLOPE: f64 = 3.0;
const GRAVITY: f64 = 9.81;
const TEMPLATE: &str = include_str!("../../../cases/validation/film.toml");

/// A film.
#[derive(Clone, Copy, Debug)]
struct Film {
    name: &'static str,
    /// [kg/m^3]
    density: f64,
    /// K [Pa s^n].
    consistency: f64,
    /// n [1].
    index: f64,
    /// tau_0 [Pa].
    yield_stress: f64,
    /// [m]
    depth: f64,
    /// End [s]: shear-thinning fluids take long.
    until: f64,
}

const FILMS: [Film; 4] = [
    Film {
        name: "newton",
        density: 1000.0,
        consistency: 2.0,
        index: 1.0,
        yield_stress: 0.0,
        depth: 0.05,
        until: 6.0,
    },
    Film {
        name: "bingham",
        density: 1000.0,
        consistency: 2.0,
        index: 1.0,
        yield_stress: 10.0,
        depth: 0.05,
        until: 6.0,
    },
    Film {
        name: "power",
        density: 1000.0,
        consistency: 6.0,
        index: 0.5,
        yield_stress: 0.0,
        depth: 0.05,
        until: 14.0,
    },
    CLAY,
];

/// The clay of Monge-Gapper et al. (2024), Table 1.
const CLAY: Film = Film {
    name: "clay",
    density: 1540.0,
    consistency: 4.472,
    index: 0.472,
    yield_stress: 30.0,
    depth: 0.06,
    until: 16.0,
};

/// Rows over the depth.
fn rows(effort: Effort) -> [u32; 3] {
    effort.pick([10, 20, 40], [4, 6, 8])
}

/// Clay that is 0.9 of its own plug deep.
fn still() -> Film {
    Film {
        name: "still",
        depth: 0.9 * CLAY.layer().plug(),
        ..CLAY
    }
}

impl Film {
    fn layer(&self) -> Layer {
        Layer {
            consistency: self.consistency,
            index: self.index,
            yield_stress: self.yield_stress,
            force: self.density * GRAVITY * SLOPE.to_radians().sin(),
            thickness: self.depth,
        }
    }

    fn member(&self, rows: u32) -> Result<Member, String> {
        let dp = self.depth / f64::from(rows);
        let length = 10.0 * dp;
        let text = Template::new(TEMPLATE)?
            .with("domain.lower", point(0.0, -6.0 * dp))
            .with("domain.upper", point(length, 1.5 * self.depth))
            .with("domain.slope", SLOPE.to_radians())
            .with("numerics.spacing", dp)
            .with("materials.fluid.density", self.density)
            .with("materials.fluid.consistency", self.consistency)
            .with("materials.fluid.flow_index", self.index)
            .with("materials.fluid.yield_stress", self.yield_stress)
            .with(
                "bodies.film.box",
                rectangle([0.0, 0.0], [length, self.depth]),
            )
            .with("walls.bed.polyline", points(&[[0.0, 0.0], [length, 0.0]]))
            .with("run.until", self.until)
            .text()?;
        let times = (0..5).map(|k| self.until * (0.75 + 0.0625 * f64::from(k)));
        Ok(Member::new(
            format!("{}_{rows}", self.name),
            text,
            &["energy.kinetic"],
            times.collect(),
        ))
    }

    /// Distance below the surface and velocity of every particle of every snapshot.
    fn profile(&self, recording: &Recording) -> impl Iterator<Item = (f64, f64)> {
        let depth = self.depth;
        recording.snapshots.iter().flat_map(move |s| {
            let rows = s.position.iter().zip(&s.velocity);
            rows.map(move |(x, v)| ((depth - f64::from(x[1])).max(0.0), f64::from(v[0])))
        })
    }
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let counts = rows(effort);
    let mut all = FILMS
        .iter()
        .flat_map(|film| counts.map(|n| film.member(n)))
        .collect::<Result<Vec<_>, _>>()?;
    all.push(still().member(counts[1])?);
    Ok(all)
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    let mut table = Table {
        title: "L2 error of the velocity".to_owned(),
        head: [
            "fluid",
            "rows",
            "exact surface speed [m/s]",
            "L2",
            "plug spread",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: Vec::new(),
    };
    let counts = rows(results.effort);
    for film in &FILMS {
        let found = counts.map(|n| {
            let recording = results.finished(&format!("{}_{n}", film.name));
            recording.and_then(|r| film.layer().errors(film.profile(r)))
        });
        for (n, errors) in counts.iter().zip(found) {
            let Some((l2, spread)) = errors else { continue };
            let plug = film.yield_stress > 0.0;
            table.rows.push(vec![
                film.name.to_owned(),
                n.to_string(),
                number(film.layer().velocity(0.0)),
                number(l2),
                if plug { number(spread) } else { "-".to_owned() },
            ]);
        }
        judge(film, counts, found, &mut report.metrics);
    }
    report.metrics.push(stands(results, counts[1]));
    report.tables.push(table);
    report.figures.push(figure(results, counts[1])?);
    Ok(report)
}

fn judge(film: &Film, counts: [u32; 3], found: [Option<(f64, f64)>; 3], metrics: &mut Vec<Metric>) {
    let l2 = |k: usize| found[k].map(|f| f.0);
    metrics.push(Metric::new(
        format!("{}: L2 of velocity, {} rows", film.name, counts[1]),
        l2(1),
        Rule::AtMost(0.01),
        "asked at 20 rows",
    ));
    metrics.push(Metric::new(
        format!(
            "{}: order from {} to {} rows",
            film.name, counts[0], counts[2]
        ),
        l2(0).zip(l2(2)).map(|(coarse, fine)| {
            (coarse / fine).ln() / (f64::from(counts[2]) / f64::from(counts[0])).ln()
        }),
        Rule::AtLeast(1.5),
        "asked",
    ));
    if film.yield_stress > 0.0 {
        metrics.push(Metric::new(
            format!(
                "{}: spread of the plug's speed, {} rows",
                film.name, counts[1]
            ),
            found[1].map(|f| f.1),
            Rule::AtMost(1e-3),
            "a plug is rigid",
        ));
    }
}

/// The film that is too thin to flow.
fn stands(results: &Results, rows: u32) -> Metric {
    let film = still();
    let fastest = results.finished(&format!("still_{rows}")).map(|r| {
        film.profile(r)
            .fold(0.0, |most: f64, (_, u)| most.max(u.abs()))
    });
    Metric::new(
        "clay 0.9 of its plug deep: fastest particle in the last quarter",
        fastest,
        Rule::AtMost(1e-4),
        "it stands still; 60 mm of it flow at 0.126 m/s",
    )
    .unit("m/s")
}

fn figure(results: &Results, rows: u32) -> Result<Figure, String> {
    let mut curves = Vec::new();
    for (k, film) in FILMS.iter().enumerate() {
        let layer = film.layer();
        let fastest = layer.velocity(0.0);
        let exact = (0..=100).map(|i| {
            let y = f64::from(i) / 100.0;
            (layer.velocity(y * film.depth) / fastest, 1.0 - y)
        });
        let name = format!("{}, exact", film.name);
        curves.push(Curve::new(name, exact.collect(), Look::Thin, k));
        if let Some(recording) = results.finished(&format!("{}_{rows}", film.name)) {
            let dots = film.profile(recording).step_by(7);
            let dots = dots
                .map(|(y, u)| (u / fastest, 1.0 - y / film.depth))
                .collect();
            let name = format!("{}, computed", film.name);
            curves.push(Curve::new(name, dots, Look::Dots, k));
        }
    }
    Ok(Figure {
        name: "profiles".to_owned(),
        caption: format!("Velocity over the exact one at the surface, {rows} rows over the depth"),
        svg: Chart {
            x: "velocity over the exact largest [1]".to_owned(),
            y: "height over depth [1]".to_owned(),
            curves,
        }
        .svg()?,
    })
}
