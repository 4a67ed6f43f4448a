//! Numbers and names that are legal and look like a slip: of units, of times, of what was left out.

use super::{devices, length};
use crate::material::Law;
use crate::scene::{Scene, Slip};

/// Densities that materials have [kg/m^3]: less is g/cm^3 meant, or a gas; nothing is heavier than osmium.
const DENSITIES: std::ops::RangeInclusive<f64> = 100.0..=25_000.0;

/// Wall friction that is seldom found [1]: the tangent of 56 deg.
const ROUGH: f64 = 1.5;

/// Remarks on materials, frictions, schedules, inflows and outflows, none for most scenes.
pub(super) fn slips(scene: &Scene) -> Vec<String> {
    let materials = densities(scene).into_iter().chain(large_grains(scene));
    let all = materials.chain(dry_under_fluid(scene));
    all.chain(frictions(scene))
        .chain(devices::devices(scene))
        .collect()
}

fn densities(scene: &Scene) -> Vec<String> {
    let told = scene.materials.iter().filter_map(|named| {
        let (of, density) = match &named.material.law {
            Law::MuI(_) | Law::BarkerGray(_) => (" of its grains", named.material.grains.density),
            Law::Fluid | Law::ConstantFriction(_) => ("", named.material.rest_density()),
        };
        (!DENSITIES.contains(&density)).then(|| {
            format!(
                "note: material {}: found a density{of} of {density} kg/m^3; of grains and liquids it is seldom below 100 or above\n  \
                 25000. Check its unit: plain numbers are kg/m^3, and \"1 g/cm^3\" is 1000 of them.",
                named.name
            )
        })
    });
    told.collect()
}

fn large_grains(scene: &Scene) -> Vec<String> {
    let spacing = scene.numerics.spacing;
    let told = scene.materials.iter().filter_map(|named| {
        let diameter = named.material.grains.diameter;
        let has_grains = matches!(named.material.law, Law::MuI(_) | Law::BarkerGray(_));
        (has_grains && diameter > spacing * (1.0 + 1e-9)).then(|| {
            format!(
                "note: material {}: its grains, {}, are larger than numerics.spacing, {}: what is computed finer than a grain is\n  \
                 none of the material's. Check the unit of grain_diameter, or take a coarser spacing.",
                named.name,
                length(diameter),
                length(spacing),
            )
        })
    });
    told.collect()
}

/// Grains without pore water beside a liquid: it stays out of their pores and carries none of their weight.
fn dry_under_fluid(scene: &Scene) -> Vec<String> {
    let liquid = scene.materials.iter().find(|named| {
        let material = &named.material;
        material.is_fluid()
            && material.cohesion == 0.0
            && material.rest_density() >= *DENSITIES.start()
    });
    let Some(liquid) = liquid else {
        return Vec::new();
    };
    let dry = scene.materials.iter().filter(|named| {
        let material = &named.material;
        !material.is_fluid() && !material.is_saturated()
    });
    let told = dry.map(|named| {
        format!(
            "note: material {}: its grains are dry, in a scene with {}: that stays out of their pores and carries none of what\n  \
             they press on each other with; a bed under it holds more than it would (through a sluice a third less came).\n  \
             Add pore_fluid = \"{}\" if the grains are saturated.",
            named.name, liquid.name, liquid.name
        )
    });
    told.collect()
}

fn frictions(scene: &Scene) -> Vec<String> {
    let walls = scene.walls.iter().map(|w| ("wall", &w.name, w.slip));
    let gates = scene.gates.iter().map(|g| ("gate", &g.name, g.slip));
    let told = walls.chain(gates).filter_map(|(kind, name, slip)| {
        let Slip::Friction { coefficient } = slip else {
            return None;
        };
        (coefficient > ROUGH).then(|| {
            format!(
                "note: {kind} {name}: its wall_friction of {coefficient} is the tangent of {:.1} deg. Give the tangent of the angle, not the\n  \
                 angle; for a wall that grains stick to leave `slip` out.",
                coefficient.atan().to_degrees()
            )
        })
    });
    told.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene in which nothing is to be told, with these edits: texts and what stands in their places.
    fn told(edits: &[(&str, &str)]) -> Vec<String> {
        let mut text = r#"
name = "s"
[domain]
lower = [0, -0.2]
upper = [0.6, 0.6]
[numerics]
spacing = 0.01
expected_speed = 1
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[bodies.heap]
material = "sand"
box = { lower = [0, 0], upper = [0.1, 0.1] }
[walls.bed]
polyline = [[0, 0], [0.6, 0]]
slip = "friction"
wall_friction = 0.5
[gates.main]
from = [0.3, 0]
to = [0.3, 0.3]
start = 0.5
[inflows.feed]
material = "sand"
from = [0.2, 0.5]
to = [0.1, 0.5]
velocity = [0, -0.5]
rate = 1
[outflows.end]
lower = [0.5, 0]
upper = [0.51, 0.6]
[run]
step = 0.01
until = 1
[[schedule]]
input = "gate.main.opening"
points = [[0, 0.5], [0.5, 1]]
"#
        .to_owned();
        for (old, new) in edits {
            assert!(text.contains(old), "no {old:?} to replace");
            text = text.replace(old, new);
        }
        slips(&crate::scene::parse("s", &text).unwrap_or_else(|e| panic!("{e}")))
    }

    /// One note with these words, and none of the scene as it is.
    fn one(edits: &[(&str, &str)], words: &[&str]) {
        let notes = told(edits);
        let [note] = &notes[..] else {
            panic!("{edits:?}: {notes:?}");
        };
        for word in words {
            assert!(note.contains(word), "no {word:?} in {note}");
        }
    }

    #[test]
    fn what_is_as_usual_is_not_told() {
        assert_eq!(told(&[]), Vec::<String>::new());
    }

    #[test]
    fn densities_and_frictions_of_other_units_are_told() {
        let grains = (
            "preset = \"glass_beads\"",
            "preset = \"glass_beads\"\ngrain_density = 2.5",
        );
        one(
            &[grains, ("rate = 1\n", "rate = 0.01\n")],
            &["material sand", "of 2.5 kg/m^3", "g/cm^3"],
        );
        one(
            &[("wall_friction = 0.5", "wall_friction = 25")],
            &["wall bed", "wall_friction of 25", "87.7 deg"],
        );
    }

    #[test]
    fn grains_larger_than_a_spacing_are_told() {
        let grains = (
            "preset = \"glass_beads\"",
            "preset = \"glass_beads\"\ngrain_diameter = \"11 mm\"",
        );
        one(
            &[grains],
            &["material sand", "0.011 m", "numerics.spacing, 0.01 m"],
        );
    }

    #[test]
    fn dry_grains_beside_water_are_told() {
        let water = "[materials.water]\nlaw = \"fluid\"\npreset = \"water\"\n\
                     [bodies.pool]\nmaterial = \"water\"\nbox = { lower = [0, 0.1], upper = [0.1, 0.2] }\n[bodies.heap]";
        one(
            &[("[bodies.heap]", water)],
            &["material sand", "pore_fluid = \"water\""],
        );
        let saturated = (
            "preset = \"glass_beads\"",
            "preset = \"glass_beads\"\npore_fluid = \"water\"",
        );
        assert_eq!(
            told(&[saturated, ("[bodies.heap]", water)]),
            Vec::<String>::new()
        );
    }

    #[test]
    fn schedules_that_set_the_start_aside_or_come_too_late_are_told() {
        let points = "points = [[0, 0.5], [0.5, 1]]";
        one(
            &[(points, "points = [[0, 0], [0.5, 1]]")],
            &["gate.main.opening", "it is 0 from 0 s on", "start = 0.5"],
        );
        one(
            &[(points, "points = [[2, 0.5], [3, 1]]")],
            &["gate.main.opening", "at 2 s, behind run.until, 1 s"],
        );
    }

    #[test]
    fn inflows_from_far_above_what_the_sound_speed_is_for_are_told() {
        one(
            &[
                ("from = [0.2, 0.5]", "from = [0.2, 0.58]"),
                ("to = [0.1, 0.5]", "to = [0.1, 0.58]"),
            ],
            &[
                "inflow feed",
                "0.58 m above",
                "by 6 %",
                "10.000 m/s, is for 0.101",
                "expected_speed = 2.385",
            ],
        );
    }

    #[test]
    fn outlets_of_few_spacings_are_told() {
        one(
            &[("to = [0.3, 0.3]", "to = [0.3, 0.07]")],
            &["gate main", "7.0 spacings", "numerics.spacing"],
        );
    }

    #[test]
    fn devices_that_do_nothing_or_may_miss_something_are_told() {
        one(
            &[(
                "slip = \"friction\"",
                "velocity = [1, 0]\ninput = \"speed\"\nslip = \"friction\"",
            )],
            &["wall bed", "no schedule sets wall.bed.speed"],
        );
        one(&[("rate = 1\n", "")], &["inflow feed", "inflows.feed.rate"]);
        let fed =
            "[[schedule]]\ninput = \"inflow.feed.rate\"\npoints = [[0, 0], [1, 0.5]]\n[[schedule]]";
        assert_eq!(
            told(&[("rate = 1\n", ""), ("[[schedule]]", fed)]),
            Vec::<String>::new()
        );
        one(
            &[("upper = [0.51, 0.6]", "upper = [0.505, 0.6]")],
            &["outflow end", "0.005 m thick"],
        );
    }
}
