//! Walls: where they are and how material slips on them.

use super::Lift;
use super::geometry::{Region, crossing_edges};
use crate::scene::raw::{At, Entry, Place, Ratio, RawBox, RawCircle, RawPlane, RawWall, SlipWord};
use crate::scene::types::{Dimension, Point, Slip, Wall, WallGeometry};

/// A wall, as far as bodies must keep clear of it.
pub(super) enum Solid {
    /// Segments with material on the left.
    Polyline(Vec<([f64; 2], [f64; 2])>),
    /// A box.
    Block(Region),
    /// A plane with material on the side of its normal.
    Plane { point: Point, normal: Point },
}

impl Lift<'_> {
    /// Slip of the wall or gate at `place`, with its coefficient of friction: there with slip = "friction" and only then.
    pub(super) fn slip(
        &mut self,
        place: &Place,
        word: Option<&At<SlipWord>>,
        friction: Option<&At<Ratio>>,
        given: &[&str],
    ) -> Option<Slip> {
        let slip = match word?.value {
            SlipWord::NoSlip => Slip::NoSlip,
            SlipWord::FreeSlip => Slip::FreeSlip,
            SlipWord::Friction => {
                if !given.contains(&"wall_friction") {
                    self.problems.report(
                        place,
                        "slip = \"friction\" without wall_friction",
                        "a coefficient mu_w >= 0",
                        "add for example wall_friction = 0.4",
                    );
                }
                return Some(Slip::Friction {
                    coefficient: friction?.value.0,
                });
            }
        };
        if let Some(friction) = friction {
            self.problems.report(
                &friction.place,
                "wall_friction on a wall that has another slip",
                "wall_friction only beside slip = \"friction\"",
                "add slip = \"friction\", or delete it",
            );
        }
        Some(slip)
    }

    pub(super) fn walls(&mut self) -> Vec<Wall> {
        let raw = self.raw;
        let entries = Self::readable(raw.walls.as_ref());
        let lift = |(entry, wall)| self.wall(entry, wall);
        entries.into_iter().filter_map(lift).collect()
    }

    fn wall(&mut self, entry: &Entry<RawWall>, raw: &RawWall) -> Option<Wall> {
        let geometry = self.wall_geometry(entry, raw)?;
        let slip = self.slip(
            &entry.place,
            raw.slip.as_ref(),
            raw.wall_friction.as_ref(),
            &raw.given,
        );
        let motion = self.motion(entry, raw, &geometry);
        let motion = motion?;
        let drive = self.drive(raw, &motion)?;
        Some(Wall {
            name: entry.name.clone(),
            geometry,
            slip: slip?,
            rigid: motion.rigid,
            velocity: motion.velocity,
            rotation: motion.rotation,
            drive,
        })
    }

    /// Exactly one of polyline, circle, box and plane.
    fn wall_geometry(&mut self, entry: &Entry<RawWall>, raw: &RawWall) -> Option<WallGeometry> {
        let chain = "polyline = [[0, 0], [1, 0]]";
        let (keys, example): (&[&str], _) = match self.dimension {
            Dimension::Two => (&["polyline", "circle", "box", "plane"], chain),
            Dimension::Axisymmetric => (&["polyline", "box", "plane"], chain),
            Dimension::Three => (
                &["box", "plane"],
                "plane = { point = [0, 0, 0], normal = [0, 0, 1] }",
            ),
        };
        let all = ["polyline", "circle", "box", "plane"];
        self.check_one_of(&entry.place, &raw.given, &all, keys, example)?;
        if let (Some(closed), false) = (&raw.closed, raw.given.contains(&"polyline")) {
            self.problems.report(
                &closed.place,
                "closed without a polyline",
                "closed only beside polyline",
                "delete it",
            );
        }
        let (geometry, solid) = if raw.polyline.is_some() {
            self.polyline(raw)?
        } else if let Some(circle) = &raw.circle {
            self.circular_wall(circle)?
        } else if let Some(r#box) = &raw.r#box {
            self.box_wall(r#box)?
        } else {
            self.plane_wall(&raw.plane.as_ref()?.value)?
        };
        self.check_periodic_sides_open(&entry.place, &solid);
        self.solids.push((entry.place.clone(), solid));
        Some(geometry)
    }

    fn polyline(&mut self, raw: &RawWall) -> Option<(WallGeometry, Solid)> {
        let at = raw.polyline.as_ref()?;
        let closed = raw.closed.as_ref().is_some_and(|c| c.value.0);
        let points = self.outline(at, if closed { 3 } else { 2 }, "box or plane")?;
        let eps = self.eps();
        let mut segments = Vec::new();
        let count = if closed {
            points.len()
        } else {
            points.len() - 1
        };
        for i in 0..count {
            let next = (i + 1) % points.len();
            let (a, b) = (points[i], points[next]);
            self.check_apart(&at.value.0[next].place, a, b, "delete this point")?;
            segments.push((a, b));
        }
        if let Some((i, j)) = crossing_edges(&points, closed, eps) {
            self.problems.report(
                &at.place,
                format!("the segment after point {i} crosses the segment after point {j}"),
                "a polyline that does not cross itself; its ends may touch it",
                "give the points in order along the surface, material on the left (points count from 0), or make two walls of it",
            );
            return None;
        }
        for (corner, [x, y]) in at.value.0.iter().zip(&points) {
            self.check_inside(&corner.place, [*x, *y, 0.0]);
            self.heights.push(self.height([*x, *y, 0.0]));
        }
        let geometry = WallGeometry::Polyline { points, closed };
        Some((geometry, Solid::Polyline(segments)))
    }

    fn circular_wall(&mut self, circle: &At<RawCircle>) -> Option<(WallGeometry, Solid)> {
        let instead = if self.planar() {
            "polyline, box or plane"
        } else {
            "box or plane"
        };
        let points = self.circle(circle, instead)?;
        let next = |i: usize| points[(i + 1) % points.len()];
        let segments = (0..points.len()).map(|i| (points[i], next(i))).collect();
        let heights: Vec<f64> = points
            .iter()
            .map(|&[x, y]| self.height([x, y, 0.0]))
            .collect();
        self.heights.extend(heights);
        let closed = true;
        Some((
            WallGeometry::Polyline { points, closed },
            Solid::Polyline(segments),
        ))
    }

    fn box_wall(&mut self, at: &At<RawBox>) -> Option<(WallGeometry, Solid)> {
        let (lower, upper) = self.raw_box(at)?;
        self.check_inside(&at.place, lower);
        self.check_inside(&at.place, upper);
        self.heights
            .extend([self.height(lower), self.height(upper)]);
        let solid = Solid::Block(Region::block(self.planar(), lower, upper));
        Some((WallGeometry::Box { lower, upper }, solid))
    }

    fn plane_wall(&mut self, plane: &RawPlane) -> Option<(WallGeometry, Solid)> {
        let point = plane.point.as_ref().and_then(|p| self.point(p));
        let normal = plane.normal.as_ref().and_then(|n| self.direction(n));
        let (point, normal) = (point?, normal?);
        self.heights.push(self.height(point));
        let geometry = WallGeometry::Plane { point, normal };
        Some((geometry, Solid::Plane { point, normal }))
    }

    /// No wall lies across a periodic side: material must pass there.
    fn check_periodic_sides_open(&mut self, place: &Place, solid: &Solid) {
        let Some(domain) = self.domain.clone() else {
            return;
        };
        let eps = self.eps();
        for axis in (0..self.axes()).filter(|&a| domain.periodic[a]) {
            let sides = [domain.lower[axis], domain.upper[axis]];
            let closes = match solid {
                Solid::Polyline(segments) => segments.iter().any(|(a, b)| {
                    let on =
                        |side: &f64| (a[axis] - side).abs() <= eps && (b[axis] - side).abs() <= eps;
                    sides.iter().any(on)
                }),
                Solid::Plane { normal, .. } => normal[axis].abs() > 1e-6,
                Solid::Block(_) => false,
            };
            if closes {
                let name = Self::axis_name(axis);
                self.problems.report(
                    place,
                    format!("a wall across the domain's side at {name}, which is periodic"),
                    format!(
                        "walls that leave periodic sides open, or no \"{name}\" in domain.periodic"
                    ),
                    "delete this part of the wall, or the axis from domain.periodic",
                );
            }
        }
    }
}
