//! How deep wall points lie behind the surface of their wall: what Morris ghosts of scheme `paper_a` are made of.

use crate::boundary::WallPoints;
use crate::math::{Vector, dot, sub};

use super::{Scene, WallGeometry, narrow};

/// Distance of each point behind its wall's plane or segment [m], half a spacing or more.
pub(super) fn ghost_depth<const D: usize>(scene: &Scene, walls: &WallPoints<D>) -> Vec<f64> {
    let least = 0.25 * scene.numerics.spacing;
    let depth = |point: usize| {
        let (x, normal) = (&walls.position[point], &walls.normal[point]);
        let behind = |on: &Vector<D>| dot(&sub(on, x), normal);
        match &scene.walls[usize::from(walls.group[point])].geometry {
            // Segments of one direction differ in how far the point is behind them; it was made by the nearest.
            WallGeometry::Polyline { points, closed } => segments(points, *closed)
                .filter(|(_, across)| dot(&narrow::<D>(across), normal) > 1.0 - 1e-9)
                .map(|(corner, _)| behind(&narrow(&corner)))
                .filter(|d| *d > least)
                .fold(f64::INFINITY, f64::min),
            WallGeometry::Plane { point, .. } => behind(&narrow(point)),
            WallGeometry::Box { .. } => f64::INFINITY,
        }
    };
    (0..walls.len()).map(depth).collect()
}

/// First corner and unit normal (to the left) of each segment.
fn segments(points: &[[f64; 2]], closed: bool) -> impl Iterator<Item = ([f64; 3], [f64; 3])> + '_ {
    let count = if closed {
        points.len()
    } else {
        points.len() - 1
    };
    (0..count).map(move |s| {
        let (a, b) = (points[s], points[(s + 1) % points.len()]);
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx.hypot(dy);
        ([a[0], a[1], 0.0], [-dy / length, dx / length, 0.0])
    })
}
