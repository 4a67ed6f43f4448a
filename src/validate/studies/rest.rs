//! `rest`: what must not move, and what it presses with.

use crate::validate::bagnold::{Grains, Layer};
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::statistics::rms;
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{
    Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Snapshot, Study,
};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "rest",
    title: "Rest: heap, silo and slope do not move, and press with their weight",
    about: "A heap of sand of 20 deg (friction angle 30.5 deg) and a closed silo, four times as high as wide, for 100 sqrt(H/g); \
a layer on slopes a degree below and above its friction angle; sand in a box with smooth sides. Height and front are compared \
from 10 sqrt(H/g), when the arbitrary start has settled, to the end. Kinetic energy is the largest of the last tenth, over \
m g H. Pressures are those at the end.",
    members,
    analyse,
};

const GRAVITY: f64 = 9.81;
const TEMPLATE: &str = include_str!("../../../cases/validation/rest.toml");
const SLOPE: &str = include_str!("../../../cases/validation/incline.toml");
/// Height of heap, box and layer [m].
const HEIGHT: f64 = 0.1;
const SILO: [f64; 2] = [0.125, 0.5];
/// Bulk density of the sand, phi_max rho_s [kg/m^3].
const SAND: f64 = 0.6 * 2600.0;
const KEPT: [&str; 3] = ["energy.kinetic", "mass.present", "gauge.depth.depth"];
/// Friction angle of glass beads [deg].
const FRICTION: f64 = 20.90;
const LAYERS: usize = 20;
/// Rows over the depth of a layer on a slope.
const ROWS: u32 = 20;

fn scale(height: f64) -> f64 {
    (height / GRAVITY).sqrt()
}

/// Rows where its pressure is judged.
fn fine_rows(effort: Effort) -> u32 {
    effort.pick(2 * ROWS, ROWS)
}

fn heap(effort: Effort) -> Result<Member, String> {
    let spacing = effort.pick(4e-3, 10e-3);
    let half = HEIGHT / 20.0_f64.to_radians().tan();
    let reach = 1.5 * half;
    let time = scale(HEIGHT);
    let text = Template::new(TEMPLATE)?
        .with("domain.lower", point(-reach, -0.05))
        .with("domain.upper", point(reach, 1.5 * HEIGHT))
        .with("numerics.spacing", spacing)
        // At rest by the yield, not by sleep.
        .with("numerics.sleep", false)
        .without("bodies.sand.box")
        .with(
            "bodies.sand.polygon",
            points(&[[-half, 0.0], [half, 0.0], [0.0, HEIGHT]]),
        )
        .with(
            "walls.floor.polyline",
            points(&[[-reach, 0.0], [reach, 0.0]]),
        )
        .with("walls.floor.slip", "no_slip")
        .with("gauges.depth.foot", point(0.0, 0.0))
        .with("gauges.front.kind", "front")
        .with("gauges.front.origin", point(0.0, 0.0))
        .with("gauges.front.direction", point(1.0, 0.0))
        .with("run.step", time / 2.0)
        .with("run.until", effort.pick(100.0, 20.0) * time)
        .text()?;
    let kept = [&KEPT[..], &["gauge.front.front"]].concat();
    Ok(Member::new("heap".to_owned(), text, &kept, Vec::new()))
}

fn silo(effort: Effort) -> Result<Member, String> {
    let spacing = effort.pick(6.25e-3, 12.5e-3);
    let [width, height] = SILO;
    let time = scale(height);
    let walls = [
        [0.0, 1.2 * height],
        [0.0, 0.0],
        [width, 0.0],
        [width, 1.2 * height],
    ];
    let text = Template::new(TEMPLATE)?
        .with("domain.lower", point(-0.05, -0.05))
        .with("domain.upper", point(width + 0.05, 1.3 * height))
        .with("numerics.spacing", spacing)
        // At rest by the yield, not by sleep.
        .with("numerics.sleep", false)
        .with("bodies.sand.box", rectangle([0.0, 0.0], SILO))
        .with("walls.floor.polyline", points(&walls))
        .with("walls.floor.slip", "no_slip")
        .with("gauges.depth.foot", point(0.5 * width, 0.0))
        .with("run.step", time / 2.0)
        .with("run.until", effort.pick(100.0, 10.0) * time)
        .text()?;
    Ok(Member::new("silo".to_owned(), text, &KEPT, Vec::new()))
}

fn hydrostatic(effort: Effort) -> Result<Member, String> {
    let until = effort.pick(20.0, 5.0) * scale(HEIGHT);
    let text = Template::new(TEMPLATE)?
        .with("run.until", until)
        .with("numerics.sleep", false)
        .text()?;
    let kept = [&KEPT[..], &["gauge.weight.force_y"]].concat();
    Ok(Member::new(
        "hydrostatic".to_owned(),
        text,
        &kept,
        vec![until],
    ))
}

/// A layer at rest on a slope so many degrees above the friction angle, so many rows deep.
fn slope(name: &str, above: f64, rows: u32, effort: Effort) -> Result<Member, String> {
    let until = effort.pick(10.0, 1.0);
    let spacing = HEIGHT / f64::from(rows);
    let period = 10.0 * spacing;
    let text = Template::new(SLOPE)?
        .with("domain.lower", point(0.0, -0.02))
        .with("domain.upper", point(period, 1.5 * HEIGHT))
        .with("numerics.spacing", spacing)
        .with("bodies.layer.box", rectangle([0.0, 0.0], [period, HEIGHT]))
        .with("walls.bed.polyline", points(&[[0.0, 0.0], [period, 0.0]]))
        .with("gauges.depth.foot", point(0.5 * period, 0.0))
        .with("domain.slope", (FRICTION + above).to_radians())
        .with("numerics.expected_speed", 0.3)
        .with("numerics.sleep", false)
        .with("run.until", until)
        .text()?;
    Ok(Member::new(name.to_owned(), text, &KEPT, vec![until]))
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    Ok(vec![
        heap(effort)?,
        silo(effort)?,
        hydrostatic(effort)?,
        slope("slope_below", -1.0, ROWS, effort)?,
        slope("slope_below_fine", -1.0, fine_rows(effort), effort)?,
        slope("slope_above", 1.0, ROWS, effort)?,
    ])
}

fn layer(above: f64) -> Layer {
    Layer {
        material: Grains::glass_beads(5e-3),
        slope: (FRICTION + above).to_radians(),
        depth: HEIGHT,
        gravity: GRAVITY,
    }
}

/// Largest less smallest value of a variable from `from` [s] on.
fn range(recording: &Recording, variable: &str, from: f64) -> Option<f64> {
    let curve = recording.curve(variable);
    let late = curve.iter().filter(|p| p.0 >= from).map(|p| p.1);
    let (low, high) = late.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    (low <= high).then_some(high - low)
}

/// Largest kinetic energy of the last tenth, over m g H.
fn energy(recording: &Recording, height: f64) -> Option<f64> {
    let end = recording.time.last()?;
    let curve = recording.curve("energy.kinetic");
    let late = curve.iter().filter(|p| p.0 >= 0.9 * end).map(|p| p.1);
    Some(late.fold(0.0, f64::max) / (recording.last("mass.present")? * GRAVITY * height))
}

/// Pressure less the exact one, over that of the bed: root mean square of the means of twenty layers, and of particles.
fn pressure_errors(snapshot: &Snapshot, exact: &dyn Fn(f64) -> f64) -> Option<(f64, f64)> {
    let particles = snapshot.position.iter().zip(&snapshot.pressure);
    let mut layers = [(0.0, 0_u32); LAYERS];
    let mut errors = Vec::new();
    for (x, p) in particles {
        let height = f64::from(x[1]);
        let error = (f64::from(*p) - exact(height)) / exact(0.0);
        let index = (height / HEIGHT * LAYERS as f64).max(0.0) as usize;
        let layer = &mut layers[index.min(LAYERS - 1)];
        *layer = (layer.0 + error, layer.1 + 1);
        errors.push(error);
    }
    let full = layers.iter().filter(|layer| layer.1 > 0);
    let means: Vec<f64> = full.map(|(sum, count)| sum / f64::from(*count)).collect();
    Some((rms(&means)?, rms(&errors)?))
}

fn mean_velocity(recording: &Recording) -> Option<f64> {
    let last = recording.snapshots.last()?;
    let all: Vec<f64> = last.velocity.iter().map(|v| f64::from(v[0])).collect();
    crate::validate::statistics::mean(&all)
}

fn analyse(results: &Results) -> Result<Report, String> {
    const STILL: &str = "at rest nothing moves; 1e-4 H is a hundredth of a spacing or less";
    const QUIET: &str = "1e-10 of m g H is a speed of 1e-5 sqrt(gH): what is left is no flow";
    let mut metrics = Vec::new();
    let kinds = [
        ("heap", HEIGHT, Some("gauge.front.front")),
        ("silo", SILO[1], None),
    ];
    for (name, height, front) in kinds {
        let recording = results.finished(name);
        let from = 10.0 * scale(height);
        let change =
            |variable: &str| recording.and_then(|r| Some(range(r, variable, from)? / height));
        metrics.push(Metric::new(
            format!("{name}: change of height over H"),
            change("gauge.depth.depth"),
            Rule::AtMost(1e-4),
            STILL,
        ));
        if let Some(front) = front {
            metrics.push(Metric::new(
                format!("{name}: change of front over H"),
                change(front),
                Rule::AtMost(1e-4),
                STILL,
            ));
        }
        let quiet = recording.and_then(|r| energy(r, height));
        metrics.push(Metric::new(
            format!("{name}: kinetic energy over m g H"),
            quiet,
            Rule::AtMost(1e-10),
            QUIET,
        ));
    }
    let below = results.finished("slope_below");
    metrics.push(Metric::new(
        "slope at the friction angle less 1 deg: kinetic energy over m g H",
        below.and_then(|r| energy(r, HEIGHT)),
        Rule::AtMost(1e-10),
        QUIET,
    ));
    let above = results.finished("slope_above").and_then(mean_velocity);
    metrics.push(Metric::new(
        "slope at the friction angle and 1 deg: mean velocity after 10 s over the steady one",
        above.map(|v| v / layer(1.0).mean_velocity()),
        Rule::AtLeast(0.5),
        "it flows; how exactly is for the study inclined_plane",
    ));
    metrics.extend(pressures(results));
    let report = Report {
        metrics,
        figures: vec![figure(results)?],
        ..Report::default()
    };
    Ok(report)
}

fn pressures(results: &Results) -> Vec<Metric> {
    let hydrostatic = |y: f64| SAND * GRAVITY * (HEIGHT - y);
    let cos = (FRICTION - 1.0).to_radians().cos();
    let lithostatic = |y: f64| 0.6 * 2500.0 * GRAVITY * cos * (HEIGHT - y);
    let errors = |name: &str, exact: &dyn Fn(f64) -> f64| {
        pressure_errors(results.finished(name)?.snapshots.last()?, exact)
    };
    let smooth = errors("hydrostatic", &hydrostatic);
    let rows = fine_rows(results.effort);
    let sloped = errors("slope_below_fine", &lithostatic);
    let coarse = errors("slope_below", &lithostatic);
    let weight = results
        .finished("hydrostatic")
        .and_then(|r| Some(-r.last("gauge.weight.force_y")? / (r.last("mass.present")? * GRAVITY)));
    const SCATTER: &str =
        "what single particles differ by: forces frozen in the packing, not judged";
    let exact = "exact; mean of each of twenty layers, root mean square over the layers";
    vec![
        Metric::new(
            "box with smooth sides: error of pressure rho g (H - y), over the bed's",
            smooth.map(|e| e.0),
            Rule::AtMost(0.01),
            exact,
        ),
        Metric::new(
            "box with smooth sides: the same of single particles",
            smooth.map(|e| e.1),
            Rule::Report(None),
            SCATTER,
        ),
        Metric::new(
            "box with smooth sides: force on the floor over the weight",
            weight,
            Rule::Near(1.0, 0.01),
            "exact",
        ),
        Metric::new(
            format!(
                "slope at rest, {rows} rows: error of pressure rho g cos th (H - z), over the bed's"
            ),
            sloped.map(|e| e.0),
            Rule::AtMost(0.01),
            exact,
        ),
        Metric::new(
            format!("slope at rest, {rows} rows: the same of single particles"),
            sloped.map(|e| e.1),
            Rule::Report(None),
            SCATTER,
        ),
        Metric::new(
            format!("slope at rest, {ROWS} rows: error of pressure"),
            coarse.map(|e| e.0),
            Rule::Report(None),
            "the row beside the floor has most of it",
        ),
    ]
}

/// Kinetic energies over time.
fn figure(results: &Results) -> Result<Figure, String> {
    let mut curves = Vec::new();
    for (colour, (name, height)) in [("heap", HEIGHT), ("silo", SILO[1]), ("slope_below", HEIGHT)]
        .into_iter()
        .enumerate()
    {
        let Some(recording) = results.finished(name) else {
            continue;
        };
        let weight = recording.last("mass.present").unwrap_or(f64::NAN) * GRAVITY * height;
        let points = recording.curve("energy.kinetic").into_iter();
        // Below 1e-20 is nothing, and the logarithm of nothing is no point.
        let points = points.map(|(t, e)| (t / scale(height), (e / weight).max(1e-20).log10()));
        curves.push(Curve::new(name, points.collect(), Look::Line, colour));
    }
    let chart = Chart {
        x: "t / sqrt(H/g)".to_owned(),
        y: "log10 of kinetic energy / (m g H)".to_owned(),
        curves,
    };
    Ok(Figure {
        name: "energy".to_owned(),
        caption: "Kinetic energy over time.".to_owned(),
        svg: chart.svg()?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_an_exact_pile() {
        let exact = |y: f64| 100.0 * (1.0 - y);
        let mut snapshot = Snapshot {
            position: vec![[0.0, 0.052, 0.0], [0.0, 0.053, 0.0], [0.0, 0.0, 0.0]],
            pressure: vec![94.8, 94.7, 100.0],
            ..Snapshot::default()
        };
        let (layers, particles) = pressure_errors(&snapshot, &exact).unwrap();
        assert!(layers < 1e-7 && particles < 1e-7, "{layers} {particles}");
        // Two neighbours, one a per cent too high and one too low: the layer is right, the particles are not.
        snapshot.pressure = vec![95.8, 93.7, 100.0];
        let (layers, particles) = pressure_errors(&snapshot, &exact).unwrap();
        assert!(layers < 1e-7, "{layers}");
        assert!(
            (particles - (2e-4_f64 / 3.0).sqrt()).abs() < 1e-7,
            "{particles}"
        );

        let mut recording = Recording::empty("key".to_owned());
        recording.time = vec![0.0, 1.0, 2.0, 10.0];
        let column = |values: [f64; 4]| values.map(|v| vec![v]).to_vec();
        recording.series.insert(
            "gauge.depth.depth".to_owned(),
            column([2.0, 1.0, 1.25, 1.125]),
        );
        recording
            .series
            .insert("energy.kinetic".to_owned(), column([9.0, 9.0, 9.0, 9.81]));
        recording
            .series
            .insert("mass.present".to_owned(), column([2.0; 4]));
        assert_eq!(range(&recording, "gauge.depth.depth", 1.0), Some(0.25));
        assert_eq!(energy(&recording, 0.5), Some(1.0));
        assert_eq!(range(&recording, "gauge.depth.depth", 99.0), None);
    }
}
