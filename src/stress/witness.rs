//! Looks at a component after every communication step and holds it against the checks.

use crate::component::{Component, MassLedger, Totals, ValueReference, VariableTable};
use crate::scene::{ForceTarget, GaugeKind, InputTarget, Scene};
use crate::solver::Scheme;

use super::balance::{Balance, Before};
use super::checks::{Check, Failure};
use super::ride::{Done, Ride};
use super::run::Figures;
use super::{Drive, walls};

/// Share of a communication step's impulses by which momentum may miss them.
const MOMENTUM: f64 = 1e-4;

/// What a solve's residual, summed over all particles, may be: so many times its tolerance times the sum of mass times
/// speed against the walls, a step's fall at least.
const SOLVE: f64 = 3.0;

/// The same without walls, over the sum of mass times speed: rounding.
const FREE_MOMENTUM: f64 = 1e-9;

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
        self.check_gates(&now, done, wanted, time - start, time);
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
        self.steps = component.statistics().steps;
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
            // What the solve leaves of its residual in each internal step goes to the walls unseen.
            let steps = f64::from(done.report.substeps);
            let allowed = if self.balance.has_walls() {
                MOMENTUM * scale
                    + SOLVE * self.scene.numerics.solver_tolerance * steps * found.moving
            } else {
                FREE_MOMENTUM * scale
            };
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

    fn check_speed(&mut self, component: &Component, time: f64) {
        let allowed = 3.0 * self.balance.speed(time);
        let fastest = component.statistics().max_speed;
        self.figures.speed_share = self.figures.speed_share.max(fastest / allowed);
        if fastest > allowed {
            self.fail(
                Check::Speed,
                time,
                format!("a particle at {fastest:.3} m/s, allowed {allowed:.3} m/s"),
            );
        }
    }

    fn check_leak(&mut self, component: &Component, time: f64) {
        let spacing = self.scene.numerics.spacing;
        let view = component.particles();
        let axes = self.scene.dimension.axes();
        let (share, place) = walls::deepest(&view, &component.wall_points(), spacing, axes);
        self.figures.deepest = self.figures.deepest.max(share);
        if share > walls::MOST_WALL {
            self.fail(
                Check::Leak,
                time,
                format!(
                    "a particle at {place:?} m, whose neighbourhood is wall by {share:.2}, allowed {}",
                    walls::MOST_WALL
                ),
            );
        }
        if let Some((place, depth)) = walls::outside(&view, &self.drive.inside, spacing) {
            self.fail(
                Check::Leak,
                time,
                format!("a particle at {place:?} m, {depth:.2} dp outside the container"),
            );
        }
    }

    fn check_step_size(&mut self, done: &Done, time: f64) {
        let n = &self.scene.numerics;
        if n.scheme != Scheme::Implicit || self.slept {
            return;
        }
        let h = n.smoothing_ratio * n.spacing;
        let acoustic = n.courant * h / n.sound_speed;
        let motion = 0.2 * h / (6.0 * self.balance.speed(time)).max(f64::MIN_POSITIVE);
        let least = acoustic.min(motion).min(done.asked) / 3.0;
        let share = done.report.smallest_step / acoustic.min(done.asked);
        self.figures.least_step = if self.figures.least_step == 0.0 {
            share
        } else {
            self.figures.least_step.min(share)
        };
        if done.report.smallest_step < least {
            self.fail(
                Check::StepSize,
                time,
                format!(
                    "an internal step of {:e} s (bound by {}), allowed {least:e} s",
                    done.report.smallest_step,
                    done.report.bound_by.name()
                ),
            );
        }
    }

    /// A sleeping scene wakes when it is told something, and only then.
    fn check_sleep(
        &mut self,
        component: &Component,
        now: &Before,
        wanted: &[(InputTarget, f64)],
        time: f64,
    ) {
        if !self.slept {
            return;
        }
        let told = wanted.iter().any(|(input, value)| match input {
            InputTarget::GateOpening(i) => (self.before.openings[*i] - value).abs() > 1e-6,
            InputTarget::InflowRate(_) => *value > 0.0,
        });
        let worked = component.statistics().steps > self.steps;
        if told && !worked {
            self.fail(
                Check::Sleep,
                time,
                format!("told {wanted:?}, it slept on: no internal step was done"),
            );
        }
        if !told && (worked || now.totals.moment != self.before.totals.moment) {
            self.fail(
                Check::Sleep,
                time,
                "nothing was told and it did not sleep on".to_owned(),
            );
        }
    }

    fn check_gates(
        &mut self,
        now: &Before,
        done: &Done,
        wanted: &[(InputTarget, f64)],
        h: f64,
        time: f64,
    ) {
        let hs = self.scene.numerics.smoothing_ratio * self.scene.numerics.spacing;
        for (input, value) in wanted {
            let InputTarget::GateOpening(i) = input else {
                continue;
            };
            let gate = &self.scene.gates[*i];
            let length = walls::length(&gate.from, &gate.to);
            let (from, to) = (self.before.openings[*i], now.openings[*i]);
            let moved = (to - from) * length;
            let most = gate.max_speed * h * (1.0 + 1e-9) + 1e-12 * length;
            // A plate that closes may wait for grains; one that opens has nothing in its way.
            let steps = f64::from(done.report.substeps);
            let least = ((value - from) * length)
                .min(gate.max_speed * h)
                .min(0.1 * hs * steps)
                .max(0.0);
            let arrives = *value <= from || moved >= least * (1.0 - 1e-6) - 1e-9 * length;
            if !(0.0..=1.0).contains(&to) || moved.abs() > most || !arrives {
                self.fail(
                    Check::Gate,
                    time,
                    format!(
                        "gate {} told {value} went from {from} to {to} in {h} s, allowed at most {most} m{}",
                        gate.name,
                        if arrives { String::new() } else { format!(" and at least {least} m") }
                    ),
                );
            }
        }
    }

    fn check_rest(&mut self, totals: &Totals, mass: f64, time: f64) {
        if !self.drive.rest || mass <= 0.0 {
            return;
        }
        let centre = totals.moment.map(|m| m / mass);
        let Some(half) = self.half else {
            // Half of the communication steps, or of the internal ones where those run out first.
            let late = self.figures.communication_steps + 1 >= self.drive.count as u64 / 2
                || self.figures.internal_steps >= self.drive.most_steps / 2;
            self.half = late.then_some(centre);
            return;
        };
        let moved = walls::length(&half, &centre) / self.scene.numerics.spacing;
        let energy = totals.kinetic_energy / self.balance.scale(mass);
        self.figures.creep = self.figures.creep.max(moved);
        if moved > 0.01 || energy > 1e-5 {
            self.fail(
                Check::Rest,
                time,
                format!(
                    "the centre of mass moved by {moved:.2e} dp, allowed 0.01; kinetic energy is {energy:.2e} of M g H, allowed 1e-5"
                ),
            );
        }
    }

    /// A block that nothing touches falls at g, as one.
    fn check_fall(&mut self, totals: &Totals, mass: f64, time: f64) {
        let g = &self.scene.domain.gravity;
        let start = self.balance.start_velocity();
        let mean = totals.momentum.map(|p| p / mass);
        let miss: f64 = (0..3)
            .map(|k| (mean[k] - start[k] - g[k] * time).powi(2))
            .sum();
        let own = 2.0 * totals.kinetic_energy / mass - mean.iter().map(|v| v * v).sum::<f64>();
        let size = walls::length(g, &[0.0; 3]);
        let miss = miss.sqrt() / (size * time + walls::length(&start, &[0.0; 3]));
        // It starts with the pressure of its height, which has nothing to rest on: p = rho g H gives off p/(rho c0).
        let given = size * self.balance.height() / self.scene.numerics.sound_speed;
        let spread = own.max(0.0).sqrt() / given;
        if miss > 1e-9 || spread > 1.0 {
            self.fail(
                Check::Rest,
                time,
                format!("a block that falls misses g t by {miss:.2e} of it, allowed 1e-9; its grains differ by {spread:.2e} of what its pressure gives, allowed 1"),
            );
        }
    }

    /// Counts a step for the figures.
    pub(super) fn count(&mut self, done: &Done) {
        self.figures.communication_steps += 1;
        self.figures.internal_steps += u64::from(done.report.substeps);
    }
}

/// Whether all particles sleep.
pub(super) fn is_asleep(component: &Component) -> bool {
    let asleep = component.particles().asleep;
    !asleep.is_empty() && asleep.iter().all(|a| *a == 1)
}

/// Gauges of forces: on what, and the handle of each component.
pub(super) fn forces(
    scene: &Scene,
    component: &Component,
) -> Vec<(ForceTarget, Vec<ValueReference>)> {
    let handle = |gauge: &str, axis: &str| {
        let name = format!("gauge.{gauge}.force_{axis}");
        Some(component.variables().by_name(&name)?.reference)
    };
    let gauges = scene.gauges.iter();
    gauges
        .filter_map(|gauge| match &gauge.kind {
            GaugeKind::Force { on } => {
                let axes = ["x", "y", "z"].into_iter();
                Some((*on, axes.filter_map(|a| handle(&gauge.name, a)).collect()))
            }
            _ => None,
        })
        .collect()
}
