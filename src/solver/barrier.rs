//! What keeps particles in front of walls when their pressure does not (docs/theory.md, W5).
//!
//! A wall acts by the pressure of the particle that sees it, and that by its density. Material that has thinned out (a spray, a
//! ring that has moved outwards, the last grains beside an edge) may be so loose that all of a wall's compression, a factor of
//! about 2 down to the first row, leaves it without pressure: it sinks in. So a wall also pushes by place alone, with
//!
//!   a_i = -4 k (N_i - 1/2) grad N_i   where N_i > 1/2,   N_i = sum_walls w dp^D W(x_iw; h = dp)            (W5)
//!
//! N is the share of the neighbourhood, as wide as a spacing, that is wall: 0.14 in front of a wall where particles rest, 0.36
//! at most in a corner of three, 1/2 on the surface, 0.9 on the first row: nothing changes for what stays in front of walls. The force has
//! a potential, 2 k (N - 1/2)^2 (of rings with the images of walls across the axis); on the way out only a fourth of it acts, so that it takes energy and never gives any.
//!
//! What rests on a wall by this push rubs on it with it, as Coulomb says: without that a ring that had thinned out on a floor glided on
//! for ever. mu is mu_w on faces with friction, the material's mu_s without slip, none on smooth ones and of fluids:
//!
//!   a_i -= min(mu |a_i|, |u|/dt) u/|u|,   u the velocity along the wall, against its surface                 (W5)

use crate::kernel::WendlandC2;
use crate::material::{Friction as _, Material};
use crate::math::{Vector, dot, norm, scale, sub};

use super::Solver;
use super::pair::WallRow;

/// The share of wall from where on it pushes [1]: that on a flat surface.
const SURFACE: f64 = 0.5;

/// Share of the force on the way out that is missing at speeds beyond [`SOFT`] [1]: a coefficient of restitution of one half.
const LOST: f64 = 0.75;

/// Speed over the sound speed at which all of [`LOST`] is missing [1].
const SOFT: f64 = 0.01;

/// k of a particle over dp^2 and what the step allows: (this/dt)^2 [1]. Its frequency at a surface is 1.6 sqrt(k)/dp, twice that in
/// corners, against 2/dt that symplectic Euler bears.
const STIFFNESS: f64 = 0.6;

/// The kernel of N, and dp^D.
#[derive(Clone, Copy, Debug)]
pub(super) struct Barrier<const D: usize> {
    kernel: WendlandC2<D>,
    /// dp^D [m^D].
    cell: f64,
    /// Largest k [m^2/s^2].
    most: f64,
}

/// Sums over the wall points that one particle sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearness<const D: usize> {
    /// N [1].
    share: f64,
    /// grad N [1/m].
    slope: Vector<D>,
    /// grad N . (v_i - v_w) [1/s].
    rate: f64,
    /// sum mu w dp^D W [1].
    friction: f64,
    /// sum v_w w dp^D W of the walls' surfaces [m/s].
    carried: Vector<D>,
}

/// What rubs on a wall by the push of (W5).
#[derive(Clone, Copy, Debug)]
pub(super) struct Rub<const D: usize> {
    /// mu [1].
    friction: f64,
    /// Velocity of the wall's surface [m/s].
    surface: Vector<D>,
}

impl<const D: usize> Rub<D> {
    pub(super) const NONE: Self = Self {
        friction: 0.0,
        surface: [0.0; D],
    };

    /// Acceleration of friction on what moves at u and is pushed with `push` [m/s^2], over no more than what stops it in `dt` [s]. Across the
    /// wall it takes half of a speed below `slow` [m/s]: what lies on it would hop from step to step for ever.
    pub(super) fn grip(
        &self,
        push: &Vector<D>,
        u: &Vector<D>,
        (dt, slow): (f64, f64),
    ) -> Vector<D> {
        let size = norm(push);
        if self.friction <= 0.0 || size == 0.0 {
            return [0.0; D];
        }
        let n = scale(1.0 / size, push);
        let slip = sub(u, &self.surface);
        let across = dot(&slip, &n);
        let along = sub(&slip, &scale(across, &n));
        let speed = norm(&along);
        let most = (self.friction * size).min(speed / dt);
        let rubs = scale(-most / speed.max(f64::MIN_POSITIVE), &along);
        let damped = if across.abs() < slow { across } else { 0.0 };
        sub(&rubs, &scale(0.5 * damped / dt, &n))
    }
}

impl<const D: usize> Nearness<D> {
    pub(super) const NONE: Self = Self {
        share: 0.0,
        slope: [0.0; D],
        rate: 0.0,
        friction: 0.0,
        carried: [0.0; D],
    };

    /// Means over the walls.
    pub(super) fn rub(&self) -> Rub<D> {
        Rub {
            friction: self.friction / self.share,
            surface: scale(1.0 / self.share, &self.carried),
        }
    }

    /// Acceleration of a push of (W5) [m/s^2].
    pub(super) fn push(&self, push: f64) -> Vector<D> {
        scale(-push, &self.slope)
    }
}

impl<const D: usize> Barrier<D> {
    /// For a spacing [m] and the length of the longest step [s].
    pub(super) fn new(spacing: f64, step: f64) -> Self {
        Self {
            kernel: WendlandC2::new(spacing),
            cell: spacing.powi(D as i32),
            most: (STIFFNESS * spacing / step).powi(2),
        }
    }

    /// w dp^D grad W of a wall point at x_i - x_w = x, r = |x|, of this weight [1/m].
    #[inline(always)]
    pub(super) fn slope(&self, x: &Vector<D>, r: f64, weight: f64) -> Vector<D> {
        let f = self.cell * weight * self.kernel.f(r);
        std::array::from_fn(|k| f * x[k])
    }

    /// Adds a wall point; `v` is the velocity against it, `friction` and `surface` those of its face [1, m/s].
    #[inline(always)]
    pub(super) fn add(
        &self,
        sums: &mut Nearness<D>,
        (x, r): (&Vector<D>, f64),
        weight: f64,
        v: &Vector<D>,
        (friction, surface): (f64, &Vector<D>),
    ) {
        if r >= self.kernel.support() {
            return;
        }
        let share = self.cell * weight * self.kernel.w(r);
        sums.share += share;
        sums.friction += friction * share;
        let slope = self.slope(x, r, weight);
        sums.rate += dot(&slope, v);
        for k in 0..D {
            sums.slope[k] += slope[k];
            sums.carried[k] += share * surface[k];
        }
    }

    /// 4 k (N - 1/2) of a particle of sound speed c, less on the way out [m^2/s^2]; 0 in front of the surface.
    #[inline(always)]
    pub(super) fn push(&self, sums: &Nearness<D>, c: f64) -> f64 {
        if sums.share <= SURFACE {
            return 0.0;
        }
        let size = dot(&sums.slope, &sums.slope).sqrt();
        let out = -sums.rate / (size * SOFT * c).max(f64::MIN_POSITIVE);
        let left = 1.0 - LOST * out.clamp(0.0, 1.0);
        4.0 * left * self.most.min(c * c) * (sums.share - SURFACE)
    }
}

impl<const D: usize> Solver<D> {
    /// Sets the push of (W5), and what rubs by it, on a particle of a material at x, moving at v, by the wall points `near` it.
    pub(super) fn hold_off(
        &self,
        (x, v): (&Vector<D>, &Vector<D>),
        material: &Material,
        near: &[u32],
        w: &mut WallRow<D>,
    ) {
        let nearness = self.nearness(x, v, near, material);
        w.barrier = self.barrier.push(&nearness, self.sound_speed_of(material));
        if w.barrier > 0.0 {
            w.push = nearness.push(w.barrier);
            w.rub = nearness.rub();
        }
    }

    /// What (W5) is made of: sums over all wall points near a particle at xi, moving at vi.
    fn nearness(
        &self,
        xi: &Vector<D>,
        vi: &Vector<D>,
        near: &[u32],
        material: &Material,
    ) -> Nearness<D> {
        let mut nearness = Nearness::NONE;
        let rough = material.law.static_friction();
        for &wall in near {
            let (x, r) = self.wall_offset(xi, wall);
            let weight = self.walls.weight[wall as usize];
            let against = sub(vi, &self.point_velocity(wall));
            let spec = &self.walls.groups[self.walls.group[wall as usize] as usize];
            let friction = match (rough > 0.0, spec.free_slip) {
                (true, true) => spec.friction,
                (true, false) => rough,
                (false, _) => 0.0,
            };
            let face = (friction, &self.walls.velocity[wall as usize]);
            self.barrier
                .add(&mut nearness, (&x, r), weight, &against, face);
            if let Some((x, r)) = self.wall_image(xi, wall) {
                self.barrier
                    .add(&mut nearness, (&x, r), weight, &against, face);
            }
        }
        nearness
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of a flat wall below y = 0, seen from a height, at speed v across it.
    fn seen(height: f64, v: f64) -> Nearness<2> {
        let barrier = Barrier::<2>::new(0.1, 1e-3);
        let mut sums = Nearness::NONE;
        for row in 0..4 {
            for k in -6..=6 {
                let x = [0.1 * f64::from(k), height + 0.05 + 0.1 * f64::from(row)];
                let r = x[0].hypot(x[1]);
                barrier.add(&mut sums, (&x, r), 1.0, &[0.0, v], (0.5, &[0.2, 0.0]));
            }
        }
        sums
    }

    #[test]
    fn nothing_in_front_of_a_wall_and_a_push_out_of_it() {
        let barrier = Barrier::<2>::new(0.1, 1e-3);
        assert_eq!(barrier.push(&seen(0.05, -1.0), 10.0), 0.0);
        assert_eq!(barrier.push(&seen(0.02, -1.0), 10.0), 0.0);
        let inside = seen(-0.02, 0.0);
        assert!(barrier.push(&inside, 10.0) > 0.0);
        // Against the slope, which points into the wall.
        assert!(inside.slope[1] < 0.0 && inside.slope[0].abs() < 1e-9);
    }

    #[test]
    fn what_is_pushed_rubs_along_the_wall_until_it_moves_with_it() {
        let rub = seen(-0.02, 0.0).rub();
        let push = [0.0, 3.0];
        let close = |u: [f64; 2], expected: [f64; 2]| {
            let a = rub.grip(&push, &u, (0.1, 0.5));
            let off = norm(&sub(&a, &expected));
            assert!(off < 1e-12, "{a:?} for {expected:?}");
        };
        close([1.2, -7.0], [-1.5, 0.0]);
        close([-1.2, 7.0], [1.5, 0.0]);
        // No further than to rest, and slow hops are damped.
        close([0.25, 0.6], [-0.5, 0.0]);
        close([0.2, 0.4], [0.0, -2.0]);
        let smooth = Rub::<2>::NONE;
        assert_eq!(smooth.grip(&push, &[1.2, 0.0], (0.1, 0.5)), [0.0, 0.0]);
    }

    #[test]
    fn on_the_way_out_a_fourth_is_left() {
        let barrier = Barrier::<2>::new(0.1, 1e-3);
        let push = |v: f64| barrier.push(&seen(-0.02, v), 10.0);
        assert_eq!(push(-1.0), push(0.0));
        assert!((push(1.0) / push(0.0) - 0.25).abs() < 1e-12);
    }
}
