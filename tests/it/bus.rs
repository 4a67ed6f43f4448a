//! The bus: its protocol on a real component, without a network; then the program, served, driven by Python clients.

use crate::python;
use sandgate::bus::{
    BusError, Protocol, Reply, Request, ServeOptions, Server, SetPoint, Verb, ZenohConfig,
};
use sandgate::component::{Component, Mode, StepReport, ValueReference};
use sandgate::wire::foxglove::LogLevel;
use sandgate::wire::messages::{AppliedEvent, Command};
use sandgate::wire::{Observer, Unobserved};
use serde_json::{Value, json};
use std::ffi::OsStr;

const BASE: &str = "sandgate/v1/small_silo";
const GATE: &str = "gate.main.opening";

/// A served component without its network.
struct Bench {
    component: Component,
    protocol: Protocol,
}

impl Bench {
    fn new() -> Self {
        let mut bench = Self {
            component: silo(),
            protocol: Protocol::new(BASE, None),
        };
        bench
            .protocol
            .begin(&mut bench.component, &mut Unobserved, "test")
            .unwrap();
        bench
    }

    /// Sends a body as a client would; what cannot be read is refused as the server does it.
    fn send(&mut self, verb: &str, body: &str) -> Value {
        let read = Verb::from_name(verb).and_then(|verb| Request::parse(verb, body.as_bytes()));
        let reply = match read {
            Ok(request) => self.handle(&request, &mut Unobserved),
            Err(refusal) => Reply::refusal(
                &Request::req_of(body.as_bytes()),
                &refusal,
                &self.protocol.status(&self.component),
            ),
        };
        serde_json::from_str(&reply.body).unwrap()
    }

    fn handle(&mut self, request: &Request, observer: &mut dyn Observer) -> Reply {
        self.protocol.handle(&mut self.component, request, observer)
    }

    fn ok(&mut self, verb: &str, body: &str) -> Value {
        let reply = self.send(verb, body);
        assert_eq!(reply["ok"], true, "{verb} {body}: {reply}");
        reply
    }

    fn refused(&mut self, verb: &str, body: &str, code: &str, part: &str) {
        let reply = self.send(verb, body);
        assert_eq!(reply["ok"], false, "{verb} {body}: {reply}");
        assert_eq!(reply["code"], code, "{verb} {body}: {reply}");
        let message = reply["message"].as_str().unwrap();
        assert!(message.contains(part), "{verb} {body}: {message}");
    }

    fn hash(&self) -> String {
        self.component.state_hash()
    }
}

fn silo() -> Component {
    let scene =
        sandgate::scene::load(&python::root().join("tests/scenes/small_silo.toml")).unwrap();
    Component::new(&scene).unwrap()
}

fn opening(component: &Component) -> ValueReference {
    component.variables().by_name(GATE).unwrap().reference
}

#[test]
fn a_step_by_query_is_a_step_of_the_component() {
    let mut bench = Bench::new();
    let reply = bench.ok(
        "step",
        r#"{"req":"1","client":"t","t_ns":0,"dt_ns":5000000,"inputs":{"gate.main.opening":0.5},
            "outputs":["gauge.level.depth","gate.main.opening"],"expect_step":0}"#,
    );
    assert_eq!(
        (&reply["step"], &reply["t_ns"]),
        (&json!(1), &json!(5_000_000))
    );
    assert_eq!(
        (&reply["epoch"], &reply["mode"]),
        (&json!(0), &json!("stepping"))
    );
    assert_eq!(reply["outputs"][GATE], 0.5);
    assert!(reply["outputs"]["gauge.level.depth"].as_f64().unwrap() > 0.05);
    assert!(reply["substeps"].as_u64().unwrap() >= 1);
    bench.ok("step", r#"{"req":"2"}"#);

    let mut plain = silo();
    plain.initialize(0.0, None).unwrap();
    plain.set(&[opening(&plain)], &[0.5]).unwrap();
    plain.do_step(0.0, 0.005).unwrap();
    plain.do_step(0.005, 0.005).unwrap();
    assert_eq!(bench.hash(), plain.state_hash());
}

#[test]
fn steps_of_whole_nanoseconds_do_not_drift() {
    let mut bench = Bench::new();
    for step in 1..=60_u32 {
        let body = json!({"req": step.to_string(), "dt_ns": 100_001}).to_string();
        let t_ns = 100_001 * u64::from(step);
        assert_eq!(bench.ok("step", &body)["t_ns"], t_ns);
        // One rounding of t + h, however many steps there were.
        let exact = t_ns as f64 / 1e9;
        assert!((bench.component.time() - exact).abs() <= f64::EPSILON * exact);
    }
}

#[test]
fn a_request_sent_twice_is_carried_out_once() {
    let mut bench = Bench::new();
    let first = bench.ok("step", r#"{"req":"c7e1","client":"a","dt_ns":2000000}"#);
    let hash = bench.hash();
    let again = bench.ok("step", r#"{"dt_ns":2000000, "client":"a", "req":"c7e1"}"#);
    assert_eq!(first, again);
    assert_eq!(bench.hash(), hash);
    bench.refused(
        "step",
        r#"{"req":"c7e1","client":"a","dt_ns":3000000}"#,
        "conflict",
        "choose a new one",
    );
    bench.refused(
        "pause",
        r#"{"req":"c7e1","client":"a"}"#,
        "conflict",
        "was used for another request",
    );
    assert_eq!(bench.hash(), hash);
    let other = bench.ok("step", r#"{"req":"c7e1","client":"b","dt_ns":2000000}"#);
    assert_eq!(other["step"], 2);
}

#[test]
fn ten_bad_messages_are_refused_and_the_component_goes_on_unharmed() {
    let table = [
        (
            "stepp",
            r#"{"req":"b0"}"#,
            "bad_request",
            "unknown verb \"stepp\"; there are describe, status, get, set, step",
        ),
        (
            "step",
            r#"{"req":"b1","#,
            "bad_request",
            "body is not JSON as it must be: EOF while parsing",
        ),
        (
            "step",
            r#"{"req":"b2","dt_ns":NaN}"#,
            "bad_request",
            "NaN and Infinity are not JSON either",
        ),
        (
            "step",
            r#"{"req":"b3","dt":0.005}"#,
            "bad_request",
            "step: unknown field \"dt\"; it takes req, client, t_ns, dt_ns, inputs, outputs, expect_step",
        ),
        (
            "step",
            r#"{"dt_ns":5000000}"#,
            "bad_request",
            "step: missing \"req\"",
        ),
        (
            "step",
            r#"{"req":"b5","dt_ns":-5000000}"#,
            "range",
            "dt_ns: found -5000000, allowed 1 to 3600000000000",
        ),
        (
            "set",
            r#"{"req":"b6","inputs":{"gate.main.open":1}}"#,
            "unknown_variable",
            "unknown variable \"gate.main.open\"; there are solver.threads, saturate_inputs, solver.resolution_scale",
        ),
        (
            "set",
            r#"{"req":"b7","inputs":{"gate.main.opening":"half"}}"#,
            "type",
            "gate.main.opening: found \"half\", allowed a number",
        ),
        (
            "set",
            r#"{"req":"b8","inputs":{"gate.main.opening":1.5}}"#,
            "range",
            "gate.main.opening: found 1.5, allowed",
        ),
        (
            "step",
            r#"{"req":"b9","expect_step":7}"#,
            "conflict",
            "expect_step: found 7, the component is at step 1",
        ),
        (
            "step",
            r#"{"req":"b10","t_ns":1}"#,
            "conflict",
            "t_ns: found 1, the component is at 5000000",
        ),
        (
            "step",
            r#"{"req":"b11","outputs":["gauge.none"]}"#,
            "unknown_variable",
            "unknown variable \"gauge.none\"",
        ),
        (
            "set",
            r#"{"req":"b12","inputs":{"gauge.level.depth":1}}"#,
            "range",
            "gauge.level.depth",
        ),
        (
            "set",
            r#"{"req":"b13","inputs":{"gate.main.opening":[0.1,0.2]}}"#,
            "type",
            "found 2 value(s), allowed 1",
        ),
        (
            "restore",
            r#"{"req":"b14","state":"AAAA"}"#,
            "bad_request",
            "saved state refused",
        ),
        (
            "get",
            r#"{"outputs":["time"],"outputs":["time"]}"#,
            "bad_request",
            "\"outputs\" stands there twice",
        ),
    ];
    let (mut bench, mut calm) = (Bench::new(), Bench::new());
    for each in [&mut bench, &mut calm] {
        each.ok("step", r#"{"req":"1","inputs":{"gate.main.opening":0.2}}"#);
    }
    for (verb, body, code, part) in table {
        bench.refused(verb, body, code, part);
        assert_eq!(bench.hash(), calm.hash(), "after {verb} {body}");
        let status = bench.ok("status", "");
        assert_eq!(
            (&status["step"], &status["t_ns"]),
            (&json!(1), &json!(5_000_000))
        );
    }
    for each in [&mut bench, &mut calm] {
        each.ok("step", r#"{"req":"2"}"#);
    }
    assert_eq!(bench.hash(), calm.hash());
}

#[test]
fn inputs_of_one_request_apply_all_or_none() {
    let mut bench = Bench::new();
    let before = bench.hash();
    for (body, code) in [
        (
            r#"{"req":"1","inputs":{"gate.main.opening":0.3,"gate.side.opening":0.3}}"#,
            "unknown_variable",
        ),
        (
            r#"{"req":"2","inputs":{"gate.main.opening":0.3,"gate.main.actual_opening":0.3}}"#,
            "range",
        ),
    ] {
        for verb in ["set", "step"] {
            bench.refused(
                verb,
                &body.replace("req\":\"", &format!("req\":\"{verb}")),
                code,
                "gate.",
            );
            let value = bench.ok("get", r#"{"outputs":["gate.main.opening"]}"#);
            assert_eq!(value["outputs"][GATE], 0.0, "{verb} {body}");
        }
    }
    assert_eq!(bench.hash(), before);

    // The step itself is refused after its inputs were good: it would go past the stop time.
    let mut component = silo();
    component.initialize(0.0, Some(0.004)).unwrap();
    bench.component = component;
    bench.refused(
        "step",
        r#"{"req":"3","inputs":{"gate.main.opening":0.3}}"#,
        "range",
        "the stop time",
    );
    let value = bench.ok("get", r#"{"outputs":["gate.main.opening"]}"#);
    assert_eq!(value["outputs"][GATE], 0.0);
}

#[test]
fn save_restore_and_reset_start_new_epochs() {
    let mut bench = Bench::new();
    let start = bench.hash();
    bench.ok("step", r#"{"req":"1","inputs":{"gate.main.opening":1}}"#);
    let saved = bench.ok("save", "");
    assert_eq!(saved["state_hash"], bench.hash());
    bench.ok("step", r#"{"req":"2"}"#);
    let gone_on = bench.hash();

    let restore = json!({"req": "3", "state": saved["state"]}).to_string();
    let restored = bench.ok("restore", &restore);
    assert_eq!(
        (&restored["epoch"], &restored["step"]),
        (&json!(1), &json!(1))
    );
    bench.ok("step", r#"{"req":"4"}"#);
    assert_eq!(bench.hash(), gone_on);
    // Sent again it is not carried out again.
    assert_eq!(bench.ok("restore", &restore), restored);
    assert_eq!(bench.hash(), gone_on);

    let reset = bench.ok("reset", r#"{"req":"5"}"#);
    assert_eq!(
        (&reset["epoch"], &reset["step"], &reset["t_ns"]),
        (&json!(2), &json!(0), &json!(0))
    );
    assert_eq!((bench.hash(), &reset["mode"]), (start, &json!("stepping")));
}

#[test]
fn set_points_take_effect_with_the_next_step_or_are_refused() {
    let mut bench = Bench::new();
    let send = |bench: &mut Bench, variable: &str, body: &str| {
        SetPoint::parse(variable, body.as_bytes()).and_then(|point| {
            bench
                .protocol
                .set_point(&mut bench.component, &point, &mut Unobserved)
        })
    };
    send(&mut bench, GATE, r#"{"value":0.4,"client":"plc"}"#).unwrap();
    for (variable, body, part) in [
        (GATE, "1.5", "allowed"),
        (GATE, "[0.1,0.2]", "2 value(s)"),
        (GATE, "NaN", "not JSON"),
        ("gate.none.opening", "1", "unknown variable"),
        ("gauge.level.depth", "1", "gauge.level.depth"),
    ] {
        let refusal = send(&mut bench, variable, body).unwrap_err();
        assert!(
            refusal.message.contains(part),
            "{variable} {body}: {refusal}"
        );
    }
    let reply = bench.ok(
        "step",
        r#"{"req":"1","outputs":["gate.main.opening","gate.main.actual_opening"]}"#,
    );
    assert_eq!(reply["outputs"][GATE], 0.4);
    assert!(
        reply["outputs"]["gate.main.actual_opening"]
            .as_f64()
            .unwrap()
            > 0.0
    );
}

#[test]
fn free_running_and_stepping_by_query_exclude_each_other() {
    let mut bench = Bench::new();
    bench.ok("run", r#"{"req":"1","realtime_factor":2}"#);
    assert_eq!(bench.protocol.free_running(), Some(2.0));
    bench.refused("step", r#"{"req":"2"}"#, "state", "send pause first");
    let status = bench.ok("status", "");
    assert_eq!(
        (&status["free_running"], &status["realtime_factor"]),
        (&json!(true), &json!(2.0))
    );
    bench
        .protocol
        .free_step(&mut bench.component, &mut Unobserved)
        .unwrap();
    let paused = bench.ok("pause", r#"{"req":"3"}"#);
    assert_eq!(
        (&paused["step"], &paused["t_ns"]),
        (&json!(1), &json!(5_000_000))
    );
    assert_eq!(bench.ok("step", r#"{"req":"4"}"#)["step"], 2);
    bench.ok("run", r#"{"req":"5"}"#);
    assert_eq!(bench.ok("status", "")["realtime_factor"], "Infinity");
}

#[test]
fn terminate_ends_and_only_reading_and_going_back_are_left() {
    let mut bench = Bench::new();
    let request = Request::parse(Verb::Terminate, br#"{"req":"1"}"#).unwrap();
    assert!(bench.handle(&request, &mut Unobserved).ends);
    assert_eq!(bench.component.mode(), Mode::Terminated);
    bench.refused(
        "step",
        r#"{"req":"2"}"#,
        "state",
        "do_step is not allowed in mode Terminated; allowed in Stepping",
    );
    bench.refused(
        "run",
        r#"{"req":"3"}"#,
        "state",
        "not allowed in mode terminated",
    );
    assert!(bench.ok("get", "")["outputs"]["mass.present"].is_number());
}

#[test]
fn a_step_that_fails_says_so_and_going_back_heals() {
    let scene = sandgate::scene::load(&python::root().join("tests/scenes/no_floor.toml")).unwrap();
    let mut bench = Bench {
        component: Component::new(&scene).unwrap(),
        protocol: Protocol::new(BASE, None),
    };
    bench
        .protocol
        .begin(&mut bench.component, &mut Unobserved, "test")
        .unwrap();
    let saved = bench.ok("save", "");
    bench.refused(
        "step",
        r#"{"req":"1","dt_ns":5000000000}"#,
        "diverged",
        "step failed",
    );
    assert_eq!(bench.ok("status", "")["mode"], "failed");
    bench.refused(
        "step",
        r#"{"req":"2"}"#,
        "state",
        "do_step is not allowed in mode Failed; allowed in Stepping",
    );
    bench.refused("run", r#"{"req":"3"}"#, "state", "reset or restore first");
    assert!(bench.ok("get", "")["outputs"]["time"].is_number());
    let restore = json!({"req": "4", "state": saved["state"]}).to_string();
    assert_eq!(bench.ok("restore", &restore)["mode"], "stepping");
    assert_eq!(bench.ok("step", r#"{"req":"5"}"#)["step"], 1);
}

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
fn a_panic_becomes_a_reply_and_a_reset_heals() {
    let mut bench = Bench::new();
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
}

#[test]
fn describe_tells_all_that_a_client_needs() {
    let mut bench = Bench::new();
    let reply = bench.ok("describe", "");
    assert_eq!(
        (&reply["key"], &reply["dt_ns"]),
        (&json!(BASE), &json!(5_000_000))
    );
    let gate = reply["variables"]
        .as_array()
        .unwrap()
        .iter()
        .find(|v| v["name"] == GATE)
        .unwrap();
    assert_eq!(
        (&gate["causality"], &gate["min"], &gate["max"]),
        (&json!("input"), &json!(0.0), &json!(1.0))
    );
    let all = bench.ok("get", "");
    let named = reply["variables"].as_array().unwrap().len();
    assert_eq!(all["outputs"].as_object().unwrap().len(), named);
    assert_eq!(
        all["outputs"]["gauge.surface.depth"]
            .as_array()
            .unwrap()
            .len(),
        4
    );
    assert_eq!(all["outputs"]["gate.main.blocked"], false);
    assert_eq!(all["outputs"]["gauge.level.validity"], 0);
}

#[test]
fn a_listener_that_others_can_reach_is_refused_unless_it_is_meant() {
    let open = |listen: &[&str], file: Option<&str>| {
        let folder = temp_dir::TempDir::new().unwrap();
        let options = ServeOptions {
            instance: "small_silo".into(),
            listen: listen.iter().map(|e| (*e).to_owned()).collect(),
            config: file.map(|text| {
                let path = folder.path().join("zenoh.json5");
                std::fs::write(&path, text).unwrap();
                ZenohConfig::File(path)
            }),
            ..ServeOptions::default()
        };
        Server::open(silo(), &options, &mut Unobserved)
    };
    for refused in [
        open(&["tcp/0.0.0.0:0"], None),
        open(&["tcp/127.0.0.1:0", "tcp/[::]:0"], None),
        open(
            &[],
            Some("{listen: {endpoints: {peer: ['tcp/0.0.0.0:0']}}}"),
        ),
    ] {
        let message = refused.err().unwrap().to_string();
        assert!(message.contains("--allow-open-listener"), "{message}");
    }
    let broken = open(&[], Some("{listen: 7}")).err().unwrap();
    assert!(matches!(broken, BusError::Config { .. }), "{broken}");
    let server = open(&[], Some("{listen: {endpoints: ['tcp/127.0.0.2:0']}}")).unwrap();
    assert!(server.listeners()[0].starts_with("tcp/127.0.0.2:"));
    let server = open(&[], None).unwrap();
    let listener = &server.listeners()[0];
    assert!(
        listener.starts_with("tcp/127.0.0.1:") && !listener.ends_with(":0"),
        "{listener}"
    );
}

#[test]
fn python_clients_watch_and_drive_a_served_silo() {
    let program = env!("CARGO_BIN_EXE_sandgate");
    python::pytest("test_bus.py", &[("SANDGATE", OsStr::new(program))]);
}

#[test]
fn a_subscriber_that_takes_nothing_holds_up_nobody() {
    let program = env!("CARGO_BIN_EXE_sandgate");
    let environment = [("SANDGATE", OsStr::new(program))];
    python::pytest("test_slow_subscribers.py", &environment);
}

#[test]
fn the_examples_do_what_they_say() {
    let program = env!("CARGO_BIN_EXE_sandgate");
    // `cargo test --test it` builds no examples.
    python::run(
        "cargo build --example bus_client",
        std::process::Command::new(env!("CARGO"))
            .args(["build", "--release", "--example", "bus_client"])
            .arg("--target-dir")
            .arg(python::target())
            .current_dir(python::root()),
        "the client in Rust builds",
    );
    let client = python::target().join("release/examples/bus_client");
    python::pytest(
        "test_examples.py",
        &[
            ("SANDGATE", OsStr::new(program)),
            ("SANDGATE_RUST_CLIENT", client.as_os_str()),
        ],
    );
}
