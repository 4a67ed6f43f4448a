//! Whose a push is where two walls meet (docs/theory.md, "Forces on walls").
//!
//! A wall's points behind the face of another one stand for the corner of both: were either wall to move along its normal, they
//! would come along. So a push f on such a point does the work f.v with v.n_A = v_A, v.n_B = v_B, and wall A bears (f.m_A) n_A, with
//! the dual vectors m of the normals: m_A.n_A = 1, m_A.n_B = 0. Counted to one wall alone, the other's thrust lacks 0.3 dp of the
//! pressure at its foot.
//!
//! So it is of fluids. Pressure also pushes points beside a corner along their own face, away from it, and with what lies behind the corner that
//! adds up to nothing; without that a face bears along itself what (W7) carries of a fluid's weight. Of grains, whose walls have nothing to carry,
//! each face gets the corner's push along itself instead: A what lies along n_B, and B what lies along n_A. Then no face bears
//! along itself what is not friction, and across itself each what balances the rest. Points of a wall that rubs keep theirs (`reactions`).
//!
//! Symbols: n unit normals towards the material, dp spacing.

use crate::math::{Vector, dot, norm, scale, sub};

use super::mirror::FLAT;

/// Largest |n_A.n_B| of faces that make a corner [1]: beyond it they go on from each other.
pub(crate) const PARALLEL: f64 = 0.9;

/// A particle's push on one wall point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push<const D: usize> {
    pub group: u16,
    /// Unit normal of the point's face, towards the material.
    pub normal: Vector<D>,
    /// From the particle to the point [m].
    pub to: Vector<D>,
    /// The point's part of the sum that the particle's pressure is multiplied with, V_i w F x, as it counts.
    pub reach: Vector<D>,
    /// On the particle, by the point [N s].
    pub impulse: Vector<D>,
}

impl<const D: usize> Push<D> {
    /// The part of it that a wall bears.
    pub(super) fn part(&self, group: u16, share: f64) -> Self {
        Self {
            group,
            reach: scale(share, &self.reach),
            impulse: scale(share, &self.impulse),
            ..*self
        }
    }
}

/// A point's push as two faces have it, that of the point, A, and another one, B.
pub(super) struct Corner<const D: usize> {
    /// Part of it that is a corner's, and of that A parts with to B [1].
    share: f64,
    others: f64,
    /// n_A and m_A, n_B and m_B.
    own: [Vector<D>; 2],
    other: [Vector<D>; 2],
}

impl<const D: usize> Corner<D> {
    /// (f.m_B) n_B.
    pub(super) fn across(&self, f: &Vector<D>) -> Vector<D> {
        scale(self.share * dot(&self.other[1], f), &self.other[0])
    }

    /// (f.m_A) n_A, along B; where B is one of several, its share of it.
    pub(super) fn along(&self, f: &Vector<D>) -> Vector<D> {
        scale(
            self.share / self.others * dot(&self.own[1], f),
            &self.own[0],
        )
    }
}

/// What B bears of a fluid's push on a point of A.
pub(super) fn across<const D: usize>(corner: &Corner<D>, point: &Push<D>) -> Vector<D> {
    corner.across(&point.impulse)
}

/// A face as one particle sees it.
struct Face<const D: usize> {
    group: u16,
    normal: Vector<D>,
    /// Its nearest row: the largest n.to of its points [m].
    row: f64,
}

impl<const D: usize> Face<D> {
    /// Sides of one line differ in their last bits.
    fn has(&self, push: &Push<D>) -> bool {
        self.group == push.group && dot(&self.normal, &push.normal) > 1.0 - FLAT
    }

    /// Whether the face goes on at the point without a corner.
    fn goes_on_at(&self, push: &Push<D>) -> bool {
        self.group == push.group && dot(&self.normal, &push.normal) > PARALLEL
    }

    /// How much of a point's row lies behind the face [1].
    fn covers(&self, push: &Push<D>, spacing: f64) -> f64 {
        (1.0 + (self.row - dot(&self.normal, &push.to)) / spacing).clamp(0.0, 1.0)
    }
}

/// Hands on what points behind two faces bear to the walls that it belongs to, `part` of it to B. What one particle pushes stays the
/// same in sum.
pub(super) fn part_at_corners<const D: usize>(
    pushes: &mut Vec<Push<D>>,
    spacing: f64,
    part: impl Fn(&Corner<D>, &Push<D>) -> Vector<D>,
) {
    let faces = faces(pushes);
    let shares = shares(&faces, pushes, spacing);
    for n in 0..pushes.len() {
        let push = pushes[n];
        let Some(own) = faces.iter().position(|f| f.has(&push)) else {
            continue;
        };
        let mut met: Vec<(f64, &Face<D>)> = Vec::with_capacity(D);
        for (share, face) in shares[own].iter().zip(&faces) {
            let share = share * face.covers(&push, spacing);
            if share > 0.0 {
                keep_best(&mut met, (share, face));
            }
        }
        let own = dual(&push.normal, met.iter().map(|(_, f)| f.normal));
        for (k, (share, face)) in met.iter().enumerate() {
            let others = met.iter().enumerate().filter(|(m, _)| *m != k);
            let others = std::iter::once(push.normal).chain(others.map(|(_, (_, f))| f.normal));
            let (Some(own), Some(other)) = (own, dual(&face.normal, others)) else {
                continue;
            };
            let corner = Corner {
                share: *share,
                others: met.len() as f64,
                own: [push.normal, own],
                other: [face.normal, other],
            };
            let impulse = part(&corner, &push);
            pushes[n].impulse = sub(&pushes[n].impulse, &impulse);
            pushes.push(Push {
                group: face.group,
                impulse,
                ..push
            });
        }
    }
}

fn faces<const D: usize>(pushes: &[Push<D>]) -> Vec<Face<D>> {
    let mut faces: Vec<Face<D>> = Vec::new();
    for push in pushes {
        let row = dot(&push.normal, &push.to);
        match faces.iter_mut().find(|f| f.has(push)) {
            Some(face) => face.row = face.row.max(row),
            None => faces.push(Face {
                group: push.group,
                normal: push.normal,
                row,
            }),
        }
    }
    faces
}

/// How much of a corner each face (columns) makes with each other one (rows) [1]: all of it where it stands on it, nothing where it ends a
/// row or more above it, as a lifted gate does, and nothing where one lies behind the other, as the lip of a floor behind a gate that
/// goes on from it.
fn shares<const D: usize>(faces: &[Face<D>], pushes: &[Push<D>], spacing: f64) -> Vec<Vec<f64>> {
    let is_before = |a: &Face<D>, b: &Face<D>| {
        let mut own = pushes.iter().filter(|p| a.goes_on_at(p));
        own.any(|p| dot(&b.normal, &p.to) > b.row + 0.5 * spacing)
    };
    let share = |own: &Face<D>, other: &Face<D>| {
        if own.group == other.group || dot(&own.normal, &other.normal).abs() > PARALLEL {
            return 0.0;
        }
        if !(is_before(own, other) && is_before(other, own)) {
            return 0.0;
        }
        let points = pushes.iter().filter(|p| other.has(p));
        let foot = points.fold(f64::INFINITY, |least, p| least.min(dot(&own.normal, &p.to)));
        (2.0 - (foot - own.row) / spacing).clamp(0.0, 1.0)
    };
    let row = |own| faces.iter().map(|other| share(own, other)).collect();
    faces.iter().map(row).collect()
}

/// Adds a face to those that a point's push is parted among: one of each wall, at most one fewer than dimensions.
fn keep_best<'a, const D: usize>(met: &mut Vec<(f64, &'a Face<D>)>, new: (f64, &'a Face<D>)) {
    let full = met.len() + 1 >= D;
    match met.iter_mut().find(|(_, f)| f.group == new.1.group) {
        Some(same) if new.0 > same.0 => *same = new,
        Some(_) => {}
        None if full => {}
        None => met.push(new),
    }
}

/// The vector m in the span of `n` and `others` with m.n = 1 and m.o = 0 for all others; `None` where `n` is nearly one of their sums.
fn dual<const D: usize>(
    n: &Vector<D>,
    others: impl Iterator<Item = Vector<D>>,
) -> Option<Vector<D>> {
    let mut basis: Vec<Vector<D>> = Vec::with_capacity(D);
    let without = |v: &Vector<D>, basis: &[Vector<D>]| {
        basis.iter().fold(*v, |v, b| sub(&v, &scale(dot(&v, b), b)))
    };
    for other in others {
        let rest = without(&other, &basis);
        let length = norm(&rest);
        if length > 1.0 - PARALLEL {
            basis.push(scale(1.0 / length, &rest));
        }
    }
    let m = without(n, &basis);
    let along = dot(&m, n);
    (along > 1.0 - PARALLEL).then(|| scale(1.0 / along, &m))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::add;

    const DP: f64 = 0.1;

    /// What a particle at `x` pushes with 1/r^2 away from each of the points.
    fn pushes<const D: usize>(
        x: Vector<D>,
        points: impl Iterator<Item = (u16, Vector<D>, Vector<D>)>,
    ) -> Vec<Push<D>> {
        let push = |(group, normal, point)| {
            let to = sub(&point, &x);
            let impulse = scale(-1.0 / dot(&to, &to), &to);
            Push {
                group,
                normal,
                to,
                reach: impulse,
                impulse,
            }
        };
        points.map(push).collect()
    }

    fn sum<const D: usize>(pushes: &[Push<D>], of: impl Fn(u16) -> bool) -> Vector<D> {
        let own = pushes.iter().filter(|p| of(p.group));
        own.fold([0.0; D], |sum, p| add(&sum, &p.impulse))
    }

    /// A gate (1) `lift` rows above a floor (0) that goes on under it.
    fn sluice(lift: f64) -> impl Iterator<Item = (u16, Vector<2>, Vector<2>)> {
        let place = |k: i32| (f64::from(k) + 0.5) * DP;
        let floor =
            (-4..6).flat_map(move |a| (-4..0).map(move |b| (0, [0.0, 1.0], [place(a), place(b)])));
        let gate = (-4..0).flat_map(move |a| {
            (0..6).map(move |b| (1, [1.0, 0.0], [place(a), place(b) + lift * DP]))
        });
        floor.chain(gate)
    }

    /// A gate (1) that goes on from a floor (0), whose lip goes down beside it.
    #[test]
    fn a_lip_behind_a_gate_is_none_of_its_corners() {
        let place = |k: i32| (f64::from(k) + 0.5) * DP;
        let floor = (-6..0).flat_map(|a| (-4..0).map(move |b| (a, b)));
        let floor = floor.map(|(a, b)| {
            // What is nearer to the lip than to the floor has its normal.
            let normal = if a > b { [1.0, 0.0] } else { [0.0, 1.0] };
            (0, normal, [place(a), place(b)])
        });
        let gate = (0..6).flat_map(|a| (-4..0).map(move |b| (1, [0.0, 1.0], [place(a), place(b)])));
        let before = pushes([0.5 * DP, 0.5 * DP], floor.chain(gate));
        let mut after = before.clone();
        part_at_corners(&mut after, DP, across);
        for group in 0..2 {
            assert_eq!(sum(&after, |g| g == group), sum(&before, |g| g == group));
        }
    }

    #[test]
    fn what_lies_under_a_gate_is_of_both_and_the_sum_stays() {
        let x = [0.5 * DP, 0.5 * DP];
        let before = pushes(x, sluice(0.0));
        let mut after = before.clone();
        part_at_corners(&mut after, DP, across);
        let under = before.iter().filter(|p| p.group == 0 && p.to[0] < -x[0]);
        let handed = under.fold(0.0, |sum, p| sum + p.impulse[0]);
        let gate = sum(&after, |g| g == 1);
        assert!((gate[0] - sum(&before, |g| g == 1)[0] - handed).abs() < 1e-9 * handed);
        assert!(handed > 1.0, "{handed}");
        for k in 0..2 {
            let difference = sum(&after, |_| true)[k] - sum(&before, |_| true)[k];
            assert!(difference.abs() < 1e-12);
        }
    }

    #[test]
    fn a_gate_that_is_lifted_by_a_row_has_no_corner() {
        let at = |lift| {
            let mut pushes = pushes([0.5 * DP, 0.5 * DP], sluice(lift));
            part_at_corners(&mut pushes, DP, across);
            sum(&pushes, |g| g == 0)[0]
        };
        let alone = sum(&pushes([0.5 * DP, 0.5 * DP], sluice(1.0)), |g| g == 0)[0];
        assert_eq!(at(1.0), alone);
        // In between by its share.
        assert!((at(0.5) - 0.5 * (at(0.0) + alone)).abs() < 1e-9 * at(0.0).abs().max(1.0));
    }

    #[test]
    fn what_a_moving_wall_takes_along_does_its_work() {
        // Two faces at 60 degrees, and a push on a point behind both.
        let (a, b) = ([1.0, 0.0], [-0.5, 0.75f64.sqrt()]);
        let push = [0.3, -0.8];
        let (ma, mb) = (
            dual(&a, std::iter::once(b)).unwrap(),
            dual(&b, std::iter::once(a)).unwrap(),
        );
        assert!((dot(&ma, &a) - 1.0).abs() < 1e-12 && dot(&ma, &b).abs() < 1e-12);
        let whole = add(&scale(dot(&ma, &push), &a), &scale(dot(&mb, &push), &b));
        assert!(norm(&sub(&whole, &push)) < 1e-12);
    }

    /// Of grains: what the floor has of the corner and presses up is the gate's, and the floor bears nothing along itself but for the
    /// gate's own points.
    #[test]
    fn what_grains_push_at_a_corner_goes_along_each_wall() {
        let before = pushes([0.5 * DP, 0.5 * DP], sluice(0.0));
        let mut after = before.clone();
        part_at_corners(&mut after, DP, |corner, point| corner.along(&point.impulse));
        let (floor, gate) = (sum(&after, |g| g == 0), sum(&after, |g| g == 1));
        let under = before
            .iter()
            .filter(|p| p.group == 0 && p.to[0] < -0.5 * DP);
        let up = under.fold(0.0, |sum, p| sum + p.impulse[1]);
        assert!(up > 1.0, "{up}");
        assert_eq!(floor[0], sum(&before, |g| g == 0)[0]);
        assert!((gate[1] - sum(&before, |g| g == 1)[1] - up).abs() < 1e-9 * up);
    }

    #[test]
    fn faces_that_go_on_from_each_other_keep_their_own() {
        let place = |k: i32| (f64::from(k) + 0.5) * DP;
        let floors = (-4..4).flat_map(|a| {
            (-4..0).map(move |b| (u16::from(a < 0), [0.0, 1.0], [place(a), place(b)]))
        });
        let before = pushes([0.02, 0.05], floors);
        let mut after = before.clone();
        part_at_corners(&mut after, DP, across);
        assert_eq!(after.len(), before.len());
    }
}
