//! Walls as elements of their surface, for scheme `paper_b`.

use crate::boundary::{Face, WallPoints, box_elements, plane_elements, polyline_elements};

use super::build::{faces_at, group, planes_beside};
use super::{ForceTarget, Scene, WallGeometry, narrow};

/// One point an element, with its length (in space its area) over that of a spacing as its weight.
pub(super) fn elements<const D: usize>(scene: &Scene) -> WallPoints<D> {
    let dp = scene.numerics.spacing;
    let mut points = WallPoints::default();
    let weight = |side: f64| (side / dp).powi(D as i32 - 1);
    for (n, wall) in scene.walls.iter().enumerate() {
        let spec = group(scene, wall.slip, false, ForceTarget::Wall(n));
        points.groups.push(spec);
        let mut add = |x, normal, side| points.push(x, [0.0; D], normal, weight(side), n as u16);
        match &wall.geometry {
            WallGeometry::Polyline {
                points: corners,
                closed,
            } => {
                for (x, normal, length) in polyline_elements(corners, *closed, dp) {
                    let wide = |v: [f64; 2]| narrow(&[v[0], v[1], 0.0]);
                    add(wide(x), wide(normal), length);
                }
            }
            WallGeometry::Box { lower, upper } => {
                for (x, normal, side) in box_elements::<D>(&narrow(lower), &narrow(upper), dp) {
                    add(x, normal, side);
                }
            }
            WallGeometry::Plane { point, normal } => {
                let normal = narrow(normal);
                let (lower, upper) = (narrow(&scene.domain.lower), narrow(&scene.domain.upper));
                let faces = faces_at(scene, n);
                let planes: Vec<Face<D>> = planes_beside(scene, n);
                for (x, share) in plane_elements::<D>(
                    (&narrow(point), &normal),
                    (&faces, &planes),
                    (&lower, &upper),
                    dp,
                ) {
                    points.push(x, [0.0; D], normal, share, n as u16);
                }
            }
        }
    }
    points
}
