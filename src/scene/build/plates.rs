//! The plates of gates: their points fill the corners they meet fixed walls in.

use crate::boundary::{Meets, Plate, WallPoints};
use crate::math::{Vector, dot, norm, sub};
use crate::solver::Scheme;

use super::narrow;
use super::places::{Places, STANDS, TAKEN};
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

/// What a shut plate meets at its ends by the corners of polylines that are there.
fn meets<const D: usize>(ends: &[Vector<D>; 2], corners: &[Corner<D>], dp: f64) -> [Meets; 2] {
    let axis = sub(&ends[1], &ends[0]);
    [(&ends[0], -1.0), (&ends[1], 1.0)].map(|(end, out)| {
        let met = corners
            .iter()
            .filter(|c| norm(&sub(&c.place, end)) < 0.5 * dp);
        let goes_on = |c: &&Corner<D>| {
            let along = c.next.iter().map(|next| sub(next, &c.place));
            along
                .into_iter()
                .any(|d| dot(&d, &axis) * out > COPLANAR * norm(&d) * norm(&axis))
        };
        match met.clone().find(goes_on) {
            Some(corner) => Meets::Face(corner.group),
            None if met.count() > 0 => Meets::Corner,
            None => Meets::Nothing,
        }
    })
}

/// The plates of the gates, behind fixed walls and what lies there at the start.
pub(super) fn plates<const D: usize>(
    scene: &Scene,
    walls: &WallPoints<D>,
    grains: &[Vector<D>],
    sides: &[Option<(f64, f64)>; D],
) -> Vec<Plate<D>> {
    let dp = scene.numerics.spacing;
    let corners = corners(scene);
    let rings = scene.dimension == Dimension::Axisymmetric;
    let ends = |g: &Gate| -> [Vector<D>; 2] { [narrow(&g.from), narrow(&g.to)] };
    let plate = |(n, g): (usize, &Gate)| {
        let group = (scene.walls.len() + n) as u16;
        Plate::new(
            ends(g),
            &narrow(&g.span),
            g.thickness,
            g.max_speed,
            dp,
            group,
        )
    };
    let mut plates: Vec<Plate<D>> = scene.gates.iter().enumerate().map(plate).collect();
    if scene.numerics.scheme != Scheme::Implicit {
        return plates;
    }
    let fixed = |i: &usize| {
        let wall = scene.walls.get(usize::from(walls.group[*i]));
        wall.is_some_and(|w| !w.rigid)
    };
    let fixed = (0..walls.len()).filter(fixed);
    let fixed: Vec<Vector<D>> = fixed.map(|i| walls.position[i]).collect();
    for (n, gate) in scene.gates.iter().enumerate() {
        let others = plates[..n].iter().chain(&plates[n + 1..]);
        let others: Vec<Vector<D>> = others.flat_map(Plate::shut).collect();
        let standing = Places::new(&[&fixed[..], &others].concat(), dp, sides);
        let taken = [&walls.position[..], &others, grains].concat();
        let taken = Places::new(&taken, dp, sides);
        plates[n].fill_corners(
            meets(&ends(gate), &corners, dp),
            |x| standing.has(x, STANDS),
            |x| !(rings && x[0] <= 0.0 || taken.has(x, TAKEN)),
        );
    }
    plates
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
