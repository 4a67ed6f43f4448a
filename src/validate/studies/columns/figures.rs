//! Front histories and pictures of columns.

use super::{COLUMNS, Column, GRAVITY, R0, front};
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::picture::{Panel, Picture};
use crate::validate::report::number;
use crate::validate::{Figure, Recording, Results, Snapshot};

/// Front histories in the manner of [A] Fig. 10; `name` is that of a column's member.
pub(super) fn fronts(
    results: &Results,
    name: &dyn Fn(&Column) -> String,
) -> Result<Figure, String> {
    let mut curves = Vec::new();
    for (colour, column) in COLUMNS.iter().enumerate() {
        let Some(recording) = results.finished(&name(column)) else {
            continue;
        };
        let points = front(recording)
            .into_iter()
            .map(|(t, x)| (t / column.fall(), x / R0));
        let points: Vec<_> = points.filter(|p| p.0 <= 10.0).collect();
        curves.push(Curve::new(
            format!("a = {:.2}", column.aspect),
            points,
            Look::Line,
            colour,
        ));
        let (low, high) = column.planar_band();
        let end = points_end(recording, column);
        let law = [low, high].map(|r| (end, 1.0 + r)).to_vec();
        curves.push(Curve::new(
            format!("a = {:.2}, planar law", column.aspect),
            law,
            Look::Dots,
            colour,
        ));
    }
    let chart = Chart {
        x: "t / sqrt(H0/g)".to_owned(),
        y: "front / r0".to_owned(),
        curves,
    };
    Ok(Figure {
        name: "fronts".to_owned(),
        caption: "Front over time (as [A] Fig. 10); dots: the ends of the planar law's band."
            .to_owned(),
        svg: chart.svg()?,
    })
}

/// Where the laws are drawn: at the end of the curve, over sqrt(H0/g).
fn points_end(recording: &Recording, column: &Column) -> f64 {
    let end = recording.time.last().map_or(10.0, |t| t / column.fall());
    end.min(10.0)
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
    let picture = Picture {
        lower: [-reach, 0.0],
        upper: [reach, 1.05 * column.height],
        // Of the run, which may be a coarse one.
        spacing: (2.0 * R0 * column.height / recording.particles.max(1) as f64).sqrt(),
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
