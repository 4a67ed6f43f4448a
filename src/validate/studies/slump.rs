//! `slump`: a block of a Bingham fluid sinks until its yield stress holds it.

use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::statistics::rms;
use crate::validate::template::Template;
use crate::validate::{
    Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Snapshot, Study,
};

use super::thin_layer::Block;

/// The study.
pub(super) const STUDY: Study = Study {
    name: "slump",
    title: "A block of a Bingham fluid sinks until its yield stress holds it",
    about: "A block 0.26 m long and 0.13 m high, rho = 1540 kg/m^3, tau_0 = 30 Pa, K = 50 Pa s, spreads from a wall that slips over a \
floor that does not: slowly (Re < 1), c0 = 10 sqrt(g H). Where it stops the floor bears the yield stress all along, tau_0 = -rho g h h':\n\n\
    h = sqrt(2 tau_0 (x_inf - x)/(rho g)),   x_inf = (9 A^2 rho g/(8 tau_0))^(1/3) = 0.865 m,   A = 0.0338 m^2\n\n\
(Liu and Mei 1989, doi 10.1017/S0022112089002685; thin layers). It gets there about as 1/t: fronts on the way stand beside those \
of their thin-layer equation, h_t + q_x = 0, q = G (h - y_c)^2 (2 h + y_c)/(6 K), G = rho g |h_x|, y_c = tau_0/G. \
The front is the far side of the outermost particle.",
    members,
    analyse,
};

const TEMPLATE: &str = include_str!("../../../cases/validation/slump.toml");
const HEIGHT: f64 = 0.13;
const AREA: f64 = 0.0338;
/// The block of cases/validation/slump.toml.
const BLOCK: Block = Block {
    weight: 1540.0 * 9.81,
    yield_stress: 30.0,
    consistency: 50.0,
    length: AREA / HEIGHT,
    height: HEIGHT,
};
/// rho g/tau_0 [1/m].
const WEIGHT: f64 = BLOCK.weight / BLOCK.yield_stress;
const SURFACE: &str = "gauge.surface.depth";
const FIRST_FOOT: f64 = 0.01;
const FEET: f64 = 0.02;

/// Rows over the height, and the end [s].
fn plan(effort: Effort) -> (u32, f64) {
    effort.pick((20, 2560.0), (10, 4.0))
}

/// When fronts are looked at: an eighth of the way, a fourth, half and the end [s].
fn looks(until: f64) -> [f64; 4] {
    [0.125, 0.25, 0.5, 1.0].map(|share| share * until)
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
    let times = looks(until).to_vec();
    let member = Member::new(format!("block_{rows}"), text, &[SURFACE], times);
    Ok(vec![member])
}

/// Far side of the outermost particle of each snapshot, spacing `dp` [m].
fn fronts(recording: &Recording, dp: f64) -> Vec<f64> {
    let outermost = |s: &Snapshot| {
        s.position
            .iter()
            .map(|x| f64::from(x[0]))
            .fold(0.0, f64::max)
    };
    recording
        .snapshots
        .iter()
        .map(|s| outermost(s) + 0.5 * dp)
        .collect()
}

fn surface(recording: &Recording) -> Option<Vec<(f64, f64)>> {
    let depths = recording.series.get(SURFACE)?.last()?.iter().enumerate();
    Some(
        depths
            .map(|(k, h)| (FIRST_FOOT + FEET * k as f64, *h))
            .collect(),
    )
}

/// Computed fronts, from first to last look, beside those of the thin-layer equation, and the last one beside where it stops.
fn spreading(reached: Option<&[f64]>, until: f64) -> Vec<Metric> {
    let on_the_way = BLOCK.fronts(looks(until));
    let mut metrics = Vec::new();
    for (k, time) in looks(until).into_iter().enumerate() {
        let value = reached.and_then(|r| r.get(k).copied());
        let text = format!("front at {time} s, thin-layer equation");
        let rule = Rule::Report(Some(on_the_way[k]));
        metrics.push(Metric::new(text, value, rule, "on its way").unit("m"));
        if time >= until {
            let text = format!("front at {time} s, at rest");
            let rule = Rule::NearShare(x_inf(), 0.05);
            let source = "Liu and Mei (1989); 5 % asked at H/20";
            metrics.push(Metric::new(text, value, rule, source).unit("m"));
        }
    }
    metrics
}

/// Root of the mean square of the difference of the depth, where theory has material at rest, over that at the wall.
fn shape_error(profile: &[(f64, f64)]) -> Option<f64> {
    let covered = profile.iter().filter(|p| p.0 < x_inf());
    let errors: Vec<f64> = covered.map(|p| (p.1 - exact(p.0)) / exact(0.0)).collect();
    rms(&errors)
}

fn figure(profile: Option<Vec<(f64, f64)>>, (rows, until): (u32, f64)) -> Result<Figure, String> {
    let line = (0..=100).map(|k| {
        let x = x_inf() * f64::from(k) / 100.0;
        (x, exact(x))
    });
    let mut curves = vec![Curve::new("exact, at rest", line.collect(), Look::Thin, 6)];
    if let Some(profile) = profile {
        let name = format!("{rows} rows, {until} s");
        curves.push(Curve::new(name, profile, Look::Line, 0));
    }
    Ok(Figure {
        name: "shape".to_owned(),
        caption: format!("Depth at {until} s and where theory has it stop"),
        svg: Chart {
            x: "x [m]".to_owned(),
            y: "depth [m]".to_owned(),
            curves,
        }
        .svg()?,
    })
}

fn analyse(results: &Results) -> Result<Report, String> {
    let (rows, until) = plan(results.effort);
    let found = results.finished(&format!("block_{rows}"));
    let profile = found.and_then(surface);
    let reached = found.map(|f| fronts(f, HEIGHT / f64::from(rows)));
    let mut metrics = spreading(reached.as_deref(), until);
    metrics.push(Metric::new(
        "shape: rms of h - exact over the exact depth at the wall",
        profile.as_deref().and_then(shape_error),
        Rule::AtMost(0.03),
        "3 % asked",
    ));
    Ok(Report {
        metrics,
        figures: vec![figure(profile, (rows, until))?],
        ..Report::default()
    })
}
