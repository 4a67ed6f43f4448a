//! Shear stress at the top of a material: what flows over a bed drags on it with.

use super::pressure::fit_at;
use super::{DepthLine, Reading, View, along};

/// One value: shear stress [Pa] at the highest point of a material on a line, that of the linear fit to the particles of all
/// materials around it. `material` shows the material alone; `stress` shows all of them, with |tau| = sqrt(tau:tau/2) in
/// place of pressure.
///
/// Outside, blocked and empty as a depth gauge of that material.
#[must_use]
pub fn interface_stress<const D: usize>(
    line: &DepthLine<D>,
    material: &View<D>,
    stress: &View<D>,
) -> Reading {
    let depth = match line.depth(material) {
        Ok(depth) => depth,
        Err(why) => return Reading::none(1, why),
    };
    let at = along(&line.foot, &line.up, depth);
    // Where there is material of one kind there is material.
    Reading::valid(vec![fit_at(stress, &at).unwrap_or(0.0)])
}
