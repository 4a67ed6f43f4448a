//! Profiles at a few moments of a run of any length: what the picture shows of them.
//!
//! Rows are kept at even distances; when there are too many, every other one goes, and the next ones come twice as far apart. What is
//! kept depends on the rows alone.

use super::columns::Column;
use crate::math::{norm, sub};
use crate::scene::{GaugeKind, Point, Scene};

/// Most moments kept beside the last.
const MOST: usize = 7;

/// Time [s] and the values at all places [SI].
type Moment = (f64, Vec<f64>);

/// A profile gauge over the run.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    /// Name of its array.
    pub(super) name: String,
    /// What its places are: a coordinate, or the way from the first.
    pub(super) along: &'static str,
    /// Where its values are [m].
    pub(super) places: Vec<f64>,
    /// Its first value among those of a row.
    pub(super) first: usize,
    /// What says whether they are measurements.
    flag: usize,
    /// With the numbers of their rows.
    kept: Vec<(u64, Moment)>,
    last: Option<Moment>,
    /// Rows from one that is kept to the next.
    every: u64,
    rows: u64,
}

impl Profile {
    /// All that the scene has, in its order; `columns` are those of a row.
    pub(super) fn all(scene: &Scene, columns: &[Column]) -> Vec<Self> {
        let place = |name: &str| columns.iter().position(|c| c.name == name);
        let profiles = scene.gauges.iter().filter_map(|gauge| match &gauge.kind {
            GaugeKind::Profile {
                from, to, count, ..
            } => {
                let name = format!("gauge.{}.depth", gauge.name);
                let (along, places) = line(from, to, *count);
                Some(Self {
                    first: place(&format!("{name}[1]"))?,
                    flag: place(&format!("gauge.{}.validity", gauge.name))?,
                    name,
                    along,
                    places,
                    kept: Vec::new(),
                    last: None,
                    every: 1,
                    rows: 0,
                })
            }
            _ => None,
        });
        profiles.collect()
    }

    /// Sees a row.
    pub(super) fn see(&mut self, time: f64, values: &[f64]) {
        let row = self.rows;
        self.rows += 1;
        if values[self.flag] != 0.0 {
            return;
        }
        let own = &values[self.first..self.first + self.places.len()];
        self.last = Some((time, own.to_vec()));
        if row.is_multiple_of(self.every) {
            self.kept.push((row, (time, own.to_vec())));
        }
        while self.kept.len() > MOST {
            self.every *= 2;
            self.kept.retain(|(row, _)| row.is_multiple_of(self.every));
        }
    }

    /// What is kept, in the order of time, the last row with it.
    pub(super) fn moments(&self) -> impl Iterator<Item = &Moment> {
        let end = self.kept.last().map(|(_, moment)| moment.0);
        let last = self.last.iter().filter(move |last| end != Some(last.0));
        self.kept.iter().map(|(_, moment)| moment).chain(last)
    }
}

/// Evenly spaced places on a line: the one coordinate in which they differ, or how far each is from the first [m].
fn line(from: &Point, to: &Point, count: usize) -> (&'static str, Vec<f64>) {
    let differ: Vec<usize> = (0..3).filter(|&a| from[a] != to[a]).collect();
    let (along, start, end) = match differ[..] {
        [a] => (["x", "y", "z"][a], from[a], to[a]),
        _ => ("way from the first foot", 0.0, norm(&sub(to, from))),
    };
    let step = (end - start) / (count.max(2) - 1) as f64;
    (along, (0..count).map(|k| start + step * k as f64).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile() -> Profile {
        let (along, places) = line(&[1.0, 0.5, 0.0], &[3.0, 0.5, 0.0], 3);
        Profile {
            name: "gauge.surface.depth".to_owned(),
            along,
            places,
            first: 1,
            flag: 0,
            kept: Vec::new(),
            last: None,
            every: 1,
            rows: 0,
        }
    }

    #[test]
    fn a_long_run_keeps_a_few_moments_evenly_and_its_end() {
        let mut profile = profile();
        for n in 0..=1000 {
            let t = f64::from(n);
            profile.see(t, &[0.0, t, t + 0.5, t + 1.0]);
        }
        let times: Vec<f64> = profile.moments().map(|m| m.0).collect();
        assert_eq!(times, [0.0, 256.0, 512.0, 768.0, 1000.0]);
        assert!(profile.moments().all(|(t, v)| *v == [*t, t + 0.5, t + 1.0]));
    }

    #[test]
    fn what_is_no_measurement_is_not_kept() {
        let mut profile = profile();
        for n in 0..4 {
            profile.see(f64::from(n), &[f64::from(n % 2), 1.0, 1.0, 1.0]);
        }
        let times: Vec<f64> = profile.moments().map(|m| m.0).collect();
        assert_eq!(times, [0.0, 2.0]);
    }

    #[test]
    fn places_are_a_coordinate_or_the_way_along_a_slanting_line() {
        assert_eq!(
            (profile().along, profile().places),
            ("x", vec![1.0, 2.0, 3.0])
        );
        let (along, places) = line(&[0.0; 3], &[3.0, 4.0, 0.0], 2);
        assert_eq!((along, places), ("way from the first foot", vec![0.0, 5.0]));
    }
}
