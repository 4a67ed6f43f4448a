//! Exact yield by the augmented Lagrangian (docs/theory.md, E15): a plug does not creep at all.
//!
//! Symbols: E = 2 e(v) strain rate with |E| = gamma, q its plastic copy, lambda stress, r = eta of E6 (at most the cap),
//! |a| = sqrt(a:a/2). Minimises sum m |v - v*|^2/2 + dt sum V Phi(|q|), q = E, where Phi' = tau(|q|, p):
//!
//! 1. (M - dt F_r) v = M v* + dt F[lambda - r q]    the linear solve of `implicit`, F_r with viscosity r
//! 2. x = lambda + r E(v);   |q| solves tau(|q|, p) + r |q| = |x| (0 if |x| is under the yield stress), q = |q| x/|x|
//! 3. lambda = x - r q, which is on the yield surface or below it
//!
//! lambda and q start from the last step's, so a few iterations a step are enough. Fortin & Glowinski 1983 (ALG2).

use crate::material::{Material, Rheology};
use crate::math::{Tensor, scale};
use crate::state::State;

use super::Solver;
use super::implicit::Viscous;
use super::record::Record;

/// How much more stress than it bears a particle may start a step with: no more than the pressure's own swing is lost.
pub(super) const SPARE: f64 = 2.0;

/// Share of the expected change of the plastic rate that a step starts with [1]. With all of it nothing holds back a shear rate that
/// trembles about one as small: it grows, turns the stress away from the mean shear, and slow flows were half as fast again.
const EXPECTED: f64 = 0.8;

impl<const D: usize> Solver<D> {
    /// lambda - r q, what the next linear solve takes as given.
    pub(super) fn fix_plastic_stress(&self, state: &State<D>, work: &mut Viscous<D>) {
        let (lambda, q) = (&state.grains.stress, &state.grains.plastic_rate);
        work.fixed.resize(lambda.len(), [[0.0; D]; D]);
        self.workers.each(&mut work.fixed, |i, t| {
            let r = self.viscosity[i];
            for a in 0..D {
                for b in 0..D {
                    t[a][b] = lambda[i][a][b] - r * q[i][a][b];
                }
            }
        });
    }

    /// The same for the first solve of a step, with the plastic rate that the first guess has for the last step's where grains
    /// yielded in the last step (docs/theory.md, E19): the penalty then holds back changes of acceleration and not of velocity.
    ///
    /// q changes by no more than its own size: what did not yield keeps its q of 0. There the guess is the pressure's noise, and sand
    /// that ought to stop would not; what hits a wall would go on being slowed down, and be thrown back. Nor is this for what is
    /// viscous itself, whose stress follows its rate: one step of it is exact as it is.
    pub(super) fn expect_plastic_stress(&self, state: &State<D>, work: &mut Viscous<D>) {
        let grains = &state.grains;
        let Viscous { current, fixed, .. } = work;
        fixed.resize(grains.stress.len(), [[0.0; D]; D]);
        self.workers.each(fixed, |i, t| {
            let (lambda, last) = (&grains.stress[i], &grains.plastic_rate[i]);
            let material = &self.materials[grains.phase[i] as usize];
            let (r, most) = (self.viscosity[i], self.geometry.size(last));
            let mut q = *last;
            if most > 0.0 && material.viscous.consistency == 0.0 {
                let trial = self.trial(lambda, &current[i]);
                let guessed = self.admissible(material, i, &trial).1;
                let change: Tensor<D> =
                    std::array::from_fn(|a| std::array::from_fn(|b| guessed[a][b] - last[a][b]));
                let share = EXPECTED * (most / self.geometry.size(&change)).min(1.0);
                for a in 0..D {
                    for b in 0..D {
                        q[a][b] += share * change[a][b];
                    }
                }
            }
            for a in 0..D {
                for b in 0..D {
                    t[a][b] = lambda[a][b] - r * q[a][b];
                }
            }
        });
    }

    /// lambda + r E of the velocity and linear stress of a record.
    fn trial(&self, lambda: &Tensor<D>, record: &Record) -> Tensor<D> {
        let whole = 1.0 / (1.0 - self.numerics.pair_viscosity_share);
        let linear = record.stress::<D>();
        std::array::from_fn(|a| std::array::from_fn(|b| lambda[a][b] + whole * linear[a][b]))
    }

    /// Cuts the stress that a step starts from to [`SPARE`] times what this step's pressure bears at the last plastic rate.
    ///
    /// Where the pressure has fallen far, so has r; the excess of the old stress would make q = (|x| - tau)/r a rate that no
    /// material has, and r q a stress out of all bounds when the pressure returns. What is less than that stays: it makes
    /// up for pressures that rise and fall from step to step. In steps of sound the pressure may have returned already, and r has
    /// not: so the excess is no more than what a shear rate of c/h makes up for.
    pub(super) fn cut_stress(&self, state: &mut State<D>) {
        let grains = &mut state.grains;
        let (q, phase) = (&grains.plastic_rate, &grains.phase);
        self.workers.each(&mut grains.stress, |i, lambda| {
            let material = &self.materials[phase[i] as usize];
            let rate = self.geometry.size(&q[i]);
            let r = self.kinematics[i].correction;
            let most = if material.is_fluid() {
                r * material.shear_stress(r * rate, 0.0, 1.0)
            } else {
                let summed = material.as_summed(r);
                let law = summed.as_ref().unwrap_or(material);
                law.shear_stress(rate, self.yield_pressure(i), r)
            };
            let fastest = self.sound_speed_of(material) / self.kernel.h;
            let excess = ((SPARE - 1.0) * most).min(self.viscosity[i] * fastest);
            let (size, most) = (self.geometry.size(lambda), most + excess);
            if size > most {
                *lambda = lambda.map(|row| scale(most / size, &row));
            }
        });
    }

    /// Steps 2 and 3 for every particle, from the linear stress of `work.current`.
    pub(super) fn project(&self, state: &mut State<D>, work: &Viscous<D>) {
        let grains = &mut state.grains;
        let phase = &grains.phase;
        self.workers.both(
            &mut grains.stress,
            &mut grains.plastic_rate,
            |i, lambda, q| {
                let material = &self.materials[phase[i] as usize];
                let x = self.trial(lambda, &work.current[i]);
                (*lambda, *q) = self.admissible(material, i, &x);
                []
            },
        );
    }

    /// Pressure that friction is made of [Pa].
    pub(super) fn yield_pressure(&self, i: usize) -> f64 {
        self.effective.get(i).map_or(self.pressure[i], |p| *p)
    }

    /// (lambda, q) of a trial stress.
    fn admissible(&self, material: &Material, i: usize, x: &Tensor<D>) -> (Tensor<D>, Tensor<D>) {
        let (p, r) = (self.yield_pressure(i), self.viscosity[i]);
        let zero = [[0.0; D]; D];
        if r <= 0.0 || material.is_newtonian() {
            // Newton's fluid has all its stress in the linear solve.
            return (zero, zero);
        }
        let size = self.geometry.size(x);
        let correction = self.kinematics[i].correction;
        let half = self.wall_share.get(i).map_or(0.0, |share| *share);
        let q = if material.is_fluid() {
            // Phi(R |q|): R tau(R q) + r q = |x|.
            let (x, r) = (size / correction, r / (correction * correction));
            let rate = if half > 0.0 {
                material.cell_resolvent(x, r, p, 1.0, half)
            } else {
                material.resolvent(x, r, p, 1.0)
            };
            rate / correction
        } else {
            let summed = material.as_summed(correction);
            let law = summed.as_ref().unwrap_or(material);
            if half > 0.0 {
                law.cell_resolvent(size, r, p, correction, half)
            } else {
                law.resolvent(size, r, p, correction)
            }
        };
        if q <= 0.0 {
            return (*x, zero);
        }
        let rate = x.map(|row| scale(q / size, &row));
        let stress = x.map(|row| scale(1.0 - r * q / size, &row));
        (stress, rate)
    }
}
