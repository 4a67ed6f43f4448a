//! Profiles and fronts beside those of the discs.

use super::discs::{COLUMNS, Discs, HEIGHT, fall};
use super::{TIMES, discs_at, recordings};
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::studies::columns::front;
use crate::validate::{Figure, Results};

/// Profiles of the first seed and of the discs.
pub(super) fn profiles(
    results: &Results,
    column: &Discs,
    rows: &[[f64; 4]],
) -> Result<Figure, String> {
    let mut curves = Vec::new();
    for (colour, time) in TIMES.into_iter().enumerate() {
        if let Some(depths) = recordings(results, column)
            .first()
            .and_then(|r| column.profile(r, time))
        {
            let points = depths
                .iter()
                .enumerate()
                .map(|(k, h)| (k as f64 * column.place, *h));
            curves.push(Curve::new(
                format!("t = {time} sqrt(H0/g)"),
                points.collect(),
                Look::Line,
                colour,
            ));
        }
        let known = discs_at(rows, column, time);
        if !known.is_empty() {
            curves.push(Curve::new(
                format!("t = {time}, discs"),
                known,
                Look::Dots,
                colour,
            ));
        }
    }
    let chart = Chart {
        x: "x / H0".to_owned(),
        y: "h / H0".to_owned(),
        curves,
    };
    Ok(Figure {
        name: format!("profiles_{}", column.name.replace('.', "")),
        caption: format!(
            "a = {}: profiles of the first seed (lines) and of the discs (dots).",
            column.aspect
        ),
        svg: chart.svg()?,
    })
}

/// Fronts of the first seed and of the discs over time.
pub(super) fn fronts(results: &Results, rows: &[[f64; 4]]) -> Result<Figure, String> {
    let mut curves = Vec::new();
    for (colour, column) in COLUMNS.iter().enumerate() {
        if let Some(recording) = recordings(results, column).first() {
            let points = front(recording)
                .into_iter()
                .map(|(t, x)| (t / fall(), x / HEIGHT));
            curves.push(Curve::new(
                format!("a = {}", column.aspect),
                points.collect(),
                Look::Line,
                colour,
            ));
        }
        let known = rows
            .iter()
            .filter(|row| row[0] == column.aspect)
            .map(|row| (row[1], row[2]));
        curves.push(Curve::new(
            format!("a = {}, discs", column.aspect),
            known.collect(),
            Look::Dots,
            colour,
        ));
    }
    let chart = Chart {
        x: "t / sqrt(H0/g)".to_owned(),
        y: "front / H0".to_owned(),
        curves,
    };
    Ok(Figure {
        name: "fronts".to_owned(),
        caption: "Front over time of the first seed and of the discs.".to_owned(),
        svg: chart.svg()?,
    })
}
