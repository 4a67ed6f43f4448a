//! `dam_breaks`: clear water over a dry and a wet bed, against the shallow-water solutions of Ritter and Stoker.

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Study};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "dam_breaks",
    title: "Dam breaks of clear water: Ritter and Stoker",
    about: "Water 0.30 m deep is let go at once, over a dry bed and over one 50 mm deep; 4 m of reservoir, free slip. Compared at \
6, 9 and 12 sqrt(H/g) = 1.05, 1.57 and 2.10 s with the exact solutions of the shallow-water equations (hydrostatic pressure, no \
friction):\n\n\
    dry: h = (2 c - x/t)^2/(9 g), c = sqrt(g H);   wet: a plateau of 0.1426 m behind a bore of 1.641 m/s.\n\n\
Water falls from rest at first, which those equations do not know: depths come later than theirs by a time that the fall takes, the same \
for good. It stands beside each place as its lag, (x - x_exact)/(dx/dt): a scheme that is at fault lags more and more.",
    members,
    analyse,
};

const DEPTH: f64 = 0.3;
const GRAVITY: f64 = 9.81;
/// Times of the comparison [sqrt(H/g)].
const TIMES: [f64; 3] = [6.0, 9.0, 12.0];
const RESERVOIR: f64 = 4.0;
const WET: f64 = 0.05;
/// Plateau [m], its speed and that of the bore [m/s] for 0.30 m over 0.05 m: Stoker (1957), solved by hand.
const PLATEAU: (f64, f64, f64) = (0.1426, 1.066, 1.641);
const TEMPLATE: &str = include_str!("../../../cases/validation/dam_break.toml");
const FIRST_FOOT: f64 = -3.9;
const FEET: f64 = 0.02;
const SURFACE: &str = "gauge.surface.depth";

/// sqrt(H/g) [s].
fn unit() -> f64 {
    (DEPTH / GRAVITY).sqrt()
}

/// Particles over the depth.
fn rows(effort: Effort) -> [u32; 2] {
    effort.pick([30, 60], [12, 18])
}

/// End of the bed [m]: out of reach of the water.
fn end(wet: bool) -> f64 {
    if wet { 4.2 } else { 7.8 }
}

fn member(rows: u32, wet: bool) -> Result<Member, String> {
    let dp = DEPTH / f64::from(rows);
    let end = end(wet);
    let mut template = Template::new(TEMPLATE)?
        .with("numerics.spacing", dp)
        .with("domain.lower", point(-RESERVOIR - 0.1, -0.1))
        .with("domain.upper", point(end + 0.1, 0.6))
        .with(
            "bodies.reservoir.box",
            rectangle([-RESERVOIR, 0.0], [0.0, DEPTH]),
        )
        .with("run.step", 0.5 * unit())
        .with("run.until", TIMES[2] * unit())
        .with("gauges.surface.from", point(FIRST_FOOT, 0.0))
        .with("gauges.surface.to", point(end - 0.1, 0.0))
        .with(
            "gauges.surface.count",
            ((end - 0.1 - FIRST_FOOT) / FEET).round() as i64 + 1,
        )
        .with(
            "walls.tank.polyline",
            points(&[[-RESERVOIR, 0.6], [-RESERVOIR, 0.0], [end, 0.0], [end, 0.6]]),
        );
    let bed = (WET / dp).round() * dp;
    template = if wet {
        template.with("bodies.downstream.box", rectangle([0.0, 0.0], [end, bed]))
    } else {
        template.without("bodies.downstream")
    };
    Ok(Member::new(
        format!("{}_{rows}", if wet { "wet" } else { "dry" }),
        template.text()?,
        &[SURFACE],
        Vec::new(),
    ))
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let [coarse, fine] = rows(effort);
    [(coarse, false), (coarse, true), (fine, false), (fine, true)]
        .into_iter()
        .map(|(rows, wet)| member(rows, wet))
        .collect()
}

/// Place and depth at a time [s].
fn surface(recording: &Recording, time: f64) -> Option<Vec<(f64, f64)>> {
    let depths = recording.values_at(SURFACE, time)?;
    let rows = depths.iter().enumerate();
    Some(
        rows.map(|(k, h)| (FIRST_FOOT + FEET * k as f64, *h))
            .collect(),
    )
}

/// Outermost place with at least this depth [m].
fn reach(surface: &[(f64, f64)], depth: f64) -> Option<f64> {
    let k = surface.iter().rposition(|p| p.1 >= depth)?;
    let (a, b) = (surface[k], *surface.get(k + 1)?);
    Some(a.0 + (a.1 - depth) / (a.1 - b.1) * (b.0 - a.0))
}

fn ritter(x: f64, t: f64) -> f64 {
    let c = (GRAVITY * DEPTH).sqrt();
    if x < -c * t {
        DEPTH
    } else if x > 2.0 * c * t {
        0.0
    } else {
        (2.0 * c - x / t).powi(2) / (9.0 * GRAVITY)
    }
}

fn stoker(x: f64, t: f64) -> f64 {
    let (plateau, speed, bore) = PLATEAU;
    if x > bore * t {
        WET
    } else if x > (speed - (GRAVITY * plateau).sqrt()) * t {
        plateau
    } else {
        ritter(x, t)
    }
}

/// A place that should go at a constant speed [m/s] since t = 0, and how late it is.
fn place(what: String, found: Option<f64>, speed: f64, t: f64, why: &str) -> [Metric; 2] {
    let lag = found.map(|x| (speed * t - x) / speed / unit());
    [
        Metric::new(what.clone(), found, Rule::NearShare(speed * t, 0.03), why).unit("m"),
        Metric::new(
            format!("{what}: its lag"),
            lag,
            Rule::Report(None),
            "in units of sqrt(H/g)",
        ),
    ]
}

fn dry_metrics(what: &str, t: f64, found: Option<&Vec<(f64, f64)>>, metrics: &mut Vec<Metric>) {
    let c = (GRAVITY * DEPTH).sqrt();
    let inner = |s: &Vec<(f64, f64)>| {
        let errors: Vec<f64> = s
            .iter()
            .filter(|p| (0.1 * DEPTH..0.8 * DEPTH).contains(&ritter(p.0, t)))
            .map(|p| (p.1 - ritter(p.0, t)) / DEPTH)
            .collect();
        crate::validate::statistics::rms(&errors)
    };
    metrics.push(Metric::new(
        format!("dry, {what}: profile between 0.1 H and 0.8 H, rms over H"),
        found.and_then(inner),
        Rule::AtMost(0.03),
        "Ritter (1892)",
    ));
    for share in [0.1, 0.2] {
        metrics.extend(place(
            format!("dry, {what}: place of h = {share} H"),
            found.and_then(|s| reach(s, share * DEPTH)),
            2.0 * c - 3.0 * (GRAVITY * share * DEPTH).sqrt(),
            t,
            "Ritter; asked at H/dp 200",
        ));
    }
}

fn wet_metrics(what: &str, t: f64, found: Option<&Vec<(f64, f64)>>, metrics: &mut Vec<Metric>) {
    let (plateau, speed, bore) = PLATEAU;
    let (from, to) = (
        (speed - (GRAVITY * plateau).sqrt()) * t + 0.15,
        bore * t - 0.2,
    );
    let level = |s: &Vec<(f64, f64)>| {
        let inside: Vec<f64> = s
            .iter()
            .filter(|p| p.0 > from && p.0 < to)
            .map(|p| p.1)
            .collect();
        crate::validate::statistics::mean(&inside)
    };
    metrics.push(
        Metric::new(
            format!("wet, {what}: plateau"),
            found.and_then(level),
            Rule::NearShare(plateau, 0.03),
            "Stoker (1957); asked at H/dp 200",
        )
        .unit("m"),
    );
    metrics.extend(place(
        format!("wet, {what}: bore, where the depth is half way"),
        found.and_then(|s| reach(s, 0.5 * (plateau + WET))),
        bore,
        t,
        "Stoker; asked at H/dp 200",
    ));
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    let mut curves: [Vec<Curve>; 2] = [Vec::new(), Vec::new()];
    for (k, rows) in rows(results.effort).into_iter().enumerate() {
        let found = ["dry", "wet"].map(|bed| results.finished(&format!("{bed}_{rows}")));
        for count in TIMES {
            let t = count * unit();
            let what = format!("H/dp {rows}, {count} sqrt(H/g)");
            let [dry, wet] = found.map(|f| f.and_then(|f| surface(f, t)));
            dry_metrics(&what, t, dry.as_ref(), &mut report.metrics);
            wet_metrics(&what, t, wet.as_ref(), &mut report.metrics);
            for (curves, surface) in curves.iter_mut().zip([dry, wet]) {
                let Some(surface) = surface else { continue };
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
            let points = points.filter(|x| *x <= end(name == "wet") - 0.1);
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
