//! What `status` answers: a copy of the component's figures, taken between steps, so that it can be given at any time,
//! and the counters of what the bus had to refuse or drop.

use crate::component::{Component, MassLedger, Mode, Statistics};
use crate::wire::json::number;
use serde_json::{Map, Value, json};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Where the component stood after its last call.
#[derive(Clone, Debug, PartialEq)]
pub struct Status {
    /// Counts resets and restores.
    pub epoch: u64,
    /// Communication steps done.
    pub step: u64,
    /// Simulated time (ns).
    pub t_ns: i64,
    /// Where it is in its life.
    pub mode: Mode,
    /// Simulated over wall time if it runs freely (infinite: as fast as possible); none if it waits for `step`.
    pub free_running: Option<f64>,
    /// Whether inputs out of their range are clamped.
    pub saturates: bool,
    /// Account of material.
    pub ledger: MassLedger,
    /// Figures of the solver.
    pub statistics: Statistics,
}

/// Simulated time in whole nanoseconds, as the wire has it.
#[must_use]
pub(super) fn nanoseconds(time: f64) -> i64 {
    // `as` saturates, and times are finite.
    (time * 1e9).round() as i64
}

/// The mode as replies spell it.
#[must_use]
pub(super) fn mode_name(mode: Mode) -> &'static str {
    match mode {
        Mode::Instantiated => "instantiated",
        Mode::Initialization => "initialization",
        Mode::Stepping => "stepping",
        Mode::Terminated => "terminated",
        Mode::Failed => "failed",
    }
}

impl Status {
    /// Reads a component.
    #[must_use]
    pub fn of(component: &Component, epoch: u64, free_running: Option<f64>) -> Self {
        let statistics = component.statistics();
        Self {
            epoch,
            step: statistics.communication_steps,
            t_ns: nanoseconds(component.time()),
            mode: component.mode(),
            free_running,
            saturates: component.saturates_inputs(),
            ledger: component.ledger(),
            statistics,
        }
    }

    /// `epoch`, `step`, `t_ns`, `mode`: in every reply, also in refusals.
    #[must_use]
    pub(super) fn brief(&self) -> Map<String, Value> {
        let mut map = Map::new();
        map.insert("epoch".into(), self.epoch.into());
        map.insert("step".into(), self.step.into());
        map.insert("t_ns".into(), self.t_ns.into());
        map.insert("mode".into(), mode_name(self.mode).into());
        map
    }

    /// All figures beside the brief ones.
    #[must_use]
    pub(super) fn figures(&self) -> Map<String, Value> {
        let (ledger, figures) = (&self.ledger, &self.statistics);
        let value = json!({
            "free_running": self.free_running.is_some(),
            "realtime_factor": self.free_running.map_or(Value::Null, number),
            "ledger": {
                "initial": number(ledger.initial), "inflow": number(ledger.inflow),
                "outflow": number(ledger.outflow), "present": number(ledger.present),
                "error": number(ledger.error()),
            },
            "statistics": {
                "steps": figures.steps, "iterations": figures.iterations,
                "particles": figures.particles, "step_size": number(figures.step_size),
                "kinetic_energy": number(figures.kinetic_energy),
                "max_speed": number(figures.max_speed),
                "share_dilute": number(figures.share_dilute),
            },
        });
        match value {
            Value::Object(map) => map,
            _ => Map::new(),
        }
    }
}

/// What the threads of a server share. Locks are held for a copy only.
#[derive(Debug)]
pub(super) struct Shared {
    status: Mutex<Status>,
    busy: Mutex<Option<Busy>>,
    /// Why the log ended before its time, if it did.
    log_failure: Mutex<Option<String>>,
    /// Set-points refused since the start.
    pub(super) refused_set_points: AtomicU64,
    /// Publications dropped because the publishing thread was behind.
    pub(super) dropped_publications: AtomicU64,
    /// Calls that did not get into the log because the stepping thread was behind.
    pub(super) unlogged_calls: AtomicU64,
    /// Whether the orchestrator has been silent for too long.
    pub(super) orchestrator_lost: AtomicBool,
}

/// A call that is being carried out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Busy {
    /// What.
    pub(super) verb: &'static str,
    /// For whom.
    pub(super) client: String,
    /// Its identifier.
    pub(super) req: String,
}

impl Shared {
    pub(super) fn new(status: Status) -> Self {
        Self {
            status: Mutex::new(status),
            busy: Mutex::new(None),
            log_failure: Mutex::new(None),
            refused_set_points: AtomicU64::new(0),
            dropped_publications: AtomicU64::new(0),
            unlogged_calls: AtomicU64::new(0),
            orchestrator_lost: AtomicBool::new(false),
        }
    }

    pub(super) fn update(&self, status: Status) {
        *lock(&self.status) = status;
    }

    /// Whether inputs out of their range were clamped when the component was last looked at.
    pub(super) fn saturates(&self) -> bool {
        lock(&self.status).saturates
    }

    pub(super) fn set_saturates(&self, saturates: bool) {
        lock(&self.status).saturates = saturates;
    }

    pub(super) fn has_log_failure(&self) -> bool {
        lock(&self.log_failure).is_some()
    }

    pub(super) fn set_log_failure(&self, failure: Option<String>) {
        *lock(&self.log_failure) = failure;
    }

    pub(super) fn set_busy(&self, busy: Option<Busy>) {
        *lock(&self.busy) = busy;
    }

    pub(super) fn status(&self) -> Status {
        lock(&self.status).clone()
    }

    /// What a server adds to `status`.
    pub(super) fn live(&self) -> Map<String, Value> {
        let busy = lock(&self.busy).clone();
        let mut map = Map::new();
        map.insert(
            "busy".into(),
            busy.map_or(
                Value::Null,
                |b| json!({"verb": b.verb, "client": b.client, "req": b.req}),
            ),
        );
        for (name, counter) in [
            ("refused_set_points", &self.refused_set_points),
            ("dropped_publications", &self.dropped_publications),
            ("unlogged_calls", &self.unlogged_calls),
        ] {
            map.insert(name.into(), counter.load(Relaxed).into());
        }
        let failure = lock(&self.log_failure).clone();
        map.insert("log_failure".into(), failure.into());
        let lost = self.orchestrator_lost.load(Relaxed);
        map.insert("orchestrator_lost".into(), lost.into());
        map
    }
}

/// A thread that panicked cannot have left these half-written: they are replaced whole.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
