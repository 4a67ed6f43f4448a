//! Requests on a component: [`Request`] in, [`Reply`] out. Pure: no network, no thread, no clock but the one that
//! measures `wall_us`.
//!
//! What the wire promises is kept here: a request sent twice is carried out once; `expect_step` and `t_ns` that do not
//! match are a conflict; inputs of one request apply all or none; a panic becomes a reply. The rules of the component
//! (which call is allowed when, ranges) are the component's own.

use super::answered::{Answered, Earlier};
use super::fields::base64_text;
use super::publish::schemas;
use super::refusal::{Code, Refusal};
use super::reply::Reply;
use super::request::Request;
use super::set_point::SetPoint;
use super::status::{Status, mode_name};
use super::values::{self, Assignment};
use super::verb::Verb;
use crate::component::{self, Component, Mode, StepReport, step_end};
use crate::wire::Observer;
use crate::wire::foxglove::LogLevel;
use crate::wire::messages::AppliedEvent;
use serde_json::{Map, Value, json};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

/// Version of requests and replies; the `v1` of keys.
const VERSION: u32 = 1;

/// The state of the protocol on one component.
#[derive(Debug)]
pub struct Protocol {
    base: String,
    epoch: u64,
    free_running: Option<f64>,
    answered: Answered<Reply>,
    broken: bool,
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
            protocol.whole()?;
            let inputs = [(point.variable.clone(), point.values.clone())];
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
            protocol.whole()?;
            advance(component, h, "free-running", observer)
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
            let what = panic
                .downcast_ref::<&str>()
                .map(|text| (*text).to_owned())
                .or_else(|| panic.downcast_ref::<String>().cloned())
                .unwrap_or_else(|| "panic".into());
            Err(Refusal::new(
                Code::Internal,
                format!(
                    "a defect of this program: {what}; reset or restore to go on, and report it"
                ),
            ))
        })
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

    fn dispatch(
        &mut self,
        component: &mut Component,
        request: &Request,
        observer: &mut dyn Observer,
    ) -> Result<Fields, Refusal> {
        if !matches!(
            request.verb,
            Verb::Describe | Verb::Status | Verb::Log | Verb::Reset | Verb::Restore
        ) {
            self.whole()?;
        }
        expect_step(component, request)?;
        match request.verb {
            Verb::Describe => Ok(self.description(component)),
            Verb::Status => Ok(self.status(component).figures()),
            Verb::Get => {
                let rows = values::rows(component.variables(), request.outputs.as_deref())?;
                Ok(one("outputs", values::read(component, &rows)?.into()))
            }
            Verb::Set => set(component, request, observer),
            Verb::Step => self.step(component, request, observer),
            Verb::Run => {
                if component.mode() != Mode::Stepping {
                    return Err(wrong_mode("run", component, "reset or restore first"));
                }
                self.free_running = Some(request.realtime_factor.unwrap_or(f64::INFINITY));
                Ok(Fields::new())
            }
            Verb::Pause => {
                self.free_running = None;
                Ok(Fields::new())
            }
            Verb::Reset => {
                let assignment = Assignment::resolve(component.variables(), &request.inputs)?;
                reset_with(component, &assignment)?;
                self.new_epoch(component, AppliedEvent::Reset, request, observer);
                if !assignment.references.is_empty() {
                    let Assignment { references, values } = &assignment;
                    observer.on_input(component, references, values, source(request));
                    tell_clamped(component, observer);
                }
                self.begin(component, observer, source(request))?;
                Ok(Fields::new())
            }
            Verb::Save => {
                let state = component.save()?;
                Ok(object(
                    json!({"bytes": state.len(), "state_hash": component.state_hash(),
                                 "state": base64_text(&state)}),
                ))
            }
            Verb::Restore => {
                match self.broken {
                    true => component.restore_anew(&request.state)?,
                    false => component.restore(&request.state)?,
                }
                self.new_epoch(component, AppliedEvent::Restore, request, observer);
                Ok(one("state_hash", component.state_hash().into()))
            }
            Verb::Log => {
                if let Some((level, text)) = &request.line {
                    observer.on_log(component.time(), *level, source(request), text);
                }
                Ok(Fields::new())
            }
            Verb::Terminate => {
                component.terminate()?;
                self.free_running = None;
                Ok(Fields::new())
            }
        }
    }

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

    fn step(
        &mut self,
        component: &mut Component,
        request: &Request,
        observer: &mut dyn Observer,
    ) -> Result<Fields, Refusal> {
        if self.free_running.is_some() {
            return Err(Refusal::new(
                Code::State,
                "step: the component runs freely; send pause first",
            ));
        }
        let now = super::status::nanoseconds(component.time());
        if let Some(t_ns) = request.t_ns
            && t_ns != now
        {
            return Err(Refusal::new(
                Code::Conflict,
                format!("t_ns: found {t_ns}, the component is at {now}; read status and decide"),
            ));
        }
        // The end is a whole number of nanoseconds, made a time once, so that any number of steps does not drift. Over
        // 1e9 is the nearest f64; times 1e-9 is one bit off for many. The sum saturates far beyond any run.
        let end = match request.dt_ns {
            Some(dt) => now.saturating_add_unsigned(dt) as f64 / 1e9,
            None => step_end(component.time(), component.scene().run.step),
        };
        let h = end - component.time();
        let assignment = Assignment::resolve(component.variables(), &request.inputs)?;
        let rows = match &request.outputs {
            Some(names) => values::rows(component.variables(), Some(names))?,
            None => Vec::new(),
        };
        let names: Vec<_> = rows.iter().map(|row| row.reference).collect();
        let before = assignment.present(component)?;
        assign(component, &assignment, source(request), observer)?;
        let started = Instant::now();
        let report = match advance(component, h, source(request), observer) {
            Ok(report) => report,
            Err(refusal) => {
                if component.mode() != Mode::Failed {
                    // Refused without a step: the inputs go back, too. They were allowed a moment ago.
                    assign(component, &before, "undone", observer)?;
                }
                return Err(refusal);
            }
        };
        let wall_us = u64::try_from(started.elapsed().as_micros()).unwrap_or(u64::MAX);
        let rows: Vec<_> = names
            .iter()
            .filter_map(|&reference| component.variables().by_reference(reference))
            .collect();
        let outputs = values::read(component, &rows)?;
        Ok(object(json!({
            "outputs": outputs, "substeps": report.substeps, "iterations": report.iterations,
            "wall_us": wall_us,
        })))
    }

    pub(super) fn description(&self, component: &Component) -> Fields {
        let scene = component.scene();
        let verbs: Fields = Verb::all()
            .map(|verb| {
                let mut fields = vec!["req", "client"];
                fields.extend(verb.fields());
                (verb.name().to_owned(), fields.into())
            })
            .collect();
        let schemas: Fields = schemas()
            .into_iter()
            .map(|(name, bytes)| (name.to_owned(), base64_text(&bytes).into()))
            .collect();
        object(json!({
            "protocol": VERSION,
            "program": concat!("sandgate ", env!("CARGO_PKG_VERSION")),
            "scene": scene.name,
            "title": scene.title,
            "key": self.base,
            "dt_ns": super::status::nanoseconds(scene.run.step),
            "verbs": verbs,
            "variables": values::describe(component.variables()),
            "schemas": schemas,
        }))
    }
}

fn set(
    component: &mut Component,
    request: &Request,
    observer: &mut dyn Observer,
) -> Result<Fields, Refusal> {
    let assignment = Assignment::resolve(component.variables(), &request.inputs)?;
    // Looked up before anything is set, so that a name that is not there changes nothing.
    let names = request.outputs.as_deref().unwrap_or_default();
    values::rows(component.variables(), Some(names))?;
    assign(component, &assignment, source(request), observer)?;
    let rows = values::rows(component.variables(), Some(names))?;
    Ok(one("outputs", values::read(component, &rows)?.into()))
}

fn assign(
    component: &mut Component,
    assignment: &Assignment,
    source: &str,
    observer: &mut dyn Observer,
) -> Result<(), Refusal> {
    if assignment.references.is_empty() {
        return Ok(());
    }
    component.set(&assignment.references, &assignment.values)?;
    observer.on_input(
        component,
        &assignment.references,
        &assignment.values,
        source,
    );
    tell_clamped(component, observer);
    Ok(())
}

/// Which inputs were taken but not as they were asked for.
fn tell_clamped(component: &mut Component, observer: &mut dyn Observer) {
    for note in component.take_notes() {
        observer.on_log(component.time(), LogLevel::Warning, "bus", &note);
    }
}

/// Back to the start, with these variables set, fixed parameters among them; all or nothing.
fn reset_with(component: &mut Component, assignment: &Assignment) -> Result<(), Refusal> {
    if assignment.references.is_empty() {
        return Ok(component.reset()?);
    }
    let mut fresh = component.anew()?;
    fresh.set(&assignment.references, &assignment.values)?;
    fresh.settle()?;
    *component = fresh;
    Ok(())
}

fn advance(
    component: &mut Component,
    h: f64,
    source: &str,
    observer: &mut dyn Observer,
) -> Result<StepReport, Refusal> {
    let t = component.time();
    let done = component.do_step(t, h);
    tell_clamped(component, observer);
    match done {
        Ok(report) => {
            observer.on_step(component, &report, t, h, source);
            Ok(report)
        }
        Err(error) => {
            if component.mode() == Mode::Failed {
                observer.on_log(component.time(), LogLevel::Error, "bus", &error.to_string());
            }
            Err(error.into())
        }
    }
}

fn expect_step(component: &Component, request: &Request) -> Result<(), Refusal> {
    let step = component.communication_steps();
    match request.expect_step {
        Some(expected) if expected != step => Err(Refusal::new(
            Code::Conflict,
            format!(
                "expect_step: found {expected}, the component is at step {step}; read status and decide"
            ),
        )),
        _ => Ok(()),
    }
}

fn wrong_mode(call: &str, component: &Component, remedy: &str) -> Refusal {
    Refusal::new(
        Code::State,
        format!(
            "{call} is not allowed in mode {}; {remedy}",
            mode_name(component.mode())
        ),
    )
}

fn source(request: &Request) -> &str {
    if request.client.is_empty() {
        "rpc"
    } else {
        &request.client
    }
}

fn one(name: &str, value: Value) -> Fields {
    let mut map = Fields::new();
    map.insert(name.into(), value);
    map
}

fn object(value: Value) -> Fields {
    match value {
        Value::Object(map) => map,
        _ => Fields::new(),
    }
}
