//! Sleep: a scene in which nothing has moved for a while is not computed until an input asks for something.
//!
//! Quiet is a step in which the root mean square of speeds is below 3e-5 of the speed of a fall from the scene's height, sqrt(g H),
//! no particle is faster than 1e-3 of it, gates are where they should be, and nothing flows in. A sound speed that was raised for
//! other reasons makes no flow slow.
//! A window is [`QUIET_STEPS`] of them in a row. Once forces on walls agree in two windows that follow each other, the
//! particles stand still and time passes in one step, forces as they were: grains come to rest long before friction has
//! settled what each wall carries (docs/theory.md, "Sleep").
//! A gate or a steered wall told to move or an inflow told to run wakes the scene. Scenes with walls that move unsteered or without walls never sleep, nor do
//! those with a material that would still have some way to go at such speeds.

use crate::boundary::WallPoints;
use crate::material::{Law, Material};
use crate::math::{Vector, dot, norm, scale, sub};
use crate::state::{Grains, RestState, State};

use super::devices::course;
use super::{Numerics, Scheme, Solver, StepBound, StepInputs, SubStep};

/// Quiet steps of a window: friction settles by solves, and a wave crosses 100 h meanwhile or more.
const QUIET_STEPS: u32 = 200;

/// Most by which a steady force on a wall changes from one window to the next, over itself [1].
const FORCE_DRIFT: f64 = 1e-3;

/// Share of the largest force that smaller forces are measured by [1].
const FORCE_FLOOR: f64 = 0.1;

/// Root mean square speed of a quiet scene, over sqrt(g H) [1].
const QUIET_SPEED: f64 = 3e-5;

/// Speed that no particle of a quiet scene has, over sqrt(g H) [1]: grains without load may jitter on a surface for long, but what
/// falls is faster before a scene sleeps.
const FASTEST: f64 = 1e-3;

/// Most viscosity of a material that sleeps, over rho sqrt(g H^3) [1].
///
/// A Bingham fluid's last way goes as 1/t: at the speed v it has H sqrt(eta v/(rho g H^2)) before it, 5e-5 H here.
const MOST_VISCOUS: f64 = 1e-4;

/// Why a scene never sleeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StaysAwake {
    /// It is not to, or its scheme does not.
    SwitchedOff,
    /// Nothing to rest on.
    NoWalls,
    /// Walls that move.
    MovingWalls,
    /// A material that would still have some way to go at the speeds of a quiet scene: its number.
    Creeping(usize),
}

/// Whether a scene can sleep at all: something to rest on that stands, if only while it is told to, and no material that creeps. `steered` are
/// groups of walls.
pub(super) fn stays_awake<const D: usize>(
    numerics: &Numerics,
    gravity: &Vector<D>,
    walls: &WallPoints<D>,
    steered: &[u16],
    materials: &[Material],
) -> Option<StaysAwake> {
    if !numerics.sleep || numerics.scheme != Scheme::Implicit {
        return Some(StaysAwake::SwitchedOff);
    }
    if walls.is_empty() {
        return Some(StaysAwake::NoWalls);
    }
    let moves = walls.velocity.iter().zip(&walls.group);
    let mut unsteered = moves.filter(|(v, group)| **v != [0.0; D] && !steered.contains(*group));
    if unsteered.next().is_some() {
        return Some(StaysAwake::MovingWalls);
    }
    let inertia = numerics.fall_speed.powi(3) / norm(gravity);
    let creeps = materials.iter().position(|m| !stops_soon(m, inertia));
    creeps.map(StaysAwake::Creeping)
}

/// Whether what moves at the speed of a quiet scene is all but there; `inertia` is sqrt(g H^3) [m^2/s]. A law without a static
/// friction creeps under any load, and ever more slowly.
fn stops_soon(material: &Material, inertia: f64) -> bool {
    if matches!(material.law, Law::BarkerGray(_)) {
        return false;
    }
    let viscous = &material.viscous;
    let most = MOST_VISCOUS * material.rest_density() * inertia;
    viscous.consistency == 0.0 || (viscous.is_linear() && viscous.consistency <= most)
}

impl<const D: usize> Solver<D> {
    /// Whether a sleeping scene stays asleep under these inputs; wakes it otherwise.
    pub(super) fn stays_asleep(&self, state: &mut State<D>, inputs: &StepInputs<'_>) -> bool {
        if !state.rest.asleep {
            return false;
        }
        if self.is_left_alone(state, inputs) {
            return true;
        }
        state.rest = RestState::default();
        false
    }

    /// Lets time pass until `end`.
    pub(super) fn sleep_until(&self, state: &mut State<D>, end: f64) -> SubStep {
        let dt = end - state.time;
        for (impulse, force) in state.impulse.iter_mut().zip(&state.rest.force) {
            for k in 0..D {
                impulse[k] += dt * force[k];
            }
        }
        state.time = end;
        SubStep {
            dt,
            bound: StepBound::Asleep,
            iterations: 0,
        }
    }

    /// Counts quiet steps, quiet at both ends, after a step of length dt; `before` are the impulses at its beginning.
    pub(super) fn notice_rest(
        &self,
        state: &mut State<D>,
        inputs: &StepInputs<'_>,
        was_quiet: bool,
        before: &[[f64; D]],
        dt: f64,
    ) {
        if !(was_quiet && self.is_left_alone(state, inputs) && self.is_quiet(&state.grains)) {
            state.rest = RestState::default();
            return;
        }
        let rest = &mut state.rest;
        rest.quiet_steps += 1;
        rest.quiet_time += dt;
        rest.impulse.resize(before.len(), [0.0; D]);
        for (sum, (after, before)) in rest
            .impulse
            .iter_mut()
            .zip(state.impulse.iter().zip(before))
        {
            for k in 0..D {
                sum[k] += after[k] - before[k];
            }
        }
        if rest.quiet_steps < QUIET_STEPS {
            return;
        }
        let time = rest.quiet_time;
        let force = rest.impulse.iter().map(|sum| sum.map(|s| s / time));
        let mut force: Vec<_> = force.collect();
        // Moments, which come behind forces, have no say, and keep what they were: what walls are given of the weight is some 1e-4 of it.
        let walls = self.walls.groups.len();
        let earlier = rest.force.get(..walls).unwrap_or(&[]);
        let asleep = is_steady(earlier, &force[..walls]);
        if asleep {
            self.carry_weight(&state.grains, &mut force[..walls]);
        }
        *rest = RestState {
            asleep,
            force,
            ..RestState::default()
        };
        if asleep {
            state.grains.velocity.fill([0.0; D]);
        }
    }

    /// What stands still is carried: walls share what their forces lack of the weight, which is what momentum changed by in the window.
    fn carry_weight(&self, grains: &Grains<D>, force: &mut [Vector<D>]) {
        let mass: f64 = grains.mass.iter().sum();
        let mut lacks = scale(mass, &self.gravity);
        for f in force.iter() {
            lacks = sub(&lacks, f);
        }
        if self.geometry.is_axisymmetric() {
            // Hoop stress bears along the radius.
            lacks[0] = 0.0;
        }
        let total: f64 = force.iter().map(norm).sum();
        if total > 0.0 {
            for f in force {
                let share = norm(f) / total;
                *f = std::array::from_fn(|k| f[k] + share * lacks[k]);
            }
        }
    }

    /// Whether speeds are those of rest.
    pub(super) fn is_quiet(&self, grains: &Grains<D>) -> bool {
        let fall = self.numerics.fall_speed;
        let fast = (FASTEST * fall).powi(2);
        let (mut mass, mut twice_energy) = (0.0, 0.0);
        for (v, m) in grains.velocity.iter().zip(&grains.mass) {
            let v2 = dot(v, v);
            if v2 >= fast {
                return false;
            }
            mass += m;
            twice_energy += m * v2;
        }
        twice_energy < (QUIET_SPEED * fall).powi(2) * mass
    }

    /// Gates stand where they should, but for rounding, steered walls stand, and no inflow runs.
    fn is_left_alone(&self, state: &State<D>, inputs: &StepInputs<'_>) -> bool {
        let gates = state.gates.iter().zip(inputs.openings);
        gates
            .into_iter()
            .all(|(g, wanted)| (g.opening - wanted).abs() < 1e-9)
            && inputs.rates.iter().all(|r| *r == 0.0)
            && self
                .drives
                .iter()
                .zip(&state.drives)
                .zip(inputs.drives)
                .all(|((drive, at), wanted)| drive.rests(course(at), wanted.0))
    }
}

/// Whether the forces of two windows agree; `earlier` is empty if there was no window before.
fn is_steady<const D: usize>(earlier: &[Vector<D>], later: &[Vector<D>]) -> bool {
    let size = |f: &Vector<D>| dot(f, f).sqrt();
    let floor = FORCE_FLOOR * later.iter().map(size).fold(0.0, f64::max);
    earlier.len() == later.len()
        && earlier.iter().zip(later).all(|(a, b)| {
            let change = std::array::from_fn(|k| b[k] - a[k]);
            size(&change) <= FORCE_DRIFT * size(b).max(floor)
        })
}
