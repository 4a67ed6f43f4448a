//! Gauges of the drawing, each with its name.

use super::devices::{face, middle, plus};
use super::{GAUGE, Svg};
use crate::scene::{ForceTarget, Gauge, GaugeKind, Point, Scene, WallGeometry};

/// Thin lines of gauges.
const THIN: &str = "fill=\"none\" stroke-width=\"1.2\" clip-path=\"url(#domain)\"";

pub(super) fn draw(svg: &mut Svg<'_>, scene: &Scene) {
    for gauge in &scene.gauges {
        let name = &gauge.name;
        let at = Pen { svg, name }.draw(gauge, scene);
        svg.words(at, GAUGE, name);
    }
}

/// Draws one gauge.
struct Pen<'p, 's> {
    svg: &'p mut Svg<'s>,
    /// The gauge's.
    name: &'p str,
}

impl Pen<'_, '_> {
    /// Answers where the name belongs.
    fn draw(&mut self, gauge: &Gauge, scene: &Scene) -> (f64, f64) {
        match &gauge.kind {
            GaugeKind::Depth { foot, up, length } => {
                self.upright("depth", [*foot, plus(*foot, *up, *length)])
            }
            GaugeKind::InterfaceStress { foot, up, length } => {
                let ends = [*foot, plus(*foot, *up, *length)];
                self.upright("stress of the interface", ends)
            }
            GaugeKind::Profile {
                from,
                to,
                count,
                up,
                length,
            } => self.profile([*from, *to], *count, |foot| plus(foot, *up, *length)),
            GaugeKind::Discharge { from, to, span } => {
                let corners = face(self.svg, *from, *to, *span);
                let dotted = " stroke-dasharray=\"1 3\"";
                self.line(&corners, true, dotted, "discharge through this section");
                corners[1]
            }
            GaugeKind::Force { on, about } => self.force((*on, *about), scene),
            GaugeKind::Pressure { at, .. } => {
                let at = self.svg.view.place(*at);
                self.dot(at, "pressure at this point");
                at
            }
            GaugeKind::Velocity { at } => {
                let at = self.svg.view.place(*at);
                self.dot(at, "velocity at this point");
                at
            }
            GaugeKind::Mass { lower, upper } => self.mass(*lower, *upper),
            GaugeKind::Front {
                origin, direction, ..
            } => self.front(*origin, *direction),
        }
    }

    /// A line from the foot to the top of a column.
    fn upright(&mut self, what: &str, ends: [Point; 2]) -> (f64, f64) {
        let [foot, top] = ends.map(|end| self.svg.view.place(end));
        self.line(&[foot, top], false, "", &format!("{what} along this line"));
        self.dot(foot, &format!("foot of the {what}"));
        // Beside the line rather than on the bed, where walls and gates have their names.
        (foot.0, foot.1 - 0.3 * (foot.1 - top.1).clamp(-200.0, 200.0))
    }

    /// A faint line on each foot.
    fn profile(
        &mut self,
        [from, to]: [Point; 2],
        count: usize,
        top: impl Fn(Point) -> Point,
    ) -> (f64, f64) {
        let way: Point = [0, 1, 2].map(|k| to[k] - from[k]);
        for k in 0..count {
            let foot = plus(from, way, k as f64 / (count - 1).max(1) as f64);
            let ends = [foot, top(foot)].map(|end| self.svg.view.place(end));
            let what = format!("depth {} of {count}", k + 1);
            self.line(&ends, false, " stroke-opacity=\"0.4\"", &what);
        }
        self.svg.view.place(from)
    }

    fn force(&mut self, (on, about): (ForceTarget, Option<Point>), scene: &Scene) -> (f64, f64) {
        let (what, at) = match on {
            ForceTarget::Wall(i) => {
                let wall = &scene.walls[i];
                (format!("wall {}", wall.name), on_wall(&wall.geometry))
            }
            ForceTarget::Gate(i) => {
                let gate = &scene.gates[i];
                (format!("gate {}", gate.name), gate.from)
            }
        };
        let at = self.svg.view.place(at);
        self.dot(at, &format!("force on {what}"));
        if let Some(about) = about {
            let pivot = self.svg.view.place(about);
            self.dot(pivot, &format!("moment on {what} about this point"));
        }
        (at.0, at.1 + 32.0)
    }

    fn mass(&mut self, lower: Point, upper: Point) -> (f64, f64) {
        let corner = |x: f64, y: f64| self.svg.view.place([x, y, lower[2]]);
        let corners = [
            corner(lower[0], lower[1]),
            corner(upper[0], lower[1]),
            corner(upper[0], upper[1]),
            corner(lower[0], upper[1]),
        ];
        self.line(&corners, true, "", "mass in this box");
        corners[0]
    }

    fn front(&mut self, origin: Point, direction: Point) -> (f64, f64) {
        let at = self.svg.view.place(origin);
        let what = "front, counted from here";
        match self.svg.view.direction(direction) {
            Some(towards) => {
                let title = self.title(what);
                self.svg.arrow(at, towards, 26.0, GAUGE, &title);
            }
            None => self.dot(at, what),
        }
        (at.0, at.1 + 18.0)
    }

    fn line(&mut self, points: &[(f64, f64)], closed: bool, more: &str, what: &str) {
        let style = format!("{THIN} stroke=\"{GAUGE}\"{more}");
        let title = self.title(what);
        self.svg.line(points, closed, &style, &title);
    }

    fn dot(&mut self, (x, y): (f64, f64), what: &str) {
        let attributes = format!("cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{GAUGE}\"");
        let title = self.title(what);
        self.svg.shape("circle", &attributes, &title);
    }

    fn title(&self, what: &str) -> String {
        format!("gauge {}: {what}", self.name)
    }
}

/// A point of a wall to put a name at.
fn on_wall(geometry: &WallGeometry) -> Point {
    match geometry {
        WallGeometry::Polyline { points, .. } => points
            .first()
            .map_or([0.0; 3], |corner| [corner[0], corner[1], 0.0]),
        WallGeometry::Box { lower, upper } => middle(*lower, *upper),
        WallGeometry::Plane { point, .. } => *point,
    }
}
