//! Balance of momentum and energy of a run, from outside: sums over particles against gravity, the forces that gauges of
//! walls and gates report, what flows in, and how walls and gates move.

use crate::component::{Component, Totals, ValueReference};
use crate::scene::{Dimension, ForceTarget, Scene};
use crate::solver::Scheme;

use super::forces;
use super::walls::length;

/// What was so before a step.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Before {
    /// Sums over particles.
    pub(super) totals: Totals,
    /// Mass present and mass that came in [kg].
    pub(super) mass: f64,
    pub(super) inflow: f64,
    /// Openings of all gates, and whether material held or slowed each in the last step.
    pub(super) openings: Vec<f64>,
    pub(super) blocked: Vec<bool>,
    /// How long each wall would have moved at its full speed to be where it is [s].
    pub(super) wall_times: Vec<f64>,
}

impl Before {
    /// Now.
    pub(super) fn of(component: &Component, totals: Totals) -> Self {
        let ledger = component.ledger();
        let table = component.variables();
        let read = |reference| {
            let mut value = [0.0];
            // What is of the component's own table can be read in every mode that a ride is in.
            let _ = component.get(&[reference], &mut value);
            value[0]
        };
        let gates = 0..component.scene().gates.len();
        Self {
            totals,
            mass: ledger.present,
            inflow: ledger.inflow,
            openings: gates
                .clone()
                .map(|g| read(table.actual_opening(g)))
                .collect(),
            blocked: gates.map(|g| read(table.gate_blocked(g)) != 0.0).collect(),
            wall_times: component.wall_times(),
        }
    }
}

/// What a step came to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    /// By how much momentum misses the impulses, and the largest of these [kg m/s]; `None` where it cannot be told.
    pub(super) momentum: Option<(f64, f64)>,
    /// Energy over what it may be without any error, over the scale of the start; `None` where it cannot be told.
    pub(super) energy: Option<f64>,
}

/// The account of a run.
pub(super) struct Balance<'a> {
    scene: &'a Scene,
    forces: Vec<(ForceTarget, Vec<ValueReference>)>,
    /// Whether every wall and gate has a gauge.
    complete: bool,
    /// Whether energy can be accounted for.
    energetic: bool,
    /// Ways of the step before, one a force [m].
    ways: Vec<[f64; 3]>,
    /// Whether steps are internal ones: see [`Balance::in_pieces`].
    in_pieces: bool,
    /// Energy at the start, with all work done since [J].
    budget: f64,
    /// M g H + kinetic energy of the start [J].
    scale: f64,
    /// Height of the material at the start along gravity, or that of the domain where there is none [m].
    height: f64,
    start: [f64; 3],
}

impl<'a> Balance<'a> {
    /// Of a scene at its start.
    pub(super) fn new(scene: &'a Scene, component: &Component, totals: &Totals, mass: f64) -> Self {
        let forces = forces::gauges(scene, component);
        let complete = forces.len() == scene.walls.len() + scene.gates.len();
        let g = &scene.domain.gravity;
        let wraps = (0..3).any(|k| scene.domain.periodic[k] && g[k] != 0.0);
        let turns = scene.walls.iter().any(|w| w.rotation.is_some());
        let moves = scene.walls.iter().any(|w| w.velocity != [0.0; 3]) || !scene.gates.is_empty();
        let (lower, upper) = if mass > 0.0 {
            (totals.lower, totals.upper)
        } else {
            (scene.domain.lower, scene.domain.upper)
        };
        let extent = (0..3)
            .map(|k| (g[k] * (upper[k] - lower[k])).abs())
            .sum::<f64>();
        let size = length(g, &[0.0; 3]);
        let height = if size > 0.0 {
            extent / size + scene.numerics.spacing
        } else {
            0.0
        };
        let mut balance = Self {
            scene,
            forces,
            complete,
            energetic: !wraps && !turns && (complete || !moves),
            ways: Vec::new(),
            in_pieces: false,
            budget: 0.0,
            scale: mass * size * height + totals.kinetic_energy,
            height,
            start: totals.momentum.map(|p| p / mass.max(f64::MIN_POSITIVE)),
        };
        balance.budget = balance.energy(totals, mass);
        balance.ways = vec![[0.0; 3]; balance.forces.len()];
        balance
    }

    /// For steps of about an internal one. A plate moves at the end of it, from where the force of this step was taken to
    /// where that of the next one will be: its work is the mean of both forces times its way, to the second order in the step.
    /// With the first force alone a plate that goes to and fro by dx gains -dx^2 dF/dx each time from nothing.
    pub(super) fn in_pieces(mut self) -> Self {
        self.in_pieces = true;
        self
    }

    /// Whether there are walls or gates.
    pub(super) fn has_walls(&self) -> bool {
        !(self.scene.walls.is_empty() && self.scene.gates.is_empty())
    }

    /// Mean velocity at the start [m/s].
    pub(super) fn start_velocity(&self) -> [f64; 3] {
        self.start
    }

    /// M g H of a mass, H the height at the start; kinetic energy of the start where there is no gravity [J].
    pub(super) fn scale(&self, mass: f64) -> f64 {
        let weight = mass * length(&self.scene.domain.gravity, &[0.0; 3]) * self.height;
        if weight > 0.0 {
            weight
        } else {
            self.scale.max(f64::MIN_POSITIVE)
        }
    }

    /// Kinetic and potential energy; potential energy is 0 at the domain's lowest corner, so that what leaves takes some away.
    fn energy(&self, totals: &Totals, mass: f64) -> f64 {
        let d = &self.scene.domain;
        let potential = |k: usize| {
            let least = (-d.gravity[k] * d.lower[k]).min(-d.gravity[k] * d.upper[k]);
            -d.gravity[k] * totals.moment[k] - mass * least
        };
        totals.kinetic_energy + (0..3).map(potential).sum::<f64>()
    }

    /// Potential energy of a unit of mass from the domain's lowest to its highest corner [J/kg].
    fn fall(&self) -> f64 {
        let d = &self.scene.domain;
        (0..3)
            .map(|k| (d.gravity[k] * (d.upper[k] - d.lower[k])).abs())
            .sum()
    }

    /// Height of the material at the start [m].
    pub(super) fn height(&self) -> f64 {
        self.height
    }

    /// Largest speed of any point of a wall [m/s].
    fn walls_speed(&self) -> f64 {
        let d = &self.scene.domain;
        let reach = length(&d.lower, &d.upper);
        let speed = |w: &crate::scene::Wall| {
            let turns = w.rotation.map_or(0.0, |r| r.rate.abs() * reach);
            length(&w.velocity, &[0.0; 3]) + turns
        };
        self.scene.walls.iter().map(speed).fold(0.0, f64::max)
    }

    /// What a fall through the domain, the start, walls, gates and inflows can give a particle by a time [m/s].
    pub(super) fn speed(&self, time: f64) -> f64 {
        let scene = self.scene;
        let none = [0.0; 3];
        let d = &scene.domain;
        let fall = (2.0 * self.fall()).sqrt();
        let along: f64 = (0..3)
            .filter(|k| d.periodic[*k])
            .map(|k| d.gravity[k].abs() * time)
            .sum();
        let most = |speeds: &mut dyn Iterator<Item = f64>| speeds.fold(0.0, f64::max);
        let bodies = most(&mut scene.bodies.iter().map(|b| {
            let profile = match b.profile {
                crate::scene::VelocityProfile::Uniform => 0.0,
                crate::scene::VelocityProfile::Bagnold => scene.numerics.sound_speed / 10.0,
            };
            length(&b.velocity, &none) + profile
        }));
        let walls = self.walls_speed();
        // Plates slide: what they push goes before their edge.
        let gates = most(&mut scene.gates.iter().map(|g| g.max_speed));
        let inflows = most(&mut scene.inflows.iter().map(|i| length(&i.velocity, &none)));
        // Without gravity and motion there is still the noise of the starting lattice.
        fall + along + bodies + walls + gates + inflows + 0.01 * scene.numerics.sound_speed
    }

    /// Accounts for a communication step of h.
    pub(super) fn step(
        &mut self,
        component: &Component,
        before: &Before,
        now: &Before,
        h: f64,
    ) -> Found {
        let scene = self.scene;
        let mut impulse = scene.domain.gravity.map(|g| g * now.mass * h);
        let mut largest = length(&impulse, &[0.0; 3]);
        // Share of a way's work that waits for the next force, and how much of it does.
        let later = if self.in_pieces { 0.5 } else { 0.0 };
        let mut open = 0.0;
        for ((target, references), last) in self.forces.iter().zip(&mut self.ways) {
            let mut force = [0.0; 3];
            let count = references.len().min(3);
            // These handles came from its own table: it knows them.
            let _ = component.get(&references[..count], &mut force[..count]);
            let way = forces::way(scene, *target, (before, now), h);
            for k in 0..3 {
                impulse[k] -= force[k] * h;
                self.budget -= force[k] * ((1.0 - later) * way[k] + later * last[k]);
                open += later * force[k] * way[k];
            }
            *last = way;
            largest = largest.max(length(&force, &[0.0; 3]) * h);
        }
        let entered = now.inflow - before.inflow;
        let inflow = scene.inflows.iter().map(|i| length(&i.velocity, &[0.0; 3]));
        let fastest = inflow.fold(0.0, f64::max);
        // Its own energy, and the work of pushing it in against the weight of the highest column.
        self.budget += entered * (0.5 * fastest * fastest + 2.0 * self.fall());
        if self.scale <= 0.0 {
            self.scale = self.scale(now.mass);
        }
        let energy = self.energetic.then(|| {
            let over = self.energy(&now.totals, now.mass) - (self.budget - open);
            over / self.scale.max(self.scale(now.mass))
        });
        Found {
            momentum: self.momentum(before, now, impulse, largest),
            energy,
        }
    }

    fn momentum(
        &self,
        before: &Before,
        now: &Before,
        impulse: [f64; 3],
        largest: f64,
    ) -> Option<(f64, f64)> {
        let flows = !(self.scene.inflows.is_empty() && self.scene.outflows.is_empty());
        let reference = self.scene.numerics.scheme != Scheme::Implicit;
        if flows || !self.complete || reference || now.mass <= 0.0 {
            return None;
        }
        // Hoop stress makes radial momentum.
        let ring = self.scene.dimension == Dimension::Axisymmetric;
        let axes = if ring { 1..2 } else { 0..3 };
        let miss = axes
            .map(|k| {
                let change = now.totals.momentum[k] - before.totals.momentum[k];
                (change - impulse[k]).powi(2)
            })
            .sum::<f64>()
            .sqrt();
        let scale = if self.has_walls() {
            // Rounding of the sums.
            largest + 1e-4 * now.totals.momentum_scale
        } else {
            now.totals.momentum_scale.max(largest)
        };
        Some((miss, scale))
    }

    /// What dilatancy may add to the energy, over M g H: the pressure of (M3) depends on the shear rate, so that material
    /// that is sheared loosens, from phi_max to phi_min at most, and lifts what lies above; half of the weight is above.
    pub(super) fn dilatancy(&self) -> f64 {
        let loosest = self.scene.materials.iter().map(|m| {
            if m.material.grains.diameter > 0.0 {
                m.material.grains.phi_max / m.material.grains.phi_min - 1.0
            } else {
                0.0
            }
        });
        0.5 * loosest.fold(0.0, f64::max)
    }
}
