//! State, solver and gauges of a scene in D dimensions: the one implementation of [`Engine`].

mod sight;
mod solids;

use std::sync::OnceLock;

use super::engine::{
    Advance, Devices, DriveReading, Engine, GateState, InflowState, Inputs, SolverError,
};
use super::sampling::Sampler;
use super::saved::Saved;
use super::{Error, MassLedger, ParticleView, Statistics, Totals, figures};
use crate::boundary::Steers;
use crate::gauge::Reading;
use crate::math::{Geometry, Vector};
use crate::scene::{self, Dimension, Scene, WallDrive};
use crate::solver::{Solver, StaysAwake, StepInputs, three};
use crate::state::{RestState, State};
use solids::Solids;

struct Simulation<const D: usize> {
    state: State<D>,
    solver: Solver<D>,
    sampler: Sampler<D>,
    /// Surfaces of walls and gates, for gauges.
    solids: Solids<D>,
    /// Readings of a scene that sleeps: they do not change until it wakes.
    still: OnceLock<Vec<Reading>>,
    /// Internal steps done when the communication step began, if the scene slept then.
    slept_at: Option<u64>,
    /// What [`Engine::back_to_kept`] goes back to.
    kept: Option<Saved<D>>,
    devices: Devices,
    /// Largest rate of each inflow [kg/s].
    most_rate: Vec<f64>,
    drives: Vec<WallDrive>,
    /// Of each wall the number of its drive.
    wall_drives: Vec<Option<usize>>,
    spacing: f64,
    geometry: Geometry,
    lower: Vector<D>,
    upper: Vector<D>,
    periodic: [Option<(f64, f64)>; D],
}

/// Builds particles, walls, devices and gauges of a scene.
///
/// # Errors
/// [`Error::Setup`] if the scene cannot be built.
pub(crate) fn build(scene: &Scene) -> Result<Box<dyn Engine>, Error> {
    match scene.dimension {
        Dimension::Two | Dimension::Axisymmetric => Ok(Box::new(Simulation::<2>::new(scene)?)),
        Dimension::Three => Ok(Box::new(Simulation::<3>::new(scene)?)),
    }
}

impl<const D: usize> Simulation<D> {
    fn new(scene: &Scene) -> Result<Self, Error> {
        let (plan, mut state) = scene::build::<D>(scene).map_err(Error::Setup)?;
        let (lower, upper) = (plan.lower, plan.upper);
        let periodic =
            std::array::from_fn(|k| (plan.periodic.length[k] > 0.0).then(|| (lower[k], upper[k])));
        let mut solver = Solver::new(plan, 1);
        solver.start(&mut state);
        let solids = Solids::new(scene, periodic);
        let spacing = scene.numerics.spacing;
        let sampler = Sampler::new(scene).into_walls(spacing, |x| solids.holds(x));
        let mut simulation = Self {
            state,
            solver,
            sampler,
            solids,
            still: OnceLock::new(),
            slept_at: None,
            kept: None,
            devices: Devices::default(),
            most_rate: scene.inflows.iter().map(|i| i.max_rate).collect(),
            drives: scene.drives().map(|(_, drive)| drive.clone()).collect(),
            wall_drives: (0..scene.walls.len()).map(|n| scene.drive_of(n)).collect(),
            spacing,
            geometry: scene::geometry(scene),
            lower,
            upper,
            periodic,
        };
        simulation.refresh_devices();
        Ok(simulation)
    }

    fn refresh_devices(&mut self) {
        let state = &self.state;
        let (walls, others) = state.impulse.split_at(self.wall_drives.len());
        let (gates, moments) = others.split_at(state.gates.len());
        self.devices = Devices {
            gates: state
                .gates
                .iter()
                .zip(gates)
                .map(|(g, i)| GateState {
                    opening: g.opening,
                    blocked: g.blocked,
                    impulse: three(i),
                })
                .collect(),
            inflows: state
                .inflows
                .iter()
                .map(|i| InflowState {
                    mass: i.admitted,
                    blocked: i.blocked,
                })
                .collect(),
            drives: state
                .drives
                .iter()
                .zip(&self.drives)
                .map(|(at, drive)| DriveReading {
                    speed: at.rate * drive.full,
                    position: (at.way * drive.full).clamp(drive.stops.0, drive.stops.1),
                    is_told_place: drive.steers == Steers::Way,
                })
                .collect(),
            outflow_mass: state.drained.clone(),
            wall_impulse: walls.iter().map(three).collect(),
            moment: moments.iter().map(three).collect(),
        };
    }

    /// One internal step.
    fn advance_once(
        &mut self,
        (start, end): (f64, f64),
        inputs: &Inputs,
        report: &mut Advance,
    ) -> Result<(), crate::solver::SolverError> {
        let elapsed = self.state.time - start;
        // A slope may lead out of the range, by rounding or where inputs are saturated.
        let openings = inputs.gate_opening.iter();
        let openings: Vec<f64> = openings.map(|r| r.at(elapsed).clamp(0.0, 1.0)).collect();
        let rates = inputs.inflow_rate.iter().zip(&self.most_rate);
        let rates: Vec<f64> = rates
            .map(|(r, most)| r.at(elapsed).clamp(0.0, *most))
            .collect();
        let drives = inputs.wall_drive.iter().zip(&self.drives);
        let drives: Vec<(f64, f64)> = drives
            .map(|(r, drive)| {
                let (least, most) = drive.range();
                let told = r.at(elapsed).clamp(least, most);
                (told / drive.full, r.slope / drive.full)
            })
            .collect();
        let Self {
            state,
            solver,
            sampler,
            ..
        } = self;
        let counts = sampler.counts();
        let done = solver.step(
            state,
            end,
            &StepInputs {
                openings: &openings,
                rates: &rates,
                drives: &drives,
            },
            &mut |before, grains| {
                if counts {
                    sampler.count(before, grains);
                }
            },
        )?;
        report.add(&done);
        // The last of equal steps ends at the end; rounding does not add another.
        if end - self.state.time < 1e-9 * done.dt {
            self.state.time = end;
        }
        Ok(())
    }

    /// Internal steps happened: what was read before them is stale.
    fn refresh(&mut self) {
        // A scene that woke and fell asleep again has done steps; sleeping does none.
        if self.slept_at != Some(self.state.steps) {
            self.still = OnceLock::new();
        }
        self.refresh_devices();
    }

    /// Goes to a state of this scene.
    fn take_over(&mut self, saved: Saved<D>) {
        self.solver.renew_threads();
        self.sampler.set_crossed(&saved.crossed);
        self.state = saved.state;
        self.still = OnceLock::new();
        // What was kept may be of another course of events.
        self.kept = None;
        self.slept_at = None;
        self.solver.resume(&self.state);
        self.refresh_devices();
    }

    fn failed(&self, error: &crate::solver::SolverError) -> SolverError {
        SolverError {
            what: error.to_string(),
        }
    }
}

impl<const D: usize> Engine for Simulation<D> {
    fn advance(&mut self, start: f64, end: f64, inputs: &Inputs) -> Result<Advance, SolverError> {
        self.begin(start, inputs);
        let workers = self.solver.workers();
        let rows = self.state.grains.len();
        let mut report = Advance::none();
        let advanced = workers.install(rows, || {
            while self.state.time < end {
                self.advance_once((start, end), inputs, &mut report)?;
            }
            Ok(())
        });
        advanced.map_err(|e| self.failed(&e))?;
        self.refresh();
        Ok(report)
    }

    fn begin(&mut self, start: f64, inputs: &Inputs) {
        self.solver.renew_threads();
        self.sampler.begin_step();
        self.slept_at = self.state.rest.asleep.then_some(self.state.steps);
        for impulse in &mut self.state.impulse {
            *impulse = [0.0; D];
        }
        self.state.forget_blocked();
        self.state.time = start;
        if inputs.all().any(|r| r.slope != 0.0) {
            // What changes within the step would come too late for a sleeper.
            self.state.rest = RestState::default();
        }
    }

    fn substep(
        &mut self,
        span: (f64, f64),
        inputs: &Inputs,
        advance: &mut Advance,
    ) -> Result<f64, SolverError> {
        let workers = self.solver.workers();
        let rows = self.state.grains.len();
        workers
            .install(rows, || self.advance_once(span, inputs, advance))
            .map_err(|e| self.failed(&e))?;
        self.refresh();
        Ok(self.state.time.min(span.1))
    }

    fn devices(&self) -> &Devices {
        &self.devices
    }

    fn sample(&self, step: f64) -> Vec<Reading> {
        if let Some(still) = self.still.get() {
            return self.sampler.sample_still(still, &self.devices, step);
        }
        let readings = self.readings(step);
        if self.state.rest.asleep {
            self.still.get_or_init(|| readings.clone());
        }
        readings
    }

    fn save(&self) -> Result<Vec<u8>, String> {
        Saved::encode(&self.state, &self.sampler)
    }

    fn restore(&mut self, bytes: &[u8]) -> Result<(), String> {
        let saved = Saved::decode(bytes, &self.state, &self.solver, &self.sampler)?;
        // As many counts as there are sections, as was just checked.
        self.take_over(saved);
        Ok(())
    }

    fn check(&self, bytes: &[u8]) -> Result<(), String> {
        Saved::decode(bytes, &self.state, &self.solver, &self.sampler).map(drop)
    }

    fn keep(&mut self) {
        // What was kept goes first: there are never three copies.
        let kept = self.kept.take();
        let slept = self.state.rest.asleep && self.slept_at == Some(self.state.steps);
        let same = kept.filter(|kept| slept && kept.state.steps == self.state.steps);
        self.kept = Some(match same {
            // Sleep moves no particle, and they are nearly all that there is to copy.
            Some(kept) => kept.slept_on(&mut self.state, &self.sampler),
            None => Saved::of(&self.state, &self.sampler),
        });
    }

    fn back_to_kept(&mut self) -> bool {
        let kept = self.kept.take();
        kept.map(|kept| self.take_over(kept)).is_some()
    }

    fn ledger(&self) -> MassLedger {
        figures::ledger(&self.state)
    }

    fn statistics(&self) -> Statistics {
        figures::statistics(&self.state, &self.solver)
    }

    fn totals(&self) -> Totals {
        figures::totals(&self.state.grains)
    }

    fn particles(&self) -> ParticleView {
        figures::particles(&self.state, &self.solver)
    }

    fn steps(&self) -> u64 {
        self.state.steps
    }

    fn stays_awake(&self) -> Option<StaysAwake> {
        self.solver.stays_awake()
    }

    fn inflow_pushes(&self, inflow: usize) -> bool {
        self.solver.inflow_pushes(inflow)
    }

    fn wall_points(&self) -> Vec<[f64; 3]> {
        let walls = self.solver.walls();
        walls
            .position
            .iter()
            .zip(&walls.weight)
            .filter(|(_, w)| **w > 0.0)
            .map(|(x, _)| three(x))
            .collect()
    }

    fn wall_shares(&self) -> Vec<f64> {
        let weights = self.solver.walls().weight.iter().copied();
        weights.filter(|w| *w > 0.0).collect()
    }

    fn wall_times(&self) -> Vec<f64> {
        let way = |drive: Option<usize>| match drive {
            Some(drive) => self.state.drives[drive].way,
            None => self.state.pose.now,
        };
        self.wall_drives.iter().map(|drive| way(*drive)).collect()
    }

    fn set_threads(&mut self, threads: usize) {
        self.solver.set_threads(threads);
    }
}
