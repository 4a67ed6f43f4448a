//! Curves over an axis as SVG.

use plotters::coord::Shift;
use plotters::prelude::*;

/// Okabe and Ito's colours, seven of them: also told apart by colour-blind readers.
pub const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(60, 60, 60),
];

const SIZE: (u32, u32) = (900, 420);
const LEGEND: u32 = 250;

/// How a curve is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Look {
    /// A line: what was computed.
    Line,
    /// A thin line: an exact solution or a law.
    Thin,
    /// Dots: data.
    Dots,
}

/// One curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Name in the legend; one without has no place there.
    pub name: String,
    /// Points, in order.
    pub points: Vec<(f64, f64)>,
    /// Line or dots.
    pub look: Look,
    /// Which of [`COLOURS`], counted round.
    pub colour: usize,
}

impl Curve {
    /// A curve.
    #[must_use]
    pub fn new(
        name: impl Into<String>,
        points: Vec<(f64, f64)>,
        look: Look,
        colour: usize,
    ) -> Self {
        Self {
            name: name.into(),
            points,
            look,
            colour,
        }
    }
}

/// A chart with linear axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    /// What the x axis shows, with its unit.
    pub x: String,
    /// What the y axis shows, with its unit.
    pub y: String,
    /// The curves.
    pub curves: Vec<Curve>,
}

impl Chart {
    /// Draws it.
    ///
    /// # Errors
    /// What the drawing library says.
    pub fn svg(&self) -> Result<String, String> {
        self.draw().map_err(|error| error.to_string())
    }

    fn draw(&self) -> Result<String, Box<dyn std::error::Error>> {
        let mut picture = String::new();
        {
            let root = SVGBackend::with_string(&mut picture, SIZE).into_drawing_area();
            root.fill(&WHITE)?;
            let (plot, legend) = root.split_horizontally(SIZE.0 - LEGEND);
            self.draw_plot(&plot)?;
            self.draw_legend(&legend)?;
            root.present()?;
        }
        // The library ends lines with blanks.
        let lines: Vec<&str> = picture.lines().map(str::trim_end).collect();
        Ok(lines.join("\n") + "\n")
    }

    fn draw_plot(
        &self,
        area: &DrawingArea<SVGBackend, Shift>,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let points = || self.curves.iter().flat_map(|c| c.points.iter());
        let x = limits(points().map(|p| p.0));
        let y = limits(points().map(|p| p.1));
        let mut chart = ChartBuilder::on(area)
            .margin(10)
            .x_label_area_size(42)
            .y_label_area_size(70)
            .build_cartesian_2d(x, y)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(RGBColor(225, 225, 225))
            .x_desc(&self.x)
            .y_desc(&self.y)
            .y_label_formatter(&|y| axis_number(*y))
            .x_label_formatter(&|x| axis_number(*x))
            .label_style(("sans-serif", 13))
            .axis_desc_style(("sans-serif", 14))
            .draw()?;
        for curve in &self.curves {
            let colour = COLOURS[curve.colour % COLOURS.len()];
            let shown = curve.points.iter().copied();
            let shown = shown.filter(|(x, y)| x.is_finite() && y.is_finite());
            match curve.look {
                Look::Dots => {
                    chart.draw_series(shown.map(|p| Circle::new(p, 3, colour.filled())))?;
                }
                look => {
                    chart.draw_series(LineSeries::new(shown, colour.stroke_width(width(look))))?;
                }
            }
        }
        Ok(())
    }

    fn draw_legend(
        &self,
        area: &DrawingArea<SVGBackend, Shift>,
    ) -> Result<(), Box<dyn std::error::Error>> {
        let named = self.curves.iter().filter(|c| !c.name.is_empty());
        for (index, curve) in named.enumerate() {
            let colour = COLOURS[curve.colour % COLOURS.len()];
            let y = 24 + 21 * i32::try_from(index)?;
            match curve.look {
                Look::Dots => area.draw(&Circle::new((18, y), 3, colour.filled()))?,
                look => {
                    let style = colour.stroke_width(width(look));
                    area.draw(&PathElement::new(vec![(6, y), (30, y)], style))?;
                }
            }
            area.draw(&Text::new(
                curve.name.clone(),
                (38, y - 6),
                ("sans-serif", 13),
            ))?;
        }
        Ok(())
    }
}

fn width(look: Look) -> u32 {
    match look {
        Look::Thin => 1,
        Look::Line | Look::Dots => 2,
    }
}

/// Smallest and largest finite value with a margin, never an empty range.
fn limits(values: impl Iterator<Item = f64>) -> std::ops::Range<f64> {
    let (low, high) = values
        .filter(|v| v.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
            (low.min(v), high.max(v))
        });
    if low > high {
        return 0.0..1.0;
    }
    let margin = match high - low {
        0.0 => high.abs().max(1.0) * 0.05,
        range => range * 0.04,
    };
    low - margin..high + margin
}

/// A number for an axis: four digits, exponents only where they help.
#[must_use]
pub fn axis_number(value: f64) -> String {
    let size = value.abs();
    if size != 0.0 && !(1e-3..1e5).contains(&size) {
        return format!("{value:.2e}");
    }
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" {
        "0".to_owned()
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_and_their_names_are_in_the_picture() {
        let line = |name: &str, look| {
            Curve::new(name, vec![(0.0, 0.0), (1.0, 2.0), (f64::NAN, 1.0)], look, 0)
        };
        let chart = Chart {
            x: "time".to_owned(),
            y: "front".to_owned(),
            curves: vec![line("a line", Look::Line), line("some dots", Look::Dots)],
        };
        let svg = chart.svg().unwrap();
        for text in [
            "a line",
            "some dots",
            "time",
            "front",
            "<polyline",
            "<circle",
        ] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(!svg.contains("NaN"));
    }

    #[test]
    fn a_chart_of_nothing_is_drawn_too() {
        let chart = Chart {
            x: String::new(),
            y: String::new(),
            curves: Vec::new(),
        };
        assert!(chart.svg().unwrap().starts_with("<svg"));
        assert_eq!(limits([f64::NAN].into_iter()), 0.0..1.0);
    }
}
