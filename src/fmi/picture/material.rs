//! Material at the start: cells that hold particles, row by row, one path a material.

use std::collections::BTreeSet;
use std::fmt::Write;

use super::{Svg, View};
use crate::component::Component;
use crate::scene::Scene;

/// Colours of materials, those of the devices left out.
pub(in crate::fmi) const COLOURS: [&str; 4] = ["#d9b365", "#009e73", "#f0e442", "#999999"];
/// Cells over the longer side of a drawing, at most.
const MOST_CELLS: f64 = 256.0;

/// Side of a cell [m]: a spacing, more for scenes of very many particles.
pub(super) fn cell(scene: &Scene, view: &View) -> f64 {
    let extent = |axis: usize| view.upper[axis] - view.lower[axis];
    let longest = extent(view.right).max(extent(view.up));
    scene.numerics.spacing.max(longest / MOST_CELLS)
}

pub(super) fn draw(svg: &mut Svg<'_>, component: &Component) {
    let scene = component.scene();
    let view = svg.view;
    let cell = cell(scene, view);
    let mut cells: BTreeSet<(u8, i64, i64)> = BTreeSet::new();
    let particles = component.particles();
    // Cells have particles at their middles: a lattice of them falls into one each, not into two by a rounding.
    let Some(first) = particles.position.first().map(|x| x.map(f64::from)) else {
        return;
    };
    for (x, phase) in particles.position.iter().zip(&particles.phase) {
        let place = |axis: usize| ((f64::from(x[axis]) - first[axis]) / cell).round() as i64;
        cells.insert((*phase, place(view.up), place(view.right)));
    }
    for (phase, material) in scene.materials.iter().enumerate() {
        let mine = cells.iter().filter(|key| usize::from(key.0) == phase);
        let mut path = String::new();
        for (row, column, count) in runs(mine.map(|key| (key.1, key.2))) {
            let mut corner = [0.0; 3];
            corner[view.right] = first[view.right] + (column as f64 - 0.5) * cell;
            let top = if view.flipped { -0.5 } else { 0.5 };
            corner[view.up] = first[view.up] + (row as f64 + top) * cell;
            let (x, y) = view.place(corner);
            let (width, height) = (count as f64 * cell * view.scale, cell * view.scale);
            // Writing to a String cannot fail.
            let _ = write!(path, "M{x:.1} {y:.1}h{width:.1}v{height:.1}h-{width:.1}z");
        }
        let colour = COLOURS[phase % COLOURS.len()];
        svg.shape(
            "path",
            &format!("d=\"{path}\" fill=\"{colour}\""),
            &format!("material {}", material.name),
        );
    }
}

/// Cells next to each other in a row as (row, first column, number).
fn runs(cells: impl Iterator<Item = (i64, i64)>) -> Vec<(i64, i64, i64)> {
    let mut runs: Vec<(i64, i64, i64)> = Vec::new();
    for (row, column) in cells {
        match runs.last_mut() {
            Some(last) if last.0 == row && last.1 + last.2 == column => last.2 += 1,
            _ => runs.push((row, column, 1)),
        }
    }
    runs
}
