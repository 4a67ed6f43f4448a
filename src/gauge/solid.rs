//! Where walls and gates are, by their surfaces: what says whether a place of a gauge lies inside one.
//!
//! Sums over wall particles do not tell that within a spacing of a face, where a gauge that looks for the end of
//! material must know it. Surfaces are put where they are by whoever knows how walls move.

use crate::math::{Vector, add};

/// A wall or gate at one time.
#[derive(Clone, Debug, PartialEq)]
pub enum Solid<const D: usize> {
    /// All behind a plane.
    Behind {
        /// A point of the plane [m].
        point: [f64; D],
        /// Unit normal, out of the solid.
        normal: [f64; D],
    },
    /// A box in any pose.
    Block {
        /// One corner [m].
        corner: [f64; D],
        /// The edges from there, at right angles [m]; one without length leaves nothing.
        edges: [[f64; D]; D],
    },
    /// In the plane: what lies to the right of a chain of points.
    Chain {
        /// Its points in order [m].
        points: Vec<[f64; D]>,
        /// Whether the last is joined to the first.
        closed: bool,
        /// How far it reaches to the right [m].
        depth: f64,
    },
}

impl<const D: usize> Solid<D> {
    /// The same where a rigid motion has put it: `place` says where a point of it is.
    #[must_use]
    pub fn moved(&self, place: impl Fn(&[f64; D]) -> [f64; D]) -> Self {
        let way = |from: &[f64; D], along: &[f64; D]| {
            let tip = place(&std::array::from_fn(|k| from[k] + along[k]));
            let start = place(from);
            std::array::from_fn(|k| tip[k] - start[k])
        };
        match self {
            Solid::Behind { point, normal } => Solid::Behind {
                point: place(point),
                normal: way(point, normal),
            },
            Solid::Block { corner, edges } => Solid::Block {
                corner: place(corner),
                edges: edges.map(|edge| way(corner, &edge)),
            },
            Solid::Chain {
                points,
                closed,
                depth,
            } => Solid::Chain {
                points: points.iter().map(place).collect(),
                closed: *closed,
                depth: *depth,
            },
        }
    }

    /// The same and its images over periodic sides (lower and upper side of each such axis [m]), as far as they reach between these.
    #[must_use]
    pub fn images(self, sides: &[Option<(f64, f64)>; D]) -> Vec<Self> {
        let Some((least, most)) = self.bounds() else {
            return vec![self];
        };
        let mut all = vec![self];
        for (axis, side) in sides.iter().enumerate() {
            let Some((lower, upper)) = *side else {
                continue;
            };
            let period = upper - lower;
            let first = ((lower - most[axis]) / period).ceil() as i64;
            let last = ((upper - least[axis]) / period).floor() as i64;
            let shifts = (first..=last).map(|n| n as f64 * period);
            let shifted = |by: f64| {
                let moved = move |x: &[f64; D]| {
                    std::array::from_fn(|k| x[k] + if k == axis { by } else { 0.0 })
                };
                all.iter().map(move |solid| solid.moved(moved))
            };
            all = shifts.flat_map(shifted).collect();
        }
        all
    }

    /// Smallest and largest coordinates [m]; `None` of a plane, which has none.
    fn bounds(&self) -> Option<([f64; D], [f64; D])> {
        let (corners, margin): (Vec<Vector<D>>, f64) = match self {
            Solid::Behind { .. } => return None,
            Solid::Block { corner, edges } => {
                let corners = (0..1 << D).map(|n: usize| {
                    let taken = edges.iter().enumerate().filter(|(e, _)| n >> e & 1 == 1);
                    taken.fold(*corner, |x, (_, edge)| add(&x, edge))
                });
                (corners.collect(), 0.0)
            }
            Solid::Chain { points, depth, .. } => (points.clone(), *depth),
        };
        let bound = |of: fn(f64, f64) -> f64, start: f64, margin: f64| {
            std::array::from_fn(|k| corners.iter().fold(start, |m, x| of(m, x[k])) + margin)
        };
        Some((
            bound(f64::min, f64::INFINITY, -margin),
            bound(f64::max, f64::NEG_INFINITY, margin),
        ))
    }

    /// Whether a place lies inside, deeper than `slack` [m]: places on a face are before it, however they are rounded.
    #[must_use]
    pub fn holds(&self, at: &[f64; D], slack: f64) -> bool {
        // Two chains that meet end to end leave nothing between them.
        self.holds_from(at, slack, 0.0)
    }

    /// Whether a place lies inside, at least so deep [m], also from the free ends of a chain: what slides past these does not.
    #[must_use]
    pub fn holds_deep(&self, at: &[f64; D], depth: f64) -> bool {
        self.holds_from(at, depth, depth)
    }

    fn holds_from(&self, at: &[f64; D], slack: f64, from_ends: f64) -> bool {
        match self {
            Solid::Behind { point, normal } => super::component(at, point, normal) < -slack,
            Solid::Block { corner, edges } => edges.iter().all(|edge| {
                let length = edge.iter().map(|e| e * e).sum::<f64>().sqrt();
                let along = super::component(at, corner, edge) / length;
                // Of an edge without length this is no number.
                along > slack && along < length - slack
            }),
            Solid::Chain {
                points,
                closed,
                depth,
            } => depth_behind(points, *closed, at, from_ends)
                .is_some_and(|d| d > slack && d < *depth),
        }
    }
}

/// How far a place lies behind a chain, from the nearest of its segments [m]; `None` before it and beyond its free ends, or nearer than
/// `from_ends` to beyond them.
fn depth_behind<const D: usize>(
    points: &[[f64; D]],
    closed: bool,
    at: &[f64; D],
    from_ends: f64,
) -> Option<f64> {
    let count = points.len() - usize::from(!closed);
    let mut best: Option<Seen> = None;
    for k in 0..count {
        let seen = seen_from(&points[k], &points[(k + 1) % points.len()], at)?;
        let kept = from_ends / seen.length;
        let free = (!closed && k == 0 && seen.share < kept)
            || (!closed && k + 1 == count && seen.share > 1.0 - kept);
        let seen = Seen { free, ..seen };
        if best.as_ref().is_none_or(|b| seen.is_nearer_than(b)) {
            best = Some(seen);
        }
    }
    best.filter(|b| b.right > 0.0 && !b.free).map(|b| b.away)
}

/// A segment, seen from a place.
struct Seen {
    /// Distance [m].
    away: f64,
    /// How far the place lies to the right of the segment's line [m].
    right: f64,
    /// Foot of the place along the segment, 0 to 1 between its ends [1].
    share: f64,
    /// Length of the segment [m].
    length: f64,
    /// Whether the nearest point is an end where the chain does not go on.
    free: bool,
}

impl Seen {
    /// At a corner both segments are as near: the one that the place is further beside says on which side it is.
    fn is_nearer_than(&self, other: &Self) -> bool {
        let same = 1e-9 * (self.away + other.away);
        if (self.away - other.away).abs() <= same {
            self.right.abs() > other.right.abs()
        } else {
            self.away < other.away
        }
    }
}

/// `None` for a segment without length.
fn seen_from<const D: usize>(a: &[f64; D], b: &[f64; D], at: &[f64; D]) -> Option<Seen> {
    let (way, to) = ([b[0] - a[0], b[1] - a[1]], [at[0] - a[0], at[1] - a[1]]);
    let length = way[0].hypot(way[1]);
    if length <= 0.0 {
        return None;
    }
    let share = (to[0] * way[0] + to[1] * way[1]) / (length * length);
    let foot = share.clamp(0.0, 1.0);
    Some(Seen {
        away: (to[0] - foot * way[0]).hypot(to[1] - foot * way[1]),
        right: (to[0] * way[1] - to[1] * way[0]) / length,
        share,
        length,
        free: false,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chain(points: &[[f64; 2]], closed: bool) -> Solid<2> {
        Solid::Chain {
            points: points.to_vec(),
            closed,
            depth: 0.4,
        }
    }

    #[test]
    fn a_tank_holds_what_is_beyond_its_sides_and_below_its_floor() {
        let tank = chain(&[[0.0, 1.0], [0.0, 0.0], [2.0, 0.0], [2.0, 1.0]], false);
        for (at, inside) in [
            ([1.0, 0.1], false),
            ([0.0, 0.5], false),
            ([1.0, -0.1], true),
            ([-0.1, 0.5], true),
            ([-0.1, -0.2], true),
            ([2.1, 0.9], true),
            ([1.0, -0.5], false),
            // Beyond the free end of a side.
            ([-0.1, 1.1], false),
        ] {
            assert_eq!(tank.holds(&at, 1e-6), inside, "{at:?}");
        }
        // Level with the free end, and below it.
        let deep = |y: f64| tank.holds_deep(&[-0.2, y], 0.1);
        assert!(tank.holds(&[-0.2, 1.0], 1e-6) && !deep(1.0) && !deep(0.95) && deep(0.8));
        assert!(!tank.holds_deep(&[-0.05, 0.5], 0.1));
    }

    #[test]
    fn the_outside_of_a_corner_is_before_both_of_its_sides() {
        // A step down: material above and beyond it.
        let step = chain(&[[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [2.0, 0.0]], false);
        for (at, inside) in [
            ([1.1, 1.1], false),
            ([0.9, 0.8], true),
            ([1.1, 0.9], false),
            ([0.8, 1.1], false),
            ([1.2, -0.1], true),
        ] {
            assert_eq!(step.holds(&at, 1e-6), inside, "{at:?}");
        }
    }

    #[test]
    fn what_a_period_has_moved_out_is_seen_on_the_other_side() {
        let sides = [Some((0.0, 1.0)), None];
        let holds = |solids: &[Solid<2>], x: f64| solids.iter().any(|s| s.holds(&[x, 0.04], 1e-6));
        let block = |x: f64| Solid::<2>::Block {
            corner: [x, 0.0],
            edges: [[0.1, 0.0], [0.0, 0.05]],
        };
        // (where its left side is, places in it, places beside it)
        for (x, inside, beside) in [
            (0.2, [0.25, 0.29], [0.19, 0.31]),
            (0.95, [0.99, 0.04], [0.94, 0.06]),
            (3.95, [0.99, 0.04], [0.94, 0.06]),
            (-2.05, [0.99, 0.04], [0.94, 0.06]),
            (8.2, [0.25, 0.29], [0.19, 0.31]),
        ] {
            let images = block(x).images(&sides);
            assert!(images.len() <= 2, "{x}: {images:?}");
            for (at, is) in [(inside, true), (beside, false)] {
                assert!(at.iter().all(|&a| holds(&images, a) == is), "{x} {at:?}");
            }
            assert_eq!(block(x).images(&[None; 2]), [block(x)]);
        }
        let paddle = chain(&[[1.5, 0.3], [1.5, 0.0], [1.7, 0.0]], false).images(&sides);
        assert!(holds(&paddle, 0.45) && !holds(&paddle, 0.55));
    }

    #[test]
    fn a_block_turns_with_its_motion_and_one_without_length_holds_nothing() {
        let block = Solid::<2>::Block {
            corner: [1.0, 0.0],
            edges: [[2.0, 0.0], [0.0, 1.0]],
        };
        assert!(block.holds(&[2.0, 0.5], 1e-6) && !block.holds(&[0.9, 0.5], 1e-6));
        let turned = block.moved(|x| [-x[1], x[0]]);
        assert!(turned.holds(&[-0.5, 2.0], 1e-6) && !turned.holds(&[0.5, 2.0], 1e-6));
        let open = Solid::<2>::Block {
            corner: [1.0, 0.0],
            edges: [[0.0, 0.0], [0.0, 1.0]],
        };
        assert!(!open.holds(&[1.0, 0.5], 1e-6));
        let floor = Solid::<3>::Behind {
            point: [0.0; 3],
            normal: [0.0, 0.0, 1.0],
        };
        let ceiling = floor.moved(|x| [x[0], -x[1], 1.0 - x[2]]);
        assert!(ceiling.holds(&[0.0, 0.0, 1.1], 1e-6) && !ceiling.holds(&[0.0, 0.0, 0.9], 1e-6));
    }
}
