//! The contract suite on the component itself.

use crate::suite::{Driver, Outcome, Refusal, check_all};
use sandgate::component::{Component, Error, ValueReference};
use sandgate::scene::{self, Scene};

/// A scene of tests/scenes.
fn scene(name: &str) -> Scene {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/scenes")
        .join(name);
    scene::load(&path).unwrap_or_else(|why| panic!("{why}"))
}

struct Direct(Component);

fn refusal(error: Error) -> Refusal {
    Refusal::Message(error.to_string())
}

impl Driver for Direct {
    fn enter_initialization(&mut self, start: f64, stop: Option<f64>) -> Outcome<()> {
        self.0.enter_initialization(start, stop).map_err(refusal)
    }
    fn exit_initialization(&mut self) -> Outcome<()> {
        self.0.exit_initialization().map_err(refusal)
    }
    fn set(&mut self, references: &[ValueReference], values: &[f64]) -> Outcome<()> {
        self.0.set(references, values).map_err(refusal)
    }
    fn get(&mut self, references: &[ValueReference], count: usize) -> Outcome<Vec<f64>> {
        let mut values = vec![0.0; count];
        self.0.get(references, &mut values).map_err(refusal)?;
        Ok(values)
    }
    fn do_step(&mut self, t: f64, h: f64) -> Outcome<()> {
        self.0.do_step(t, h).map(drop).map_err(refusal)
    }
    fn save(&mut self) -> Outcome<Vec<u8>> {
        self.0.save().map_err(refusal)
    }
    fn restore(&mut self, bytes: &[u8]) -> Outcome<()> {
        self.0.restore(bytes).map_err(refusal)
    }
    fn reset(&mut self) -> Outcome<()> {
        self.0.reset().map_err(refusal)
    }
    fn terminate(&mut self) -> Outcome<()> {
        self.0.terminate().map_err(refusal)
    }
}

fn make(scene: &Scene) -> Box<dyn Driver> {
    Box::new(Direct(
        Component::new(scene).unwrap_or_else(|why| panic!("{why}")),
    ))
}

#[test]
fn component_keeps_the_contract_on_a_silo() {
    check_all(&make, &scene("small_silo.toml"));
}

#[test]
fn component_keeps_the_contract_with_every_device() {
    check_all(&make, &scene("devices.toml"));
}

#[test]
fn component_keeps_the_contract_in_space() {
    check_all(&make, &scene("devices_3d.toml"));
}
