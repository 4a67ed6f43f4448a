//! Shear stress at the top of a material: what flows over a bed drags on it with.

use super::pressure::fit_at;
use super::{DepthLine, Reading, View, along};

/// One value: shear stress [Pa] at the highest point of a material on a line, that of the linear fit to the particles around it of
/// what ranks lowest there: it bears the stress between materials (docs/theory.md, F6), and a bed's own may be whatever holds it
/// together. `material` shows the material alone; `stress` the materials of each rank, from the lowest, with |tau| =
/// sqrt(tau:tau/2) in place of pressure.
///
/// Outside, blocked and empty as a depth gauge of that material.
#[must_use]
pub fn interface_stress<'v, const D: usize>(
    line: &DepthLine<D>,
    material: &View<D>,
    stress: impl Iterator<Item = View<'v, D>>,
) -> Reading {
    let depth = match line.depth(material) {
        Ok(depth) => depth,
        Err(why) => return Reading::none(1, why),
    };
    let at = along(&line.foot, &line.up, depth);
    let mut sides = stress.filter_map(|view| fit_at(&view, &at));
    // Where there is material of one kind there is material.
    Reading::valid(vec![sides.next().unwrap_or(0.0)])
}
