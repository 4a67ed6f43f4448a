//! Walls as points, the groups these belong to, and how walls move.

use crate::boundary::{
    Belt, Drive, End, GroupSpec, Joint, Mover, ROWS, RigidMotion, WallPoints, box_points,
    free_ends, joined_points, plane_points, tip_points, to_centres,
};
use crate::math::{dot, norm, scale};
use crate::solver::{PARALLEL, Periodic};

use super::faces::faces_at;
use super::narrow;
use super::slides::drop_behind_slides;
use crate::scene::{
    Dimension, ForceTarget, GaugeKind, Point, Rotation, Scene, Slip, Wall, WallGeometry,
};

/// Points of all walls, and groups of walls and gates in this order.
pub(super) fn walls<const D: usize>(scene: &Scene, periodic: &Periodic<D>) -> WallPoints<D> {
    let dp = scene.numerics.spacing;
    let mut points = WallPoints::default();
    for (n, wall) in scene.walls.iter().enumerate() {
        let motion = rigid_motion::<D>(&wall.velocity, wall.rotation.as_ref());
        points.groups.push(GroupSpec {
            spin: motion.spin(),
            drift: wall.velocity,
            ..group(scene, wall.slip, wall.rigid, ForceTarget::Wall(n))
        });
        match &wall.geometry {
            WallGeometry::Polyline {
                points: corners,
                closed,
            } => add_polyline(&mut points, scene, n, corners, *closed),
            WallGeometry::Box { lower, upper } => {
                let (velocity, faces) = (narrow(&wall.velocity), faces_at(scene, n));
                let rows = box_points::<D>(&narrow(lower), &narrow(upper), &faces, dp);
                for (x, normal, weight) in rows {
                    points.push(x, velocity, normal, weight, n as u16);
                }
            }
            WallGeometry::Plane { point, normal } => {
                add_plane(&mut points, scene, periodic, n, (point, normal));
            }
        }
    }
    if scene.dimension == Dimension::Axisymmetric {
        points.retain(|x, _| x[0] > 0.0);
    }
    drop_behind_slides(scene, &mut points);
    let wall = |group: u16| &scene.walls[group as usize];
    points.drop_doubles(dp, |a, b| wall(a).moves_with(wall(b)));
    // Afterwards: in a tip points lie closer than that, and two at each place.
    for n in 0..scene.walls.len() {
        add_tips(&mut points, scene, n);
    }
    for (n, gate) in scene.gates.iter().enumerate() {
        points
            .groups
            .push(group(scene, gate.slip, false, ForceTarget::Gate(n)));
    }
    points
}

/// Points of a chain of straight sides in the plane, and its ends where no other wall goes on.
fn add_polyline<const D: usize>(
    points: &mut WallPoints<D>,
    scene: &Scene,
    wall: usize,
    corners: &[[f64; 2]],
    closed: bool,
) {
    let dp = scene.numerics.spacing;
    let Wall {
        velocity, rigid, ..
    } = &scene.walls[wall];
    let group = wall as u16;
    let wide = |x: [f64; 2]| narrow(&[x[0], x[1], 0.0]);
    let joints = joints(scene, wall);
    let rows = joined_points(corners, closed, joints, dp);
    let bends = to_centres(corners, closed, joints, &rows, dp);
    if bends.iter().any(|to| *to != [0.0; 2]) {
        points.to_centre.resize(points.len(), [0.0; D]);
        points.to_centre.extend(bends.into_iter().map(wide));
    }
    for (x, normal, weight) in rows {
        points.push(wide(x), narrow(velocity), wide(normal), weight, group);
    }
    let (depth, rim) = (ROWS as f64 * dp, 0.25 * dp);
    if let Some((joint, other)) = straight_joint(scene, wall, depth) {
        let joint = Joint {
            place: wide(joint.place),
            ways: joint.ways.map(wide),
            normal: wide(joint.normal),
            depth,
        };
        points.add_joint(&joint, group, other);
    }
    if closed || *rigid {
        return;
    }
    for (end, length) in free_ends(corners, joints, depth, rim) {
        let end = End {
            point: wide(end.point),
            outward: wide(end.outward),
            normal: wide(end.normal),
            depth,
            rim,
        };
        points.add_end(end, length, group);
    }
}

/// Points in the acute corners of a chain of straight sides.
fn add_tips<const D: usize>(points: &mut WallPoints<D>, scene: &Scene, wall: usize) {
    let Wall {
        geometry, velocity, ..
    } = &scene.walls[wall];
    let WallGeometry::Polyline {
        points: corners,
        closed,
    } = geometry
    else {
        return;
    };
    let (dp, joints) = (scene.numerics.spacing, joints(scene, wall));
    let wide = |x: [f64; 2]| narrow(&[x[0], x[1], 0.0]);
    let is_shown = |x: [f64; 2]| scene.dimension != Dimension::Axisymmetric || x[0] > 0.0;
    for (x, normal, weight) in tip_points(corners, *closed, joints, dp) {
        if is_shown(x) {
            points.push(wide(x), narrow(velocity), wide(normal), weight, wall as u16);
        }
    }
}

/// Points of a plane through `point` with this normal, within the domain.
fn add_plane<const D: usize>(
    points: &mut WallPoints<D>,
    scene: &Scene,
    periodic: &Periodic<D>,
    wall: usize,
    (point, normal): (&Point, &Point),
) {
    let normal = narrow(normal);
    let sides = std::array::from_fn(|k| periodic.length[k] > 0.0);
    let (lower, upper) = (narrow(&scene.domain.lower), narrow(&scene.domain.upper));
    let motion = rigid_motion::<D>(
        &scene.walls[wall].velocity,
        scene.walls[wall].rotation.as_ref(),
    );
    let dp = scene.numerics.spacing;
    let (place, faces) = (narrow(point), faces_at(scene, wall));
    let rows = plane_points::<D>((&place, &normal), &faces, (&lower, &upper), &sides, dp);
    for (x, weight) in rows {
        let velocity = motion.velocity_at(&x, 0.0);
        points.push(x, velocity, normal, weight, wall as u16);
    }
}

/// What all points of a wall or gate share.
pub(in crate::scene) fn group(
    scene: &Scene,
    slip: Slip,
    moves: bool,
    target: ForceTarget,
) -> GroupSpec {
    let wants_force = scene
        .gauges
        .iter()
        .any(|g| matches!(g.kind, GaugeKind::Force { on, .. } if on == target));
    GroupSpec {
        free_slip: slip != Slip::NoSlip,
        friction: slip.friction(),
        moves,
        wants_force,
        spin: [0.0; 3],
        drift: [0.0; 3],
    }
}

/// Where a wall goes straight on from another one that moves as it does, and which: of a belt and what stands beside it each
/// keeps all that its points are pushed with, as they do not slide alike.
fn straight_joint(scene: &Scene, wall: usize, depth: f64) -> Option<(Joint<2>, u16)> {
    let WallGeometry::Polyline { points, .. } = &scene.walls[wall].geometry else {
        return None;
    };
    let (other, arrives) = meets(scene, wall)[0]?;
    let motion = |n: usize| (scene.walls[n].velocity, scene.walls[n].rotation);
    let is_steered = |n: usize| scene.walls[n].drive.is_some();
    let leaves = way(&points[0], &points[1]);
    let apart = motion(wall) != motion(other) || is_steered(wall) || is_steered(other);
    if apart || dot(&arrives, &leaves) <= PARALLEL {
        return None;
    }
    let joint = Joint {
        place: points[0],
        ways: [arrives, leaves],
        normal: [-leaves[1], leaves[0]],
        depth,
    };
    Some((joint, other as u16))
}

/// Directions in which other walls arrive at the first point of an open polyline and leave its last: walls that meet make a
/// whole corner, if they stay where they are to each other.
fn joints(scene: &Scene, wall: usize) -> [Option<[f64; 2]>; 2] {
    meets(scene, wall).map(|met| met.map(|(_, way)| way))
}

/// As [`joints`], each with the wall that is met.
fn meets(scene: &Scene, wall: usize) -> [Option<(usize, [f64; 2])>; 2] {
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
    let others: Vec<(usize, &Vec<[f64; 2]>)> = others.filter_map(|n| Some((n, open(n)?))).collect();
    let eps = 1e-6 * scene.numerics.spacing;
    let same = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < eps;
    let (first, last) = (own[0], own[own.len() - 1]);
    let before = others.iter().find(|(_, o)| same(&o[o.len() - 1], &first));
    let after = others.iter().find(|(_, o)| same(&o[0], &last));
    [
        before.map(|(n, o)| (*n, way(&o[o.len() - 2], &o[o.len() - 1]))),
        after.map(|(n, o)| (*n, way(&o[0], &o[1]))),
    ]
}

/// Unit direction from a to b.
fn way(a: &[f64; 2], b: &[f64; 2]) -> [f64; 2] {
    let d = [b[0] - a[0], b[1] - a[1]];
    scale(1.0 / norm(&d), &d)
}

/// Walls that move as a whole.
pub(super) fn movers<const D: usize>(scene: &Scene, points: &WallPoints<D>) -> Vec<Mover<D>> {
    let rigid = scene.walls.iter().enumerate().filter(|(_, w)| w.rigid);
    rigid
        .map(|(n, wall)| {
            let motion = rigid_motion(&wall.velocity, wall.rotation.as_ref());
            Mover::new(points, n as u16, motion, scene.drive_of(n))
        })
        .collect()
}

/// Walls whose surface slides along itself at a speed that is steered.
pub(super) fn belts<const D: usize>(scene: &Scene, points: &WallPoints<D>) -> Vec<Belt<D>> {
    let sliding = scene.walls.iter().enumerate().filter(|(_, w)| !w.rigid);
    let steered = sliding.filter_map(|(n, _)| Some((n, scene.drive_of(n)?)));
    steered
        .map(|(n, drive)| Belt::new(points, n as u16, drive))
        .collect()
}

/// How the walls that are steered may move.
pub(super) fn drives<const D: usize>(scene: &Scene, movers: &[Mover<D>]) -> Vec<Drive> {
    let drives = scene.drives().enumerate();
    drives
        .map(|(n, (_, drive))| Drive {
            steers: drive.steers,
            stops: (drive.stops.0 / drive.full, drive.stops.1 / drive.full),
            quickness: drive.ramp.recip(),
            speed: {
                let mover = movers.iter().find(|m| m.drive == Some(n));
                mover.map_or(0.0, |m| m.travel(1.0))
            },
        })
        .collect()
}

/// How a wall's material moves, or a body's at the start.
pub(crate) fn rigid_motion<const D: usize>(
    velocity: &Point,
    rotation: Option<&Rotation>,
) -> RigidMotion<D> {
    let (centre, rate, axis) = match rotation {
        Some(r) => (r.centre, r.rate, r.axis),
        None => ([0.0; 3], 0.0, [0.0, 0.0, 1.0]),
    };
    RigidMotion {
        velocity: narrow(velocity),
        centre: narrow(&centre),
        rate,
        axis,
    }
}
