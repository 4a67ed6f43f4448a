//! One axis of a cell grid: which cell a coordinate lies in, which cells a sphere touches, what a period does to both.

/// One axis of the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Axis {
    /// Lower end [m].
    lower: f64,
    /// Length of a cell [m].
    edge: f64,
    /// Number of cells.
    pub(super) cells: usize,
    /// Length of the period [m], if periodic.
    period: Option<f64>,
}

impl Axis {
    pub(super) fn new(lower: f64, upper: f64, edge: f64, most: usize, periodic: bool) -> Self {
        let length = upper - lower;
        // Cells may be larger than asked for, never smaller: `most` keeps a far-flung point from costing memory.
        let cells = ((length / edge).floor().max(1.0) as usize).min(most);
        let edge = if length > 0.0 {
            length / cells as f64
        } else {
            edge
        };
        let period = periodic.then_some(length);
        Self {
            lower,
            edge,
            cells,
            period,
        }
    }

    /// Lower and upper end of the cells [m]; `None` if periodic.
    pub(super) fn ends(&self) -> Option<(f64, f64)> {
        let upper = self.lower + self.edge * self.cells as f64;
        self.period.is_none().then_some((self.lower, upper))
    }

    /// The image inside the period; the value itself on other axes.
    pub(super) fn wrap(&self, x: f64) -> f64 {
        match self.period {
            Some(period) => {
                let inside = (x - self.lower).rem_euclid(period) + self.lower;
                if inside >= self.lower + period {
                    self.lower
                } else {
                    inside
                }
            }
            None => x,
        }
    }

    /// Cell of a wrapped coordinate, at the rim for coordinates outside.
    pub(super) fn cell(&self, x: f64) -> usize {
        (((x - self.lower) / self.edge).max(0.0) as usize).min(self.cells - 1)
    }

    /// First cell and number of cells that a sphere around `x` touches; the caller goes on modulo `cells`.
    pub(super) fn reach(&self, x: f64, radius: f64) -> (usize, usize) {
        // A little more than the radius: rounding must not lose a point at a cell's face.
        let radius = radius + 1e-9 * self.edge + 4.0 * f64::EPSILON * (x.abs() + radius);
        let (from, to) = (
            (x - radius - self.lower) / self.edge,
            (x + radius - self.lower) / self.edge,
        );
        if self.period.is_some() {
            let (from, to) = (from.floor(), to.floor());
            let count = (to - from) as usize + 1;
            if count >= self.cells {
                return (0, self.cells);
            }
            let start = from.rem_euclid(self.cells as f64) as usize;
            return (start.min(self.cells - 1), count);
        }
        let cell = |c: f64| (c.max(0.0) as usize).min(self.cells - 1);
        let (from, to) = (cell(from), cell(to));
        (from, to - from + 1)
    }

    /// Shortest difference of two wrapped coordinates.
    pub(super) fn difference(&self, a: f64, b: f64) -> f64 {
        let d = a - b;
        match self.period {
            Some(period) if d > 0.5 * period => d - period,
            Some(period) if d < -0.5 * period => d + period,
            _ => d,
        }
    }
}
