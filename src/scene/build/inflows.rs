//! Sources: where and how heavy the particles are that an inflow lets in.

use crate::math::{Vector, add, norm, scale};
use crate::solver::Source;

use super::narrow;
use super::particles::particle_mass;
use crate::scene::{Inflow, Scene};

/// Slots half a spacing inside the face, so that a row clears it as it appears.
pub(super) fn source<const D: usize>(scene: &Scene, inflow: &Inflow) -> Source<D> {
    let dp = scene.numerics.spacing;
    let material = &scene.materials[inflow.material].material;
    let (from, to, span) = (
        narrow::<D>(&inflow.from),
        narrow::<D>(&inflow.to),
        narrow::<D>(&inflow.span),
    );
    let edge: Vector<D> = std::array::from_fn(|k| to[k] - from[k]);
    let velocity = narrow::<D>(&inflow.velocity);
    let along = (norm(&edge) / dp).round().max(1.0) as usize;
    let wide = if D == 2 {
        1
    } else {
        (norm(&span) / dp).round().max(1.0) as usize
    };
    let clear = scale(0.5 * dp / norm(&velocity), &velocity);
    let density = material.rest_density();
    let mut slots = Vec::new();
    let mut masses = Vec::new();
    for i in 0..along {
        for m in 0..wide {
            let mut x = add(
                &add(&from, &clear),
                &scale((i as f64 + 0.5) / along as f64, &edge),
            );
            if D == 3 {
                x = add(&x, &scale((m as f64 + 0.5) / wide as f64, &span));
            }
            slots.push(x);
            let place = std::array::from_fn(|k| if k < D { x[k] } else { 0.0 });
            masses.push(particle_mass(scene, &place, density, dp.powi(D as i32)));
        }
    }
    Source {
        slots,
        masses,
        velocity,
        phase: inflow.material as u8,
        density,
    }
}
