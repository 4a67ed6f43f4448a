//! What gauges see of a simulation: particles of a material, or all, with one kind of pressure; and walls.

use std::cell::OnceCell;

use super::Simulation;
use crate::component::sampling::{Shows, Sight};
use crate::gauge::{Reading, View};
use crate::math::Vector;
use crate::scene::PressureQuantity;
use crate::state::CellGrid;

/// Particles that gauges see: of one material, or all, with one kind of pressure.
struct Shown<const D: usize> {
    position: Vec<Vector<D>>,
    mass: Vec<f64>,
    density: Vec<f64>,
    pressure: Vec<f64>,
    cells: CellGrid<D>,
}

impl<const D: usize> Simulation<D> {
    /// Readings of all gauges now, at the end of a communication step of this length [s].
    pub(super) fn readings(&self, step: f64) -> Vec<Reading> {
        let walls = self.solver.walls();
        let solid: Vec<Vector<D>> = walls
            .position
            .iter()
            .zip(&walls.weight)
            .filter(|(_, w)| **w > 0.5)
            .map(|(x, _)| *x)
            .collect();
        let solid = self.cells(&solid);
        let openings = self.state.gates.iter().map(|g| g.opening);
        let solids = self.solids.at(self.state.pose.now, openings);
        // Of all ranks together.
        let stress = OnceCell::new();
        let shown: Vec<(Sight, Shown<D>)> = self
            .sampler
            .seen()
            .into_iter()
            .map(|sight| (sight, self.show(sight, &stress)))
            .collect();
        let view = |sight: Sight| {
            // All that a gauge sees is shown.
            let place = shown.iter().position(|(s, _)| *s == sight);
            let shown = &shown[place.unwrap_or(0)].1;
            View {
                position: &shown.position,
                mass: &shown.mass,
                density: &shown.density,
                pressure: &shown.pressure,
                cells: &shown.cells,
                solid: &solid,
                solids: &solids,
                spacing: self.spacing,
                kernel: *self.solver.kernel(),
                geometry: self.geometry,
                lower: self.lower,
                upper: self.upper,
                periodic: self.periodic.map(|p| p.is_some()),
            }
        };
        self.sampler.sample(view, &self.devices, step)
    }

    /// Particles of a material, or all. Grains that an outflow has taken stay in the arrays until lists are rebuilt; gauges do
    /// not see them.
    fn show(&self, sight: Sight, stress: &OnceCell<Vec<f64>>) -> Shown<D> {
        let grains = &self.state.grains;
        let material = sight.material;
        let (pressure, has): (Vec<f64>, Vec<bool>) = match sight.quantity {
            Shows::Pressure(quantity) => self.pressures(quantity),
            Shows::ShearStress => {
                let stress = stress.get_or_init(|| self.solver.shear_stress(&self.state));
                (stress.clone(), vec![true; stress.len()])
            }
        };
        let is_seen = |i: &usize| {
            let rank = || self.solver.material_of(&self.state, *i).rank();
            !grains.drained[*i]
                && has[*i]
                && material.is_none_or(|m| m == grains.phase[*i])
                && sight.rank.is_none_or(|r| r == rank())
        };
        let seen: Vec<usize> = (0..grains.len()).filter(is_seen).collect();
        let pick = |values: &[f64]| -> Vec<f64> { seen.iter().map(|&i| values[i]).collect() };
        let position: Vec<Vector<D>> = seen.iter().map(|&i| grains.position[i]).collect();
        Shown {
            cells: self.cells(&position),
            position,
            mass: pick(&grains.mass),
            density: pick(&grains.density),
            pressure: pick(&pressure),
        }
    }

    /// One kind of pressure of each particle [Pa], and whether it has that.
    fn pressures(&self, quantity: PressureQuantity) -> (Vec<f64>, Vec<bool>) {
        let all = 0..self.state.grains.len();
        let total = self.solver.pressure();
        match quantity {
            PressureQuantity::Total => (total.to_vec(), vec![true; total.len()]),
            PressureQuantity::Effective => {
                let is_grains = |i| !self.solver.material_of(&self.state, i).is_fluid();
                let effective = self.solver.effective_pressure().to_vec();
                (effective, all.map(is_grains).collect())
            }
            PressureQuantity::Pore => all
                .map(|i| {
                    let material = self.solver.material_of(&self.state, i);
                    if material.is_fluid() {
                        (total[i], true)
                    } else {
                        let pore = self.solver.pore_pressure(&self.state, i);
                        (pore, material.is_saturated())
                    }
                })
                .unzip(),
        }
    }

    fn cells(&self, points: &[Vector<D>]) -> CellGrid<D> {
        CellGrid::build(points, self.solver.kernel().support(), &self.periodic)
    }
}
