//! What the viscous solve leaves of momentum (docs/theory.md, E9): (E9) holds to its tolerance only, and its stress near surfaces is not
//! central. Pieces that no wall pushes get momentum and angular momentum back as a rigid motion, walls bear what the others lost.

use crate::math::{Tensor, Vector, add, add_outer, apply, scale, sub, trace};
use crate::state::State;

use super::Solver;
use super::implicit::Viscous;
use super::pair::WallRow;
use super::turning::rotation;

/// Radius of gyration below which a piece has no rotation that can be told from rounding, over the spacing [1]: that of one particle.
const SMALL: f64 = 1e-3;

impl<const D: usize> Solver<D> {
    /// Pieces that no wall pushes get back the momentum and angular momentum of v* exactly.
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
        let mut lost = vec![Lost::NONE; touching.len()];
        let free = |i: usize| Some(self.lists.pieces[i] as usize).filter(|piece| !touching[*piece]);
        let (position, mass) = (&state.grains.position, &state.grains.mass);
        // A piece that reaches across a periodic side has no centre to turn about, and rings do not turn.
        let turns = !self.geometry.is_axisymmetric() && self.periodic.length == [0.0; D];
        for i in 0..mass.len() {
            if let Some(piece) = free(i) {
                let change = sub(&self.prediction[i].velocity, &velocity[i]);
                lost[piece].add(mass[i], &position[i], &change);
            }
        }
        for i in (0..mass.len()).filter(|_| turns) {
            if let Some(piece) = free(i) {
                let change = sub(&self.prediction[i].velocity, &velocity[i]);
                lost[piece].add_spin(mass[i], &position[i], &change);
            }
        }
        let least = (SMALL * self.numerics.spacing).powi(2);
        for piece in &mut lost {
            if trace(&piece.second) < least * piece.mass {
                piece.turned = [[0.0; D]; D];
            }
        }
        for i in 0..mass.len() {
            if let Some(piece) = free(i) {
                // Rings keep momentum along their axis only.
                let back = lost[piece].velocity_at(&position[i]);
                for k in usize::from(self.geometry.is_axisymmetric())..D {
                    velocity[i][k] += back[k];
                }
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

/// What a piece lost.
#[derive(Clone, Copy)]
struct Lost<const D: usize> {
    mass: f64,
    momentum: Vector<D>,
    /// Sum of m x [kg m].
    moment: Vector<D>,
    /// Sum of m x x^T about the centre of mass [kg m^2].
    second: Tensor<D>,
    /// Sum of m v x^T about it [kg m^2/s].
    turned: Tensor<D>,
}

impl<const D: usize> Lost<D> {
    const NONE: Self = Self {
        mass: 0.0,
        momentum: [0.0; D],
        moment: [0.0; D],
        second: [[0.0; D]; D],
        turned: [[0.0; D]; D],
    };

    fn add(&mut self, mass: f64, x: &Vector<D>, v: &Vector<D>) {
        self.mass += mass;
        self.momentum = add(&self.momentum, &scale(mass, v));
        self.moment = add(&self.moment, &scale(mass, x));
    }

    fn arm(&self, x: &Vector<D>) -> Vector<D> {
        sub(x, &scale(1.0 / self.mass, &self.moment))
    }

    fn add_spin(&mut self, mass: f64, x: &Vector<D>, v: &Vector<D>) {
        let arm = self.arm(x);
        add_outer(&mut self.second, mass, &arm, &arm);
        add_outer(&mut self.turned, mass, v, &arm);
    }

    /// Of the rigid motion that has all that was lost.
    fn velocity_at(&self, x: &Vector<D>) -> Vector<D> {
        let spin = rotation(&self.second, &self.turned);
        add(
            &scale(1.0 / self.mass, &self.momentum),
            &apply(&spin, &self.arm(x)),
        )
    }
}
