//! Pictures of the study: hydrographs of each depth, profiles of the bed, hydrographs over the spacing.

use super::{Dam, GRID, PLACES, SHARES};
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::{Figure, Recording, Report, Results};

fn chart(x: &str, y: &str, curves: Vec<Curve>) -> Result<String, String> {
    Chart {
        x: x.to_owned(),
        y: y.to_owned(),
        curves,
    }
    .svg()
}

/// Level as a line, bed as a thin one, at the three places.
fn hydrographs(found: &Recording, label: &str, curves: &mut Vec<Curve>, colour: Option<usize>) {
    for (k, (place, _)) in PLACES.iter().enumerate() {
        let name = format!("{label}x/L = {}", place.replace('_', "."));
        let colour = colour.unwrap_or(k);
        for (what, look) in [("level", Look::Line), ("silt", Look::Thin)] {
            let curve = found.curve(&format!("gauge.{what}_{place}.depth"));
            let name = if what == "level" {
                name.clone()
            } else {
                String::new()
            };
            curves.push(Curve::new(name, curve, look, colour));
        }
    }
}

fn profiles(found: &Recording) -> Vec<Curve> {
    let mut curves = Vec::new();
    for (k, time) in [0.5, 1.0, 2.0, 6.0].into_iter().enumerate() {
        if found.time.last().is_none_or(|last| *last < time - 1e-6) {
            continue;
        }
        for (what, look) in [("surface", Look::Line), ("bed", Look::Thin)] {
            let depths = found.values_at(&format!("gauge.{what}.depth"), time);
            let points = depths.unwrap_or_default().iter().enumerate();
            let points = points.map(|(k, h)| (0.02 + 0.02 * k as f64, *h));
            let name = if what == "surface" {
                format!("{time} s")
            } else {
                String::new()
            };
            curves.push(Curve::new(name, points.collect(), look, k));
        }
    }
    curves
}

pub(super) fn draw(results: &Results, dams: &[Dam], report: &mut Report) -> Result<(), String> {
    for share in SHARES {
        // The finest that is there.
        let mut of: Vec<&Dam> = dams.iter().filter(|dam| dam.share == share).collect();
        of.sort_by(|a, b| {
            b.until
                .total_cmp(&a.until)
                .then(a.spacing.total_cmp(&b.spacing))
        });
        let found = of
            .iter()
            .find_map(|dam| Some((dam, results.finished(&dam.name())?)));
        let Some((dam, found)) = found else { continue };
        let mut curves = Vec::new();
        hydrographs(found, "", &mut curves, None);
        report.figures.push(Figure {
            name: format!("levels_{share}"),
            caption: format!(
                "{share} % silt, {} mm: level (thick) and bed (thin) over time (as [B], figures 10 to 24)",
                dam.spacing
            ),
            svg: chart("time [s]", "depth [m]", curves)?,
        });
        report.figures.push(Figure {
            name: format!("profiles_{share}"),
            caption: format!(
                "{share} % silt, {} mm: surface (thick) and bed (thin); the dam stood at 1.52 m",
                dam.spacing
            ),
            svg: chart("x [m]", "depth [m]", profiles(found))?,
        });
    }
    let mut grid: Vec<&Dam> = dams.iter().filter(|dam| dam.share == GRID).collect();
    grid.sort_by(|a, b| b.spacing.total_cmp(&a.spacing));
    let mut curves = Vec::new();
    for (k, dam) in grid.iter().enumerate() {
        let Some(found) = results.finished(&dam.name()) else {
            continue;
        };
        for (what, look) in [("level", Look::Line), ("silt", Look::Thin)] {
            let curve = found.curve(&format!("gauge.{what}_1_0.depth"));
            let early = curve.into_iter().filter(|p| p.0 <= 2.0 + 1e-9).collect();
            let name = if what == "level" {
                format!("{} mm", dam.spacing)
            } else {
                String::new()
            };
            curves.push(Curve::new(name, early, look, k));
        }
    }
    report.figures.push(Figure {
        name: "grid".to_owned(),
        caption: format!("{GRID} % silt, level (thick) and bed (thin) at x/L = 1.0 by the spacing"),
        svg: chart("time [s]", "depth [m]", curves)?,
    });
    Ok(())
}
