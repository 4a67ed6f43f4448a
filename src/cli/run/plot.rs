//! `gauges.svg`: gauges, devices and inputs over time, one panel a unit, and profiles along their lines, one panel each, so that a
//! run can be judged at a glance.
//!
//! Counts and the solver's own figures are left to `gauges.csv`. Samples whose gauge says
//! they are not valid (empty, outside, blocked) are gaps in the curve.

mod profiles;

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::columns::Column;
use super::curve::{Curve, Point};
use super::series::Series;
use crate::validate::chart::axis_number;

const WIDTH: u32 = 1100;
const PANEL: u32 = 210;
const TITLE: u32 = 44;
const LEGEND: u32 = 280;
/// As many letters as fit beside a legend's line, and into the title's.
const LEGEND_LETTERS: usize = 38;
const TITLE_LETTERS: usize = 100;
/// More curves than this in one panel cannot be told apart.
const MOST_CURVES: usize = 6;
/// Okabe and Ito's colours: also told apart by colour-blind readers.
const COLOURS: [RGBColor; MOST_CURVES] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

type Failed = Box<dyn std::error::Error>;
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// Draws the picture.
///
/// # Errors
/// What the drawing library says; it draws into memory, so there is no file to fail on.
pub(super) fn svg(title: &str, series: &Series) -> Result<String, Failed> {
    let panels = panels(&series.columns);
    let mut picture = String::new();
    {
        let count = panels.len() + series.profiles.len();
        let height = TITLE + PANEL * u32::try_from(count.max(1))?;
        let root = SVGBackend::with_string(&mut picture, (WIDTH, height)).into_drawing_area();
        root.fill(&WHITE)?;
        let (head, body) = root.split_vertically(TITLE);
        // XML has no control characters.
        let title = shortened(&title.replace(char::is_control, " "), TITLE_LETTERS);
        head.draw(&Text::new(title, (16, 14), ("sans-serif", 20)))?;
        if count == 0 {
            let text = "this case has no gauges, gates, inflows or outflows to draw";
            body.draw(&Text::new(text, (16, 40), ("sans-serif", 15)))?;
        }
        let areas = body.split_evenly((count.max(1), 1));
        for (panel, area) in panels.iter().zip(&areas) {
            draw_panel(area, panel, series)?;
        }
        for (profile, area) in series.profiles.iter().zip(&areas[panels.len()..]) {
            profiles::draw(area, profile, &series.columns[profile.first])?;
        }
        root.present()?;
    }
    Ok(picture)
}

/// Curves that share an axis.
struct Panel<'a> {
    unit: &'static str,
    factor: f64,
    curves: Vec<&'a Column>,
}

/// Real scalars of gauges and devices by unit, in order of first appearance.
fn panels(columns: &[Column]) -> Vec<Panel<'_>> {
    let mut panels: Vec<Panel> = Vec::new();
    for column in columns.iter().filter(|c| c.curve.is_some()) {
        let (unit, factor) = column.display_unit.unwrap_or((column.unit, 1.0));
        let open = panels
            .iter_mut()
            .find(|p| p.unit == unit && p.curves.len() < MOST_CURVES);
        match open {
            Some(panel) => panel.curves.push(column),
            None => panels.push(Panel {
                unit,
                factor,
                curves: vec![column],
            }),
        }
    }
    panels
}

fn draw_panel(area: &Area, panel: &Panel, series: &Series) -> Result<(), Failed> {
    let (plot, legend) = area.split_horizontally(WIDTH - LEGEND);
    let (start, end) = series.span.unwrap_or((0.0, 1.0));
    let titles = ("time [s]".to_owned(), unit_title(panel.unit));
    let times = start..end.max(start + 1e-9);
    let mut chart = axes(&plot, times, limits(panel), &titles)?;
    for (index, column) in panel.curves.iter().enumerate() {
        let style = COLOURS[index % MOST_CURVES].stroke_width(if column.is_input { 1 } else { 2 });
        for piece in pieces(column, panel.factor) {
            chart.draw_series(LineSeries::new(thinned(piece, end - start), style))?;
        }
        let y = 22 + 22 * i32::try_from(index)?;
        let line = vec![(6, y + 6), (30, y + 6)];
        legend.draw(&PathElement::new(line, style))?;
        let suffix = if column.is_input { " (input)" } else { "" };
        let text = shortened(&format!("{}{suffix}", column.name), LEGEND_LETTERS);
        legend.draw(&Text::new(text, (38, y), ("sans-serif", 13)))?;
    }
    Ok(())
}

/// Text of at most so many letters, without its middle if it has more: names of one panel begin alike or end alike.
fn shortened(text: &str, most: usize) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= most {
        return text.to_owned();
    }
    let tail = (most - 1) / 2;
    let (head, tail) = (
        &letters[..most - 1 - tail],
        &letters[letters.len() - tail..],
    );
    head.iter().chain(&['…']).chain(tail).collect()
}

/// Empty axes with titles of x and y.
fn axes<'a, 'b>(
    plot: &'a Area<'b>,
    x: Range<f64>,
    y: Range<f64>,
    (x_title, y_title): &(String, String),
) -> Result<Chart<'a, 'b>, Failed> {
    // What is left of a zero among ticks that were added up.
    let rest = |range: &Range<f64>| 1e-9 * (range.end - range.start);
    let (x_rest, y_rest) = (rest(&x), rest(&y));
    let tick = |value: &f64, rest: f64| match value.abs() < rest {
        true => "0".to_owned(),
        false => axis_number(*value),
    };
    let mut chart = ChartBuilder::on(plot)
        .margin(8)
        .x_label_area_size(38)
        .y_label_area_size(84)
        .build_cartesian_2d(x, y)?;
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(RGBColor(225, 225, 225))
        .x_desc(x_title)
        .y_desc(y_title)
        .y_labels(6)
        .y_label_formatter(&|y| tick(y, y_rest))
        .x_label_formatter(&|x| tick(x, x_rest))
        .label_style(("sans-serif", 12))
        .axis_desc_style(("sans-serif", 13))
        .draw()?;
    Ok(chart)
}

fn unit_title(unit: &str) -> String {
    match unit {
        "1" => "share [1]".to_owned(),
        unit => format!("[{unit}]"),
    }
}

/// Smallest and largest valid value of the panel with a margin, never an empty range.
fn limits(panel: &Panel) -> Range<f64> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for column in &panel.curves {
        for (_, y) in pieces(column, panel.factor).into_iter().flatten() {
            low = low.min(y);
            high = high.max(y);
        }
    }
    if !low.is_finite() || !high.is_finite() {
        return 0.0..1.0;
    }
    margin(low, high)
}

/// Some more than this range, never an empty one.
fn margin(low: f64, high: f64) -> Range<f64> {
    let margin = match high - low {
        0.0 => high.abs().max(1.0) * 0.05,
        range => range * 0.05,
    };
    low - margin..high + margin
}

/// The curve as unbroken pieces of valid samples.
fn pieces(column: &Column, factor: f64) -> Vec<Vec<Point>> {
    let mut pieces = vec![Vec::new()];
    for point in column.curve.iter().flat_map(Curve::points) {
        match (point, pieces.last_mut()) {
            (Some((time, value)), Some(piece)) => piece.push((time, value * factor)),
            _ => pieces.push(Vec::new()),
        }
    }
    pieces.retain(|piece| !piece.is_empty());
    pieces
}

/// A long piece of a run of this length [s], with first, last, least and largest sample of every pixel: it looks the same.
fn thinned(piece: Vec<Point>, length: f64) -> Vec<Point> {
    let pixels = f64::from(WIDTH - LEGEND);
    if piece.len() < 4 * (WIDTH - LEGEND) as usize {
        return piece;
    }
    let pixel = |point: &Point| (point.0 / length * pixels).floor();
    let mut kept = Vec::new();
    for same in piece.chunk_by(|a, b| pixel(a) == pixel(b)) {
        let extreme = |order: fn(&f64, &f64) -> bool| {
            let better = |best: usize, n: usize| {
                if order(&same[n].1, &same[best].1) {
                    n
                } else {
                    best
                }
            };
            (1..same.len()).fold(0, better)
        };
        let mut shown = [0, extreme(f64::lt), extreme(f64::gt), same.len() - 1];
        shown.sort_unstable();
        for (at, n) in shown.iter().enumerate() {
            if at == 0 || shown[at - 1] != *n {
                kept.push(same[*n]);
            }
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A noisy curve of a million samples with one spike: the spike, both ends and order stay, the rest goes.
    #[test]
    fn a_long_curve_keeps_its_extremes() {
        let many = 1_000_000;
        let wave = |n: usize| {
            if n == 345_678 {
                9.0
            } else {
                (n as f64 * 0.37).sin()
            }
        };
        let curve: Vec<_> = (0..many).map(|n| (n as f64 * 1e-3, wave(n))).collect();
        let thin = thinned(curve.clone(), 1e3);
        assert!(thin.len() <= 4 * (WIDTH - LEGEND + 1) as usize);
        assert!(thin.is_sorted_by(|a, b| a.0 < b.0));
        assert!(thin.contains(&curve[345_678]));
        assert_eq!((thin.first(), thin.last()), (curve.first(), curve.last()));
        let short = curve[..100].to_vec();
        assert_eq!(thinned(short.clone(), 1e3), short);
    }

    #[test]
    fn long_names_of_one_device_stay_apart() {
        let [x, y] = ["x", "y"].map(|k| {
            shortened(
                &format!("gauge.force_on_left_tank_wall_and_floor.force_{k}"),
                38,
            )
        });
        assert_eq!(x, "gauge.force_on_left…_and_floor.force_x");
        assert_ne!(x, y);
        assert_eq!(shortened("gauge.level.depth", 38), "gauge.level.depth");
        assert_eq!(shortened("µ".repeat(39).as_str(), 38).chars().count(), 38);
    }
}
