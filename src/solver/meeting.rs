//! Where materials meet: whose stress acts between them (docs/theory.md, F6).
//!
//! Were water among the neighbours by which a bed's grains tell their strain rate, that would be the rate of water sliding over
//! them, and their yield stress, whatever it is, would hold the water: two rows of ten stood still over a bed that is cohesive, and one of
//! sand braked water a hundred times too much. Clay under water is no better. So for the strain rate whose stress a particle bears, and for
//! its adjoint, the force of that stress, neighbour j counts m_ij times to particle i,
//!
//!   m_ij = 2 eta_j/(eta_i + eta_j) for two fluids of different materials,
//!   m_ij = 2 if i is of a fluid and j of grains, 0 if j is and i is not, else 1;   m_ij + m_ji = 2          (F6)
//!
//! (the first with viscosities at the start of the step, where the rate they follow takes 1). An even shear stress is borne with
//! any of these; with viscosities that jump rates jump, and what the neighbour beyond an interface shows of them is the first row's exactly.
//! Grains are a wall without slip to a fluid, that moves as they do (E14), and a fluid to grains what air is.

use std::ops::Range;

use crate::math::{Four, LANES, Lanes, Vector};
use crate::state::State;

use super::Solver;
use super::pair::Block;

/// Kinds of neighbours, in the order in which rows have them.
pub(super) const KINDS: usize = 4;

/// Of the same material, or both grains: m_ij = m_ji = 1.
pub(super) const LIKE: u8 = 0;
/// Of another fluid: m by viscosities.
pub(super) const OTHER: u8 = 1;
/// Grains beside a fluid: m_ij = 2, m_ji = 0.
pub(super) const HARDER: u8 = 2;
/// A fluid beside grains: m_ij = 0, m_ji = 2.
pub(super) const SOFTER: u8 = 3;

/// Neighbours of one row within the support in whole groups, those of each kind together.
#[derive(Clone, Copy)]
pub(super) struct Neighbours<'a> {
    pub(super) all: &'a [u32],
    /// How many groups are of the first kind, of the first two and of the first three.
    pub(super) kinds: [usize; KINDS - 1],
}

impl Neighbours<'_> {
    #[inline(always)]
    pub(super) fn groups(&self) -> &[[u32; LANES]] {
        self.all.as_chunks::<LANES>().0
    }

    /// Whether there are grains among them, and they are a fluid's.
    #[inline(always)]
    pub(super) fn have_harder(&self) -> bool {
        self.kinds[OTHER as usize] < self.kinds[HARDER as usize]
    }

    /// Whether there are fluids among them, and they are a grain's.
    #[inline(always)]
    pub(super) fn have_softer(&self) -> bool {
        self.kinds[HARDER as usize] < self.groups().len()
    }
}

impl<const D: usize> Solver<D> {
    /// Sorts the `count` neighbours of particle i in `near` by kind, each filled up with i to whole groups. Returns their number, and
    /// the numbers of groups of the first kind, of the first two and of the first three. `found` is room to work in.
    pub(super) fn sort_by_kind(
        &self,
        state: &State<D>,
        i: usize,
        near: &mut [u32],
        count: usize,
        found: &mut Vec<u32>,
    ) -> (usize, [usize; KINDS - 1]) {
        let phase = &state.grains.phase;
        let own = phase[i];
        if near[..count].iter().all(|&j| phase[j as usize] == own) {
            return (count, [count / LANES; KINDS - 1]);
        }
        let is_fluid = |phase: u8| self.materials[phase as usize].is_fluid();
        let kind = |other: u8| match (is_fluid(own), is_fluid(other)) {
            (true, false) => HARDER,
            (false, true) => SOFTER,
            (true, true) if own != other => OTHER,
            _ => LIKE,
        };
        found.clear();
        found.extend(near[..count].iter().filter(|&&j| j as usize != i));
        let (mut end, mut ends) = (0, [0; KINDS]);
        for (n, done) in ends.iter_mut().enumerate() {
            for &j in found.iter() {
                if kind(phase[j as usize]) as usize == n {
                    near[end] = j;
                    end += 1;
                }
            }
            let full = end.next_multiple_of(LANES);
            near[end..full].fill(i as u32);
            end = full;
            *done = end / LANES;
        }
        (end, [ends[0], ends[1], ends[2]])
    }
}

/// m_ij of fluids of these viscosities; 0 where both have none.
#[inline(always)]
pub(super) fn share<L: Lanes>(lanes: L, own: Four<L>, other: Four<L>) -> Four<L> {
    let both = (own + other).max(Four::splat(lanes, f64::MIN_POSITIVE));
    (other + other).over(both)
}

/// sums += sum_j m_ij (v_j - v_i) (x) g_ij over groups of one KIND but the last; `own`: v_i, and `eta` viscosities.
#[inline(always)]
pub(super) fn add_differences<L: Lanes, const D: usize, const KIND: u8>(
    (lanes, block, i, eta): (L, &Block<D>, usize, &[f64]),
    range: Range<usize>,
    own: &[Four<L>; D],
    v: &[Vector<D>],
    sums: &mut [[Four<L>; D]; D],
) {
    for (j, g) in block.j[range.clone()].iter().zip(&block.g[range]) {
        let near = [
            &v[j[0] as usize],
            &v[j[1] as usize],
            &v[j[2] as usize],
            &v[j[3] as usize],
        ];
        let m = match KIND {
            OTHER => {
                let other = Four::gather(lanes, |m| eta[j[m] as usize]);
                share(lanes, Four::splat(lanes, eta[i]), other)
            }
            _ => Four::splat(lanes, if KIND == HARDER { 2.0 } else { 1.0 }),
        };
        for a in 0..D {
            let mut d = Four::gather(lanes, |m| near[m][a]) - own[a];
            if KIND != LIKE {
                d = m * d;
            }
            for b in 0..D {
                sums[a][b] += d * Four::load(lanes, &g[b]);
            }
        }
    }
}
