//! What a stepped solver lets others read.

use std::sync::Arc;

use crate::boundary::WallPoints;
use crate::kernel::WendlandC2;
use crate::material::Material;
use crate::math::{Vector, Workers};
use crate::state::State;

use super::{Scheme, Solver, StaysAwake};

impl<const D: usize> Solver<D> {
    /// Why the scene never sleeps; none if it may.
    #[must_use]
    pub fn stays_awake(&self) -> Option<StaysAwake> {
        self.stays_awake
    }

    /// Whether an inflow pushes what is before it: a fluid's, through a wall that stands (W13).
    #[must_use]
    pub fn inflow_pushes(&self, inflow: usize) -> bool {
        self.sources[inflow].piston.is_some()
    }

    /// Pressure of each particle [Pa].
    #[must_use]
    pub fn pressure(&self) -> &[f64] {
        &self.pressure
    }

    /// What momentum feels of the pressure of each particle: with bulk friction, where a material has it [Pa].
    pub(crate) fn normal_pressure(&self) -> &[f64] {
        if self.normal_pressure.is_empty() {
            &self.pressure
        } else {
            &self.normal_pressure
        }
    }

    /// Pore pressure of each particle of a state that this solver has just stepped, started or resumed [Pa]; 0 for what is
    /// not saturated.
    #[must_use]
    pub fn pore_pressure(&self, state: &State<D>, i: usize) -> f64 {
        if matches!(self.numerics.scheme, Scheme::PaperB(_)) {
            let material = &self.materials[state.grains.phase[i] as usize];
            return if material.is_saturated() {
                self.pressure[i] - self.effective[i]
            } else {
                0.0
            };
        }
        state
            .grains
            .pore_pressure
            .get(i)
            .map_or(0.0, |p| p.max(0.0))
    }

    /// Number of materials.
    #[must_use]
    pub fn materials(&self) -> usize {
        self.materials.len()
    }

    /// The material of a particle.
    #[must_use]
    pub fn material_of(&self, state: &State<D>, i: usize) -> &Material {
        &self.materials[state.grains.phase[i] as usize]
    }

    /// gamma of each particle [1/s], of the plain velocity gradient.
    pub fn shear_rates(&self) -> impl Iterator<Item = f64> + '_ {
        self.kinematics.iter().map(|k| k.shear)
    }

    /// Inertial number of each particle [1].
    #[must_use]
    pub fn inertial_number(&self) -> &[f64] {
        &self.inertial_number
    }

    /// Wall and gate points where they are now.
    #[must_use]
    pub fn walls(&self) -> &WallPoints<D> {
        &self.walls
    }

    /// The kernel.
    #[must_use]
    pub fn kernel(&self) -> &WendlandC2<D> {
        &self.kernel
    }

    /// Threads at work.
    #[must_use]
    pub fn workers(&self) -> Arc<Workers> {
        Arc::clone(&self.workers)
    }
}

/// A point as three numbers, for messages and pictures.
#[must_use]
pub fn three<const D: usize>(x: &Vector<D>) -> [f64; 3] {
    std::array::from_fn(|k| if k < D { x[k] } else { 0.0 })
}
