//! Points, vectors, directions and boxes: as many values as the scene has axes, inside the domain where they have to be.

use super::Lift;
use crate::math::normalized;
use crate::scene::raw::{At, Coordinates, Length, Place};
use crate::scene::types::Point;

impl Lift<'_> {
    /// A point or vector with as many values as the scene has dimensions; reports other counts.
    pub(super) fn vector<Q>(&mut self, at: &At<Coordinates<Q>>) -> Option<Point> {
        let values = &at.value.values;
        if values.len() != self.axes() {
            let (allowed, remedy) = if self.planar() {
                (
                    format!("2 values, [x, y], because {}", self.dimension_key()),
                    "delete the third value, or set dimension = 3",
                )
            } else {
                (
                    "3 values, [x, y, z], because dimension = 3".to_owned(),
                    "add the third value, or set dimension = 2",
                )
            };
            let found = format!("{} values", values.len());
            self.problems.report(&at.place, found, allowed, remedy);
            return None;
        }
        let mut point = [0.0; 3];
        point[..values.len()].copy_from_slice(values);
        Some(point)
    }

    /// As [`Lift::vector`], and inside the domain.
    pub(super) fn point<Q>(&mut self, at: &At<Coordinates<Q>>) -> Option<Point> {
        let point = self.vector(at)?;
        self.check_inside(&at.place, point).then_some(point)
    }

    /// Reports points outside the domain.
    pub(super) fn check_inside(&mut self, place: &Place, point: Point) -> bool {
        let Some(domain) = &self.domain else {
            return true;
        };
        let eps = self.eps();
        let outside = (0..self.axes())
            .find(|&a| point[a] < domain.lower[a] - eps || point[a] > domain.upper[a] + eps);
        if let Some(axis) = outside {
            let name = Self::axis_name(axis);
            let allowed = format!(
                "{name} from {} to {} m, the domain",
                domain.lower[axis], domain.upper[axis]
            );
            let found = format!("{name} = {} m", point[axis]);
            let remedy = "move it into the domain, or enlarge domain.lower and domain.upper";
            self.problems.report(place, found, allowed, remedy);
        }
        outside.is_none()
    }

    /// A direction of unit length; reports zero vectors.
    pub(super) fn direction<Q>(&mut self, at: &At<Coordinates<Q>>) -> Option<Point> {
        let vector = self.vector(at)?;
        let unit = normalized(&vector);
        if unit.is_none() {
            self.problems.report(
                &at.place,
                "a vector of length 0",
                "a direction: any vector that is not 0",
                if self.planar() {
                    "write for example [0, 1]"
                } else {
                    "write for example [0, 0, 1]"
                },
            );
        }
        unit
    }

    /// The second edge of a face: needed in space, where `example` is one that fits, refused in the plane.
    pub(super) fn span<Q>(
        &mut self,
        span: Option<&At<Coordinates<Q>>>,
        given: &[&str],
        table: &Place,
        example: &str,
    ) -> Option<Point> {
        match (span, self.planar()) {
            (None, true) => Some([0.0; 3]),
            (Some(span), true) => {
                self.problems.report(
                    &span.place,
                    format!("span in {}", self.kind()),
                    "span only where dimension = 3; a plane's depth is domain.width, a ring's 2 pi x",
                    "delete it",
                );
                None
            }
            (Some(span), false) => self.vector(span),
            (None, false) if given.contains(&"span") => None,
            (None, false) => {
                self.problems.report(
                    &table.child("span"),
                    "nothing",
                    "the vector of the face's second edge, because dimension = 3",
                    format!("add for example {example}"),
                );
                None
            }
        }
    }

    /// Corners of a box, lower below upper on every axis; reports the first axis on which they are not.
    pub(super) fn corners(
        &mut self,
        lower: Option<&At<Coordinates<Length>>>,
        upper: Option<&At<Coordinates<Length>>>,
    ) -> Option<(Point, Point)> {
        let (low_at, high_at) = (lower?, upper?);
        let (low, high) = (self.vector(low_at), self.vector(high_at));
        let (low, high) = (low?, high?);
        for axis in 0..self.axes() {
            if low[axis] >= high[axis] {
                let name = Self::axis_name(axis);
                let found = format!("{name} = {} m", high[axis]);
                let allowed = format!("{name} above {} m, that of lower", low[axis]);
                let remedy = "swap or correct the corners";
                self.problems.report(&high_at.place, found, allowed, remedy);
                return None;
            }
        }
        Some((low, high))
    }
}
