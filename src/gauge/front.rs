//! Front: the outermost place along a direction with a depth of at least so much, and the 99.5 % mass
//! quantile beside it. Material that leans on a wall ends at the wall's face: what is behind it has no depth.
//!
//! In space, only the vertical plane through the origin along the direction is looked at: depths are those on it,
//! and the quantile is of the mass within one kernel radius of it.

use super::{DepthLine, Reading, Validity, View, along, component};

/// Share of the mass ahead of the origin that the quantile leaves behind it.
const QUANTILE: f64 = 0.995;

/// Where the front is looked for.
#[derive(Clone, Debug, PartialEq)]
pub struct Front<const D: usize> {
    /// Where distances start; a point of the bed [m].
    pub origin: [f64; D],
    /// Unit vector along the bed.
    pub direction: [f64; D],
    /// Unit vector of depth.
    pub up: [f64; D],
    /// Depth that counts [m]: one spacing unless the scene says otherwise; less cannot be seen.
    pub least_depth: f64,
}

impl<const D: usize> Front<D> {
    /// Two values: front [m] and 99.5 % quantile of the mass ahead of the origin [m], both from the origin.
    ///
    /// Empty: no place ahead of the origin is as deep as that.
    #[must_use]
    pub fn sample(&self, view: &View<D>) -> Reading {
        if view.is_outside(&self.origin) {
            return Reading::none(2, Validity::Outside);
        }
        let mut ahead: Vec<(f64, f64)> = Vec::new();
        let mut highest: f64 = 0.0;
        for (x, &mass) in view.position.iter().zip(view.mass) {
            let s = component(x, &self.origin, &self.direction);
            if s > 0.0 && self.is_near_plane(x, s, view.kernel.support()) {
                ahead.push((s, mass));
                highest = highest.max(component(x, &self.origin, &self.up));
            }
        }
        // Ties keep the order of particles, so the sums below have one order.
        ahead.sort_by(|a, b| a.0.total_cmp(&b.0));
        let Some(&(outermost, _)) = ahead.last() else {
            return Reading::none(2, Validity::Empty);
        };
        match self.front(view, outermost, highest) {
            Some(front) => Reading::valid(vec![front, quantile(&ahead)]),
            None => Reading::none(2, Validity::Empty),
        }
    }

    /// Whether a particle is within `radius` of the vertical plane along the direction; always so in the plane.
    fn is_near_plane(&self, x: &[f64; D], s: f64, radius: f64) -> bool {
        let height = component(x, &self.origin, &self.up);
        let square: f64 = (0..D)
            .map(|a| (x[a] - self.origin[a] - s * self.direction[a] - height * self.up[a]).powi(2))
            .sum();
        D == 2 || square < radius * radius
    }

    /// Outermost distance with that depth, searched from a spacing beyond the outermost particle.
    fn front(&self, view: &View<D>, outermost: f64, highest: f64) -> Option<f64> {
        let deep = |s: f64| {
            let foot = along(&self.origin, &self.direction, s);
            let line = DepthLine {
                foot,
                up: self.up,
                length: highest + 2.0 * view.spacing,
            };
            line.is_deep(view, self.least_depth)
        };
        let step = 0.5 * view.spacing;
        let start = outermost + 2.0 * step;
        let count = (start / step).ceil() as usize;
        let place = |k: usize| (start - k as f64 * step).max(0.0);
        let inner = (0..=count).find(|&k| deep(place(k)))?;
        if inner == 0 {
            return Some(place(0));
        }
        let (mut low, mut high) = (place(inner), place(inner - 1));
        for _ in 0..20 {
            let middle = 0.5 * (low + high);
            if deep(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(low)
    }
}

/// Distance behind which the given share of mass lies; `sorted` holds (distance, mass), at least one.
fn quantile(sorted: &[(f64, f64)]) -> f64 {
    let total: f64 = sorted.iter().map(|p| p.1).sum();
    let mut sum = 0.0;
    for &(s, mass) in sorted {
        sum += mass;
        if sum >= QUANTILE * total {
            return s;
        }
    }
    sorted[sorted.len() - 1].0
}

#[cfg(test)]
mod tests {
    use super::super::view::bed::Bed;
    use super::*;

    #[test]
    fn front_of_a_block_is_its_face() {
        let block = Bed::<2>::new(1.6, 10, 0.0).keep(|x| x[0] < 0.25);
        let front = Front {
            origin: [0.05, 0.0],
            direction: [1.0, 0.0],
            up: [0.0, 1.0],
            least_depth: block.spacing,
        };
        let reading = block.look(|view| front.sample(view));
        assert_eq!(reading.validity, Validity::Valid);
        // The surface rounds off at the kernel's width at a right angle: a spacing at most.
        assert!(
            (reading.values[0] - 0.2).abs() < block.spacing,
            "{reading:?}"
        );
        // 20 columns of equal mass: 99.5 % lies behind the last, at 0.245 - 0.05.
        assert!((reading.values[1] - 0.195).abs() < 1e-9, "{reading:?}");
    }

    #[test]
    fn lone_grains_ahead_are_not_the_front() {
        let block = Bed::<2>::new(1.6, 10, 0.0)
            .keep(|x| x[0] < 0.25 || (x[0] > 0.35 && x[0] < 0.36 && x[1] < 0.01));
        let front = Front {
            origin: [0.0, 0.0],
            direction: [1.0, 0.0],
            up: [0.0, 1.0],
            least_depth: block.spacing,
        };
        let reading = block.look(|view| front.sample(view));
        assert!(
            (reading.values[0] - 0.25).abs() < block.spacing,
            "{reading:?}"
        );
    }

    /// A wedge 0.1 deep at the origin and 0 at 0.4: the front recedes by what the depth asks for.
    #[test]
    fn a_deeper_front_lies_further_back() {
        let wedge = Bed::<2>::new(1.6, 20, 0.0).keep(|x| x[1] < 0.1 * (1.0 - x[0] / 0.4));
        let place = |least_depth: f64| {
            let front = Front {
                origin: [0.0, 0.0],
                direction: [1.0, 0.0],
                up: [0.0, 1.0],
                least_depth,
            };
            wedge.look(|view| front.sample(view)).values[0]
        };
        let (thin, deep) = (place(0.03), place(0.06));
        // Rows of one spacing: places are known to four spacings at this slope.
        assert!(
            (thin - deep - 0.12).abs() < 4.0 * wedge.spacing,
            "{thin} {deep}"
        );
    }

    /// On a thin wedge a row is ten spacings long: the front is where the profile has that depth, whatever share of a spacing it is.
    #[test]
    fn the_front_is_where_the_depth_gauge_reads_that_depth() {
        let wedge = Bed::<2>::new(1.6, 4, 0.0).keep(|x| x[1] < 0.04 * (1.0 - x[0] / 0.4));
        for least in [1.0, 1.02, 1.1, 1.24, 1.26, 1.5, 2.1] {
            let least_depth = least * wedge.spacing;
            let front = Front {
                origin: [0.0, 0.0],
                direction: [1.0, 0.0],
                up: [0.0, 1.0],
                least_depth,
            };
            let place = wedge.look(|view| front.sample(view)).values[0];
            let depth = |s: f64| {
                let line = DepthLine {
                    foot: [s, 0.0],
                    up: [0.0, 1.0],
                    length: 0.1,
                };
                wedge.look(|view| line.sample(view)).values[0]
            };
            // Bisection leaves half a spacing over 2^20.
            let near = 1e-5 * wedge.spacing;
            let (before, beyond) = (depth(place - near), depth(place + near));
            assert!(
                before >= least_depth * (1.0 - 1e-6) && beyond < least_depth * (1.0 + 1e-6),
                "{least} spacings: {before} m before {place} m, {beyond} m beyond"
            );
            // Not only at its edge: nothing beyond is as deep.
            // As far as the images across the periodic side, which are deep.
            let places = (1..40).map(|k| place + 0.5 * f64::from(k) * wedge.spacing);
            let beyond = places.filter(|s| *s < 0.36).map(depth);
            let deepest = beyond.fold(0.0, f64::max);
            assert!(
                deepest < least_depth + 0.01 * wedge.spacing,
                "{least} spacings: {deepest} m beyond"
            );
        }
    }

    #[test]
    fn no_material_ahead_is_empty() {
        let block = Bed::<2>::new(1.6, 10, 0.0).keep(|x| x[0] < 0.25);
        let front = Front {
            origin: [0.3, 0.0],
            direction: [1.0, 0.0],
            up: [0.0, 1.0],
            least_depth: block.spacing,
        };
        assert_eq!(
            block.look(|view| front.sample(view)),
            Reading::none(2, Validity::Empty)
        );
    }
}
