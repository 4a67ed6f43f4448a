//! Walls, gates, inflows and outflows of the drawing, each with its name.

use super::{GATE, INFLOW, OUTFLOW, Svg, WALL};
use crate::scene::{
    Dimension, Gate, Inflow, Outflow, OutflowPlace, Point, Scene, Wall, WallGeometry,
};
use crate::units::shown_bound;

pub(super) fn draw(svg: &mut Svg<'_>, scene: &Scene) {
    for outflow in &scene.outflows {
        draw_outflow(svg, outflow);
    }
    for wall in &scene.walls {
        draw_wall(svg, wall, scene.dimension);
    }
    for gate in &scene.gates {
        draw_gate(svg, gate);
    }
    for inflow in &scene.inflows {
        draw_inflow(svg, inflow);
    }
}

pub(super) fn plus(a: Point, b: Point, factor: f64) -> Point {
    [0, 1, 2].map(|k| a[k] + factor * b[k])
}

pub(super) fn middle(a: Point, b: Point) -> Point {
    [0, 1, 2].map(|k| 0.5 * (a[k] + b[k]))
}

/// Corners of a face from `from` to `to`, extruded along `span` in space.
pub(super) fn face(svg: &Svg<'_>, from: Point, to: Point, span: Point) -> Vec<(f64, f64)> {
    [from, to, plus(to, span, 1.0), plus(from, span, 1.0)]
        .map(|corner| svg.view.place(corner))
        .to_vec()
}

fn rectangle(svg: &Svg<'_>, lower: Point, upper: Point) -> Vec<(f64, f64)> {
    let (low, high) = (svg.view.place(lower), svg.view.place(upper));
    vec![low, (high.0, low.1), high, (low.0, high.1)]
}

fn draw_outflow(svg: &mut Svg<'_>, outflow: &Outflow) {
    let (corners, fill, title) = match outflow.place {
        OutflowPlace::Box { lower, upper } => {
            let title = format!("outflow {}", outflow.name);
            (rectangle(svg, lower, upper), OUTFLOW, title)
        }
        OutflowPlace::Outside => {
            let title = format!("outflow {}: all that leaves the domain", outflow.name);
            (
                rectangle(svg, svg.view.lower, svg.view.upper),
                "none",
                title,
            )
        }
    };
    let style = format!(
        "fill=\"{fill}\" fill-opacity=\"0.2\" stroke=\"{OUTFLOW}\" stroke-dasharray=\"5 3\""
    );
    svg.line(&corners, true, &style, &title);
    svg.words((corners[0].0, corners[0].1 - 2.0), INFLOW, &title);
}

fn draw_wall(svg: &mut Svg<'_>, wall: &Wall, dimension: Dimension) {
    let name = &wall.name;
    let title = match &wall.drive {
        None => format!("wall {name}"),
        Some(drive) => {
            let (least, most) = drive.range();
            let (least, most) = (shown_bound(least), shown_bound(most));
            let unit = drive.unit();
            let input = drive.input();
            format!("wall {name}: input wall.{name}.{input}, {least} to {most} {unit}")
        }
    };
    let stroke = format!("fill=\"none\" stroke=\"{WALL}\" stroke-width=\"2.5\"");
    match &wall.geometry {
        WallGeometry::Polyline { points, closed } => {
            let corners: Vec<_> = points
                .iter()
                .map(|p| svg.view.place([p[0], p[1], 0.0]))
                .collect();
            svg.line(&corners, *closed, &stroke, &title);
        }
        WallGeometry::Box { lower, upper } => {
            let style = format!("fill=\"{WALL}\" fill-opacity=\"0.35\" stroke=\"{WALL}\"");
            svg.line(&rectangle(svg, *lower, *upper), true, &style, &title);
        }
        WallGeometry::Plane { point, normal } => {
            let view = svg.view;
            let middle = view.place(*point);
            let far = 4.0 * (view.size().0 + view.size().1);
            // A plane across the view is a line; one that the reader looks at is the paper itself.
            let sides = match view.direction(*normal) {
                Some((x, y)) if dimension != Dimension::Three || is_across(svg, *normal) => vec![
                    (middle.0 - far * y, middle.1 + far * x),
                    (middle.0 + far * y, middle.1 - far * x),
                ],
                _ => rectangle(svg, view.lower, view.upper),
            };
            let closed = sides.len() > 2;
            let width = if closed { "1" } else { "4" };
            let style = format!(
                "fill=\"none\" stroke=\"{WALL}\" stroke-width=\"{width}\" clip-path=\"url(#domain)\""
            );
            svg.line(&sides, closed, &style, &title);
        }
    }
}

/// Whether a plane with this normal is seen from its edge.
fn is_across(svg: &Svg<'_>, normal: Point) -> bool {
    let (x, y) = (normal[svg.view.right], normal[svg.view.up]);
    x.hypot(y) > 0.999
}

fn draw_gate(svg: &mut Svg<'_>, gate: &Gate) {
    let title = format!(
        "gate {}: input gate.{}.opening, {} at the start; opens from its dashed end",
        gate.name, gate.name, gate.start
    );
    let way: Point = [0, 1, 2].map(|k| gate.to[k] - gate.from[k]);
    let edge = plus(gate.from, way, gate.start);
    let whole = face(svg, gate.from, gate.to, gate.span);
    let plate = face(svg, edge, gate.to, gate.span);
    let dashed = format!("fill=\"none\" stroke=\"{GATE}\" stroke-dasharray=\"4 3\"");
    svg.line(&whole, true, &dashed, &title);
    let solid = format!(
        "fill=\"{GATE}\" fill-opacity=\"0.5\" stroke=\"{GATE}\" stroke-width=\"4\" stroke-linejoin=\"round\""
    );
    svg.line(&plate, true, &solid, &title);
    let at = svg.view.place(middle(gate.from, gate.to));
    svg.words((at.0, at.1 + 18.0), GATE, &format!("gate {}", gate.name));
}

fn draw_inflow(svg: &mut Svg<'_>, inflow: &Inflow) {
    let title = format!(
        "inflow {}: input inflow.{}.rate, up to {:.3} kg/s",
        inflow.name, inflow.name, inflow.max_rate
    );
    let corners = face(svg, inflow.from, inflow.to, inflow.span);
    let style = format!("fill=\"none\" stroke=\"{INFLOW}\" stroke-width=\"3\"");
    svg.line(&corners, true, &style, &title);
    let centre = middle(inflow.from, plus(inflow.to, inflow.span, 1.0));
    let at = svg.view.place(centre);
    if let Some(towards) = svg.view.direction(inflow.velocity) {
        svg.arrow(at, towards, 22.0, INFLOW, &title);
    }
    let top = corners.iter().map(|c| c.1).fold(at.1, f64::min);
    svg.words(
        (at.0, top - 2.0),
        INFLOW,
        &format!("inflow {}", inflow.name),
    );
}
