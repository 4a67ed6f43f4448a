//! What axisymmetric scenes add to a sweep (docs/theory.md, "Axisymmetric scenes", R1 to R5): nothing of this is
//! computed or stored in other scenes.
//!
//! A particle is a ring of radius r, of length w = 2 pi r and volume V = m/rho. Pair coefficients are
//! g_ij = V_j (1/w_i + 1/w_j)/2 grad_i W_ij: then V_i g_ij = -V_j g_ji, and all sums over pairs read as in the plane.
//! Rings do not meet their images across the axis, but where they are shifted; what is missing there is local, a share `axis` of v_r,
//! and hoop strain is v_r `hoop`.

use crate::math::{Geometry, Tensor, Vector, add_outer, dot, norm, scale, sub, trace};
use crate::state::State;

use super::Solver;
use super::pair::Block;

/// What one ring has beside its pairs, from its place and its neighbours'.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ring {
    /// 1/r: hoop strain rate over v_r [1/m].
    pub(super) hoop: f64,
    /// What G_rr takes of v_r for the material that is missing across the axis; with it, the force of a uniform
    /// pressure vanishes [1/m].
    pub(super) axis: f64,
    /// What div v takes of the images across the axis, with weights of opposite sign; with it, div v of a flow that is
    /// linear in r and z is right up to the axis [1/s].
    pub(super) closing: f64,
}

impl<const D: usize> Solver<D> {
    /// 1/r of a place, bounded near the axis [1/m].
    #[inline(always)]
    fn hoop_at(&self, x: &Vector<D>) -> f64 {
        1.0 / x[0].max(Geometry::LEAST_RADIUS * self.numerics.spacing)
    }

    /// Fills `self.rings` from positions, velocities and volumes; leaves it empty unless the scene is axisymmetric.
    pub(super) fn update_rings(&mut self, state: &State<D>) {
        if !self.geometry.is_axisymmetric() {
            return;
        }
        let mut rings = std::mem::take(&mut self.rings);
        rings.resize(state.grains.len(), Ring::default());
        self.workers
            .blocks_read(&self.lists.blocks, &mut rings, |block, first, out| {
                for (row, ring) in out.iter_mut().enumerate() {
                    *ring = self.ring(state, block, first + row, row);
                }
            });
        self.rings = rings;
    }

    fn ring(&self, state: &State<D>, block: &Block<D>, i: usize, row: usize) -> Ring {
        let grains = &state.grains;
        let (xi, vi) = (&grains.position[i], &grains.velocity[i]);
        let hoop = self.hoop_at(xi);
        let support = self.kernel.support();
        let mut ring = Ring {
            hoop,
            ..Ring::default()
        };
        if xi[0] >= support {
            return ring;
        }
        // An image is farther than what it is an image of: all that matter are of neighbours. A ring's own image has
        // no weight, (w_i - w_i)/2.
        let mut add = |other: &Vector<D>, area: f64, v: Vector<D>| {
            let mut x = self.periodic.difference(xi, other);
            x[0] = xi[0] + other[0];
            let r2 = dot(&x, &x);
            if r2 < support * support && r2 > 0.0 {
                let g = scale(area * self.kernel.f(r2.sqrt()), &x);
                ring.axis -= 2.0 * g[0];
                ring.closing += dot(&v, &g);
            }
        };
        for &j in block.row(row) {
            let j = j as usize;
            let xj = &grains.position[j];
            let mut v = sub(&grains.velocity[j], vi);
            v[0] = -grains.velocity[j][0] - vi[0];
            let difference = 0.5 / std::f64::consts::TAU * (self.hoop_at(xj) - hoop);
            add(xj, self.volume[j] * difference, v);
        }
        for &w in block.wall_row(row) {
            let w = w as usize;
            let xw = &self.walls.position[w];
            let vw = self.point_velocity(w as u32);
            let mut v = scale(2.0, &sub(&vw, vi));
            v[0] = -2.0 * (vw[0] + vi[0]);
            let weight = 0.5 * self.walls.weight[w] * (1.0 - xw[0] * hoop);
            add(xw, self.lattice_cell() * weight, v);
        }
        ring
    }

    /// Area by which ring i sees a wall point of this weight, times (w_i + w_w)/(2 w_i) [m^2].
    ///
    /// A cell of the lattice, not the ring's own section: that one shrinks as the ring grows, and a ring at the axis
    /// would slip under its neighbours through the floor.
    #[inline(always)]
    pub(super) fn ring_wall_area(&self, i: usize, wall: u32, weight: f64) -> f64 {
        let radius = self.walls.position[wall as usize][0];
        self.lattice_cell() * weight * 0.5 * (1.0 + radius * self.rings[i].hoop)
    }

    /// V_j of a neighbour as pair coefficients have it: the volume, or (1/w_i + 1/w_j)/2 of a ring's (R2).
    #[inline(always)]
    pub(super) fn volume_seen(&self, i: usize, j: usize) -> f64 {
        if !self.geometry.is_axisymmetric() {
            return self.volume[j];
        }
        let hoops = self.rings[i].hoop + self.rings[j].hoop;
        self.volume[j] * 0.5 / std::f64::consts::TAU * hoops
    }

    /// grad C [1/m] and M [1] of ring i in the section: pair coefficients are longer the further out a neighbour is, and would push all
    /// to the axis. Beyond the axis lies the section's image.
    pub(super) fn section_sums(
        &self,
        state: &State<D>,
        block: &Block<D>,
        (i, row): (usize, usize),
    ) -> (Vector<D>, Tensor<D>) {
        let place = &state.grains.position;
        let support = self.kernel.support();
        let (mut slope, mut moment) = ([0.0; D], [[0.0; D]; D]);
        let mut add = |x: &Vector<D>, area: f64| {
            let r = norm(x);
            if r > 0.0 && r < support {
                let weight = area * self.kernel.f(r);
                for k in 0..D {
                    slope[k] += weight * x[k];
                }
                add_outer(&mut moment, -weight, x, x);
            }
        };
        let mut add_with_image = |other: &Vector<D>, area: f64| {
            let mut x = self.periodic.difference(&place[i], other);
            add(&x, area);
            x[0] = place[i][0] + other[0];
            add(&x, area);
        };
        let area = |j: usize| self.volume[j] * self.rings[j].hoop / std::f64::consts::TAU;
        add_with_image(&place[i], area(i));
        for &j in block.row(row).iter().filter(|&&j| j as usize != i) {
            add_with_image(&place[j as usize], area(j as usize));
        }
        for &w in block.wall_row(row) {
            let w = w as usize;
            let area = self.lattice_cell() * self.walls.weight[w];
            add_with_image(&self.walls.position[w], area);
        }
        (slope, moment)
    }

    /// (w_w - w_i)/(w_w + w_i): the part of ring i's g of a wall point that it has because they are not of one length [1]; 0 unless
    /// particles are rings.
    #[inline(always)]
    pub(super) fn ring_part(&self, i: usize, wall: u32) -> f64 {
        if !self.geometry.is_axisymmetric() {
            return 0.0;
        }
        let ratio = self.walls.position[wall as usize][0] * self.rings[i].hoop;
        (ratio - 1.0) / (ratio + 1.0)
    }

    /// dp^2 [m^2].
    #[inline(always)]
    fn lattice_cell(&self) -> f64 {
        self.numerics.spacing * self.numerics.spacing
    }

    /// Hoop strain rate of particle i at velocity v [1/s]; 0 unless particles are rings.
    #[inline(always)]
    pub(super) fn hoop_rate(&self, i: usize, v: &Vector<D>) -> f64 {
        if self.geometry.is_axisymmetric() {
            self.rings[i].hoop * v[0]
        } else {
            0.0
        }
    }

    /// What G_rr takes of v_r near the axis, times v_r [1/s]; 0 unless particles are rings.
    #[inline(always)]
    pub(super) fn axis_rate(&self, i: usize, v: &Vector<D>) -> f64 {
        if self.geometry.is_axisymmetric() {
            self.rings[i].axis * v[0]
        } else {
            0.0
        }
    }

    /// Viscous force of hoop and axis terms on ring i against e_r, per volume [N/m^3]: tau_tt = -(tau_rr + tau_zz) on
    /// the hoop strain and tau_rr on the axis' share, minus the adjoint of the strain; and the pair form's share,
    /// which sees no hoop strain by itself.
    #[inline(always)]
    pub(super) fn ring_drag(&self, i: usize, v: &Vector<D>, tau: &Tensor<D>, share: f64) -> f64 {
        let Ring { hoop, axis, .. } = self.rings[i];
        let hoop_stress = -trace(tau);
        tau[0][0] * axis + hoop_stress * hoop + share * self.pair_viscosity[i] * hoop * hoop * v[0]
    }

    /// Hoop part of the Jacobi block's rr, per volume [Pa s/m^2]: 2 eta e:e of a hoop strain has 4/3.
    #[inline(always)]
    pub(super) fn ring_stiffness(&self, i: usize) -> f64 {
        let hoop = self.rings[i].hoop;
        4.0 / 3.0 * self.pair_viscosity[i] * hoop * hoop
    }
}
