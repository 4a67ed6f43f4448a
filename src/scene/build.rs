//! Scene to what the solver runs: particles, wall points, devices. The last function that knows scenes.

use crate::boundary::{
    End, GroupSpec, Mover, Plate, ROWS, RigidMotion, WallPoints, box_points, free_ends,
    joined_points, plane_points,
};
use crate::math::{Geometry, Vector, add, dot, norm, scale, sub};
use crate::shape::{Lattice, lattice};
use crate::solver::{Periodic, Plan, Scheme, Sink, Source, three};
use crate::state::{GateState, Grains, InflowState, PoseTimes, Random, RestState, State};

use super::elements::elements;
use super::ghosts::ghost_depth;
use super::load::Loads;
use super::steady_flow::steady_flow;
use super::{Dimension, ForceTarget, GaugeKind, Inflow, Point, Scene, Slip, Wall, WallGeometry};

/// The first D components of a point.
#[must_use]
pub fn narrow<const D: usize>(point: &Point) -> Vector<D> {
    std::array::from_fn(|k| point[k])
}

/// Solver plan and start state of a scene whose dimension is D.
///
/// # Errors
/// A sentence: no particles and no inflow, a particle inside a wall, a periodic side too short for the kernel.
pub fn build<const D: usize>(scene: &Scene) -> Result<(Plan<D>, State<D>), String> {
    let periodic = periodic::<D>(scene)?;
    let walls = match scene.numerics.scheme {
        Scheme::PaperB(_) => elements::<D>(scene),
        Scheme::Implicit | Scheme::PaperA(_) => walls::<D>(scene, &periodic),
    };
    let movers = movers(scene, &walls);
    let sources = scene.inflows.iter().map(|i| source(scene, i)).collect();
    let sinks = scene
        .outflows
        .iter()
        .map(|o| Sink {
            lower: narrow(&o.lower),
            upper: narrow(&o.upper),
        })
        .collect();
    let ghost_depth = match scene.numerics.scheme {
        Scheme::PaperA(_) => ghost_depth(scene, &walls),
        Scheme::Implicit | Scheme::PaperB(_) => Vec::new(),
    };
    let state = state::<D>(scene)?;
    let plates = plates(scene, &walls, &state.grains.position);
    let plan = Plan {
        numerics: scene.numerics.clone(),
        gravity: narrow(&scene.domain.gravity),
        geometry: geometry(scene),
        lower: narrow(&scene.domain.lower),
        upper: narrow(&scene.domain.upper),
        periodic,
        materials: scene.materials.iter().map(|m| m.material.clone()).collect(),
        walls,
        ghost_depth,
        movers,
        plates,
        sources,
        sinks,
    };
    check_overlap(scene, &plan, &state)?;
    Ok((plan, state))
}

/// What a scene's coordinates stand for.
#[must_use]
pub fn geometry(scene: &Scene) -> Geometry {
    match scene.dimension {
        Dimension::Two => Geometry::Planar {
            width: scene.domain.width,
        },
        Dimension::Axisymmetric => Geometry::Axisymmetric,
        Dimension::Three => Geometry::Space,
    }
}

fn periodic<const D: usize>(scene: &Scene) -> Result<Periodic<D>, String> {
    let domain = &scene.domain;
    // Support 2 h and the lists' skin of 0.3 h, on both sides of a particle.
    let least = 2.0 * (2.0 + 0.3) * scene.numerics.spacing * scene.numerics.smoothing_ratio;
    let mut length = [0.0; D];
    for (k, length) in length.iter_mut().enumerate() {
        if domain.periodic[k] {
            *length = domain.upper[k] - domain.lower[k];
            if *length < least {
                return Err(format!(
                    "the periodic side along axis {k} is {length} m long; allowed at least {least} m (4.6 h): lengthen the domain or refine the spacing"
                ));
            }
        }
    }
    Ok(Periodic {
        lower: narrow(&domain.lower),
        length,
    })
}

/// Mass of a particle, rounded to a multiple of a power of two so that sums of up to 2^28 particles no heavier than
/// `largest` are exact [kg].
fn exact_mass(mass: f64, largest: f64) -> f64 {
    let quantum = 2f64.powi(largest.log2().floor() as i32 - 24);
    (mass / quantum).round() * quantum
}

/// Mass of a particle of `density` at a place that stands for `cell` m^D of the section [kg]. Rings far from the axis
/// are heavier than those near it: the heaviest that the domain has room for sets what masses are multiples of.
fn particle_mass(scene: &Scene, place: &Point, density: f64, cell: f64) -> f64 {
    let geometry = geometry(scene);
    let length = |x: &Point| geometry.length_across(x, 0.0);
    let mass = density * cell * length(place);
    let largest = if geometry.is_axisymmetric() {
        density * cell * length(&scene.domain.upper)
    } else {
        mass
    };
    exact_mass(mass, largest)
}

fn state<const D: usize>(scene: &Scene) -> Result<State<D>, String> {
    let mut random = Random::new(scene.numerics.seed);
    let mut grains = Grains {
        implicit: scene.numerics.scheme == Scheme::Implicit,
        exact_yield: scene.keeps_stress(),
        wall_friction: scene.has_wall_friction(),
        saturated: scene.has_pore_pressure(),
        ..Grains::default()
    };
    let mut id = 0;
    let up = up_axis(scene);
    let jitter = scene.numerics.jitter;
    let rings = scene.dimension == Dimension::Axisymmetric;
    // With the packing of the start (`solver/pack.rs`), which evens what it leaves uneven beside walls.
    let staggered = jitter > 0.0 && !rings && scene.numerics.scheme == Scheme::Implicit;
    // Rings of half a spacing move half as far: the mass is that of the place, and the section's area follows from it.
    let reach = |axis: usize, place: &Point| {
        let dp = scene.numerics.spacing;
        jitter
            * if rings && axis == 0 {
                dp.min(place[0])
            } else {
                dp
            }
    };
    let lattices: Vec<Lattice> = scene
        .bodies
        .iter()
        .map(|body| {
            let level = body.level.map(|height| (scene.up(), height));
            lattice(&body.shape, level, scene.numerics.spacing, D, staggered)
        })
        .collect();
    let loads = Loads::new::<D>(scene, up, &lattices);
    for (number, (body, lattice)) in scene.bodies.iter().zip(&lattices).enumerate() {
        let material = &scene.materials[body.material].material;
        let sound_speed = material.sound_speed.unwrap_or(scene.numerics.sound_speed);
        let flow = steady_flow(scene, body);
        let bulk = flow
            .as_ref()
            .map_or(material.rest_density(), |f| f.loose_density);
        // Rings are not packed (`solver/pack.rs`), and nothing damps what uneven ones of a fluid do to its pressure.
        let still = rings && material.is_fluid();
        for place in &lattice.points {
            let position: Vector<D> = std::array::from_fn(|k| {
                let aside = reach(k, place) * random.symmetric();
                if still { place[k] } else { place[k] + aside }
            });
            let mut velocity: Vector<D> = narrow(&body.velocity);
            let mut density =
                material.density_under(loads.above(number, &three(&position)), sound_speed);
            let mut shear_rate = 0.0;
            if let Some(flow) = &flow {
                let here = flow.at(&three(&position), scene.numerics.sound_speed);
                velocity = add(&velocity, &narrow(&here.velocity));
                (density, shear_rate) = (here.density, here.shear_rate);
            }
            let mass = particle_mass(scene, place, bulk, lattice.cell_volume);
            grains.push(id, body.material as u8, position, velocity, mass, density);
            if let Some(relaxed) = grains.relaxed_shear.last_mut() {
                *relaxed = shear_rate;
            }
            id += 1;
        }
    }
    if grains.is_empty() && scene.inflows.is_empty() {
        return Err("the scene has no particles and no inflow: add a body that holds at least one particle spacing".to_owned());
    }
    let gates = scene
        .gates
        .iter()
        .map(|g| GateState {
            opening: g.start,
            rate: 0.0,
            blocked: false,
            listed_opening: g.start,
        })
        .collect();
    Ok(State {
        time: 0.0,
        initial_mass: grains.present_mass(),
        grains,
        pose: PoseTimes::default(),
        gates,
        inflows: vec![InflowState::default(); scene.inflows.len()],
        drained: vec![0.0; scene.outflows.len()],
        impulse: vec![[0.0; D]; scene.walls.len() + scene.gates.len()],
        next_id: id,
        steps: 0,
        iterations: 0,
        step_size: 0.0,
        trend: 0.0,
        rest: RestState::default(),
        random,
    })
}

/// Axis of "up".
fn up_axis(scene: &Scene) -> usize {
    let up = scene.up();
    (0..3).fold(0, |best, k| {
        if up[k].abs() > up[best].abs() {
            k
        } else {
            best
        }
    })
}

/// What all points of a wall or gate share.
pub(super) fn group(scene: &Scene, slip: Slip, moves: bool, target: ForceTarget) -> GroupSpec {
    let wants_force = scene
        .gauges
        .iter()
        .any(|g| matches!(g.kind, GaugeKind::Force { on } if on == target));
    GroupSpec {
        free_slip: slip != Slip::NoSlip,
        friction: slip.friction(),
        moves,
        wants_force,
    }
}

/// Directions in which other walls arrive at the first point of an open polyline and leave its last: walls that meet make a
/// whole corner, if they stay where they are to each other.
fn joints(scene: &Scene, wall: usize) -> [Option<[f64; 2]>; 2] {
    let open = |n: usize| match &scene.walls[n] {
        other @ Wall {
            geometry:
                WallGeometry::Polyline {
                    points,
                    closed: false,
                },
            ..
        } if other.moves_with(&scene.walls[wall]) => Some(points),
        _ => None,
    };
    let Some(own) = open(wall) else {
        return [None; 2];
    };
    let others = (0..scene.walls.len()).filter(|n| *n != wall);
    let others: Vec<&Vec<[f64; 2]>> = others.filter_map(open).collect();
    let eps = 1e-6 * scene.numerics.spacing;
    let same = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < eps;
    let way = |a: &[f64; 2], b: &[f64; 2]| {
        let d = [b[0] - a[0], b[1] - a[1]];
        scale(1.0 / norm(&d), &d)
    };
    let (first, last) = (own[0], own[own.len() - 1]);
    let before = others.iter().find(|o| same(&o[o.len() - 1], &first));
    let after = others.iter().find(|o| same(&o[0], &last));
    [
        before.map(|o| way(&o[o.len() - 2], &o[o.len() - 1])),
        after.map(|o| way(&o[0], &o[1])),
    ]
}

fn walls<const D: usize>(scene: &Scene, periodic: &Periodic<D>) -> WallPoints<D> {
    let dp = scene.numerics.spacing;
    let mut points = WallPoints::default();
    for (n, wall) in scene.walls.iter().enumerate() {
        points
            .groups
            .push(group(scene, wall.slip, wall.rigid, ForceTarget::Wall(n)));
        let velocity = narrow(&wall.velocity);
        match &wall.geometry {
            WallGeometry::Polyline {
                points: corners,
                closed,
            } => {
                let joints = joints(scene, n);
                for (x, normal, weight) in joined_points(corners, *closed, joints, dp) {
                    points.push(
                        narrow(&[x[0], x[1], 0.0]),
                        velocity,
                        narrow(&[normal[0], normal[1], 0.0]),
                        weight,
                        n as u16,
                    );
                }
                if !closed && !wall.rigid {
                    let (depth, rim) = (ROWS as f64 * dp, 0.25 * dp);
                    for (end, length) in free_ends(corners, joints, depth, rim) {
                        let wide = |x: [f64; 2]| narrow(&[x[0], x[1], 0.0]);
                        let end = End {
                            point: wide(end.point),
                            outward: wide(end.outward),
                            normal: wide(end.normal),
                            depth,
                            rim,
                        };
                        points.add_end(end, length, n as u16);
                    }
                }
            }
            WallGeometry::Box { lower, upper } => {
                for (x, normal) in box_points::<D>(&narrow(lower), &narrow(upper), dp) {
                    points.push(x, velocity, normal, 1.0, n as u16);
                }
            }
            WallGeometry::Plane { point, normal } => {
                let normal = narrow(normal);
                let sides = std::array::from_fn(|k| periodic.length[k] > 0.0);
                let (lower, upper) = (narrow(&scene.domain.lower), narrow(&scene.domain.upper));
                let motion = rigid_motion::<D>(wall);
                for x in plane_points::<D>(&narrow(point), &normal, &lower, &upper, &sides, dp) {
                    let velocity = motion.velocity_at(&x, 0.0);
                    points.push(x, velocity, normal, 1.0, n as u16);
                }
            }
        }
    }
    if scene.dimension == Dimension::Axisymmetric {
        points.retain(|x| x[0] > 0.0);
    }
    let wall = |group: u16| &scene.walls[group as usize];
    points.drop_doubles(dp, |a, b| wall(a).moves_with(wall(b)));
    for (n, gate) in scene.gates.iter().enumerate() {
        points
            .groups
            .push(group(scene, gate.slip, false, ForceTarget::Gate(n)));
    }
    points
}

/// How a wall's material moves.
fn rigid_motion<const D: usize>(wall: &Wall) -> RigidMotion<D> {
    let (centre, rate, axis) = match wall.rotation {
        Some(r) => (r.centre, r.rate, r.axis),
        None => ([0.0; 3], 0.0, [0.0, 0.0, 1.0]),
    };
    RigidMotion {
        velocity: narrow(&wall.velocity),
        centre: narrow(&centre),
        rate,
        axis,
    }
}

fn movers<const D: usize>(scene: &Scene, points: &WallPoints<D>) -> Vec<Mover<D>> {
    let rigid = scene.walls.iter().enumerate().filter(|(_, w)| w.rigid);
    rigid
        .map(|(n, wall)| Mover::new(points, n as u16, rigid_motion(wall)))
        .collect()
}

/// The plates of the gates, behind fixed walls and what lies there at the start.
fn plates<const D: usize>(
    scene: &Scene,
    walls: &WallPoints<D>,
    grains: &[Vector<D>],
) -> Vec<Plate<D>> {
    let dp = scene.numerics.spacing;
    let number = |n: usize| (scene.walls.len() + n) as u16;
    let mut corners: Vec<Vector<D>> = Vec::new();
    for wall in scene.walls.iter().filter(|w| !w.rigid) {
        if let WallGeometry::Polyline { points, .. } = &wall.geometry {
            let wide = |x: &[f64; 2]| narrow(&[x[0], x[1], 0.0]);
            corners.extend(points.iter().map(wide));
        }
    }
    let ghosts = scene.numerics.scheme != Scheme::Implicit;
    let plate = |(n, g): (usize, &super::Gate)| {
        let ends: [Vector<D>; 2] = [narrow(&g.from), narrow(&g.to)];
        let mut plate = Plate::new(
            ends,
            &narrow(&g.span),
            g.thickness,
            g.max_speed,
            dp,
            number(n),
        );
        let near = |x: &Vector<D>, y: &Vector<D>, reach: f64| norm(&sub(x, y)) < reach * dp;
        let meets = |end: &Vector<D>| !ghosts && corners.iter().any(|c| near(c, end, 0.5));
        let rings = scene.dimension == Dimension::Axisymmetric;
        plate.fill_corners(ends.each_ref().map(meets), |x| {
            let mut others = walls.position.iter().chain(grains);
            let across_the_axis = rings && x[0] <= 0.0;
            !across_the_axis && !others.any(|y| near(x, y, 0.7))
        });
        plate
    };
    scene.gates.iter().enumerate().map(plate).collect()
}

/// Slots half a spacing inside the face, so that a row clears it as it appears.
fn source<const D: usize>(scene: &Scene, inflow: &Inflow) -> Source<D> {
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

/// No particle may start inside a wall or gate.
fn check_overlap<const D: usize>(
    scene: &Scene,
    plan: &Plan<D>,
    state: &State<D>,
) -> Result<(), String> {
    let near = 0.3 * plan.numerics.spacing;
    let sides: [Option<(f64, f64)>; D] = std::array::from_fn(|k| {
        (plan.periodic.length[k] > 0.0).then(|| (plan.lower[k], plan.upper[k]))
    });
    let mut walls = plan.walls.clone();
    for (plate, gate) in plan.plates.iter().zip(&state.gates) {
        let mut plate = plate.clone();
        plate.append(&mut walls);
        plate.place(&mut walls, gate.opening, 0.0);
    }
    let shown: Vec<usize> = (0..walls.len())
        .filter(|&w| walls.weight[w] > 0.5)
        .collect();
    let visible: Vec<Vector<D>> = shown.iter().map(|&w| walls.position[w]).collect();
    let cells = crate::state::CellGrid::build(&visible, plan.numerics.spacing, &sides);
    for x in &state.grains.position {
        let mut hit = None;
        cells.for_each_within(x, near, |w, _, _| hit = Some(w));
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
