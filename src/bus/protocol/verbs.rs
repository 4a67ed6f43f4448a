//! The verbs of requests, `step` apart: what each is made into, and the fields of its reply.

use super::drive::{assign, reset_with, tell_clamped};
use super::{Fields, Protocol, source};
use crate::bus::fields::base64_text;
use crate::bus::publish::schemas;
use crate::bus::refusal::{Code, Refusal};
use crate::bus::request::Request;
use crate::bus::status::{mode_name, nanoseconds};
use crate::bus::values::{self, Assignment};
use crate::bus::verb::Verb;
use crate::component::{Component, Mode};
use crate::wire::Observer;
use crate::wire::foxglove::LogLevel;
use crate::wire::messages::AppliedEvent;
use serde_json::{Value, json};

/// Version of requests and replies; the `v1` of keys.
const VERSION: u32 = 1;

impl Protocol {
    /// Does what a request asks for, or says why not.
    pub(super) fn dispatch(
        &mut self,
        component: &mut Component,
        request: &Request,
        observer: &mut dyn Observer,
    ) -> Result<Fields, Refusal> {
        if !matches!(
            request.verb,
            Verb::Describe | Verb::Status | Verb::Get | Verb::Save | Verb::Log | Verb::Terminate
        ) {
            self.goes_on()?;
        }
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
            Verb::Run => self.run(component, request),
            Verb::Pause => {
                self.free_running = None;
                Ok(Fields::new())
            }
            Verb::Reset => self.reset(component, request, observer),
            Verb::Save => save(component, Verb::MOST_STATE, observer),
            Verb::Restore => self.restore(component, request, observer),
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

    /// From now on the component steps by itself.
    fn run(&mut self, component: &Component, request: &Request) -> Result<Fields, Refusal> {
        if component.mode() != Mode::Stepping {
            return Err(wrong_mode("run", component, "reset or restore first"));
        }
        self.free_running = Some(request.realtime_factor.unwrap_or(f64::INFINITY));
        Ok(Fields::new())
    }

    /// Back to the start, with the inputs of the request.
    fn reset(
        &mut self,
        component: &mut Component,
        request: &Request,
        observer: &mut dyn Observer,
    ) -> Result<Fields, Refusal> {
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

    /// To the state of the request.
    fn restore(
        &mut self,
        component: &mut Component,
        request: &Request,
        observer: &mut dyn Observer,
    ) -> Result<Fields, Refusal> {
        match self.broken {
            true => component.restore_anew(&request.state)?,
            false => component.restore(&request.state)?,
        }
        self.new_epoch(component, AppliedEvent::Restore, request, observer);
        Ok(one("state_hash", component.state_hash().into()))
    }

    /// What a client must know to speak with this component.
    pub(in crate::bus) fn description(&self, component: &Component) -> Fields {
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
            "dt_ns": nanoseconds(scene.run.step),
            "verbs": verbs,
            "variables": values::describe(component.variables()),
            "schemas": schemas,
        }))
    }
}

/// The state, as text. One that is longer than `restore` takes (`most`) is given all the same, since a file of it can be gone on
/// with, but with a warning, so that nobody counts on it.
fn save(
    component: &Component,
    most: usize,
    observer: &mut dyn Observer,
) -> Result<Fields, Refusal> {
    let state = component.save()?;
    let text = base64_text(&state);
    let warning = (text.len() > most).then(|| {
        format!(
            "save: found a state of {} bytes as text, allowed {most} in restore: it cannot be restored over Zenoh; decode it into a file \
             and go on with `sandgate run CASE --resume FILE`, or use a coarser numerics.spacing",
            text.len()
        )
    });
    let mut fields = object(
        json!({"bytes": state.len(), "state_hash": component.state_hash(),
                     "state": text}),
    );
    if let Some(warning) = warning {
        observer.on_log(component.time(), LogLevel::Warning, "bus", &warning);
        fields.insert("warning".into(), warning.into());
    }
    Ok(fields)
}

/// Inputs set, outputs read.
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

fn one(name: &str, value: Value) -> Fields {
    let mut map = Fields::new();
    map.insert(name.into(), value);
    map
}

/// The fields of a JSON object.
pub(super) fn object(value: Value) -> Fields {
    match value {
        Value::Object(map) => map,
        _ => Fields::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Unobserved;

    #[test]
    fn a_state_that_restore_does_not_take_is_saved_with_a_warning() {
        let text = include_str!("../../../tests/scenes/small_silo.toml");
        let scene = crate::scene::parse("small_silo.toml", text).unwrap();
        let mut component = Component::new(&scene).unwrap();
        component.initialize(0.0, None).unwrap();
        let length = base64_text(&component.save().unwrap()).len();
        let fits = save(&component, length, &mut Unobserved).unwrap();
        assert_eq!(fits.get("warning"), None);
        let not = save(&component, length - 1, &mut Unobserved).unwrap();
        assert_eq!(not["state"], fits["state"]);
        let warning = not["warning"].as_str().unwrap();
        for part in [
            &(length - 1).to_string()[..],
            "restored",
            "--resume",
            "coarser",
        ] {
            assert!(warning.contains(part), "{warning}");
        }
    }

    /// The longest state fits into a body with all that may stand beside it.
    #[test]
    fn restore_takes_what_is_saved_without_a_warning() {
        let restore = |length: usize| {
            let id = "\\u0041".repeat(64);
            let state = "A".repeat(length);
            let body = format!(
                r#"{{"req":"{id}","client":"{id}","expect_step":{},"state":"{state}"}}"#,
                u64::MAX
            );
            Request::parse(Verb::Restore, body.as_bytes())
        };
        let request = restore(Verb::MOST_STATE).unwrap();
        assert_eq!(request.state.len(), Verb::MOST_STATE / 4 * 3);
        let refusal = restore(Verb::MOST_STATE + (1 << 20)).unwrap_err();
        assert_eq!(refusal.code, Code::TooLarge);
    }
}
