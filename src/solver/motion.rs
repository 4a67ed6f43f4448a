//! Particles move, stay inside, and find their neighbours again.

use crate::math::Vector;
use crate::state::State;

use super::outputs::three;
use super::{Solver, SolverError};

/// How far beyond the domain a particle may be, over the spacing: as far as boxes and sections that end on a wall's face reach behind it.
/// What a wall on the domain's side holds under tension may be drawn into its face by some hundredths.
pub const SLACK: f64 = 0.25;

impl<const D: usize> Solver<D> {
    /// v and x to the end of the step (symplectic Euler; `last` is its last acoustic step), and what diffusion and shifting do to
    /// density before lists may reorder rows.
    pub(super) fn move_grains(
        &mut self,
        state: &mut State<D>,
        dt: f64,
        last: f64,
    ) -> Result<(), SolverError> {
        let (new, prediction) = (&self.viscous.velocity, &self.prediction);
        let is_bad = |i: usize| !new[i].iter().all(|c| c.is_finite());
        if let Some(bad) = self.workers.first_bad(new.len(), is_bad) {
            return Err(self.not_finite(state, "velocity", |n| n != bad));
        }
        let grains = &mut state.grains;
        self.before.clone_from(&grains.position);
        let (x, v) = (&mut grains.position, &mut grains.velocity);
        let (shift, way) = (&self.shift, self.acoustic.way());
        self.workers.both(x, v, |i, x, v| {
            *v = new[i];
            for k in 0..D {
                x[k] += last * v[k];
            }
            if let Some(way) = way.get(i) {
                for k in 0..D {
                    x[k] += way[k];
                }
            }
            if let Some(shift) = shift.get(i) {
                for k in 0..D {
                    x[k] += dt * shift[k];
                }
            }
            []
        });
        self.note_accelerations(state, dt);
        let grains = &mut state.grains;
        let divergence = &self.shift_divergence;
        self.workers.each(&mut grains.density, |i, rho| {
            *rho += last * prediction[i].diffusion;
            if let Some(divergence) = divergence.get(i) {
                *rho *= (-dt * divergence).exp();
            }
        });
        if self.geometry.is_axisymmetric() {
            for i in 0..grains.len() {
                if grains.position[i][0] < 0.0 {
                    grains.mirror(i);
                }
            }
        }
        Ok(())
    }

    pub(super) fn wrap(&self, position: &mut [Vector<D>]) {
        if self.periodic.length.iter().any(|l| *l > 0.0) {
            self.workers.each(position, |_, x| self.periodic.wrap(x));
        }
    }

    /// Periodic sides, and the check that nothing is lost.
    pub(super) fn keep_inside(&self, state: &mut State<D>) -> Result<(), SolverError> {
        let grains = &mut state.grains;
        self.wrap(&mut grains.position);
        let slack = SLACK * self.numerics.spacing;
        let rings = self.geometry.is_axisymmetric();
        let is_lost = |i: usize| {
            let x = &grains.position[i];
            let inside = (0..D).all(|k| {
                // Rings have no place behind their axis.
                let is_axis = k == 0 && rings && self.lower[0] <= 0.0;
                let below = if is_axis { 0.0 } else { slack };
                self.periodic.length[k] > 0.0
                    || (x[k] >= self.lower[k] - below && x[k] <= self.upper[k] + slack)
            });
            !inside && !grains.drained[i]
        };
        match self.workers.first_bad(grains.len(), is_lost) {
            None => Ok(()),
            Some(i) => Err(SolverError::Lost {
                particle: grains.id[i],
                time: state.time,
                position: three(&grains.position[i]),
                velocity: three(&grains.velocity[i]),
            }),
        }
    }

    /// Periodic sides and lists that hold, after a move of the reference schemes, whose walls stand still.
    pub(super) fn settle(&mut self, state: &mut State<D>) -> Result<(), SolverError> {
        self.keep_inside(state)?;
        let walled = !self.walls.is_empty();
        if self
            .lists
            .outdated(&state.grains, &self.periodic, 0.0, walled, &self.workers)
        {
            self.renew_lists(state);
        }
        Ok(())
    }

    pub(super) fn sweep_kinematics_in_valid_lists(&mut self, state: &mut State<D>, renew: bool) {
        let travel = self
            .plates
            .iter()
            .zip(&state.gates)
            .map(|(p, g)| (g.opening - g.listed_opening).abs() * p.length)
            .fold(0.0, f64::max);
        let travel = travel.max(self.travel_of_walls(state));
        let travel = travel.max(self.travel_of_streams(state));
        // What comes to rest must not lean on what an outflow took.
        let lean = state.rest.quiet_steps > 0 && state.grains.drained.contains(&true);
        if renew
            || lean
            || self.lists.outdated(
                &state.grains,
                &self.periodic,
                travel,
                !self.walls.is_empty(),
                &self.workers,
            )
        {
            self.renew_lists(state);
        }
        let grains = &mut state.grains;
        grains.swept_density.clone_from(&grains.density);
        self.sweep_kinematics(state);
    }

    pub(super) fn renew_lists(&mut self, state: &mut State<D>) {
        self.lists.sort(&mut state.grains, &self.periodic);
        state.pose.listed = state.pose.now;
        for drive in &mut state.drives {
            drive.listed_way = drive.way;
        }
        for gate in &mut state.gates {
            gate.listed_opening = gate.opening;
        }
        for inflow in &mut state.inflows {
            inflow.listed_advance = inflow.advance;
        }
        for (plate, gate) in self.plates.iter().zip(&state.gates) {
            plate.place(&mut self.walls, gate.opening, gate.rate);
        }
        self.build_lists(state);
        if self.resize_rings(state) {
            self.lists.sort(&mut state.grains, &self.periodic);
            self.build_lists(state);
        }
    }

    /// Builds lists from the noted positions and the walls where they are.
    pub(super) fn build_lists(&mut self, state: &State<D>) {
        self.lists.build(
            &state.grains,
            &self.walls,
            &self.periodic,
            (&self.workers, self.arch),
        );
    }
}

#[cfg(test)]
mod tests {
    use crate::material::Material;
    use crate::math::Geometry;
    use crate::solver::{Solver, sample};

    /// In motion a drained row stays as long as lists hold; what comes to rest beside it would lean on it for good.
    #[test]
    fn what_an_outflow_took_goes_before_anything_rests() {
        let plane = Geometry::Planar { width: 1.0 };
        let (plan, mut state) = sample::disordered::<2>(Material::sand_04(), plane, 14, 0.0);
        let mut solver = Solver::new(plan, 1);
        solver.start(&mut state);
        state.grains.drained[100] = true;
        solver.sweep_kinematics_in_valid_lists(&mut state, false);
        assert_eq!(state.grains.len(), 196);
        state.rest.quiet_steps = 1;
        solver.sweep_kinematics_in_valid_lists(&mut state, false);
        assert_eq!(state.grains.len(), 195);
        assert!(!state.grains.drained.contains(&true));
    }
}
