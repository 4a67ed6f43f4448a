//! The plain scalar form of each pass, and how far the fast one's results are from it.

use crate::math::{Tensor, Vector};
use crate::solver::kinematics::Kinematics;
use crate::solver::plain::PlainPairs;
use crate::solver::pressure::Prediction;
use crate::solver::record::Record;

use super::{Pass, Passes, STEP};

/// Results of the plain sweeps.
#[derive(Debug, Default)]
pub(super) struct Plain<const D: usize> {
    pub(super) pairs: PlainPairs<D>,
    kinematics: Vec<Kinematics>,
    prediction: Vec<Prediction<D>>,
    gradient: Vec<Tensor<D>>,
    stress: Vec<Tensor<D>>,
    force: Vec<Vector<D>>,
}

impl<const D: usize> Passes<D> {
    /// Runs the plain scalar form of a pass, after those before it; nothing for [`Pass::Lists`].
    pub fn run_plain(&mut self, pass: Pass) {
        let (solver, state, plain) = (&self.solver, &self.state, &mut self.plain);
        let n = state.grains.len();
        let v = &state.grains.velocity;
        match pass {
            Pass::Lists => (),
            Pass::Pairs => {
                let rows = solver.plain_pairs(state, &mut plain.pairs);
                plain.kinematics.resize(n, Kinematics::default());
                for (i, (k, row)) in plain.kinematics.iter_mut().zip(&rows).enumerate() {
                    *k = solver.finish(row, state.grains.phase[i], i, &v[i]);
                }
            }
            Pass::Pressure => {
                plain.prediction.resize(n, Prediction::default());
                solver.plain_pressure(state, &plain.pairs, STEP, &mut plain.prediction);
            }
            Pass::Stress => {
                plain.gradient.resize(n, [[0.0; D]; D]);
                plain.stress.resize(n, [[0.0; D]; D]);
                solver.plain_gradients(&plain.pairs, v, &mut plain.gradient);
                for (i, tau) in plain.stress.iter_mut().enumerate() {
                    *tau = solver.row_stress(i, &v[i], &plain.gradient[i]);
                }
            }
            Pass::Force => {
                plain.force.resize(n, [0.0; D]);
                solver.plain_forces(&plain.pairs, v, &plain.stress, &mut plain.force);
            }
        }
    }

    /// Runs all passes in both forms; the largest difference between the results of one pass over the largest result,
    /// for each pass that has a plain form [1].
    pub fn disagreement(&mut self) -> Vec<(Pass, f64)> {
        let mut found = Vec::new();
        for pass in Pass::ALL {
            self.prepare(pass);
            self.run(pass);
            self.run_plain(pass);
            if pass.has_plain() {
                found.push((pass, self.differ(pass)));
            }
        }
        found
    }

    fn differ(&self, pass: Pass) -> f64 {
        let (solver, plain) = (&self.solver, &self.plain);
        match pass {
            Pass::Lists => 0.0,
            Pass::Pairs => {
                let of = |k: &Kinematics| [k.divergence, k.shear, k.pair_scale, k.relative_speed];
                apart(solver.kinematics.iter().zip(&plain.kinematics), of)
            }
            Pass::Pressure => {
                let velocity = apart(solver.prediction.iter().zip(&plain.prediction), |p| {
                    p.velocity
                });
                let resistance = apart(solver.prediction.iter().zip(&plain.prediction), |p| {
                    [p.resistance[0][0], p.resistance[D - 1][0]]
                });
                let diffusion = apart(solver.prediction.iter().zip(&plain.prediction), |p| {
                    [p.diffusion]
                });
                velocity.max(resistance).max(diffusion)
            }
            Pass::Stress => {
                let fast: Vec<Tensor<D>> = self.stressed.iter().map(Record::stress).collect();
                apart(fast.iter().zip(&plain.stress), |t| t[0])
            }
            Pass::Force => {
                let to_force = |i: usize| solver.width * solver.volume[i];
                let plain: Vec<Vector<D>> = (0..self.force.len())
                    .map(|i| crate::math::scale(to_force(i), &plain.force[i]))
                    .collect();
                apart(self.force.iter().zip(&plain), |f| *f)
            }
        }
    }
}

/// Largest difference of the values of pairs of rows over the largest value.
fn apart<'a, T: 'a, const K: usize>(
    rows: impl Iterator<Item = (&'a T, &'a T)>,
    values: impl Fn(&T) -> [f64; K],
) -> f64 {
    let (mut difference, mut largest) = (0.0f64, f64::MIN_POSITIVE);
    for (a, b) in rows {
        for (a, b) in values(a).into_iter().zip(values(b)) {
            // Not a number must not pass as no difference.
            if !(a - b).is_finite() {
                return f64::INFINITY;
            }
            difference = difference.max((a - b).abs());
            largest = largest.max(b.abs());
        }
    }
    difference / largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{norm, sub};

    fn agrees<const D: usize>(side: usize) {
        let mut passes = Passes::<D>::new(side, 0.2);
        assert_eq!(passes.particles(), side.pow(D as u32));
        let found = passes.disagreement();
        assert_eq!(found.len(), 4);
        for (pass, difference) in found {
            assert!(difference < 1e-11, "{}: {difference}", pass.name());
        }
        let (x, support) = (passes.positions(), 2.0 * passes.smoothing_length());
        let near = |i: usize, j: usize| i != j && norm(&sub(&x[i], &x[j])) < support;
        let count = |i| (0..x.len()).filter(|&j| near(i, j)).count();
        assert_eq!(passes.pairs(), (0..x.len()).map(count).sum::<usize>());
        // A sweep repeated gives the same, whatever came between.
        let before = passes.force.clone();
        for pass in [Pass::Pairs, Pass::Lists, Pass::Pressure, Pass::Force] {
            passes.prepare(pass);
            passes.run(pass);
        }
        assert_eq!(before, passes.force);
    }

    #[test]
    fn fast_and_plain_passes_agree() {
        agrees::<2>(23);
        agrees::<3>(9);
    }

    #[test]
    fn a_wrong_result_is_seen() {
        let mut passes = Passes::<2>::new(12, 0.2);
        passes.disagreement();
        passes.plain.force[7][0] *= 1.01;
        passes.plain.prediction[7].diffusion = f64::NAN;
        assert!(passes.differ(Pass::Force) > 1e-6);
        assert!(passes.differ(Pass::Pressure).is_infinite());
    }
}
