//! Cells of one list radius over the particles' own bounding box, with periodic axes; counting sort, fixed order.

use std::ops::Range;

use crate::math::{Four, Lanes, Vector};

/// Which axes repeat, and over what length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periodic<const D: usize> {
    /// Lower end of each axis [m].
    pub lower: Vector<D>,
    /// Length of each periodic axis [m]; 0 for axes that are not periodic.
    pub length: Vector<D>,
}

impl<const D: usize> Periodic<D> {
    /// Nearest image of a - b.
    #[inline(always)]
    #[must_use]
    pub fn difference(&self, a: &Vector<D>, b: &Vector<D>) -> Vector<D> {
        std::array::from_fn(|k| {
            let d = a[k] - b[k];
            let l = self.length[k];
            if l > 0.0 {
                if d > 0.5 * l {
                    d - l
                } else if d < -0.5 * l {
                    d + l
                } else {
                    d
                }
            } else {
                d
            }
        })
    }

    /// The image of `x` that is nearest to a place.
    #[must_use]
    pub fn image(&self, x: &Vector<D>, place: &Vector<D>) -> Vector<D> {
        std::array::from_fn(|k| {
            let (l, d) = (self.length[k], x[k] - place[k]);
            if l > 0.0 {
                x[k] - l * (d / l).round()
            } else {
                x[k]
            }
        })
    }

    /// The nearest image of a difference along axis k.
    #[inline(always)]
    pub(super) fn nearest<L: Lanes>(&self, lanes: L, k: usize, d: Four<L>) -> Four<L> {
        let length = self.length[k];
        if length <= 0.0 {
            return d;
        }
        let whole = Four::splat(lanes, length);
        let half = Four::splat(lanes, 0.5 * length);
        let minus_half = Four::splat(lanes, -0.5 * length);
        d - d.where_greater(half, whole) + minus_half.where_greater(d, whole)
    }

    /// Moves a point back into the periodic box.
    pub fn wrap(&self, x: &mut Vector<D>) {
        for k in 0..D {
            let l = self.length[k];
            if l > 0.0 {
                let t = x[k] - self.lower[k];
                if !(0.0..l).contains(&t) {
                    let wrapped = self.lower[k] + t.rem_euclid(l);
                    // What lies below by less than rounding would come to stand at the upper end.
                    x[k] = if wrapped - self.lower[k] < l {
                        wrapped
                    } else {
                        self.lower[k]
                    };
                }
            }
        }
    }
}

/// Runs of points around a cell.
#[derive(Debug)]
pub(super) struct Near<const D: usize> {
    cell: Option<[i64; D]>,
    pub(super) runs: Vec<Range<u32>>,
}

impl<const D: usize> Near<D> {
    /// Of no cell yet.
    pub(super) fn new() -> Self {
        Self {
            cell: None,
            runs: Vec::new(),
        }
    }
}

/// Makes cells wider along the axes with most of them until there are no more than points deserve: 80 each.
fn widen<const D: usize>(
    points: usize,
    extents: &Vector<D>,
    periodic: &Periodic<D>,
    count: &mut [usize; D],
    edges: &mut Vector<D>,
) {
    let most = 80.0 * points as f64 + 4096.0;
    while count.iter().map(|&n| n as f64).product::<f64>() > most {
        let Some(k) = (0..D).max_by_key(|&k| count[k]) else {
            return;
        };
        if periodic.length[k] > 0.0 {
            count[k] = count[k].div_ceil(2);
            edges[k] = extents[k] / count[k] as f64;
        } else {
            edges[k] *= 2.0;
            count[k] = (extents[k] / edges[k]).floor() as usize + 1;
        }
    }
}

/// Points sorted by cell.
pub(super) struct Grid<'a, const D: usize> {
    periodic: &'a Periodic<D>,
    origin: Vector<D>,
    edge: Vector<D>,
    count: [usize; D],
    start: Vec<u32>,
    order: Vec<u32>,
}

impl<'a, const D: usize> Grid<'a, D> {
    /// Bins points in cells at least `edge` wide.
    pub(super) fn build(points: &[Vector<D>], edge: f64, periodic: &'a Periodic<D>) -> Self {
        let mut low = [f64::INFINITY; D];
        let mut high = [f64::NEG_INFINITY; D];
        for x in points {
            for k in 0..D {
                low[k] = low[k].min(x[k]);
                high[k] = high[k].max(x[k]);
            }
        }
        let mut count = [1usize; D];
        let mut edges = [edge; D];
        for k in 0..D {
            if periodic.length[k] > 0.0 {
                low[k] = periodic.lower[k];
                count[k] = ((periodic.length[k] / edge).floor() as usize).max(1);
                edges[k] = periodic.length[k] / count[k] as f64;
            } else if high[k] >= low[k] {
                // Points far apart (spray) get wider cells rather than a table larger than the points deserve.
                let most = ((4 * points.len() + 64) as f64)
                    .powf(1.0 / D as f64)
                    .ceil()
                    .max(8.0)
                    * 4.0;
                edges[k] = edge.max((high[k] - low[k]) / most);
                count[k] = ((high[k] - low[k]) / edges[k]).floor() as usize + 1;
            } else {
                low[k] = 0.0;
            }
        }
        let extents: Vector<D> = std::array::from_fn(|k| match periodic.length[k] {
            l if l > 0.0 => l,
            _ => high[k] - low[k],
        });
        widen(points.len(), &extents, periodic, &mut count, &mut edges);
        let mut grid = Self {
            periodic,
            origin: low,
            edge: edges,
            count,
            start: Vec::new(),
            order: Vec::new(),
        };
        let cells: Vec<u32> = points
            .iter()
            .map(|x| grid.index(&grid.cell(x)) as u32)
            .collect();
        let total: usize = count.iter().product();
        let mut start = vec![0u32; total + 1];
        for &c in &cells {
            start[c as usize + 1] += 1;
        }
        for c in 0..total {
            start[c + 1] += start[c];
        }
        let mut next = start.clone();
        let mut order = vec![0u32; points.len()];
        for (i, &c) in cells.iter().enumerate() {
            order[next[c as usize] as usize] = i as u32;
            next[c as usize] += 1;
        }
        grid.start = start;
        grid.order = order;
        grid
    }

    /// Points in cell order.
    pub(super) fn order(&self) -> &[u32] {
        &self.order
    }

    /// Cell of a point, which may lie outside the box.
    fn cell(&self, x: &Vector<D>) -> [i64; D] {
        std::array::from_fn(|k| {
            let c = ((x[k] - self.origin[k]) / self.edge[k]).floor() as i64;
            if self.periodic.length[k] > 0.0 {
                c.rem_euclid(self.count[k] as i64)
            } else {
                c
            }
        })
    }

    fn index(&self, c: &[i64; D]) -> usize {
        let mut n = 0usize;
        for k in (0..D).rev() {
            n = n * self.count[k] + (c[k].clamp(0, self.count[k] as i64 - 1) as usize);
        }
        n
    }

    /// Points of a run, in cell order.
    #[inline]
    pub(super) fn points(&self, run: &Range<u32>) -> &[u32] {
        &self.order[run.start as usize..run.end as usize]
    }

    /// Runs of points in the cells around `x`, each point once, in a fixed order; `near` holds those of the last place.
    #[inline]
    pub(super) fn find_runs(&self, x: &Vector<D>, near: &mut Near<D>) {
        let here = self.cell(x);
        if near.cell != Some(here) {
            near.cell = Some(here);
            self.cells_around(&here, &mut near.runs);
        }
    }

    fn cells_around(&self, here: &[i64; D], runs: &mut Vec<Range<u32>>) {
        // Per axis the cells to visit; short periodic axes name each cell once.
        let mut axes = [[0i64; 3]; D];
        let mut lengths = [0usize; D];
        for k in 0..D {
            let n = self.count[k] as i64;
            for o in -1..=1 {
                let mut c = here[k] + o;
                if self.periodic.length[k] > 0.0 {
                    c = c.rem_euclid(n);
                    if axes[k][..lengths[k]].contains(&c) {
                        continue;
                    }
                } else if c < 0 || c >= n {
                    continue;
                }
                axes[k][lengths[k]] = c;
                lengths[k] += 1;
            }
        }
        runs.clear();
        let outer: usize = lengths[1..].iter().product();
        for m in 0..outer {
            let mut rest = m;
            let mut c = [0i64; D];
            for k in 1..D {
                c[k] = axes[k][rest % lengths[k]];
                rest /= lengths[k];
            }
            for &first in &axes[0][..lengths[0]] {
                c[0] = first;
                let cell = self.index(&c);
                let (start, end) = (self.start[cell], self.start[cell + 1]);
                // Cells along the first axis follow each other.
                match runs.last_mut() {
                    Some(last) if last.end == start => last.end = end,
                    _ => runs.push(start..end),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: Periodic<3> = Periodic {
        lower: [0.0; 3],
        length: [0.0; 3],
    };

    /// Spray over a large room: cells for the points and not for the room, and all pairs are found.
    #[test]
    fn cells_are_as_many_as_the_points_deserve() {
        let at = |n: u32, by: u32| f64::from(n * by % 1009) / 10.09;
        let points: Vec<Vector<3>> = (0..1000)
            .map(|n| [at(n, 17), at(n, 313), at(n, 701)])
            .collect();
        let long = Periodic {
            length: [100.0, 100.0, 0.0],
            ..NONE
        };
        for (periodic, edge) in [(NONE, 3.0), (NONE, 1e-3), (long, 3.0), (long, 1e-6)] {
            let grid = Grid::build(&points, edge, &periodic);
            assert!(grid.start.len() <= 80 * 1000 + 4097, "{}", grid.start.len());
            let mut near = Near::new();
            for (i, x) in points.iter().enumerate() {
                grid.find_runs(x, &mut near);
                let mut found: Vec<u32> = near
                    .runs
                    .iter()
                    .flat_map(|run| grid.points(run))
                    .copied()
                    .collect();
                found.sort_unstable();
                for (j, y) in points.iter().enumerate() {
                    let r = periodic.difference(x, y);
                    let is_near = r.iter().map(|c| c * c).sum::<f64>() < edge * edge;
                    let is_found = found.binary_search(&(j as u32)).is_ok();
                    assert!(is_found || !is_near, "{i} and {j} at {r:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_below_a_period_by_rounding_stays_in_it() {
        let periodic = Periodic {
            lower: [0.0],
            length: [1.0],
        };
        for below in [-1e-20, -1e-17, -1e-300] {
            let mut x = [below];
            periodic.wrap(&mut x);
            assert!((0.0..1.0).contains(&x[0]), "{below}: {x:?}");
        }
    }
}
