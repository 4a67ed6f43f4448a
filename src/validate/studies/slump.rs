//! `slump`: a block of a Bingham fluid sinks until its yield stress holds it.

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::statistics::rms;
use crate::validate::template::Template;
use crate::validate::{Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Study};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "slump",
    title: "A block of a Bingham fluid sinks until its yield stress holds it",
    about: "A block 0.26 m long and 0.13 m high, rho = 1540 kg/m^3, tau_0 = 30 Pa, K = 50 Pa s, spreads from a wall that slips over a \
floor that does not: slowly (Re < 1), c0 = 10 sqrt(g H). Where it stops the floor bears the yield stress all along, tau_0 = -rho g h h':\n\n\
    h = sqrt(2 tau_0 (x_inf - x)/(rho g)),   x_inf = (9 A^2 rho g/(8 tau_0))^(1/3) = 0.865 m,   A = 0.0338 m^2\n\n\
(Liu and Mei 1989, doi 10.1017/S0022112089002685; thin layers). It gets there about as 1/t: fronts \
at half the time stand beside those at the end.",
    members,
    analyse,
};

const TEMPLATE: &str = include_str!("../../../cases/validation/slump.toml");
const HEIGHT: f64 = 0.13;
const AREA: f64 = 0.0338;
/// rho g/tau_0 [1/m].
const WEIGHT: f64 = 1540.0 * 9.81 / 30.0;
const FRONT: &str = "gauge.front.front";
const SURFACE: &str = "gauge.surface.depth";
const FIRST_FOOT: f64 = 0.01;
const FEET: f64 = 0.02;

/// Rows over the height, and the end [s].
fn plan(effort: Effort) -> (u32, f64) {
    effort.pick((20, 160.0), (10, 4.0))
}

fn x_inf() -> f64 {
    (9.0 / 8.0 * AREA * AREA * WEIGHT).cbrt()
}

fn exact(x: f64) -> f64 {
    (2.0 * (x_inf() - x).max(0.0) / WEIGHT).sqrt()
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let (rows, until) = plan(effort);
    let text = Template::new(TEMPLATE)?
        .with("numerics.spacing", HEIGHT / f64::from(rows))
        .with("run.until", until)
        .text()?;
    let member = Member::new(format!("block_{rows}"), text, &[FRONT, SURFACE], Vec::new());
    Ok(vec![member])
}

fn front(recording: &Recording, share: f64) -> Option<f64> {
    let fronts = recording.series.get(FRONT)?;
    let place = ((fronts.len() - 1) as f64 * share).round() as usize;
    fronts.get(place)?.first().copied()
}

fn surface(recording: &Recording) -> Option<Vec<(f64, f64)>> {
    let depths = recording.series.get(SURFACE)?.last()?.iter().enumerate();
    Some(
        depths
            .map(|(k, h)| (FIRST_FOOT + FEET * k as f64, *h))
            .collect(),
    )
}

fn analyse(results: &Results) -> Result<Report, String> {
    let (rows, until) = plan(results.effort);
    let found = results.finished(&format!("block_{rows}"));
    let profile = found.and_then(surface);
    let shape = |s: &Vec<(f64, f64)>| {
        let errors: Vec<f64> = s
            .iter()
            .filter(|p| p.0 < x_inf())
            .map(|p| (p.1 - exact(p.0)) / exact(0.0))
            .collect();
        rms(&errors)
    };
    let source = "Liu and Mei (1989); 5 % asked at H/20";
    let metrics = vec![
        Metric::new(
            format!("front at {until} s"),
            found.and_then(|f| front(f, 1.0)),
            Rule::NearShare(x_inf(), 0.05),
            source,
        )
        .unit("m"),
        Metric::new(
            format!("front at {} s", 0.5 * until),
            found.and_then(|f| front(f, 0.5)),
            Rule::Report(Some(x_inf())),
            "on its way",
        )
        .unit("m"),
        Metric::new(
            "shape: rms of h - exact over the exact depth at the wall",
            profile.as_ref().and_then(shape),
            Rule::AtMost(0.03),
            "3 % asked",
        ),
    ];
    let line = (0..=100).map(|k| {
        let x = x_inf() * f64::from(k) / 100.0;
        (x, exact(x))
    });
    let mut curves = vec![Curve::new("exact, at rest", line.collect(), Look::Thin, 6)];
    if let Some(profile) = profile {
        curves.push(Curve::new(
            format!("{rows} rows, {until} s"),
            profile,
            Look::Line,
            0,
        ));
    }
    let figure = Figure {
        name: "shape".to_owned(),
        caption: format!("Depth at {until} s and where theory has it stop"),
        svg: Chart {
            x: "x [m]".to_owned(),
            y: "depth [m]".to_owned(),
            curves,
        }
        .svg()?,
    };
    Ok(Report {
        metrics,
        figures: vec![figure],
        ..Report::default()
    })
}
