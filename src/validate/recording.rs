//! What a member leaves behind: series, particles at some times, and what it cost.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Outcome {
    /// Not at its end yet.
    Running,
    /// At its end time.
    Finished,
    /// A step failed, with the reason: a result too, the same at every repetition.
    Failed(String),
}

/// Particles at one time, single precision as in [`crate::component::ParticleView`]; one entry a particle.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Snapshot {
    /// Time [s].
    pub time: f64,
    /// Positions [m].
    pub position: Vec<[f32; 3]>,
    /// Velocities [m/s].
    pub velocity: Vec<[f32; 3]>,
    /// Pressures [Pa].
    pub pressure: Vec<f32>,
    /// Inertial numbers [1].
    pub inertial_number: Vec<f32>,
}

/// A member's results.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recording {
    /// Hash of scene, plan and sources.
    pub key: String,
    /// [`super::SOURCES`] of the program that computed it.
    pub sources: String,
    /// How it ended.
    pub outcome: Outcome,
    /// Communication points [s].
    pub time: Vec<f64>,
    /// Values at these points by variable: one entry a point, each with all flat values.
    pub series: BTreeMap<String, Vec<Vec<f64>>>,
    /// Particles, in order of time.
    pub snapshots: Vec<Snapshot>,
    /// Particles at the start.
    pub particles: u64,
    /// Internal steps.
    pub steps: u64,
    /// Iterations of viscous solves.
    pub iterations: u64,
    /// CPU time of stepping, of all its threads [s].
    pub cpu: f64,
    /// Most threads that it had.
    #[serde(default = "one")]
    pub threads: usize,
}

fn one() -> usize {
    1
}

impl Recording {
    /// A recording that has not begun.
    #[must_use]
    pub fn empty(key: String) -> Self {
        Self {
            key,
            sources: super::SOURCES.to_owned(),
            outcome: Outcome::Running,
            time: Vec::new(),
            series: BTreeMap::new(),
            snapshots: Vec::new(),
            particles: 0,
            steps: 0,
            iterations: 0,
            cpu: 0.0,
            threads: 1,
        }
    }

    /// Whether it reached its end time.
    #[must_use]
    pub fn is_finished(&self) -> bool {
        self.outcome == Outcome::Finished
    }

    /// A scalar over time: (time [s], value), empty if it was not kept.
    #[must_use]
    pub fn curve(&self, variable: &str) -> Vec<(f64, f64)> {
        let values = self.series.get(variable).map_or(&[][..], Vec::as_slice);
        let first = |v: &Vec<f64>| v.first().copied().unwrap_or(f64::NAN);
        self.time
            .iter()
            .copied()
            .zip(values.iter().map(first))
            .collect()
    }

    /// All values of a variable at the communication point nearest to a time [s].
    #[must_use]
    pub fn values_at(&self, variable: &str, time: f64) -> Option<&[f64]> {
        let nearest = (0..self.time.len()).min_by(|&a, &b| {
            let far = |i: usize| (self.time[i] - time).abs();
            far(a).total_cmp(&far(b))
        })?;
        self.series.get(variable)?.get(nearest).map(Vec::as_slice)
    }

    /// A scalar at the communication point nearest to a time [s].
    #[must_use]
    pub fn at(&self, variable: &str, time: f64) -> Option<f64> {
        self.values_at(variable, time)?.first().copied()
    }

    /// A scalar at the end.
    #[must_use]
    pub fn last(&self, variable: &str) -> Option<f64> {
        self.series.get(variable)?.last()?.first().copied()
    }
}
