//! Pair coefficients of the current positions, kept by blocks of rows, four neighbours to a group.

use crate::math::{LANES, Quad, Tensor, Vector};

use super::barrier::Rub;
use super::meeting::KINDS;
use super::mirror::Image;
use super::reflect::Reflection;
use super::wall_contact::Contact;

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
    /// k[a][b][c] = sum P_ab g_c, and what turns in bends.
    pub(super) k: [Tensor<D>; D],
    /// q[a][c] = sum (P v_w)_a g_c, and what turns in bends and with walls.
    pub(super) q: Tensor<D>,
    /// sum c (P g)(P g)^T, pair form.
    pub(super) c: Tensor<D>,
    /// sum c (P g)(P g)^T v_w.
    pub(super) cv: Vector<D>,
    /// What the lattices' phase made of s along the one flat face that material slides along, and s lacks (`flat_face`); else 0.
    pub(super) phase: Vector<D>,
    /// 4 k (N - 1/2) of (W5) [m^2/s^2] and its acceleration [m/s^2]; 0 in front of walls.
    pub(super) barrier: f64,
    pub(super) push: Vector<D>,
    /// What rubs by that push, and the acceleration of it in this step [m/s^2].
    pub(super) rub: Rub<D>,
    pub(super) grip: Vector<D>,
    /// Of what shear stress goes on into walls of: sum (I - n n^T) |F| V (n.x)^2 over points without slip, how far it is carried on
    /// (docs/theory.md, W4, W14); else 0.
    pub(super) lean: Tensor<D>,
    /// Of the same: sum over these faces of |sum g| [1/m].
    pub(super) sticking: f64,
    /// What images take from it.
    pub(super) lean_less: Tensor<D>,
    /// L of (W7) before it is bounded: sum |F| V x x^T, the points' part of M, of fluids and of grains with full pores; of dry grains that
    /// bear a fluid with x along each smooth face (W10); else 0.
    pub(super) moment: Tensor<D>,
    /// sum |F| V x (x.v_w) of the same, v_w the points' velocity; else 0.
    pub(super) moment_drive: Vector<D>,
    /// a* - g of (W7) in this step, or a_q of (W10), times what of L is kept [m/s^2].
    pub(super) carried: Vector<D>,
    /// Of bends and turning walls: what M lacks of the identity, over the trace of the walls' part of it; else 0.
    pub(super) lack: Tensor<D>,
    /// Range of its images in the block.
    pub(super) images: (u32, u32),
    pub(super) reflections: (u32, u32),
}

/// A chunk of rows.
///
/// A group is four pairs of one row: j neighbours; g = V_j grad_i W_ij [1/m]; c = 2 (D + 2)/(|g| r) [m^2], so that
/// c (v.g) g is the pair form of viscosity, multiplied by eta_ij in `pressure`. Rows end with pairs of a particle with
/// itself, g = 0, that fill the last group.
#[derive(Debug, Default)]
pub(super) struct Block<const D: usize> {
    /// Neighbours of all rows; what lies behind the last row's end is left from earlier.
    neighbours: Vec<u32>,
    /// Wall points of all rows, likewise.
    walls: Vec<u32>,
    /// Where each row's neighbours and wall points end.
    ends: Vec<(u32, u32)>,
    /// Where those of the row in hand end.
    filled: (usize, usize),
    /// Neighbours within the support of the row in hand, room for the longest row.
    pub(super) near: Vec<u32>,
    /// Room to sort them by kind in; empty where all are alike.
    pub(super) found: Vec<u32>,
    /// Neighbours of each group; here and in `g` and `c` what lies behind the last row's end is left from earlier.
    pub(super) j: Vec<[u32; LANES]>,
    /// g of each group.
    pub(super) g: Vec<[Quad; D]>,
    /// c of each group.
    pub(super) c: Vec<Quad>,
    /// Where each row's groups end.
    group_ends: Vec<u32>,
    /// Where those of each kind end, but for the last (see `meeting`); empty where all are alike.
    kind_ends: Vec<[u32; KINDS - 1]>,
    /// Rows that see walls.
    pub(super) wall_rows: Vec<WallRow<D>>,
    /// Images of neighbours across flat walls without slip, row after row; empty in scenes without fluids.
    pub(super) images: Vec<Image<D>>,
    /// Images across flat walls with free slip, likewise; empty in the plane.
    pub(super) reflections: Vec<Reflection<D>>,
    /// T of (F3) of each row; empty in scenes without.
    pub(super) textures: Vec<Tensor<D>>,
    /// n.M n of each row, n along gravity (F9); empty in scenes without pores.
    pub(super) transmitted: Vec<f64>,
    /// M of each row that (T1) is for, 0 of others; empty in scenes without.
    pub(super) turning: Vec<Tensor<D>>,
    /// Faces with friction that rows see, row after row; empty in scenes without.
    pub(super) contacts: Vec<Contact<D>>,
}

/// Lets `write` put up to `most` items at `end` and counts them in. Room is made once and kept: it is not cleared for each run.
// What writes may be compiled for the lanes' instructions: it must become part of its caller.
#[inline(always)]
fn append(
    list: &mut Vec<u32>,
    end: &mut usize,
    most: usize,
    write: impl FnOnce(&mut [u32]) -> usize,
) {
    if list.len() < *end + most {
        list.resize((*end + most).max(2 * list.len()), 0);
    }
    *end += write(&mut list[*end..*end + most]);
}

impl<const D: usize> Block<D> {
    pub(super) fn clear(&mut self) {
        self.filled = (0, 0);
        self.ends.clear();
        self.near.clear();
    }

    /// Adds to the row in hand those of `most` neighbours that `write` puts in front and counts.
    #[inline(always)]
    pub(super) fn add_neighbours(&mut self, most: usize, write: impl FnOnce(&mut [u32]) -> usize) {
        append(&mut self.neighbours, &mut self.filled.0, most, write);
    }

    /// As `add_neighbours`, for wall points.
    #[inline(always)]
    pub(super) fn add_walls(&mut self, most: usize, write: impl FnOnce(&mut [u32]) -> usize) {
        append(&mut self.walls, &mut self.filled.1, most, write);
    }

    /// Ends the row of particle i: filled up with itself to whole groups.
    pub(super) fn end_row(&mut self, i: u32) {
        let start = self.ends.last().map_or(0, |end| end.0) as usize;
        let listed = self.filled.0 - start;
        let count = listed.next_multiple_of(LANES);
        self.add_neighbours(count - listed, |rest| {
            rest.fill(i);
            rest.len()
        });
        // Neighbours of each kind fill their last group.
        let most = count + (KINDS - 1) * LANES;
        if self.near.len() < most {
            self.near.resize(most, 0);
        }
        self.ends.push((self.filled.0 as u32, self.filled.1 as u32));
    }

    pub(super) fn rows(&self) -> usize {
        self.ends.len()
    }

    /// Neighbours of a row, out to the skin, itself among them; whole groups, the last filled with the particle itself.
    pub(super) fn row(&self, row: usize) -> &[u32] {
        let start = if row == 0 { 0 } else { self.ends[row - 1].0 };
        &self.neighbours[start as usize..self.ends[row].0 as usize]
    }

    /// Wall points near a row, out to the skin.
    pub(super) fn wall_row(&self, row: usize) -> &[u32] {
        let start = if row == 0 { 0 } else { self.ends[row - 1].1 };
        &self.walls[start as usize..self.ends[row].1 as usize]
    }

    /// Forgets groups, wall rows and contacts before a sweep makes them anew, with up to this many `more` groups a row than are listed.
    pub(super) fn forget_pairs(&mut self, more: usize) {
        // Room for all that is listed, made once: no row has to ask for it, and lanes' registers outlive what they write.
        let most = self.filled.0 / LANES + more * self.rows();
        if self.j.len() < most {
            self.j.resize(most, [0; LANES]);
            self.g.resize(most, [Quad::default(); D]);
            self.c.resize(most, Quad::default());
        }
        self.group_ends.clear();
        self.kind_ends.clear();
        self.wall_rows.clear();
        self.images.clear();
        self.reflections.clear();
        self.textures.clear();
        self.transmitted.clear();
        self.turning.clear();
        self.contacts.clear();
    }

    /// Adds a row of such groups; where its coefficients g and c belong.
    #[inline(always)]
    pub(super) fn next_row(&mut self, groups: &[[u32; LANES]]) -> (&mut [[Quad; D]], &mut [Quad]) {
        let start = self.group_ends.last().map_or(0, |end| *end as usize);
        let end = start + groups.len();
        self.group_ends.push(end as u32);
        self.j[start..end].copy_from_slice(groups);
        (&mut self.g[start..end], &mut self.c[start..end])
    }

    /// Range of a row's groups.
    #[inline(always)]
    pub(super) fn groups(&self, row: usize) -> std::ops::Range<usize> {
        let start = if row == 0 {
            0
        } else {
            self.group_ends[row - 1]
        };
        start as usize..self.group_ends[row] as usize
    }

    /// Tells how many groups the row that comes next has of the first kind, of the first two, and so on but for the last.
    #[inline(always)]
    pub(super) fn tell_kinds(&mut self, counts: [usize; KINDS - 1]) {
        let start = self.group_ends.last().map_or(0, |end| *end);
        self.kind_ends
            .push(counts.map(|count| start + count as u32));
    }

    /// Ranges of a row's groups, kind after kind.
    #[inline(always)]
    pub(super) fn kinds(&self, row: usize) -> [std::ops::Range<usize>; KINDS] {
        let all = self.groups(row);
        let [like, other, harder] = match self.kind_ends.get(row) {
            Some(ends) => ends.map(|end| end as usize),
            None => [all.end; KINDS - 1],
        };
        [all.start..like, like..other, other..harder, harder..all.end]
    }

    /// Images that a row sees.
    #[inline(always)]
    pub(super) fn images_of(&self, w: &WallRow<D>) -> &[Image<D>] {
        &self.images[w.images.0 as usize..w.images.1 as usize]
    }

    /// Those across walls with free slip.
    #[inline(always)]
    pub(super) fn reflections_of(&self, w: &WallRow<D>) -> &[Reflection<D>] {
        &self.reflections[w.reflections.0 as usize..w.reflections.1 as usize]
    }

    /// Calls `visit(j, k, g)` for the neighbours of a row, one at a time: k = 2 V_j |F| [1/m^2], g = V_j grad_i W_ij [1/m].
    /// Only before the coefficients are multiplied by viscosity.
    #[inline(always)]
    pub(super) fn for_each_pair(&self, row: usize, mut visit: impl FnMut(u32, f64, Vector<D>)) {
        let over = 1.0 / (D as f64 + 2.0);
        let range = self.groups(row);
        let groups = self.j[range.clone()]
            .iter()
            .zip(&self.g[range.clone()])
            .zip(&self.c[range]);
        for ((j, g), c) in groups {
            for (m, &j) in j.iter().enumerate() {
                let mut g_ij = [0.0; D];
                let mut g2 = 0.0;
                for k in 0..D {
                    g_ij[k] = g[k].0[m];
                    g2 += g_ij[k] * g_ij[k];
                }
                if g2 > 0.0 {
                    visit(j, over * g2 * c.0[m], g_ij);
                }
            }
        }
    }
}
