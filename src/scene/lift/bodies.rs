//! Bodies: where material is at the start, clear of everything else.

use super::geometry::{Region, crossing_edges, signed_area};
use super::motion::Turning;
use super::{Filled, Lift};
use crate::math::dot;
use crate::scene::raw::{At, Coordinates, Entry, Length, List, Place, RawBody, RawBox, RawColumn};
use crate::scene::types::{Body, Dimension, VelocityProfile};
use crate::shape::{Shape, cut_below};

const PLANAR_BOX: &str = "box = { lower = [0, 0], upper = [0.1, 0.1] }";
const SPACE_BOX: &str = "box = { lower = [0, 0, 0], upper = [0.1, 0.1, 0.1] }";

impl Lift<'_> {
    pub(super) fn bodies(&mut self) -> Vec<Body> {
        let raw = self.raw;
        let entries = Self::readable(raw.bodies.as_ref());
        let lift = |(entry, body)| self.body(entry, body);
        entries.into_iter().filter_map(lift).collect()
    }

    fn body(&mut self, entry: &Entry<RawBody>, raw: &RawBody) -> Option<Body> {
        let material = raw.material.as_ref().and_then(|name| {
            let known = self.raw.materials.as_ref();
            self.index_of(&name.value.0, &name.place, "materials", known)
        });
        let velocity = match &raw.velocity {
            Some(velocity) => self.vector(velocity),
            None => Some([0.0; 3]),
        };
        let rotation = self.rotation(&Turning {
            what: "a body",
            given: &raw.given,
            rate: raw.angular_velocity.as_ref(),
            centre: raw.centre.as_ref(),
            axis: raw.axis.as_ref(),
        });
        let shape = self.shape(entry, raw)?;
        let region = self.region(&shape);
        let region = self.fill_to_level(raw, region)?;
        self.check_body_size(&entry.place, &region);
        let (lower, upper) = region.bounds();
        if self.check_inside(&entry.place, lower) && self.check_inside(&entry.place, upper) {
            self.check_bodies_apart(&entry.place, &region);
        }
        self.filled.push(Filled {
            place: entry.place.clone(),
            region,
            material,
        });
        let roundness = match (&raw.circle, &shape) {
            (Some(_), Shape::Polygon { points }) => {
                let side = std::f64::consts::TAU / points.len() as f64;
                side / side.sin()
            }
            _ => 1.0,
        };
        Some(Body {
            name: entry.name.clone(),
            material: material?,
            shape,
            roundness,
            level: raw.level.as_ref().map(|l| l.value.0),
            velocity: velocity?,
            rotation: rotation?,
            profile: match raw.velocity_profile {
                Some(_) => VelocityProfile::Bagnold,
                None => VelocityProfile::Uniform,
            },
        })
    }

    /// Exactly one of box, polygon, circle and column, as the dimension allows.
    fn shape(&mut self, entry: &Entry<RawBody>, raw: &RawBody) -> Option<Shape> {
        let (keys, example): (&[&str], _) = match self.dimension {
            Dimension::Two => (&["box", "polygon", "circle"], PLANAR_BOX),
            Dimension::Axisymmetric => (&["box", "polygon"], PLANAR_BOX),
            Dimension::Three => (&["box", "column"], SPACE_BOX),
        };
        // One that the dimension does not have is told with what to use instead.
        let all = ["box", "polygon", "circle", "column"];
        self.check_one_of(&entry.place, &raw.given, &all, keys, example)?;
        if let Some(circle) = &raw.circle {
            let instead = if self.planar() {
                "box or polygon"
            } else {
                "box or column"
            };
            let points = self.circle(circle, instead)?;
            return Some(Shape::Polygon { points });
        }
        match (&raw.r#box, &raw.polygon, &raw.column) {
            (Some(r#box), _, _) => {
                let (lower, upper) = self.raw_box(r#box)?;
                Some(Shape::Box { lower, upper })
            }
            (_, Some(polygon), _) => {
                let points = self.polygon(polygon)?;
                Some(Shape::Polygon { points })
            }
            (_, _, Some(column)) => self.column(column),
            _ => None,
        }
    }

    /// Reports none or several of a set of keys that exclude each other; `fitting` are those that the dimension has.
    pub(super) fn check_one_of(
        &mut self,
        table: &Place,
        given: &[&str],
        keys: &[&str],
        fitting: &[&str],
        example: &str,
    ) -> Option<()> {
        let stands = |key: &&str| given.contains(key);
        let names: Vec<&str> = keys.iter().copied().filter(stands).collect();
        let remedy = match names.len() {
            0 => format!("add for example {example}"),
            1 => return Some(()),
            _ => "delete all but one".to_owned(),
        };
        let found = match names.len() {
            0 => "none of them".to_owned(),
            _ => names.join(" and "),
        };
        let allowed = format!("exactly one of {}", fitting.join(", "));
        self.problems.report(table, found, allowed, remedy);
        None
    }

    pub(super) fn raw_box(&mut self, at: &At<RawBox>) -> Option<([f64; 3], [f64; 3])> {
        self.corners(at.value.lower.as_ref(), at.value.upper.as_ref())
    }

    fn column(&mut self, at: &At<RawColumn>) -> Option<Shape> {
        if self.planar() {
            let shapes = match self.axisymmetric() {
                true => "box or polygon",
                false => "box, polygon or circle",
            };
            self.problems.report(
                &at.place,
                format!("a column in {}", self.kind()),
                format!("{shapes}, because {}", self.dimension_key()),
                "use a box (in an axisymmetric scene one from r = 0 is a column), or set dimension = 3",
            );
            return None;
        }
        let base = self.vector(at.value.base.as_ref()?)?;
        Some(Shape::Column {
            base,
            radius: at.value.radius.as_ref()?.value.0,
            height: at.value.height.as_ref()?.value.0,
            quarter: at.value.quarter.as_ref().is_some_and(|q| q.value.0),
        })
    }

    /// A simple polygon with an area.
    fn polygon(&mut self, at: &At<List<Coordinates<Length>>>) -> Option<Vec<[f64; 2]>> {
        let points = self.outline(at, 3, "box or column")?;
        let eps = self.eps();
        let count = points.len();
        for i in 0..count {
            let (a, b) = (points[i], points[(i + 1) % count]);
            let place = &at.value.0[(i + 1) % count].place;
            let remedy = "delete it; the last corner joins the first by itself";
            self.check_apart(place, a, b, remedy)?;
        }
        if let Some((i, j)) = crossing_edges(&points, true, eps) {
            self.problems.report(
                &at.place,
                format!("the edge after point {i} crosses the edge after point {j}"),
                "a polygon that does not cross itself",
                "give the corners in order around the outline (points count from 0)",
            );
            return None;
        }
        if signed_area(&points).abs() <= eps * eps {
            self.problems.report(
                &at.place,
                "a polygon without area",
                "corners that are not all on one line",
                "move a corner",
            );
            return None;
        }
        Some(points)
    }

    fn region(&self, shape: &Shape) -> Region {
        match shape {
            Shape::Box { lower, upper } => Region::block(self.planar(), *lower, *upper),
            Shape::Polygon { points } => Region::Polygon(points.clone()),
            Shape::Column {
                base,
                radius,
                height,
                quarter,
            } => Region::Column {
                base: *base,
                radius: *radius,
                height: *height,
                quarter: *quarter,
            },
        }
    }

    /// The part of a body below its level; reports levels that leave nothing.
    fn fill_to_level(&mut self, raw: &RawBody, region: Region) -> Option<Region> {
        let Some(level) = &raw.level else {
            return Some(region);
        };
        let up = self.up();
        let (lower, upper) = region.bounds();
        let (a, b) = (dot(&up, &lower), dot(&up, &upper));
        let (low, high) = (a.min(b), a.max(b));
        if level.value.0 <= low || level.value.0 > high + self.eps() {
            self.problems.report(
                &level.place,
                format!("{} m", level.value.0),
                format!("above {low} and at most {high} m, within the body's height"),
                "correct the level or the body",
            );
            return None;
        }
        let level = level.value.0;
        Some(match region {
            Region::Polygon(points) => Region::Polygon(cut_below(&points, [up[0], up[1]], level)),
            Region::Block {
                mut lower,
                mut upper,
            } => {
                for axis in 0..3 {
                    if up[axis] > 0.5 {
                        upper[axis] = upper[axis].min(level);
                    } else if up[axis] < -0.5 {
                        lower[axis] = lower[axis].max(-level);
                    }
                }
                Region::Block { lower, upper }
            }
            // A column is upright: a level cuts it level only if "up" is z.
            Region::Column {
                base,
                radius,
                height,
                quarter,
            } if up[2] > 0.5 => Region::Column {
                base,
                radius,
                height: height.min(level - base[2]),
                quarter,
            },
            column @ Region::Column { .. } => column,
        })
    }

    /// A body narrower than a particle would be empty.
    fn check_body_size(&mut self, place: &Place, region: &Region) {
        let Some(spacing) = self.spacing else {
            return;
        };
        let (lower, upper) = region.bounds();
        for axis in 0..self.axes() {
            let extent = upper[axis] - lower[axis];
            if extent < spacing * (1.0 - 1e-9) {
                self.problems.report(
                    place,
                    format!("a body {extent} m wide along {}", Self::axis_name(axis)),
                    format!(
                        "at least numerics.spacing, {spacing} m{}, along every axis",
                        self.of_quality()
                    ),
                    "enlarge the body or refine numerics.spacing",
                );
                return;
            }
        }
    }

    fn check_bodies_apart(&mut self, place: &Place, region: &Region) {
        let eps = self.eps();
        let mut others = self.filled.iter();
        if let Some(other) = others.find(|f| f.region.overlaps(region, eps)) {
            let found = format!("overlaps {}", other.place.key);
            self.problems.report(
                place,
                found,
                "bodies that touch at most",
                "move or shrink one of them",
            );
        }
    }

    /// A scene without bodies and inflows has nothing to do.
    pub(super) fn check_something_flows(&mut self) {
        // A section that is there but could not be read has been reported.
        let bodies = self.raw.bodies.as_ref().map(|b| b.value.0.len());
        let inflows = self.raw.inflows.as_ref().map(|i| i.value.0.len());
        let some = |count: Option<usize>, key: &str| {
            count.unwrap_or(usize::from(self.raw.given.contains(&key))) > 0
        };
        if !some(bodies, "bodies") && !some(inflows, "inflows") {
            self.problems.report(
                &Place::default().child("bodies"),
                "neither a body nor an inflow",
                "at least one [bodies.NAME] or [inflows.NAME]",
                "add a body, for example [bodies.fill] with material and box",
            );
        }
    }
}
