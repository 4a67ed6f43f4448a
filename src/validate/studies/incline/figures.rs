//! Profiles and starts of flow down a plane.

use super::measure::mean_velocity;
use super::{FLOWS, START, exact_transient};
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::{Figure, Results};

/// Velocity over height, computed and exact.
pub(super) fn profiles(results: &Results) -> Result<Figure, String> {
    // Over its depth and surface velocity the profile is the same at every slope and of every material.
    let exact = (0..=50).map(|k| f64::from(k) / 50.0);
    let exact = exact.map(|z| (1.0 - (1.0 - z).powf(1.5), z)).collect();
    let mut curves = vec![Curve::new("exact", exact, Look::Thin, 6)];
    for (colour, run) in FLOWS[..6].iter().enumerate() {
        let Some(recording) = results.finished(run.name) else {
            continue;
        };
        let layer = run.layer_of(recording);
        let top = layer.dilated_depth();
        let Some(last) = recording.snapshots.last() else {
            continue;
        };
        let dots = last.position.iter().zip(&last.velocity);
        let dots = dots.map(|(x, v)| {
            (
                f64::from(v[0]) / layer.surface_velocity(),
                f64::from(x[1]) / top,
            )
        });
        curves.push(Curve::new(run.name, dots.collect(), Look::Dots, colour));
    }
    let chart = Chart {
        x: "velocity / exact surface velocity".to_owned(),
        y: "height / exact depth".to_owned(),
        curves,
    };
    Ok(Figure {
        name: "profiles".to_owned(),
        caption: "Velocity of every particle at the end over height, and the exact profile."
            .to_owned(),
        svg: chart.svg()?,
    })
}

/// Mean velocity over time after starts from rest.
pub(super) fn starts(results: &Results) -> Result<Figure, String> {
    let layer = START.layer();
    let scale = layer.mean_velocity();
    let over = |points: Vec<(f64, f64)>| -> Vec<_> {
        points
            .into_iter()
            .filter(|p| p.0 <= 10.0)
            .map(|(t, v)| (t, v / scale))
            .collect()
    };
    let mut curves = vec![Curve::new(
        "one-dimensional transient",
        over(exact_transient(&layer)),
        Look::Thin,
        0,
    )];
    if let Some(recording) = results.finished(START.name) {
        curves.push(Curve::new(
            "computed",
            over(mean_velocity(recording)),
            Look::Dots,
            1,
        ));
    }
    let chart = Chart {
        x: "time [s]".to_owned(),
        y: "mean velocity / steady mean velocity".to_owned(),
        curves,
    };
    Ok(Figure {
        name: "start".to_owned(),
        caption: "Glass beads of 5 mm on 25 degrees from rest.".to_owned(),
        svg: chart.svg()?,
    })
}
