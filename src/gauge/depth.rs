//! Depth: the highest point of a line where the Shepard sum is 0.5.
//!
//! Symbols: S_m material, S_b solid behind the plane through the foot (the bed), S_s other solid (side walls).
//! The sum is S = (S_m + S_b) / (1 - S_s): material ends where half of what walls leave free is filled. The bed
//! counts as filled, so that a layer thinner than the kernel has its own height; side walls count as more of what
//! is beside them, so that a line along a wall reads what a line in the middle reads. Far from walls S = S_m.
//! Where there is no material at all, and behind the surface of a wall or gate, S = 0: material that touches a roof ends
//! there.

use super::nearby::Nearby;
use super::{Reading, Validity, View, along};

/// Shepard sum of material below which a place counts as dry: a lone grain at the place itself gives 0.2.
const DRY: f64 = 0.05;

/// Places on a line are this many spacings apart: finer than the kernel, so that no crossing is stepped over.
const STEP: f64 = 0.25;

/// Share of a depth by which rounding may make it less than what is asked for.
const ROUNDING: f64 = 1e-9;

/// A line along which depth is measured.
#[derive(Clone, Debug, PartialEq)]
pub struct DepthLine<const D: usize> {
    /// Foot of the line, on the bed [m].
    pub foot: [f64; D],
    /// Unit vector along the line.
    pub up: [f64; D],
    /// Length searched [m].
    pub length: f64,
}

impl<const D: usize> DepthLine<D> {
    /// One value: depth above the foot [m], 0 to `length`.
    ///
    /// Outside: the foot is outside the domain. Blocked: a wall or gate covers the place one spacing above the
    /// foot. Empty: no material.
    #[must_use]
    pub fn sample(&self, view: &View<D>) -> Reading {
        match self.depth(view) {
            Ok(depth) => Reading::valid(vec![depth]),
            Err(why) => Reading::none(1, why),
        }
    }

    /// Depth [m], or why there is none.
    pub(super) fn depth(&self, view: &View<D>) -> Result<f64, Validity> {
        let mut near = Nearby::new(view);
        let filled = self.filled(view, &mut near)?;
        if filled == self.count(view) {
            return Ok(self.length);
        }
        Ok(self.crossing(view, &near, filled))
    }

    /// The height above place `filled` where S falls below 0.5 [m], S >= 0.5 there.
    ///
    /// By false position, the weight of the end that stays halved (Illinois): S is as smooth as the kernel.
    fn crossing(&self, view: &View<D>, near: &Nearby<D>, filled: usize) -> f64 {
        let excess = |height: f64| self.fill(view, near, height) - 0.5;
        let (mut low, mut high) = (self.height(view, filled), self.height(view, filled + 1));
        let (mut above, mut below) = (excess(low), excess(high));
        let fine = 1e-12 * view.spacing;
        let mut last_rose = None;
        // Some ten; where S jumps (a wall ends, a piece ends) as many as halving the interval takes.
        for _ in 0..60 {
            if high - low <= fine {
                break;
            }
            let share = above / (above - below);
            // Never at an end, so that the interval closes in from both sides.
            let next = low + share.clamp(0.01, 0.99) * (high - low);
            let there = excess(next);
            let rose = there >= 0.0;
            if rose {
                (low, above) = (next, there);
                if last_rose == Some(true) {
                    below *= 0.5;
                }
            } else {
                (high, below) = (next, there);
                if last_rose == Some(false) {
                    above *= 0.5;
                }
            }
            last_rose = Some(rose);
        }
        low
    }

    /// Whether the depth is at least `least` [m], but for rounding; for less than what the depth itself costs, where places tell.
    pub(super) fn is_deep(&self, view: &View<D>, least: f64) -> bool {
        let least = least * (1.0 - ROUNDING);
        let mut near = Nearby::new(view);
        let Ok(filled) = self.filled(view, &mut near) else {
            return false;
        };
        // The surface is between this place and the next.
        self.height(view, filled) >= least
            || (filled < self.count(view)
                && self.height(view, filled + 1) > least
                && self.crossing(view, &near, filled) >= least)
    }

    /// Number of the highest place with S >= 0.5, or why there is none. `near` is then what it and the next place see.
    fn filled(&self, view: &View<D>, near: &mut Nearby<D>) -> Result<usize, Validity> {
        if view.is_outside(&self.foot) {
            return Err(Validity::Outside);
        }
        let above = along(&self.foot, &self.up, view.spacing);
        // Corners between walls that meet are behind neither.
        if view.is_inside(&above) || view.is_covered(&above) {
            return Err(Validity::Blocked);
        }
        let filled = self.highest_filled(view, near).ok_or(Validity::Empty)?;
        let at = along(&self.foot, &self.up, self.height(view, filled));
        if near.material_sum(&at) < DRY {
            return Err(Validity::Empty);
        }
        Ok(filled)
    }

    /// Number of the line's upper end.
    fn count(&self, view: &View<D>) -> usize {
        (self.length / (STEP * view.spacing)).ceil().max(1.0) as usize
    }

    /// Height of a place along the line [m].
    fn height(&self, view: &View<D>, k: usize) -> f64 {
        (k as f64 * STEP * view.spacing).min(self.length)
    }

    /// Number of the highest place with S >= 0.5.
    ///
    /// Goes down in blocks of a kernel radius and passes over those that no material reaches, where S is 0.
    fn highest_filled(&self, view: &View<D>, near: &mut Nearby<D>) -> Option<usize> {
        let support = view.kernel.support();
        let height = |k| self.height(view, k);
        let block = ((support / (STEP * view.spacing)) as usize).max(1);
        let mut top = self.count(view) + 1;
        // Whole blocks, so that those below are the same in any domain.
        top -= block * (top.saturating_sub(self.places_below_top(view)) / block);
        while top > 0 {
            let bottom = top.saturating_sub(block);
            let middle = 0.5 * (height(bottom) + height(top));
            let centre = along(&self.foot, &self.up, middle);
            // The block, its upper end included, is at most a kernel radius long.
            if near.gather(&centre, 0.5 * support)
                && let Some(k) = (bottom..top)
                    .rev()
                    .find(|&k| self.fill(view, near, height(k)) >= 0.5)
            {
                return Some(k);
            }
            top = bottom;
        }
        None
    }

    /// Places from the foot up to where no material reaches any more: a line may be much longer.
    fn places_below_top(&self, view: &View<D>) -> usize {
        let margin = 2.0 * view.kernel.support();
        let height = |a: usize| {
            let (lower, upper) = view.cells.ends(a)?;
            // Rings have images on the other side of the axis.
            if self.up[a] == 0.0 || (a == 0 && view.geometry.is_axisymmetric()) {
                return None;
            }
            let end = if self.up[a] > 0.0 {
                upper + margin
            } else {
                lower - margin
            };
            Some((end - self.foot[a]) / self.up[a])
        };
        let top = (0..D).filter_map(height).fold(self.length, f64::min);
        // `as` saturates.
        (top / (STEP * view.spacing)).ceil() as usize + 1
    }

    /// The sum S at a height above the foot.
    fn fill(&self, view: &View<D>, near: &Nearby<D>, height: f64) -> f64 {
        let at = along(&self.foot, &self.up, height);
        let material = near.material_sum(&at);
        if material == 0.0 {
            return 0.0;
        }
        let (bed, side) = near.solid_sums(&at, &self.foot, &self.up);
        if bed + side > 0.0 && view.is_inside(&at) {
            return 0.0;
        }
        // The bound keeps a place in a corner between walls from dividing by nothing.
        (material + bed) / (1.0 - side).max(0.1)
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::bed::Bed;
    use super::*;

    /// Depth on flat beds of known height, at several phases of the line and of the lattice against it, with and
    /// without jitter: within 0.1 dp, the definition's tolerance.
    fn flat_bed_is_right<const D: usize>(ratios: &[f64], rows: &[usize], jitters: &[f64]) {
        for &ratio in ratios {
            for &count in rows {
                for &jitter in jitters {
                    let bed = Bed::<D>::new(ratio, count, jitter);
                    for phase in [0.0, 0.13, 0.29, 0.5, 0.71, 0.93] {
                        let mut foot = [0.5 * bed.length() + phase * bed.spacing; D];
                        let mut up = [0.0; D];
                        foot[1] = 0.0;
                        up[1] = 1.0;
                        let line = DepthLine {
                            foot,
                            up,
                            length: 1.3 * bed.height() + 0.1,
                        };
                        let depth = bed.look(|view| line.sample(view));
                        assert_eq!(depth.validity, Validity::Valid);
                        let error = (depth.values[0] - bed.height()) / bed.spacing;
                        assert!(
                            error.abs() < 0.1,
                            "D {D} h/dp {ratio} rows {count} jitter {jitter} phase {phase}: off by {error} dp"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn flat_bed_in_the_plane_is_read_within_a_tenth_of_a_spacing() {
        flat_bed_is_right::<2>(&[1.3, 1.6, 2.0], &[1, 2, 3, 12], &[0.0]);
        flat_bed_is_right::<2>(&[1.3, 1.6, 2.0], &[12], &[0.05, 0.1]);
    }

    #[test]
    fn flat_bed_in_space_is_read_within_a_tenth_of_a_spacing() {
        flat_bed_is_right::<3>(&[1.3, 1.6, 2.0], &[1, 6], &[0.0]);
        flat_bed_is_right::<3>(&[1.6], &[6], &[0.1]);
    }

    #[test]
    fn line_along_a_side_wall_reads_what_a_line_in_the_middle_reads() {
        let bed = Bed::<2>::with_side_wall(1.6, 10);
        let line = DepthLine {
            foot: [0.0, 0.0],
            up: [0.0, 1.0],
            length: 1.0,
        };
        let depth = bed.look(|view| line.sample(view));
        assert!(
            (depth.values[0] - bed.height()).abs() < 0.1 * bed.spacing,
            "{depth:?}"
        );
    }

    #[test]
    fn layers_in_the_corner_of_bed_and_wall_are_read_within_a_fifth_of_a_spacing() {
        for ratio in [1.3, 1.6, 2.0] {
            for rows in 1..8 {
                let bed = Bed::<2>::with_side_wall(ratio, rows);
                let line = DepthLine {
                    foot: [0.0, 0.0],
                    up: [0.0, 1.0],
                    length: 1.0,
                };
                let depth = bed.look(|view| line.sample(view));
                let error = (depth.values[0] - bed.height()) / bed.spacing;
                // Solid below the foot plane but under the side wall counts as bed: single rows read high.
                assert!(
                    error.abs() < 0.2,
                    "h/dp {ratio} rows {rows}: off by {error} dp"
                );
            }
        }
    }

    #[test]
    fn material_that_touches_a_lid_is_as_deep_as_the_lid_is_high() {
        for ratio in [1.3, 1.6, 2.0] {
            let bed = Bed::<2>::new(ratio, 6, 0.0).with_lid();
            let line = DepthLine {
                foot: [0.2, 0.0],
                up: [0.0, 1.0],
                length: 0.5,
            };
            let depth = bed.look(|view| line.sample(view)).values[0];
            // A face is known to a thousandth of a spacing.
            let off = (depth - bed.height()) / bed.spacing;
            assert!(off.abs() < 2e-3, "h/dp {ratio}: off by {off} dp");
        }
    }

    #[test]
    fn a_line_into_the_bed_is_blocked() {
        let bed = Bed::<2>::new(1.6, 6, 0.0);
        let line = DepthLine {
            foot: [0.2, 0.0],
            up: [0.0, -1.0],
            length: 0.5,
        };
        let depth = bed.look(|view| line.sample(view));
        assert_eq!(depth, Reading::none(1, Validity::Blocked));
    }

    #[test]
    fn dry_outside_and_covered_places_say_so() {
        let bed = Bed::<2>::new(1.6, 0, 0.0);
        let up = [0.0, 1.0];
        let sample = |foot: [f64; 2]| {
            bed.look(|view| {
                DepthLine {
                    foot,
                    up,
                    length: 0.5,
                }
                .sample(view)
            })
        };
        assert_eq!(sample([0.2, 0.0]), Reading::none(1, Validity::Empty));
        assert_eq!(sample([0.2, -7.0]), Reading::none(1, Validity::Outside));
        assert_eq!(
            sample([0.2, -2.5 * bed.spacing]),
            Reading::none(1, Validity::Blocked)
        );
    }

    #[test]
    fn searching_in_blocks_finds_what_searching_everywhere_finds() {
        // A bed with a slab that floats above it, seen by lines of many lengths and feet.
        let bed = Bed::<2>::new(1.6, 30, 0.1).keep(|x| x[1] < 0.06 || (x[1] > 0.21 && x[0] < 0.2));
        for k in 0..60 {
            let length = 0.04 + 0.0071 * f64::from(k);
            let foot = [0.0067 * f64::from(k), 0.0];
            let line = DepthLine {
                foot,
                up: [0.0, 1.0],
                length,
            };
            bed.look(|view| {
                let mut all = Nearby::new(view);
                all.gather(&foot, length + view.spacing);
                let everywhere = (0..=line.count(view))
                    .rev()
                    .find(|&k| line.fill(view, &all, line.height(view, k)) >= 0.5);
                let mut near = Nearby::new(view);
                assert_eq!(line.highest_filled(view, &mut near), everywhere, "line {k}");
                for least in [1.0, 1.01, 1.1, 1.3, 5.63, 5.7] {
                    let least = least * view.spacing;
                    let deep = line.depth(view).is_ok_and(|depth| depth >= least);
                    assert_eq!(line.is_deep(view, least), deep, "line {k}, {least} m");
                }
            });
        }
    }

    #[test]
    fn depth_ends_at_the_length_searched() {
        let bed = Bed::<2>::new(1.6, 12, 0.0);
        let line = DepthLine {
            foot: [0.2, 0.0],
            up: [0.0, 1.0],
            length: 5.0 * bed.spacing,
        };
        assert_eq!(
            bed.look(|view| line.sample(view)).values,
            [5.0 * bed.spacing]
        );
    }
}
