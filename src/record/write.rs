//! Writes a component's life to an MCAP file: what drove it, what came out, what was asked, and pictures.
//!
//! The recorder watches; it never changes the component, and a disk that is full does not stop the simulation unless
//! the scene says that its log is required.

use super::channels::{Channel, Channels};
use super::error::{Failure, RecordError};
use super::file::{LogFile, Pace, Writing};
use super::options::{Finished, RecordOptions};
use super::place::Place;
use super::preamble::{has_state, owned, write_preamble};
use super::sink::Sink;
use crate::component::{Component, StepReport, ValueReference};
use crate::wire::convert::{self, nanoseconds, timestamp};
use crate::wire::foxglove::{Log, LogLevel, SceneUpdate};
use crate::wire::messages::{AppliedEvent, Command};
use crate::wire::{Moment, Pending, keys, picture};
use prost::Message;
use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// Records one component. Made by [`Recorder::create`], ended by [`Recorder::finish`].
pub struct Recorder {
    pub(super) file: LogFile,
    channels: Channels,
    options: RecordOptions,
    pub(super) place: Option<Place>,
    pending: Pending,
    /// Checksums of the states that were saved since this file began.
    saved: HashSet<[u8; 32]>,
    /// How often the component was brought back to one of them.
    restored: u64,
    /// Time from which snapshots are counted [s].
    first_time: f64,
    /// Time at which this file begins [s].
    began: f64,
    /// Snapshots that were due so far.
    snapshots: u64,
    trouble: Option<RecordError>,
    earlier: Earlier,
    last: Last,
}

/// What the files before this one lack.
#[derive(Clone, Default)]
struct Earlier {
    failure: Option<Failure>,
    dropped: u64,
}

/// Where the component was when its outputs were last written: a file that ends because the component jumped must not
/// tell where it jumped to.
#[derive(Clone, Copy, Default)]
struct Last {
    time: f64,
    communication_steps: u64,
    steps: u64,
}

impl Recorder {
    /// Starts `path` (written as `path.part` until it is finished): metadata of the run, the scene's text and, if the
    /// component has been initialised already, its state, so that the file is whole without any other.
    ///
    /// # Errors
    /// [`RecordError::Exists`], [`RecordError::Create`], [`RecordError::Instance`], [`RecordError::Component`];
    /// [`RecordError::Required`] if the first bytes cannot be written.
    pub fn create(
        path: &Path,
        component: &Component,
        options: RecordOptions,
    ) -> Result<Self, RecordError> {
        let place = Place {
            rotates: options.rotates(),
            ..Place::alone(path)
        };
        // Before the file is made, so that a bad name leaves none behind.
        keys::base(keys::ROOT, &options.instance)?;
        let sink = Box::new(place.create()?);
        Self::start(sink, Some(place), component, options, None)
    }

    /// As [`Recorder::create`], as the file that follows after `jumps` resets of a component whose files before it have
    /// ended: `run-1-0000.mcap`.
    ///
    /// # Errors
    /// As [`Recorder::create`].
    pub fn create_after(
        path: &Path,
        jumps: u32,
        component: &Component,
        options: RecordOptions,
    ) -> Result<Self, RecordError> {
        let place = Place {
            rotates: options.rotates(),
            epoch: jumps,
            ..Place::alone(path)
        };
        keys::base(keys::ROOT, &options.instance)?;
        let sink = Box::new(place.create()?);
        Self::start(sink, Some(place), component, options, None)
    }

    pub(super) fn start(
        sink: Box<dyn Sink>,
        place: Option<Place>,
        component: &Component,
        options: RecordOptions,
        numbers: Option<BTreeMap<String, u64>>,
    ) -> Result<Self, RecordError> {
        let base = keys::base(keys::ROOT, &options.instance)?;
        let pace = if options.deterministic {
            Pace::Caller
        } else {
            Pace::WallClock
        };
        let writing = Writing {
            pace,
            sync_every_flush: options.sync_every_flush,
        };
        let mut file = LogFile::start(sink, place.as_ref().map(Place::part), writing);
        write_preamble(&mut file, component, &options, place.as_ref())?;
        let channels = Channels::add(&mut file, component, &base, numbers.unwrap_or_default());
        let mut recorder = Self {
            file,
            channels,
            options,
            place,
            pending: Pending::default(),
            saved: HashSet::new(),
            restored: 0,
            first_time: component.time(),
            began: component.time(),
            snapshots: 0,
            trouble: None,
            earlier: Earlier::default(),
            last: Last::default(),
        };
        recorder.remember(component);
        // Before initialisation parameters may still move walls: who runs the log again has the scene's own then.
        let started = has_state(component);
        let scene = match started {
            true => component.scene(),
            false => component.base_scene(),
        };
        recorder.scene(
            &picture::scene_update(scene, component.time()),
            component.time(),
        );
        if started {
            recorder.applied(
                component,
                AppliedEvent::Restore,
                (component.time(), f64::NAN),
                "",
            );
            recorder.outputs(component, None)?;
        }
        recorder.file.flush();
        recorder.check()?;
        Ok(recorder)
    }

    /// The component was initialised from `start`, with `stop` if one was set [s], by `source`. Inputs recorded before
    /// belong to it.
    ///
    /// # Errors
    /// [`RecordError::Required`], [`RecordError::Component`].
    pub fn record_initialization(
        &mut self,
        component: &Component,
        start: f64,
        stop: Option<f64>,
        source: &str,
    ) -> Result<(), RecordError> {
        self.first_time = start;
        self.began = start;
        self.snapshots = 0;
        let times = (start, stop.unwrap_or(f64::NAN));
        self.applied(component, AppliedEvent::Initialize, times, source);
        let drawn = |scene| picture::scene_update(scene, start);
        let now = drawn(component.scene());
        if now != drawn(component.base_scene()) {
            self.scene(&now, start);
        }
        self.outputs(component, None)?;
        self.end_of_step()
    }

    /// Variables were set by `source` and accepted: they take effect in the step that follows. Flat values as in
    /// [`Component::set`].
    pub fn record_inputs(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        values: &[f64],
        source: &str,
    ) {
        self.pending.set(component, references, values, source);
    }

    /// Inputs were given slopes by `source` and accepted, one each, as in [`Component::set_input_derivatives`].
    pub fn record_slopes(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        slopes: &[f64],
        source: &str,
    ) {
        self.pending.slopes(component, references, slopes, source);
    }

    /// Something was done inside the step that is running.
    pub fn record_moment(&mut self, component: &Component, moment: &Moment, source: &str) {
        self.pending.moment(component, moment, source);
    }

    /// The step that was running did not come to its end: what was done inside it is forgotten, inputs set before it
    /// still count.
    pub fn record_failed_step(&mut self) {
        self.pending.forget_moments();
    }

    /// The state was saved by `source`, and the component may be brought back to it. `state` is its checksum
    /// ([`saved_checksum`](crate::component::saved_checksum)); the state itself is not written: who runs the log again
    /// comes by it.
    ///
    /// # Errors
    /// [`RecordError::Required`].
    pub fn record_save(
        &mut self,
        component: &Component,
        state: &[u8; 32],
        source: &str,
    ) -> Result<(), RecordError> {
        self.saved.insert(*state);
        let times = (component.time(), f64::NAN);
        self.stated(component, AppliedEvent::Save, times, state, source);
        self.check()
    }

    /// The component was brought back to the state with this checksum. If it was saved since this file began, the file
    /// goes on; otherwise it is a [`Recorder::record_jump`].
    ///
    /// # Errors
    /// As [`Recorder::record_jump`].
    pub fn record_restore(
        &mut self,
        component: &Component,
        state: &[u8; 32],
        source: &str,
    ) -> Result<(), RecordError> {
        if !self.saved.contains(state) || !has_state(component) {
            return self.record_jump(component, AppliedEvent::Restore, source);
        }
        if !self.pending.is_empty() {
            self.leave_pending();
        }
        self.restored += 1;
        let times = (component.time(), f64::NAN);
        self.stated(component, AppliedEvent::Restore, times, state, source);
        self.outputs(component, None)?;
        self.end_of_step()
    }

    /// A step was done from `t` over `h` [s] by `source`: writes the inputs it used, all outputs, the figures of the
    /// solver with the account of mass and, when due, a snapshot of the particles.
    ///
    /// # Errors
    /// [`RecordError::Required`], [`RecordError::Component`].
    pub fn record_step(
        &mut self,
        component: &Component,
        report: &StepReport,
        t: f64,
        h: f64,
        source: &str,
    ) -> Result<(), RecordError> {
        self.applied(component, AppliedEvent::Step, (t, h), source);
        self.outputs(component, Some(report))?;
        self.end_of_step()?;
        self.rotate(component)
    }

    /// Goes on in the next file (`run-0-0001.mcap`) if it is time. That file starts with the state as it is now and
    /// counts messages on, so that a gap between files can be seen.
    fn rotate(&mut self, component: &Component) -> Result<(), RecordError> {
        let RecordOptions {
            rotate_every,
            rotate_bytes,
            ..
        } = self.options;
        // A billionth is allowed for, as in `particles_due`.
        let late =
            rotate_every > 0.0 && component.time() - self.began >= rotate_every * (1.0 - 1e-9);
        let large = rotate_bytes > 0 && self.file.bytes() >= rotate_bytes;
        let Some(place) = self.place.as_ref().filter(|_| late || large) else {
            return Ok(());
        };
        if self.file.failure().is_some() {
            return Ok(());
        }
        match self.follow(place.next(), component, "rotated") {
            Ok(mut following) => {
                following.first_time = self.first_time;
                following.snapshots = self.snapshots;
                self.go_on(following, |before| before.finish(component, "rotated"))
            }
            Err(error) => self.stay(error),
        }
    }

    /// Ends this file by `end` and goes on in `following`, which remembers what this one lacks.
    fn go_on(
        &mut self,
        mut following: Self,
        end: impl FnOnce(Self) -> Result<Finished, RecordError>,
    ) -> Result<(), RecordError> {
        following.trouble = self.trouble.take();
        following.earlier = self.earlier.clone();
        match end(std::mem::replace(self, following)) {
            Ok(finished) => {
                self.earlier = Earlier {
                    failure: finished.failure,
                    dropped: finished.dropped,
                };
                Ok(())
            }
            Err(error) if self.options.required => {
                if let RecordError::Required(failure) = &error {
                    self.earlier.failure.get_or_insert(failure.clone());
                }
                Err(error)
            }
            // The file is whole and only its name is not: told at the end.
            Err(error) => {
                self.keep(Err(error));
                Ok(())
            }
        }
    }

    /// No file can follow: a log that is not required ends here.
    fn stay(&mut self, error: RecordError) -> Result<(), RecordError> {
        if self.options.required {
            return Err(error);
        }
        self.file.give_up(&error.to_string());
        Ok(())
    }

    /// The file that takes over from this one.
    fn follow(
        &self,
        next: Place,
        component: &Component,
        reason: &str,
    ) -> Result<Self, RecordError> {
        let options = RecordOptions {
            reason: reason.to_owned(),
            ..self.options.clone()
        };
        let sink = Box::new(next.create()?);
        let numbers = (reason == "rotated").then(|| self.channels.numbers());
        Self::start(sink, Some(next), component, options, numbers)
    }

    /// A call from outside, or the reply to one.
    ///
    /// # Errors
    /// [`RecordError::Required`].
    pub fn record_command(&mut self, command: &Command) -> Result<(), RecordError> {
        let channel = self.channels.command(&mut self.file, command);
        let deterministic = self.options.deterministic;
        let data = command.encode_to_vec();
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

    /// The component was reset or restored: ends this file and starts the next (`run-1-0000.mcap`), which carries the
    /// state it starts from.
    ///
    /// # Errors
    /// As [`Recorder::create`] and [`Recorder::finish`].
    pub fn record_jump(
        &mut self,
        component: &Component,
        event: AppliedEvent,
        source: &str,
    ) -> Result<(), RecordError> {
        let Some(place) = self.place.clone() else {
            self.applied(component, event, (component.time(), f64::NAN), source);
            return self.end_of_step();
        };
        let reason = match event {
            AppliedEvent::Reset => "reset",
            AppliedEvent::Restore => "restored",
            _ => "start",
        };
        match self.follow(place.jumped(), component, reason) {
            Ok(following) => self.go_on(following, |before| before.close(BTreeMap::new(), reason)),
            Err(error) => self.stay(error),
        }
    }

    /// The first failed write, if there was one; what came after it is not in its file.
    #[must_use]
    pub fn failure(&self) -> Option<Failure> {
        let earlier = self.earlier.failure.clone();
        earlier.or_else(|| self.file.failure())
    }

    /// The first error of a call that came through [`Observer`](crate::wire::Observer), which has no answer to give.
    pub fn take_trouble(&mut self) -> Option<RecordError> {
        self.trouble.take()
    }

    pub(super) fn keep(&mut self, written: Result<(), RecordError>) {
        if let Err(error) = written {
            self.trouble.get_or_insert(error);
        }
    }

    /// Messages that are not in the log, in this file or those before it, because a write failed.
    #[must_use]
    pub fn dropped(&self) -> u64 {
        self.earlier.dropped + self.file.counts().dropped
    }

    /// Writes the end (reason, steps, hash of the state, drops) and the summary, and gives the file its final name.
    /// A log that failed before keeps the name that ends in `.part`.
    ///
    /// # Errors
    /// [`RecordError::Required`] if the log is required and not whole, [`RecordError::Rename`]; what
    /// [`Recorder::take_trouble`] would give.
    pub fn finish(mut self, component: &Component, reason: &str) -> Result<Finished, RecordError> {
        self.remember(component);
        let state = [
            ("mode".to_owned(), format!("{:?}", component.mode())),
            ("state_hash".to_owned(), component.state_hash()),
        ];
        let trouble = self.trouble.take();
        let finished = self.close(state.into(), reason)?;
        trouble.map_or(Ok(finished), Err)
    }

    /// Ends the file of a component that has been reset, or gone to a state that is not initialised: it does not tell
    /// where the component went.
    ///
    /// # Errors
    /// As [`Recorder::finish`].
    pub fn end(mut self, reason: &str) -> Result<Finished, RecordError> {
        let trouble = self.trouble.take();
        let finished = self.close(BTreeMap::new(), reason)?;
        trouble.map_or(Ok(finished), Err)
    }

    /// Removes the file: nothing happened that it could tell.
    ///
    /// # Errors
    /// [`RecordError::Create`] with what the system said.
    pub fn discard(mut self) -> Result<(), RecordError> {
        self.file.give_up("discarded");
        match &self.place {
            Some(place) => {
                let path = place.part();
                std::fs::remove_file(&path).map_err(|source| RecordError::Create { path, source })
            }
            None => Ok(()),
        }
    }

    /// How many files of other epochs come before the one that follows after a reset; for [`Recorder::create_after`].
    #[must_use]
    pub fn next_epoch(&self) -> u32 {
        self.place.as_ref().map_or(0, |place| place.epoch + 1)
    }

    /// Whether the scene, or whoever made this log, requires it.
    #[must_use]
    pub fn is_required(&self) -> bool {
        self.options.required
    }

    fn close(
        mut self,
        state: BTreeMap<String, String>,
        reason: &str,
    ) -> Result<Finished, RecordError> {
        let last = self.last;
        if !self.pending.is_empty() {
            self.leave_pending();
        }
        let mut end = owned([
            ("reason", reason.to_owned()),
            ("time", last.time.to_string()),
            ("time_bits", format!("{:016x}", last.time.to_bits())),
            ("communication_steps", last.communication_steps.to_string()),
            ("steps", last.steps.to_string()),
            ("dropped", self.file.counts().dropped.to_string()),
            ("restored", self.restored.to_string()),
        ]);
        end.extend(state);
        self.file.metadata("end", end);
        let (counts, failure) = self.file.finish();
        let first = self.earlier.failure.or_else(|| failure.clone());
        if let (Some(first), true) = (&first, self.options.required) {
            return Err(RecordError::Required(first.clone()));
        }
        let path = match (&self.place, &failure) {
            (Some(place), None) => Some(place.rename()?),
            (Some(place), Some(_)) => Some(place.part()),
            (None, _) => None,
        };
        Ok(Finished {
            path,
            messages: counts.written,
            dropped: self.earlier.dropped + counts.dropped,
            failure: first,
        })
    }

    fn remember(&mut self, component: &Component) {
        let figures = component.statistics();
        self.last = Last {
            time: component.time(),
            communication_steps: figures.communication_steps,
            steps: figures.steps,
        };
    }

    fn scene(&mut self, update: &SceneUpdate, time: f64) {
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

    fn applied(
        &mut self,
        component: &Component,
        event: AppliedEvent,
        (t, h): (f64, f64),
        source: &str,
    ) {
        let step = match event {
            AppliedEvent::Initialize => 0,
            _ => component.statistics().communication_steps,
        };
        self.write_applied(event, step, (t, h), &[], source);
    }

    /// As `applied`, of a call about a saved state.
    fn stated(
        &mut self,
        component: &Component,
        event: AppliedEvent,
        times: (f64, f64),
        state: &[u8],
        source: &str,
    ) {
        let step = component.statistics().communication_steps;
        self.write_applied(event, step, times, state, source);
    }

    /// Inputs that were set after the last step, and that no step will use.
    fn leave_pending(&mut self) {
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

    /// Outputs, figures, frames of the gates and, when due, particles.
    fn outputs(
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
        for frame in convert::gate_frames(component)? {
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
        // A billionth of the interval is allowed for, as communication points are sums of rounded steps.
        let due = ((time - self.first_time) / every + 1e-9).floor() as u64 + 1;
        let come = due > self.snapshots;
        self.snapshots = due;
        come
    }

    fn end_of_step(&mut self) -> Result<(), RecordError> {
        if self.options.deterministic {
            self.file.flush();
        }
        self.check()
    }

    fn check(&self) -> Result<(), RecordError> {
        match self.file.failure() {
            Some(failure) if self.options.required => Err(RecordError::Required(failure)),
            _ => Ok(()),
        }
    }
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
