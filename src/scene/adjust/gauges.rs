//! Places of gauges.

use super::{Adjustable, MILLIMETRES, Target, around};
use crate::scene::raw::{Coordinates, Length, RawGauge};
use crate::scene::types::Domain;

/// Coordinates of gauge `i`'s places.
pub(super) fn list(
    i: usize,
    name: &str,
    gauge: &RawGauge,
    domain: &Domain,
    axes: usize,
    list: &mut Vec<Adjustable>,
) {
    for (p, (point, at)) in points(gauge).into_iter().enumerate() {
        for axis in 0..axes {
            let start = at.values.get(axis).copied().unwrap_or(0.0);
            let letter = ["x", "y", "z"][axis];
            list.push(Adjustable {
                name: format!("gauge.{name}.{point}_{letter}"),
                description: format!("{letter} of `{point}`, a place of gauge {name}"),
                unit: "m",
                display_unit: MILLIMETRES,
                start,
                range: around((domain.lower[axis], domain.upper[axis]), start),
                target: Target::Gauge(i, p, axis),
            });
        }
    }
}

/// Places of a gauge that may be moved, with the names of their keys.
fn points(gauge: &RawGauge) -> Vec<(&'static str, &Coordinates<Length>)> {
    let all = match gauge {
        RawGauge::Depth(g) => vec![("foot", &g.foot)],
        RawGauge::InterfaceStress(g) => vec![("foot", &g.foot)],
        RawGauge::Profile(g) => vec![("from", &g.from), ("to", &g.to)],
        RawGauge::Discharge(g) => vec![("from", &g.from), ("to", &g.to)],
        RawGauge::Pressure(g) => vec![("at", &g.at)],
        RawGauge::Velocity(g) => vec![("at", &g.at)],
        RawGauge::Front(g) => vec![("origin", &g.origin)],
        RawGauge::Force(_) | RawGauge::Mass(_) => Vec::new(),
    };
    all.into_iter()
        .filter_map(|(name, at)| Some((name, &at.as_ref()?.value)))
        .collect()
}

/// Moves a gauge's place, counted as in [`points`].
pub(super) fn apply(gauge: &mut RawGauge, point: usize, axis: usize, value: f64) {
    let at = match (gauge, point) {
        (RawGauge::Depth(g), _) => &mut g.foot,
        (RawGauge::InterfaceStress(g), _) => &mut g.foot,
        (RawGauge::Profile(g), 0) => &mut g.from,
        (RawGauge::Profile(g), _) => &mut g.to,
        (RawGauge::Discharge(g), 0) => &mut g.from,
        (RawGauge::Discharge(g), _) => &mut g.to,
        (RawGauge::Pressure(g), _) => &mut g.at,
        (RawGauge::Velocity(g), _) => &mut g.at,
        (RawGauge::Front(g), _) => &mut g.origin,
        (RawGauge::Force(_) | RawGauge::Mass(_), _) => return,
    };
    let values = at.as_mut().map(|at| &mut at.value.values);
    if let Some(coordinate) = values.and_then(|v| v.get_mut(axis)) {
        *coordinate = value;
    }
}
