//! How walls move: belts, whose surface slides along itself, and rigid walls, which move as a whole.

use super::Lift;
use crate::math::{dot, length, normalized};
use crate::scene::raw::{
    AngularSpeed, At, Coordinates, Entry, Length, MotionWord, Place, Ratio, RawWall,
};
use crate::scene::types::{Point, Rotation, WallGeometry};

/// Share of a belt's velocity that may be across its surface [1].
const ASKEW: f64 = 1e-3;

/// What a table says of rotation.
pub(super) struct Turning<'a> {
    /// What turns, with its article.
    pub(super) what: &'a str,
    /// Keys of the table.
    pub(super) given: &'a [&'static str],
    pub(super) rate: Option<&'a At<AngularSpeed>>,
    pub(super) centre: Option<&'a At<Coordinates<Length>>>,
    pub(super) axis: Option<&'a At<Coordinates<Ratio>>>,
}

/// Motion of a wall.
pub(super) struct Motion {
    pub(super) rigid: bool,
    pub(super) velocity: Point,
    pub(super) rotation: Option<Rotation>,
}

impl Lift<'_> {
    /// Motion of a wall of this geometry.
    pub(super) fn motion(
        &mut self,
        entry: &Entry<RawWall>,
        raw: &RawWall,
        geometry: &WallGeometry,
    ) -> Option<Motion> {
        let rigid = raw.motion.as_ref()?.value == MotionWord::Rigid;
        let mut velocity = match &raw.velocity {
            Some(at) => self.vector(at)?,
            None => [0.0; 3],
        };
        let rotation = self.rotation(&Turning {
            what: "a wall",
            given: &raw.given,
            rate: raw.angular_velocity.as_ref(),
            centre: raw.centre.as_ref(),
            axis: raw.axis.as_ref(),
        })?;
        if let Some(at) = &raw.velocity {
            if rigid {
                self.check_rigid(&at.place, geometry, velocity);
            } else {
                velocity = self.along_belt(&at.place, geometry, velocity);
            }
        }
        if let (Some(at), Some(rotation)) = (&raw.angular_velocity, rotation) {
            self.check_turning(&at.place, geometry, rigid, rotation);
        }
        let turns = raw.given.contains(&"angular_velocity");
        if rigid && length(&velocity) == 0.0 && !turns {
            self.problems.report(
                &entry.place,
                "motion = \"rigid\" without velocity or angular_velocity",
                "one of them, not 0",
                if self.planar() {
                    "add for example velocity = [0, \"-1 mm/s\"], or delete motion"
                } else {
                    "add for example velocity = [0, 0, \"-1 mm/s\"], or delete motion"
                },
            );
        }
        Some(Motion {
            rigid,
            velocity,
            rotation,
        })
    }

    /// angular_velocity with its centre, and in space its axis; `Some(None)` if nothing turns.
    pub(super) fn rotation(&mut self, raw: &Turning) -> Option<Option<Rotation>> {
        let what = raw.what;
        let Some(rate) = raw.rate else {
            for place in [raw.centre.map(|c| &c.place), raw.axis.map(|a| &a.place)] {
                if let Some(place) = place.filter(|_| !raw.given.contains(&"angular_velocity")) {
                    self.problems.report(
                        place,
                        format!("{what} that does not turn"),
                        "centre and axis only beside angular_velocity",
                        "add for example angular_velocity = \"5 rpm\", or delete it",
                    );
                }
            }
            return Some(None);
        };
        if self.axisymmetric() {
            self.problems.report(
                &rate.place,
                format!("{what} that turns in an axisymmetric scene"),
                "no rotation: nothing swirls about the axis there",
                "delete it, or set dimension = 3",
            );
            return None;
        }
        let Some(centre) = raw.centre else {
            if !raw.given.contains(&"centre") {
                self.problems.report(
                    &rate.place,
                    "angular_velocity without a centre",
                    "angular_velocity beside the centre of rotation",
                    if self.planar() {
                        "add for example centre = [0, 0]"
                    } else {
                        "add for example centre = [0, 0, 0]"
                    },
                );
            }
            return None;
        };
        let axis = self.axis(raw, &rate.place);
        let centre = self.vector(centre);
        Some(Some(Rotation {
            rate: rate.value.0,
            centre: centre?,
            axis: axis?,
        }))
    }

    /// About what it turns: in the plane about z.
    fn axis(&mut self, raw: &Turning, rate: &Place) -> Option<Point> {
        match (raw.axis, self.planar()) {
            (None, true) => Some([0.0, 0.0, 1.0]),
            (Some(axis), false) => self.direction(axis),
            (Some(axis), true) => {
                self.problems.report(
                    &axis.place,
                    "an axis in a planar scene",
                    "axis only where dimension = 3; in the plane all turns about z",
                    "delete it, or set dimension = 3",
                );
                None
            }
            (None, false) => {
                if !raw.given.contains(&"axis") {
                    self.problems.report(
                        rate,
                        "angular_velocity without an axis",
                        "in space angular_velocity beside the axis of rotation",
                        "add for example axis = [0, 0, 1]",
                    );
                }
                None
            }
        }
    }

    /// A plane fills the domain's section, so that it can move along its normal only; rings move along the axis.
    fn check_rigid(&mut self, place: &Place, geometry: &WallGeometry, velocity: Point) {
        if let WallGeometry::Plane { normal, .. } = geometry {
            let across = dot(&velocity, normal);
            let along: Point = std::array::from_fn(|k| velocity[k] - across * normal[k]);
            if length(&along) > 1e-6 * length(&velocity) {
                self.problems.report(
                    place,
                    format!(
                        "a rigid plane that moves along itself at {} m/s",
                        length(&along)
                    ),
                    "a velocity along the plane's normal",
                    "turn it, use motion = \"belt\", or use a polyline or a box",
                );
            }
        }
        if self.axisymmetric() && velocity[0] != 0.0 {
            self.problems.report(
                place,
                format!("a radial velocity of {} m/s", velocity[0]),
                "a velocity along the axis, [0, v], in an axisymmetric scene",
                "set the first component to 0",
            );
        }
    }

    /// A belt that turns is a plane across its axis; planes cannot turn otherwise.
    fn check_turning(
        &mut self,
        place: &Place,
        geometry: &WallGeometry,
        rigid: bool,
        rotation: Rotation,
    ) {
        let table = match geometry {
            WallGeometry::Plane { normal, .. } => dot(normal, &rotation.axis).abs() > 1.0 - 1e-9,
            _ => false,
        };
        let plane = matches!(geometry, WallGeometry::Plane { .. });
        if plane != rigid && (rigid || table) {
            return;
        }
        let found = match (rigid, plane) {
            (true, _) => "a rigid plane that turns",
            (false, true) => "a belt that turns about an axis along it",
            (false, false) => "a belt that turns",
        };
        let (allowed, remedy) = match (self.planar(), plane) {
            (true, true) => (
                "rotation of rigid polylines, circles and boxes; planes cannot turn",
                "use a polyline, a circle or a box, or delete angular_velocity",
            ),
            (true, false) => (
                "rotation of rigid polylines, circles and boxes",
                "set motion = \"rigid\"",
            ),
            (false, true) => (
                "rotation of rigid boxes, and of belts that are planes across the axis; planes cannot turn otherwise",
                "use boxes, or set motion = \"belt\" with the axis along the plane's normal",
            ),
            (false, false) => (
                "rotation of rigid boxes, and of belts that are planes across the axis",
                "set motion = \"rigid\"",
            ),
        };
        self.problems.report(place, found, allowed, remedy);
    }

    /// Whether a wall of an axisymmetric scene begins at r = 0; a plane that is no cylinder does.
    fn reaches_axis(&self, geometry: &WallGeometry) -> bool {
        let eps = self.eps();
        match geometry {
            WallGeometry::Polyline { points, .. } => points.iter().any(|p| p[0] <= eps),
            WallGeometry::Box { lower, .. } => lower[0] <= eps,
            WallGeometry::Plane { normal, .. } => {
                let at_axis = self.domain.as_ref().is_none_or(|d| d.lower[0] <= eps);
                at_axis && normal[1].abs() > 1e-6
            }
        }
    }

    /// The velocity of a belt lies in its surface: what is across it because directions were written with few digits is taken away.
    fn along_belt(&mut self, place: &Place, geometry: &WallGeometry, velocity: Point) -> Point {
        let speed = length(&velocity);
        let across = match geometry {
            WallGeometry::Plane { normal, .. } => dot(&velocity, normal).abs(),
            WallGeometry::Box { .. } => speed,
            WallGeometry::Polyline { points, .. } => points
                .windows(2)
                .filter_map(|w| {
                    let along = [w[1][0] - w[0][0], w[1][1] - w[0][1], 0.0];
                    let [x, y, _] = normalized(&along)?;
                    Some((velocity[0] * y - velocity[1] * x).abs())
                })
                .fold(0.0, f64::max),
        };
        if self.axisymmetric() && velocity[0] != 0.0 && self.reaches_axis(geometry) {
            self.problems.report(
                place,
                format!(
                    "a radial velocity of {} m/s of a wall that reaches the axis",
                    velocity[0]
                ),
                "radial belts away from the axis only: on it nothing can move apart or together",
                "begin the wall at a radius above 0, or set the first component to 0",
            );
        }
        if across > ASKEW * speed {
            self.problems.report(
                place,
                format!("a velocity with {across} m/s across the surface"),
                "a velocity along the wall's surface (a belt): straight polylines and planes only",
                "turn it along the wall; for a wall that moves as a whole set motion = \"rigid\"",
            );
            return velocity;
        }
        let normal = surface_normal(geometry);
        let across = dot(&velocity, &normal);
        std::array::from_fn(|k| velocity[k] - across * normal[k])
    }
}

/// Unit normal of a straight surface; 0 of a box.
fn surface_normal(geometry: &WallGeometry) -> Point {
    match geometry {
        WallGeometry::Plane { normal, .. } => *normal,
        WallGeometry::Box { .. } => [0.0; 3],
        WallGeometry::Polyline { points, .. } => {
            let way = [
                points[1][0] - points[0][0],
                points[1][1] - points[0][1],
                0.0,
            ];
            normalized(&way).map_or([0.0; 3], |[x, y, _]| [-y, x, 0.0])
        }
    }
}
