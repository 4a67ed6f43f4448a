//! The bus: its protocol on a real component, without a network; then the program, served, driven by Python clients.

mod heard;
mod refusals;
mod requests;

use crate::python;
use sandgate::bus::{Protocol, Reply, Request, Verb};
use sandgate::component::{Component, ValueReference};
use sandgate::wire::{Observer, Unobserved};
use serde_json::Value;
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
