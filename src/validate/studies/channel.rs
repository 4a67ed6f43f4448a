//! `channel`: fluids with and without yield stress between two plates, against their exact profiles.

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::report::number;
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{
    Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Study, Table,
};

use super::yield_profile::Layer;

/// The study.
pub(super) const STUDY: Study = Study {
    name: "channel",
    title: "Fluids in a channel against their exact profiles",
    about: "A fluid of Herschel and Bulkley, tau = tau_0 + K gamma^n, between two plates 2 b = 40 mm apart, driven by a force G \
per volume, periodic along it (10 particles). Within y_c = tau_0/G of the middle it moves as a plug,\n\n\
    u_p = n/(n + 1) (G/K)^(1/n) (b - y_c)^(1 + 1/n),   u = u_p [1 - ((y - y_c)/(b - y_c))^(1 + 1/n)] outside.\n\n\
Newton's fluid, Bingham's, a power law and the clay of Monge-Gapper et al. (2024), Table 1. Starts at rest; velocity of all particles \
over the last quarter of the run. L2: root of the mean square of u - exact over that of the exact u. `shifting` = 0.5.",
    members,
    analyse,
};

const HALF_WIDTH: f64 = 0.02;
const TEMPLATE: &str = include_str!("../../../cases/validation/channel.toml");

/// A fluid and what drives it.
#[derive(Clone, Copy, Debug)]
struct Flow {
    name: &'static str,
    /// [kg/m^3]
    density: f64,
    /// K [Pa s^n].
    consistency: f64,
    /// n.
    index: f64,
    /// tau_0 [Pa].
    yield_stress: f64,
    /// G [Pa/m].
    force: f64,
    /// End [s]: shear-thinning fluids take long.
    until: f64,
}

const FLOWS: [Flow; 4] = [
    Flow {
        name: "newton",
        density: 1000.0,
        consistency: 1.0,
        index: 1.0,
        yield_stress: 0.0,
        force: 1000.0,
        until: 1.6,
    },
    Flow {
        name: "bingham",
        density: 1000.0,
        consistency: 1.0,
        index: 1.0,
        yield_stress: 10.0,
        force: 1000.0,
        until: 1.6,
    },
    Flow {
        name: "power",
        density: 1000.0,
        consistency: 2.0,
        index: 0.5,
        yield_stress: 0.0,
        force: 500.0,
        until: 4.0,
    },
    Flow {
        name: "clay",
        density: 1540.0,
        consistency: 4.472,
        index: 0.472,
        yield_stress: 30.0,
        force: 2500.0,
        until: 1.6,
    },
];

/// Rows from wall to middle.
fn rows(effort: Effort) -> [u32; 3] {
    effort.pick([10, 20, 40], [4, 6, 8])
}

impl Flow {
    fn layer(&self) -> Layer {
        Layer {
            consistency: self.consistency,
            index: self.index,
            yield_stress: self.yield_stress,
            force: self.force,
            thickness: HALF_WIDTH,
        }
    }

    fn member(&self, rows: u32) -> Result<Member, String> {
        let dp = HALF_WIDTH / f64::from(rows);
        let (length, height) = (10.0 * dp, 2.0 * HALF_WIDTH);
        let edge = 6.0 * dp;
        let text = Template::new(TEMPLATE)?
            .with("domain.lower", point(0.0, -edge))
            .with("domain.upper", point(length, height + edge))
            .with("domain.gravity", point(self.force / self.density, -0.3))
            .with("numerics.spacing", dp)
            .with("materials.fluid.density", self.density)
            .with("materials.fluid.consistency", self.consistency)
            .with("materials.fluid.flow_index", self.index)
            .with("materials.fluid.yield_stress", self.yield_stress)
            .with("bodies.fluid.box", rectangle([0.0, 0.0], [length, height]))
            .with("walls.low.polyline", points(&[[0.0, 0.0], [length, 0.0]]))
            .with(
                "walls.high.polyline",
                points(&[[length, height], [0.0, height]]),
            )
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
}

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
        head: ["fluid", "rows to the middle", "L2", "plug spread"]
            .map(str::to_owned)
            .to_vec(),
        rows: Vec::new(),
    };
    let counts = rows(results.effort);
    for flow in &FLOWS {
        let found = counts.map(|n| {
            let recording = results.finished(&format!("{}_{n}", flow.name));
            recording.and_then(|r| {
                let rows = profile(r).map(|(y, u)| (y.abs(), u));
                flow.layer().errors(rows)
            })
        });
        for (n, errors) in counts.iter().zip(found) {
            if let Some((l2, spread)) = errors {
                let plug = if flow.yield_stress > 0.0 {
                    number(spread)
                } else {
                    "-".to_owned()
                };
                table
                    .rows
                    .push(vec![flow.name.to_owned(), n.to_string(), number(l2), plug]);
            }
        }
        let l2 = |k: usize| found[k].map(|f| f.0);
        report.metrics.push(Metric::new(
            format!("{}: L2 of velocity, {} rows", flow.name, counts[1]),
            l2(1),
            Rule::AtMost(0.01),
            "asked at 20 rows to the middle",
        ));
        report.metrics.push(Metric::new(
            format!(
                "{}: order from {} to {} rows",
                flow.name, counts[0], counts[2]
            ),
            l2(0).zip(l2(2)).map(|(coarse, fine)| {
                (coarse / fine).ln() / (f64::from(counts[2]) / f64::from(counts[0])).ln()
            }),
            Rule::AtLeast(1.5),
            "asked",
        ));
        if flow.yield_stress > 0.0 {
            report.metrics.push(Metric::new(
                format!(
                    "{}: spread of the plug's speed, {} rows",
                    flow.name, counts[1]
                ),
                found[1].map(|f| f.1),
                Rule::AtMost(1e-3),
                "a plug is rigid",
            ));
        }
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
            format!("{}, exact", flow.name),
            exact.collect(),
            Look::Thin,
            k,
        ));
        if let Some(recording) = results.finished(&format!("{}_{rows}", flow.name)) {
            let dots = profile(recording).step_by(7);
            let dots = dots.map(|(y, u)| (1e3 * y, u / fastest)).collect();
            curves.push(Curve::new(
                format!("{}, computed", flow.name),
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
