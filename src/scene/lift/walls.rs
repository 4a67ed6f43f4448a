//! Walls and gates.

use super::Lift;
use super::faces::{example_of_span, plate_places};
use super::geometry::{Region, crossing_edges};
use crate::boundary::ROWS;
use crate::math::{cross, length, normalized, sub};
use crate::scene::raw::{At, Entry, Place, Ratio, RawGate, RawWall, SlipWord};
use crate::scene::types::{Dimension, Gate, Point, Slip, Wall, WallGeometry};
use crate::units::shown_bound;

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
    fn slip(
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
        Some(Wall {
            name: entry.name.clone(),
            geometry,
            slip: slip?,
            rigid: motion.rigid,
            velocity: motion.velocity,
            rotation: motion.rotation,
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
            (
                WallGeometry::Polyline { points, closed },
                Solid::Polyline(segments),
            )
        } else if let Some(r#box) = &raw.r#box {
            let (lower, upper) = self.raw_box(r#box)?;
            self.check_inside(&r#box.place, lower);
            self.check_inside(&r#box.place, upper);
            self.heights
                .extend([self.height(lower), self.height(upper)]);
            let solid = Solid::Block(Region::block(self.planar(), lower, upper));
            (WallGeometry::Box { lower, upper }, solid)
        } else {
            let plane = &raw.plane.as_ref()?.value;
            let point = plane.point.as_ref().and_then(|p| self.point(p));
            let normal = plane.normal.as_ref().and_then(|n| self.direction(n));
            let (point, normal) = (point?, normal?);
            self.heights.push(self.height(point));
            let geometry = WallGeometry::Plane { point, normal };
            (geometry, Solid::Plane { point, normal })
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

    pub(super) fn gates(&mut self) -> Vec<Gate> {
        let raw = self.raw;
        let entries = Self::readable(raw.gates.as_ref());
        let lift = |(entry, gate)| self.gate(entry, gate);
        entries.into_iter().filter_map(lift).collect()
    }

    fn gate(&mut self, entry: &Entry<RawGate>, raw: &RawGate) -> Option<Gate> {
        let from = raw.from.as_ref().and_then(|p| self.point(p));
        let to = raw.to.as_ref().and_then(|p| self.point(p));
        let example = example_of_span(from, to, None);
        let span = self.span(raw.span.as_ref(), &raw.given, &entry.place, &example);
        let thickness = self.thickness(raw);
        let slip = self.slip(
            &entry.place,
            raw.slip.as_ref(),
            raw.wall_friction.as_ref(),
            &raw.given,
        );
        let (from, to, span, spacing) = (from?, to?, span?, self.spacing?);
        self.check_face(&entry.place, from, to, span);
        self.heights.extend([self.height(from), self.height(to)]);
        let gate = Gate {
            name: entry.name.clone(),
            from,
            to,
            span,
            thickness: thickness.unwrap_or(ROWS as f64 * spacing),
            max_speed: raw.max_speed.as_ref()?.value.0,
            start: raw.start.as_ref()?.value.0,
            slip: slip?,
        };
        if !self.planar() {
            let places = plate_places(&gate, spacing);
            self.space_plates.push((entry.place.clone(), places));
        } else if let Some(plate) = plate(&gate) {
            self.plates.push((entry.place.clone(), plate));
        }
        Some(gate)
    }

    /// At least four spacings, so that no particle sees through the plate, and no more than the domain can hold.
    fn thickness(&mut self, raw: &RawGate) -> Option<f64> {
        let at: &At<_> = raw.thickness.as_ref()?;
        let least = ROWS as f64 * self.spacing?;
        if at.value.0 < least * (1.0 - 1e-9) {
            self.problems.report(
                &at.place,
                format!("{} m", at.value.0),
                format!(
                    "at least {} m, four times numerics.spacing{}",
                    shown_bound(least),
                    self.of_quality()
                ),
                "thicken the gate, leave thickness out, or refine numerics.spacing",
            );
        }
        if let Some(domain) = &self.domain {
            let sides = (0..3).map(|k| domain.upper[k] - domain.lower[k]);
            let most = sides.fold(0.0, f64::max);
            if at.value.0 > most.max(least) {
                self.problems.report(
                    &at.place,
                    format!("{} m", at.value.0),
                    format!("at most {most} m, the longest side of the domain"),
                    "give the thickness of the plate, or leave it out",
                );
                return None;
            }
        }
        Some(at.value.0)
    }

    /// A face at least two spacings wide, and in space with two edges that are not parallel.
    pub(super) fn check_face(
        &mut self,
        place: &Place,
        from: Point,
        to: Point,
        span: Point,
    ) -> bool {
        let least = 2.0 * self.spacing.unwrap_or(0.0);
        let edge = sub(&to, &from);
        let across = cross(&edge, &span);
        let thin = if self.planar() {
            length(&edge)
        } else {
            let longest = length(&edge).max(length(&span));
            (length(&across) / longest).min(length(&edge))
        };
        // But for rounding: 0.0875 - 0.0375 is a little less than 0.05.
        let good = thin >= least * (1.0 - 1e-9) && thin > 0.0;
        if !good {
            self.problems.report(
                place,
                format!(
                    "a face {} m wide",
                    shown_bound(if thin.is_nan() { 0.0 } else { thin })
                ),
                format!(
                    "at least {} m, two spacings{}; in space span is not parallel to from - to",
                    shown_bound(least),
                    self.of_quality()
                ),
                "move from and to apart, or refine numerics.spacing",
            );
        }
        good
    }
}

/// The plate where it covers its gap at the start; `None` if it is open.
fn plate(gate: &Gate) -> Option<Region> {
    if gate.start >= 1.0 {
        return None;
    }
    let edge = sub(&gate.to, &gate.from);
    let [x, y, _] = normalized(&edge)?;
    // To the right of the way from `from` to `to`.
    let deep = [y * gate.thickness, -x * gate.thickness];
    let a = [
        gate.from[0] + gate.start * edge[0],
        gate.from[1] + gate.start * edge[1],
    ];
    let b = [gate.to[0], gate.to[1]];
    Some(Region::Polygon(vec![
        a,
        [a[0] + deep[0], a[1] + deep[1]],
        [b[0] + deep[0], b[1] + deep[1]],
        b,
    ]))
}
