//! Materials that a file names and nothing in the scene is made of: a scene with them would pay for what it lacks.

use crate::scene::types::{Body, Gauge, Inflow, NamedMaterial};

/// Drops materials that no body, inflow or gauge refers to, and gives their names.
pub(super) fn drop_unused(
    materials: &mut Vec<Option<NamedMaterial>>,
    bodies: &mut [Body],
    inflows: &mut [Inflow],
    gauges: &mut [Gauge],
) -> Vec<String> {
    let mut used = vec![false; materials.len()];
    let of_bodies = bodies.iter().map(|b| b.material);
    let of_inflows = inflows.iter().map(|i| i.material);
    let of_gauges = gauges.iter().filter_map(|g| g.material);
    for material in of_bodies.chain(of_inflows).chain(of_gauges) {
        used[material] = true;
    }
    if used.iter().all(|u| *u) {
        return Vec::new();
    }
    let number = |material: usize| used[..material].iter().filter(|u| **u).count();
    for body in bodies {
        body.material = number(body.material);
    }
    for inflow in inflows {
        inflow.material = number(inflow.material);
    }
    for material in gauges.iter_mut().filter_map(|g| g.material.as_mut()) {
        *material = number(*material);
    }
    let mut dropped = Vec::new();
    let mut keep = used.iter();
    materials.retain(|named| {
        let kept = keep.next().is_none_or(|u| *u);
        if !kept {
            dropped.extend(named.iter().map(|n| n.name.clone()));
        }
        kept
    });
    dropped
}
