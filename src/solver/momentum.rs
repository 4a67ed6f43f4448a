//! What the viscous solve leaves of momentum (docs/theory.md, E9): (E9) holds to its tolerance only. Pieces that no wall pushes get it back,
//! walls bear what the others lost.

use crate::math::{Tensor, Vector, add, scale, sub};
use crate::state::State;

use super::Solver;
use super::implicit::Viscous;
use super::pair::WallRow;

impl<const D: usize> Solver<D> {
    /// Pieces that no wall pushes get back the momentum of v* exactly: the solve keeps it only to its tolerance.
    pub(super) fn restore_momentum(&self, state: &State<D>, work: &mut Viscous<D>) {
        let touching = self.lists.touching(|i, wall| {
            self.material_of(state, i).is_fluid() || self.is_pushed(i, wall, &work.stress(i))
        });
        if touching.contains(&false) {
            self.give_back(state, &touching, &mut work.velocity);
        }
        work.touching = touching;
    }

    fn give_back(&self, state: &State<D>, touching: &[bool], velocity: &mut [Vector<D>]) {
        // Rings keep momentum along their axis only.
        let first = usize::from(self.geometry.is_axisymmetric());
        let mut lost = vec![([0.0; D], 0.0); touching.len()];
        for (i, piece) in self.lists.pieces.iter().enumerate() {
            let m = state.grains.mass[i];
            let (momentum, mass) = &mut lost[*piece as usize];
            for k in first..D {
                momentum[k] += m * (self.prediction[i].velocity[k] - velocity[i][k]);
            }
            *mass += m;
        }
        for (i, piece) in self.lists.pieces.iter().enumerate() {
            if touching[*piece as usize] {
                continue;
            }
            let (momentum, mass) = &lost[*piece as usize];
            for k in first..D {
                velocity[i][k] += momentum[k] / mass;
            }
        }
    }

    /// What the viscous solve has taken from the momentum of all that touches walls [N s]. (E9) holds to its tolerance, and what touches no
    /// wall has the rest back already.
    pub(super) fn momentum_of_solve(&self, state: &State<D>) -> Vector<D> {
        let mut sum = [0.0; D];
        let pieces = self.lists.pieces.iter().enumerate();
        for (i, _) in pieces.filter(|(_, piece)| self.viscous.touching[**piece as usize]) {
            let change = sub(&self.prediction[i].velocity, &self.viscous.velocity[i]);
            sum = add(&sum, &scale(state.grains.mass[i], &change));
        }
        sum
    }

    /// Whether grains that see a wall get anything from it; loose ones, without pressure and stress, fly past.
    fn is_pushed(&self, i: usize, wall: &WallRow<D>, stress: &Tensor<D>) -> bool {
        let drag = self.numerics.pair_viscosity_share * self.pair_viscosity[i];
        let pressed = self.mean_pressure(i) != 0.0 || *stress != [[0.0; D]; D];
        pressed || drag != 0.0 || wall.barrier != 0.0 || wall.grip != [0.0; D]
    }
}
