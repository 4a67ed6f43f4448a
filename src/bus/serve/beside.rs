//! A component that somebody else steps (an FMU's importer, a C program) on the network: it is published and takes
//! set-points, but time stays with its owner, and requests that would move it are refused.
//!
//! Publishing runs on a thread of its own, as for a server; set-points wait in the same queue, the last of each variable,
//! until the owner's next step, which takes them.

use super::closing::{Leaving, OpenSession};
use super::desk::{Aside, Desk, Entrances};
use super::press::{Press, QUEUE_OF_GAUGES};
use super::replies::{ended, send_replies};
use super::{ServeOptions, WAITING_REPLIES, session, spawn};
use crate::bus::Protocol;
use crate::bus::advice::Advice;
use crate::bus::error::BusError;
use crate::bus::fields::Given;
use crate::bus::keys::Keys;
use crate::bus::notes::{Notes, WAITING_NOTES, tell_refused, tell_taken, tell_unlogged};
use crate::bus::publish::{LastValues, Publisher};
use crate::bus::queue::queue;
use crate::bus::reach::Reach;
use crate::bus::refusal::{Code, Refusal};
use crate::bus::set_point::SetPoint;
use crate::bus::status::{Busy, Shared, Status, lock};
use crate::bus::tasks::{Taker, Task, tasks};
use crate::bus::values::{self, Assignment, Settable};
use crate::component::{Component, StepReport, ValueReference};
use crate::wire::foxglove::LogLevel;
use crate::wire::messages::{AppliedEvent, Command};
use crate::wire::{Both, Moment, Observer};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::sync_channel;
use std::thread::JoinHandle;

/// A component on the network beside its owner.
pub struct Beside {
    session: OpenSession,
    reach: Reach,
    instance: String,
    publisher: Publisher,
    shared: Arc<Shared>,
    aside: Arc<Aside>,
    tasks: Taker,
    notes: Notes,
    entrances: Entrances,
    threads: Vec<JoinHandle<()>>,
    epoch: u64,
    /// Simulated time that `status` tells [s].
    time: f64,
    /// The last set-point of each variable, as it was taken (clamped, it may be), until its owner sets it.
    held: BTreeMap<ValueReference, SetPoint>,
}

impl Beside {
    /// Opens the session and lets others in. Nothing is published before the component is told to be initialised or
    /// to have jumped.
    ///
    /// # Errors
    /// As [`Server::open`](super::Server::open).
    pub fn open(component: &Component, options: &ServeOptions) -> Result<Self, BusError> {
        let options = ServeOptions {
            advice: Advice::Configuration,
            ..options.with_metadata()?
        };
        let keys = Keys::new(&options.instance)?;
        let (session, reach) = session::open(&options, Some(&keys))?;
        let (batches, publications) = queue();
        let (jobs, replies) = sync_channel(WAITING_REPLIES);
        let (task_queue, tasks) = tasks(Settable::of(component.variables()));
        let (note_queue, notes) = sync_channel(WAITING_NOTES);
        let last = Arc::new(LastValues::default());
        let particles_wanted = Arc::new(AtomicBool::new(false));
        let shared = Arc::new(Shared::new(Status::of(component, 0, None)));
        let publisher = Publisher::new(
            keys.base(),
            component,
            batches,
            last.clone(),
            particles_wanted.clone(),
            shared.clone(),
        );
        let press = Press::new(session.clone(), &keys, particles_wanted, QUEUE_OF_GAUGES)?;
        let threads = vec![
            spawn("sandgate-publish", move || press.run(publications))?,
            spawn("sandgate-reply", move || send_replies(&replies, &last))?,
        ];
        let aside = Arc::new(Aside {
            description: Protocol::new(keys.base(), None).description(component),
            values: Default::default(),
            elements: values::elements(component.variables()),
        });
        let desk = Desk {
            keys,
            shared: shared.clone(),
            tasks: task_queue,
            notes: note_queue,
            jobs,
            aside: Some(aside.clone()),
        };
        let mut beside = Self {
            entrances: Entrances::open(&session, desk)?,
            session,
            reach,
            instance: options.instance,
            publisher,
            shared,
            aside,
            tasks,
            notes: Notes(notes),
            threads,
            epoch: 0,
            time: component.time(),
            held: BTreeMap::new(),
        };
        beside.update(component);
        Ok(beside)
    }

    /// Where clients find it.
    #[must_use]
    pub fn reach(&self) -> &Reach {
        &self.reach
    }

    /// Its name in keys.
    #[must_use]
    pub fn instance(&self) -> &str {
        &self.instance
    }

    /// Before a step: sets what set-points ask for. The owner wins: of a variable that it has set since the last step
    /// (`owned`) a set-point that came meanwhile is refused, and an earlier one holds no longer. Any other holds from
    /// this step on, also when the owner goes back to an earlier state. `other` hears what was set, and what was asked
    /// and answered since the last call.
    pub fn apply(
        &mut self,
        component: &mut Component,
        owned: &BTreeSet<ValueReference>,
        other: &mut dyn Observer,
    ) {
        self.tell_notes(other);
        self.held.retain(|reference, _| !owned.contains(reference));
        for task in self.tasks.take_all() {
            let Task::SetPoint(point) = task else {
                continue; // The desk hands on nothing else.
            };
            match self.set(component, &point, owned, other) {
                Ok((reference, flat)) => {
                    tell_taken(self.time, &point, other);
                    let given = Given {
                        flat,
                        ..point.given
                    };
                    self.held.insert(reference, SetPoint { given, ..point });
                }
                Err(refusal) => self.refuse(&point, &refusal, other),
            }
        }
        for point in self.held.values().cloned().collect::<Vec<_>>() {
            if let Err(refusal) = self.hold(component, &point, other) {
                self.refuse(&point, &refusal, other);
            }
        }
    }

    /// Its owner's step begins: `status` tells so until it is done or has failed.
    pub fn tell_step(&self, interface: &str) {
        self.shared.set_busy(Some(Busy {
            verb: "step",
            client: interface.to_owned(),
            req: String::new(),
        }));
    }

    /// Gives the variable and the values that it holds then.
    fn set(
        &mut self,
        component: &mut Component,
        point: &SetPoint,
        owned: &BTreeSet<ValueReference>,
        other: &mut dyn Observer,
    ) -> Result<(ValueReference, Vec<f64>), Refusal> {
        let inputs = [(point.variable.clone(), point.given.clone())];
        let assignment = Assignment::resolve(component.variables(), &inputs)?;
        let [reference] = assignment.references[..] else {
            return Err(Refusal::new(
                Code::Internal,
                "one variable is one reference",
            ));
        };
        if owned.contains(&reference) {
            let message = format!("{}: its owner sets it", point.variable);
            return Err(Refusal::new(Code::NotOwner, message));
        }
        component.set(&[reference], &assignment.values)?;
        let source = point.source();
        Both(other, &mut self.publisher).on_input(
            component,
            &[reference],
            &assignment.values,
            source,
        );
        self.tell_clamped(component, other);
        Ok((reference, assignment.present(component)?.values))
    }

    /// Sets it again if the component holds another value, as after a roll-back.
    fn hold(
        &mut self,
        component: &mut Component,
        point: &SetPoint,
        other: &mut dyn Observer,
    ) -> Result<(), Refusal> {
        let inputs = [(point.variable.clone(), point.given.clone())];
        let assignment = Assignment::resolve(component.variables(), &inputs)?;
        if assignment.present(component)?.values == assignment.values {
            return Ok(());
        }
        self.set(component, point, &BTreeSet::new(), other)
            .map(drop)
    }

    fn tell_clamped(&mut self, component: &mut Component, other: &mut dyn Observer) {
        for note in component.take_notes() {
            let mut both = Both(other, &mut self.publisher);
            both.on_log(component.time(), LogLevel::Warning, "bus", &note);
        }
    }

    fn refuse(&mut self, point: &SetPoint, refusal: &Refusal, other: &mut dyn Observer) {
        self.shared.refused_set_points.fetch_add(1, Relaxed);
        let mut both = Both(other, &mut self.publisher);
        tell_refused(self.time, point, refusal, &mut both);
    }

    /// What was asked and answered, or refused, since the last call: for `other`, which may be a log. A step may last
    /// longer than the log may lag behind, so that this is called between internal steps, too.
    pub fn tell_notes(&mut self, other: &mut dyn Observer) {
        let mut both = Both(other, &mut self.publisher);
        self.notes.tell(self.time, &mut both);
    }

    /// What `status` says of the log.
    pub fn tell_trouble(&self, trouble: Option<String>) {
        self.shared.set_log_failure(trouble);
    }

    /// Status and values are those of now.
    fn update(&mut self, component: &Component) {
        self.time = component.time();
        self.shared.set_busy(None);
        self.shared.update(Status::of(component, self.epoch, None));
        match values::read(component, &values::all_rows(component.variables())) {
            Ok(values) => *lock(&self.aside.values) = values,
            Err(error) => self.publisher.tell_unread(self.time, &error),
        }
    }

    /// Nobody gets in any more, what waits is published, threads end; the session is to be closed. `other` hears what was
    /// asked since the last call; set-points that still wait are refused.
    pub fn leave(mut self, other: &mut dyn Observer) -> Leaving {
        drop(self.entrances);
        let mut both = Both(other, &mut self.publisher);
        for task in self.tasks.take_all() {
            if let Task::SetPoint(point) = task {
                tell_refused(self.time, &point, &ended(), &mut both);
            }
        }
        self.notes.tell(self.time, &mut both);
        let unlogged = self.shared.unlogged_calls.load(Relaxed);
        tell_unlogged(self.time, unlogged, &mut both);
        drop(self.publisher);
        for thread in self.threads {
            // A panic there was reported by the thread itself, and who waited was answered.
            let _ = thread.join();
        }
        Leaving(self.session)
    }
}

impl Observer for Beside {
    fn on_initialize(&mut self, c: &Component, start: f64, stop: Option<f64>, source: &str) {
        self.publisher.on_initialize(c, start, stop, source);
        self.update(c);
    }

    fn on_input(&mut self, c: &Component, refs: &[ValueReference], values: &[f64], source: &str) {
        self.shared.set_saturates(c.saturates_inputs());
        self.publisher.on_input(c, refs, values, source);
    }

    fn on_slopes(&mut self, c: &Component, inputs: &[ValueReference], slopes: &[f64], who: &str) {
        self.publisher.on_slopes(c, inputs, slopes, who);
    }

    fn on_moment(&mut self, component: &Component, moment: &Moment, source: &str) {
        self.publisher.on_moment(component, moment, source);
    }

    fn on_failed_step(&mut self) {
        self.shared.set_busy(None);
        self.publisher.on_failed_step();
    }

    fn on_step(&mut self, c: &Component, report: &StepReport, t: f64, h: f64, source: &str) {
        self.publisher.on_step(c, report, t, h, source);
        self.update(c);
    }

    fn on_command(&mut self, _: &Command) {}

    fn on_reply(&mut self, _: &Command) {}

    fn on_jump(&mut self, component: &Component, event: AppliedEvent, source: &str) {
        self.epoch += 1;
        self.publisher.on_jump(component, event, source);
        self.update(component);
    }

    fn on_log(&mut self, time: f64, level: LogLevel, name: &str, message: &str) {
        self.publisher.on_log(time, level, name, message);
    }
}
