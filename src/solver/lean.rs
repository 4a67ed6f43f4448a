//! Fluids at walls: what wall points, which take stress and pressure of the particle that sees them wherever they stand, lack of
//! it. Without slip shear stress goes on into the wall as momentum says (docs/theory.md, W4); at all walls pressure goes on with its
//! own slope (W7).
//!
//! A wall point takes the stress of the particle that sees it. Across the face the shear traction t changes by
//! dt/dn = rho (a - g)_t + grad_t p, which is what viscous forces leave of momentum along the wall: rho (a - a*)_t, a* the
//! acceleration of gravity and pressure. Carried on from x_i to x_w it is worth a part K of the particle's own momentum:
//!
//!   m (I - K) (a - a*) = F,   K = sum_walls (I - n n^T) |F_iw| V (n.x_iw)^2,                               (W4)
//!
//! F the viscous force without it. Where images stand for wall points (`mirror`) K is what they lack: it loses `lean_less`.
//! In the first row of a flat wall K is 0.6 along the wall (0.3 for the pair form's share), 0.5 without images. Without it the sum of stresses that
//! a wall gets is that of about 0.7 dp inside, and rows there shear too fast: by 5 % of the stress at 20 rows, which is a
//! fourth of a yield stress fluid's rate. The wall gets m K (a* - a) beside -F, so that momentum balances.
//!
//! Where nothing slips along a wall only, and for fluids: in sand friction would gain and pressure would not (`wall_ratio`).
//!
//! Of a slope of pressure the first row's neighbours show it 0.65 along a wall and 0.5 across it, and points with its own pressure
//! nothing. Along walls its weight was borne by as much: the row beside the wall of a tank at rest fell at a fourth of g, the water
//! went round, and densities, which follow div v, kept what that did to them. Across a floor rows sank until walls made up for the rest
//! by being nearer, 0.47 spacings instead of 0.5; that took as much more shear stress from them, which (W4) already had: the first row
//! of a film of clay was at 0.68 of its speed. With points at p_i + grad p . (x_w - x_i),
//!
//!   (I - L) (a* - g) = a_p,   L = sum_walls |F_iw| V x_iw x_iw^T,                                           (W7)
//!
//! a_p what the sums give. That is a smaller inertia and weight of a force that stays the adjoint of div v, so that sound is stable,
//! and the wall gets m L (a* - g).
//!
//! Up to |g| counts, and less of it the faster a particle moves the way that pressure drives it: a wall that stands still must
//! drive nothing. Taken whole, two of 200 random scenes (mud that hits its tub) gained 2 and 10 % of their energy.
//!
//! Grains keep their wall points, but for the pressure q of fluids in them: p_w in pores, 0 where there are none, and from a fluid
//! to them it goes over as a jump. L that of (W7) where pores are full, of dry grains along smooth faces, made of the x along each,
//!
//!   a += L (I - L)^-1 a_q,   a_q = -(1/rho_i) [sum_fluids (p_i + p_j - 2 q_i) g_ij + sum_grains (q_j - q_i) g_ij].    (W10)
//!
//! Across a wall that leaves the pressure that the row has too much there to the grains' own weight: p' of the first row is that at the
//! wall, and not half a spacing of the water's weight more, with which a saturated layer rubbed.
//!
//! With fluids' walls alone what walls gave along themselves ended where the fluid did: they pushed fluids down under sand, and took
//! weight from what lies on sand, by 0.3 dp of the pressure there. What a fluid pushes on grains is more than their weight, so that
//! not |g| bounds it but the pressure of the deepest fluid over a row.

use crate::math::{Tensor, Vector, apply, dot, inverse, norm, scale, sub, trace};
use crate::state::State;

use super::Solver;
use super::meeting::SOFTER;
use super::pair::{Block, WallRow};

/// Most of a particle's momentum that walls are given, and of a slope that they add [1]: corners and slits would ask for all of it.
const MOST: f64 = 0.8;

/// Speed against a wall, the way that pressure drives and over c0, from which on the wall adds nothing [1].
const DRIVEN: f64 = 0.01;

/// What a particle's sums show of a slope of pressure [m/s^2], and the most of it that walls carry on.
pub(super) struct Slope<const D: usize> {
    summed: Vector<D>,
    most: f64,
}

impl<const D: usize> Solver<D> {
    /// Gathers K of every particle after a sweep; nothing in scenes where neither fluids nor friction go on into walls.
    pub(super) fn note_lean(&mut self, state: &State<D>) {
        if !self.has_fluids && !self.friction_goes_on {
            return;
        }
        self.lean.clear();
        self.lean.resize(state.grains.len(), [[0.0; D]; D]);
        let mut lean = std::mem::take(&mut self.lean);
        self.workers
            .blocks_read(&self.lists.blocks, &mut lean, |block, _, out| {
                for w in &block.wall_rows {
                    let k = std::array::from_fn(|a| {
                        std::array::from_fn(|b| w.lean[a][b] - w.lean_less[a][b])
                    });
                    out[w.row as usize] = bounded(&k);
                }
            });
        self.lean = lean;
    }

    /// What the sums of pressure give a fluid's particle whose velocity they and gravity have made of that `before` the step.
    pub(super) fn slope_of_fluid(
        &self,
        before: &Vector<D>,
        velocity: &Vector<D>,
        dt: f64,
    ) -> Slope<D> {
        Slope {
            summed: std::array::from_fn(|a| (velocity[a] - before[a]) / dt - self.gravity[a]),
            most: self.gravity_norm,
        }
    }

    /// What the pressure of fluids, beside it and in pores, gives particle i of grains (W10).
    pub(super) fn slope_in_grains(
        &self,
        state: &State<D>,
        block: &Block<D>,
        (i, row): (usize, usize),
    ) -> Slope<D> {
        let p = self.normal_pressure();
        let own = self.pore_pressure(state, i);
        let fluids = &block.kinds(row)[SOFTER as usize];
        let mut summed = [0.0; D];
        for n in block.groups(row) {
            for (lane, &j) in block.j[n].iter().enumerate() {
                let j = j as usize;
                let q = if fluids.contains(&n) {
                    p[i] + p[j] - 2.0 * own
                } else {
                    self.pore_pressure(state, j) - own
                };
                for (a, g) in summed.iter_mut().zip(&block.g[n]) {
                    *a -= q * g.0[lane];
                }
            }
        }
        // What a fluid at rest can press with, on one row.
        let deepest = if self.gravity_norm > 0.0 {
            self.numerics.fall_speed.powi(2) / self.numerics.spacing
        } else {
            0.0
        };
        Slope {
            summed: scale(self.specific_volume(state, i), &summed),
            most: deepest,
        }
    }

    /// Adds to the velocity that a particle beside walls gets from gravity and the sums of pressure what walls lack of their slope, and
    /// notes it. `before`: at the step's start.
    pub(super) fn carry_slope(
        &self,
        slope: &Slope<D>,
        before: &Vector<D>,
        dt: f64,
        w: &mut WallRow<D>,
        velocity: &mut Vector<D>,
    ) {
        let lacking = bounded(&w.moment);
        let mut shown = lacking.map(|row| scale(-1.0, &row));
        for (a, row) in shown.iter_mut().enumerate() {
            row[a] += 1.0;
        }
        let whole = apply(&inverse(&shown), &slope.summed);
        let added = apply(&lacking, &whole);
        let size = norm(&added);
        if size == 0.0 {
            return;
        }
        let way = scale(1.0 / size, &added);
        let lack = dot(&way, &apply(&lacking, &way));
        let heavy = (lack * slope.most / size).min(1.0);
        // Against the walls.
        let whole_lack = dot(&way, &apply(&w.moment, &way));
        let moving = sub(&apply(&w.moment, before), &w.moment_drive);
        let driven = dot(&way, &moving) / (whole_lack * DRIVEN * self.numerics.sound_speed);
        let share = heavy * (1.0 - driven).clamp(0.0, 1.0);
        for a in 0..D {
            velocity[a] += dt * share * added[a];
        }
        let kept = trace(&lacking) / trace(&w.moment);
        w.carried = scale(kept * share, &whole);
    }

    /// m (I - K) a.
    #[inline(always)]
    pub(super) fn inertia(&self, mass: f64, i: usize, a: &Vector<D>) -> Vector<D> {
        match self.lean.get(i) {
            None => scale(mass, a),
            Some(k) => {
                let part = apply(k, a);
                std::array::from_fn(|c| mass * (a[c] - part[c]))
            }
        }
    }

    /// m (I - K) (v* - v) - m K b dt: what a step has to bring a particle from v to v*, b of (W14).
    #[inline(always)]
    pub(super) fn inertia_to(&self, mass: f64, i: usize, change: &Vector<D>, dt: f64) -> Vector<D> {
        let inertia = self.inertia(mass, i, change);
        match self.even_slope.get(i) {
            None => inertia,
            Some(b) => {
                let even = apply(&self.lean[i], b);
                std::array::from_fn(|c| inertia[c] - mass * dt * even[c])
            }
        }
    }

    /// m (v - v* - b dt) [N s], times what of K was kept: what each wall point's part of K makes an impulse of.
    pub(super) fn leant(
        &self,
        state: &State<D>,
        (i, whole): (usize, &Tensor<D>),
        dt: f64,
    ) -> Vector<D> {
        let Some(k) = self.lean.get(i) else {
            return [0.0; D];
        };
        let kept = if trace(whole) > 0.0 {
            trace(k) / trace(whole)
        } else {
            0.0
        };
        let m = kept * state.grains.mass[i];
        let b = self.even_slope.get(i).copied().unwrap_or([0.0; D]);
        let (v, aim) = (&self.viscous.velocity[i], &self.prediction[i].velocity);
        std::array::from_fn(|a| m * (v[a] - aim[a] - dt * b[a]))
    }
}

/// K, less of it where its largest eigenvalue would be more than [`MOST`].
fn bounded<const D: usize>(k: &Tensor<D>) -> Tensor<D> {
    // Row sums bound eigenvalues.
    let rows = k.map(|row| row.iter().map(|c| c.abs()).sum::<f64>());
    let most = rows.iter().copied().fold(0.0, f64::max);
    if most <= MOST {
        return *k;
    }
    k.map(|row| scale(MOST / most, &row))
}
