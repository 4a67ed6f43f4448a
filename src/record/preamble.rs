//! What stands first in a log: which scene, version and seed, the scene's text, and the state it starts from.

use super::error::RecordError;
use super::file::LogFile;
use super::options::RecordOptions;
use super::place::Place;
use crate::component::{Component, Mode};
use crate::units::hex;
use crate::wire::convert::nanoseconds;
use std::collections::BTreeMap;

/// Metadata "run" and "segment" and the attachments: first in the file, so that they survive a crash.
pub(super) fn write_preamble(
    file: &mut LogFile,
    component: &Component,
    options: &RecordOptions,
    place: Option<&Place>,
) -> Result<(), RecordError> {
    let scene = component.scene();
    let begins = options.begins.unwrap_or(component.time());
    let run = [
        ("scene", scene.name.clone()),
        ("title", scene.title.clone()),
        ("scene_hash", hex(&scene.fingerprint())),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("instance", options.instance.clone()),
        ("seed", scene.numerics.seed.to_string()),
        ("precision", "f64".to_owned()),
        ("communication_step", scene.run.step.to_string()),
        ("deterministic", options.deterministic.to_string()),
    ];
    let mut run = owned(run);
    run.extend(in_use(component));
    file.metadata("run", run);
    let begin = [
        ("epoch", place.map_or(0, |p| p.epoch).to_string()),
        ("number", place.map_or(0, |p| p.number).to_string()),
        ("reason", options.reason.clone()),
        ("time", begins.to_string()),
    ];
    file.metadata("segment", owned(begin));
    let time = nanoseconds(begins);
    file.attachment(
        "scene.toml",
        "application/toml",
        time,
        scene.source.as_bytes(),
    );
    for (name, media_type, data) in &options.attachments {
        file.attachment(name, media_type, time, data);
    }
    if has_state(component) {
        let state = component.save()?;
        file.attachment("start.state", "application/octet-stream", time, &state);
    }
    Ok(())
}

/// The particle spacing, and the parameters that are not the scene's, as they are now: those of an FMU may be set after its log began,
/// so that they stand at a log's end, too.
pub(super) fn in_use(component: &Component) -> BTreeMap<String, String> {
    let spacing = component.scene().numerics.spacing.to_string();
    let mut all = owned([("spacing", spacing)]);
    let changed = component.changed_parameters();
    let changed: Vec<_> = changed.map(|(n, v)| format!("{n} = {v}")).collect();
    if !changed.is_empty() {
        all.insert("parameters".to_owned(), changed.join(", "));
    }
    all
}

/// Whether the component is past its start, so that the scene alone does not say what it is.
pub(super) fn has_state(component: &Component) -> bool {
    !matches!(component.mode(), Mode::Instantiated | Mode::Initialization)
}

pub(super) fn owned<const N: usize>(pairs: [(&str, String); N]) -> BTreeMap<String, String> {
    pairs.into_iter().map(|(k, v)| (k.to_owned(), v)).collect()
}
