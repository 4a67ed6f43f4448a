//! Scene to what the solver runs: particles, wall points, devices. The last module that knows scenes.

mod faces;
mod inflows;
mod joins;
mod masses;
mod memory;
mod overlap;
mod particles;
mod places;
mod plates;
mod slides;
mod walls;

use crate::boundary::{Plate, WallPoints};
use crate::math::{Geometry, Vector};
use crate::solver::{Moment, Periodic, Plan, SLACK, Scheme, Sink};
use crate::state::State;

use super::elements::elements;
use super::footing::Support;
use super::ghosts::ghost_depth;
use super::{Dimension, ForceTarget, OutflowPlace, Point, Scene};
use inflows::{piston, source};
use joins::{Standing, join_boxes};
use memory::check_memory;
use overlap::check_overlap;
use particles::{spins, state};
use plates::{plates, with_plates};
use walls::{belts, drives, movers, walls};

pub(super) use faces::{faces_at, planes_beside};
pub use masses::BodyMass;
pub(super) use walls::group;
pub(crate) use walls::rigid_motion;

/// The first D components of a point.
#[must_use]
pub fn narrow<const D: usize>(point: &Point) -> Vector<D> {
    std::array::from_fn(|k| point[k])
}

/// Moments that gauges read, in the gauges' order; groups of wall points are walls, then gates.
fn moments<const D: usize>(scene: &Scene) -> Vec<Moment<D>> {
    let moment = |(on, about): (ForceTarget, Point)| Moment {
        group: match on {
            ForceTarget::Wall(wall) => wall,
            ForceTarget::Gate(gate) => scene.walls.len() + gate,
        } as u16,
        about: narrow(&about),
    };
    scene.moments().map(moment).collect()
}

/// Solver plan and start state of a scene whose dimension is D.
///
/// # Errors
/// A sentence: no particles and no inflow, more of them or of walls than there is memory for, a particle inside a wall.
pub fn build<const D: usize>(scene: &Scene) -> Result<(Plan<D>, State<D>), String> {
    let periodic = periodic::<D>(scene);
    check_memory::<D>(scene)?;
    let mut walls = match scene.numerics.scheme {
        Scheme::PaperB(_) => elements::<D>(scene),
        Scheme::Implicit | Scheme::PaperA(_) => walls::<D>(scene, &periodic),
    };
    let mut sources: Vec<_> = scene.inflows.iter().map(|i| source(scene, i)).collect();
    let sinks = scene
        .outflows
        .iter()
        .map(|o| sink(scene, o.place))
        .collect();
    let ghost_depth = match scene.numerics.scheme {
        Scheme::PaperA(_) => ghost_depth(scene, &walls),
        Scheme::Implicit | Scheme::PaperB(_) => Vec::new(),
    };
    let state = state(scene, &supports(scene, &walls))?;
    let spins = spins(scene);
    let sides = std::array::from_fn(|k| {
        (periodic.length[k] > 0.0).then(|| {
            let lower = scene.domain.lower[k];
            (lower, lower + periodic.length[k])
        })
    });
    let plates = plates(scene, &walls, &state.grains.position, &sides);
    if scene.numerics.scheme == Scheme::Implicit {
        let slots = sources.iter().flat_map(|s| s.slots.iter().copied());
        let standing = Standing {
            plates: plates.iter().flat_map(Plate::shut).collect(),
            grains: &state.grains.position,
            slots: slots.collect(),
            sides,
        };
        join_boxes(scene, &mut walls, &standing);
    }
    for (source, inflow) in sources.iter_mut().zip(&scene.inflows) {
        source.piston = piston(scene, inflow, source, &walls);
    }
    let movers = movers(scene, &walls);
    let belts = belts(scene, &walls);
    let drives = drives(scene, &movers);
    let plan = Plan {
        numerics: scene.numerics.clone(),
        gravity: narrow(&scene.domain.gravity),
        geometry: geometry(scene),
        friction_goes_on: scene.friction_goes_on(),
        lower: narrow(&scene.domain.lower),
        upper: narrow(&scene.domain.upper),
        periodic,
        materials: scene.materials.iter().map(|m| m.material.clone()).collect(),
        walls,
        ghost_depth,
        movers,
        belts,
        drives,
        plates,
        spins,
        sources,
        sinks,
        moments: moments(scene),
    };
    check_overlap(scene, &plan, &state)?;
    Ok((plan, state))
}

/// An outflow; what is outside of the domain is so by the slack that all else has, and not beyond a periodic side or the axis of rings.
fn sink<const D: usize>(scene: &Scene, place: OutflowPlace) -> Sink<D> {
    let domain = &scene.domain;
    let (lower, upper, outside) = match place {
        OutflowPlace::Box { lower, upper } => (lower, upper, false),
        OutflowPlace::Outside => {
            let rings = scene.dimension == Dimension::Axisymmetric;
            let slack = SLACK * scene.numerics.spacing;
            let is_open = |k: usize| !domain.periodic[k];
            let lower = |k: usize| match is_open(k) && !(rings && k == 0 && domain.lower[0] <= 0.0)
            {
                true => domain.lower[k] - slack,
                false => f64::NEG_INFINITY,
            };
            let upper = |k: usize| match is_open(k) {
                true => domain.upper[k] + slack,
                false => f64::INFINITY,
            };
            (std::array::from_fn(lower), std::array::from_fn(upper), true)
        }
    };
    Sink {
        lower: narrow(&lower),
        upper: narrow(&upper),
        outside,
    }
}

/// Points of walls and gates that what is there at the start may stand on or lie under; a chain of short segments has many of little weight.
fn supports<const D: usize>(scene: &Scene, walls: &WallPoints<D>) -> Vec<Support<D>> {
    if scene.numerics.scheme != Scheme::Implicit {
        return Vec::new();
    }
    let openings: Vec<f64> = scene.gates.iter().map(|g| g.start).collect();
    let plates = plates(scene, walls, &[], &[None; D]);
    let all = with_plates(walls, &plates, &openings);
    let points = all.position.iter().zip(&all.normal).zip(&all.weight);
    let points = points.map(|((place, normal), weight)| Support {
        place: *place,
        normal: *normal,
        weight: *weight,
    });
    points.filter(|point| point.weight > 0.0).collect()
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

fn periodic<const D: usize>(scene: &Scene) -> Periodic<D> {
    let domain = &scene.domain;
    let length = |k: usize| domain.upper[k] - domain.lower[k];
    let sides = |k: usize| if domain.periodic[k] { length(k) } else { 0.0 };
    Periodic {
        lower: narrow(&domain.lower),
        length: std::array::from_fn(sides),
    }
}
