//! The plates of gates: their points fill the corners they meet fixed walls in.

use crate::boundary::{Meets, Plate, WallPoints};
use crate::math::{Vector, dot, norm, sub};
use crate::solver::Scheme;

use super::narrow;
use crate::scene::{Dimension, Gate, Scene, WallGeometry};

/// Least cosine between a gate's face and one that goes on from it [1].
const COPLANAR: f64 = 0.95;

/// A point of a fixed polyline, and those next to it.
struct Corner<const D: usize> {
    group: u16,
    place: Vector<D>,
    next: Vec<Vector<D>>,
}

fn corners<const D: usize>(scene: &Scene) -> Vec<Corner<D>> {
    let mut corners = Vec::new();
    let fixed = scene.walls.iter().enumerate().filter(|(_, w)| !w.rigid);
    for (group, wall) in fixed {
        let WallGeometry::Polyline { points, closed } = &wall.geometry else {
            continue;
        };
        let wide: Vec<Vector<D>> = points.iter().map(|x| narrow(&[x[0], x[1], 0.0])).collect();
        let n = wide.len();
        for (k, place) in wide.iter().enumerate() {
            let before = (k > 0 || *closed).then(|| wide[(k + n - 1) % n]);
            let after = (k + 1 < n || *closed).then(|| wide[(k + 1) % n]);
            corners.push(Corner {
                group: group as u16,
                place: *place,
                next: before.into_iter().chain(after).collect(),
            });
        }
    }
    corners
}

/// The plates of the gates, behind fixed walls and what lies there at the start.
pub(super) fn plates<const D: usize>(
    scene: &Scene,
    walls: &WallPoints<D>,
    grains: &[Vector<D>],
) -> Vec<Plate<D>> {
    let dp = scene.numerics.spacing;
    let number = |n: usize| (scene.walls.len() + n) as u16;
    let corners = corners(scene);
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
        let axis = sub(&ends[1], &ends[0]);
        let meets = |(end, out): (&Vector<D>, f64)| {
            let met = corners.iter().filter(|c| near(&c.place, end, 0.5));
            let goes_on = |c: &&Corner<D>| {
                let along = c.next.iter().map(|next| sub(next, &c.place));
                along
                    .into_iter()
                    .any(|d| dot(&d, &axis) * out > COPLANAR * norm(&d) * norm(&axis))
            };
            match met.clone().find(goes_on) {
                _ if ghosts => Meets::Nothing,
                Some(corner) => Meets::Face(corner.group),
                None if met.count() > 0 => Meets::Corner,
                None => Meets::Nothing,
            }
        };
        let rings = scene.dimension == Dimension::Axisymmetric;
        plate.fill_corners([meets((&ends[0], -1.0)), meets((&ends[1], 1.0))], |x| {
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
