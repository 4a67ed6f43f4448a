//! Draws `docs/silo.svg`: the silo case at four moments, and what its gauges say.
//!
//! `cargo run --release --example silo_picture`
//!
//! It is also an example of how to use the library from Rust: load a scene, build the component, set inputs, step,
//! read gauges and particles.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

use sandgate::component::{Component, ParticleView, ValueReference};
use sandgate::scene::{self, Scene, WallGeometry};

/// Moments shown [s]: at rest, open, half closed, open again.
const MOMENTS: [f64; 4] = [0.0, 0.35, 0.75, 1.1];
/// Width of one silo and height of the row [px].
const CELL: (f64, f64) = (250.0, 460.0);
/// Height of the chart below [px].
const CHART: f64 = 190.0;
/// Slow to fast, readable for colour-blind people (viridis).
const COLOURS: [&str; 8] = [
    "#440154", "#46327e", "#365c8d", "#277f8e", "#1fa187", "#4ac16d", "#a0da39", "#fde725",
];
/// Speed of the brightest colour [m/s].
const FASTEST: f64 = 1.2;

fn main() -> Result<(), Box<dyn Error>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let scene = scene::load(&root.join("cases/silo_gate.toml"))?;
    let mut component = Component::new(&scene)?;
    component.set_threads(0);
    component.initialize(0.0, None)?;

    let opening = reference(&component, "gate.")?;
    let discharge = reference(&component, "outflow.")?;
    let mut series = Vec::new();
    let mut svg = String::new();
    let mut moments = MOMENTS.iter().enumerate().peekable();
    for step in 0_u32.. {
        let time = component.time();
        if let Some((column, moment)) = moments.next_if(|(_, m)| time >= **m - 1e-9) {
            let left = CELL.0 * column as f64;
            draw_silo(&mut svg, left, *moment, &scene, &component)?;
        }
        if time >= scene.run.until - 1e-9 {
            break;
        }
        apply_schedules(&mut component)?;
        let next = f64::from(step + 1) * scene.run.step;
        component.do_step(time, next - time)?;
        let mut values = [0.0; 2];
        component.get(&[opening, discharge], &mut values)?;
        series.push((component.time(), values));
    }
    draw_chart(&mut svg, &series)?;
    let (width, height) = (CELL.0 * MOMENTS.len() as f64, CELL.1 + CHART);
    let picture = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{svg}</svg>\n"
    );
    std::fs::write(root.join("docs/silo.svg"), picture)?;
    Ok(())
}

/// The actual opening of the first gate, or the rate of the first outflow.
fn reference(component: &Component, prefix: &str) -> Result<ValueReference, Box<dyn Error>> {
    let rows = component.variables().rows();
    let wanted = [".actual_opening", ".rate"];
    rows.iter()
        .find(|v| v.name.starts_with(prefix) && wanted.iter().any(|end| v.name.ends_with(end)))
        .map(|v| v.reference)
        .ok_or_else(|| format!("the case has no {prefix}*").into())
}

/// Sets the scene's scheduled inputs for the step that begins now.
fn apply_schedules(component: &mut Component) -> Result<(), Box<dyn Error>> {
    let time = component.time();
    for schedule in component.scene().schedules.clone() {
        let reference = component.variables().input(schedule.input);
        component.set(&[reference], &[schedule.value_at(time)])?;
    }
    Ok(())
}

fn draw_silo(
    svg: &mut String,
    left: f64,
    moment: f64,
    scene: &Scene,
    component: &Component,
) -> Result<(), Box<dyn Error>> {
    let (low, high) = (scene.domain.lower, scene.domain.upper);
    let scale = ((CELL.0 - 20.0) / (high[0] - low[0])).min((CELL.1 - 50.0) / (high[1] - low[1]));
    let place = |x: f64, y: f64| {
        (
            left + 10.0 + (x - low[0]) * scale,
            36.0 + (high[1] - y) * scale,
        )
    };
    writeln!(
        svg,
        "<text x=\"{}\" y=\"24\" font-size=\"16\">t = {moment} s</text>",
        left + 12.0
    )?;
    draw_particles(
        svg,
        &component.particles(),
        scene.numerics.spacing * scale,
        place,
    )?;
    for wall in &scene.walls {
        if let WallGeometry::Polyline { points, .. } = &wall.geometry {
            let corners: Vec<String> = points
                .iter()
                .map(|p| place(p[0], p[1]))
                .map(|(x, y)| format!("{x:.1},{y:.1}"))
                .collect();
            writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"#333\" stroke-width=\"2\"/>",
                corners.join(" ")
            )?;
        }
    }
    for gate in &scene.gates {
        let name = format!("gate.{}.actual_opening", gate.name);
        let variable = component
            .variables()
            .by_name(&name)
            .ok_or("no such output")?;
        let mut opening = [0.0];
        component.get(&[variable.reference], &mut opening)?;
        let at = |axis: usize| gate.from[axis] + opening[0] * (gate.to[axis] - gate.from[axis]);
        let ((x1, y1), (x2, y2)) = (place(at(0), at(1)), place(gate.to[0], gate.to[1]));
        writeln!(
            svg,
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" stroke=\"#d55e00\" stroke-width=\"5\"/>"
        )?;
    }
    Ok(())
}

/// Dots by speed: one path a colour keeps the file small.
fn draw_particles(
    svg: &mut String,
    view: &ParticleView,
    size: f64,
    place: impl Fn(f64, f64) -> (f64, f64),
) -> Result<(), Box<dyn Error>> {
    for (class, colour) in COLOURS.iter().enumerate() {
        let mut path = String::new();
        for (x, v) in view.position.iter().zip(&view.velocity) {
            let speed = f64::from(v[0]).hypot(f64::from(v[1]));
            let share = (speed / FASTEST * COLOURS.len() as f64) as usize;
            if share.min(COLOURS.len() - 1) == class {
                let (x, y) = place(f64::from(x[0]), f64::from(x[1]));
                write!(path, "M{x:.1} {y:.1}h0")?;
            }
        }
        writeln!(
            svg,
            "<path d=\"{path}\" stroke=\"{colour}\" stroke-width=\"{:.2}\" stroke-linecap=\"round\"/>",
            size * 1.05
        )?;
    }
    Ok(())
}

/// Opening and outflow rate over time.
fn draw_chart(svg: &mut String, series: &[(f64, [f64; 2])]) -> Result<(), Box<dyn Error>> {
    let width = CELL.0 * MOMENTS.len() as f64 - 120.0;
    let (top, bottom) = (CELL.1 + 30.0, CELL.1 + CHART - 30.0);
    let end = series.last().map_or(1.0, |(time, _)| *time);
    let most = |index: usize| series.iter().map(|(_, v)| v[index]).fold(1e-12, f64::max);
    let curves = [
        (0, "#d55e00", "gate opening [1]", ""),
        (1, "#0072b2", "outflow", " kg/s"),
    ];
    writeln!(
        svg,
        "<path d=\"M60 {top}V{bottom}h{width}\" stroke=\"#333\" fill=\"none\"/>"
    )?;
    for second in 0..=end as u32 {
        let x = 60.0 + f64::from(second) / end * width;
        writeln!(
            svg,
            "<text x=\"{x:.0}\" y=\"{:.0}\" font-size=\"13\">{second} s</text>",
            bottom + 18.0
        )?;
    }
    for (index, colour, name, unit) in curves {
        let top_value = most(index);
        let points: Vec<String> = series
            .iter()
            .map(|(time, v)| {
                let y = bottom - v[index] / top_value * (bottom - top);
                format!("{:.1},{y:.1}", 60.0 + time / end * width)
            })
            .collect();
        writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"/>",
            points.join(" ")
        )?;
        let (x, y) = (70.0 + 260.0 * index as f64, top - 8.0);
        writeln!(
            svg,
            "<text x=\"{x}\" y=\"{y}\" font-size=\"14\" fill=\"{colour}\">{name}, full height {top_value:.3}{unit}</text>"
        )?;
    }
    Ok(())
}
