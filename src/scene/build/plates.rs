//! The plates of gates: their points fill the corners they meet fixed walls in.

use crate::boundary::{Plate, WallPoints};
use crate::math::{Vector, norm, sub};
use crate::solver::Scheme;

use super::narrow;
use crate::scene::{Dimension, Gate, Scene, WallGeometry};

/// The plates of the gates, behind fixed walls and what lies there at the start.
pub(super) fn plates<const D: usize>(
    scene: &Scene,
    walls: &WallPoints<D>,
    grains: &[Vector<D>],
) -> Vec<Plate<D>> {
    let dp = scene.numerics.spacing;
    let number = |n: usize| (scene.walls.len() + n) as u16;
    let mut corners: Vec<Vector<D>> = Vec::new();
    for wall in scene.walls.iter().filter(|w| !w.rigid) {
        if let WallGeometry::Polyline { points, .. } = &wall.geometry {
            let wide = |x: &[f64; 2]| narrow(&[x[0], x[1], 0.0]);
            corners.extend(points.iter().map(wide));
        }
    }
    let ghosts = scene.numerics.scheme != Scheme::Implicit;
    let plate = |(n, g): (usize, &Gate)| {
        let ends: [Vector<D>; 2] = [narrow(&g.from), narrow(&g.to)];
        let mut plate = Plate::new(
            ends,
            &narrow(&g.span),
            g.thickness,
            g.max_speed,
            dp,
            number(n),
        );
        let near = |x: &Vector<D>, y: &Vector<D>, reach: f64| norm(&sub(x, y)) < reach * dp;
        let meets = |end: &Vector<D>| !ghosts && corners.iter().any(|c| near(c, end, 0.5));
        let rings = scene.dimension == Dimension::Axisymmetric;
        plate.fill_corners(ends.each_ref().map(meets), |x| {
            let mut others = walls.position.iter().chain(grains);
            let across_the_axis = rings && x[0] <= 0.0;
            !across_the_axis && !others.any(|y| near(x, y, 0.7))
        });
        plate
    };
    scene.gates.iter().enumerate().map(plate).collect()
}

/// Points of fixed walls and, at these openings, of plates.
pub(super) fn with_plates<const D: usize>(
    walls: &WallPoints<D>,
    plates: &[Plate<D>],
    openings: &[f64],
) -> WallPoints<D> {
    let mut all = walls.clone();
    for (plate, opening) in plates.iter().zip(openings) {
        let mut plate = plate.clone();
        plate.append(&mut all);
        plate.place(&mut all, *opening, 0.0);
    }
    all
}
