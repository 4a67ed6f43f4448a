//! The contract suite through the exported functions: FMI 2, FMI 3 and the plain C interface behave as the component.
//!
//! Drivers declare the functions as a C caller does and call them by name.
#![allow(
    clippy::undocumented_unsafe_blocks,
    reason = "each call below keeps the headers' contract"
)]

mod c_driver;
mod calls;
mod fmi2_driver;
mod fmi3_driver;
#[path = "../../tests/contract/mod.rs"]
mod suite;
mod updates;

use std::ffi::{CStr, CString, c_char, c_void};
use std::path::Path;
use std::sync::Mutex;

use sandgate::component::{Component, ValueKind, VariableTable};
use sandgate::scene::{self, Scene};

use crate::guard::packed;
use suite::{Outcome, Refusal, check_all};

/// `fmi3IntermediateUpdateCallback`.
type Update = extern "C" fn(*mut c_void, f64, bool, bool, bool, bool, *mut bool, *mut f64);

/// What the importer's logger was told since the last look.
type Messages = Box<Mutex<Vec<String>>>;

/// Adds a message; what loggers do.
fn note(environment: *mut c_void, message: *const c_char) {
    let messages = unsafe { &*environment.cast::<Mutex<Vec<String>>>() };
    let message = unsafe { CStr::from_ptr(message) };
    let message = message.to_str().expect("messages are UTF-8").to_owned();
    messages.lock().expect("no panic inside").push(message);
}

/// OK, or all messages of the call: an error without one is an error of ours.
fn outcome(status: i32, messages: &Mutex<Vec<String>>) -> Outcome<()> {
    let told = std::mem::take(&mut *messages.lock().expect("no panic inside"));
    match status {
        0 => Ok(()),
        3 if told.is_empty() => panic!("Error without a message"),
        3 => Err(Refusal::Message(told.join("\n").replace("%%", "%"))),
        other => panic!("status {other}, allowed 0 (OK) and 3 (Error)"),
    }
}

/// The scene that drivers are made for.
fn scene() -> Scene {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    scene::load(&root.join("tests/scenes/devices.toml")).expect("it loads")
}

/// Packs the scene, and gives its token.
fn pack(scene: &Scene, version: sandgate::fmi::FmiVersion) -> CString {
    packed::pack(&scene.source);
    // As importers have it: from the description of a component of the scene as it was packed.
    let scene = scene::parse("scene.toml", &scene.source).expect("a scene's source is a scene");
    let component = Component::new(&scene).expect("it builds");
    CString::new(sandgate::fmi::token(&component, version)).expect("no zero byte")
}

/// References of one kind, with the places of their values.
struct Group {
    kind: ValueKind,
    references: Vec<u32>,
    places: Vec<std::ops::Range<usize>>,
}

/// Groups by kind, reals first. Unknown references count as reals of one value.
fn groups(table: &VariableTable, references: &[u32]) -> Vec<Group> {
    let mut groups = [ValueKind::Real, ValueKind::Integer, ValueKind::Boolean].map(|kind| Group {
        kind,
        references: Vec::new(),
        places: Vec::new(),
    });
    let mut start = 0;
    for reference in references {
        let row = table.by_reference(*reference);
        let (kind, length) = row.map_or((ValueKind::Real, 1), |row| (row.kind, row.len()));
        let group = groups
            .iter_mut()
            .find(|g| g.kind == kind)
            .expect("all kinds are there");
        group.references.push(*reference);
        group.places.push(start..start + length);
        start += length;
    }
    groups
        .into_iter()
        .filter(|g| !g.references.is_empty())
        .collect()
}

#[test]
fn fmi_2_keeps_the_contract() {
    check_all(&|scene| Box::new(fmi2_driver::Fmi2::new(scene)), &scene());
}

#[test]
fn fmi_3_keeps_the_contract() {
    check_all(&|scene| Box::new(fmi3_driver::Fmi3::new(scene)), &scene());
}

#[test]
fn the_c_interface_keeps_the_contract() {
    check_all(&|scene| Box::new(c_driver::C::new(scene)), &scene());
}
