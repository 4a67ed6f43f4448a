//! Extents of bodies: the corners of boxes, so also how high they are filled; the fill level of other shapes, and where
//! a scene gives one.

use super::super::raw::{Length, Place, RawBody};
use super::super::types::{Domain, Point};
use super::{Adjustable, MILLIMETRES, Target, around, at};
use crate::shape::Shape;

/// Which value of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum BodyKey {
    /// A box's lower corner along an axis.
    Lower(usize),
    /// A box's upper corner along an axis.
    Upper(usize),
    /// Height below which the shape is filled.
    Level,
}

/// Where bodies may be.
pub(super) struct Space<'a> {
    pub(super) domain: &'a Domain,
    /// Against gravity's main axis.
    pub(super) up: Point,
    pub(super) axes: usize,
    /// Particle spacing, none where the scene gives none [m].
    pub(super) spacing: Option<f64>,
}

/// The values of the i-th body, whose shape is `shape` (none where the scene could not be read).
pub(super) fn list(
    i: usize,
    name: &str,
    raw: &RawBody,
    shape: Option<&Shape>,
    space: &Space<'_>,
    list: &mut Vec<Adjustable>,
) {
    let mut add = |key: &str, description: String, target, start: f64, range| {
        list.push(Adjustable {
            name: format!("body.{name}.{key}"),
            description,
            unit: "m",
            display_unit: MILLIMETRES,
            start,
            range: around(range, start),
            target: Target::Body(i, target),
        });
    };
    let (lower, upper) = (space.domain.lower, space.domain.upper);
    let given = raw.level.as_ref().map(|level| level.value.0);
    if let Some(Shape::Box {
        lower: low,
        upper: high,
    }) = shape
    {
        for axis in 0..space.axes {
            let letter = ["x", "y", "z"][axis];
            let range = (lower[axis], upper[axis]);
            let text = |end: &str, top: bool| {
                let level = match given {
                    Some(_) if top => format!(", no lower than its fill level, body.{name}.level"),
                    None if top => ": its fill level".to_owned(),
                    _ => String::new(),
                };
                format!("{letter} of the {end} corner of body {name}{level}")
            };
            // What repeats itself along an axis is not filled along it.
            let up = match space.domain.periodic[axis] {
                true => 0.0,
                false => space.up[axis],
            };
            let (key, lowest) = (format!("lower_{letter}"), text("lower", up < 0.0));
            add(&key, lowest, BodyKey::Lower(axis), low[axis], range);
            let (key, highest) = (format!("upper_{letter}"), text("upper", up > 0.0));
            add(&key, highest, BodyKey::Upper(axis), high[axis], range);
        }
    }
    // Corners of boxes move.
    let own = shape.filter(|shape| !matches!(shape, Shape::Box { .. }));
    let own = own.map(|shape| heights(shape.bounds(), space.up));
    if let Some(start) = given.or(own.map(|(_, top)| top)) {
        let text = format!("height up to which body {name} is filled");
        // Less than a spacing would be no body.
        let lift = |(foot, top)| (foot + space.spacing.unwrap_or(0.0), top);
        let range = own.map_or(heights((lower, upper), space.up), lift);
        add("level", text, BodyKey::Level, start, range);
    }
}

/// Least and greatest height of a box along "up", which is an axis [m].
fn heights((lower, upper): (Point, Point), up: Point) -> (f64, f64) {
    let height = |p: Point| (0..3).map(|axis| up[axis] * p[axis]).sum::<f64>();
    let (a, b) = (height(lower), height(upper));
    (a.min(b), a.max(b))
}

/// Puts a value of a body.
pub(super) fn apply(body: &mut RawBody, place: &Place, key: BodyKey, value: f64) {
    let corner = match key {
        BodyKey::Level => {
            body.level = at(place, "level", Length(value));
            return;
        }
        BodyKey::Lower(axis) => (axis, body.r#box.as_mut().map(|b| &mut b.value.lower)),
        BodyKey::Upper(axis) => (axis, body.r#box.as_mut().map(|b| &mut b.value.upper)),
    };
    if let (axis, Some(Some(corner))) = corner
        && let Some(coordinate) = corner.value.values.get_mut(axis)
    {
        *coordinate = value;
    }
}
