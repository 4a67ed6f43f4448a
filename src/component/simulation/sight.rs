//! What gauges see of a simulation: particles of a material, or all, with one kind of pressure; and walls.

use super::Simulation;
use crate::component::engine::Engine as _;
use crate::component::sampling::Sight;
use crate::gauge::{Edge, Reading, View, is_outside};
use crate::math::Vector;
use crate::scene::PressureQuantity;
use crate::state::CellGrid;

/// Particles that gauges see: of one material, or all, with one kind of pressure.
struct Shown<const D: usize> {
    position: Vec<Vector<D>>,
    mass: Vec<f64>,
    density: Vec<f64>,
    pressure: Vec<f64>,
    /// Empty where no gauge reads it.
    velocity: Vec<Vector<D>>,
    cells: CellGrid<D>,
}

/// Particles near an interface of a material, and what passes between them.
struct Met<const D: usize> {
    material: u8,
    force: Vec<Vector<D>>,
    area: Vec<Vector<D>>,
    shear: Vec<f64>,
    is_inside: Vec<bool>,
    cells: CellGrid<D>,
}

impl<const D: usize> Simulation<D> {
    /// Readings of all gauges now, at the end of a communication step of this length [s].
    pub(super) fn readings(&self, step: f64) -> Vec<Reading> {
        let seen = self.sampler.seen();
        let solid = self.cells(&self.solid_points(!seen.is_empty()));
        let openings = self.state.gates.iter().map(|g| g.opening);
        let solids = self.solids.at(&self.wall_times(), openings);
        let shown: Vec<(Sight, Shown<D>)> = seen
            .into_iter()
            .map(|sight| (sight, self.show(sight)))
            .collect();
        let met: Vec<Met<D>> = self
            .sampler
            .edges()
            .into_iter()
            .map(|material| self.meet(material))
            .collect();
        let periodic = self.periodic.map(|p| p.is_some());
        let outside = |at: &Vector<D>| is_outside(at, (&self.lower, &self.upper), &periodic);
        let view = |sight: Sight| {
            // All that a gauge sees is shown.
            let place = shown.iter().position(|(s, _)| *s == sight);
            let shown = &shown[place.unwrap_or(0)].1;
            View {
                position: &shown.position,
                mass: &shown.mass,
                density: &shown.density,
                pressure: &shown.pressure,
                velocity: &shown.velocity,
                cells: &shown.cells,
                solid: &solid,
                solids: &solids,
                spacing: self.spacing,
                kernel: *self.solver.kernel(),
                geometry: self.geometry,
                lower: self.lower,
                upper: self.upper,
                periodic,
            }
        };
        let edge = |material: u8| {
            let place = met.iter().position(|m| m.material == material);
            let met = &met[place.unwrap_or(0)];
            Edge {
                force: &met.force,
                area: &met.area,
                shear: &met.shear,
                is_inside: &met.is_inside,
                cells: &met.cells,
            }
        };
        self.sampler
            .sample(view, edge, outside, (&self.devices, step))
    }

    /// Points of walls and gates that fill their place, where some gauge looks for them.
    fn solid_points(&self, wanted: bool) -> Vec<Vector<D>> {
        if !wanted {
            return Vec::new();
        }
        let walls = self.solver.walls();
        let whole = walls.position.iter().zip(&walls.weight);
        whole.filter(|(_, w)| **w > 0.5).map(|(x, _)| *x).collect()
    }

    /// Particles of a material, or all. Grains that an outflow has taken stay in the arrays until lists are rebuilt; gauges do
    /// not see them.
    fn show(&self, sight: Sight) -> Shown<D> {
        let grains = &self.state.grains;
        let material = sight.material;
        let (pressure, has) = self.pressures(sight.quantity);
        let is_seen = |i: &usize| {
            !grains.drained[*i] && has[*i] && material.is_none_or(|m| m == grains.phase[*i])
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
            velocity: match sight.moving {
                true => seen.iter().map(|&i| grains.velocity[i]).collect(),
                false => Vec::new(),
            },
        }
    }

    /// Particles that hand something to others across an interface of `material`.
    fn meet(&self, material: u8) -> Met<D> {
        let grains = &self.state.grains;
        let handed = self.solver.handed(&self.state, material);
        let shear: Vec<f64> = self.solver.shear_rates().collect();
        let near: Vec<usize> = (0..grains.len())
            .filter(|&i| handed[i].area != [0.0; D])
            .collect();
        let position: Vec<Vector<D>> = near.iter().map(|&i| grains.position[i]).collect();
        Met {
            material,
            force: near.iter().map(|&i| handed[i].force).collect(),
            area: near.iter().map(|&i| handed[i].area).collect(),
            shear: near.iter().map(|&i| shear[i]).collect(),
            is_inside: near.iter().map(|&i| grains.phase[i] == material).collect(),
            cells: self.cells(&position),
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
