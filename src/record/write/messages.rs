//! The messages of a log: what is told to the recorder becomes bytes on its channels.

use super::Recorder;
use crate::component::{Component, StepReport};
use crate::record::channels::Channel;
use crate::record::error::RecordError;
use crate::record::file::LogFile;
use crate::wire::convert::{self, nanoseconds, timestamp};
use crate::wire::foxglove::{Log, LogLevel, SceneUpdate};
use crate::wire::messages::{AppliedEvent, Command, CommandKind};
use prost::Message;
use std::time::{SystemTime, UNIX_EPOCH};

impl Recorder {
    /// A call from outside, or the reply to one. How long a step took is no part of a deterministic log.
    ///
    /// # Errors
    /// [`RecordError::Required`].
    pub fn record_command(&mut self, command: &Command) -> Result<(), RecordError> {
        let channel = self.channels.command(&mut self.file, command);
        let deterministic = self.options.deterministic;
        let timed = deterministic && command.kind() == CommandKind::Reply;
        let data = match timed.then(|| without_wall_time(&command.body)).flatten() {
            Some(body) => {
                let command = Command {
                    body,
                    ..command.clone()
                };
                command.encode_to_vec()
            }
            None => command.encode_to_vec(),
        };
        write(&mut self.file, deterministic, channel, command.time, &data);
        self.check()
    }

    /// A line for people; `name` is the part of the program that speaks.
    ///
    /// # Errors
    /// [`RecordError::Required`].
    pub fn log(
        &mut self,
        time: f64,
        level: LogLevel,
        name: &str,
        message: &str,
    ) -> Result<(), RecordError> {
        let line = Log {
            timestamp: Some(timestamp(time)),
            level: level as i32,
            message: message.to_owned(),
            name: name.to_owned(),
            file: String::new(),
            line: 0,
        };
        let data = line.encode_to_vec();
        let channel = &mut self.channels.log;
        write(
            &mut self.file,
            self.options.deterministic,
            channel,
            time,
            &data,
        );
        self.check()
    }

    /// A snapshot of the particles now, due or not.
    ///
    /// # Errors
    /// [`RecordError::Required`].
    pub fn particles(&mut self, component: &Component) -> Result<(), RecordError> {
        let data = convert::point_cloud(component).encode_to_vec();
        let channel = &mut self.channels.particles;
        let time = component.time();
        write(
            &mut self.file,
            self.options.deterministic,
            channel,
            time,
            &data,
        );
        self.check()
    }

    pub(super) fn scene(&mut self, update: &SceneUpdate, time: f64) {
        let update = update.encode_to_vec();
        let channel = &mut self.channels.scene;
        write(
            &mut self.file,
            self.options.deterministic,
            channel,
            time,
            &update,
        );
    }

    pub(super) fn applied(
        &mut self,
        component: &Component,
        event: AppliedEvent,
        (t, h): (f64, f64),
        source: &str,
    ) {
        let step = match event {
            AppliedEvent::Initialize => 0,
            _ => component.communication_steps(),
        };
        self.write_applied(event, step, (t, h), &[], source);
    }

    /// As `applied`, of a call about a saved state.
    pub(super) fn stated(
        &mut self,
        component: &Component,
        event: AppliedEvent,
        times: (f64, f64),
        state: &[u8],
        source: &str,
    ) {
        let step = component.communication_steps();
        self.write_applied(event, step, times, state, source);
    }

    /// Inputs that were set after the last step, and that no step will use.
    pub(super) fn leave_pending(&mut self) {
        let last = self.last;
        let times = (last.time, 0.0);
        self.write_applied(AppliedEvent::Set, last.communication_steps, times, &[], "");
    }

    fn write_applied(
        &mut self,
        event: AppliedEvent,
        step: u64,
        (t, h): (f64, f64),
        state: &[u8],
        source: &str,
    ) {
        let mut applied = self.pending.applied(event, step, (t, h), source);
        applied.state = state.to_vec();
        let data = applied.encode_to_vec();
        let channel = &mut self.channels.applied;
        let deterministic = self.options.deterministic;
        write(&mut self.file, deterministic, channel, t, &data);
    }

    /// Outputs, figures, frames of gates and moving walls and, when due, particles.
    pub(super) fn outputs(
        &mut self,
        component: &Component,
        report: Option<&StepReport>,
    ) -> Result<(), RecordError> {
        self.remember(component);
        let (time, deterministic) = (self.last.time, self.options.deterministic);
        let step = self.last.communication_steps;
        for (output, channel) in &mut self.channels.outputs {
            let data = convert::gauge(component, output, step, channel.next)?.encode_to_vec();
            write(&mut self.file, deterministic, channel, time, &data);
        }
        let stats = &mut self.channels.stats;
        let data = convert::step_stats(component, report, stats.next).encode_to_vec();
        write(&mut self.file, deterministic, stats, time, &data);
        for frame in convert::frames(component)? {
            let channel = &mut self.channels.frames;
            write(
                &mut self.file,
                deterministic,
                channel,
                time,
                &frame.encode_to_vec(),
            );
        }
        if self.particles_due(time) {
            self.particles(component)?;
        }
        Ok(())
    }

    /// Whether a snapshot's time has come since the last one; several that a long step has passed give one.
    fn particles_due(&mut self, time: f64) -> bool {
        let every = self.options.particles_every;
        if every <= 0.0 {
            return false;
        }
        let due = snapshots_due(time - self.first_time, every);
        // More than can be counted: one each time.
        let come = due > self.snapshots || due == u64::MAX;
        self.snapshots = due;
        come
    }

    pub(super) fn end_of_step(&mut self) -> Result<(), RecordError> {
        if self.options.deterministic {
            self.file.flush();
        }
        self.check()
    }

    pub(super) fn check(&self) -> Result<(), RecordError> {
        match self.file.failure() {
            Some(failure) if self.options.required => Err(RecordError::Required(failure)),
            _ => Ok(()),
        }
    }
}

/// Snapshots that are due after so long, the first at once [s].
fn snapshots_due(elapsed: f64, every: f64) -> u64 {
    // A billionth of the interval is allowed for, as communication points are sums of rounded steps.
    let whole = (elapsed / every + 1e-9).floor();
    // `as` saturates.
    (whole as u64).saturating_add(1)
}

/// A reply without its field `wall_us`, if it has it. The text within cannot be part of a string: there quotes are escaped.
fn without_wall_time(body: &str) -> Option<String> {
    const FIELD: &str = ",\"wall_us\":";
    let (before, after) = body.split_once(FIELD)?;
    let rest = after.trim_start_matches(|c: char| c.is_ascii_digit());
    Some(format!("{before}{rest}"))
}

fn write(file: &mut LogFile, deterministic: bool, channel: &mut Channel, time: f64, data: &[u8]) {
    let log_time = nanoseconds(time);
    let publish_time = if deterministic {
        log_time
    } else {
        // A clock before 1970 gives 0; nothing depends on it.
        let since = SystemTime::now().duration_since(UNIX_EPOCH);
        since.map_or(0, |d| u64::try_from(d.as_nanos()).unwrap_or(u64::MAX))
    };
    // MCAP counts in 32 bits and says that numbers may come round.
    let sequence = channel.next as u32;
    file.message(time, channel.id, sequence, (log_time, publish_time), data);
    channel.next += 1;
}

#[cfg(test)]
mod tests {
    use super::snapshots_due;

    #[test]
    fn snapshots_are_counted_however_many_are_due() {
        assert_eq!(snapshots_due(0.0, 0.05), 1);
        assert_eq!(snapshots_due(0.049, 0.05), 1);
        // Three steps of 0.1 come to a little more or less.
        assert_eq!(snapshots_due(0.1 + 0.2, 0.1), 4);
        assert_eq!(snapshots_due(0.3 - 1e-12, 0.1), 4);
        assert_eq!(snapshots_due(1.0, 1e-300), u64::MAX);
        assert_eq!(snapshots_due(1.0, f64::MIN_POSITIVE), u64::MAX);
    }
}
