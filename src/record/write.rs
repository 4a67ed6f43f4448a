//! Writes a component's life to an MCAP file: what drove it, what came out, what was asked, and pictures.
//!
//! The recorder watches; it never changes the component, and a disk that is full does not stop the simulation unless
//! the scene says that its log is required. `segments` ends files and begins the next, `messages` puts what is told into words.

mod messages;
mod segments;

use super::channels::Channels;
use super::error::{Failure, RecordError};
use super::file::{LogFile, Pace, Writing};
use super::options::RecordOptions;
use super::place::Place;
use super::preamble::{has_state, write_preamble};
use super::sink::Sink;
use crate::component::{Component, StepReport, ValueReference};
use crate::wire::messages::AppliedEvent;
use crate::wire::{Moment, Pending, keys, picture};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

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
    /// The file is closed already, under this name: no other could follow it.
    ended: Option<Option<PathBuf>>,
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
    /// [`RecordError::Exists`], [`RecordError::Folder`], [`RecordError::Create`], [`RecordError::Instance`], [`RecordError::Component`];
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
        Self::open(place, component, options, None)
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
        Self::open(place, component, options, None)
    }

    /// Begins the file at `place`. One that cannot be begun leaves nothing there, so that the same name can be given again.
    fn open(
        place: Place,
        component: &Component,
        options: RecordOptions,
        numbers: Option<BTreeMap<String, u64>>,
    ) -> Result<Self, RecordError> {
        let sink = Box::new(place.create()?);
        let part = place.part();
        Self::start(sink, Some(place), component, options, numbers).inspect_err(|_| {
            // What counts is why it could not begin.
            let _ = std::fs::remove_file(part);
        })
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
        let begins = options.begins.unwrap_or(component.time());
        let channels = Channels::add(&mut file, component, &base, numbers.unwrap_or_default());
        let mut recorder = Self {
            file,
            channels,
            options,
            place,
            pending: Pending::default(),
            saved: HashSet::new(),
            restored: 0,
            first_time: begins,
            began: begins,
            snapshots: 0,
            trouble: None,
            earlier: Earlier::default(),
            ended: None,
            last: Last::default(),
        };
        recorder.remember(component);
        recorder.last.time = begins;
        // Before initialisation parameters may still move walls: who runs the log again has the scene's own then.
        let started = has_state(component);
        let scene = match started {
            true => component.scene(),
            false => component.base_scene(),
        };
        recorder.scene(&picture::scene_update(scene, begins), begins);
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
    /// comes by it. A state that a failed step left is not noted, since nobody comes by that; going back to it is a jump.
    ///
    /// # Errors
    /// [`RecordError::Required`].
    pub fn record_save(
        &mut self,
        component: &Component,
        state: &[u8; 32],
        source: &str,
    ) -> Result<(), RecordError> {
        if component.step_failed() {
            return self.check();
        }
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

    /// Whether the scene, or whoever made this log, requires it.
    #[must_use]
    pub fn is_required(&self) -> bool {
        self.options.required
    }

    fn remember(&mut self, component: &Component) {
        self.last = Last {
            time: component.time(),
            communication_steps: component.communication_steps(),
            steps: component.steps(),
        };
    }
}
