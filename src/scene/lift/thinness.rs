//! Whether a wall is thick enough for its first row of points, half a spacing behind each face. Where it is measured does not hang
//! on the spacing: what one spacing passes, finer ones do.

use super::geometry::{Flat, Region};

pub(super) type Segment = (Flat, Flat);

/// Places looked at along what two sides of a wall have in common.
const PLACES: usize = 24;

/// The largest spacing [m] that the wall between the face `own` and the back of it that the face `other` makes allows, if that is less
/// than `spacing` and the body is before `other` there.
///
/// At a tip all walls are thinner than any spacing. There it counts how thick the wedge gets: a spacing at the end of its shorter
/// side, across that, half of one in its middle.
pub(super) fn most_spacing(
    own: Segment,
    other: Segment,
    region: &Region,
    spacing: f64,
    eps: f64,
) -> Option<f64> {
    let seen = |at: Flat| depth_behind(own, at);
    let ((from, low), (to, high)) = (seen(other.0), seen(other.1));
    // Back to back the other one runs against this one.
    let length = length(own);
    let (first, last) = (from.max(0.0).min(length), to.max(0.0).min(length));
    if first - last <= eps {
        return None;
    }
    let tip = thickness_at_tip(own, other, eps);
    if tip.is_some_and(|thick| thick >= spacing * ROUNDING) {
        return None;
    }
    let too_thin = |depth: f64| tip.is_some() || depth < 0.5 * spacing * ROUNDING;
    let places = (0..PLACES).map(|i| last + (i as f64 + 0.5) / PLACES as f64 * (first - last));
    let depths = places.filter_map(|place| {
        let depth = low + (high - low) * (place - from) / (to - from);
        let probes = [depth + PAST * eps, 0.5 * spacing];
        let is_met = |probe: f64| probe > depth && holds_behind(region, own, place, probe, eps);
        (depth > 0.0 && too_thin(depth) && probes.into_iter().any(is_met)).then_some(depth)
    });
    let thinnest = depths.reduce(f64::min)?;
    Some(tip.unwrap_or(2.0 * thinnest))
}

/// Less than this share of what is needed is too little.
const ROUNDING: f64 = 1.0 - 1e-9;

/// How far past a face a body that touches it is looked for, in the tolerance of touching: faces meet at sharp angles.
const PAST: f64 = 20.0;

/// Whether the way `from` - `to` crosses a segment.
pub(super) fn crossing((from, to): Segment, (a, b): Segment) -> bool {
    let (way, along, to_a) = (between(from, to), between(a, b), between(from, a));
    let slant = turn(way, along);
    let (share, place) = (turn(to_a, along) / slant, turn(to_a, way) / slant);
    // Of parallels both are no numbers.
    (0.0..=1.0).contains(&share) && (0.0..=1.0).contains(&place)
}

/// Thickness at the end of the shorter side, across it [m], if the two make an acute corner of the wall between them.
fn thickness_at_tip(own: Segment, other: Segment, eps: f64) -> Option<f64> {
    let meet = |a: Flat, b: Flat| (a[0] - b[0]).hypot(a[1] - b[1]) <= eps;
    let (before, after) = if meet(own.1, other.0) {
        (own, other)
    } else if meet(other.1, own.0) {
        (other, own)
    } else {
        return None;
    };
    let (a, b) = (between(before.0, before.1), between(after.0, after.1));
    let (sin, cos) = (-turn(a, b), -(a[0] * b[0] + a[1] * b[1]));
    (sin > 0.0 && cos > 0.0).then(|| length(own).min(length(other)) * sin / cos)
}

/// Where a point is as a face sees it: along it from its first point, and behind it [m].
fn depth_behind((a, b): Segment, point: Flat) -> (f64, f64) {
    let (t, d) = (between(a, b), between(a, point));
    let size = length((a, b));
    ((t[0] * d[0] + t[1] * d[1]) / size, -turn(t, d) / size)
}

/// Whether a region holds the point that a face sees there.
fn holds_behind(region: &Region, own: Segment, along: f64, depth: f64, eps: f64) -> bool {
    let (a, t, size) = (own.0, between(own.0, own.1), length(own));
    let x = a[0] + (along * t[0] + depth * t[1]) / size;
    let y = a[1] + (along * t[1] - depth * t[0]) / size;
    region.holds([x, y, 0.0], eps)
}

fn turn(u: Flat, v: Flat) -> f64 {
    u[0] * v[1] - u[1] * v[0]
}

fn between(u: Flat, v: Flat) -> Flat {
    [v[0] - u[0], v[1] - u[1]]
}

fn length((a, b): Segment) -> f64 {
    (b[0] - a[0]).hypot(b[1] - a[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    const EPS: f64 = 1e-9;

    /// Material above the floor y = 0, left of x = 1.
    fn above() -> Region {
        Region::block(true, [-1.0, 0.0, 0.0], [1.0, 1.0, 0.0])
    }

    #[test]
    fn a_plate_allows_twice_its_thickness() {
        let (top, under) = (([0.0, 0.0], [0.5, 0.0]), ([0.5, -0.02], [0.0, -0.02]));
        let most = |spacing| most_spacing(under, top, &above(), spacing, EPS);
        assert!((most(0.05).unwrap() - 0.04).abs() < 1e-9);
        assert_eq!(most(0.04), None);
        // Nothing is before the other side.
        assert_eq!(most_spacing(top, under, &above(), 0.05, EPS), None);
    }

    /// Acceptance goes on to finer spacings, and what is named is accepted.
    #[test]
    fn a_tip_is_no_thin_wall_and_a_wedge_of_less_than_a_spacing_is() {
        for degrees in [3.0_f64, 20.0, 30.0, 40.0, 44.0, 46.0, 60.0, 85.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let (top, under) = (
                ([-0.5, 0.0], [0.0, 0.0]),
                ([0.0, 0.0], [-0.1 * cos, -0.1 * sin]),
            );
            let most = |spacing| most_spacing(under, top, &above(), spacing, EPS);
            let thick = 0.1 * sin / cos;
            for n in 1..200 {
                let spacing = thick * f64::from(n) / 100.0;
                match most(spacing) {
                    None => assert!(spacing <= thick * (1.0 + 1e-8), "{degrees} {spacing}"),
                    Some(least) => {
                        assert!(spacing > thick && (least - thick).abs() < 1e-9);
                        assert_eq!(most(least), None);
                    }
                }
            }
        }
    }

    #[test]
    fn a_wall_that_gets_thinner_is_refused_by_one_figure() {
        let (top, under) = (([-0.5, 0.0], [0.0, 0.0]), ([0.0, -0.005], [-0.5, -0.1]));
        let most = |spacing| most_spacing(under, top, &above(), spacing, EPS);
        let first = most(0.05).unwrap();
        assert_eq!(most(0.02), Some(first));
        assert_eq!(most(first), None);
    }
}
