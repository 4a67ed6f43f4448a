//! Requests on a component: [`Request`] in, [`Reply`] out. Pure: no network, no thread, no clock but the one that
//! measures `wall_us`.
//!
//! What the wire promises is kept here: a request sent twice is carried out once; `expect_step` and `t_ns` that do not
//! match are a conflict; inputs of one request apply all or none; a panic becomes a reply. The rules of the component
//! (which call is allowed when, ranges) are the component's own.

mod drive;
mod step;
mod verbs;

use super::answered::{Answered, Earlier};
use super::notes::Notes;
use super::refusal::{Code, Refusal};
use super::reply::Reply;
use super::request::Request;
use super::set_point::SetPoint;
use super::status::Status;
use super::values::Assignment;
use super::verb::Verb;
use crate::component::{self, Component, Mode, step_end};
use crate::math::panic_text;
use crate::wire::Observer;
use crate::wire::messages::AppliedEvent;
use drive::{advance, assign};
use serde_json::{Map, Value};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The state of the protocol on one component.
#[derive(Debug)]
pub struct Protocol {
    base: String,
    epoch: u64,
    free_running: Option<f64>,
    answered: Answered<Reply>,
    broken: bool,
    /// Why nothing goes on any more, if so.
    over: Option<String>,
    notes: Option<Notes>,
}

/// Fields of a reply.
pub(super) type Fields = Map<String, Value>;

impl Protocol {
    /// A protocol for the component at `base` (`sandgate/v1/INSTANCE`). `free_running`: simulated over wall time, or
    /// none to wait for `step`.
    #[must_use]
    pub fn new(base: &str, free_running: Option<f64>) -> Self {
        Self {
            base: base.to_owned(),
            epoch: 0,
            free_running,
            answered: Answered::default(),
            broken: false,
            over: None,
            notes: None,
        }
    }

    /// With notes of what is answered elsewhere, for the log: they are told between internal steps, too, since a step may
    /// last longer than the log may lag behind.
    pub(super) fn with_notes(self, notes: Notes) -> Self {
        Self {
            notes: Some(notes),
            ..self
        }
    }

    /// Tells what was answered elsewhere since the last call.
    pub(super) fn tell_notes(&self, component: &Component, observer: &mut dyn Observer) {
        if let Some(notes) = &self.notes {
            notes.tell(component.time(), observer);
        }
    }

    /// Brings a component that was only built to its first communication point.
    ///
    /// # Errors
    /// Those of [`Component::initialize`].
    pub fn begin(
        &mut self,
        component: &mut Component,
        observer: &mut dyn Observer,
        source: &str,
    ) -> Result<(), component::Error> {
        if component.mode() == Mode::Instantiated {
            component.initialize(0.0, None)?;
            observer.on_initialize(component, 0.0, None, source);
        }
        Ok(())
    }

    /// Simulated over wall time if the component shall step by itself now.
    #[must_use]
    pub fn free_running(&self) -> Option<f64> {
        self.free_running
    }

    /// Steps by itself from now on, at `factor` of simulated over wall time.
    pub(super) fn run_freely(&mut self, factor: f64) {
        self.free_running = Some(factor);
    }

    /// Nothing goes on from now on: who asks for it is told `why`.
    pub(super) fn end(&mut self, why: String) {
        self.free_running = None;
        self.over = Some(why);
    }

    /// Counts resets and restores.
    #[must_use]
    pub fn epoch(&self) -> u64 {
        self.epoch
    }

    /// Where the component stands.
    #[must_use]
    pub fn status(&self, component: &Component) -> Status {
        Status::of(component, self.epoch, self.free_running)
    }

    /// Carries out a request, or repeats its earlier reply.
    pub fn handle(
        &mut self,
        component: &mut Component,
        request: &Request,
        observer: &mut dyn Observer,
    ) -> Reply {
        if request.verb.changes() {
            match self.answered.look_up(request) {
                Earlier::New => {}
                Earlier::Answered(reply) => return reply.clone(),
                Earlier::Other => {
                    let refusal = Refusal::new(
                        Code::Conflict,
                        format!(
                            "req {:?} was used for another request; choose a new one",
                            request.req
                        ),
                    );
                    return Reply::refusal(&request.req, &refusal, &self.status(component));
                }
            }
        }
        let outcome = self.guarded(|protocol| protocol.dispatch(component, request, observer));
        let status = self.status(component);
        let mut reply = match outcome {
            Ok(fields) => Reply::success(&request.req, &status, fields),
            Err(refusal) => Reply::refusal(&request.req, &refusal, &status),
        };
        reply.ends = request.verb == Verb::Terminate && reply.error.is_none();
        if request.verb.changes() {
            self.answered.keep(request, reply.clone());
        }
        reply
    }

    /// Carries out a set-point; it takes effect with the next step.
    ///
    /// # Errors
    /// [`Code::UnknownVariable`], [`Code::Type`], [`Code::Range`], [`Code::State`]; nothing is changed then.
    pub fn set_point(
        &mut self,
        component: &mut Component,
        point: &SetPoint,
        observer: &mut dyn Observer,
    ) -> Result<(), Refusal> {
        self.guarded(|protocol| {
            protocol.goes_on()?;
            protocol.whole()?;
            let inputs = [(point.variable.clone(), point.given.clone())];
            let assignment = Assignment::resolve(component.variables(), &inputs)?;
            assign(component, &assignment, point.source(), observer)
        })
    }

    /// One communication step of the scene's length, without anybody asking: used while running freely. A step that
    /// fails ends free running.
    ///
    /// # Errors
    /// As a `step` request.
    pub fn free_step(
        &mut self,
        component: &mut Component,
        observer: &mut dyn Observer,
    ) -> Result<(), Refusal> {
        let time = component.time();
        let h = step_end(time, component.scene().run.step) - time;
        let outcome = self.guarded(|protocol| {
            protocol.goes_on()?;
            protocol.whole()?;
            advance(
                component,
                h,
                "free-running",
                protocol.notes.as_ref(),
                observer,
            )
        });
        if outcome.is_err() {
            self.free_running = None;
        }
        outcome.map(|_| ())
    }

    /// Turns a panic into a refusal; what panicked is not used again until it is built anew.
    fn guarded<T>(
        &mut self,
        call: impl FnOnce(&mut Self) -> Result<T, Refusal>,
    ) -> Result<T, Refusal> {
        catch_unwind(AssertUnwindSafe(|| call(self))).unwrap_or_else(|panic| {
            self.broken = true;
            let what = panic_text(panic.as_ref());
            Err(Refusal::new(
                Code::Internal,
                format!(
                    "a defect of this program: {what}; reset or restore to go on, and report it"
                ),
            ))
        })
    }

    /// Whether it is not over.
    fn goes_on(&self) -> Result<(), Refusal> {
        let Some(why) = &self.over else {
            return Ok(());
        };
        let message = format!(
            "the component ends, because its log must be whole (log.required): {why}; describe, status, get, save, log and \
             terminate are still carried out"
        );
        Err(Refusal::new(Code::State, message))
    }

    /// After a panic only calls that build the state anew are safe.
    fn whole(&self) -> Result<(), Refusal> {
        if self.broken {
            Err(Refusal::new(
                Code::Internal,
                "an earlier call met a defect of this program; reset or restore to go on",
            ))
        } else {
            Ok(())
        }
    }

    /// The component jumped: what was said of the time before is over.
    fn new_epoch(
        &mut self,
        component: &Component,
        event: AppliedEvent,
        request: &Request,
        observer: &mut dyn Observer,
    ) {
        self.epoch += 1;
        self.free_running = None;
        self.broken = false;
        observer.on_jump(component, event, source(request));
    }
}

/// Who asks, for the log.
fn source(request: &Request) -> &str {
    if request.client.is_empty() {
        "rpc"
    } else {
        &request.client
    }
}
