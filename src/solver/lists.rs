//! Neighbour lists with a skin, sorted particles, and the pieces that hang together.
//!
//! Lists are built from `Grains::listed` (the positions at that moment), so that a restored state rebuilds the same
//! lists in the same order. They stay valid while nothing has moved more than the skin allows, relative to the mean
//! motion for particles among themselves (a uniform speed costs nothing) and to walls for wall lists.

use crate::boundary::WallPoints;
use crate::math::{Arch, CHUNK, Four, LANES, Lanes, Vector, Workers, dot, in_lanes, norm, sub};
use crate::state::Grains;

use super::grid::{Grid, Near, Periodic};
use super::pair::{Block, WallRow};

/// Skin of the neighbour lists over h [1].
pub(super) const SKIN: f64 = 0.3;

/// Shortest period over h [1]: the kernel's support of 2 h and the skin on both sides of a particle, so that none meets another
/// and its image.
pub const SHORTEST_PERIOD: f64 = 2.0 * (2.0 + SKIN);

/// Neighbour lists of one state.
#[derive(Debug)]
pub(super) struct Lists<const D: usize> {
    /// Rows in chunks of `CHUNK`, with their neighbours and (per step) pair coefficients.
    pub(super) blocks: Vec<Block<D>>,
    /// Piece of each particle: connected through lists.
    pub(super) pieces: Vec<u32>,
    /// Number of pieces.
    pub(super) piece_count: usize,
    /// Radius of the lists: support + skin [m].
    reach: f64,
    skin: f64,
}

impl<const D: usize> Lists<D> {
    /// Empty lists for a support radius and a skin [m].
    pub(super) fn new(support: f64, skin: f64) -> Self {
        Self {
            blocks: Vec::new(),
            pieces: Vec::new(),
            piece_count: 0,
            reach: support + skin,
            skin,
        }
    }

    /// Whether particles have moved too far since the lists were built.
    pub(super) fn outdated(
        &self,
        grains: &Grains<D>,
        periodic: &Periodic<D>,
        wall_travel: f64,
        has_walls: bool,
        workers: &Workers,
    ) -> bool {
        let n = grains.len();
        if n == 0 {
            return false;
        }
        let moved = |i: usize| periodic.difference(&grains.position[i], &grains.listed[i]);
        let mean = workers.sums(n, moved).map(|sum| sum / n as f64);
        let [relative, absolute] = workers.largest(n, |i| {
            let d = moved(i);
            [norm(&sub(&d, &mean)), norm(&d)]
        });
        2.0 * relative > self.skin || (has_walls && absolute + wall_travel > self.skin)
    }

    /// Sorts particles by cell and notes where they are; lists must be built next.
    pub(super) fn sort(&self, grains: &mut Grains<D>, periodic: &Periodic<D>) {
        let keep: Vec<u32> = (0..grains.len() as u32)
            .filter(|&i| !grains.drained[i as usize])
            .collect();
        if keep.len() < grains.len() {
            grains.reorder(&keep);
        }
        let grid = Grid::build(&grains.position, self.reach, periodic);
        grains.reorder(grid.order());
        grains.listed.clone_from(&grains.position);
    }

    /// Builds lists from the noted positions.
    pub(super) fn build(
        &mut self,
        grains: &Grains<D>,
        walls: &WallPoints<D>,
        periodic: &Periodic<D>,
        (workers, arch): (&Workers, Arch),
    ) {
        let n = grains.len();
        let x = &grains.listed;
        let grid = Grid::build(x, self.reach, periodic);
        let wall_grid = Grid::build(&walls.position, self.reach, periodic);
        let reach2 = self.reach * self.reach;
        self.blocks.resize_with(n.div_ceil(CHUNK), Block::default);
        let mut rows = vec![(); n];
        workers.blocks(&mut self.blocks, &mut rows, |block, first, part| {
            block.clear();
            let (mut near, mut near_walls) = (Near::new(), Near::new());
            in_lanes!(arch, |lanes| for i in first..first + part.len() {
                grid.find_runs(&x[i], &mut near);
                for run in &near.runs {
                    let points = grid.points(run);
                    block.add_neighbours(points.len() + LANES, |list| {
                        keep_near(lanes, list, points, &x[i], x, periodic, reach2)
                    });
                }
                wall_grid.find_runs(&x[i], &mut near_walls);
                for run in &near_walls.runs {
                    let points = wall_grid.points(run);
                    block.add_walls(points.len() + LANES, |list| {
                        keep_near(
                            lanes,
                            list,
                            points,
                            &x[i],
                            &walls.position,
                            periodic,
                            reach2,
                        )
                    });
                }
                block.end_row(i as u32);
            });
        });
        self.find_pieces(n);
    }

    /// Union-find over list pairs.
    fn find_pieces(&mut self, n: usize) {
        let mut parent: Vec<u32> = (0..n as u32).collect();
        fn root(parent: &mut [u32], mut i: u32) -> u32 {
            while parent[i as usize] != i {
                parent[i as usize] = parent[parent[i as usize] as usize];
                i = parent[i as usize];
            }
            i
        }
        for (c, block) in self.blocks.iter().enumerate() {
            for row in 0..block.rows() {
                let i = (c * CHUNK + row) as u32;
                let mut own = root(&mut parent, i);
                for &j in block.row(row).iter().filter(|&&j| j < i) {
                    // Nearly all are in the piece already.
                    if parent[j as usize] == own {
                        continue;
                    }
                    let other = root(&mut parent, j);
                    // The smaller index wins: the result does not depend on the order of unions.
                    let first = own.min(other);
                    parent[own.max(other) as usize] = first;
                    own = first;
                }
            }
        }
        let mut number = vec![u32::MAX; n];
        self.piece_count = 0;
        self.pieces.clear();
        for i in 0..n {
            let r = root(&mut parent, i as u32) as usize;
            if number[r] == u32::MAX {
                number[r] = self.piece_count as u32;
                self.piece_count += 1;
            }
            self.pieces.push(number[r]);
        }
    }

    /// Which pieces are pushed by a wall now: those with a particle that sees one which, asked about, `gives` it something.
    ///
    /// Lists reach further than what is seen: a piece may be near a wall that gives it nothing.
    pub(super) fn touching(&self, gives: impl Fn(usize, &WallRow<D>) -> bool) -> Vec<bool> {
        let mut touching = vec![false; self.piece_count];
        for (c, block) in self.blocks.iter().enumerate() {
            for row in &block.wall_rows {
                let i = c * CHUNK + row.row as usize;
                let piece = &mut touching[self.pieces[i] as usize];
                *piece = *piece || gives(i, row);
            }
        }
        touching
    }
}

/// Writes those of `run` that are nearer to `here` than sqrt(`reach2`) to the front of `list`, which has room for `LANES` more than
/// the run has; returns their number. A particle is near itself, too; sweeps leave it out.
#[inline(always)]
fn keep_near<L: Lanes, const D: usize>(
    lanes: L,
    list: &mut [u32],
    run: &[u32],
    here: &Vector<D>,
    points: &[Vector<D>],
    periodic: &Periodic<D>,
    reach2: f64,
) -> usize {
    let limit = Four::splat(lanes, reach2);
    // What lies at the same place is near, too.
    let least = Four::splat(lanes, f64::MIN_POSITIVE);
    let mut count = 0;
    let (groups, rest) = run.as_chunks::<LANES>();
    for j in groups {
        let there = j.map(|j| &points[j as usize]);
        let mut r2 = least;
        for k in 0..D {
            let d = Four::splat(lanes, here[k]) - Four::gather(lanes, |m| there[m][k]);
            let d = periodic.nearest(lanes, k, d);
            r2 += d * d;
        }
        let (kept, more) = r2.pack_between(limit, j);
        list[count..count + LANES].copy_from_slice(&kept);
        count += more;
    }
    for &j in rest {
        let d = periodic.difference(here, &points[j as usize]);
        list[count] = j;
        count += usize::from(dot(&d, &d) < reach2);
    }
    count
}

/// Mean of rows, for frames of reference.
pub(super) fn mean<const D: usize>(rows: &[Vector<D>], weight: &[f64]) -> Vector<D> {
    let mut sum = [0.0; D];
    let mut total = 0.0;
    for (r, w) in rows.iter().zip(weight) {
        for k in 0..D {
            sum[k] += w * r[k];
        }
        total += w;
    }
    if total > 0.0 {
        sum.map(|s| s / total)
    } else {
        sum
    }
}
