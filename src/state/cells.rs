//! A cell grid over points: who is within a radius of a place. Derived data: rebuilt when wanted, never saved.
//!
//! Gauges and pictures use it; the solver builds its own neighbour lists. The order of visits depends on the
//! points alone (counting sort, cells in order, points of a cell in order of index), so that sums over it have
//! the same bits whatever the number of threads.

mod axis;

use axis::Axis;

/// Points of D dimensions sorted into cells.
#[derive(Clone, Debug)]
pub struct CellGrid<const D: usize> {
    axes: [Axis; D],
    /// First entry of each cell in `entries`, and the end of the last.
    first: Vec<u32>,
    /// Index and position of the points, sorted by cell; periodic axes hold the image inside the period.
    entries: Vec<(u32, [f64; D])>,
}

impl<const D: usize> CellGrid<D> {
    /// Sorts finite `positions` [m] into cells of at least `cell_edge` > 0 [m].
    ///
    /// `periodic` holds lower and upper end of each periodic axis [m]. Other axes reach as far as the points do.
    /// Distances on periodic axes are those of the nearest image, so radii of queries should stay below half a period.
    #[must_use]
    pub fn build(
        positions: &[[f64; D]],
        cell_edge: f64,
        periodic: &[Option<(f64, f64)>; D],
    ) -> Self {
        // At most about four cells a point in all, however far apart the points are.
        let most = ((4 * positions.len() + 4096) as f64).powf(1.0 / D as f64) as usize;
        let axes: [Axis; D] = std::array::from_fn(|a| match periodic[a] {
            Some((lower, upper)) => Axis::new(lower, upper, cell_edge, most, true),
            None => {
                let (mut lower, mut upper) = (f64::INFINITY, f64::NEG_INFINITY);
                for x in positions {
                    lower = lower.min(x[a]);
                    upper = upper.max(x[a]);
                }
                if lower > upper {
                    (lower, upper) = (0.0, 0.0);
                }
                Axis::new(lower, upper, cell_edge, most.max(1), false)
            }
        });
        let mut grid = Self {
            axes,
            first: Vec::new(),
            entries: Vec::new(),
        };
        grid.sort(positions);
        grid
    }

    /// Counting sort: stable, so points of a cell keep the order of their indices.
    fn sort(&mut self, positions: &[[f64; D]]) {
        let wrapped: Vec<[f64; D]> = positions.iter().map(|x| self.wrap(x)).collect();
        let cells: usize = self.axes.iter().map(|a| a.cells).product();
        self.first = vec![0; cells + 1];
        for x in &wrapped {
            let cell = self.cell_of(x);
            self.first[cell + 1] += 1;
        }
        for cell in 0..cells {
            self.first[cell + 1] += self.first[cell];
        }
        let mut next = self.first.clone();
        self.entries = vec![(0, [0.0; D]); wrapped.len()];
        for (index, x) in wrapped.iter().enumerate() {
            let slot = &mut next[self.cell_of(x)];
            self.entries[*slot as usize] = (index as u32, *x);
            *slot += 1;
        }
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there are no points.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// How far the points reach along an axis, but for rounding: its lower and upper end [m]; `None` on periodic axes.
    #[must_use]
    pub fn ends(&self, axis: usize) -> Option<(f64, f64)> {
        self.axes[axis].ends()
    }

    /// Calls `visit` with index, position (on periodic axes the image nearest to `centre`) [m] and distance [m] of
    /// every point closer to `centre` than `radius` [m], in an order that depends on the points alone.
    pub fn for_each_within(
        &self,
        centre: &[f64; D],
        radius: f64,
        mut visit: impl FnMut(usize, [f64; D], f64),
    ) {
        let wrapped = self.wrap(centre);
        self.for_each_slot(&wrapped, radius, |slot| {
            if let Some(image) = self.image(slot, centre, &wrapped, radius) {
                visit(self.entries[slot].0 as usize, image.0, image.1);
            }
        });
    }

    /// Fills `crowd` with the points closer to `centre` than `radius` [m], for [`CellGrid::for_each_of`].
    pub fn gather(&self, centre: &[f64; D], radius: f64, crowd: &mut Vec<u32>) {
        let wrapped = self.wrap(centre);
        crowd.clear();
        self.for_each_slot(&wrapped, radius, |slot| {
            if self.image(slot, centre, &wrapped, radius).is_some() {
                crowd.push(slot as u32);
            }
        });
    }

    /// As [`CellGrid::for_each_within`], of the points in `crowd` alone: the same visits if it was gathered within at
    /// least `radius` and the distance of the two centres, in the same order but where a sphere reaches round a period.
    pub fn for_each_of(
        &self,
        crowd: &[u32],
        centre: &[f64; D],
        radius: f64,
        mut visit: impl FnMut(usize, [f64; D], f64),
    ) {
        let wrapped = self.wrap(centre);
        for &slot in crowd {
            if let Some(image) = self.image(slot as usize, centre, &wrapped, radius) {
                visit(self.entries[slot as usize].0 as usize, image.0, image.1);
            }
        }
    }

    /// Calls `visit` with the number of each entry in the cells that a sphere touches.
    fn for_each_slot(&self, wrapped: &[f64; D], radius: f64, mut visit: impl FnMut(usize)) {
        if self.entries.is_empty() {
            return;
        }
        let reach: [(usize, usize); D] =
            std::array::from_fn(|a| self.axes[a].reach(wrapped[a], radius));
        let mut offset = [0_usize; D];
        loop {
            let cell = self.flat(&std::array::from_fn(|a| {
                (reach[a].0 + offset[a]) % self.axes[a].cells
            }));
            (self.first[cell] as usize..self.first[cell + 1] as usize).for_each(&mut visit);
            // Next cell of the block, first axis fastest.
            let Some(axis) = (0..D).find(|&a| offset[a] + 1 < reach[a].1) else {
                return;
            };
            offset[axis] += 1;
            offset[..axis].fill(0);
        }
    }

    /// Position of an entry's image nearest to `centre` [m] and its distance [m], if that is less than `radius`.
    #[inline]
    fn image(
        &self,
        slot: usize,
        centre: &[f64; D],
        wrapped: &[f64; D],
        radius: f64,
    ) -> Option<([f64; D], f64)> {
        let x = &self.entries[slot].1;
        let d: [f64; D] = std::array::from_fn(|a| self.axes[a].difference(x[a], wrapped[a]));
        let square: f64 = d.iter().map(|v| v * v).sum();
        (square < radius * radius)
            .then(|| (std::array::from_fn(|a| centre[a] + d[a]), square.sqrt()))
    }

    /// The image inside the periods.
    fn wrap(&self, x: &[f64; D]) -> [f64; D] {
        std::array::from_fn(|a| self.axes[a].wrap(x[a]))
    }

    fn cell_of(&self, wrapped: &[f64; D]) -> usize {
        self.flat(&std::array::from_fn(|a| self.axes[a].cell(wrapped[a])))
    }

    fn flat(&self, cell: &[usize; D]) -> usize {
        (0..D)
            .rev()
            .fold(0, |flat, a| flat * self.axes[a].cells + cell[a])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points without pattern, from the fractional parts of multiples of irrational numbers.
    fn scattered<const D: usize>(count: usize) -> Vec<[f64; D]> {
        let steps = [0.618_033_988_75, 0.414_213_562_37, 0.732_050_807_57];
        (0..count)
            .map(|i| std::array::from_fn(|a| ((i + 1) as f64 * steps[a]).fract()))
            .collect()
    }

    fn brute<const D: usize>(
        points: &[[f64; D]],
        at: &[f64; D],
        radius: f64,
        periodic: &[bool; D],
    ) -> Vec<usize> {
        let near = |x: &[f64; D]| {
            let square: f64 = (0..D)
                .map(|a| {
                    let d = (x[a] - at[a]).abs().rem_euclid(if periodic[a] {
                        1.0
                    } else {
                        f64::INFINITY
                    });
                    let d = if periodic[a] { d.min(1.0 - d) } else { d };
                    d * d
                })
                .sum();
            square.sqrt() < radius
        };
        (0..points.len()).filter(|&i| near(&points[i])).collect()
    }

    fn check<const D: usize>(periodic: [bool; D]) {
        let points = scattered::<D>(700);
        let periods = periodic.map(|p| p.then_some((0.0, 1.0)));
        for edge in [0.03, 0.11, 0.4, 3.0] {
            let grid = CellGrid::build(&points, edge, &periods);
            for (probe, radius) in scattered::<D>(60)
                .iter()
                .zip([0.02, 0.1, 0.23, 0.45].iter().cycle())
            {
                // Some probes outside the box.
                let at: [f64; D] = std::array::from_fn(|a| 1.3 * probe[a] - 0.15);
                let mut found = Vec::new();
                grid.for_each_within(&at, *radius, |i, image, distance| {
                    let apart: f64 = (0..D).map(|a| (image[a] - at[a]).powi(2)).sum();
                    assert!((apart.sqrt() - distance).abs() < 1e-12);
                    found.push(i);
                });
                found.sort_unstable();
                assert_eq!(
                    found,
                    brute(&points, &at, *radius, &periodic),
                    "edge {edge} at {at:?} radius {radius}"
                );
            }
        }
    }

    #[test]
    fn finds_what_a_search_over_all_pairs_finds() {
        check([false, false]);
        check([true, false]);
        check([true, true]);
        check([false, false, false]);
        check([true, false, true]);
    }

    #[test]
    fn a_crowd_is_visited_as_all_points_are() {
        let points = scattered::<2>(700);
        for periodic in [false, true] {
            let periods = [periodic.then_some((0.0, 1.0)), None];
            let grid = CellGrid::build(&points, 0.11, &periods);
            let mut crowd = Vec::new();
            for (k, centre) in scattered::<2>(60).iter().enumerate() {
                let at = [centre[0] + 0.002 * k as f64, centre[1] - 0.05];
                grid.gather(centre, 0.11 + 0.13, &mut crowd);
                let (mut all, mut some) = (Vec::new(), Vec::new());
                grid.for_each_within(&at, 0.11, |i, x, r| all.push((i, x, r)));
                grid.for_each_of(&crowd, &at, 0.11, |i, x, r| some.push((i, x, r)));
                assert_eq!(some, all, "at {at:?}, periodic {periodic}");
            }
        }
    }

    #[test]
    fn order_of_visits_is_that_of_cells_then_indices() {
        let points = [[0.1, 0.1], [0.9, 0.1], [0.2, 0.2], [0.1, 0.3]];
        let grid = CellGrid::build(&points, 0.5, &[Some((0.0, 1.0)), None]);
        let mut order = Vec::new();
        grid.for_each_within(&[0.4, 0.2], 10.0, |i, _, _| order.push(i));
        assert_eq!(order, [0, 2, 3, 1]);
    }

    #[test]
    fn empty_and_far_flung_sets_are_harmless() {
        let grid = CellGrid::<3>::build(&[], 0.1, &[None; 3]);
        grid.for_each_within(&[0.0; 3], 1.0, |_, _, _| panic!("there is no point"));
        let grid = CellGrid::build(&[[0.0, 0.0], [1e12, -1e12]], 1e-3, &[None; 2]);
        assert!(grid.first.len() < 10_000);
        let mut found = Vec::new();
        grid.for_each_within(&[1e12, -1e12], 1.0, |i, _, _| found.push(i));
        assert_eq!(found, [1]);
    }
}
