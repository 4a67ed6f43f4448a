//! Which faces of other walls a plane or a box meets: its rows of points count from them.

use crate::boundary::{Face, ROWS};
use crate::math::{Vector, dot, sub};
use crate::scene::{Point, Scene, Wall, WallGeometry};

use super::narrow;

/// Faces of the walls that stand still to a wall and meet it.
pub(in crate::scene) fn faces_at<const D: usize>(scene: &Scene, wall: usize) -> Vec<Face<D>> {
    let dp = scene.numerics.spacing;
    let own = &scene.walls[wall];
    let others = scene.walls.iter().enumerate();
    let others = others.filter(|(n, other)| *n != wall && other.moves_with(own));
    let mut met = Vec::new();
    for (_, other) in others {
        let faces = faces_of(other);
        if let WallGeometry::Plane { .. } = other.geometry {
            met.extend(faces);
        } else {
            let corners: Vec<Vector<D>> = corners_of(other);
            if touches(own, &corners, dp) {
                met.extend(faces);
            }
        }
    }
    met
}

/// Walls that are planes, but for this one.
pub(in crate::scene) fn planes_beside<const D: usize>(scene: &Scene, wall: usize) -> Vec<Face<D>> {
    let others = scene.walls.iter().enumerate().filter(|(n, _)| *n != wall);
    others
        .filter(|(_, other)| matches!(other.geometry, WallGeometry::Plane { .. }))
        .flat_map(|(_, other)| faces_of(other))
        .collect()
}

/// (point, normal) of the faces of a wall.
fn faces_of<const D: usize>(wall: &Wall) -> Vec<Face<D>> {
    match &wall.geometry {
        WallGeometry::Plane { point, normal } => vec![(narrow(point), narrow(normal))],
        WallGeometry::Box { lower, upper } => (0..D)
            .flat_map(|k| {
                let mut normal = [0.0; D];
                normal[k] = 1.0;
                [lower, upper].map(|corner| (narrow(corner), normal))
            })
            .collect(),
        WallGeometry::Polyline { points, closed } => {
            let ends = points.iter().skip(1);
            let back = points.first().filter(|_| *closed);
            points
                .iter()
                .zip(ends.chain(back))
                .map(|(a, b)| {
                    let way = [b[0] - a[0], b[1] - a[1]];
                    let length = way[0].hypot(way[1]);
                    let normal = [-way[1] / length, way[0] / length, 0.0];
                    (narrow(&[a[0], a[1], 0.0]), narrow(&normal))
                })
                .collect()
        }
    }
}

/// Corners of a wall that has any.
fn corners_of<const D: usize>(wall: &Wall) -> Vec<Vector<D>> {
    match &wall.geometry {
        WallGeometry::Plane { .. } => Vec::new(),
        WallGeometry::Box { lower, upper } => (0..1usize << D)
            .map(|n| {
                std::array::from_fn(|k| {
                    let corner: &Point = if n >> k & 1 == 0 { lower } else { upper };
                    corner[k]
                })
            })
            .collect(),
        WallGeometry::Polyline { points, .. } => {
            points.iter().map(|x| narrow(&[x[0], x[1], 0.0])).collect()
        }
    }
}

/// Whether what spans these corners reaches to within half a spacing of a wall's face or its rows.
fn touches<const D: usize>(wall: &Wall, corners: &[Vector<D>], dp: f64) -> bool {
    let spans = |of: &dyn Fn(&Vector<D>) -> f64, lower: f64, upper: f64| {
        let (least, most) = corners
            .iter()
            .map(of)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
                (a.min(x), b.max(x))
            });
        least <= upper + 0.5 * dp && most >= lower - 0.5 * dp
    };
    match &wall.geometry {
        WallGeometry::Plane { point, normal } => {
            let (point, normal): (Vector<D>, Vector<D>) = (narrow(point), narrow(normal));
            spans(&|x| dot(&sub(x, &point), &normal), -(ROWS as f64) * dp, 0.0)
        }
        WallGeometry::Box { lower, upper } => (0..D).all(|k| spans(&|x| x[k], lower[k], upper[k])),
        WallGeometry::Polyline { .. } => false,
    }
}
