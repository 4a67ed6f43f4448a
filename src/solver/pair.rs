//! Pair coefficients of the current positions, kept by blocks of rows.

use crate::math::{Tensor, Vector};

use super::wall_friction::Contact;

/// Particle i against neighbour j: all that sweeps need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<const D: usize> {
    /// Neighbour.
    pub(super) j: u32,
    /// V_j grad_i W_ij [1/m].
    pub(super) g: Vector<D>,
    /// 2 (D + 2) / (|g| r), so that c (v.g) g is the pair form of viscosity; `weigh` multiplies it by eta_ij [.. m^2].
    pub(super) c: f64,
}

/// Sums over the wall points that a particle sees. P projects on the normal at free slip, else P = I; w weight;
/// g = V_i w grad W.
#[derive(Clone, Debug)]
pub(super) struct WallRow<const D: usize> {
    /// Row within the block.
    pub(super) row: u32,
    /// sum g.
    pub(super) s: Vector<D>,
    /// sum v_w . g.
    pub(super) drive: f64,
    /// k[a][b][c] = sum P_ab g_c.
    pub(super) k: [Tensor<D>; D],
    /// q[a][c] = sum (P v_w)_a g_c.
    pub(super) q: Tensor<D>,
    /// sum c (P g)(P g)^T, pair form.
    pub(super) c: Tensor<D>,
    /// sum c (P g)(P g)^T v_w.
    pub(super) cv: Vector<D>,
}

/// A chunk of rows.
#[derive(Debug, Default)]
pub(super) struct Block<const D: usize> {
    pub(super) neighbours: Vec<u32>,
    pub(super) walls: Vec<u32>,
    ends: Vec<(u32, u32)>,
    /// Pairs within the support, row after row.
    pub(super) pairs: Vec<Pair<D>>,
    /// Where each row's pairs end.
    pub(super) pair_ends: Vec<u32>,
    /// Rows that see walls.
    pub(super) wall_rows: Vec<WallRow<D>>,
    /// Faces with friction that rows see, row after row; empty in scenes without.
    pub(super) contacts: Vec<Contact<D>>,
}

impl<const D: usize> Block<D> {
    pub(super) fn clear(&mut self) {
        self.neighbours.clear();
        self.walls.clear();
        self.ends.clear();
    }

    pub(super) fn end_row(&mut self) {
        self.ends
            .push((self.neighbours.len() as u32, self.walls.len() as u32));
    }

    pub(super) fn rows(&self) -> usize {
        self.ends.len()
    }

    /// Neighbours of a row, out to the skin.
    pub(super) fn row(&self, row: usize) -> &[u32] {
        let start = if row == 0 { 0 } else { self.ends[row - 1].0 };
        &self.neighbours[start as usize..self.ends[row].0 as usize]
    }

    /// Wall points near a row, out to the skin.
    pub(super) fn wall_row(&self, row: usize) -> &[u32] {
        let start = if row == 0 { 0 } else { self.ends[row - 1].1 };
        &self.walls[start as usize..self.ends[row].1 as usize]
    }

    /// Range of a row's pairs.
    #[inline(always)]
    pub(super) fn pair_range(&self, row: usize) -> std::ops::Range<usize> {
        let start = if row == 0 { 0 } else { self.pair_ends[row - 1] };
        start as usize..self.pair_ends[row] as usize
    }

    /// Pairs of a row.
    #[inline(always)]
    pub(super) fn pairs_of(&self, row: usize) -> &[Pair<D>] {
        &self.pairs[self.pair_range(row)]
    }
}
