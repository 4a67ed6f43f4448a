//! Sums over pairs and ghosts, written as [A] prints them. Masses of planar scenes are per width.
//!
//! Symbols: x = r_ij, v = v_ij, grad_i W_ij = F x, P = p/rho^2. A ghost j of particle i has the mass, density and total
//! stress of i (times its share of a full particle), and v_ij = beta v_i, beta = min(beta_max, 1 + d_j/d_i), with the
//! distances d from the wall's surface ([A] eqs. 34 to 36).

use crate::math::{CHUNK, Tensor, Vector, add_outer, dot, scale, sub};
use crate::solver::Solver;
use crate::state::State;

use super::response::Response;
use super::{PaperA, Sweeps, Work};

/// What one sweep gives a particle.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rates {
    /// R = D rho/Dt [kg/(m^3 s)].
    pub(super) density: f64,
    /// gamma = sqrt(2 eps:eps), eps as printed: its trace is not taken out [1/s].
    pub(super) shear: f64,
}

/// What neighbours and ghosts add up to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Gathered<const D: usize> {
    /// sum m_j v.grad W [kg/(m^3 s)].
    pub(super) continuity: f64,
    /// - sum m_j/rho_j v (x) grad W [1/s].
    pub(super) gradient: Tensor<D>,
}

impl<const D: usize> Gathered<D> {
    const NOTHING: Self = Self {
        continuity: 0.0,
        gradient: [[0.0; D]; D],
    };

    #[inline(always)]
    fn add(&mut self, mass: f64, rho: f64, v: &Vector<D>, at: &Seen<D>) {
        let w = scale(at.f, &at.x);
        self.continuity += mass * dot(v, &w);
        add_outer(&mut self.gradient, -mass / rho, v, &w);
    }

    #[inline(always)]
    pub(super) fn rates(&self) -> Rates {
        Rates {
            density: self.continuity,
            shear: shear_rate_as_printed(&self.gradient),
        }
    }
}

/// Where a neighbour or ghost is, seen from particle i.
struct Seen<const D: usize> {
    /// r_ij [m].
    x: Vector<D>,
    /// Its square [m^2].
    r2: f64,
    /// F <= 0 [1/m^(D+2)].
    f: f64,
}

/// A ghost within the support of a particle.
struct Ghost<const D: usize> {
    at: Seen<D>,
    /// Its mass, per width [kg].
    mass: f64,
    /// v_ij over v_i.
    beta: f64,
    /// Its number among the wall points.
    wall: usize,
}

impl<const D: usize> Solver<D> {
    /// D rho/Dt ([A] eq. 26) and the shear rate ([A] eq. 31, symmetrised) at `velocity` and `density`.
    pub(super) fn sweep_rates(
        &mut self,
        choices: &PaperA,
        state: &State<D>,
        velocity: &[Vector<D>],
        density: &[f64],
        out: &mut Vec<Rates>,
    ) {
        let grains = &state.grains;
        out.resize(grains.len(), Rates::default());
        if choices.sweeps == Sweeps::Lanes {
            self.sweep_rates_in_lanes(choices, state, velocity, density, out);
            return;
        }
        self.workers
            .blocks_read(&self.lists.blocks, out, |block, first, out| {
                for (row, rates) in out.iter_mut().enumerate() {
                    let i = first + row;
                    let mut sums = Gathered::NOTHING;
                    for &j in block.row(row) {
                        let j = j as usize;
                        let Some(at) = self.neighbour(state, i, j) else {
                            continue;
                        };
                        let v = sub(&velocity[i], &velocity[j]);
                        sums.add(grains.mass[j] / self.width, density[j], &v, &at);
                    }
                    let walls = block.wall_row(row);
                    self.add_ghost_rates(choices, state, i, walls, (velocity, density), &mut sums);
                    *rates = sums.rates();
                }
            });
    }

    #[inline(always)]
    pub(super) fn add_ghost_rates(
        &self,
        choices: &PaperA,
        state: &State<D>,
        i: usize,
        walls: &[u32],
        (velocity, density): (&[Vector<D>], &[f64]),
        sums: &mut Gathered<D>,
    ) {
        for ghost in self.ghosts(choices, state, i, walls) {
            let v = scale(ghost.beta, &velocity[i]);
            sums.add(ghost.mass, density[i], &v, &ghost.at);
        }
    }

    /// Dv/Dt ([A] eq. 37) from the velocities and responses at n + 1/2, where rates were swept last.
    pub(super) fn sweep_accelerations(
        &mut self,
        choices: &PaperA,
        state: &State<D>,
        work: &mut Work<D>,
    ) {
        let grains = &state.grains;
        work.acceleration.resize(grains.len(), [0.0; D]);
        if choices.sweeps == Sweeps::Lanes {
            self.sweep_accelerations_in_lanes(choices, state, work);
            return;
        }
        let (velocity, response) = (&work.half_velocity, &work.response);
        self.workers.blocks_read(
            &self.lists.blocks,
            &mut work.acceleration,
            |block, first, out| {
                for (row, a) in out.iter_mut().enumerate() {
                    let i = first + row;
                    *a = self.gravity;
                    for &j in block.row(row) {
                        let j = j as usize;
                        let Some(at) = self.neighbour(state, i, j) else {
                            continue;
                        };
                        let v = sub(&velocity[i], &velocity[j]);
                        let stress = self.pair_stress(&response[i], &response[j], &v, &at);
                        push(a, -grains.mass[j] / self.width * stress, &at);
                    }
                    let own = (&velocity[i], &response[i]);
                    self.add_ghost_acceleration(choices, state, i, block.wall_row(row), own, a);
                }
            },
        );
    }

    #[inline(always)]
    pub(super) fn add_ghost_acceleration(
        &self,
        choices: &PaperA,
        state: &State<D>,
        i: usize,
        walls: &[u32],
        (v, response): (&Vector<D>, &Response),
        a: &mut Vector<D>,
    ) {
        for ghost in self.ghosts(choices, state, i, walls) {
            let v = scale(ghost.beta, v);
            let stress = self.pair_stress(response, response, &v, &ghost.at);
            push(a, -ghost.mass * stress, &ghost.at);
        }
    }

    /// Impulse of the material on walls whose force somebody reads, over one step [N s].
    pub(super) fn react_paper_a(
        &self,
        choices: &PaperA,
        state: &mut State<D>,
        work: &Work<D>,
        dt: f64,
    ) {
        if !self.walls.groups.iter().any(|g| g.wants_force) {
            return;
        }
        for (b, block) in self.lists.blocks.iter().enumerate() {
            for row in 0..block.rows() {
                let i = b * CHUNK + row;
                let mut felt = Vec::new();
                for ghost in self.ghosts(choices, state, i, block.wall_row(row)) {
                    let read = |group: u16| self.walls.groups[usize::from(group)].wants_force;
                    let mut bearers = self
                        .walls
                        .bearers(ghost.wall)
                        .filter(|b| read(b.0))
                        .peekable();
                    if bearers.peek().is_some() {
                        let v = scale(ghost.beta, &work.half_velocity[i]);
                        let own = &work.response[i];
                        let mut a = [0.0; D];
                        let stress = self.pair_stress(own, own, &v, &ghost.at);
                        push(&mut a, -ghost.mass * stress, &ghost.at);
                        felt.extend(bearers.map(|(group, share)| (group, scale(share, &a))));
                    }
                }
                for (group, a) in felt {
                    for k in 0..D {
                        state.impulse[usize::from(group)][k] -= dt * state.grains.mass[i] * a[k];
                    }
                }
            }
        }
    }

    /// What stands in the brackets of [A] eq. 37, so that Dv_i/Dt = g - sum m_j (...) F x:
    /// P_i + P_j + Pi_ij - 2 (D + 2) eta_ij (v.x)/(r^2 rho_i rho_j), eta_ij the harmonic mean; printed with 8, right in the
    /// plane only. Pi_ij ([A] eq. 38) acts on approaching and receding pairs alike and has nothing beside r^2.
    #[inline(always)]
    fn pair_stress(&self, i: &Response, j: &Response, v: &Vector<D>, at: &Seen<D>) -> f64 {
        let stretch = dot(v, &at.x) / at.r2;
        let mut stress = i.pressure_term + j.pressure_term;
        let both = i.viscosity + j.viscosity;
        if both > 0.0 {
            let mean = 2.0 * i.viscosity * j.viscosity / both;
            let factor = 2.0 * (D as f64 + 2.0);
            stress -= factor * mean * stretch / (i.density * j.density);
        }
        let alpha = self.numerics.artificial_viscosity;
        if alpha > 0.0 {
            let sound = 0.5 * (i.sound_speed + j.sound_speed);
            let rho = 0.5 * (i.density + j.density);
            stress -= alpha * self.kernel.h * sound / rho * stretch;
        }
        stress
    }

    /// Neighbour j of particle i, if it is within the support.
    #[inline(always)]
    fn neighbour(&self, state: &State<D>, i: usize, j: usize) -> Option<Seen<D>> {
        let position = &state.grains.position;
        self.seen(&position[i], &position[j])
    }

    #[inline(always)]
    fn seen(&self, from: &Vector<D>, to: &Vector<D>) -> Option<Seen<D>> {
        let x = self.periodic.difference(from, to);
        let r2 = dot(&x, &x);
        let support = self.kernel.support();
        (r2 < support * support && r2 > 0.0).then(|| Seen {
            x,
            r2,
            f: self.kernel.f(r2.sqrt()),
        })
    }

    /// Ghosts within the support of particle i.
    #[inline(always)]
    fn ghosts<'s>(
        &'s self,
        choices: &PaperA,
        state: &'s State<D>,
        i: usize,
        near: &'s [u32],
    ) -> impl Iterator<Item = Ghost<D>> + 's {
        let beta_max = choices.ghost_velocity_factor;
        let position = &state.grains.position[i];
        let mass = state.grains.mass[i] / self.width;
        near.iter().filter_map(move |&w| {
            let w = w as usize;
            let at = self.seen(position, &self.walls.position[w])?;
            let behind = self.ghost_depth[w];
            let before = dot(&at.x, &self.walls.normal[w]) - behind;
            // A particle on or behind the surface sees what one very close to it sees.
            let beta = if before > 0.0 {
                (1.0 + behind / before).min(beta_max)
            } else {
                beta_max
            };
            Some(Ghost {
                at,
                mass: self.walls.weight[w] * mass,
                beta,
                wall: w,
            })
        })
    }
}

/// a += factor grad W.
#[inline(always)]
fn push<const D: usize>(a: &mut Vector<D>, factor: f64, at: &Seen<D>) {
    for (a, x) in a.iter_mut().zip(&at.x) {
        *a += factor * at.f * x;
    }
}

/// sqrt(2 eps:eps) of eps = sym grad v; in the default scheme it is the deviator's.
fn shear_rate_as_printed<const D: usize>(gradient: &Tensor<D>) -> f64 {
    let mut sum = 0.0;
    for a in 0..D {
        for b in 0..D {
            let eps = 0.5 * (gradient[a][b] + gradient[b][a]);
            sum += eps * eps;
        }
    }
    (2.0 * sum).sqrt()
}
