//! Points by where they are: what stands at a place.

use crate::math::Vector;
use crate::state::CellGrid;

/// Distance within which a wall stands at a place, over the spacing [1]: lattices need not agree.
pub(super) const STANDS: f64 = 0.9;

/// Distance within which there is no room for a point, over the spacing [1].
pub(super) const TAKEN: f64 = 0.7;

/// Points, and the unit that distances to them are in.
pub(super) struct Places<const D: usize> {
    cells: CellGrid<D>,
    spacing: f64,
}

impl<const D: usize> Places<D> {
    /// `sides`: lower and upper end of periodic axes [m].
    pub(super) fn new(points: &[Vector<D>], spacing: f64, sides: &[Option<(f64, f64)>; D]) -> Self {
        Self {
            cells: CellGrid::build(points, spacing, sides),
            spacing,
        }
    }

    /// The nearest of those that are wanted, within `reach` spacings.
    pub(super) fn nearest(
        &self,
        x: &Vector<D>,
        reach: f64,
        wanted: impl Fn(usize) -> bool,
    ) -> Option<usize> {
        let mut best = (f64::INFINITY, None);
        self.cells
            .for_each_within(x, reach * self.spacing, |n, _, r| {
                if r < best.0 && wanted(n) {
                    best = (r, Some(n));
                }
            });
        best.1
    }

    /// Those that are wanted within `reach` spacings.
    pub(super) fn within(
        &self,
        x: &Vector<D>,
        reach: f64,
        wanted: impl Fn(usize) -> bool,
    ) -> Vec<usize> {
        let mut found = Vec::new();
        self.cells
            .for_each_within(x, reach * self.spacing, |n, _, _| {
                if wanted(n) {
                    found.push(n);
                }
            });
        found
    }

    /// Whether there is any within `reach` spacings.
    pub(super) fn has(&self, x: &Vector<D>, reach: f64) -> bool {
        self.nearest(x, reach, |_| true).is_some()
    }
}
