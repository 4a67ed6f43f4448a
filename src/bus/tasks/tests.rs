//! What waits, and what gives way to what.

use super::*;
use crate::bus::verb::Verb;
use crate::component::VariableTable;

const GATE: &str = "gate.sluice.opening";
const RATE: &str = "inflow.feed.rate";

fn empty() -> (Giver, Taker) {
    let text = include_str!("../../../tests/scenes/devices.toml");
    let scene = crate::scene::parse("devices.toml", text).unwrap();
    tasks(Settable::of(&VariableTable::of(&scene)))
}

struct Nobody;

impl Asked for Nobody {
    fn answer(self: Box<Self>, _: Reply) {}
}

fn call(req: usize) -> Task {
    let body = format!(r#"{{"req":"{req}"}}"#);
    Task::Call {
        request: Box::new(Request::parse(Verb::Step, body.as_bytes()).unwrap()),
        body,
        asked: Box::new(Nobody),
    }
}

/// What became of the older one, as text.
fn put(giver: &Giver, variable: &str, body: &str) -> Result<Option<String>, NoRoom> {
    let point = SetPoint::parse(variable, body.as_bytes()).unwrap();
    let superseded = giver.point(point, false)?;
    Ok(superseded.map(|point| shown(&point)))
}

fn shown(point: &SetPoint) -> String {
    format!("{} {}", point.variable, point.body)
}

fn all(taker: &Taker) -> Vec<String> {
    let tasks = taker.take_all().map(|task| match task {
        Task::Call { body, .. } => body,
        Task::SetPoint(point) => shown(&point),
    });
    tasks.collect()
}

#[test]
fn the_last_set_point_of_each_variable_waits_however_many_came() {
    let (giver, taker) = empty();
    assert_eq!(put(&giver, RATE, "0.25"), Ok(None));
    for k in 0..10_000 {
        let older = (k > 0).then(|| format!("{GATE} {}", f64::from(k - 1) * 1e-4));
        let body = (f64::from(k) * 1e-4).to_string();
        assert_eq!(put(&giver, GATE, &body), Ok(older));
    }
    let newest = format!("{GATE} {}", 9_999.0 * 1e-4);
    assert_eq!(all(&taker), [format!("{RATE} 0.25"), newest]);
}

#[test]
fn a_request_takes_what_came_before_it_and_nothing_later() {
    let (giver, taker) = empty();
    put(&giver, GATE, "0.1").unwrap();
    giver.call(call(1)).ok().unwrap();
    assert_eq!(put(&giver, GATE, "0.2"), Ok(None));
    assert_eq!(put(&giver, GATE, "0.3"), Ok(Some(format!("{GATE} 0.2"))));
    giver.call(call(2)).ok().unwrap();
    let told = [
        format!("{GATE} 0.1"),
        r#"{"req":"1"}"#.to_owned(),
        format!("{GATE} 0.3"),
        r#"{"req":"2"}"#.to_owned(),
    ];
    assert_eq!(all(&taker), told);
}

#[test]
fn what_will_be_refused_takes_no_place_of_what_will_be_taken() {
    let (giver, taker) = empty();
    put(&giver, GATE, "0.5").unwrap();
    for (variable, body) in [
        (GATE, "7"),
        (GATE, "[0.1,0.2]"),
        ("gate.none", "1"),
        ("gauge.past_gate.discharge", "1"),
    ] {
        assert_eq!(put(&giver, variable, body), Ok(None), "{variable} {body}");
    }
    for _ in 4..WAITING_ODD_POINTS {
        assert_eq!(put(&giver, "gate.none", "1"), Ok(None));
    }
    assert_eq!(put(&giver, "gate.none", "1"), Err(NoRoom::Full));
    // Where inputs are clamped, it is one like any other.
    let far = SetPoint::parse(GATE, b"7").unwrap();
    let older = giver.point(far, true).unwrap().unwrap();
    assert_eq!(shown(&older), format!("{GATE} 0.5"));
    assert_eq!(all(&taker).len(), WAITING_ODD_POINTS + 1);
}

#[test]
fn between_many_requests_older_set_points_give_way_and_the_newest_of_each_variable_waits() {
    let (giver, taker) = empty();
    put(&giver, RATE, "0.25").unwrap();
    for k in 0..WAITING_REQUESTS {
        let older = put(&giver, GATE, &format!("{}", k as f64 * 1e-3)).unwrap();
        assert_eq!(older.is_some(), k >= WAITING_SET_POINTS - 1, "{k}");
        giver.call(call(k)).ok().unwrap();
    }
    let (full, back) = giver.call(call(WAITING_REQUESTS)).err().unwrap();
    assert!(full == NoRoom::Full && matches!(back, Task::Call { .. }));
    let waiting = all(&taker);
    let points = waiting.iter().filter(|told| !told.starts_with('{'));
    assert_eq!(points.count(), WAITING_SET_POINTS);
    assert_eq!(waiting[0], format!("{RATE} 0.25"));
    assert_eq!(waiting[waiting.len() - 2], format!("{GATE} 0.255"));
}

#[test]
fn requests_wait_as_long_as_there_is_memory_for_their_bodies() {
    let (giver, taker) = empty();
    let long = |req| {
        let Task::Call { request, asked, .. } = call(req) else {
            panic!("a call is a call")
        };
        let body = String::from_utf8(vec![0; WAITING_BYTES / 2]).unwrap();
        Task::Call {
            request,
            body,
            asked,
        }
    };
    giver.call(long(1)).ok().unwrap();
    giver.call(long(2)).ok().unwrap();
    let (why, back) = giver.call(call(3)).err().unwrap();
    assert!(why == NoRoom::Heavy && matches!(back, Task::Call { .. }));
    // A set-point has room of its own.
    assert_eq!(put(&giver, GATE, "0.5"), Ok(None));
    assert!(taker.take(Duration::ZERO).is_ok());
    assert!(giver.call(call(3)).is_ok());
}

#[test]
fn who_takes_waits_for_so_long_and_ends_with_who_gives() {
    let (giver, taker) = empty();
    let none = taker.take(Duration::from_millis(1)).err();
    assert_eq!(none, Some(RecvTimeoutError::Timeout));
    put(&giver, GATE, "0.5").unwrap();
    drop(giver);
    assert!(taker.take(Duration::from_secs(60)).is_ok());
    let none = taker.take(Duration::from_secs(60)).err();
    assert_eq!(none, Some(RecvTimeoutError::Disconnected));
    let (giver, taker) = empty();
    drop(taker);
    assert_eq!(put(&giver, GATE, "0.5"), Err(NoRoom::Ended));
    assert!(matches!(giver.call(call(1)), Err((NoRoom::Ended, _))));
}
