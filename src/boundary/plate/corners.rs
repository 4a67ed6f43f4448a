//! Where a shut plate meets the end of a wall, the two bodies touch at an edge, and a fluid seeps through between them: what lies behind
//! that edge is filled.

use super::{Plate, Point};
use crate::boundary::points::ROWS;
use crate::math::{Vector, add, scale};

/// What a shut plate meets at one of its ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meets {
    /// Nothing, or no corner to fill.
    Nothing,
    /// A wall that stands across it: the corner is the plate's.
    Corner,
    /// A wall of this group whose face goes on from the plate's: what fills its edge bears for it.
    Face(u16),
}

impl<const D: usize> Plate<D> {
    /// Fills what lies beyond the plate's ends and, in space, its sides, as far as `is_free`. Beyond the far end it stays until the
    /// plate has left it; beyond the leading edge it comes out of the edge as that closes the last of the way, and goes as it opens;
    /// beside the plate it goes row by row, with the leading edge. At an end that is not known to meet anything, and at the sides,
    /// walls that it meets at no more than its edge are looked for: `stands` says where something does.
    pub fn fill_corners(
        &mut self,
        ends: [Meets; 2],
        stands: impl Fn(&Vector<D>) -> bool,
        is_free: impl Fn(&Vector<D>) -> bool,
    ) {
        let mut filled = Vec::new();
        let met = [0, 1].map(|end| self.fill_end(end, ends[end], &stands, &mut filled));
        if self.across.is_some() {
            for side in [0, 1] {
                let beside = self.fill_side(side, &stands, &mut filled);
                // The eighths behind an end and this side.
                let behind: Vec<f64> = (0..ROWS)
                    .map(|out| self.aside(side, out as f64 + 0.5))
                    .collect();
                for end in [0, 1] {
                    let row = [0, self.count[0] - 1][end];
                    let line = [0, self.count[2] - 1][side];
                    if beside.contains(&row) && met[end].contains(&line) {
                        self.fill_beyond(end, &behind, self.group, &mut filled);
                    }
                }
            }
        }
        filled.retain(|point| is_free(&self.at(point.along, &point.offset)));
        self.points.extend(filled);
    }

    /// Fills beyond an end, and tells the lines of points across at which there was something to fill.
    fn fill_end(
        &self,
        end: usize,
        meets: Meets,
        stands: &impl Fn(&Vector<D>) -> bool,
        filled: &mut Vec<Point<D>>,
    ) -> Vec<usize> {
        let touches = |m: &usize| {
            let place =
                |steps, before| self.before(self.beyond(end, steps), *m as f64 + 0.5, before);
            meets != Meets::Nothing || touches_at_edge(place, stands)
        };
        let met: Vec<usize> = (0..self.count[2]).filter(touches).collect();
        let group = match meets {
            Meets::Face(group) => group,
            Meets::Corner | Meets::Nothing => self.group,
        };
        let across: Vec<f64> = met.iter().map(|&m| m as f64 + 0.5).collect();
        self.fill_beyond(end, &across, group, filled);
        met
    }

    /// Fills beyond a side, and tells the rows along the axis at which there was something to fill.
    fn fill_side(
        &self,
        side: usize,
        stands: &impl Fn(&Vector<D>) -> bool,
        filled: &mut Vec<Point<D>>,
    ) -> Vec<usize> {
        let [along, deep, _] = self.count;
        let row = |i: usize| (i as f64 + 0.5) * self.step;
        let touches = |i: &usize| {
            let place = |steps, before| self.before(row(*i), self.aside(side, steps), before);
            touches_at_edge(place, stands)
        };
        let met: Vec<usize> = (0..along).filter(touches).collect();
        for &i in &met {
            for (k, out) in (0..deep).flat_map(|k| (0..ROWS).map(move |out| (k, out))) {
                filled.push(Point {
                    along: row(i),
                    offset: self.offset(k, self.aside(side, out as f64 + 0.5)),
                    group: self.group,
                    stays: true,
                });
            }
        }
        met
    }

    /// Rows beyond an end, at places so many steps across.
    fn fill_beyond(&self, end: usize, across: &[f64], group: u16, filled: &mut Vec<Point<D>>) {
        for k in 0..self.count[1] {
            for &steps in across {
                filled.extend((0..ROWS).map(|row| Point {
                    along: self.beyond(end, row as f64 + 0.5),
                    offset: self.offset(k, steps),
                    group,
                    stays: end == 1,
                }));
            }
        }
    }

    /// Coordinate along the axis so many steps beyond an end [m].
    fn beyond(&self, end: usize, steps: f64) -> f64 {
        if end == 0 {
            -steps * self.step
        } else {
            self.length + steps * self.step
        }
    }

    /// Steps across from the side where the plate begins, so many beyond a side.
    fn aside(&self, side: usize, steps: f64) -> f64 {
        if side == 0 {
            -steps
        } else {
            self.count[2] as f64 + steps
        }
    }

    /// A place so many steps before the shut plate's face.
    fn before(&self, along: f64, across: f64, before: f64) -> Vector<D> {
        let mut x = self.at(along, &scale(before * self.step, &self.normal));
        if let Some((u, width)) = &self.across {
            x = add(&x, &scale(across * width / self.count[2] as f64, u));
        }
        x
    }
}

/// Whether something stands across from an edge, which it meets there and nowhere else; `place` is so many steps beyond the edge and
/// before the face.
fn touches_at_edge<const D: usize>(
    place: impl Fn(f64, f64) -> Vector<D>,
    stands: &impl Fn(&Vector<D>) -> bool,
) -> bool {
    stands(&place(0.5, 0.5)) && !stands(&place(-0.5, 0.5)) && !stands(&place(0.5, -0.5))
}
