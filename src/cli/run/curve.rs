//! A variable over a run of any length, in bounded memory: what a picture shows of it.
//!
//! Samples are gathered in bins of equally many, and of each bin the first, last, least and largest are kept. When there are too
//! many bins, each two become one and the next ones take twice as many samples: peaks stay, and what is kept depends on the
//! samples alone. A run of fewer samples than there may be bins keeps all.

/// Most bins: at least two for each pixel of the picture's width.
const MOST_BINS: usize = 4096;

/// Time [s] and value [SI].
pub(super) type Point = (f64, f64);

/// The samples, thinned.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    bins: Vec<Bin>,
    /// Samples of a full bin.
    size: u64,
    /// Samples of the last bin.
    filled: u64,
}

/// Samples that follow each other.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Bin {
    /// Of the valid ones.
    kept: Option<Kept>,
    /// Time of the first that is not valid [s].
    gap: Option<f64>,
}

/// What is kept of them.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Kept {
    first: Point,
    low: Point,
    high: Point,
    last: Point,
    /// Whether the largest came before the least.
    falls: bool,
}

impl Curve {
    /// Without samples.
    pub(super) fn new() -> Self {
        Self {
            bins: Vec::new(),
            size: 1,
            filled: 0,
        }
    }

    /// Adds a sample: a value that was reached at `time`, or held from `since` to then; `None` if it is none to show.
    pub(super) fn add(&mut self, since: f64, time: f64, value: Option<f64>) {
        let bin = match value {
            Some(value) => Bin::of((since, value), (time, value)),
            None => Bin {
                kept: None,
                gap: Some(time),
            },
        };
        match self.bins.last_mut() {
            Some(last) if self.filled < self.size => {
                *last = last.followed_by(&bin);
                self.filled += 1;
            }
            _ => {
                if self.bins.len() == MOST_BINS {
                    self.merge_pairs();
                }
                self.bins.push(bin);
                self.filled = 1;
            }
        }
    }

    fn merge_pairs(&mut self) {
        let pairs = self.bins.chunks(2);
        let merged = pairs.map(|pair| match pair {
            [one, next] => one.followed_by(next),
            // Never: there may be an even number of bins.
            rest => rest[0],
        });
        self.bins = merged.collect();
        self.size *= 2;
    }

    /// What is kept, in the order of time; `None` where the curve breaks.
    pub(super) fn points(&self) -> impl Iterator<Item = Option<Point>> {
        self.bins.iter().flat_map(Bin::points)
    }
}

impl Bin {
    fn of(first: Point, last: Point) -> Self {
        let kept = Kept {
            first,
            low: first,
            high: first,
            last,
            falls: false,
        };
        Self {
            kept: Some(kept),
            gap: None,
        }
    }

    fn followed_by(&self, next: &Self) -> Self {
        let kept = match (self.kept, next.kept) {
            (Some(one), Some(next)) => Some(one.followed_by(&next)),
            (one, next) => one.or(next),
        };
        Self {
            kept,
            gap: self.gap.or(next.gap),
        }
    }

    fn points(&self) -> Vec<Option<Point>> {
        let mut points: Vec<Option<Point>> = match &self.kept {
            Some(kept) => kept.points().into_iter().map(Some).collect(),
            None => Vec::new(),
        };
        if let Some(gap) = self.gap {
            let behind = |point: &Option<Point>| point.is_some_and(|(time, _)| time >= gap);
            let at = points.iter().position(behind).unwrap_or(points.len());
            points.insert(at, None);
        }
        points
    }
}

impl Kept {
    fn followed_by(&self, next: &Self) -> Self {
        let (lower, higher) = (next.low.1 < self.low.1, next.high.1 > self.high.1);
        Self {
            first: self.first,
            low: if lower { next.low } else { self.low },
            high: if higher { next.high } else { self.high },
            last: next.last,
            falls: match (lower, higher) {
                (false, false) => self.falls,
                (true, true) => next.falls,
                (lower, _) => lower,
            },
        }
    }

    /// In the order of time, each once.
    fn points(&self) -> Vec<Point> {
        let (one, other) = match self.falls {
            true => (self.high, self.low),
            false => (self.low, self.high),
        };
        let mut points = vec![self.first, one, other, self.last];
        points.dedup();
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(samples: impl Iterator<Item = (f64, Option<f64>)>) -> Curve {
        let mut curve = Curve::new();
        for (time, value) in samples {
            curve.add(time, time, value);
        }
        curve
    }

    /// A hundred million steps of a run would be as many bins.
    #[test]
    fn a_long_run_keeps_its_peaks_and_ends_in_bounded_memory() {
        let many = 1_000_003_u32;
        let wave = |n: u32| match n {
            345_678 => 9.0,
            999_999 => -7.0,
            n => (f64::from(n) * 0.37).sin(),
        };
        let long = curve((0..many).map(|n| (f64::from(n), Some(wave(n)))));
        assert!((MOST_BINS / 2..=MOST_BINS).contains(&long.bins.len()));
        let points: Vec<Point> = long.points().flatten().collect();
        assert!(points.len() <= 4 * MOST_BINS);
        assert!(points.is_sorted_by(|a, b| a.0 < b.0));
        assert!(points.contains(&(345_678.0, 9.0)) && points.contains(&(999_999.0, -7.0)));
        let end = f64::from(many - 1);
        assert_eq!(points[0], (0.0, 0.0));
        assert_eq!(points[points.len() - 1], (end, wave(many - 1)));
        // Bins are of equal numbers of samples, so that no part of the run is thinner than another.
        let early = points.iter().filter(|p| p.0 < 0.25 * end).count();
        let share = early as f64 / points.len() as f64;
        assert!((share - 0.25).abs() < 0.01, "{share}");
    }

    #[test]
    fn a_short_run_keeps_every_sample_and_gap() {
        let samples: Vec<_> = (0..MOST_BINS)
            .map(|n| (n as f64, (n % 10 != 3).then_some((n as f64).sin())))
            .collect();
        let short = curve(samples.iter().copied());
        let points: Vec<_> = short.points().collect();
        let wanted: Vec<_> = samples.iter().map(|(t, v)| Some((*t, (*v)?))).collect();
        assert_eq!(points, wanted);
    }

    #[test]
    fn gaps_stay_when_a_run_is_long() {
        let empty = |n: u32| (40_000..60_000).contains(&n) || n == 77_777;
        let long = curve((0..100_000).map(|n| (f64::from(n), (!empty(n)).then_some(1.0))));
        let pieces: Vec<Vec<_>> = long
            .points()
            .collect::<Vec<_>>()
            .split(Option::is_none)
            .map(|piece| piece.iter().flatten().map(|p| p.0).collect())
            .filter(|piece: &Vec<f64>| !piece.is_empty())
            .collect();
        let ends: Vec<_> = pieces.iter().map(|p| (p[0], p[p.len() - 1])).collect();
        assert_eq!(ends.len(), 3, "{ends:?}");
        assert_eq!((ends[0].0, ends[2].1), (0.0, 99_999.0));
        assert_eq!((ends[0].1, ends[1].0), (39_999.0, 60_000.0));
        // Within a bin of 32.
        assert!((ends[1].1 - 77_777.0).abs() < 32.0, "{ends:?}");
    }

    #[test]
    fn what_holds_over_a_step_is_drawn_from_its_start() {
        let mut held = Curve::new();
        held.add(0.0, 0.0, Some(0.0));
        held.add(0.0, 1.0, Some(0.5));
        let points: Vec<_> = held.points().flatten().collect();
        assert_eq!(points, [(0.0, 0.0), (0.0, 0.5), (1.0, 0.5)]);
    }
}
