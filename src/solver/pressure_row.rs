//! One row of the pressure sweep: particle i against its neighbours, four at a time (docs/theory.md, E7, E8, E17). Walls are
//! left out.
//!
//! Symbols as in `pressure`; c = 2 (D + 2)/(|g| r) of a pair.

use std::ops::Range;

use crate::material::Material;
use crate::math::{Four, LANES, Lanes, Quad, Tensor, Vector};
use crate::state::State;

use super::Solver;
use super::meeting::{KINDS, share};
use super::pair::Block;
use super::pressure::Prediction;

/// Particle i, and its sums over neighbours. PLAIN: see [`Solver::is_plain`].
struct PressureRow<'s, L: Lanes, const D: usize, const PLAIN: bool> {
    solver: &'s Solver<D>,
    state: &'s State<D>,
    lanes: L,
    i: usize,
    /// Its load: pressure [Pa], shear rate [1/s], density [kg/m^3], pair viscosity [Pa s].
    pressure: f64,
    shear: f64,
    rho: f64,
    eta: f64,
    /// Its sound speed [m/s].
    c0: f64,
    /// Its pressure with bulk friction, where a material has that, and those of all particles; none where not [Pa].
    own_normal: f64,
    normal: Option<&'s [f64]>,
    /// p T of (F3) [Pa]; none where rows do not slide.
    uneven: Option<&'s Tensor<D>>,
    /// alpha h c0 against all neighbours, and against those of its own kind [m^2/s].
    damp: f64,
    own_damping: f64,
    /// Acoustic impedances of all materials, none where they are alike, and its own [Pa s/m].
    impedances: &'s [f64],
    impedance: f64,
    /// Whether it has no yield stress.
    flows: bool,
    /// Half the time that opens the diffusion's gate [s].
    gate: Four<L>,
    /// 1 over the pressure of a spacing's depth [1/Pa].
    head: f64,
    /// Share of the viscosity that pairs bear, twice, and that of the stress [1].
    by_pairs: Four<L>,
    by_stress: Four<L>,
    force: [Four<L>; D],
    resistance: [[Four<L>; D]; D],
    diffusion: Four<L>,
}

/// Four neighbours.
struct Near<'b, L: Lanes, const D: usize> {
    j: &'b [u32; LANES],
    pressure: Four<L>,
    shear: Four<L>,
    rho: Four<L>,
    eta: Four<L>,
    /// g_ij [1/m], its square, and c [m^2].
    g: [Four<L>; D],
    g2: Four<L>,
    c: Four<L>,
}

impl<'b, L: Lanes, const D: usize> Near<'b, L, D> {
    #[inline(always)]
    fn load(lanes: L, loads: &[Quad], j: &'b [u32; LANES], g: &[Quad; D], c: &Quad) -> Self {
        let [pressure, shear, rho, eta] = Four::transpose(
            lanes,
            [
                &loads[j[0] as usize],
                &loads[j[1] as usize],
                &loads[j[2] as usize],
                &loads[j[3] as usize],
            ],
        );
        let zero = Four::splat(lanes, 0.0);
        let mut g_ij = [zero; D];
        for k in 0..D {
            g_ij[k] = Four::load(lanes, &g[k]);
        }
        let mut g2 = zero;
        for g in g_ij {
            g2 += g * g;
        }
        Self {
            j,
            pressure,
            shear,
            rho,
            eta,
            g: g_ij,
            g2,
            c: Four::load(lanes, c),
        }
    }
}

impl<const D: usize> Solver<D> {
    /// Row i; PLAIN: see [`Self::is_plain`]. Multiplies its pairs' coefficients by their viscosity.
    #[inline(always)]
    pub(super) fn predict<L: Lanes, const PLAIN: bool>(
        &self,
        lanes: L,
        state: &State<D>,
        loads: &[Quad],
        dt: f64,
        block: &mut Block<D>,
        (i, row): (usize, usize),
    ) -> Prediction<D> {
        let mut sums = PressureRow::<L, D, PLAIN>::new(self, lanes, state, loads, i);
        let kinds = block.kinds(row);
        let range = block.groups(row);
        let (j, g) = (&block.j[range.clone()], &block.g[range.clone()]);
        for (n, ((j, g), c)) in (range.start..).zip(j.iter().zip(g).zip(&mut block.c[range])) {
            let near = Near::load(lanes, loads, j, g, c);
            sums.push(&near);
            sums.damp(&near);
            sums.diffuse(&near);
            *c = sums.resist(&near, n, &kinds).store();
        }
        sums.finish(dt)
    }

    /// alpha less what the material's own viscosity is worth: nu = alpha h c/(2 (D + 2)).
    pub(super) fn missing_viscosity(&self, m: &Material) -> f64 {
        if m.artificial_viscosity == 0.0 || !m.is_newtonian() {
            return 0.0;
        }
        let own = 2.0 * (D as f64 + 2.0) * m.viscous.consistency
            / (m.rest_density() * self.kernel.h * self.sound_speed_of(m));
        (m.artificial_viscosity - own).max(0.0)
    }
}

impl<'s, L: Lanes, const D: usize, const PLAIN: bool> PressureRow<'s, L, D, PLAIN> {
    #[inline(always)]
    fn new(solver: &'s Solver<D>, lanes: L, state: &'s State<D>, loads: &[Quad], i: usize) -> Self {
        let numerics = &solver.numerics;
        let splat = |a: f64| Four::splat(lanes, a);
        let [pressure, shear, rho, eta] = loads[i].0;
        let material = &solver.materials[state.grains.phase[i] as usize];
        let c0 = solver.sound_speed_of(material);
        let normal =
            (!PLAIN && !solver.normal_pressure.is_empty()).then_some(&solver.normal_pressure[..]);
        let by_pairs = numerics.pair_viscosity_share;
        Self {
            solver,
            state,
            lanes,
            i,
            pressure,
            shear,
            rho,
            eta,
            c0,
            own_normal: normal.map_or(pressure, |n| n[i]),
            normal,
            uneven: solver.uneven_pressure.get(i).filter(|_| !PLAIN),
            damp: numerics.artificial_viscosity * solver.kernel.h * c0,
            own_damping: solver.missing_viscosity(material) * solver.kernel.h * c0,
            impedances: &solver.impedances,
            impedance: solver
                .impedances
                .get(usize::from(state.grains.phase[i]))
                .map_or(0.0, |z| *z),
            flows: solver.flows.get(i).is_some_and(|f| *f > 0.0),
            gate: splat(0.5 * numerics.diffusion_gate_time),
            head: 1.0 / (rho * solver.gravity_norm * numerics.spacing).max(f64::MIN_POSITIVE),
            by_pairs: splat(2.0 * by_pairs),
            by_stress: splat(1.0 - by_pairs),
            force: [splat(0.0); D],
            resistance: [[splat(0.0); D]; D],
            diffusion: splat(0.0),
        }
    }

    #[inline(always)]
    fn splat(&self, a: f64) -> Four<L> {
        Four::splat(self.lanes, a)
    }

    /// V F over |g|^2 c: grad W = F x, so that |g|^2 c = 2 (D + 2) V |F|.
    #[inline(always)]
    fn to_f(&self) -> Four<L> {
        self.splat(-1.0 / (2.0 * (D as f64 + 2.0)))
    }

    /// Pressure, and less of it where rows slide (F3).
    #[inline(always)]
    fn push(&mut self, near: &Near<'_, L, D>) {
        let (j, g) = (near.j, &near.g);
        let push = self.normal.map_or(near.pressure, |n| {
            Four::gather(self.lanes, |m| n[j[m] as usize])
        });
        let push = self.splat(self.own_normal) + push;
        for k in 0..D {
            self.force[k] -= push * g[k];
        }
        let Some(own) = self.uneven else {
            return;
        };
        // Symmetric, and without a trace.
        let mut last = self.splat(0.0);
        for a in 0..D {
            for b in a..D {
                if a + 1 == D {
                    self.force[a] -= last * g[a];
                    continue;
                }
                let other = |m: usize| self.solver.uneven_pressure[j[m] as usize][a][b];
                let both = self.splat(own[a][b]) + Four::gather(self.lanes, other);
                self.force[a] += both * g[b];
                if a == b {
                    last += both;
                } else {
                    self.force[b] += both * g[a];
                }
            }
        }
    }

    /// Artificial viscosity, [A] eq. 38, c the mean of both: (v.x)/r^2 = (v.g) F/|g|^2, on approaching and receding pairs alike.
    #[inline(always)]
    fn damp(&mut self, near: &Near<'_, L, D>) {
        if PLAIN || !(self.damp > 0.0 || self.own_damping > 0.0) {
            return;
        }
        let (grains, i, j) = (&self.state.grains, self.i, near.j);
        let mut along = self.splat(0.0);
        for k in 0..D {
            let vj = Four::gather(self.lanes, |m| grains.velocity[j[m] as usize][k]);
            along += (self.splat(grains.velocity[i][k]) - vj) * near.g[k];
        }
        let mut alpha = self.splat(self.damp);
        let materials = &self.solver.materials;
        if self.damp > 0.0 && materials.iter().any(|m| m.sound_speed.is_some()) {
            // That of the pair, or what one loses the other does not gain.
            let of = |m: usize| {
                let material = &materials[grains.phase[j[m] as usize] as usize];
                self.solver.sound_speed_of(material)
            };
            let mean = self.splat(self.c0) + Four::gather(self.lanes, of);
            alpha = alpha * mean * self.splat(0.5 / self.c0);
        }
        if self.own_damping > 0.0 {
            // That of its own kind.
            let same =
                |m: usize| f64::from(u8::from(grains.phase[j[m] as usize] == grains.phase[i]));
            let damped = &self.solver.damped;
            let share = |m: usize| same(m) * 0.5 * (damped[i] + damped[j[m] as usize]);
            alpha += self.splat(self.own_damping) * Four::gather(self.lanes, share);
        }
        // Beside what is far heavier no more than twice what its like would give, or it is too stiff for a step.
        let lighter = self.splat(self.rho).min(near.rho);
        let rho = self.mean_rho(near).min(lighter + lighter);
        let damping = alpha * rho * along * self.to_f() * near.c;
        for k in 0..D {
            self.force[k] += damping * near.g[k];
        }
    }

    #[inline(always)]
    fn mean_rho(&self, near: &Near<'_, L, D>) -> Four<L> {
        self.splat(0.5) * (self.splat(self.rho) + near.rho)
    }

    /// Diffusion of density on pressure (E8).
    #[inline(always)]
    fn diffuse(&mut self, near: &Near<'_, L, D>) {
        if self.solver.numerics.density_diffusion <= 0.0 {
            return;
        }
        let (zero, one) = (self.splat(0.0), self.splat(1.0));
        let mut down = zero;
        for k in 0..D {
            down += self.splat(self.solver.gravity[k]) * near.g[k];
        }
        let sum = self.splat(self.pressure) + near.pressure;
        let mut open = (self.gate * (self.splat(self.shear) + near.shear)).min(one);
        if !PLAIN && self.flows {
            let flows = |m: usize| self.solver.flows[near.j[m] as usize];
            open = open.max(Four::gather(self.lanes, flows));
        }
        // The hydrostatic part is taken out where there is a hydrostatic load to speak of.
        let loaded = (sum * self.splat(self.head)).min(one);
        let still = self.mean_rho(near) * down * loaded;
        let steep = (self.splat(self.pressure) - near.pressure) * (self.to_f() * near.g2 * near.c);
        let mut change = open * (steep - still);
        if !PLAIN && !self.impedances.is_empty() {
            change = change * self.share_of_diffusion(near);
        }
        self.diffusion += sum.where_greater(zero, change);
    }

    /// z_i/max(z_i, z_j): what pairs of unlike materials may diffuse without gaining energy (E8).
    #[inline(always)]
    fn share_of_diffusion(&self, near: &Near<'_, L, D>) -> Four<L> {
        let phase = &self.state.grains.phase;
        Four::gather(self.lanes, |m| {
            let other = self.impedances[usize::from(phase[near.j[m] as usize])];
            self.impedance / self.impedance.max(other)
        })
    }

    /// What resists, of group n of a row with these kinds of neighbours. Returns c times the viscosity of pairs [Pa s m^2].
    #[inline(always)]
    fn resist(
        &mut self,
        near: &Near<'_, L, D>,
        n: usize,
        [like, other, harder, _]: &[Range<usize>; KINDS],
    ) -> Four<L> {
        let (two, eta) = (self.splat(2.0), self.splat(self.eta));
        // Harmonic mean of the viscosities; 0 if both are.
        let both = (eta + near.eta).max(self.splat(f64::MIN_POSITIVE));
        let weighted = near.c * (two * eta * near.eta).over(both);
        let mut stress = self.by_stress * near.eta;
        if !PLAIN && n >= like.end {
            // m_ji is in the stress and in its force.
            let m = match n {
                n if n < other.end => share(self.lanes, near.eta, eta),
                n if n < harder.end => self.splat(0.0),
                _ => two,
            };
            stress = m * m * stress;
        }
        let mut twice = self.by_pairs * weighted;
        if D > 2 {
            twice += self.splat(1.0 - 2.0 / D as f64) * stress;
        }
        for a in 0..D {
            let cg = twice * near.g[a];
            for b in a..D {
                self.resistance[a][b] += cg * near.g[b];
            }
            self.resistance[a][a] += stress * near.g2;
        }
        weighted
    }

    /// What the row comes to.
    #[inline(always)]
    fn finish(&self, dt: f64) -> Prediction<D> {
        let (solver, i) = (self.solver, self.i);
        let specific = solver.specific_volume(self.state, i);
        let mut velocity: Vector<D> = self.state.grains.velocity[i];
        for k in 0..D {
            let mut f = self.force[k].sum();
            if k == 0 && solver.geometry.is_axisymmetric() {
                let ring = &solver.rings[i];
                f += self.own_normal * (ring.hoop + ring.axis);
            }
            velocity[k] += dt * (solver.gravity[k] + specific * f);
        }
        let mut resistance = [[0.0; D]; D];
        for a in 0..D {
            for b in 0..D {
                resistance[a][b] = self.resistance[a.min(b)][a.max(b)].sum();
            }
        }
        let strength = solver.diffusion_strength(self.c0, dt);
        Prediction {
            velocity,
            diffusion: strength * self.diffusion.sum(),
            resistance,
        }
    }
}
