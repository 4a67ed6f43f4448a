//! Bends of polylines: sides that turn gently stand for an arc, and what slides along them turns about its centre.
//!
//! Symbols: c centre of the arc, t directions of the sides, e how far from their corner it touches them.

use super::points::{Polyline, ROWS};
use crate::math::{add, dot, norm, scale, sub};

/// Largest angle between sides of a bend [rad]: those of a circle of four spacings' radius. Beyond it they make a corner.
const GENTLE: f64 = 0.5;
/// Least angle: below it sides go straight on [rad].
const STRAIGHT: f64 = 1e-6;
/// Most of a side that an arc takes, and its least radius, in spacings [1].
const LONGEST: f64 = 2.0;
const NARROWEST: f64 = 3.5;
/// How far points may lie beside the arc's ends and still be of it, over the spacing: rounding.
const BESIDE: f64 = 1e-6;

/// The arc that touches both sides of a corner at the same distance from it: of a regular polygon the circle within.
struct Arc {
    centre: [f64; 2],
    radius: f64,
    /// Directions of the sides, and where it touches them.
    sides: [[f64; 2]; 2],
    ends: [[f64; 2]; 2],
}

impl Arc {
    /// `sides`: direction and length of the sides before and after the corner.
    fn new(corner: &[f64; 2], sides: [([f64; 2], f64); 2], spacing: f64) -> Option<Self> {
        let [(before, a), (after, b)] = sides;
        let turn = before[0] * after[1] - before[1] * after[0];
        let angle = turn.atan2(dot(&before, &after));
        let reach = (0.5 * a.min(b)).min(LONGEST * spacing);
        let radius = reach / (0.5 * angle.abs()).tan();
        if !(STRAIGHT..=GENTLE).contains(&angle.abs()) || radius < NARROWEST * spacing {
            return None;
        }
        let ends = [
            add(corner, &scale(-reach, &before)),
            add(corner, &scale(reach, &after)),
        ];
        // To the left where it turns left.
        let to_centre = scale(radius.copysign(angle), &[-before[1], before[0]]);
        Some(Self {
            centre: add(&ends[0], &to_centre),
            radius,
            sides: [before, after],
            ends,
        })
    }

    /// Whether a point in a row `depth` at most behind the face lies beside the arc.
    fn has(&self, x: &[f64; 2], depth: f64, spacing: f64) -> bool {
        let [before, after] = &self.sides;
        let along = dot(&sub(x, &self.ends[0]), before).min(dot(&sub(&self.ends[1], x), after));
        let arm = sub(x, &self.centre);
        let towards = sub(
            &add(&self.ends[0], &self.ends[1]),
            &scale(2.0, &self.centre),
        );
        along > -BESIDE * spacing
            && dot(&arm, &towards) > 0.0
            && (norm(&arm) - self.radius).abs() < depth
    }
}

/// From each of a polyline's points ([`joined_points`](super::joined_points)) to the centre of the bend that it lies in; 0 on
/// straight sides.
#[must_use]
pub fn to_centres(
    corners: &[[f64; 2]],
    closed: bool,
    joints: [Option<[f64; 2]>; 2],
    points: &[([f64; 2], [f64; 2], f64)],
    spacing: f64,
) -> Vec<[f64; 2]> {
    let polyline = Polyline {
        corners,
        closed,
        joints,
    };
    let depth = (ROWS + 1) as f64 * spacing;
    let arc = |c| {
        let [before, after] = polyline.sides_at(c);
        let corner = &corners[c % corners.len()];
        Arc::new(corner, [before?, after?], spacing)
    };
    let arcs: Vec<Arc> = (0..=polyline.segments()).filter_map(arc).collect();
    let of_side = |arc: &Arc, n: &[f64; 2]| {
        let on_left = |t: &[f64; 2]| n[0] == -t[1] && n[1] == t[0];
        arc.sides.iter().any(on_left)
    };
    let to_centre = |(x, n, _): &([f64; 2], [f64; 2], f64)| {
        let mut own = arcs.iter().filter(|arc| of_side(arc, n));
        let found = own.find(|arc| arc.has(x, depth, spacing));
        found.map_or([0.0; 2], |arc| sub(&arc.centre, x))
    };
    points.iter().map(to_centre).collect()
}

#[cfg(test)]
mod tests {
    use super::super::points::joined_points;
    use super::*;

    fn centres(corners: &[[f64; 2]], closed: bool) -> Vec<([f64; 2], [f64; 2])> {
        let points = joined_points(corners, closed, [None; 2], 0.1);
        let centres = to_centres(corners, closed, [None; 2], &points, 0.1);
        points.iter().map(|p| p.0).zip(centres).collect()
    }

    #[test]
    fn all_of_a_circle_turns_about_its_centre_inside_and_outside() {
        let corner = |n: usize| {
            let (sin, cos) = (std::f64::consts::TAU * n as f64 / 40.0).sin_cos();
            [1.0 + 1.27 * cos, 2.0 + 1.27 * sin]
        };
        let mut corners: Vec<[f64; 2]> = (0..40).map(corner).collect();
        for _ in 0..2 {
            for (x, to) in centres(&corners, true) {
                let centre = add(&x, &to);
                assert!(norm(&sub(&centre, &[1.0, 2.0])) < 1e-9, "{x:?}: {centre:?}");
            }
            corners.reverse();
        }
    }

    #[test]
    fn sharp_corners_and_straight_sides_have_no_centre() {
        let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let straight = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]];
        for (corners, closed) in [(&square[..], true), (&straight[..], false)] {
            let all = centres(corners, closed);
            assert!(all.iter().all(|(_, to)| *to == [0.0; 2]));
        }
        // A gentle one, only where it is.
        let all = centres(&[[0.0, 0.0], [2.0, 0.0], [4.0, 0.6]], false);
        for (x, to) in &all {
            let near = (x[0] - 2.0).abs() < 0.15;
            assert!(!near || *to != [0.0; 2], "{x:?}");
            assert!((x[0] - 2.0).abs() < 0.4 || *to == [0.0; 2], "{x:?}");
        }
    }
}
