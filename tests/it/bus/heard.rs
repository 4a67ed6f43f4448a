//! What an observer of the protocol hears.

use super::Bench;
use sandgate::bus::{Request, Verb};
use sandgate::component::{Component, StepReport, ValueReference};
use sandgate::wire::Observer;
use sandgate::wire::foxglove::LogLevel;
use sandgate::wire::messages::{AppliedEvent, Command};

/// Hears everything; panics where it is told to.
#[derive(Default)]
struct Listener {
    heard: Vec<String>,
    panic_on_step: bool,
}

impl Observer for Listener {
    fn on_initialize(&mut self, _: &Component, start: f64, _: Option<f64>, source: &str) {
        self.heard.push(format!("initialize {start} {source}"));
    }
    fn on_input(&mut self, _: &Component, _: &[ValueReference], values: &[f64], source: &str) {
        self.heard.push(format!("input {values:?} {source}"));
    }
    fn on_step(&mut self, _: &Component, _: &StepReport, t: f64, h: f64, source: &str) {
        assert!(!self.panic_on_step, "a defect made for this test");
        self.heard.push(format!("step {t} {h} {source}"));
    }
    fn on_command(&mut self, _: &Command) {}
    fn on_reply(&mut self, _: &Command) {}
    fn on_jump(&mut self, _: &Component, event: AppliedEvent, source: &str) {
        self.heard.push(format!("{event:?} {source}"));
    }
    fn on_log(&mut self, _: f64, level: LogLevel, _: &str, _: &str) {
        self.heard.push(format!("{level:?}"));
    }
}

#[test]
fn a_reset_sets_fixed_parameters_all_or_none() {
    let mut bench = Bench::new();
    let particles = bench.ok("get", r#"{"outputs":["solver.particles"]}"#)["outputs"].clone();
    bench.ok("step", r#"{"req":"1","inputs":{"gate.main.opening":1}}"#);
    bench.ok("set", r#"{"req":"0","inputs":{"solver.threads":2}}"#);
    let before = bench.hash();
    bench.refused(
        "set",
        r#"{"req":"2","inputs":{"solver.resolution_scale":1.25}}"#,
        "state",
        "fixed parameter",
    );
    for (req, inputs) in [
        ("3", r#"{"solver.resolution_scale":-1}"#),
        (
            "4",
            r#"{"gate.main.opening":0.5,"solver.resolution_scale":1e9}"#,
        ),
    ] {
        let body = format!(r#"{{"req":"{req}","inputs":{inputs}}}"#);
        bench.refused("reset", &body, "range", "solver.resolution_scale");
        assert_eq!(bench.hash(), before);
        // What no saved state holds stays as well.
        let threads = bench.ok("get", r#"{"outputs":["solver.threads"]}"#);
        assert_eq!(threads["outputs"]["solver.threads"], 2);
    }
    let mut listener = Listener::default();
    let body = r#"{"req":"5","client":"b","inputs":{"solver.resolution_scale":1.25,"gate.main.opening":0.5}}"#;
    let request = Request::parse(Verb::Reset, body.as_bytes()).unwrap();
    assert!(bench.handle(&request, &mut listener).error.is_none());
    assert_eq!(
        listener.heard,
        ["Reset b", "input [1.25, 0.5] b", "initialize 0 b"]
    );
    let now = bench.ok("get", r#"{"outputs":["solver.particles"]}"#)["outputs"].clone();
    assert!(now["solver.particles"].as_f64() > particles["solver.particles"].as_f64());
    // The next one goes back to the scene's own.
    bench.ok("reset", r#"{"req":"6"}"#);
    assert_eq!(
        bench.ok("get", r#"{"outputs":["solver.particles"]}"#)["outputs"],
        particles
    );
}

#[test]
fn clamped_inputs_and_lines_of_clients_are_heard() {
    let mut bench = Bench::new();
    let mut listener = Listener::default();
    let mut send = |verb: Verb, body: &str| {
        let request = Request::parse(verb, body.as_bytes()).unwrap();
        assert_eq!(bench.handle(&request, &mut listener).error, None, "{body}");
    };
    send(
        Verb::Set,
        r#"{"req":"1","inputs":{"saturate_inputs":true}}"#,
    );
    send(
        Verb::Set,
        r#"{"req":"2","client":"a","inputs":{"gate.main.opening":1.5}}"#,
    );
    send(
        Verb::Log,
        r#"{"req":"3","client":"a","message":"hatch opened by hand","level":"error"}"#,
    );
    send(Verb::Log, r#"{"req":"4","message":"closed again"}"#);
    assert_eq!(
        listener.heard,
        [
            "input [1.0] rpc",
            "input [1.5] a",
            "Warning",
            "Error",
            "Info"
        ]
    );
    bench.refused("log", r#"{"req":"5"}"#, "bad_request", "message");
    bench.refused("log", r#"{"message":"x"}"#, "bad_request", "req");
    bench.refused("log", r#"{"req":"6","message":7}"#, "type", "message");
    bench.refused(
        "log",
        r#"{"req":"7","message":"x","level":"loud"}"#,
        "type",
        "info, warning or error",
    );
}

#[test]
fn an_observer_hears_what_happens_in_its_order() {
    let mut bench = Bench::new();
    let mut listener = Listener::default();
    for (verb, body) in [
        (
            Verb::Set,
            r#"{"req":"1","client":"a","inputs":{"gate.main.opening":0.25}}"#,
        ),
        (
            Verb::Step,
            r#"{"req":"2","inputs":{"gate.main.opening":0.5}}"#,
        ),
        (
            Verb::Step,
            r#"{"req":"2","inputs":{"gate.main.opening":0.5}}"#,
        ),
        (Verb::Step, r#"{"req":"3","expect_step":9}"#),
        (Verb::Reset, r#"{"req":"4","client":"b"}"#),
    ] {
        bench.handle(
            &Request::parse(verb, body.as_bytes()).unwrap(),
            &mut listener,
        );
    }
    assert_eq!(
        listener.heard,
        [
            "input [0.25] a",
            "input [0.5] rpc",
            "step 0 0.005 rpc",
            "Reset b",
            "initialize 0 b"
        ]
    );
}

#[test]
fn a_panic_becomes_a_reply_and_a_reset_or_a_saved_state_heals() {
    let mut bench = Bench::new();
    let saved = bench.ok("save", "")["state"].clone();
    let mut listener = Listener {
        panic_on_step: true,
        ..Listener::default()
    };
    let request = Request::parse(Verb::Step, br#"{"req":"1"}"#).unwrap();
    let reply = bench.handle(&request, &mut listener);
    assert!(
        reply.body.contains("a defect made for this test"),
        "{}",
        reply.body
    );
    assert_eq!(reply.status(), "internal");
    bench.refused(
        "step",
        r#"{"req":"2"}"#,
        "internal",
        "reset or restore to go on",
    );
    bench.refused("get", "{}", "internal", "reset or restore to go on");
    assert_eq!(bench.ok("status", "")["ok"], true);
    bench.ok("reset", r#"{"req":"3"}"#);
    assert_eq!(bench.ok("step", r#"{"req":"4"}"#)["step"], 1);

    let request = Request::parse(Verb::Step, br#"{"req":"5"}"#).unwrap();
    assert_eq!(bench.handle(&request, &mut listener).status(), "internal");
    bench.ok("restore", &format!(r#"{{"req":"6","state":{saved}}}"#));
    assert_eq!(bench.ok("step", r#"{"req":"7"}"#)["step"], 1);
}
