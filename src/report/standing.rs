//! What of a log still stands after its roll-backs: where an importer went back to a state that it had saved, the
//! figures and snapshots of the steps it took back are left out, as [`Table`](crate::record::Table) leaves out their rows.

use super::pack::{Cloud, Scale};
use crate::wire::messages::{Applied, AppliedEvent, StepStats};
use std::collections::HashMap;

/// A snapshot of the log that stands.
pub(super) struct Shot {
    /// Its number among all snapshots of the file, from 0.
    pub(super) number: usize,
    /// Particles in it.
    pub(super) particles: usize,
    /// What it needs of the scale.
    pub(super) scale: Scale,
    /// Simulated time [ns].
    log_time: u64,
}

/// Figures and snapshots that stand, in the order of time.
#[derive(Default)]
pub(super) struct Standing {
    pub(super) stats: Vec<StepStats>,
    pub(super) shots: Vec<Shot>,
    /// Snapshots read so far, those taken back among them.
    read: usize,
    /// How many snapshots had been read when states were saved, by the states' checksums.
    saved: HashMap<Vec<u8>, usize>,
}

impl Standing {
    pub(super) fn add_cloud(&mut self, log_time: u64, cloud: Cloud) {
        self.shots.push(Shot {
            number: self.read,
            particles: cloud.len(),
            scale: Scale::of(cloud),
            log_time,
        });
        self.read += 1;
    }

    /// `log_time` is the time of the message [ns].
    pub(super) fn add_applied(&mut self, log_time: u64, applied: &Applied) {
        match applied.event() {
            AppliedEvent::Save => {
                self.saved.insert(applied.state.clone(), self.read);
            }
            AppliedEvent::Restore => {
                if let Some(&read) = self.saved.get(&applied.state) {
                    self.take_back(applied.step, log_time, read);
                }
            }
            _ => {}
        }
    }

    /// Figures of this step come again. A snapshot does not: that of the state itself stays.
    fn take_back(&mut self, step: u64, log_time: u64, read: usize) {
        let kept = self.stats.partition_point(|own| own.step < step);
        self.stats.truncate(kept);
        self.shots.retain(|shot| {
            shot.log_time < log_time || shot.log_time == log_time && shot.number < read
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::foxglove::PointCloud;

    fn applied(event: AppliedEvent, step: u64, state: u8) -> Applied {
        Applied {
            event: event as i32,
            step,
            state: vec![state],
            ..Applied::default()
        }
    }

    /// Steps to `last`, each with its figures and its snapshot.
    fn go(standing: &mut Standing, steps: std::ops::RangeInclusive<u64>) {
        for step in steps {
            figures(standing, step);
            standing.add_cloud(step, Cloud::of(&PointCloud::default()));
        }
    }

    fn figures(standing: &mut Standing, step: u64) {
        standing.stats.push(StepStats {
            step,
            ..StepStats::default()
        });
    }

    fn what_stands(standing: &Standing) -> (Vec<u64>, Vec<usize>) {
        let steps = standing.stats.iter().map(|stats| stats.step).collect();
        let numbers = standing.shots.iter().map(|shot| shot.number).collect();
        (steps, numbers)
    }

    #[test]
    fn what_was_taken_back_does_not_stand() {
        let mut standing = Standing::default();
        go(&mut standing, 0..=2);
        standing.add_applied(2, &applied(AppliedEvent::Save, 2, b'a'));
        go(&mut standing, 3..=4);
        standing.add_applied(4, &applied(AppliedEvent::Save, 4, b'b'));
        standing.add_applied(2, &applied(AppliedEvent::Restore, 2, b'a'));
        // As a log has it: figures of the state come again, its snapshot does not.
        figures(&mut standing, 2);
        assert_eq!(what_stands(&standing), (vec![0, 1, 2], vec![0, 1, 2]));
        go(&mut standing, 3..=4);
        let second = (vec![0, 1, 2, 3, 4], vec![0, 1, 2, 5, 6]);
        assert_eq!(what_stands(&standing), second);
        // The snapshot at this time is of the other way to it, not of the state.
        standing.add_applied(4, &applied(AppliedEvent::Restore, 4, b'b'));
        figures(&mut standing, 4);
        assert_eq!(what_stands(&standing), (second.0, vec![0, 1, 2, 5]));
        // The state a file starts from is none that it saved.
        standing.add_applied(0, &applied(AppliedEvent::Restore, 0, b'c'));
        assert_eq!(standing.stats.len(), 5);
    }
}
