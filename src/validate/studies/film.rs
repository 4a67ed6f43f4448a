//! `film`: films of fluids with and without yield stress on a slope, against their exact profiles; one too thin to flow.

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::report::number;
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{
    Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Study, Table,
};

use super::yield_profile::{Asked, CLAY, Errors, Fluid, Layer, last_quarter, rows};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "film",
    title: "Films of fluids on a slope against their exact profiles",
    about: "A film of a fluid of Herschel and Bulkley, tau = tau_0 + K gamma^n, on a slope of 3 degrees without slip, periodic along \
it (10 particles). Down to y_c = tau_0/(rho g sin 3 deg) below the surface it moves as a plug; the profile is that of half a channel \
(study `channel`) driven by G = rho g sin 3 deg. Starts at rest; velocity of all particles over the last quarter of the run, depth \
taken from the exact surface. L2: root of the mean square of u - exact over that of the exact u, for single particles; orders also for the means of rows.\n\n\
Each at h/dp = 2 and at the default's 1.6. Rows that slide over each other under pressure drag each other on and back as their particles \
pass: at 1.6 a row's velocity swings by some percent of what it differs by from the next row's, an error of first order that rows' means over time \
do not have. The wider kernel does not see single particles pass.\n\n\
A film of clay thinner than its plug stands still: 0.9 of it is judged, with sleep off.",
    members,
    analyse,
};

const SLOPE: f64 = 3.0;
const GRAVITY: f64 = 9.81;
const TEMPLATE: &str = include_str!("../../../cases/validation/film.toml");

/// How wide a film's kernel is, and what is asked of it.
#[derive(Clone, Copy, Debug)]
struct Kernel {
    /// h/dp [1].
    smoothing: f64,
    asked: Asked,
}

/// The kernel that is judged.
const WIDE: Kernel = Kernel {
    smoothing: 2.0,
    asked: Asked {
        of: "",
        at: "asked at 20 rows",
        order: Rule::AtLeast(1.5),
        reason: "asked",
    },
};

/// The default's.
const USUAL: Kernel = Kernel {
    smoothing: 1.6,
    asked: Asked {
        of: ", h/dp 1.6",
        order: Rule::Report(None),
        reason: "rows' velocities swing as particles pass",
        ..WIDE.asked
    },
};

impl Kernel {
    /// Name of a run.
    fn run(&self, fluid: &Fluid, rows: u32) -> String {
        format!("{}_{rows}_h{:.1}", fluid.name, self.smoothing)
    }
}

/// A film.
#[derive(Clone, Copy, Debug)]
struct Film {
    fluid: Fluid,
    /// [m]
    depth: f64,
    /// End [s]: shear-thinning fluids take long.
    until: f64,
}

const FILMS: [Film; 4] = [
    Film {
        fluid: Fluid {
            name: "newton",
            density: 1000.0,
            consistency: 2.0,
            index: 1.0,
            yield_stress: 0.0,
        },
        depth: 0.05,
        until: 6.0,
    },
    Film {
        fluid: Fluid {
            name: "bingham",
            density: 1000.0,
            consistency: 2.0,
            index: 1.0,
            yield_stress: 10.0,
        },
        depth: 0.05,
        until: 6.0,
    },
    Film {
        fluid: Fluid {
            name: "power",
            density: 1000.0,
            consistency: 6.0,
            index: 0.5,
            yield_stress: 0.0,
        },
        depth: 0.05,
        until: 14.0,
    },
    OF_CLAY,
];

const OF_CLAY: Film = Film {
    fluid: CLAY,
    depth: 0.06,
    until: 16.0,
};

/// Clay that is 0.9 of its own plug deep.
fn still() -> Film {
    Film {
        fluid: Fluid {
            name: "still",
            ..CLAY
        },
        depth: 0.9 * OF_CLAY.layer().plug(),
        ..OF_CLAY
    }
}

impl Film {
    fn layer(&self) -> Layer {
        Layer {
            fluid: self.fluid,
            force: self.fluid.density * GRAVITY * SLOPE.to_radians().sin(),
            thickness: self.depth,
        }
    }

    fn member(&self, rows: u32, kernel: &Kernel) -> Result<Member, String> {
        let dp = self.depth / f64::from(rows);
        let length = 10.0 * dp;
        let text = self
            .fluid
            .pour(Template::new(TEMPLATE)?)
            .with("domain.lower", point(0.0, -6.0 * dp))
            .with("domain.upper", point(length, 1.5 * self.depth))
            .with("domain.slope", SLOPE.to_radians())
            .with("numerics.spacing", dp)
            .with("numerics.smoothing_ratio", kernel.smoothing)
            .with(
                "bodies.film.box",
                rectangle([0.0, 0.0], [length, self.depth]),
            )
            .with("walls.bed.polyline", points(&[[0.0, 0.0], [length, 0.0]]))
            .with("run.until", self.until)
            .text()?;
        Ok(Member::new(
            kernel.run(&self.fluid, rows),
            text,
            &["energy.kinetic"],
            last_quarter(self.until),
        ))
    }

    /// Its row in the table of errors.
    fn row(&self, kernel: &Kernel, rows: u32, errors: &Errors) -> Vec<String> {
        vec![
            self.fluid.name.to_owned(),
            number(kernel.smoothing),
            rows.to_string(),
            number(self.layer().velocity(0.0)),
            number(errors.particles),
            number(errors.profile),
            self.fluid.spread_cell(errors.spread),
        ]
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
    let mut all = Vec::new();
    for kernel in [WIDE, USUAL] {
        for film in &FILMS {
            for rows in counts {
                all.push(film.member(rows, &kernel)?);
            }
        }
        all.push(still().member(counts[1], &kernel)?);
    }
    Ok(all)
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    let mut table = Table {
        title: "L2 error of the velocity".to_owned(),
        head: [
            "fluid",
            "h/dp",
            "rows",
            "exact surface speed [m/s]",
            "L2, particles",
            "L2, means of rows",
            "plug spread",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: Vec::new(),
    };
    let counts = rows(results.effort);
    for kernel in [WIDE, USUAL] {
        for film in &FILMS {
            let found = counts.map(|n| {
                let recording = results.finished(&kernel.run(&film.fluid, n));
                recording.and_then(|r| film.layer().errors(film.profile(r), n))
            });
            for (n, errors) in counts.iter().zip(found) {
                table.rows.extend(errors.map(|e| film.row(&kernel, *n, &e)));
            }
            let judged = film.fluid.judge(counts, found, &kernel.asked);
            report.metrics.extend(judged);
        }
        report.metrics.push(stands(results, &kernel, counts[1]));
    }
    report.tables.push(table);
    report.figures.push(figure(results, counts[1])?);
    Ok(report)
}

/// The film that is too thin to flow.
fn stands(results: &Results, kernel: &Kernel, rows: u32) -> Metric {
    let film = still();
    let fastest = results.finished(&kernel.run(&film.fluid, rows)).map(|r| {
        film.profile(r)
            .fold(0.0, |most: f64, (_, u)| most.max(u.abs()))
    });
    Metric::new(
        format!(
            "clay{}, 0.9 of its plug deep: fastest particle in the last quarter",
            kernel.asked.of
        ),
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
        let name = format!("{}, exact", film.fluid.name);
        curves.push(Curve::new(name, exact.collect(), Look::Thin, k));
        if let Some(recording) = results.finished(&WIDE.run(&film.fluid, rows)) {
            let dots = film.profile(recording).step_by(7);
            let dots = dots
                .map(|(y, u)| (u / fastest, 1.0 - y / film.depth))
                .collect();
            let name = format!("{}, computed", film.fluid.name);
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
