//! Discharge: mass that crosses a section, counted where it crosses.
//!
//! A particle crosses when its path from one internal step to the next goes through the section. The section is
//! half-open in every sense (a particle on its plane counts as past it, an edge belongs to one side), so a crossing
//! is counted once, whatever the steps. Particle masses are multiples of a power of two, hence the sum is exact.

use crate::math::{dot, norm};

/// A segment (planar) or parallelogram (space) and the mass that went through it.
#[derive(Clone, Debug, PartialEq)]
pub struct Crossing<const D: usize> {
    /// One corner [m].
    corner: [f64; D],
    centre: [f64; D],
    /// Normal, from the left to the right side; not of unit length.
    normal: [f64; D],
    /// From the corner [m].
    edges: Vec<[f64; D]>,
    /// x -> share along each edge: dual vectors of the edges [1/m].
    dual: Vec<[f64; D]>,
    /// Whether each edge spans a whole period: then it has no ends.
    endless: Vec<bool>,
    /// Shares of each edge between which paths are counted: 0 and 1, but where it ends on a wall.
    ends: Vec<(f64, f64)>,
    /// Length of the period of each axis [m], if periodic.
    period: [Option<f64>; D],
    /// Net mass from left to right since the start [kg].
    mass: f64,
}

impl<const D: usize> Crossing<D> {
    /// The segment from `from` to `to` (planar), or the parallelogram with corner `from` and edges `to - from` and
    /// `span` (space) [m]. Downstream is to the right of the segment; in space along (to - from) x span, which is
    /// the same when `span` points along z. `period` holds the lengths of periodic axes [m].
    #[must_use]
    pub fn new(from: [f64; D], to: [f64; D], span: [f64; D], period: [Option<f64>; D]) -> Self {
        let u: [f64; D] = std::array::from_fn(|a| to[a] - from[a]);
        if D == 2 {
            let normal = std::array::from_fn(|a| if a == 0 { u[1] } else { -u[0] });
            return Self::with_edges(from, &[u], normal, period);
        }
        let normal = std::array::from_fn(|a| {
            let (b, c) = ((a + 1) % D, (a + 2) % D);
            u[b] * span[c] - u[c] * span[b]
        });
        Self::with_edges(from, &[u, span], normal, period)
    }

    fn with_edges(
        corner: [f64; D],
        edges: &[[f64; D]],
        normal: [f64; D],
        period: [Option<f64>; D],
    ) -> Self {
        let centre =
            std::array::from_fn(|a| corner[a] + 0.5 * edges.iter().map(|e| e[a]).sum::<f64>());
        // A tenth of a billionth: edges written as the domain's own corners span it to rounding.
        let spans = |e: &[f64; D]| {
            (0..D).any(|a| period[a].is_some_and(|l| e[a].abs() >= (1.0 - 1e-10) * l))
        };
        Self {
            corner,
            centre,
            normal,
            edges: edges.to_vec(),
            dual: duals(edges),
            endless: edges.iter().map(spans).collect(),
            ends: vec![(0.0, 1.0); edges.len()],
            period,
            mass: 0.0,
        }
    }

    /// Lets what ends on a wall reach into it, as particles of a thin layer are pressed in a little: where a place `reach` [m] beyond
    /// an end is behind a face and the end itself is not, all along that end.
    pub fn reach_into(&mut self, reach: f64, is_behind: impl Fn(&[f64; D]) -> bool) {
        for (k, edge) in self.edges.iter().enumerate() {
            let share = reach / norm(edge);
            let other = self.edges.iter().enumerate().find(|(n, _)| *n != k);
            let beyond = |at: f64| {
                let mut along = [0.1, 0.5, 0.9].into_iter();
                along.all(|t| {
                    let x: [f64; D] = std::array::from_fn(|a| {
                        let aside = other.map_or(0.0, |(_, e)| t * e[a]);
                        self.corner[a] + at * edge[a] + aside
                    });
                    is_behind(&x)
                })
            };
            if beyond(-share) && !beyond(0.1 * share) {
                self.ends[k].0 = -share;
            }
            if beyond(1.0 + share) && !beyond(1.0 - 0.1 * share) {
                self.ends[k].1 = 1.0 + share;
            }
        }
    }

    /// Centre of the section [m].
    #[must_use]
    pub fn centre(&self) -> [f64; D] {
        self.centre
    }

    /// +1 if the path crosses from left to right, -1 from right to left, 0 if it does not cross.
    ///
    /// Paths are shorter than half a period; on periodic axes any image of either end will do.
    #[must_use]
    pub fn count(&self, before: &[f64; D], after: &[f64; D]) -> i8 {
        let start: [f64; D] = std::array::from_fn(|a| self.nearest(a, before[a] - self.centre[a]));
        let path: [f64; D] = std::array::from_fn(|a| self.nearest(a, after[a] - before[a]));
        let height = dot(&start, &self.normal);
        let end: [f64; D] = std::array::from_fn(|a| start[a] + path[a]);
        let rise = dot(&end, &self.normal);
        let sign = match (height >= 0.0, rise >= 0.0) {
            (false, true) => 1,
            (true, false) => -1,
            _ => return 0,
        };
        let share = height / (height - rise);
        let through: [f64; D] = std::array::from_fn(|a| {
            let offset = self.nearest(a, start[a] + share * path[a]);
            offset + self.centre[a] - self.corner[a]
        });
        let inside =
            self.dual
                .iter()
                .zip(&self.endless)
                .zip(&self.ends)
                .all(|((dual, endless), ends)| {
                    *endless || (ends.0..ends.1).contains(&dot(&through, dual))
                });
        if inside { sign } else { 0 }
    }

    /// Counts a particle of `mass` [kg].
    pub fn add(&mut self, before: &[f64; D], after: &[f64; D], mass: f64) {
        self.mass += f64::from(self.count(before, after)) * mass;
    }

    /// Net mass from left to right since the start [kg]. Part of the saved state.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Takes over a saved mass [kg].
    pub fn set_mass(&mut self, mass: f64) {
        self.mass = mass;
    }

    /// The image of a difference within half a period.
    fn nearest(&self, axis: usize, difference: f64) -> f64 {
        match self.period[axis] {
            Some(period) => difference - period * (difference / period).round(),
            None => difference,
        }
    }
}

/// Dual vectors within the span of one or two edges: dual_i . edge_k = 1 if i = k, else 0.
fn duals<const D: usize>(edges: &[[f64; D]]) -> Vec<[f64; D]> {
    let project = |e: &[f64; D], other: Option<&[f64; D]>| -> [f64; D] {
        let across: [f64; D] = match other {
            Some(o) => std::array::from_fn(|a| e[a] - o[a] * dot(e, o) / dot(o, o)),
            None => *e,
        };
        let square = dot(&across, e);
        std::array::from_fn(|a| across[a] / square)
    };
    match edges {
        [u, v] => vec![project(u, Some(v)), project(v, Some(u))],
        _ => edges.iter().map(|e| project(e, None)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_of_the_segment_is_downstream() {
        // Upwards along y: the right side is +x.
        let section = Crossing::new([0.0, 0.0], [0.0, 1.0], [0.0; 2], [None; 2]);
        assert_eq!(section.count(&[-0.1, 0.5], &[0.1, 0.5]), 1);
        assert_eq!(section.count(&[0.1, 0.5], &[-0.1, 0.5]), -1);
        assert_eq!(section.count(&[-0.1, 1.5], &[0.1, 1.5]), 0);
        assert_eq!(section.count(&[-0.2, 0.5], &[-0.1, 0.5]), 0);
        // A slanted path that starts beside the segment and goes through it.
        assert_eq!(section.count(&[-0.1, -0.05], &[0.1, 0.15]), 1);
    }

    #[test]
    fn stopping_on_the_section_and_going_on_counts_once() {
        let section = Crossing::new([0.0, 0.0], [0.0, 1.0], [0.0; 2], [None; 2]);
        let path = [[-0.1, 0.5], [0.0, 0.5], [0.1, 0.5]];
        assert_eq!(
            path.windows(2)
                .map(|w| section.count(&w[0], &w[1]))
                .sum::<i8>(),
            1
        );
        let back = [[0.1, 0.5], [0.0, 0.5], [-0.1, 0.5], [0.0, 0.5]];
        assert_eq!(
            back.windows(2)
                .map(|w| section.count(&w[0], &w[1]))
                .sum::<i8>(),
            0
        );
    }

    #[test]
    fn two_sections_end_to_end_count_what_one_long_section_counts() {
        let whole = Crossing::new([0.3, 0.0], [0.5, 1.0], [0.0; 2], [None; 2]);
        let lower = Crossing::new([0.3, 0.0], [0.4, 0.5], [0.0; 2], [None; 2]);
        let upper = Crossing::new([0.4, 0.5], [0.5, 1.0], [0.0; 2], [None; 2]);
        for k in 0..1000 {
            let t = f64::from(k) * 0.618_033_988_75;
            let before = [t.fract(), (3.7 * t).fract()];
            let after = [(1.9 * t).fract(), (2.3 * t).fract()];
            let parts = lower.count(&before, &after) + upper.count(&before, &after);
            assert_eq!(whole.count(&before, &after), parts, "{before:?} {after:?}");
        }
    }

    #[test]
    fn parallelogram_in_space_with_slanted_edges() {
        // Span along z makes the planar rule: right of +y is +x.
        let section = Crossing::new([0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.5, 1.0], [None; 3]);
        assert_eq!(section.count(&[-0.1, 0.3, 0.1], &[0.1, 0.3, 0.1]), 1);
        // y = 0.2 at z = 0.9 is below the slanted edge (0.45), y = 1.2 is inside.
        assert_eq!(section.count(&[-0.1, 0.2, 0.9], &[0.1, 0.2, 0.9]), 0);
        assert_eq!(section.count(&[0.1, 1.2, 0.9], &[-0.1, 1.2, 0.9]), -1);
    }

    #[test]
    fn every_round_through_a_periodic_channel_counts_once() {
        for place in [0.0, 0.37, 1.0] {
            let mut section =
                Crossing::new([place, 0.0], [place, 1.0], [0.0; 2], [Some(1.0), None]);
            let mut x = 0.2_f64;
            for _ in 0..700 {
                let next = (x + 0.01).rem_euclid(1.0);
                section.add(&[x, 0.5], &[next, 0.5], 0.25);
                x = next;
            }
            assert_eq!(section.mass(), 1.75, "section at x = {place}");
        }
    }

    #[test]
    fn section_across_a_whole_period_has_no_ends() {
        let section = Crossing::new([0.0, 0.5], [1.0, 0.5], [0.0; 2], [Some(1.0), None]);
        for x in [0.0, 1e-17, 0.5, 1.0 - 1e-16, 1.0] {
            // Right of +x is down.
            assert_eq!(section.count(&[x, 0.6], &[x + 0.01, 0.4]), 1, "at {x}");
        }
    }

    /// From a floor to the open, in the plane and in space.
    #[test]
    fn a_section_that_ends_on_a_wall_counts_what_is_pressed_into_that() {
        let below = |reach: f64| {
            let mut section = Crossing::new([0.0, 0.0], [0.0, 1.0], [0.0; 2], [None; 2]);
            section.reach_into(reach, |x| x[1] < 0.0);
            [-0.02, 0.5, 0.99, 1.01].map(|y| section.count(&[-0.1, y], &[0.1, y]))
        };
        assert_eq!(below(0.03), [1, 1, 1, 0]);
        assert_eq!(below(0.01), [0, 1, 1, 0]);
        let mut space = Crossing::new([0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [None; 3]);
        // A floor, and a side wall along half of the section's end: only all of an end is taken.
        space.reach_into(0.03, |x| x[1] < 0.0 || (x[2] > 1.0 && x[1] < 0.5));
        let counts = |y: f64, z: f64| space.count(&[-0.1, y, z], &[0.1, y, z]);
        assert_eq!([counts(-0.02, 0.5), counts(0.2, 1.02)], [1, 0]);
    }
}
