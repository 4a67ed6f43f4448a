//! The files of one log: where one ends and the next begins, and what the next must know of those before it.

use super::{Earlier, Recorder};
use crate::component::Component;
use crate::record::error::{Failure, RecordError};
use crate::record::options::{Finished, RecordOptions};
use crate::record::place::Place;
use crate::record::preamble::{in_use, owned};
use crate::wire::messages::AppliedEvent;
use std::collections::BTreeMap;

impl Recorder {
    /// Goes on in the next file (`run-0-0001.mcap`) if it is time. That file starts with the state as it is now and
    /// counts messages on, so that a gap between files can be seen.
    pub(super) fn rotate(&mut self, component: &Component) -> Result<(), RecordError> {
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
        let broke_off = self.file.failure().is_some();
        if self.ended.is_some() || broke_off && self.options.required {
            return Ok(());
        }
        match self.follow(place.next(), component, "rotated") {
            // There is still no room: the next one is tried when it is time for it.
            Ok(following) if broke_off && following.failure().is_some() => {
                self.began = component.time();
                following.discard()
            }
            Ok(mut following) => {
                following.first_time = self.first_time;
                following.snapshots = self.snapshots;
                self.go_on(following, |before| before.finish(component, "rotated"))
            }
            Err(_) if broke_off => {
                self.began = component.time();
                Ok(())
            }
            Err(error) => {
                let state = self.whereabouts(component);
                self.stop(error, state, "rotated")
            }
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

    /// No file can follow: this one ends as if one did, and the log with it. The disk may be fine, so that nothing of
    /// it is lost.
    fn stop(
        &mut self,
        error: RecordError,
        state: BTreeMap<String, String>,
        reason: &str,
    ) -> Result<(), RecordError> {
        if self.ended.is_none() {
            let ended = self.end_file(state, reason);
            self.keep(ended);
        }
        self.earlier.failure.get_or_insert_with(|| Failure {
            time: self.last.time,
            written: Some(self.last.time),
            cause: error.to_string(),
            file: None,
        });
        if self.options.required {
            return Err(error);
        }
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
            begins: None,
            ..self.options.clone()
        };
        let numbers = (reason == "rotated").then(|| self.channels.numbers());
        Self::open(next, component, options, numbers)
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
            Err(error) => self.stop(error, BTreeMap::new(), reason),
        }
    }

    /// Writes the end (reason, steps, hash of the state unless a failed step left it, drops) and the summary, and gives the file its final name.
    /// A log that failed before keeps the name that ends in `.part`.
    ///
    /// # Errors
    /// [`RecordError::Required`] if the log is required and not whole, [`RecordError::Rename`]; what
    /// [`Recorder::take_trouble`] would give.
    pub fn finish(mut self, component: &Component, reason: &str) -> Result<Finished, RecordError> {
        let state = self.whereabouts(component);
        let trouble = self.trouble.take();
        let finished = self.close(state, reason)?;
        trouble.map_or(Ok(finished), Err)
    }

    /// Where the component is as its file ends.
    fn whereabouts(&mut self, component: &Component) -> BTreeMap<String, String> {
        self.remember(component);
        let mode = ("mode".to_owned(), format!("{:?}", component.mode()));
        let mut state = BTreeMap::from([mode]);
        state.extend(in_use(component));
        if !component.step_failed() {
            state.insert("state_hash".to_owned(), component.state_hash());
        }
        state
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
    /// [`RecordError::Remove`] with what the system said.
    pub fn discard(mut self) -> Result<(), RecordError> {
        self.file.give_up("discarded");
        match &self.place {
            Some(place) => {
                let path = place.part();
                std::fs::remove_file(&path).map_err(|source| RecordError::Remove { path, source })
            }
            None => Ok(()),
        }
    }

    /// How many files of other epochs come before the one that follows after a reset; for [`Recorder::create_after`].
    #[must_use]
    pub fn next_epoch(&self) -> u32 {
        self.place.as_ref().map_or(0, |place| place.epoch + 1)
    }

    fn close(
        mut self,
        state: BTreeMap<String, String>,
        reason: &str,
    ) -> Result<Finished, RecordError> {
        if self.ended.is_none() {
            self.end_file(state, reason)?;
        }
        let failure = self.failure();
        if let (Some(failure), true) = (&failure, self.options.required) {
            return Err(RecordError::Required(failure.clone()));
        }
        let counts = self.file.counts();
        Ok(Finished {
            path: self.ended.flatten(),
            messages: counts.written,
            dropped: self.earlier.dropped + counts.dropped,
            failure,
        })
    }

    /// Writes the end and gives the file its name; what comes later is dropped.
    fn end_file(
        &mut self,
        state: BTreeMap<String, String>,
        reason: &str,
    ) -> Result<(), RecordError> {
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
        let (_, failure) = self.file.finish();
        // A required log that is not whole keeps the name that says so.
        let lacks = failure.is_some() || self.options.required && self.earlier.failure.is_some();
        self.ended = Some(self.place.as_ref().map(Place::part));
        if let (Some(place), false) = (&self.place, lacks) {
            self.ended = Some(Some(place.rename()?));
        }
        Ok(())
    }
}
