//! Fluids at flat walls without slip: their shear rate is that of mirror images (docs/theory.md, W6), and so is what the pair form
//! takes along the wall (W9).
//!
//! A wall point counts as an image of the particle that sees it, at -v_i, whatever its depth. That is right for the image of
//! particle i itself; images of its neighbours j move at -v_j. The difference,
//!
//!   G_i -= sum_j (v_j - v_i) (x) g'_ij,   g'_ij = V_j F' (x_i - x_j'),   x_j' the image of x_j,               (W6)
//!
//! makes the shear rate of a linear flow right in every row (0.905 and 1.094 of it in the first two without), and its adjoint,
//! forces between i and j, makes wall points bear tau_j. What shear stress is then carried on into the wall is what an image
//! lacks of it: K of (W4) less sum_j (I - n n^T) |F'| V_j (d_i^2 - d_j^2), d the distance from the face.
//!
//! The pair form's share s_p against images is, along the face, with t = (I - n n^T)(x_i - x_j'),
//!
//!   F_i += V_i s_p sum_j eta_ij 2 (D + 2) |F'| V_j t (t . (v_i - v_j))/r'^2,                                 (W9)
//!
//! opposite for j. What its images lack along the face is 2 d_j^2 of curvature, a K of sum_j 2 (D + 2) |F'| V_j d_j^2 t t^T/r'^2:
//! K is that of both forms by their shares.

use crate::math::{Tensor, Vector, add_outer, apply, dot, norm};
use crate::state::State;

use super::Solver;
use super::pair::Block;

/// Most that normals differ, and distances over the spacing, where a face counts as flat [1].
pub(super) const FLAT: f64 = 1e-6;
pub(super) const LEVEL: f64 = 1e-3;

/// A flat face as a particle sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mirror<const D: usize> {
    normal: Vector<D>,
    /// From the face [m]; 0 where there is none, or more than one.
    distance: f64,
}

/// A neighbour's image across a flat face.
#[derive(Clone, Copy, Debug)]
pub(super) struct Image<const D: usize> {
    j: u32,
    /// g' and its own image: V_j F' (x_i - x_j') and V_j F' (x_i' - x_j) [1/m].
    g: Vector<D>,
    back: Vector<D>,
    /// sqrt(2 (D + 2) V_j |F'|) t/r' [1/m].
    along: Vector<D>,
}

impl<const D: usize> Solver<D> {
    /// Notes which flat face each particle of a fluid sees, if it sees one and nothing else.
    pub(super) fn note_mirrors(&mut self, state: &State<D>) {
        let fixed = &self.walls.groups[..self.fixed_groups];
        let nothing_sticks = fixed.iter().all(|g| g.free_slip);
        if !self.has_fluids || nothing_sticks {
            return;
        }
        let none = Mirror {
            normal: [0.0; D],
            distance: 0.0,
        };
        let mut mirrors = std::mem::take(&mut self.mirrors);
        mirrors.clear();
        mirrors.resize(state.grains.len(), none);
        self.workers
            .blocks_read(&self.lists.blocks, &mut mirrors, |block, first, out| {
                for (row, o) in out.iter_mut().enumerate() {
                    let i = first + row;
                    let phase = state.grains.phase[i] as usize;
                    if self.materials[phase].is_fluid() {
                        *o = self
                            .mirror_of(state, i, block.wall_row(row))
                            .unwrap_or(none);
                    }
                }
            });
        self.mirrors = mirrors;
    }

    /// The face behind wall points without slip near particle i, `None` if their normals differ.
    fn mirror_of(&self, state: &State<D>, i: usize, near: &[u32]) -> Option<Mirror<D>> {
        let xi = &state.grains.position[i];
        let mut found: Option<Mirror<D>> = None;
        for &wall in near {
            let (x, r) = self.wall_offset(xi, wall);
            let group = self.walls.group[wall as usize] as usize;
            if r >= self.kernel.support()
                || r == 0.0
                || self.walls.weight[wall as usize] == 0.0
                || self.walls.groups[group].free_slip
            {
                continue;
            }
            if group >= self.fixed_groups {
                return None;
            }
            let normal = self.wall_normal(xi, wall, state);
            // The face lies half a spacing before the first row of points.
            let distance = dot(&normal, &x) - 0.5 * self.numerics.spacing;
            match &mut found {
                None => found = Some(Mirror { normal, distance }),
                Some(m) if dot(&m.normal, &normal) > 1.0 - FLAT => {
                    m.distance = m.distance.min(distance);
                }
                Some(_) => return None,
            }
        }
        found.filter(|m| m.distance > 0.0)
    }

    /// Appends the images that particle i sees of its neighbours, and returns what they take from K of (W4), `lean` without them.
    pub(super) fn find_images(
        &self,
        state: &State<D>,
        i: usize,
        block: &mut Block<D>,
        near: &[u32],
        lean: &Tensor<D>,
    ) -> Tensor<D> {
        let mut less = [[0.0; D]; D];
        let mut of_pairs = [[0.0; D]; D];
        let Some(own) = self.mirrors.get(i).filter(|m| m.distance > 0.0) else {
            return less;
        };
        let x = &state.grains.position;
        for &j in near {
            let other = &self.mirrors[j as usize];
            // Between materials no more than (F6) says.
            let same = state.grains.phase[i] == state.grains.phase[j as usize];
            if j as usize == i || other.distance <= 0.0 || !same {
                continue;
            }
            let offset = self.periodic.difference(&x[i], &x[j as usize]);
            // The same from both sides to the last bit, so that the operator is symmetric.
            let n: Vector<D> = std::array::from_fn(|k| 0.5 * (own.normal[k] + other.normal[k]));
            let up = dot(&n, &offset);
            let (sum, rise) = (own.distance + other.distance, own.distance - other.distance);
            let bent = dot(&own.normal, &other.normal) < 1.0 - FLAT;
            if bent || (up - rise).abs() > LEVEL * self.numerics.spacing {
                continue;
            }
            let along: Vector<D> = std::array::from_fn(|k| offset[k] - up * n[k]);
            let r = norm(&std::array::from_fn::<_, D, _>(|k| along[k] + sum * n[k]));
            if r >= self.kernel.support() {
                continue;
            }
            let vf = self.volume_seen(i, j as usize) * self.kernel.f(r);
            let by_pairs = (-2.0 * (D as f64 + 2.0) * vf).sqrt() / r;
            let t = along.map(|c| by_pairs * c);
            add_outer(&mut of_pairs, other.distance * other.distance, &t, &t);
            block.images.push(Image {
                j,
                g: std::array::from_fn(|k| vf * (along[k] + sum * n[k])),
                back: std::array::from_fn(|k| vf * (along[k] - sum * n[k])),
                along: t,
            });
            let part = -vf * sum * rise;
            for (k, row) in less.iter_mut().enumerate() {
                row[k] += part;
            }
            add_outer(&mut less, -part, &n, &n);
        }
        let share = self.numerics.pair_viscosity_share;
        for a in 0..D {
            for b in 0..D {
                less[a][b] += share * (lean[a][b] - less[a][b] - of_pairs[a][b]);
            }
        }
        less
    }
}

/// gradient -= sum_j (v_j - v_i) (x) g'_ij.
#[inline(always)]
pub(super) fn add_image_gradient<const D: usize>(
    images: &[Image<D>],
    i: usize,
    v: &[Vector<D>],
    gradient: &mut Tensor<D>,
) {
    for image in images {
        let other = &v[image.j as usize];
        let d: Vector<D> = std::array::from_fn(|k| v[i][k] - other[k]);
        add_outer(gradient, 1.0, &d, &image.g);
    }
}

/// -sum_j (tau_i g'_ij + tau_j g''_ij), g'' the image of g': minus the adjoint of [`add_image_gradient`] per volume.
#[inline(always)]
pub(super) fn image_force<const D: usize>(
    images: &[Image<D>],
    own: &Tensor<D>,
    stress: impl Fn(usize) -> Tensor<D>,
) -> Vector<D> {
    let mut f = [0.0; D];
    for image in images {
        let (a, b) = (
            apply(own, &image.g),
            apply(&stress(image.j as usize), &image.back),
        );
        for k in 0..D {
            f[k] -= a[k] + b[k];
        }
    }
    f
}

/// sum_j eta_ij 2 (D + 2) |F'| V_j t (t . (v_i - v_j))/r'^2 per volume (W9); `other` gives a neighbour's velocity and eta_ij.
#[inline(always)]
pub(super) fn image_drag<const D: usize>(
    images: &[Image<D>],
    v: &Vector<D>,
    other: impl Fn(usize) -> (Vector<D>, f64),
) -> Vector<D> {
    let mut f = [0.0; D];
    for image in images {
        let (vj, eta) = other(image.j as usize);
        let against = eta * (dot(v, &image.along) - dot(&vj, &image.along));
        for k in 0..D {
            f[k] += against * image.along[k];
        }
    }
    f
}
