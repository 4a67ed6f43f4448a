//! Whether a scene can start: no particle inside a wall or gate.

use super::plates::with_plates;
use crate::math::{Vector, dot, sub};
use crate::scene::Scene;
use crate::solver::{Plan, Scheme};
use crate::state::{CellGrid, State};

/// No particle may start inside a wall or gate.
///
/// # Errors
/// A sentence that names the first particle that does, and the wall.
pub(super) fn check_overlap<const D: usize>(
    scene: &Scene,
    plan: &Plan<D>,
    state: &State<D>,
) -> Result<(), String> {
    let near = 0.3 * plan.numerics.spacing;
    let sides: [Option<(f64, f64)>; D] = std::array::from_fn(|k| {
        (plan.periodic.length[k] > 0.0).then(|| (plan.lower[k], plan.upper[k]))
    });
    let openings: Vec<f64> = state.gates.iter().map(|g| g.opening).collect();
    let walls = with_plates(&plan.walls, &plan.plates, &openings);
    let shown: Vec<usize> = (0..walls.len())
        .filter(|&w| walls.weight[w] > 0.5)
        .collect();
    let visible: Vec<Vector<D>> = shown.iter().map(|&w| walls.position[w]).collect();
    let cells = CellGrid::build(&visible, plan.numerics.spacing, &sides);
    // Elements of scheme paper_b lie in the surface itself: what is in front of the nearest one is clear, however near.
    let in_surface = matches!(plan.numerics.scheme, Scheme::PaperB(_));
    for x in &state.grains.position {
        let mut hit = None;
        let mut nearest = f64::INFINITY;
        cells.for_each_within(x, near, |w, y, r| {
            if r < nearest {
                nearest = r;
                let behind = dot(&walls.normal[shown[w]], &sub(x, &y)) < 0.0;
                hit = Some(w).filter(|_| behind || !in_surface);
            }
        });
        if let Some(w) = hit {
            return Err(format!(
                "a particle starts at {:?} m, inside {}: move the body or the wall apart",
                &x[..],
                wall_name(scene, walls.group[shown[w]]),
            ));
        }
        if dot(x, x).is_nan() {
            return Err("a particle starts at a position that is not a number".to_owned());
        }
    }
    Ok(())
}

/// Of a group of wall points. Planar gates are checked before, so that a gate here stands in space.
fn wall_name(scene: &Scene, group: u16) -> String {
    let n = usize::from(group);
    if let Some(wall) = scene.walls.get(n) {
        return format!("wall {}", wall.name);
    }
    let gate = &scene.gates[n - scene.walls.len()].name;
    format!("gate {gate}, whose material belongs on the side of span x (to - from)")
}
