//! `channel`: fluids with and without yield stress between two plates, against their exact profiles.

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::report::number;
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{Effort, Figure, Member, Recording, Report, Results, Rule, Study, Table};

use super::yield_profile::{Asked, CLAY, Fluid, Layer, last_quarter, rows};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "channel",
    title: "Fluids in a channel against their exact profiles",
    about: "A fluid of Herschel and Bulkley, tau = tau_0 + K gamma^n, between two plates 2 b = 40 mm apart, driven by a force G \
per volume, periodic along it (10 particles). Within y_c = tau_0/G of the middle it moves as a plug,\n\n\
    u_p = n/(n + 1) (G/K)^(1/n) (b - y_c)^(1 + 1/n),   u = u_p [1 - ((y - y_c)/(b - y_c))^(1 + 1/n)] outside.\n\n\
Newton's fluid, Bingham's, a power law and the clay of Monge-Gapper et al. (2024), Table 1. Starts at rest; velocity of all particles \
over the last quarter of the run. L2: root of the mean square of u - exact over that of the exact u, for single particles; orders also for the means of rows. `shifting` = 0.5.",
    members,
    analyse,
};

const HALF_WIDTH: f64 = 0.02;
const TEMPLATE: &str = include_str!("../../../cases/validation/channel.toml");

/// A fluid and what drives it.
#[derive(Clone, Copy, Debug)]
struct Flow {
    fluid: Fluid,
    /// G [Pa/m].
    force: f64,
    /// End [s]: as late as to have come within 1e-4 of steady flow a quarter before; shear-thinning fluids take long.
    until: f64,
}

const FLOWS: [Flow; 4] = [
    Flow {
        fluid: Fluid {
            name: "newton",
            density: 1000.0,
            consistency: 1.0,
            index: 1.0,
            yield_stress: 0.0,
        },
        force: 1000.0,
        until: 3.2,
    },
    Flow {
        fluid: Fluid {
            name: "bingham",
            density: 1000.0,
            consistency: 1.0,
            index: 1.0,
            yield_stress: 10.0,
        },
        force: 1000.0,
        until: 3.2,
    },
    Flow {
        fluid: Fluid {
            name: "power",
            density: 1000.0,
            consistency: 2.0,
            index: 0.5,
            yield_stress: 0.0,
        },
        force: 500.0,
        until: 8.0,
    },
    Flow {
        fluid: CLAY,
        force: 2500.0,
        until: 3.2,
    },
];

impl Flow {
    fn layer(&self) -> Layer {
        Layer {
            fluid: self.fluid,
            force: self.force,
            thickness: HALF_WIDTH,
        }
    }

    fn member(&self, rows: u32) -> Result<Member, String> {
        let dp = HALF_WIDTH / f64::from(rows);
        let (length, height) = (10.0 * dp, 2.0 * HALF_WIDTH);
        let edge = 6.0 * dp;
        let text = self
            .fluid
            .pour(Template::new(TEMPLATE)?)
            .with("domain.lower", point(0.0, -edge))
            .with("domain.upper", point(length, height + edge))
            .with(
                "domain.gravity",
                point(self.force / self.fluid.density, -0.3),
            )
            .with("numerics.spacing", dp)
            .with("bodies.fluid.box", rectangle([0.0, 0.0], [length, height]))
            .with("walls.low.polyline", points(&[[0.0, 0.0], [length, 0.0]]))
            .with(
                "walls.high.polyline",
                points(&[[length, height], [0.0, height]]),
            )
            .with("run.until", self.until)
            .text()?;
        Ok(Member::new(
            format!("{}_{rows}", self.fluid.name),
            text,
            &["energy.kinetic"],
            last_quarter(self.until),
        ))
    }
}

const ASKED: Asked = Asked {
    of: "",
    at: "asked at 20 rows to the middle",
    order: Rule::AtLeast(1.5),
    reason: "asked",
};

/// Distance from the middle and velocity of every particle of every snapshot.
fn profile(recording: &Recording) -> impl Iterator<Item = (f64, f64)> {
    recording.snapshots.iter().flat_map(|s| {
        let rows = s.position.iter().zip(&s.velocity);
        rows.map(|(x, v)| (f64::from(x[1]) - HALF_WIDTH, f64::from(v[0])))
    })
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let each = FLOWS
        .iter()
        .flat_map(|flow| rows(effort).map(|n| flow.member(n)));
    each.collect()
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    let mut table = Table {
        title: "L2 error of the velocity".to_owned(),
        head: [
            "fluid",
            "rows to the middle",
            "L2, particles",
            "L2, means of rows",
            "plug spread",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: Vec::new(),
    };
    let counts = rows(results.effort);
    for flow in &FLOWS {
        let found = counts.map(|n| {
            let recording = results.finished(&format!("{}_{n}", flow.fluid.name));
            recording.and_then(|r| {
                let rows = profile(r).map(|(y, u)| (y.abs(), u));
                flow.layer().errors(rows, n)
            })
        });
        for (n, errors) in counts.iter().zip(found) {
            let Some(errors) = errors else { continue };
            table.rows.push(vec![
                flow.fluid.name.to_owned(),
                n.to_string(),
                number(errors.particles),
                number(errors.profile),
                flow.fluid.spread_cell(errors.spread),
            ]);
        }
        report
            .metrics
            .extend(flow.fluid.judge(counts, found, &ASKED));
    }
    report.tables.push(table);
    report.figures.push(figure(results, counts[1])?);
    Ok(report)
}

fn figure(results: &Results, rows: u32) -> Result<Figure, String> {
    let mut curves = Vec::new();
    for (k, flow) in FLOWS.iter().enumerate() {
        let layer = flow.layer();
        let fastest = layer.velocity(0.0);
        let exact = (0..=100).map(|i| {
            let y = HALF_WIDTH * (f64::from(i) / 50.0 - 1.0);
            (1e3 * y, layer.velocity(y.abs()) / fastest)
        });
        curves.push(Curve::new(
            format!("{}, exact", flow.fluid.name),
            exact.collect(),
            Look::Thin,
            k,
        ));
        if let Some(recording) = results.finished(&format!("{}_{rows}", flow.fluid.name)) {
            let dots = profile(recording).step_by(7);
            let dots = dots.map(|(y, u)| (1e3 * y, u / fastest)).collect();
            curves.push(Curve::new(
                format!("{}, computed", flow.fluid.name),
                dots,
                Look::Dots,
                k,
            ));
        }
    }
    Ok(Figure {
        name: "profiles".to_owned(),
        caption: format!(
            "Velocity over the exact speed in the middle, {rows} rows from wall to middle"
        ),
        svg: Chart {
            x: "distance from the middle [mm]".to_owned(),
            y: "velocity over the exact largest [1]".to_owned(),
            curves,
        }
        .svg()?,
    })
}
