//! Acute corners of a wall's body (the lip of an outlet that is cut away below, the edge of a blade): mitred rows would begin
//! dp/(2 sin(a/2)) behind a tip of angle a, and what flows past would cut across it. Points in the tip stand for it.

use super::points::{Polyline, right};
use crate::math::{add, dot, norm, scale};

/// |cos a| of an angle that counts as a right one: square corners keep their lattice.
const SQUARE: f64 = 1e-6;

/// An acute corner of the wall's body.
pub(super) struct Tip {
    /// Unit direction into the body, along the bisector.
    pub inward: [f64; 2],
    /// tan(a/2) of its angle a.
    pub slope: f64,
    /// Length of its shorter side [m]; sides of other walls are taken as long.
    pub leg: f64,
    /// Unit normals of its faces, towards the material.
    pub normals: [[f64; 2]; 2],
}

impl Polyline<'_> {
    /// The tip at corner c, if it is one: the material goes round it by more than three right angles.
    pub(super) fn tip(&self, c: usize) -> Option<Tip> {
        let [Some(before), Some(after)] = self.sides(c) else {
            return None;
        };
        let (ra, rb) = (right(&before), right(&after));
        let turns_right = before[0] * after[1] - before[1] * after[0] < 0.0;
        let m = add(&ra, &rb);
        let half = 0.5 * norm(&m);
        if !turns_right || dot(&before, &after) > -SQUARE || half <= 0.0 {
            return None;
        }
        Some(Tip {
            inward: scale(0.5 / half, &m),
            slope: half / (1.0 - half * half).sqrt(),
            leg: self.leg(c),
            normals: [ra, rb].map(|r| scale(-1.0, &r)),
        })
    }

    /// Length of the shorter of its own sides at corner c [m].
    fn leg(&self, c: usize) -> f64 {
        let lengths = self
            .sides_at(c)
            .into_iter()
            .flatten()
            .map(|(_, length)| length);
        lengths.fold(f64::INFINITY, f64::min)
    }
}

/// (position, normal, weight) of the points in the acute corners of a polyline that [`super::joined_points`] leaves to them.
///
/// A mitred row's corner point stands for dp^2 of the body. In an acute tip that is a triangle; it is cut across into slices a
/// spacing long, each with its area at its centroid, so that the first point lies 2/3 dp behind the tip whatever its angle (0.71 dp at
/// square corners). That one counts in full: with less, tips would be blunt again. Half of each has the normal of either face.
#[must_use]
pub fn tip_points(
    corners: &[[f64; 2]],
    closed: bool,
    joints: [Option<[f64; 2]>; 2],
    spacing: f64,
) -> Vec<([f64; 2], [f64; 2], f64)> {
    let polyline = Polyline {
        corners,
        closed,
        joints,
    };
    // A joint's point belongs to the polyline that starts there.
    let tips = (0..polyline.segments()).filter_map(|c| Some((corners[c], polyline.tip(c)?)));
    let mut points = Vec::new();
    for (corner, tip) in tips {
        for (depth, weight) in slices(tip.slope, tip.leg / spacing) {
            let place = add(&corner, &scale(depth * spacing, &tip.inward));
            points.extend(tip.normals.map(|normal| (place, normal, 0.5 * weight)));
        }
    }
    points
}

/// Centroids and weights, in spacings, of the slices of a tip with sides as long as `leg`. Where rows begin further back than a
/// triangle of area 1 reaches, slices reach as far.
fn slices(slope: f64, leg: f64) -> impl Iterator<Item = (f64, f64)> {
    let to_rows = 0.5 / slope;
    let most = leg / slope.hypot(1.0);
    let reach = (1.0 / slope.sqrt()).max(to_rows).min(most);
    (0..reach.ceil() as usize).map(move |n| {
        let (from, to) = (n as f64, (n as f64 + 1.0).min(reach));
        let square = to * to - from * from;
        let cube = to.powi(3) - from.powi(3);
        // All walls are as tight at their tips as at square corners.
        let weight = if n == 0 { 1.0 } else { slope * square };
        (2.0 / 3.0 * cube / square, weight)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boundary::{joined_points, polyline_points};
    use crate::math::sub;

    const DP: f64 = 0.1;

    /// A floor whose end is cut away below at this angle.
    fn lip(degrees: f64, leg: f64) -> [[f64; 2]; 3] {
        let a = f64::to_radians(degrees);
        [[-6.0, 0.0], [0.0, 0.0], [-leg * a.cos(), -leg * a.sin()]]
    }

    #[test]
    fn a_tip_has_a_full_point_at_its_end_and_its_area_behind() {
        for degrees in [30.0, 45.0, 60.0, 75.0, 89.0] {
            let corners = lip(degrees, 3.0);
            let points = tip_points(&corners, false, [None; 2], DP);
            let weight = |end: bool| {
                let at_end = |p: &&([f64; 2], [f64; 2], f64)| (norm(&p.0) < 0.7 * DP) == end;
                points.iter().filter(at_end).map(|p| p.2).sum::<f64>()
            };
            let slope = (0.5 * f64::to_radians(degrees)).tan();
            assert!((weight(true) - 1.0).abs() < 1e-9, "{degrees}");
            assert!((weight(false) - (1.0 - slope)).abs() < 1e-9, "{degrees}");
        }
    }

    #[test]
    fn corners_that_are_not_acute_have_no_tip() {
        for degrees in [90.0, 120.0, 180.0] {
            assert!(tip_points(&lip(degrees, 3.0), false, [None; 2], DP).is_empty());
        }
        // An acute bend of the material.
        let mut bend = lip(45.0, 3.0);
        bend.reverse();
        assert!(tip_points(&bend, false, [None; 2], DP).is_empty());
    }

    /// However sharp it is and however short its under side, all points lie in the body and none of the floor is bare.
    #[test]
    fn rows_stay_in_a_wedge_and_leave_no_gap() {
        for degrees in [3.0_f64, 10.0, 20.0, 30.0, 46.0, 60.0, 80.0] {
            for leg in [0.15, 0.5, 1.0, 3.0] {
                let corners = lip(degrees, leg);
                let mut points = polyline_points(&corners, false, DP);
                points.extend(tip_points(&corners, false, [None; 2], DP));
                let (sin, cos) = degrees.to_radians().sin_cos();
                for ([x, y], _, _) in &points {
                    let under = *y < x * sin / cos - 1e-9;
                    let beside = -x * cos - y * sin < leg - 1e-9;
                    assert!(*y < 0.0 && !(under && beside), "{degrees} {leg}: {x} {y}");
                }
                let mut floor: Vec<f64> = points
                    .iter()
                    .filter(|p| p.0[1] > -0.6 * DP)
                    .map(|p| p.0[0])
                    .collect();
                floor.sort_by(f64::total_cmp);
                let gap = floor.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
                assert!(gap < 2.0 * DP, "{degrees} {leg}: {gap}");
            }
        }
    }

    /// A lip of which each face is a wall of its own is the one of a single wall.
    #[test]
    fn two_walls_that_meet_make_a_whole_tip() {
        let [a, b, c] = lip(45.0, 3.0);
        let way = |a: [f64; 2], b: [f64; 2]| {
            let d = sub(&b, &a);
            scale(1.0 / norm(&d), &d)
        };
        let (floor, under) = ([a, b], [b, c]);
        let (after, before) = ([None, Some(way(b, c))], [Some(way(a, b)), None]);
        let one = tip_points(&[a, b, c], false, [None; 2], DP);
        let mut two = tip_points(&floor, false, after, DP);
        two.extend(tip_points(&under, false, before, DP));
        assert_eq!(one, two);
        let one = polyline_points(&[a, b, c], false, DP).len();
        let two = joined_points(&floor, false, after, DP).len()
            + joined_points(&under, false, before, DP).len();
        assert_eq!(one, two);
    }
}
