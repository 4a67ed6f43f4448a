//! Profiles: values over places, a curve a moment, the later the darker.

use plotters::prelude::*;

use super::super::columns::Column;
use super::super::profile::Profile;
use super::{Area, Failed, LEGEND, WIDTH, axes, axis_number, margin, unit_title};

/// Colours of the first and the last moment.
const EARLY: [f64; 3] = [170.0, 205.0, 235.0];
const LATE: [f64; 3] = [0.0, 45.0, 110.0];
const LINE: i32 = 21;

/// Draws one; `column` is that of its first value.
pub(super) fn draw(area: &Area, profile: &Profile, column: &Column) -> Result<(), Failed> {
    let (unit, factor) = column.display_unit.unwrap_or((column.unit, 1.0));
    let (plot, legend) = area.split_horizontally(WIDTH - LEGEND);
    let values = profile.moments().flat_map(|moment| &moment.1);
    let high = values.fold(0.0_f64, |most, v| most.max(v * factor));
    let low = profile.places.iter().copied().fold(f64::INFINITY, f64::min);
    let end = profile
        .places
        .iter()
        .copied()
        .fold(f64::NEG_INFINITY, f64::max);
    let titles = (format!("{} [m]", profile.along), unit_title(unit));
    let mut chart = axes(&plot, low..end.max(low + 1e-9), margin(0.0, high), &titles)?;
    let count = profile.moments().count();
    let title = Text::new(profile.name.clone(), (6, 4), ("sans-serif", 13));
    legend.draw(&title)?;
    for (n, (time, values)) in profile.moments().enumerate() {
        let style = shade(n as f64 / (count.max(2) - 1) as f64).stroke_width(2);
        let points = profile.places.iter().zip(values);
        let points = points.map(|(x, v)| (*x, v * factor));
        chart.draw_series(LineSeries::new(points, style))?;
        let y = LINE * (1 + i32::try_from(n)?) + 4;
        legend.draw(&PathElement::new(vec![(6, y + 6), (30, y + 6)], style))?;
        let text = format!("t = {} s", axis_number(*time));
        legend.draw(&Text::new(text, (38, y), ("sans-serif", 13)))?;
    }
    Ok(())
}

fn shade(share: f64) -> RGBColor {
    let mixed = |k: usize| (EARLY[k] + share * (LATE[k] - EARLY[k])) as u8;
    RGBColor(mixed(0), mixed(1), mixed(2))
}
