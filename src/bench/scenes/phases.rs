//! What several phases cost a scene that has none of them.

use serde::{Deserialize, Serialize};
use toml::Value;

use super::{COLUMN, Stretch, in_turns, template};
use crate::bench::Error;
use crate::validate::template::{Template, points, rectangle};

/// The column alone, with phases that nothing is made of, and beside a little of each phase.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Phases {
    /// Sand alone, the same once more, unused materials, and beside tubs of a second sand, of water, of saturated silt.
    pub stretches: Vec<Stretch>,
    /// Whether particles end at the same places, velocities and pressures with unused materials as in sand alone.
    pub same: bool,
}

/// A fluid, and a bed whose pores it fills.
fn with_phases(scene: Template) -> Template {
    scene
        .with("materials.water.law", "fluid")
        .with("materials.water.preset", "water")
        .with("materials.silt.law", "constant_friction")
        .with("materials.silt.friction_angle", "30 deg")
        .with("materials.silt.density", "1990 kg/m^3")
        .with("materials.silt.consistency", "3.97 Pa s")
        .with("materials.silt.pore_fluid", "water")
}

/// Another sand like the first.
fn with_second_sand(scene: Template) -> Template {
    scene
        .with("materials.other.law", "mu_i")
        .with("materials.other.preset", "sand_04")
}

/// A tub beyond the reach of the column: 10 by 5 particles, 3 % of what is there, at rest.
fn with_tub(scene: Template, material: &str) -> Template {
    scene
        .with(
            "domain.upper",
            Value::Array(vec![Value::from(0.5), Value::from(0.15)]),
        )
        .with(
            "walls.tub.polyline",
            points(&[[0.43, 0.05], [0.43, 0.0], [0.4602, 0.0], [0.4602, 0.05]]),
        )
        .with("bodies.tub.material", material)
        .with("bodies.tub.box", rectangle([0.43, 0.0], [0.4602, 0.0151]))
}

/// Steps the column alone and beside other phases in turns.
///
/// # Errors
/// [`Error::Scene`] if a step fails.
pub fn phases(simulated: f64, repeats: usize, watch: &mut dyn FnMut(f64)) -> Result<Phases, Error> {
    let alone = || template(COLUMN, "sand alone");
    let scenes = [
        ("sand alone", alone()?),
        ("the same once more", alone()?),
        (
            "with water and saturated silt that nothing is made of",
            with_phases(alone()?),
        ),
        ("beside a tub of the same sand", with_tub(alone()?, "sand")),
        (
            "beside a tub of another sand like it",
            with_tub(with_second_sand(alone()?), "other"),
        ),
        (
            "beside a tub of water",
            with_tub(with_phases(alone()?), "water"),
        ),
        (
            "beside a tub of saturated silt",
            with_tub(with_phases(alone()?), "silt"),
        ),
    ];
    let found = in_turns(&scenes, simulated, repeats, watch)?;
    let (first, unused) = (&found.ends[0].component, &found.ends[2].component);
    Ok(Phases {
        same: first.particles() == unused.particles(),
        stretches: found.stretches,
    })
}
