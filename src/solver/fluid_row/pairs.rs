//! Four pairs of a row: what all terms of its sums are made of.
//!
//! Symbols as in `fluid_row`.

use crate::math::{Four, Lanes, Vector};
use crate::solver::Solver;
use crate::solver::record::Motions;

use super::LEAST_DISTANCE2;

/// Particle i, and the kernel's numbers, the same in all lanes.
pub(super) struct Own<'s, L: Lanes, const D: usize> {
    solver: &'s Solver<D>,
    lanes: L,
    x: [Four<L>; D],
    v: [Four<L>; D],
    /// 1/r of a ring, else 0 [1/m].
    hoop: Four<L>,
    zero: Four<L>,
    one: Four<L>,
    /// r^2 that is divided by at least [m^2].
    least: Four<L>,
    inverse_2h: Four<L>,
    slope: Four<L>,
    /// -3/(2 h): F' of F = -s (1 - r/(2 h))^3 is that times -s (1 - r/(2 h))^2.
    falloff: Four<L>,
    /// 1/(4 pi): from the mean hoop of two rings to the section.
    to_section: Four<L>,
    /// -2 (D + 2).
    pair_form: Four<L>,
}

/// Particle i against four neighbours j.
pub(super) struct Pairs<L: Lanes, const D: usize> {
    /// x and v, their squares and v.x.
    pub(super) x: [Four<L>; D],
    pub(super) v: [Four<L>; D],
    pub(super) r2: Four<L>,
    pub(super) v2: Four<L>,
    pub(super) vx: Four<L>,
    r: Four<L>,
    /// 1 - r/(2 h), 0 beyond the support.
    t: Four<L>,
    volume: Four<L>,
    /// V_j F, and g of it.
    pub(super) vf: Four<L>,
    pub(super) g: [Four<L>; D],
    /// 1/(V_j F r^2).
    inverse: Four<L>,
    /// V_j F/r^2, made of that without another division.
    pub(super) weight: Four<L>,
}

impl<'s, L: Lanes, const D: usize> Own<'s, L, D> {
    /// Of a particle at x, v, with the `hoop` of its ring.
    #[inline(always)]
    pub(super) fn new(
        solver: &'s Solver<D>,
        lanes: L,
        (x, v, hoop): (&Vector<D>, &Vector<D>, f64),
    ) -> Self {
        let kernel = &solver.kernel;
        let splat = |a: f64| Four::splat(lanes, a);
        let mut own = Self {
            solver,
            lanes,
            x: [splat(0.0); D],
            v: [splat(0.0); D],
            hoop: splat(hoop),
            zero: splat(0.0),
            one: splat(1.0),
            least: splat(LEAST_DISTANCE2 * kernel.h * kernel.h),
            inverse_2h: splat(kernel.inverse_support()),
            slope: splat(-kernel.slope()),
            falloff: splat(-3.0 * kernel.inverse_support()),
            to_section: splat(0.5 / std::f64::consts::TAU),
            pair_form: splat(-2.0 * (D as f64 + 2.0)),
        };
        for k in 0..D {
            own.x[k] = splat(x[k]);
            own.v[k] = splat(v[k]);
        }
        own
    }

    /// RINGS: particles are rings.
    #[inline(always)]
    pub(super) fn beside<const RINGS: bool>(&self, other: &Motions<L, D>) -> Pairs<L, D> {
        let zero = self.zero;
        let (mut x, mut v) = ([zero; D], [zero; D]);
        let (mut r2, mut v2, mut vx) = (zero, zero, zero);
        for k in 0..D {
            let away = self.x[k] - other.x[k];
            x[k] = self.solver.periodic.nearest(self.lanes, k, away);
            v[k] = self.v[k] - other.v[k];
            r2 += x[k] * x[k];
            v2 += v[k] * v[k];
            vx += v[k] * x[k];
        }
        let r = r2.sqrt();
        let t = (self.one - r * self.inverse_2h).max(zero);
        let mut volume = other.volume;
        if RINGS {
            volume = volume * ((self.hoop + other.hoop) * self.to_section);
        }
        let vf = volume * (self.slope * t * t * t);
        let mut g = [zero; D];
        for k in 0..D {
            g[k] = vf * x[k];
        }
        let inverse = self.one.over(r2.max(self.least) * vf);
        Pairs {
            x,
            v,
            r2,
            v2,
            vx,
            r,
            t,
            volume,
            vf,
            g,
            inverse,
            weight: vf * vf * inverse,
        }
    }

    /// c of the pair form: |g| r = V_j |F| r^2 [m^2].
    #[inline(always)]
    pub(super) fn pair_form(&self, pairs: &Pairs<L, D>) -> Four<L> {
        self.pair_form * pairs.inverse
    }

    /// V_j v.(grad grad W) v = V_j (F v^2 + F'/r (v.x)^2), with 1/r = r V_j F/(V_j F r^2) [1/s^2].
    #[inline(always)]
    pub(super) fn curvature(&self, p: &Pairs<L, D>) -> Four<L> {
        let steeper = p.volume * (self.slope * p.t * p.t) * self.falloff;
        p.vf * (p.v2 + steeper * p.r * p.inverse * p.vx * p.vx)
    }
}
