//! Friction of walls.

use super::{Adjustable, Target, around};
use crate::scene::raw::{Ratio, RawWall};

/// Wall `i`'s friction coefficient, if it has Coulomb friction.
pub(super) fn friction(i: usize, name: &str, wall: &RawWall) -> Option<Adjustable> {
    let start = wall.wall_friction.as_ref()?.value.0;
    Some(Adjustable {
        name: format!("wall.{name}.friction"),
        description: format!("Coulomb friction coefficient of wall {name}"),
        unit: "1",
        display_unit: None,
        start,
        range: around((0.0, 10.0), start),
        target: Target::WallFriction(i),
    })
}

/// Sets it.
pub(super) fn apply(wall: &mut RawWall, value: f64) {
    if let Some(friction) = &mut wall.wall_friction {
        friction.value = Ratio(value);
    }
}
