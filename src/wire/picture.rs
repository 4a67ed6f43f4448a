//! Scene → what viewers draw: walls, gates, inflows, outflows and gauges as lines, boxes and texts.
//!
//! A gate is drawn closed in a frame of its own, `gate.NAME`, and a wall that moves as a whole where it starts in
//! `wall.NAME`; [`frames`](super::convert::frames) say where these frames are. Particles are in [`point_cloud`](super::convert::point_cloud).

use super::convert::{IDENTITY, WORLD, pose, timestamp};
use super::foxglove::{
    Color, CubePrimitive, KeyValuePair, LinePrimitive, LineType, Point3, Pose, Quaternion,
    SceneEntity, SceneUpdate, TextPrimitive, Vector3,
};
use crate::scene::{Gate, Gauge, GaugeKind, OutflowPlace, Point, Scene, Wall, WallGeometry};
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3 as V3};

const WALL: Color = color(0.35, 0.35, 0.38, 1.0);
const GATE: Color = color(0.80, 0.25, 0.15, 1.0);
const INFLOW: Color = color(0.15, 0.45, 0.80, 1.0);
const OUTFLOW: Color = color(0.15, 0.45, 0.80, 0.25);
const GAUGE: Color = color(0.10, 0.60, 0.30, 1.0);

/// Everything of the scene that does not flow, drawn at simulated time `time` [s].
#[must_use]
pub fn scene_update(scene: &Scene, time: f64) -> SceneUpdate {
    let artist = Artist { scene, time };
    let mut entities = Vec::new();
    entities.extend(scene.walls.iter().map(|wall| artist.wall(wall)));
    entities.extend(scene.gates.iter().map(|gate| artist.gate(gate)));
    for inflow in &scene.inflows {
        let corners = artist.face(inflow.from, inflow.to, inflow.span);
        let mut entity = artist.entity(format!("inflow.{}", inflow.name), WORLD.to_owned());
        entity.lines.push(artist.line(&corners, INFLOW));
        entities.push(entity);
    }
    for outflow in &scene.outflows {
        let OutflowPlace::Box { lower, upper } = outflow.place else {
            continue;
        };
        let mut entity = artist.entity(format!("outflow.{}", outflow.name), WORLD.to_owned());
        entity.cubes.push(artist.bounds(lower, upper, OUTFLOW));
        entities.push(entity);
    }
    entities.extend(scene.gauges.iter().map(|gauge| artist.gauge(gauge)));
    SceneUpdate {
        deletions: Vec::new(),
        entities,
    }
}

struct Artist<'a> {
    scene: &'a Scene,
    time: f64,
}

impl Artist<'_> {
    fn planar(&self) -> bool {
        self.scene.dimension.axes() == 2
    }

    fn entity(&self, id: String, frame_id: String) -> SceneEntity {
        SceneEntity {
            timestamp: Some(timestamp(self.time)),
            frame_id,
            metadata: vec![KeyValuePair {
                key: "name".to_owned(),
                value: id.clone(),
            }],
            id,
            frame_locked: true,
            ..SceneEntity::default()
        }
    }

    fn wall(&self, wall: &Wall) -> SceneEntity {
        let id = format!("wall.{}", wall.name);
        let frame = if wall.rigid {
            id.clone()
        } else {
            WORLD.to_owned()
        };
        let mut entity = self.entity(id, frame);
        match &wall.geometry {
            WallGeometry::Polyline { points, closed } => {
                let mut corners: Vec<Point> = points.iter().map(|&[x, y]| [x, y, 0.0]).collect();
                if *closed {
                    corners.extend(corners.first().copied());
                }
                entity.lines.push(self.line(&corners, WALL));
            }
            WallGeometry::Box { lower, upper } => {
                entity.cubes.push(self.bounds(*lower, *upper, WALL));
            }
            WallGeometry::Plane { point, normal } => {
                let corners = self.plane(*point, *normal);
                entity.lines.push(self.line(&corners, WALL));
            }
        }
        entity
    }

    /// The plate when closed: along x from `from` to `to`, its face at the far side of y, its body on the right.
    fn gate(&self, gate: &Gate) -> SceneEntity {
        let id = format!("gate.{}", gate.name);
        let mut entity = self.entity(id.clone(), id);
        let along = V3::from(gate.to) - V3::from(gate.from);
        let span = if self.planar() {
            V3::new(0.0, 0.0, self.scene.numerics.spacing)
        } else {
            V3::from(gate.span)
        };
        let (e1, e3) = (along.normalize(), span.normalize());
        let left = e3.cross(&e1);
        let depth = if self.planar() { V3::zeros() } else { span };
        let centre = V3::from(gate.from) + 0.5 * (along + depth) - 0.5 * gate.thickness * left;
        let turn = Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[e1, left, e3]));
        let q = UnitQuaternion::from_rotation_matrix(&turn);
        let orientation = Quaternion {
            x: q.i,
            y: q.j,
            z: q.k,
            w: q.w,
        };
        entity.cubes.push(CubePrimitive {
            pose: Some(pose(centre.into(), orientation)),
            size: Some(vector([along.norm(), gate.thickness, span.norm()])),
            color: Some(GATE),
        });
        entity
    }

    fn gauge(&self, gauge: &Gauge) -> SceneEntity {
        let name = format!("gauge.{}", gauge.name);
        let mut entity = self.entity(name.clone(), WORLD.to_owned());
        let corners = self.gauge_line(&gauge.kind);
        if !corners.is_empty() {
            entity.lines.push(self.line(&corners, GAUGE));
        }
        if let Some(at) = label_at(&gauge.kind) {
            entity.texts.push(TextPrimitive {
                pose: Some(pose(at, IDENTITY)),
                billboard: true,
                font_size: 12.0,
                scale_invariant: true,
                color: Some(GAUGE),
                text: name,
            });
        }
        entity
    }

    /// Where it measures; nothing for a point, and for a force, which is on a wall or gate that is drawn already.
    fn gauge_line(&self, kind: &GaugeKind) -> Vec<Point> {
        let end = |foot: Point, up: Point, length: f64| -> Point {
            (V3::from(foot) + length * V3::from(up)).into()
        };
        match kind {
            GaugeKind::Depth { foot, up, length }
            | GaugeKind::InterfaceStress { foot, up, length } => {
                vec![*foot, end(*foot, *up, *length)]
            }
            GaugeKind::Profile {
                from,
                to,
                up,
                length,
                ..
            } => vec![
                *from,
                *to,
                end(*to, *up, *length),
                end(*from, *up, *length),
                *from,
            ],
            GaugeKind::Discharge { from, to, span } => self.face(*from, *to, *span),
            GaugeKind::Front {
                origin, direction, ..
            } => {
                let step = 4.0 * self.scene.numerics.spacing;
                vec![*origin, end(*origin, *direction, step)]
            }
            GaugeKind::Mass { lower, upper } => {
                let [l, u] = [*lower, *upper];
                let corner = |x, y| [x, y, l[2]];
                vec![
                    corner(l[0], l[1]),
                    corner(u[0], l[1]),
                    corner(u[0], u[1]),
                    corner(l[0], u[1]),
                    corner(l[0], l[1]),
                ]
            }
            GaugeKind::Pressure { .. } | GaugeKind::Velocity { .. } | GaugeKind::Force { .. } => {
                Vec::new()
            }
        }
    }

    /// Two pixels wide whatever the scale.
    fn line(&self, corners: &[Point], color: Color) -> LinePrimitive {
        LinePrimitive {
            r#type: LineType::LineStrip as i32,
            pose: Some(Pose {
                position: Some(vector([0.0; 3])),
                orientation: Some(IDENTITY),
            }),
            thickness: 2.0,
            scale_invariant: true,
            points: corners
                .iter()
                .map(|&[x, y, z]| Point3 { x, y, z })
                .collect(),
            color: Some(color),
            colors: Vec::new(),
            indices: Vec::new(),
        }
    }

    /// Segment of a planar scene, outline of a parallelogram in space.
    fn face(&self, from: Point, to: Point, span: Point) -> Vec<Point> {
        if self.planar() {
            return vec![from, to];
        }
        let shifted = |p: Point| -> Point { (V3::from(p) + V3::from(span)).into() };
        vec![from, to, shifted(to), shifted(from), from]
    }

    /// A box along the axes; planar scenes get one particle spacing of depth, so that it can be seen.
    fn bounds(&self, lower: Point, upper: Point, color: Color) -> CubePrimitive {
        let mut size: Point = (V3::from(upper) - V3::from(lower)).into();
        let mut centre: Point = (0.5 * (V3::from(upper) + V3::from(lower))).into();
        if self.planar() {
            size[2] = self.scene.numerics.spacing;
            centre[2] = 0.0;
        }
        CubePrimitive {
            pose: Some(pose(centre, IDENTITY)),
            size: Some(vector(size)),
            color: Some(color),
        }
    }

    /// A plane as the line or square of it that is as large as the domain.
    fn plane(&self, point: Point, normal: Point) -> Vec<Point> {
        let domain = &self.scene.domain;
        let reach = 0.5 * (V3::from(domain.upper) - V3::from(domain.lower)).norm();
        let n = V3::from(normal);
        let out = if self.planar() || n.z.abs() < 0.9 {
            V3::z()
        } else {
            V3::x()
        };
        let a = out.cross(&n).normalize() * reach;
        let b = if self.planar() {
            V3::zeros()
        } else {
            n.cross(&a)
        };
        let at = |s: f64, t: f64| -> Point { (V3::from(point) + s * a + t * b).into() };
        if self.planar() {
            vec![at(-1.0, 0.0), at(1.0, 0.0)]
        } else {
            vec![
                at(-1.0, -1.0),
                at(1.0, -1.0),
                at(1.0, 1.0),
                at(-1.0, 1.0),
                at(-1.0, -1.0),
            ]
        }
    }
}

/// Where a gauge's name stands; none for a force, which is on a wall or gate.
fn label_at(kind: &GaugeKind) -> Option<Point> {
    match kind {
        GaugeKind::Depth { foot, .. } | GaugeKind::InterfaceStress { foot, .. } => Some(*foot),
        GaugeKind::Profile { from, .. } | GaugeKind::Discharge { from, .. } => Some(*from),
        GaugeKind::Pressure { at, .. } | GaugeKind::Velocity { at } => Some(*at),
        GaugeKind::Front { origin, .. } => Some(*origin),
        GaugeKind::Mass { lower, .. } => Some(*lower),
        GaugeKind::Force { .. } => None,
    }
}

const fn color(r: f64, g: f64, b: f64, a: f64) -> Color {
    Color { r, g, b, a }
}

fn vector([x, y, z]: Point) -> Vector3 {
    Vector3 { x, y, z }
}
