//! Where air reaches a bed: a gap that its own water roofs is no dry surface, and what surrounds it keeps its pressure.
//!
//! Cells two spacings wide around the bed, wet or walled off or empty. Empty ones are open that reach the cells' edge or a wall
//! above them (air gathers below a lid), or others that do. Dry grains let air through.

use crate::math::Vector;
use crate::solver::Solver;
use crate::state::State;

/// Width of a cell over the spacing [1]: between particles that touch none is empty.
const WIDTH: f64 = 2.0;

/// Empty cells kept around the bed.
const MARGIN: f64 = 2.0;

/// Most cells, for each particle of the scene and in any case: of beds whose drops lie farther apart all surfaces count as dry.
const MOST: (usize, usize) = (16, 1 << 16);

#[derive(Clone, Copy, Debug, PartialEq)]
enum Cell {
    Empty,
    Wet,
    Wall,
    Open,
}

/// The cells; none where all is open.
#[derive(Debug)]
pub(super) struct Air<const D: usize> {
    origin: Vector<D>,
    edge: Vector<D>,
    count: [usize; D],
    periodic: [bool; D],
    cells: Vec<Cell>,
}

impl<const D: usize> Air<D> {
    /// Whether an open cell is this place's or beside it.
    pub(super) fn reaches(&self, x: &Vector<D>) -> bool {
        if self.cells.is_empty() {
            return true;
        }
        let Some(cell) = self.cell(x) else {
            return true;
        };
        (0..3usize.pow(D as u32)).any(|n| {
            let mut rest = n;
            let mut at = Some(cell);
            for k in 0..D {
                at = match rest % 3 {
                    0 => at,
                    1 => at.and_then(|c| self.beside(c, k, true)),
                    _ => at.and_then(|c| self.beside(c, k, false)),
                };
                rest /= 3;
            }
            at.is_none_or(|c| self.cells[self.index(c)] == Cell::Open)
        })
    }

    fn cell(&self, x: &Vector<D>) -> Option<[usize; D]> {
        let mut cell = [0; D];
        for k in 0..D {
            let t = ((x[k] - self.origin[k]) / self.edge[k]).floor();
            if !(0.0..self.count[k] as f64).contains(&t) {
                return None;
            }
            cell[k] = t as usize;
        }
        Some(cell)
    }

    fn index(&self, cell: [usize; D]) -> usize {
        (0..D).rev().fold(0, |n, k| n * self.count[k] + cell[k])
    }

    /// The next cell along an axis; none beyond the edge.
    fn beside(&self, mut cell: [usize; D], axis: usize, up: bool) -> Option<[usize; D]> {
        let last = self.count[axis] - 1;
        cell[axis] = match (up, cell[axis]) {
            (true, c) if c < last => c + 1,
            (false, c) if c > 0 => c - 1,
            (true, _) if self.periodic[axis] => 0,
            (false, _) if self.periodic[axis] => last,
            _ => return None,
        };
        Some(cell)
    }

    fn mark(&mut self, x: &Vector<D>, kind: Cell) {
        if let Some(cell) = self.cell(x) {
            let index = self.index(cell);
            self.cells[index] = kind;
        }
    }

    /// Opens all empty cells that air reaches; `up` is the axis and sense against gravity.
    fn open(&mut self, up: (usize, bool)) {
        let mut found = Vec::new();
        for index in 0..self.cells.len() {
            let mut rest = index;
            let cell: [usize; D] = std::array::from_fn(|k| {
                let c = rest % self.count[k];
                rest /= self.count[k];
                c
            });
            let above = self.beside(cell, up.0, up.1);
            let under_wall = above.is_some_and(|c| self.cells[self.index(c)] == Cell::Wall);
            let at_edge = (0..D).any(|k| {
                [true, false]
                    .iter()
                    .any(|s| self.beside(cell, k, *s).is_none())
            });
            if under_wall || at_edge {
                found.push(cell);
            }
        }
        while let Some(cell) = found.pop() {
            let index = self.index(cell);
            if self.cells[index] != Cell::Empty {
                continue;
            }
            self.cells[index] = Cell::Open;
            for k in 0..D {
                found.extend(
                    [true, false]
                        .iter()
                        .filter_map(|s| self.beside(cell, k, *s)),
                );
            }
        }
    }
}

impl<const D: usize> Solver<D> {
    /// Where air is around the saturated beds of a state.
    pub(super) fn find_air(&self, state: &State<D>) -> Air<D> {
        let grains = &state.grains;
        let mut air = self.cells_around_beds(state);
        if air.cells.is_empty() {
            return air;
        }
        let walls = &self.walls;
        for (x, weight) in walls.position.iter().zip(&walls.weight) {
            if *weight > 0.0 {
                air.mark(x, Cell::Wall);
            }
        }
        for (x, phase) in grains.position.iter().zip(&grains.phase) {
            if self.materials[*phase as usize].keeps_volume() {
                air.mark(x, Cell::Wet);
            }
        }
        let up = (0..D)
            .max_by(|a, b| self.gravity[*a].abs().total_cmp(&self.gravity[*b].abs()))
            .unwrap_or(0);
        air.open((up, self.gravity[up] < 0.0));
        air
    }

    /// Empty cells; none without weight, or if they were too many.
    fn cells_around_beds(&self, state: &State<D>) -> Air<D> {
        let width = WIDTH * self.numerics.spacing;
        let mut low = [f64::INFINITY; D];
        let mut high = [f64::NEG_INFINITY; D];
        for (i, x) in state.grains.position.iter().enumerate() {
            if self.is_porous(state, i) {
                for k in 0..D {
                    low[k] = low[k].min(x[k]);
                    high[k] = high[k].max(x[k]);
                }
            }
        }
        let mut air = Air {
            origin: self.lower,
            edge: [width; D],
            count: [1; D],
            periodic: self.periodic.length.map(|l| l > 0.0),
            cells: Vec::new(),
        };
        let mut total = 1.0;
        for k in 0..D {
            let length = self.periodic.length[k];
            if length > 0.0 {
                air.origin[k] = self.periodic.lower[k];
                air.count[k] = ((length / width).floor() as usize).max(1);
                air.edge[k] = length / air.count[k] as f64;
            } else if high[k] >= low[k] {
                let at = |x: f64| ((x - self.lower[k]) / width).floor();
                let first = at(low[k]) - MARGIN;
                air.origin[k] += width * first;
                air.count[k] = (at(high[k]) + MARGIN - first) as usize + 1;
            } else {
                return air;
            }
            total *= air.count[k] as f64;
        }
        let most = MOST.0 * state.grains.len() + MOST.1;
        if self.gravity_norm > 0.0 && total <= most as f64 {
            air.cells = vec![Cell::Empty; total as usize];
        }
        air
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(rows: [&str; 5]) -> Air<2> {
        let mut air = Air {
            origin: [0.0, 0.0],
            edge: [1.0, 1.0],
            count: [7, 5],
            periodic: [false; 2],
            cells: Vec::new(),
        };
        for row in rows.iter().rev() {
            air.cells.extend(row.chars().map(|c| match c {
                'w' => Cell::Wet,
                '#' => Cell::Wall,
                _ => Cell::Empty,
            }));
        }
        air.open((1, true));
        air
    }

    /// A gap below water is none of the air's; one that a side opens is, and one below a lid.
    #[test]
    fn air_is_what_no_water_roofs() {
        let void = cells(["       ", "wwwwwww", "www www", "www www", "#######"]);
        assert!(void.reaches(&[3.5, 3.5]) && void.reaches(&[0.5, 3.5]));
        assert!(!void.reaches(&[3.5, 1.5]) && !void.reaches(&[2.5, 1.5]));
        let side = cells(["wwwwwww", "wwwwwww", "    www", "wwwwwww", "#######"]);
        assert!(side.reaches(&[3.5, 1.5]) && !side.reaches(&[5.5, 1.5]));
        let lid = cells(["#######", "ww##www", "ww  www", "wwwwwww", "#######"]);
        assert!(lid.reaches(&[2.5, 1.5]) && !lid.reaches(&[5.5, 1.5]));
    }
}
