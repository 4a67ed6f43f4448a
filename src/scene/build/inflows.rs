//! Sources: where and how heavy the particles are that an inflow lets in, and the part of a wall that it opens.

use crate::boundary::{Piston, ROWS, WallPoints};
use crate::math::{Vector, add, cross, dot, norm, scale, sub};
use crate::solver::{Scheme, Source};

use super::narrow;
use super::particles::particle_mass;
use crate::scene::{Dimension, Inflow, Point, Scene, Wall};

/// Least cosine between a wall's face and that of an inflow which lies on it [1].
const SAME: f64 = 0.99;
/// Most that a place of an inflow's row is from the first points of a wall it lies on, over the spacing [1]: 1.22 on a lattice in space.
const BEFORE: f64 = 1.4;

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
        length: norm(&edge).max(norm(&span)),
        piston: None,
    }
}

/// What of fixed walls comes forward with a stream: of fluids, where all of the face lies on such walls.
pub(super) fn piston<const D: usize>(
    scene: &Scene,
    inflow: &Inflow,
    source: &Source<D>,
    walls: &WallPoints<D>,
) -> Option<Piston<D>> {
    let is_fluid = scene.materials[inflow.material].material.is_fluid();
    if scene.numerics.scheme != Scheme::Implicit || !is_fluid {
        return None;
    }
    let dp = scene.numerics.spacing;
    let edge: Point = sub(&inflow.to, &inflow.from);
    let rings_or_plane = scene.dimension != Dimension::Three;
    let span = if rings_or_plane {
        [0.0, 0.0, 1.0]
    } else {
        inflow.span
    };
    let area = cross(&edge, &span);
    let size2 = dot(&area, &area);
    let along = scale(1.0 / size2, &cross(&span, &area));
    let wide = scale(1.0 / size2, &cross(&area, &edge));
    let across = if rings_or_plane {
        vec![narrow(&along)]
    } else {
        vec![narrow(&along), narrow(&wide)]
    };
    let side = dot(&area, &inflow.velocity).signum();
    let normal: Vector<D> = narrow(&scale(side / size2.sqrt(), &area));
    let mut piston = Piston::new(narrow(&inflow.from), across, normal, dp);
    let deep = (ROWS as f64 + 0.1) * dp;
    piston.take(walls, |piston, i| {
        let behind = |x: &Vector<D>| piston.ahead(x).is_some_and(|d| d < 0.0 && d > -deep);
        let wall = scene.walls.get(usize::from(walls.group[i]));
        let stands = |w: &Wall| !w.rigid && w.velocity == [0.0; 3] && w.rotation.is_none();
        wall.is_some_and(stands)
            && dot(&walls.normal[i], piston.normal()) > SAME
            && behind(&walls.position[i])
    });
    let near = |slot: &Vector<D>| {
        let points = piston.position().iter();
        points.map(|x| norm(&sub(x, slot))).any(|r| r < BEFORE * dp)
    };
    let whole = source.slots.iter().all(near);
    whole.then_some(piston)
}
