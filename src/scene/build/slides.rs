//! What walls that move as a whole have behind fixed planes that they slide along. It stays there, where the plane has its own points: in
//! the corner of the two each would press on its own, and both would bear what is one's.

use crate::boundary::{ROWS, WallPoints};
use crate::math::{Vector, dot, sub};

use super::narrow;
use crate::scene::{Point, Scene, Wall, WallGeometry};

/// Largest sine of the angle between what slides and a plane [1]: rounding of what was typed.
const ALONG: f64 = 1e-9;

/// A plane that a wall slides along, and that wall.
struct Slide<const D: usize> {
    group: u16,
    point: Vector<D>,
    normal: Vector<D>,
}

/// Drops the points of walls that move which lie among the rows behind a fixed plane that they slide along.
pub(super) fn drop_behind_slides<const D: usize>(scene: &Scene, points: &mut WallPoints<D>) {
    let slides = slides::<D>(scene);
    let deepest = ROWS as f64 * scene.numerics.spacing;
    let hides = |slide: &Slide<D>, x: &Vector<D>| {
        let depth = dot(&slide.normal, &sub(&slide.point, x));
        depth > 0.0 && depth < deepest
    };
    points.retain(|x, group| !slides.iter().any(|s| s.group == group && hides(s, x)));
}

fn slides<const D: usize>(scene: &Scene) -> Vec<Slide<D>> {
    let moving = scene.walls.iter().enumerate().filter(|(_, w)| w.rigid);
    let pairs = moving.flat_map(|(n, wall)| scene.walls.iter().map(move |other| (n, wall, other)));
    let slide = |(n, wall, other): (usize, &Wall, &Wall)| match &other.geometry {
        WallGeometry::Plane { point, normal } if !other.rigid && runs_along(wall, normal) => {
            Some(Slide {
                group: n as u16,
                point: narrow(point),
                normal: narrow(normal),
            })
        }
        _ => None,
    };
    pairs.filter_map(slide).collect()
}

/// Whether all of a wall that moves stays as far from planes with this unit normal as it is.
fn runs_along(wall: &Wall, normal: &Point) -> bool {
    let v = &wall.velocity;
    let turns_in_it = |axis: &Point| dot(axis, normal).abs() > 1.0 - ALONG;
    let rotation = wall.rotation.filter(|r| r.rate != 0.0);
    rotation.is_none_or(|r| turns_in_it(&r.axis))
        && dot(v, normal).abs() <= ALONG * dot(v, v).sqrt()
}
