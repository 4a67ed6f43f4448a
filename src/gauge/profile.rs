//! Surface profile: depths at evenly spaced feet.

use super::{DepthLine, Reading, Validity, View};

/// A row of depth lines.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile<const D: usize> {
    /// First foot [m].
    pub from: [f64; D],
    /// Last foot [m].
    pub to: [f64; D],
    /// Number of feet, at least 2.
    pub count: usize,
    /// Unit vector along the lines.
    pub up: [f64; D],
    /// Length of the lines searched [m].
    pub length: f64,
}

impl<const D: usize> Profile<D> {
    /// `count` values: depths [m]; 0 where a foot alone is dry, covered or outside.
    ///
    /// Valid if any foot is; otherwise the first foot's reason.
    #[must_use]
    pub fn sample(&self, view: &View<D>) -> Reading {
        let depths: Vec<Result<f64, Validity>> =
            (0..self.count).map(|k| self.line(k).depth(view)).collect();
        let validity = match depths.first() {
            Some(Err(why)) if depths.iter().all(Result::is_err) => *why,
            _ => Validity::Valid,
        };
        let values = depths.into_iter().map(|d| d.unwrap_or(0.0)).collect();
        Reading { values, validity }
    }

    fn line(&self, k: usize) -> DepthLine<D> {
        let share = k as f64 / (self.count.max(2) - 1) as f64;
        DepthLine {
            foot: std::array::from_fn(|a| self.from[a] + share * (self.to[a] - self.from[a])),
            up: self.up,
            length: self.length,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::bed::Bed;
    use super::*;

    #[test]
    fn profile_of_a_step_follows_the_step() {
        let bed = Bed::<2>::new(1.6, 8, 0.0);
        let half = 0.5 * bed.length();
        let bed = bed.keep(|x| x[0] < half || x[1] < 4.0 * 0.01);
        let profile = Profile {
            from: [0.05, 0.0],
            to: [bed.length() - 0.05, 0.0],
            count: 9,
            up: [0.0, 1.0],
            length: 0.3,
        };
        let reading = bed.look(|view| profile.sample(view));
        assert_eq!(reading.validity, Validity::Valid);
        assert_eq!(reading.values.len(), 9);
        for (k, depth) in reading.values.iter().enumerate() {
            let expected = match k.cmp(&4) {
                std::cmp::Ordering::Less => 0.08,
                std::cmp::Ordering::Greater => 0.04,
                std::cmp::Ordering::Equal => continue, // the step itself
            };
            assert!(
                (depth - expected).abs() < 0.001,
                "foot {k}: {depth} for {expected}"
            );
        }
    }

    #[test]
    fn profile_without_material_is_empty() {
        let bed = Bed::<2>::new(1.6, 0, 0.0);
        let profile = Profile {
            from: [0.05, 0.0],
            to: [0.2, 0.0],
            count: 3,
            up: [0.0, 1.0],
            length: 0.3,
        };
        assert_eq!(
            bed.look(|view| profile.sample(view)),
            Reading::none(3, Validity::Empty)
        );
    }
}
