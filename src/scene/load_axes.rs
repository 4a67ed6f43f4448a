//! The axes along which weight may rest at the start.
//!
//! Gravity mostly points against the last axis, or along a bed that the slope's lower end is on. There the way up leads along the bed for as
//! long as the layer is, though it lies across it: both axes are asked, and the one that gives a place less counts. Where the domain repeats
//! along an axis there may be no top at all: a chute that is full all round falls, and bears nothing.

use super::Scene;

/// Share of gravity's largest part along axes that do not repeat from which another part counts, too [1]. A vertical tank that stands askew by
/// a few degrees is no slope: its free sides say nothing of what its floor bears. Slopes up to 84 deg are.
const SHARE: f64 = 0.1;

/// Axes to ask, the one with most of gravity first; `up` is the one that gravity mostly points along. None where gravity has no part along
/// those that could be asked.
pub(super) fn load_axes(scene: &Scene, up: usize) -> Vec<usize> {
    let domain = &scene.domain;
    let last = scene.dimension.axes() - 1;
    // A bed lies across the last axis on slopes of up to 45 deg, and the side of a column is as free as the end of a layer.
    if up == last && !domain.periodic[up] {
        return vec![up];
    }
    let part = |axis: &usize| domain.gravity[*axis].abs();
    let mut axes: Vec<usize> = (0..=last).rev().collect();
    let fixed = axes.iter().filter(|axis| !domain.periodic[**axis]);
    let largest = fixed.map(part).fold(0.0, f64::max);
    axes.retain(|axis| part(axis) > 0.0 && part(axis) >= SHARE * largest);
    axes.sort_by(|a, b| part(b).total_cmp(&part(a)));
    axes
}

/// Whether loads ask where walls are: [`load_axes`] has several, or one that repeats.
pub(super) fn asks_for_walls(scene: &Scene) -> bool {
    let up = scene.up();
    let main = (0..3).find(|axis| up[*axis] != 0.0).unwrap_or(0);
    let axes = load_axes(scene, main);
    axes.len() > 1 || axes.iter().any(|axis| scene.domain.periodic[*axis])
}
