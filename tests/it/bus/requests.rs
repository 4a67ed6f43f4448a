//! Requests and set-points that do what they say, once.

use super::{BASE, Bench, GATE, opening, silo};
use sandgate::bus::SetPoint;
use sandgate::wire::Unobserved;
use serde_json::json;

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
        (GATE, "true", "allowed a number"),
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
