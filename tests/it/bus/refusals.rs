//! What is refused, and that nothing happens then.

use super::{BASE, Bench, silo};
use crate::python;
use sandgate::bus::{BusError, Protocol, Request, ServeOptions, Server, Verb, ZenohConfig};
use sandgate::component::{Component, Mode};
use sandgate::wire::Unobserved;
use serde_json::json;

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
            "set",
            r#"{"req":"b13b","inputs":{"gate.main.opening":true}}"#,
            "type",
            "gate.main.opening: found true or false, allowed a number",
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
        "allowed in Stepping; a step has failed: restore a saved state or reset",
    );
    bench.refused("run", r#"{"req":"3"}"#, "state", "reset or restore first");
    assert!(bench.ok("get", "")["outputs"]["time"].is_number());
    let restore = json!({"req": "4", "state": saved["state"]}).to_string();
    assert_eq!(bench.ok("restore", &restore)["mode"], "stepping");
    assert_eq!(bench.ok("step", r#"{"req":"5"}"#)["step"], 1);
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
    let large = format!("{{listen: {{}} }} // {}", " ".repeat(4 << 20));
    let large = open(&[], Some(&large)).err().unwrap().to_string();
    assert!(large.contains("allowed 4194304"), "{large}");
    let endless = ServeOptions {
        instance: "small_silo".into(),
        config: Some(ZenohConfig::File("/dev/zero".into())),
        ..ServeOptions::default()
    };
    let endless = Server::open(silo(), &endless, &mut Unobserved)
        .err()
        .unwrap();
    let endless = endless.to_string();
    assert!(
        endless.contains("a folder, device or pipe, allowed a file"),
        "{endless}"
    );
    let broken = open(&[], Some("{listen: 7}")).err().unwrap();
    assert!(matches!(broken, BusError::Config { .. }), "{broken}");
    let server = open(&[], Some("{listen: {endpoints: ['tcp/127.0.0.2:0']}}")).unwrap();
    assert!(server.reach().listeners[0].starts_with("tcp/127.0.0.2:"));
    let server = open(&[], None).unwrap();
    let listener = &server.reach().listeners[0];
    assert!(
        listener.starts_with("tcp/127.0.0.1:") && !listener.ends_with(":0"),
        "{listener}"
    );
}
