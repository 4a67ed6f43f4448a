//! Front histories and pictures of columns.

use super::{Column, GRAVITY, R0, front};
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::picture::{Panel, Picture};
use crate::validate::report::number;
use crate::validate::{Figure, Results, Snapshot};

/// Front histories in the manner of [A] Fig. 10: columns, the member drawn of each, and the ends of a law's band.
pub(super) fn fronts(
    results: &Results,
    laws: &[(&Column, String, (f64, f64))],
) -> Result<Figure, String> {
    let mut curves = Vec::new();
    for (colour, (column, name, (low, high))) in laws.iter().enumerate() {
        let Some(recording) = results.finished(name) else {
            continue;
        };
        let points = front(recording)
            .into_iter()
            .map(|(t, x)| (t / column.fall(), x / R0));
        let points: Vec<_> = points.filter(|p| p.0 <= 10.0).collect();
        let end = points.last().map_or(10.0, |p| p.0);
        let title = format!("a = {:.2}", column.aspect);
        curves.push(Curve::new(title.clone(), points, Look::Line, colour));
        let law = [*low, *high].map(|r| (end, 1.0 + r)).to_vec();
        curves.push(Curve::new(format!("{title}, law"), law, Look::Dots, colour));
    }
    let chart = Chart {
        x: "t / sqrt(H0/g)".to_owned(),
        y: "front / r0".to_owned(),
        curves,
    };
    Ok(Figure {
        name: "fronts".to_owned(),
        caption:
            "Front over time (as [A] Fig. 10); dots: the law's run-out, or the ends of its band."
                .to_owned(),
        svg: chart.svg()?,
    })
}

/// Particles of one member, as [A] Figs. 11 and 12.
pub(super) fn pictures(results: &Results, column: &Column, name: &str) -> Option<Figure> {
    let recording = results.finished(name)?;
    let reach = front(recording).iter().fold(R0, |most, p| most.max(p.1)) * 1.05;
    let panel = |s: &Snapshot| Panel {
        caption: format!(
            "t = {} sqrt(H0/g)",
            number((s.time / column.fall() * 100.0).round() / 100.0)
        ),
        particles: s
            .position
            .iter()
            .zip(&s.velocity)
            .map(|(x, v)| [x[0], x[1], v[0].hypot(v[1])])
            .collect(),
    };
    let left = recording.series.contains_key("gauge.front_left.front");
    let sides = if left { 2.0 } else { 1.0 };
    let picture = Picture {
        // Rings have no left side.
        lower: [if left { -reach } else { 0.0 }, 0.0],
        upper: [reach, 1.05 * column.height],
        // Of the run, which may be a coarse one.
        spacing: (sides * R0 * column.height / recording.particles.max(1) as f64).sqrt(),
        most: (GRAVITY * column.height).sqrt(),
        label: "speed [m/s]".to_owned(),
        panels: recording.snapshots.iter().map(panel).collect(),
    };
    Some(Figure {
        name: format!("a{:03.0}", 100.0 * column.aspect),
        caption: format!(
            "a = {:.2}: particles, coloured by speed up to sqrt(g H0).",
            column.aspect
        ),
        svg: picture.svg(),
    })
}
