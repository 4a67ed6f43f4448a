//! How loosely particles lie, and what that makes of their density (docs/theory.md, (E16)).
//!
//! Density follows div v, which does not know how much room there is. What parts and meets again, or flows in with gaps, keeps every
//! error of the way for good: a tank that was filled by a jet stood a sixth too high, a bin filled by a half-full stream twice.
//!
//!   m = tr M/D = sum_j V_j |F| r^2/D,   l = sum_j V_j |F| over that of a lattice,   s = h |sum_j g_ij|      (E2)
//!
//! with walls once. m and l are 1 where volumes fill space, and a particle on top of another counts nothing in m and most in l: room is
//! left or missing where both say so. By m alone pairs at a surface were loose, got more room, and sank into each other. At a flat
//! surface, which lacks neighbours on one side, 1 - m - 0.75 s is near 0: (1 - m)/s is 0.61 to 0.76 there in the plane, 0.51 to
//! 0.67 in space. An edge, where s >= m, and a particle alone tell nothing.

use crate::kernel::WendlandC2;
use crate::material::Material;
use crate::math::{norm, trace};

use super::Solver;
use super::fluid_row::Row;
use super::kinematics::Kinematics;
use super::pore;

/// What s takes of 1 - m at a flat surface [1].
const SIDE: f64 = 0.75;

/// Share of the volume that uneven places make look missing or too much [1].
const PLAY: f64 = 0.03;

/// The same under load where friction holds particles in uneven places [1].
const HELD: f64 = 0.3;

/// Times in which density gives way, over h/c: where there is pressure, and where there is none [1].
const LOADED: f64 = 50.0;
const FREE: f64 = 10.0;

/// Tells how much of a neighbourhood is filled.
#[derive(Clone, Copy, Debug)]
pub(super) struct Packing {
    h: f64,
    /// sum_j V_j |F| of a lattice [1/m^2].
    lattice_sum: f64,
}

impl Packing {
    pub(super) fn new<const D: usize>(kernel: &WendlandC2<D>, spacing: f64) -> Self {
        Self {
            h: kernel.h,
            lattice_sum: 0.5 * pore::lattice_sum(kernel, spacing),
        }
    }

    /// sum_j V_j |F| of a lattice [1/m^2].
    pub(super) fn lattice_sum(&self) -> f64 {
        self.lattice_sum
    }

    /// Share of a particle's neighbourhood that is empty, negative where it is filled more than once [1]; 0 within what uneven
    /// places make of it.
    pub(super) fn looseness<const D: usize>(&self, sums: &Row<D>) -> f64 {
        let by_moment = trace(&sums.moment) / D as f64;
        let by_nearness = sums.nearness / self.lattice_sum;
        let lacking = self.h * norm(&sums.side);
        if lacking >= by_moment {
            return 0.0;
        }
        let loose = 1.0 - by_moment.max(by_nearness) - SIDE * lacking;
        let dense = 1.0 - by_moment.min(by_nearness);
        if loose > PLAY {
            loose
        } else if dense < -PLAY {
            dense
        } else {
            0.0
        }
    }
}

impl<const D: usize> Solver<D> {
    /// What a step of dt adds to div v for the room that a particle of this density and relaxed shear rate has [1/s].
    pub(super) fn packing_rate(
        &self,
        m: &Material,
        k: &Kinematics,
        (rho, relaxed): (f64, f64),
        dt: f64,
    ) -> f64 {
        if k.looseness == 0.0 {
            return 0.0;
        }
        let rate = self.sound_speed_of(m) / self.kernel.h;
        let rest = m.rest_density();
        let free = self.load(m, rho, relaxed) == 0.0;
        if !m.is_fluid() && !free && k.looseness.abs() < HELD {
            return 0.0;
        }
        // What can rest unevenly is left alone where it does, as by (E8).
        let gate = if m.flows() {
            1.0
        } else {
            let stirred = k.shear + k.divergence.abs();
            (self.numerics.diffusion_gate_time * stirred).min(1.0)
        };
        if m.keeps_volume() {
            // Volumes do not follow: density goes until it says what they say.
            let away = (rho / rest).ln() + k.looseness;
            let apart = (away > 0.0) == (k.looseness > 0.0);
            return if apart {
                gate * rate / LOADED * away
            } else {
                0.0
            };
        }
        if !free {
            return gate * rate / LOADED * k.looseness;
        }
        // Compression alone loads what is free.
        let most = (rho / rest).ln().min(0.0) / dt;
        (gate * rate / FREE * k.looseness).max(most)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Vector, add_outer, dot, scale};

    const SPACING: f64 = 0.01;

    /// Looseness at the origin, where volumes of dp^D `share` lie on those points of a lattice that `keep` keeps.
    fn looseness<const D: usize>(share: f64, keep: impl Fn(&Vector<D>) -> bool) -> f64 {
        let kernel = WendlandC2::<D>::new(1.6 * SPACING);
        let mut sums = Row::NONE;
        for n in 0..9_usize.pow(D as u32) {
            let mut rest = n;
            let x: Vector<D> = std::array::from_fn(|_| {
                let c = rest % 9;
                rest /= 9;
                (c as f64 - 4.0) * SPACING
            });
            let r = norm(&x);
            if r == 0.0 || !keep(&x) {
                continue;
            }
            let vf = share * SPACING.powi(D as i32) * kernel.f(r);
            let x = scale(-1.0, &x);
            add_outer(&mut sums.moment, -vf, &x, &x);
            for (side, x) in sums.side.iter_mut().zip(&x) {
                *side += vf * x;
            }
            sums.nearness -= vf;
        }
        Packing::new(&kernel, SPACING).looseness(&sums)
    }

    fn looks_right<const D: usize>() {
        assert_eq!(looseness::<D>(1.0, |_| true), 0.0);
        // Half of the volume is missing, or half as much again too much.
        let half = looseness::<D>(0.5, |_| true);
        assert!((half - 0.5).abs() < 0.02, "{half}");
        let much = looseness::<D>(1.5, |_| true);
        assert!((much + 0.5).abs() < 0.02, "{much}");
        // Surfaces that slope, their edges, and single particles tell nothing.
        for slope in [0.0, 0.3, 1.0] {
            for depth in [0.5, 1.5] {
                let below = |x: &Vector<D>| dot(x, &std::array::from_fn(|k| [slope, 1.0, 0.0][k]));
                let top = depth * SPACING * (1.0_f64 + slope * slope).sqrt();
                let loose = looseness::<D>(1.0, |x| below(x) < top);
                assert_eq!(loose, 0.0, "slope {slope}, {depth} spacings deep");
            }
        }
        assert_eq!(looseness::<D>(1.0, |x| x.iter().all(|c| *c <= 0.0)), 0.0);
        assert_eq!(looseness::<D>(1.0, |_| false), 0.0);
    }

    #[test]
    fn looseness_is_the_share_that_is_empty() {
        looks_right::<2>();
        looks_right::<3>();
    }
}
