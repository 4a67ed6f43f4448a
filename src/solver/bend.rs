//! Bends of smooth faces, and walls that turn: what a particle sees turns about a centre (docs/theory.md, "Bends").
//!
//! Symbols: x = x_i - x_w, a = x_i - c with the centre c of the bend, J turns by a right angle, n = a/|a|, h = J a/a^2: h.v is the rate
//! at which what slides at v turns about c; O = skew of a wall's angular velocity.
//!
//! At free slip a bend's points move at n n^T v, as those of a flat face, and turn at h.v about the particle; those of a wall that turns, with
//! it:
//!
//!   G_i += [(h.(v_i - v_w)) J + O] X,   X = -sum x (x) g + (I - M) (share of the points),                   (E14c)
//!
//! which with the particles' own part is (h.v) J of what turns as one, and no strain.

use crate::math::{Tensor, Vector, add_outer, apply, dot, multiply, norm, scale, skew, sub, trace};

use super::Solver;
use super::pair::WallRow;

/// Part of M that walls make, from which on they make up for all that it lacks [1].
const SEEN: f64 = 0.1;
/// Two points see one bend where what they see of it differs by no more than this [1]: rounding.
const SAME: f64 = 1e-12;
/// The turn that h.v is the rate of.
const ABOUT: [f64; 3] = [0.0, 0.0, 1.0];

/// A bend as one particle sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bend<const D: usize> {
    /// n, towards the material or away from it.
    pub(super) normal: Vector<D>,
    /// h [1/m].
    pub(super) rate: Vector<D>,
}

impl<const D: usize> Bend<D> {
    pub(super) fn is(&self, other: &Self) -> bool {
        norm(&sub(&self.rate, &other.rate)) <= SAME * norm(&self.rate)
    }
}

/// What the faces of a row turn with, weighed by how much of M each makes.
pub(super) struct Turning<const D: usize> {
    /// Trace of the walls' part of M.
    weight: f64,
    /// Sum of h, of h.v_w and of O.
    rate: Vector<D>,
    driven: f64,
    spin: Tensor<D>,
}

impl<const D: usize> Turning<D> {
    pub(super) const NONE: Self = Self {
        weight: 0.0,
        rate: [0.0; D],
        driven: 0.0,
        spin: [[0.0; D]; D],
    };

    /// Adds a face; `around`: its part of M.
    #[inline(always)]
    pub(super) fn add(
        &mut self,
        bend: Option<&Bend<D>>,
        spin: &[f64; 3],
        around: &Tensor<D>,
        wall_velocity: &Vector<D>,
    ) {
        let weight = trace(around);
        self.weight += weight;
        if let Some(bend) = bend {
            for k in 0..D {
                self.rate[k] += weight * bend.rate[k];
            }
            self.driven += weight * dot(&bend.rate, wall_velocity);
        }
        let turn = skew::<D>(spin);
        for a in 0..D {
            for b in 0..D {
                self.spin[a][b] += weight * turn[a][b];
            }
        }
    }

    /// Makes up for what M lacks, once it is complete.
    pub(super) fn complete(&self, moment: &Tensor<D>, w: &mut WallRow<D>) {
        if self.rate == [0.0; D] && self.spin == [[0.0; D]; D] {
            return;
        }
        let share = 1.0 / self.weight.max(SEEN);
        for a in 0..D {
            for b in 0..D {
                w.lack[a][b] = share * (f64::from(u8::from(a == b)) - moment[a][b]);
            }
        }
        let lack = w.lack;
        w.add_rotation(&self.rate, &lack, self.driven);
        w.add_spin(&self.spin, &lack);
    }
}

impl<const D: usize> WallRow<D> {
    /// Adds a bend; `around`: its part of M.
    #[inline(always)]
    pub(super) fn add_bend(
        &mut self,
        rate: &Vector<D>,
        around: &Tensor<D>,
        wall_velocity: &Vector<D>,
    ) {
        self.add_rotation(rate, around, dot(rate, wall_velocity));
    }

    /// -2 (K v - Q) += (h.v - `driven`) J X.
    fn add_rotation(&mut self, rate: &Vector<D>, x: &Tensor<D>, driven: f64) {
        let turned = multiply(&skew(&ABOUT), x);
        for a in 0..D {
            for c in 0..D {
                let half = -0.5 * turned[a][c];
                for b in 0..D {
                    self.k[a][b][c] += half * rate[b];
                }
                self.q[a][c] += half * driven;
            }
        }
    }

    /// 2 Q += O X.
    #[inline(always)]
    pub(super) fn add_spin(&mut self, spin: &Tensor<D>, x: &Tensor<D>) {
        let turned = multiply(spin, x);
        for a in 0..D {
            for c in 0..D {
                self.q[a][c] += 0.5 * turned[a][c];
            }
        }
    }
}

impl<const D: usize> Solver<D> {
    /// The bend that a wall point lies in, as a particle at x from it sees it; `normal` is that of the point's face to it.
    #[inline(always)]
    pub(super) fn bend_at(&self, wall: u32, x: &Vector<D>, normal: &Vector<D>) -> Option<Bend<D>> {
        let to = self.walls.bend(wall as usize)?;
        // Beside a free end it sees another face.
        if self.walls.normal[wall as usize] != *normal {
            return None;
        }
        let arm = sub(x, to);
        let r2 = dot(&arm, &arm);
        (r2 > self.numerics.spacing.powi(2)).then(|| Bend {
            normal: scale(1.0 / r2.sqrt(), &arm),
            rate: scale(1.0 / r2, &apply(&skew(&ABOUT), &arm)),
        })
    }

    /// Velocity of a wall's material where a particle is that lies x away from one of its points: there it neither slips nor shears if it
    /// moves as the wall does.
    #[inline(always)]
    pub(super) fn wall_velocity_at(&self, wall: u32, x: &Vector<D>) -> Vector<D> {
        let mut v = self.walls.velocity[wall as usize];
        let spin = &self.walls.groups[self.walls.group[wall as usize] as usize].spin;
        if *spin != [0.0; 3] {
            let turned = apply(&skew(spin), x);
            for k in 0..D {
                v[k] += turned[k];
            }
        }
        v
    }

    /// Force per volume of a stress through a bend's point: minus the adjoint of (E14c); `g` its part of the sums.
    pub(super) fn bend_force(
        bend: &Bend<D>,
        tau: &Tensor<D>,
        (x, g): (&Vector<D>, &Vector<D>),
        lack: &Tensor<D>,
    ) -> Vector<D> {
        let mut around = lack.map(|row| scale(-dot(x, g), &row));
        add_outer(&mut around, -1.0, x, g);
        let turned = multiply(&skew(&ABOUT), &around);
        let torque: f64 = (0..D).map(|a| dot(&tau[a], &turned[a])).sum();
        scale(-torque, &bend.rate)
    }
}
