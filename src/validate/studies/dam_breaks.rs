//! `dam_breaks`: clear water over a dry and a wet bed, against the shallow-water solutions of Ritter and Stoker.

mod found;

use self::found::{Found, ritter, stoker};
use super::choices::Choice;
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{Effort, Figure, Member, Report, Results, Study};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "dam_breaks",
    title: "Dam breaks of clear water: Ritter and Stoker",
    about: "Water 0.30 m deep is let go at once, over a dry bed and over one 50 mm deep; 4 m of reservoir, free slip. Compared at \
6, 9 and 12 sqrt(H/g) = 1.05, 1.57 and 2.10 s with the exact solutions of the shallow-water equations (hydrostatic pressure, no \
friction):\n\n\
    dry: h = (2 c - x/t)^2/(9 g), c = sqrt(g H);   wet: a plateau of 0.1426 m behind a bore of 1.641 m/s.\n\n\
Water falls from rest at first, which those equations do not know: depths come later than theirs by a time that the fall takes, the same \
for good. It stands beside each place as its lag, (x - x_exact)/(dx/dt): a scheme that is at fault lags more and more. The bore is \
no step: its place is that of a step with the exact plateau that holds the same water.\n\n\
Whether the scheme has a part in what is left is told by the change of each number from one spacing to the next (30 to 60, and from 60 \
to 200 particles over the depth at the first time), and, at the coarsest, by another start and by 1.5 times the sound speed. The finest runs have the first \
2 m of the reservoir, which is what moves until they end at 6 sqrt(H/g).",
    members,
    analyse,
};

const DEPTH: f64 = 0.3;
const GRAVITY: f64 = 9.81;
/// Times of the comparison [sqrt(H/g)].
const TIMES: [f64; 3] = [6.0, 9.0, 12.0];
/// Length of the reservoir [m]: the drop of the surface, which runs back at sqrt(g H), does not reach its end.
const RESERVOIR: f64 = 4.0;
/// The same in runs that end at the first of [`TIMES`].
const SHORT_RESERVOIR: f64 = 2.0;
const WET: f64 = 0.05;
/// Plateau [m], its speed and that of the bore [m/s] for 0.30 m over 0.05 m: Stoker (1957), solved by hand.
const PLATEAU: (f64, f64, f64) = (0.1426, 1.066, 1.641);
const TEMPLATE: &str = include_str!("../../../cases/validation/dam_break.toml");
const FIRST_FOOT: f64 = -3.9;
const SHORT_FIRST_FOOT: f64 = -1.9;
const FEET: f64 = 0.02;
const SURFACE: &str = "gauge.surface.depth";

/// sqrt(H/g) [s].
fn unit() -> f64 {
    (DEPTH / GRAVITY).sqrt()
}

/// Particles over the depth.
fn rows(effort: Effort) -> [u32; 3] {
    effort.pick([30, 60, 200], [12, 18, 24])
}

/// Times that runs with so many particles over the depth are compared at [sqrt(H/g)]: the finest would cost 40 times the next.
fn times(effort: Effort, over_depth: u32) -> &'static [f64] {
    let [.., finest] = rows(effort);
    if over_depth == finest {
        &TIMES[..1]
    } else {
        &TIMES
    }
}

/// The last of them.
fn until(effort: Effort, over_depth: u32) -> f64 {
    times(effort, over_depth)
        .iter()
        .copied()
        .fold(0.0, f64::max)
}

/// Length of the reservoir and the first foot of the surface's profile [m].
fn reservoir(until: f64) -> (f64, f64) {
    if until > TIMES[0] {
        (RESERVOIR, FIRST_FOOT)
    } else {
        (SHORT_RESERVOIR, SHORT_FIRST_FOOT)
    }
}

/// End of the bed [m]: out of reach of the water.
fn end(wet: bool, until: f64) -> f64 {
    match (wet, until > TIMES[0]) {
        (true, true) => 4.2,
        (true, false) => 2.4,
        (false, true) => 7.8,
        (false, false) => 4.0,
    }
}

/// Top of the domain [m]: at 200 particles over the depth a drop from a bore flew past twice the depth.
fn top(until: f64) -> f64 {
    if until > TIMES[0] { 0.6 } else { 1.2 }
}

/// What is changed at the coarser spacing.
const CHANGED: [Choice; 2] = [Choice::Seed, Choice::SoundSpeed];

fn bed(wet: bool) -> &'static str {
    if wet { "wet" } else { "dry" }
}

/// `until` in sqrt(H/g).
fn scene(rows: u32, wet: bool, until: f64) -> Result<Template, String> {
    let dp = DEPTH / f64::from(rows);
    let end = end(wet, until);
    let (reservoir, first_foot) = reservoir(until);
    let mut template = Template::new(TEMPLATE)?
        .with("numerics.spacing", dp)
        .with("domain.lower", point(-reservoir - 0.1, -0.1))
        .with("domain.upper", point(end + 0.1, top(until)))
        .with(
            "bodies.reservoir.box",
            rectangle([-reservoir, 0.0], [0.0, DEPTH]),
        )
        .with("run.step", 0.5 * unit())
        .with("run.until", until * unit())
        .with("gauges.surface.from", point(first_foot, 0.0))
        .with("gauges.surface.to", point(end - 0.1, 0.0))
        .with(
            "gauges.surface.count",
            ((end - 0.1 - first_foot) / FEET).round() as i64 + 1,
        )
        .with(
            "walls.tank.polyline",
            points(&[[-reservoir, 0.6], [-reservoir, 0.0], [end, 0.0], [end, 0.6]]),
        );
    let bed = (WET / dp).round() * dp;
    template = if wet {
        template.with("bodies.downstream.box", rectangle([0.0, 0.0], [end, bed]))
    } else {
        template.without("bodies.downstream")
    };
    Ok(template)
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let member = |wet: bool, name: &str, scene: Template| {
        let name = format!("{}_{name}", bed(wet));
        scene
            .text()
            .map(|text| Member::new(name, text, &[SURFACE], Vec::new()))
    };
    let mut members = Vec::new();
    for rows in rows(effort) {
        for wet in [false, true] {
            let scene = scene(rows, wet, until(effort, rows))?;
            members.push(member(wet, &rows.to_string(), scene)?);
        }
    }
    let [coarse, ..] = rows(effort);
    for wet in [false, true] {
        for choice in CHANGED {
            let changed = choice.change(scene(coarse, wet, TIMES[2])?, (GRAVITY * DEPTH).sqrt());
            members.push(member(wet, choice.name(), changed)?);
        }
    }
    Ok(members)
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    let mut curves: [Vec<Curve>; 2] = [Vec::new(), Vec::new()];
    for (k, rows) in rows(results.effort).into_iter().enumerate() {
        for &count in times(results.effort, rows) {
            let what = format!("H/dp {rows}, {count} sqrt(H/g)");
            let [dry, wet] =
                [false, true].map(|wet| Found::new(results, wet, rows, count * unit()));
            report.metrics.extend(dry.dry_metrics(&what));
            report.metrics.extend(wet.wet_metrics(&what));
            for (curves, found) in curves.iter_mut().zip([dry, wet]) {
                let Some(surface) = found.judged else {
                    continue;
                };
                let name = if count == TIMES[0] {
                    format!("H/dp {rows}")
                } else {
                    String::new()
                };
                curves.push(Curve::new(name, surface, Look::Line, k));
            }
        }
    }
    let exact: [fn(f64, f64) -> f64; 2] = [ritter, stoker];
    let names = [
        ("dry", "a dry bed, with Ritter's profile"),
        ("wet", "a wet bed, with Stoker's"),
    ];
    for ((mut curves, exact), (name, what)) in curves.into_iter().zip(exact).zip(names) {
        for count in TIMES {
            let points = (0..=600).map(|k| FIRST_FOOT + FEET * f64::from(k));
            let points = points.filter(|x| *x <= end(name == "wet", TIMES[2]) - 0.1);
            let points = points.map(|x| (x, exact(x, count * unit())));
            let label = if count == TIMES[0] { "exact" } else { "" };
            curves.push(Curve::new(label, points.collect(), Look::Thin, 6));
        }
        report.figures.push(Figure {
            name: name.to_owned(),
            caption: format!("Depth at 6, 9 and 12 sqrt(H/g) over {what}"),
            svg: Chart {
                x: "x [m]".to_owned(),
                y: "depth [m]".to_owned(),
                curves,
            }
            .svg()?,
        });
    }
    Ok(report)
}
