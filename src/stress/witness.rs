//! Looks at a component after every communication step and holds it against the checks.

mod motion;
mod rests;

use crate::component::{Component, MassLedger, Totals, ValueReference, VariableTable};
use crate::scene::{InputTarget, Scene};

use super::Drive;
use super::balance::{Balance, Before};
use super::checks::{Check, Failure};
use super::ride::{Done, Ride};
use super::run::Figures;

/// Share of a communication step's impulses by which momentum may miss them, without walls of the sum of mass times speed.
const MOMENTUM: f64 = 1e-9;

/// Growth of energy without any cause, over the potential energy of the material's height: elastic energy at the Mach
/// number of the scheme, and sampling.
const ENERGY: f64 = 0.01;

/// What it knows of a run so far.
pub(super) struct Witness<'a> {
    scene: &'a Scene,
    drive: &'a Drive,
    balance: Balance<'a>,
    outputs: Vec<ValueReference>,
    values: Vec<f64>,
    /// Mass at the start.
    initial: f64,
    before: Before,
    slept: bool,
    steps: u64,
    /// Centre of mass at half of the run, for rests.
    half: Option<[f64; 3]>,
    /// What was found.
    pub(super) failures: Vec<Failure>,
    /// What was measured.
    pub(super) figures: Figures,
}

/// Handles of all outputs, and how many values they have.
fn outputs(table: &VariableTable) -> (Vec<ValueReference>, usize) {
    use crate::component::Causality;
    let rows = table.rows().iter();
    let outputs = rows.filter(|row| row.causality == Causality::Output);
    let (mut references, mut count) = (Vec::new(), 0);
    for row in outputs {
        references.push(row.reference);
        count += row.len();
    }
    (references, count)
}

impl<'a> Witness<'a> {
    /// Before the first step.
    pub(super) fn new(ride: &Ride<'a>, drive: &'a Drive) -> Self {
        let (scene, component) = (ride.scene(), &ride.component);
        let (outputs, count) = outputs(component.variables());
        let totals = component.totals();
        let ledger = component.ledger();
        Self {
            scene,
            drive,
            balance: Balance::new(scene, component, &totals, ledger.present),
            outputs,
            values: vec![0.0; count],
            initial: ledger.initial,
            before: Before::of(component, totals),
            slept: false,
            steps: 0,
            half: None,
            failures: Vec::new(),
            figures: Figures {
                particles: component.statistics().particles,
                ..Figures::default()
            },
        }
    }

    /// For communication steps of about an internal one: see [`Balance::in_pieces`].
    pub(super) fn in_pieces(mut self) -> Self {
        self.balance = self.balance.in_pieces();
        self
    }

    fn fail(&mut self, check: Check, time: f64, what: impl std::fmt::Display) {
        // The first of each kind says what happened; the rest follows from it.
        if self.failures.iter().all(|f| f.check != check) {
            self.failures.push(Failure::at(check, time, what));
        }
    }

    /// After a communication step that was told `wanted`.
    pub(super) fn look(
        &mut self,
        component: &Component,
        done: &Done,
        start: f64,
        wanted: &[(InputTarget, f64)],
    ) {
        let totals = component.totals();
        let ledger = component.ledger();
        let time = component.time();
        let now = Before::of(component, totals);
        self.figures.simulated = time;
        self.figures.particles = self.figures.particles.max(component.statistics().particles);
        self.check_time(done, start, time);
        self.check_finite(component, &totals, time);
        self.check_mass(&ledger, time);
        if self.failures.iter().any(|f| f.check == Check::Finite) {
            return;
        }
        self.check_balance(component, &now, done, start, time);
        self.check_speed(component, time);
        self.check_leak(component, time);
        self.check_step_size(done, time);
        self.check_sleep(component, &now, wanted, time);
        self.check_gates(&now, wanted, time - start, time);
        self.check_rest(&totals, ledger.present, time);
        if self.drive.falls {
            self.check_fall(&totals, ledger.present, time);
        }
        // Of what is left: nothing reaches nowhere.
        if totals.upper[0].is_finite() {
            self.figures.reach = totals.upper[0];
        }
        self.figures.kinetic = totals.kinetic_energy / self.balance.scale(ledger.present);
        self.before = now;
        self.slept = is_asleep(component);
        self.figures.slept |= self.slept;
        self.steps = component.steps();
    }

    fn check_time(&mut self, done: &Done, start: f64, time: f64) {
        let end = start + done.asked;
        if done.report.time.to_bits() != time.to_bits()
            || (!done.report.ended_early && time.to_bits() != end.to_bits())
        {
            self.fail(
                Check::Time,
                time,
                format!("asked for {end:?}, reported {:?}", done.report.time),
            );
        }
    }

    fn check_finite(&mut self, component: &Component, totals: &Totals, time: f64) {
        if let Err(error) = component.get(&self.outputs, &mut self.values) {
            self.fail(
                Check::Finite,
                time,
                format!("outputs cannot be read: {error}"),
            );
            return;
        }
        let sums = [totals.kinetic_energy, totals.momentum_scale];
        if let Some(value) = self.values.iter().chain(&sums).find(|v| !v.is_finite()) {
            let value = *value;
            self.fail(Check::Finite, time, format!("an output is {value}"));
        }
    }

    fn check_mass(&mut self, ledger: &MassLedger, time: f64) {
        if ledger.error() != 0.0 || ledger.initial != self.initial || ledger.present < 0.0 {
            self.fail(Check::Mass, time, format!("{ledger:?}"));
        }
    }

    /// Momentum and energy.
    fn check_balance(
        &mut self,
        component: &Component,
        now: &Before,
        done: &Done,
        start: f64,
        time: f64,
    ) {
        let found = self
            .balance
            .step(component, &self.before, now, time - start);
        // What falls asleep is stopped: that is no force.
        let fell_asleep = is_asleep(component) && !self.slept;
        if let Some((miss, scale)) = found.momentum
            && !fell_asleep
        {
            let allowed = MOMENTUM * scale;
            let share = miss / allowed.max(f64::MIN_POSITIVE);
            self.figures.momentum_error = self.figures.momentum_error.max(share);
            if share > 1.0 {
                self.fail(
                    Check::Momentum,
                    time,
                    format!(
                        "in a step of {} s momentum misses the impulses by {miss:.3e} kg m/s, the largest is {scale:.3e}; \
                         allowed {allowed:.3e}",
                        done.asked
                    ),
                );
            }
        }
        if let Some(excess) = found.energy {
            self.figures.energy_excess = self.figures.energy_excess.max(excess);
            let allowed = ENERGY + self.balance.dilatancy();
            if excess > allowed {
                self.fail(
                    Check::Energy,
                    time,
                    format!("energy grew by {excess:.3} of M g H + kinetic energy at the start, allowed {allowed:.3}"),
                );
            }
        }
    }

    /// Counts a step for the figures.
    pub(super) fn count(&mut self, done: &Done) {
        self.figures.communication_steps += 1;
        self.figures.internal_steps += done.report.substeps;
    }
}

/// Whether all particles sleep.
pub(super) fn is_asleep(component: &Component) -> bool {
    let asleep = component.particles().asleep;
    !asleep.is_empty() && asleep.iter().all(|a| *a == 1)
}
