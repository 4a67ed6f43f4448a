//! Whether a scene can start: no particle inside a wall or gate.

use super::particles::lattices;
use super::plates::with_plates;
use crate::math::{Vector, dot, sub};
use crate::scene::Scene;
use crate::solver::{INSIDE, Plan, Scheme};
use crate::state::{CellGrid, State};
use crate::units::shown;

/// What starts may be so near to a point of a wall or gate [spacing].
const START: f64 = 0.3;

/// No particle may start inside a wall or gate, and none may come in there.
///
/// # Errors
/// A sentence that names the first particle or the inflow that does, and the wall.
pub(super) fn check_overlap<const D: usize>(
    scene: &Scene,
    plan: &Plan<D>,
    state: &State<D>,
) -> Result<(), String> {
    let obstacles = Obstacles::new(plan, state);
    for (number, x) in state.grains.position.iter().enumerate() {
        let a_particle = || format!("a particle of body {} starts", body_of::<D>(scene, number));
        if let Some(group) = obstacles.holds(x, START) {
            return Err(format!(
                "{} at {:?} m, inside {}{}: move the body or the wall apart",
                a_particle(),
                &x[..],
                name(scene, group),
                side(scene, group),
            ));
        }
        if dot(x, x).is_nan() {
            return Err(format!(
                "{} at a position that is not a number",
                a_particle()
            ));
        }
    }
    check_inflows(scene, plan, &obstacles)
}

/// The body that a particle of the start belongs to: they stand in the bodies' order.
fn body_of<const D: usize>(scene: &Scene, number: usize) -> &str {
    let mut end = 0;
    let ends = lattices::<D>(scene).into_iter().map(|lattice| {
        end += lattice.points.len();
        end
    });
    let mut bodies = scene.bodies.iter().zip(ends);
    let found = bodies.find(|(_, end)| number < *end);
    found.map_or("", |(body, _)| &body.name)
}

/// What comes in has room, and stays in.
fn check_inflows<const D: usize>(
    scene: &Scene,
    plan: &Plan<D>,
    obstacles: &Obstacles<D>,
) -> Result<(), String> {
    for (inflow, source) in scene.inflows.iter().zip(&plan.sources) {
        let name = &inflow.name;
        for x in &source.slots {
            let place = || x.map(|c| shown((c * 1e6).round() / 1e6)).join(", ");
            let lets_in = || format!("inflow {name} lets in at [{}] m", place());
            if let Some(group) = obstacles.holds(x, INSIDE) {
                return Err(format!(
                    "{}, inside {}: move its face out of there, to where material has room; on the wall's own face it may lie",
                    lets_in(),
                    self::name(scene, group),
                ));
            }
            if let Some(drain) = plan.sinks.iter().position(|sink| sink.holds(x)) {
                return Err(format!(
                    "{}, inside outflow {}, which would take it out at once: move one of the two",
                    lets_in(),
                    scene.outflows[drain].name,
                ));
            }
        }
    }
    Ok(())
}

/// Points of walls and of gates as they start.
struct Obstacles<const D: usize> {
    normal: Vec<Vector<D>>,
    group: Vec<u16>,
    cells: CellGrid<D>,
    spacing: f64,
    /// Elements of scheme paper_b lie in the surface itself: what is in front of the nearest one is clear, however near.
    in_surface: bool,
}

impl<const D: usize> Obstacles<D> {
    fn new(plan: &Plan<D>, state: &State<D>) -> Self {
        let spacing = plan.numerics.spacing;
        let sides: [Option<(f64, f64)>; D] = std::array::from_fn(|k| {
            (plan.periodic.length[k] > 0.0).then(|| (plan.lower[k], plan.upper[k]))
        });
        let openings: Vec<f64> = state.gates.iter().map(|g| g.opening).collect();
        let walls = with_plates(&plan.walls, &plan.plates, &openings);
        let shown = || (0..walls.len()).filter(|&w| walls.weight[w] > 0.5);
        let position: Vec<Vector<D>> = shown().map(|w| walls.position[w]).collect();
        Self {
            cells: CellGrid::build(&position, spacing, &sides),
            normal: shown().map(|w| walls.normal[w]).collect(),
            group: shown().map(|w| walls.group[w]).collect(),
            spacing,
            in_surface: matches!(plan.numerics.scheme, Scheme::PaperB(_)),
        }
    }

    /// The group of the nearest point within so many spacings of a place, if that is no place before it.
    fn holds(&self, x: &Vector<D>, near: f64) -> Option<u16> {
        let mut hit = None;
        let mut nearest = f64::INFINITY;
        self.cells
            .for_each_within(x, near * self.spacing, |w, y, r| {
                if r < nearest {
                    nearest = r;
                    let behind = dot(&self.normal[w], &sub(x, &y)) < 0.0;
                    hit = Some(self.group[w]).filter(|_| behind || !self.in_surface);
                }
            });
        hit
    }
}

/// What a group of wall points belongs to.
fn name(scene: &Scene, group: u16) -> String {
    let n = usize::from(group);
    match scene.walls.get(n) {
        Some(wall) => format!("wall {}", wall.name),
        None => format!(
            "gate {} as it starts",
            scene.gates[n - scene.walls.len()].name
        ),
    }
}

/// On which side of it bodies belong: planar gates were looked at before, so that a gate here stands in space.
fn side(scene: &Scene, group: u16) -> &'static str {
    match scene.walls.get(usize::from(group)) {
        Some(_) => "",
        None => ", whose material belongs on the side of span x (to - from)",
    }
}
