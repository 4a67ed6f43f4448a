//! Work-precision studies: error against CPU time of a case over resolutions and numerical choices, one at a time, the
//! Pareto front of both, and the settings that are dominated by others.
//!
//! A [`Study`] makes scenes from settings and measures their error; [`measure`] runs what a stored run lacks.

mod front;
mod page;
mod studies;

pub use front::{Standing, standings};
pub use page::{MADE, csv, figure, text};
pub use studies::{STUDIES, Study, by_name};

use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::clock::timed;
use super::{Error, Machine};
use crate::component::{Component, next_point};
use crate::scene;
use crate::units::hex;
use crate::validate::SOURCES;

/// A numerical choice that differs from the defaults.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setting {
    /// Particles per length over those of the case [1].
    pub resolution: f64,
    /// Key of `[numerics]` and its value as TOML; none: defaults.
    pub change: Option<(&'static str, &'static str)>,
}

impl Setting {
    /// Its name: the key and value, or "defaults".
    #[must_use]
    pub fn name(&self) -> String {
        self.change.map_or("defaults".to_owned(), |(key, value)| {
            format!("{key} = {}", value.trim_matches('"'))
        })
    }
}

/// Choices tried beside the defaults at one resolution.
const CHANGES: [(&str, &str); 17] = [
    ("smoothing_ratio", "1.3"),
    ("smoothing_ratio", "2.0"),
    ("courant", "0.25"),
    ("courant", "0.5"),
    ("courant", "0.9"),
    ("acoustic_steps", "1"),
    ("solver_tolerance", "1e-2"),
    ("solver_tolerance", "1e-6"),
    ("yield_iterations", "3"),
    ("yield", "\"capped\""),
    ("pair_viscosity_share", "0.0"),
    ("pair_viscosity_share", "0.2"),
    ("density_diffusion", "0.0"),
    ("density_diffusion", "0.3"),
    ("sleep", "false"),
    ("quality", "\"draft\""),
    ("quality", "\"fine\""),
];

/// What one setting came to.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// Name of the study.
    pub study: String,
    /// Particles per length over those of the case [1].
    pub resolution: f64,
    /// Name of the setting.
    pub setting: String,
    /// Hash of scene and sources: what is the same is not run again.
    pub key: String,
    /// What was measured, in the study's unit; `None` if a step failed.
    pub value: Option<f64>,
    /// CPU time of all steps [s].
    pub cpu: f64,
    /// Particles at the end.
    pub particles: u64,
    /// Internal steps.
    pub steps: u64,
    /// Simulated time [s].
    pub simulated: f64,
}

/// A stored run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PrecisionRun {
    /// Where and when the last of it was measured.
    pub machine: Machine,
    /// All settings of all studies.
    pub measured: Vec<Measured>,
}

/// All settings of a study: defaults over resolutions, and every other choice at the case's own.
#[must_use]
pub fn settings(study: &Study) -> Vec<Setting> {
    let resolutions = study.resolutions.iter();
    let mut all: Vec<Setting> = resolutions
        .map(|&resolution| Setting {
            resolution,
            change: None,
        })
        .collect();
    all.extend(CHANGES.iter().map(|&change| Setting {
        resolution: 1.0,
        change: Some(change),
    }));
    all
}

/// Runs what `known` lacks of some studies. `watch` hears the share done and what is next; `keep` gets the run after each
/// setting; when `stop` becomes true no other is begun.
///
/// # Errors
/// [`Error::Scene`] for scenes that are refused: a defect; what `keep` says.
pub fn measure(
    chosen: &[&Study],
    known: Vec<Measured>,
    stop: &AtomicBool,
    watch: &mut dyn FnMut(f64, &str),
    keep: &mut dyn FnMut(&PrecisionRun) -> Result<(), Error>,
) -> Result<PrecisionRun, Error> {
    let mut run = PrecisionRun {
        machine: Machine::here(),
        measured: known,
    };
    let mut jobs = Vec::new();
    for study in chosen {
        for setting in settings(study) {
            let text = study.scene(&setting)?;
            // Particle steps go with the third power in the plane.
            jobs.push((
                *study,
                setting,
                text,
                study.cost * setting.resolution.powi(3),
            ));
        }
    }
    let total: f64 = jobs.iter().map(|(.., cost)| cost).sum();
    let mut done = 0.0;
    for (study, setting, text, cost) in jobs {
        if stop.load(Ordering::SeqCst) {
            break;
        }
        let key = key(&text);
        let what = format!("{} {} x{}", study.name, setting.name(), setting.resolution);
        watch(done / total, &what);
        if !run.measured.iter().any(|m| m.key == key) {
            let fresh = one(study, &setting, &text, key)?;
            let same = |m: &Measured| {
                m.study == fresh.study
                    && m.setting == fresh.setting
                    && m.resolution == fresh.resolution
            };
            run.measured.retain(|m| !same(m));
            run.measured.push(fresh);
            run.machine.finish();
            keep(&run)?;
        }
        done += cost;
    }
    Ok(run)
}

/// SHA-256 of scene and sources, in hexadecimal.
fn key(text: &str) -> String {
    let mut hash = Sha256::new();
    hash.update(SOURCES.as_bytes());
    hash.update(text.as_bytes());
    hex(&hash.finalize())
}

/// One setting, on one thread.
fn one(study: &Study, setting: &Setting, text: &str, key: String) -> Result<Measured, Error> {
    let refused = |why: String| Error::Scene {
        scene: study.name.to_owned(),
        why,
    };
    let scene = scene::parse(study.name, text).map_err(|e| refused(e.to_string()))?;
    let mut component = Component::new(&scene).map_err(|e| refused(e.to_string()))?;
    component
        .initialize(0.0, None)
        .map_err(|e| refused(e.to_string()))?;
    let (mut cpu, mut failed) = (0.0, false);
    let mut watch = study.begin(&component);
    while let Some(next) = next_point(component.time(), scene.run.step, scene.run.until) {
        let time = component.time();
        let (spent, step) = timed(|| component.do_step(time, next - time));
        cpu += spent;
        if step.is_err() {
            failed = true;
            break;
        }
        watch(&component);
    }
    let figures = component.statistics();
    Ok(Measured {
        study: study.name.to_owned(),
        resolution: setting.resolution,
        setting: setting.name(),
        key,
        value: (!failed)
            .then(|| study.value(&component, watch(&component)))
            .filter(|v| v.is_finite()),
        cpu,
        particles: figures.particles,
        steps: figures.steps,
        simulated: component.time(),
    })
}
