//! The scene as an SVG drawing for an FMU's documentation: walls, gates, inflows, outflows, gauges, material at the start.
//!
//! Planar scenes are drawn as they are. Scenes in space are seen from the side: the axis of gravity upwards, the longer
//! of the two others to the right. Material is drawn in cells, so that the drawing stays small however many particles
//! there are.

mod devices;
mod gauges;
mod material;

pub(super) use material::COLOURS;

use std::fmt::Write;

use super::xml::escape;
use crate::component::Component;
use crate::scene::{Dimension, Point, Scene};

/// Room for the drawing without its margins [px].
const ROOM: (f64, f64) = (640.0, 460.0);
/// Margin for names and the scale [px].
const MARGIN: f64 = 46.0;

/// What is drawn and in which colour (Okabe and Ito's, which colour-blind people can tell apart); material takes the
/// others. The legend of the page.
pub(super) const LEGEND: [(&str, &str); 5] = [
    ("wall", WALL),
    ("gate", GATE),
    ("inflow", INFLOW),
    ("outflow", OUTFLOW),
    ("gauge", GAUGE),
];
const WALL: &str = "#333333";
const GATE: &str = "#d55e00";
const INFLOW: &str = "#0072b2";
const OUTFLOW: &str = "#56b4e9";
const GAUGE: &str = "#a3397f";

/// From the scene's coordinates to the drawing's.
struct View {
    /// Axis drawn to the right.
    right: usize,
    /// Axis drawn upwards.
    up: usize,
    /// Whether it is drawn upside down, because gravity pulls along the axis.
    flipped: bool,
    lower: Point,
    upper: Point,
    /// Pixels a metre.
    scale: f64,
}

impl View {
    fn of(scene: &Scene) -> Self {
        let (lower, upper) = (scene.domain.lower, scene.domain.upper);
        let extent = |axis: usize| upper[axis] - lower[axis];
        let (right, up) = match scene.dimension {
            Dimension::Two | Dimension::Axisymmetric => (0, 1),
            Dimension::Three => {
                let pull = |axis: usize| scene.domain.gravity[axis].abs();
                let up = (0..3).rev().fold(
                    2,
                    |best, axis| {
                        if pull(axis) > pull(best) { axis } else { best }
                    },
                );
                let (a, b) = ((up + 1) % 3, (up + 2) % 3);
                (if extent(a) >= extent(b) { a } else { b }, up)
            }
        };
        Self {
            right,
            up,
            flipped: scene.domain.gravity[up] > 0.0,
            lower,
            upper,
            scale: (ROOM.0 / extent(right)).min(ROOM.1 / extent(up)),
        }
    }

    /// Width and height of the drawing [px].
    fn size(&self) -> (f64, f64) {
        let extent = |axis: usize| (self.upper[axis] - self.lower[axis]) * self.scale;
        (
            extent(self.right) + 2.0 * MARGIN,
            extent(self.up) + 2.0 * MARGIN,
        )
    }

    /// Where a point of the scene is drawn [px].
    fn place(&self, point: Point) -> (f64, f64) {
        let across = point[self.right] - self.lower[self.right];
        let down = if self.flipped {
            point[self.up] - self.lower[self.up]
        } else {
            self.upper[self.up] - point[self.up]
        };
        (MARGIN + across * self.scale, MARGIN + down * self.scale)
    }

    /// A direction of the scene as one of the drawing, of length 1; `None` if it points at the reader.
    fn direction(&self, vector: Point) -> Option<(f64, f64)> {
        let sign = if self.flipped { 1.0 } else { -1.0 };
        let (x, y) = (vector[self.right], sign * vector[self.up]);
        let length = x.hypot(y);
        (length > 1e-6 * (vector.iter().map(|v| v * v).sum::<f64>()).sqrt())
            .then(|| (x / length, y / length))
    }
}

/// A drawing under construction.
struct Svg<'a> {
    text: String,
    view: &'a View,
}

impl Svg<'_> {
    /// An element with attributes, and what a pointer resting on it shows.
    fn shape(&mut self, element: &str, attributes: &str, title: &str) {
        // Writing to a String cannot fail.
        let _ = writeln!(
            self.text,
            "<{element} {attributes}><title>{}</title></{element}>",
            escape(title)
        );
    }

    /// A line through points, in pixels.
    fn line(&mut self, points: &[(f64, f64)], closed: bool, attributes: &str, title: &str) {
        let element = if closed { "polygon" } else { "polyline" };
        let points: Vec<String> = points
            .iter()
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        let attributes = format!("points=\"{}\" {attributes}", points.join(" "));
        self.shape(element, &attributes, title);
    }

    /// Words with a white rim, so that they can be read on top of anything.
    fn words(&mut self, (x, y): (f64, f64), colour: &str, words: &str) {
        let (width, _) = self.view.size();
        let anchor = if x > 0.75 * width { "end" } else { "start" };
        let x = if anchor == "end" { x - 5.0 } else { x + 5.0 };
        let _ = writeln!(
            self.text,
            "<text x=\"{x:.1}\" y=\"{:.1}\" fill=\"{colour}\" text-anchor=\"{anchor}\" paint-order=\"stroke\" \
             stroke=\"white\" stroke-width=\"3\">{}</text>",
            y - 4.0,
            escape(words)
        );
    }

    /// An arrow of `length` pixels.
    fn arrow(
        &mut self,
        (x, y): (f64, f64),
        (dx, dy): (f64, f64),
        length: f64,
        colour: &str,
        title: &str,
    ) {
        let end = (x + dx * length, y + dy * length);
        let barb = |side: f64| {
            (
                end.0 - 6.0 * dx - side * dy * 4.0,
                end.1 - 6.0 * dy + side * dx * 4.0,
            )
        };
        let stroke = format!("fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"");
        self.line(
            &[(x, y), end, barb(1.0), end, barb(-1.0)],
            false,
            &stroke,
            title,
        );
    }
}

/// The drawing of a component before its first step.
pub(super) fn picture(component: &Component) -> String {
    let scene = component.scene();
    let view = View::of(scene);
    let (width, height) = view.size();
    let mut svg = Svg {
        text: String::new(),
        view: &view,
    };
    let _ = writeln!(
        svg.text,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
         height=\"{height:.0}\" role=\"img\" font-family=\"sans-serif\" font-size=\"11\">\n\
         <title>{}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n\
         <clipPath id=\"domain\"><rect x=\"{MARGIN}\" y=\"{MARGIN}\" width=\"{:.1}\" height=\"{:.1}\"/></clipPath>",
        escape(&scene.title),
        width - 2.0 * MARGIN,
        height - 2.0 * MARGIN,
    );
    domain(&mut svg, scene);
    material::draw(&mut svg, component);
    devices::draw(&mut svg, scene);
    gauges::draw(&mut svg, scene);
    scale_bar(&mut svg, height);
    svg.text.push_str("</svg>\n");
    svg.text
}

/// The domain's rim, and where gravity pulls.
fn domain(svg: &mut Svg<'_>, scene: &Scene) {
    let (low, high) = (
        svg.view.place(scene.domain.lower),
        svg.view.place(scene.domain.upper),
    );
    let rim = [low, (high.0, low.1), high, (low.0, high.1)];
    let title = "domain: material must not leave it except by outflows and periodic sides";
    svg.line(
        &rim,
        true,
        "fill=\"#fafafa\" stroke=\"#bbb\" stroke-dasharray=\"2 3\"",
        title,
    );
    if let Some(down) = svg.view.direction(scene.domain.gravity) {
        let at = (svg.view.size().0 - 0.5 * MARGIN, MARGIN);
        svg.arrow(at, down, 28.0, "#777", "gravity");
        svg.words((at.0 + 12.0, at.1), "#777", "g");
    }
}

/// A length of 1, 2 or 5 times a power of ten, about a quarter of the width.
fn scale_bar(svg: &mut Svg<'_>, height: f64) {
    let wanted = 0.25 * (svg.view.size().0 - 2.0 * MARGIN) / svg.view.scale;
    let power = 10.0_f64.powf(wanted.log10().floor());
    let digit = [5.0, 2.0, 1.0]
        .into_iter()
        .find(|d| d * power <= wanted)
        .unwrap_or(1.0);
    let length = digit * power;
    let name = match length {
        l if l >= 1.0 => format!("{l:.0} m"),
        l if l >= 0.01 => format!("{:.0} cm", l * 100.0),
        l => format!("{:.3} mm", l * 1000.0),
    };
    let y = height - 0.35 * MARGIN;
    let ends = [(MARGIN, y), (MARGIN + length * svg.view.scale, y)];
    svg.line(
        &ends,
        false,
        "fill=\"none\" stroke=\"#777\" stroke-width=\"2\"",
        "scale",
    );
    svg.words((MARGIN, y - 2.0), "#777", &name);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    fn drawn(file: &str, text: &str) -> (Scene, String) {
        let scene = scene::parse(file, text).expect("it is a scene");
        let component = Component::new(&scene).expect("it builds");
        let svg = picture(&component);
        (scene, svg)
    }

    /// Every device and gauge is named, every coordinate is a number inside or near the drawing.
    fn check(scene: &Scene, svg: &str) {
        let names = scene.walls.iter().map(|w| format!("wall {}", w.name));
        let names = names
            .chain(scene.gates.iter().map(|g| format!("gate {}", g.name)))
            .chain(scene.inflows.iter().map(|i| format!("inflow {}", i.name)))
            .chain(scene.outflows.iter().map(|o| format!("outflow {}", o.name)))
            .chain(scene.gauges.iter().map(|g| format!("gauge {}", g.name)))
            .chain(
                scene
                    .materials
                    .iter()
                    .map(|m| format!("material {}", m.name)),
            );
        for name in names {
            assert!(svg.contains(&format!("<title>{name}")), "{name}");
        }
        for bad in ["NaN", ",inf", "\"inf\"", "inf,"] {
            assert!(!svg.contains(bad), "{bad} in {svg}");
        }
        assert!(svg.len() < 200_000, "{} bytes", svg.len());
    }

    #[test]
    fn everything_in_a_scene_is_drawn() {
        for (file, text) in [
            ("devices", include_str!("../../tests/scenes/devices.toml")),
            ("3d", include_str!("../../tests/scenes/devices_3d.toml")),
            ("silo", include_str!("../../tests/scenes/small_silo.toml")),
            ("drum", include_str!("../../cases/rotating_drum.toml")),
        ] {
            let (scene, svg) = drawn(file, text);
            check(&scene, &svg);
            assert_eq!(svg, drawn(file, text).1);
        }
    }

    #[test]
    fn material_is_drawn_where_it_is() {
        let text = include_str!("../../tests/scenes/small_silo.toml");
        let (scene, svg) = drawn("silo", text);
        let view = View::of(&scene);
        let (_, path) = svg.split_once("<path d=\"").expect("material is a path");
        let path = path.split('"').next().expect("it ends");
        // Runs "Mx yhW": their area is that of the body, 8 cm by 6.4 cm.
        let (mut width, mut lowest) = (0.0, 0.0_f64);
        for run in path.split('M').skip(1) {
            let (start, run) = run.split_once('h').expect("a run");
            let y = start.split(' ').nth(1).expect("two numbers");
            lowest = lowest.max(y.parse().expect("a number"));
            let run = run.split('v').next().expect("its width");
            width += run.parse::<f64>().expect("a number");
        }
        let cell = material::cell(&scene, &view);
        let area = width / view.scale * cell;
        assert!((area / (0.08 * 0.064) - 1.0).abs() < 0.02, "{area} m^2");
        let floor = view.place([0.0; 3]).1;
        assert!((lowest + cell * view.scale - floor).abs() < cell * view.scale);
    }
}
