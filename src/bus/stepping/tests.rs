//! The stepping thread without its thread.

use super::*;
use crate::bus::notes::{Note, Notes};
use crate::bus::refusal::Code;
use crate::bus::tasks::{Giver, tasks};
use crate::bus::values::Settable;
use crate::bus::verb::Verb;
use crate::component::{Causality, StepReport, ValueKind, ValueReference};
use crate::wire::Unobserved;
use crate::wire::messages::{AppliedEvent, Command};
use std::sync::Arc;
use std::sync::Mutex;
use std::sync::mpsc::{SyncSender, sync_channel};

fn silo(mut protocol: Protocol) -> (Component, Protocol) {
    let text = include_str!("../../../tests/scenes/small_silo.toml");
    let scene = crate::scene::parse("small_silo.toml", text).unwrap();
    let mut component = Component::new(&scene).unwrap();
    protocol
        .begin(&mut component, &mut Unobserved, "test")
        .unwrap();
    (component, protocol)
}

/// Writes down what a log would get.
#[derive(Default)]
struct Heard(Vec<String>);

impl Observer for Heard {
    fn on_initialize(&mut self, _: &Component, _: f64, _: Option<f64>, _: &str) {}
    fn on_input(&mut self, _: &Component, _: &[ValueReference], _: &[f64], _: &str) {}
    fn on_step(&mut self, _: &Component, _: &StepReport, _: f64, _: f64, _: &str) {
        self.0.push("step done".to_owned());
    }
    fn on_command(&mut self, command: &Command) {
        let Command {
            interface,
            verb,
            client,
            status,
            ..
        } = command;
        self.0
            .push(format!("{interface} {verb} of {client} {status}"));
    }
    fn on_reply(&mut self, reply: &Command) {
        self.0
            .push(format!("{} answered {}", reply.verb, reply.status));
    }
    fn on_jump(&mut self, _: &Component, _: AppliedEvent, _: &str) {}
    fn on_log(&mut self, _: f64, _: LogLevel, _: &str, message: &str) {
        self.0.push(message.to_owned());
    }
}

/// A client that keeps the status of its answer.
struct Client(Arc<Mutex<Vec<&'static str>>>);

impl Asked for Client {
    fn answer(self: Box<Self>, reply: Reply) {
        self.0.lock().unwrap().push(reply.status());
    }
}

fn call(verb: Verb, body: &str, answers: &Arc<Mutex<Vec<&'static str>>>) -> Task {
    Task::Call {
        request: Box::new(Request::parse(verb, body.as_bytes()).unwrap()),
        body: body.to_owned(),
        asked: Box::new(Client(answers.clone())),
    }
}

#[test]
fn what_still_waits_at_the_end_is_answered_and_told() {
    let (give_note, notes) = sync_channel(1);
    let (component, protocol) =
        silo(Protocol::new("sandgate/v1/silo", None).with_notes(Notes(notes)));
    let shared = Shared::new(protocol.status(&component));
    shared.unlogged_calls.store(3, Relaxed);
    let (give, tasks) = tasks(Settable::of(component.variables()));
    let answers = Arc::default();
    let step = call(Verb::Step, r#"{"req":"1","client":"late"}"#, &answers);
    give.call(step).ok().unwrap();
    let point = SetPoint::parse("gate.main.opening", br#"{"value":1,"client":"plc"}"#);
    assert_eq!(give.point(point.unwrap(), false), Ok(None));
    tell_status(&give_note);
    let stepper = Stepper {
        component,
        protocol,
        shared: &shared,
        tasks,
        watch: Watch::new(None),
        ends: None,
    };
    let mut heard = Heard::default();
    let why = Refusal::new(Code::State, "the server ended");
    stepper.close(&why, &mut heard);
    assert_eq!(*answers.lock().unwrap(), ["state"]);
    assert_eq!(
        heard.0,
        [
            "rpc step of late ",
            "step answered state",
            "in gate.main.opening of plc state",
            "set-point refused: state: the server ended",
            "rpc status of watcher ",
            "status answered ok",
            "3 calls and set-points are not in this log: too many came at once",
        ]
    );
}

#[test]
fn what_gave_way_to_a_newer_one_is_told_without_a_line_for_people() {
    let (give, notes) = sync_channel(1);
    let told = SetPoint::told("gate.main.opening", br#"{"value":1,"client":"plc"}"#);
    give.try_send(Note::Superseded(told)).ok().unwrap();
    let mut heard = Heard::default();
    Notes(notes).tell(0.0, &mut heard);
    assert_eq!(heard.0, ["in gate.main.opening of plc superseded"]);
}

fn tell_status(notes: &SyncSender<Note>) {
    let note = Note::Call(Exchange {
        verb: "status".to_owned(),
        req: String::new(),
        client: "watcher".to_owned(),
        body: String::new(),
        status: "ok",
        reply: String::new(),
    });
    notes.try_send(note).ok().unwrap();
}

#[test]
fn what_is_answered_while_a_step_runs_is_told_before_its_end() {
    let (give, notes) = sync_channel(1);
    let (mut component, mut protocol) =
        silo(Protocol::new("sandgate/v1/silo", None).with_notes(Notes(notes)));
    let mut plain = silo(Protocol::new("sandgate/v1/silo", None));
    let request = Request::parse(Verb::Step, br#"{"req":"1"}"#).unwrap();
    tell_status(&give);
    let mut heard = Heard::default();
    let reply = protocol.handle(&mut component, &request, &mut heard);
    assert_eq!(reply.error, None);
    let told = ["rpc status of watcher ", "status answered ok", "step done"];
    assert_eq!(heard.0, told);
    // Looking changes no bit.
    plain.1.handle(&mut plain.0, &request, &mut Unobserved);
    assert_eq!(component.state_hash(), plain.0.state_hash());
}

#[test]
fn set_points_are_told_as_they_are_taken_or_refused() {
    let (component, protocol) = silo(Protocol::new("sandgate/v1/silo", None));
    let shared = Shared::new(protocol.status(&component));
    let (_give, tasks) = tasks(Settable::of(component.variables()));
    let mut stepper = Stepper {
        component,
        protocol,
        shared: &shared,
        tasks,
        watch: Watch::new(None),
        ends: None,
    };
    let mut heard = Heard::default();
    for (variable, body) in [
        ("gate.main.opening", r#"{"value":0.5,"client":"plc"}"#),
        ("gate.main.opening", r#"{"value":2,"client":"plc"}"#),
    ] {
        let point = SetPoint::parse(variable, body.as_bytes()).unwrap();
        stepper.set_point(&point, &mut heard);
    }
    let [taken, refused, line] = &heard.0[..] else {
        panic!("{:?}", heard.0)
    };
    assert_eq!(taken, "in gate.main.opening of plc ok");
    assert_eq!(refused, "in gate.main.opening of plc range");
    assert!(line.starts_with("set-point refused: range"), "{line}");
}

#[test]
fn set_points_that_keep_coming_are_no_orchestrator() {
    let (component, protocol) = silo(Protocol::new("sandgate/v1/silo", None));
    let input = component.variables().rows().iter().find(|row| {
        row.causality == Causality::Input && row.kind == ValueKind::Real && row.len() == 1
    });
    let body = |variable: &str| SetPoint::parse(variable, b"0.5").unwrap();
    let point = body(&input.unwrap().name);
    let shared = Shared::new(protocol.status(&component));
    let (give, tasks) = tasks(Settable::of(component.variables()));
    let mut watch = Watch::new(Some(Lost {
        after: Duration::from_millis(200),
        then: WhenLost::Terminate,
    }));
    watch.hear();
    let stop = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            // Far more often than the stepping thread looks up.
            for _ in 0..2000 {
                let sent = give.point(point.clone(), false);
                let lost = shared.orchestrator_lost.load(Relaxed);
                if lost || sent.is_err() {
                    break;
                }
                std::thread::sleep(Duration::from_millis(5));
            }
            stop.store(true, Relaxed);
        });
        let mut stepper = Stepper {
            component,
            protocol,
            shared: &shared,
            tasks,
            watch,
            ends: None,
        };
        stepper.run(&mut Unobserved, &stop);
    });
    assert!(shared.orchestrator_lost.load(Relaxed));
}

/// A client that asks again as soon as it is answered, so that something always waits.
struct Insistent {
    give: Arc<Giver>,
    left: usize,
    stop: Arc<AtomicBool>,
}

impl Insistent {
    fn ask(self) {
        let give = self.give.clone();
        let task = Task::Call {
            request: Box::new(Request::parse(Verb::Get, b"{}").unwrap()),
            body: "{}".to_owned(),
            asked: Box::new(self),
        };
        assert!(give.call(task).is_ok());
    }
}

impl Asked for Insistent {
    fn answer(self: Box<Self>, _: Reply) {
        match self.left {
            0 => self.stop.store(true, Relaxed),
            left => Self {
                left: left - 1,
                ..*self
            }
            .ask(),
        }
    }
}

#[test]
fn requests_that_keep_coming_do_not_keep_a_component_from_stepping_by_itself() {
    let (component, mut protocol) = silo(Protocol::new("sandgate/v1/silo", None));
    protocol.run_freely(f64::INFINITY);
    let shared = Shared::new(protocol.status(&component));
    let (give, tasks) = tasks(Settable::of(component.variables()));
    let stop = Arc::new(AtomicBool::new(false));
    Insistent {
        give: Arc::new(give),
        left: 5,
        stop: stop.clone(),
    }
    .ask();
    let mut stepper = Stepper {
        component,
        protocol,
        shared: &shared,
        tasks,
        watch: Watch::new(None),
        ends: None,
    };
    stepper.run(&mut Unobserved, &stop);
    // One before each request but the first, which waited already.
    assert_eq!(stepper.component.communication_steps(), 5);
}

#[test]
fn free_running_ends_with_who_can_ask() {
    let (component, mut protocol) = silo(Protocol::new("sandgate/v1/silo", None));
    protocol.run_freely(f64::INFINITY);
    let shared = Shared::new(protocol.status(&component));
    let (give, tasks) = tasks(Settable::of(component.variables()));
    let answers = Arc::default();
    give.call(call(Verb::Get, "{}", &answers)).ok().unwrap();
    drop(give);
    let mut stepper = Stepper {
        component,
        protocol,
        shared: &shared,
        tasks,
        watch: Watch::new(None),
        ends: None,
    };
    stepper.run(&mut Unobserved, &AtomicBool::new(false));
    assert_eq!(*answers.lock().unwrap(), ["ok"]);
}

/// A log that must be whole and is not.
struct Broken;

impl Observer for Broken {
    fn on_initialize(&mut self, _: &Component, _: f64, _: Option<f64>, _: &str) {}
    fn on_input(&mut self, _: &Component, _: &[ValueReference], _: &[f64], _: &str) {}
    fn on_step(&mut self, _: &Component, _: &StepReport, _: f64, _: f64, _: &str) {}
    fn on_command(&mut self, _: &Command) {}
    fn on_reply(&mut self, _: &Command) {}
    fn on_jump(&mut self, _: &Component, _: AppliedEvent, _: &str) {}
    fn on_log(&mut self, _: f64, _: LogLevel, _: &str, _: &str) {}
    fn trouble(&self) -> Option<String> {
        Some("the disk is full".to_owned())
    }
    fn ends(&self) -> bool {
        true
    }
}

#[test]
fn without_the_log_that_it_needs_a_component_answers_for_a_while_and_does_nothing() {
    let (component, mut protocol) = silo(Protocol::new("sandgate/v1/silo", None));
    protocol.run_freely(f64::INFINITY);
    let shared = Shared::new(protocol.status(&component));
    let (give, tasks) = tasks(Settable::of(component.variables()));
    let answers = Arc::new(Mutex::new(Vec::new()));
    for (verb, body) in [
        (Verb::Step, r#"{"req":"1"}"#),
        (Verb::Reset, r#"{"req":"2"}"#),
        (Verb::Get, "{}"),
        (Verb::Save, r#"{"req":"3"}"#),
        (Verb::Terminate, r#"{"req":"4"}"#),
    ] {
        assert!(give.call(call(verb, body, &answers)).is_ok());
    }
    let mut stepper = Stepper {
        component,
        protocol,
        shared: &shared,
        tasks,
        watch: Watch::new(None),
        ends: None,
    };
    stepper.run(&mut Broken, &AtomicBool::new(false));
    let answers = answers.lock().unwrap();
    assert_eq!(*answers, ["state", "state", "ok", "ok", "ok"]);
    assert!(shared.has_log_failure());
    assert_eq!(stepper.component.communication_steps(), 0);
}
