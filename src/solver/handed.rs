//! The shear that a material hands to the others, particle by particle, for gauges: the viscous forces between pairs across its
//! interface as the solve has them (docs/theory.md, E10, E11, F6). What a side's own stress tells is something else: in what moves as
//! a block the exact yield holds any stress whose forces cancel, and between materials stress is spread over a kernel's radius.
//!
//! Symbols: a_ij = V_i g_ij = -a_ji, an area; of pairs of which one particle is of the material and the other is not.

use crate::math::{Geometry, Tensor, Vector, add, add_outer, apply, dot, norm, scale, sub};
use crate::state::State;

use super::record::Record;
use super::{Scheme, Solver, YieldForm};

/// What passes between one particle and those beyond the interface, whichever side it is on.
#[derive(Clone, Copy, Debug)]
pub struct Handed<const D: usize> {
    /// Viscous force on the material from beyond [N].
    pub force: Vector<D>,
    /// sum 2 a_ij out of the material [m^2]: an even stress tau gives the force tau a.
    pub area: Vector<D>,
}

/// What particles bear.
struct Borne<const D: usize> {
    /// tau [Pa].
    stress: Vec<Tensor<D>>,
    /// What (T1) adds [Pa]; empty in scenes without.
    turned: Vec<Tensor<D>>,
}

/// Particle i against neighbour j.
struct Facing<const D: usize> {
    i: usize,
    j: usize,
    /// a_ij [m^2].
    area: Vector<D>,
    /// Distance [m].
    r: f64,
}

impl<const D: usize> Solver<D> {
    /// What each particle of a state that this solver has just stepped, started or resumed has to do with an interface of
    /// `material`; zeros far from it.
    #[must_use]
    pub fn handed(&self, state: &State<D>, material: u8) -> Vec<Handed<D>> {
        let grains = &state.grains;
        let borne = self.borne(state);
        let nothing = Handed {
            force: [0.0; D],
            area: [0.0; D],
        };
        let mut out = vec![nothing; grains.len()];
        self.workers
            .blocks_read(&self.lists.blocks, &mut out, |block, first, out| {
                for (row, handed) in out.iter_mut().enumerate() {
                    let i = first + row;
                    let outwards = if grains.phase[i] == material {
                        1.0
                    } else {
                        -1.0
                    };
                    for &j in block.row(row) {
                        let j = j as usize;
                        let is_across =
                            (grains.phase[i] == material) != (grains.phase[j] == material);
                        if !is_across || grains.drained[i] || grains.drained[j] {
                            continue;
                        }
                        if let Some(pair) = self.facing(state, i, j) {
                            let force = self.drag(state, &borne, &pair);
                            handed.force = add(&handed.force, &scale(outwards, &force));
                            handed.area = add(&handed.area, &scale(2.0 * outwards, &pair.area));
                        }
                    }
                }
            });
        out
    }

    /// Viscous force on i [N], of (E10) and (E11) with m_ij of (F6); in the other schemes m is by viscosities.
    fn drag(&self, state: &State<D>, borne: &Borne<D>, pair: &Facing<D>) -> Vector<D> {
        let &Facing { i, j, .. } = pair;
        let (own, other) = (self.material_of(state, i), self.material_of(state, j));
        let is_default = matches!(self.numerics.scheme, Scheme::Implicit);
        let m = match (own.is_fluid(), other.is_fluid()) {
            // Plain gradients of the other schemes tell the softer side's rate, spread over both: 2 eta_i e_i + 2 eta_i e_j.
            (fluid, other) if !is_default || (fluid && other) => {
                let both = self.viscosity[i] + self.viscosity[j];
                2.0 * self.viscosity[j] / both.max(f64::MIN_POSITIVE)
            }
            (true, false) => 2.0,
            (false, true) => 0.0,
            _ => 1.0,
        };
        let along = |stress: &[Tensor<D>], i: usize| apply(&stress[i], &pair.area);
        let mut force = add(
            &scale(m, &along(&borne.stress, i)),
            &scale(2.0 - m, &along(&borne.stress, j)),
        );
        if !borne.turned.is_empty() {
            let (own, other) = (along(&borne.turned, i), along(&borne.turned, j));
            force = add(&force, &add(&scale(m, &own), &scale(2.0 - m, &other)));
        }
        if !(is_default && own.is_newtonian() && other.is_newtonian()) {
            return force;
        }
        // The pair form's share is what it is, not what the strain rate says.
        let share = self.numerics.pair_viscosity_share;
        let v = &state.grains.velocity;
        let approach = dot(&sub(&v[j], &v[i]), &pair.area);
        let c = 2.0 * (D as f64 + 2.0) / (norm(&pair.area) * pair.r).max(f64::MIN_POSITIVE);
        let paired = scale(share * self.between(i, j) * c * approach, &pair.area);
        add(&scale(1.0 - share, &force), &paired)
    }

    /// None where j is i or out of reach.
    fn facing(&self, state: &State<D>, i: usize, j: usize) -> Option<Facing<D>> {
        let x = &state.grains.position;
        let offset = self.periodic.difference(&x[i], &x[j]);
        let r = norm(&offset);
        if r == 0.0 || r >= self.kernel.support() {
            return None;
        }
        let least = Geometry::LEAST_RADIUS * self.numerics.spacing;
        let across = |i: usize| self.geometry.length_across(&x[i], least);
        let over = 0.5 * (1.0 / across(i) + 1.0 / across(j));
        let volumes = self.whole_volume(state, i) * self.whole_volume(state, j);
        Some(Facing {
            i,
            j,
            area: scale(volumes * over * self.kernel.f(r), &offset),
            r,
        })
    }

    /// Volume of a particle, of the scene's whole width or ring [m^3].
    fn whole_volume(&self, state: &State<D>, i: usize) -> f64 {
        match self.numerics.scheme {
            Scheme::Implicit => self.width * self.volume[i],
            _ => state.grains.mass[i] / state.grains.density[i],
        }
    }

    fn borne(&self, state: &State<D>) -> Borne<D> {
        let grains = &state.grains;
        if !matches!(self.numerics.scheme, Scheme::Implicit) {
            return Borne {
                stress: self.plain_stress(state),
                turned: Vec::new(),
            };
        }
        let mut records = vec![Record::default(); grains.len()];
        self.stress(&grains.velocity, &mut records, true, &[]);
        let whole = 1.0 / (1.0 - self.numerics.pair_viscosity_share);
        let is_exact = matches!(self.numerics.yield_form, YieldForm::Exact { .. });
        let stress: Vec<Tensor<D>> = records
            .iter()
            .enumerate()
            .map(|(i, record)| {
                if is_exact && !self.material_of(state, i).is_newtonian() {
                    grains.stress[i]
                } else {
                    record.stress::<D>().map(|row| scale(whole, &row))
                }
            })
            .collect();
        for (record, (stress, v)) in records.iter_mut().zip(stress.iter().zip(&grains.velocity)) {
            *record = Record::of_stress(stress, v);
        }
        Borne {
            turned: self.turned_stress(&records),
            stress,
        }
    }

    /// 2 eta dev sym G with G by neighbours alone, for the schemes whose sums are not those of (E1).
    fn plain_stress(&self, state: &State<D>) -> Vec<Tensor<D>> {
        let v = &state.grains.velocity;
        let mut out = vec![[[0.0; D]; D]; v.len()];
        self.workers
            .blocks_read(&self.lists.blocks, &mut out, |block, first, out| {
                for (row, stress) in out.iter_mut().enumerate() {
                    let i = first + row;
                    let over = 1.0 / self.whole_volume(state, i);
                    let mut gradient = [[0.0; D]; D];
                    for &j in block.row(row) {
                        let j = j as usize;
                        if let Some(pair) = self.facing(state, i, j) {
                            add_outer(&mut gradient, over, &sub(&v[j], &v[i]), &pair.area);
                        }
                    }
                    let e = self.geometry.strain_deviator(&gradient, 0.0);
                    *stress = e.map(|row| scale(2.0 * self.viscosity[i], &row));
                }
            });
        out
    }
}
