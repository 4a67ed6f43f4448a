//! Flat walls with free slip in space: fluids and dry grains go on along the face as their mirror image (docs/theory.md, W11, W12).
//!
//! A point of such a face gives nothing along itself. In the plane that is all there is to shear; in space what is sheared along the
//! face, as a layer on a bed between side walls, has half of its neighbours there: the first rows saw 0.65 of their strain and took as
//! little of the stress, and a bed's own points, which are whole beside the side wall, took more than came down to them. Images give what
//! lacks,
//!
//!   G_i += sum_j P (v_j - v_i) (x) P g'_ij,   F_i += V_i sum_j P (tau_i + tau_j) P g'_ij,   P = I - n n^T           (W11)
//!   g'_ij = V_j F' (x_i - x_j'),   x_j' = x_j - 2 d_j n the image, d the distance from the face
//!
//! and of the pair form -V_i s_p sum_j eta_ij 2 (D + 2) |F'| V_j t (t . (v_i - v_j))/r'^2, t = P (x_i - x_j). F is the adjoint of G and
//! opposite for j: the wall has no part in it. Across the face all is as the points say.
//!
//! Of grains, where there are no fluids and no pores, pressure goes on along the face, too,
//!
//!   div v_i += sum_j P (v_j - v_i) . g'_ij,   a_i -= (1/rho_i) sum_j (p_i + p_j) P g'_ij                        (W12)
//!
//! each the adjoint of the other: points at p_i show 0.65 of its slope, and what flows beside them bears 0.7 of a spacing's weight too
//! much over the width. Fluids have (W7), and what presses in pores (W10).

use crate::math::{Tensor, Vector, add_outer, along, apply, dot, sub};
use crate::state::State;

use super::Solver;
use super::fluid_row::Row;
use super::mirror::{FLAT, LEVEL};
use super::pair::Block;

/// Faces that one particle sees at most: those of a corner.
const MOST: usize = 3;

/// A flat face as a particle sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceAhead<const D: usize> {
    normal: Vector<D>,
    /// From the face [m]; 0 where there is none.
    distance: f64,
}

/// The faces of a particle.
pub(super) type Faces<const D: usize> = [FaceAhead<D>; MOST];

/// A neighbour's image, as far as it lies along the face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reflection<const D: usize> {
    j: u32,
    normal: Vector<D>,
    /// t [m].
    along: Vector<D>,
    /// V_j F' [1/m^2].
    weight: f64,
    /// 2 (D + 2) V_j |F'|/r'^2 [1/m^4].
    by_pairs: f64,
}

impl<const D: usize> Solver<D> {
    /// Notes the flat faces with free slip that each particle sees, none where it is behind one (an edge, a lip): fluids in scenes that
    /// have some, else dry grains; nothing in the plane.
    pub(super) fn note_faces(&mut self, state: &State<D>) {
        let fixed = &self.walls.groups[..self.fixed_groups];
        let wet_grains_alone = self.has_pores && !self.has_fluids;
        if D < 3 || wet_grains_alone || !fixed.iter().any(|g| g.free_slip) {
            return;
        }
        let none = [FaceAhead {
            normal: [0.0; D],
            distance: 0.0,
        }; MOST];
        let mut faces = std::mem::take(&mut self.faces);
        faces.clear();
        faces.resize(state.grains.len(), none);
        self.workers
            .blocks_read(&self.lists.blocks, &mut faces, |block, first, out| {
                for (row, o) in out.iter_mut().enumerate() {
                    let (i, near) = (first + row, block.wall_row(row));
                    let is_fluid = self.materials[state.grains.phase[i] as usize].is_fluid();
                    if is_fluid == self.has_fluids {
                        *o = self.faces_of(state, i, near, &none).unwrap_or(none);
                    }
                }
            });
        self.faces = faces;
    }

    /// The faces of wall points with free slip near particle i; `None` beside gates, edges and bends.
    fn faces_of(
        &self,
        state: &State<D>,
        i: usize,
        near: &[u32],
        none: &Faces<D>,
    ) -> Option<Faces<D>> {
        let xi = &state.grains.position[i];
        let (mut faces, mut count) = (*none, 0);
        for &wall in near {
            let group = self.walls.group[wall as usize] as usize;
            if !self.walls.groups[group].free_slip || self.walls.weight[wall as usize] == 0.0 {
                continue;
            }
            let (x, r) = self.wall_offset(xi, wall);
            if r >= self.kernel.support() {
                continue;
            }
            if group >= self.fixed_groups {
                return None;
            }
            let normal = self.wall_normal(xi, wall, state);
            // The face lies half a spacing before the first row of points.
            let distance = dot(&normal, &x) - 0.5 * self.numerics.spacing;
            let same = |f: &&mut FaceAhead<D>| dot(&f.normal, &normal) > 1.0 - FLAT;
            if let Some(face) = faces[..count].iter_mut().find(same) {
                face.distance = face.distance.min(distance);
            } else if count < MOST {
                faces[count] = FaceAhead { normal, distance };
                count += 1;
            } else {
                return None;
            }
        }
        let ahead = faces[..count].iter().all(|f| f.distance > 0.0);
        ahead.then_some(faces)
    }

    /// Appends the images that particle i sees of its neighbours, and what they add to the sums of its row.
    pub(super) fn find_reflections(
        &self,
        state: &State<D>,
        i: usize,
        block: &mut Block<D>,
        near: &[u32],
        sums: &mut Row<D>,
    ) {
        let Some(own) = self.faces.get(i) else {
            return;
        };
        let (x, v) = (&state.grains.position, &state.grains.velocity);
        for face in own.iter().filter(|f| f.distance > 0.0) {
            for &j in near {
                // Between fluids no more than (F6) says.
                let same =
                    !self.has_fluids || state.grains.phase[i] == state.grains.phase[j as usize];
                if j as usize == i || !same {
                    continue;
                }
                // Most stand too far from the face for their images to reach i.
                let reach = |f: &&FaceAhead<D>| {
                    f.distance > 0.0
                        && f.distance + face.distance < self.kernel.support()
                        && dot(&f.normal, &face.normal) > 1.0 - FLAT
                };
                let Some(other) = self.faces[j as usize].iter().find(reach) else {
                    continue;
                };
                let offset = self.periodic.difference(&x[i], &x[j as usize]);
                let Some(image) = self.reflection(j, (face, other), &offset) else {
                    continue;
                };
                let against = dot(&image.along, &sub(&v[i], &v[j as usize]));
                sums.pair_shear2 += 0.5 * image.by_pairs * against * against;
                block.reflections.push(image);
            }
        }
    }

    /// The image of neighbour j, at x_i - x_j = `offset`, across the face that both see; `None` beyond the support, or if one sees it at
    /// another level.
    fn reflection(
        &self,
        j: u32,
        (own, other): (&FaceAhead<D>, &FaceAhead<D>),
        offset: &Vector<D>,
    ) -> Option<Reflection<D>> {
        // The same from both sides to the last bit, so that the operator is symmetric.
        let normal: Vector<D> = std::array::from_fn(|k| 0.5 * (own.normal[k] + other.normal[k]));
        let up = dot(&normal, offset);
        let along: Vector<D> = std::array::from_fn(|k| offset[k] - up * normal[k]);
        let r2 = dot(&along, &along) + (own.distance + other.distance).powi(2);
        let level = (up - (own.distance - other.distance)).abs();
        if r2 >= self.kernel.support().powi(2) || level > LEVEL * self.numerics.spacing {
            return None;
        }
        let r = r2.sqrt();
        let weight = self.volume[j as usize] * self.kernel.f(r);
        Some(Reflection {
            j,
            normal,
            along,
            weight,
            by_pairs: -2.0 * (D as f64 + 2.0) * weight / r2,
        })
    }
}

/// gradient += sum_j P (v_j - v_i) (x) P g'_ij.
#[inline(always)]
pub(super) fn add_reflected_gradient<const D: usize>(
    reflections: &[Reflection<D>],
    i: usize,
    v: &[Vector<D>],
    gradient: &mut Tensor<D>,
) {
    for image in reflections {
        let d = along(&image.normal, &sub(&v[image.j as usize], &v[i]));
        add_outer(gradient, image.weight, &d, &image.along);
    }
}

/// sum_j P (v_j - v_i) . g'_ij.
#[inline(always)]
pub(super) fn reflected_divergence<const D: usize>(
    reflections: &[Reflection<D>],
    i: usize,
    v: &[Vector<D>],
) -> f64 {
    let mut rate = 0.0;
    for image in reflections {
        rate += image.weight * dot(&image.along, &sub(&v[image.j as usize], &v[i]));
    }
    rate
}

/// sum_j (p_i + p_j) P g'_ij per volume: the adjoint of the trace of [`add_reflected_gradient`].
#[inline(always)]
pub(super) fn reflected_pressure<const D: usize>(
    reflections: &[Reflection<D>],
    i: usize,
    pressure: &[f64],
) -> Vector<D> {
    let mut f = [0.0; D];
    for image in reflections {
        let both = image.weight * (pressure[i] + pressure[image.j as usize]);
        for k in 0..D {
            f[k] += both * image.along[k];
        }
    }
    f
}

/// sum_j P (tau_i + tau_j) P g'_ij per volume: minus the adjoint of [`add_reflected_gradient`].
#[inline(always)]
pub(super) fn reflected_force<const D: usize>(
    reflections: &[Reflection<D>],
    own: &Tensor<D>,
    stress: impl Fn(usize) -> Tensor<D>,
) -> Vector<D> {
    let mut f = [0.0; D];
    for image in reflections {
        let (a, b) = (
            apply(own, &image.along),
            apply(&stress(image.j as usize), &image.along),
        );
        let both: Vector<D> = std::array::from_fn(|k| a[k] + b[k]);
        let both = along(&image.normal, &both);
        for k in 0..D {
            f[k] += image.weight * both[k];
        }
    }
    f
}

/// sum_j eta_ij 2 (D + 2) |F'| V_j t (t . (v_i - v_j))/r'^2 per volume; `other` gives a neighbour's velocity and eta_ij.
#[inline(always)]
pub(super) fn reflected_drag<const D: usize>(
    reflections: &[Reflection<D>],
    v: &Vector<D>,
    other: impl Fn(usize) -> (Vector<D>, f64),
) -> Vector<D> {
    let mut f = [0.0; D];
    for image in reflections {
        let (vj, eta) = other(image.j as usize);
        let against = eta * image.by_pairs * dot(&image.along, &sub(v, &vj));
        for k in 0..D {
            f[k] += against * image.along[k];
        }
    }
    f
}
