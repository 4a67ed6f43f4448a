//! The plain scalar search of cells.

use super::{Body, Sums, add_pair, bounds};

/// The same particles sorted by square cells of one support, row after row, for the search without lists.
#[derive(Debug, Default)]
pub(super) struct Cells {
    bodies: Vec<Body>,
    /// Which particle of the strips each is.
    place: Vec<u32>,
    /// Cell of each.
    cell: Vec<[usize; 2]>,
    /// Where the cells of each row begin, and the last ends; an empty cell on either side.
    starts: Vec<Vec<usize>>,
    sums: Vec<Sums>,
}

impl Cells {
    /// From particles in strips, with cells of this edge [m].
    pub(super) fn new(strips: &[Body], edge: f64) -> Self {
        let (low, high) = bounds(strips);
        // Rows and columns from 1: nobody is at the rim.
        let at = |b: &Body| [1, 0].map(|k| 1 + ((b.0[k] - low[k]) / edge).floor() as usize);
        let [rows, columns] =
            [1, 0].map(|k| 3 + ((high[k] - low[k]).max(0.0) / edge).floor() as usize);
        let mut place: Vec<u32> = (0..strips.len() as u32).collect();
        place.sort_by_key(|i| at(&strips[*i as usize]));
        let bodies: Vec<Body> = place.iter().map(|i| strips[*i as usize]).collect();
        let cell: Vec<[usize; 2]> = bodies.iter().map(at).collect();
        let start = |row: usize, column: usize| cell.partition_point(|c| *c < [row, column]);
        let starts = |row: usize| (0..=columns).map(|column| start(row, column)).collect();
        Self {
            starts: (0..rows).map(starts).collect(),
            sums: vec![[0.0; 7]; bodies.len()],
            bodies,
            place,
            cell,
        }
    }

    /// All sums anew.
    pub(super) fn run(&mut self, h: f64) {
        for ((a, [row, column]), out) in self.bodies.iter().zip(&self.cell).zip(&mut self.sums) {
            *out = [0.0; 7];
            for starts in &self.starts[row - 1..=row + 1] {
                for b in &self.bodies[starts[column - 1]..starts[column + 2]] {
                    add_pair(h, a, b, out);
                }
            }
        }
    }

    /// The sums in the order of the strips.
    pub(super) fn in_strips(&self) -> Vec<Sums> {
        let mut sums = self.sums.clone();
        for (i, s) in self.place.iter().zip(&self.sums) {
            sums[*i as usize] = *s;
        }
        sums
    }
}
