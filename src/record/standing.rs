//! What of a log still stands after its roll-backs: where an importer went back to a state that it had saved, or forth
//! again to one that it had saved later, the rows and snapshots of the way to that state are the ones that count.
//!
//! A reading of its own comes before that of the tables and pictures, so that these keep what stands and nothing else.
//! Every row knows the one before it on its way here, so a saved state is one place on a tree, however many there are.
//! Each file of a log is taken for itself, as a state that was not saved in it begins the next file.

use super::error::ReadError;
use super::raw::{RawEntry, RawReader};
use super::read::{Body, decode};
use crate::wire::messages::{Applied, AppliedEvent};
use std::collections::HashMap;
use std::path::Path;

/// Which rows and snapshots of a log stand, by their numbers in it, from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Standing {
    rows: Vec<bool>,
    snapshots: Vec<bool>,
    returns: Vec<usize>,
}

impl Standing {
    /// Of the log at `path`, up to its cut if it was cut.
    ///
    /// # Errors
    /// [`ReadError`].
    pub fn of(path: &Path) -> Result<Self, ReadError> {
        let mut ways = Ways::default();
        for entry in RawReader::open(path)? {
            let RawEntry::Message(message) = entry? else {
                continue;
            };
            match message.channel.schema.name.as_str() {
                // The large ones are not looked into.
                "foxglove.PointCloud" => ways.snapshot(message.log_time),
                "sandgate.Applied" | "sandgate.StepStats" => match decode(path, &message)? {
                    Body::Applied(applied) => ways.applied(message.log_time, &applied),
                    Body::Stats(stats) => ways.row(stats.step),
                    _ => {}
                },
                _ => {}
            }
        }
        Ok(ways.standing())
    }

    /// Whether the `number`-th line of figures (`out/stats`), and the outputs before it, stand.
    #[must_use]
    pub fn row(&self, number: usize) -> bool {
        self.rows.get(number).is_some_and(|stands| *stands)
    }

    /// Whether the `number`-th snapshot of particles stands.
    #[must_use]
    pub fn snapshot(&self, number: usize) -> bool {
        self.snapshots.get(number).is_some_and(|stands| *stands)
    }

    /// How often the log comes back to the state of its `number`-th SAVE: states that nobody comes back to need not be kept.
    #[must_use]
    pub(super) fn returns(&self, number: usize) -> usize {
        self.returns.get(number).copied().unwrap_or_default()
    }
}

/// Where a run was when a state was saved.
struct Place {
    row: usize,
    snapshot: usize,
    /// Number of the SAVE.
    save: usize,
}

/// All ways that a run went.
#[derive(Default)]
struct Ways {
    /// By communication steps.
    rows: Tree,
    /// By log time [ns].
    snapshots: Tree,
    /// By checksum.
    saved: HashMap<Vec<u8>, Place>,
    returns: Vec<usize>,
    /// Whether what comes is that of a state that has been there before.
    again: bool,
}

impl Ways {
    fn applied(&mut self, log_time: u64, applied: &Applied) {
        let event = applied.event();
        self.again = event == AppliedEvent::Restore;
        match event {
            AppliedEvent::Save => {
                let place = Place {
                    row: self.rows.here,
                    snapshot: self.snapshots.here,
                    save: self.returns.len(),
                };
                self.saved.insert(applied.state.clone(), place);
                self.returns.push(0);
            }
            AppliedEvent::Restore => match self.saved.get(&applied.state) {
                Some(place) => {
                    self.rows.here = place.row;
                    self.snapshots.here = place.snapshot;
                    self.returns[place.save] += 1;
                }
                // Nobody knows how it came there, only that later points are over. The state that a file starts from is such a one.
                None => {
                    self.rows.leave(applied.step);
                    self.snapshots.leave(log_time);
                }
            },
            _ => {}
        }
    }

    fn row(&mut self, step: u64) {
        self.rows.add(step, self.again);
    }

    fn snapshot(&mut self, log_time: u64) {
        self.snapshots.add(log_time, self.again);
    }

    fn standing(self) -> Standing {
        Standing {
            rows: self.rows.way_here(),
            snapshots: self.snapshots.way_here(),
            returns: self.returns,
        }
    }
}

/// Messages of one kind in the order of the log, each with its point in time.
#[derive(Default)]
struct Tree {
    nodes: Vec<Node>,
    /// The last one on the way here, counted from 1; 0 for none.
    here: usize,
}

struct Node {
    /// The one before it, as [`Tree::here`].
    before: usize,
    point: u64,
}

impl Tree {
    /// One more; if it tells `again` what is here already, that stays.
    fn add(&mut self, point: u64, again: bool) {
        let before = self.here;
        self.nodes.push(Node { before, point });
        if !(again && self.last().is_some_and(|last| last.point == point)) {
            self.here = self.nodes.len();
        }
    }

    fn last(&self) -> Option<&Node> {
        self.nodes.get(self.here.checked_sub(1)?)
    }

    /// To the last one before this point.
    fn leave(&mut self, point: u64) {
        while let Some(last) = self.last().filter(|last| last.point >= point) {
            self.here = last.before;
        }
    }

    fn way_here(mut self) -> Vec<bool> {
        let mut stands = vec![false; self.nodes.len()];
        while let Some(before) = self.last().map(|last| last.before) {
            stands[self.here - 1] = true;
            self.here = before;
        }
        stands
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ops::RangeInclusive;

    impl Ways {
        fn told(&mut self, event: AppliedEvent, step: u64, state: &[u8]) {
            let applied = Applied {
                event: event as i32,
                step,
                state: state.to_vec(),
                ..Applied::default()
            };
            self.applied(step, &applied);
        }

        /// Steps to the last one, each with its figures and its snapshot.
        fn go(&mut self, steps: RangeInclusive<u64>) {
            for step in steps {
                self.told(AppliedEvent::Step, step, b"");
                self.row(step);
                self.snapshot(step);
            }
        }

        fn save(&mut self, step: u64, state: &[u8]) {
            self.told(AppliedEvent::Save, step, state);
        }

        /// As a log has it: figures of the state come again, its snapshot only if it is due again.
        fn restore(&mut self, step: u64, state: &[u8], due: bool) {
            self.told(AppliedEvent::Restore, step, state);
            self.row(step);
            if due {
                self.snapshot(step);
            }
        }
    }

    /// Numbers of the rows and of the snapshots that stand.
    fn what_stands(ways: Ways) -> (Vec<usize>, Vec<usize>) {
        let numbers = |stands: Vec<bool>| (0..stands.len()).filter(|&k| stands[k]).collect();
        let standing = ways.standing();
        (numbers(standing.rows), numbers(standing.snapshots))
    }

    #[test]
    fn what_was_taken_back_does_not_stand() {
        let mut ways = Ways::default();
        ways.go(0..=2);
        ways.save(2, b"a");
        ways.go(3..=4);
        ways.restore(2, b"a", false);
        ways.go(3..=4);
        // Rows 0 to 4, that of the state again, and two more; a snapshot less.
        assert_eq!(
            what_stands(ways),
            (vec![0, 1, 2, 6, 7], vec![0, 1, 2, 5, 6])
        );
    }

    #[test]
    fn who_goes_forth_again_gets_the_way_to_that_state_back() {
        for due in [false, true] {
            let mut ways = Ways::default();
            ways.go(0..=5);
            ways.save(5, b"early");
            ways.go(6..=10);
            ways.save(10, b"late");
            ways.restore(5, b"early", false);
            ways.go(6..=8);
            ways.restore(10, b"late", due);
            ways.go(11..=12);
            // 0 to 10; 5 again, 6, 7, 8 of the way that was given up; 10 again; then what was kept.
            let rows = (0..=10).chain(16..=17).collect();
            let shots = (0..=10).chain([14, 15].map(|k| k + usize::from(due)));
            assert_eq!(what_stands(ways), (rows, shots.collect()));
        }
    }

    #[test]
    fn a_state_that_is_reached_twice_keeps_the_way_on_which_it_was_saved_last() {
        let mut ways = Ways::default();
        ways.go(0..=0);
        ways.save(0, b"start");
        ways.go(1..=1);
        ways.save(1, b"same");
        ways.restore(0, b"start", false);
        ways.go(1..=1);
        ways.save(1, b"same");
        ways.go(2..=2);
        ways.restore(1, b"same", false);
        assert_eq!(ways.returns, [1, 0, 1]);
        assert_eq!(what_stands(ways), (vec![0, 3], vec![0, 2]));
    }

    #[test]
    fn a_state_of_elsewhere_ends_what_is_later_and_the_one_a_file_starts_from_nothing() {
        let mut ways = Ways::default();
        ways.restore(7, b"", true);
        ways.go(8..=9);
        assert_eq!(ways.rows.here, 3);
        ways.restore(8, b"unknown", true);
        ways.go(9..=9);
        assert_eq!(what_stands(ways), (vec![0, 3, 4], vec![0, 3, 4]));
    }

    #[test]
    fn a_run_that_never_goes_back_stands_as_it_is() {
        let mut ways = Ways::default();
        // Two snapshots at a time, as times below 0 are written as 0.
        for step in 0..3 {
            ways.told(AppliedEvent::Step, step, b"");
            ways.row(step);
            ways.snapshot(0);
        }
        ways.save(2, b"never restored");
        assert_eq!(what_stands(ways), (vec![0, 1, 2], vec![0, 1, 2]));
    }
}
