//! Scenes made at random: a kind and a seed give a case, always the same.
//!
//! Every scene is legal (but those of kind `illegal`): values are drawn over the ranges that the scene reader allows, as
//! far as a scene of at most 500 particles and 2,000 internal steps means anything with them. Choices that the reader
//! refuses together are drawn again.

mod devices;
mod free;
mod illegal;
mod moving;
mod named;
mod parts;
mod phases;
mod plane;
mod rings;
mod space;

use super::dice::Dice;
use super::{Case, Drive, Expect};

/// Makes a draft of a kind.
type Make = fn(&mut Dice) -> Draft;

/// A kind of scene.
#[derive(Clone, Copy)]
pub struct Kind {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// How often it is drawn against the others.
    weight: usize,
    make: Make,
}

/// A scene's text and how it is driven, before it is known to be legal.
struct Draft {
    scene: String,
    drive: Drive,
}

const fn kind(name: &'static str, weight: usize, make: Make, about: &'static str) -> Kind {
    Kind {
        name,
        about,
        weight,
        make,
    }
}

/// All kinds. A new one goes to the end, so that seeds keep their scenes.
pub const KINDS: [Kind; 42] = [
    kind(
        "column",
        12,
        plane::column,
        "a heap of any slenderness in a closed box, with or without an obstacle",
    ),
    kind(
        "corners",
        10,
        plane::corners,
        "a block thrown about in a convex container of 3 to 7 tilted walls, gravity in any direction or none",
    ),
    kind(
        "drop",
        8,
        plane::drop,
        "blocks that fall onto a bed, onto each other and onto an obstacle",
    ),
    kind(
        "layer",
        6,
        plane::layer,
        "a layer of 2 to 5 rows on a slope, periodic, from rest or from Bagnold's profile",
    ),
    kind(
        "strata",
        5,
        plane::strata,
        "two materials of different density and friction above each other",
    ),
    kind(
        "rest",
        8,
        plane::rest,
        "a level fill between walls: it must stay at rest, with sleep on and off",
    ),
    kind(
        "silo",
        12,
        devices::silo,
        "a silo whose gate slams, flutters, creeps, stays shut or opens at once",
    ),
    kind(
        "chute",
        8,
        devices::chute,
        "a chute with inflow, gate and outflow under random histories",
    ),
    kind(
        "jam",
        5,
        devices::jam,
        "an inflow into a closed box until it jams",
    ),
    kind(
        "wake",
        6,
        devices::wake,
        "a small silo that falls asleep and is woken by its gate",
    ),
    kind(
        "drum",
        5,
        moving::drum,
        "a turning drum, a third of them steered",
    ),
    kind(
        "belt",
        4,
        moving::belt,
        "a heap on a belt between walls, a third of them steered",
    ),
    kind(
        "piston",
        5,
        moving::piston,
        "a wall that moves as a whole, towards the heap or away from it, a third of them steered",
    ),
    kind(
        "free",
        6,
        free::free,
        "bodies without walls that meet: momentum",
    ),
    kind(
        "frame",
        4,
        free::frame,
        "the same seen from a frame at up to 100 m/s (S13)",
    ),
    kind("fall", 4, free::fall, "a block in free fall (S12)"),
    kind("ring", 8, rings::column, "a round column, axisymmetric"),
    kind(
        "ring_silo",
        5,
        rings::silo,
        "a round silo with a gate in its floor, axisymmetric",
    ),
    kind("heap", 5, space::heap, "a heap in a box in space"),
    kind("sluice", 4, space::sluice, "a heap behind a gate in space"),
    kind("paper", 3, plane::paper, "scheme paper_a"),
    kind(
        "threads",
        2,
        plane::threads,
        "about 2,700 particles, from where on sweeps use all threads (S19)",
    ),
    kind(
        "illegal",
        6,
        illegal::illegal,
        "a legal scene with one illegal value (S17)",
    ),
    kind(
        "s1",
        2,
        named::slam,
        "a gate that slams shut in 1 ms on a full chute (S1)",
    ),
    kind(
        "s2",
        2,
        named::creep,
        "a gate that opens at once, or over 10 s (S2)",
    ),
    kind(
        "s5",
        2,
        named::tall,
        "a column 20 to 50 times as high as wide, planar or round (S5)",
    ),
    kind(
        "s6",
        1,
        named::sheet,
        "a sheet 20 times as wide as high (S6)",
    ),
    kind(
        "s8",
        2,
        named::friction,
        "friction of 2.0 to 2.5 and of 0.01 (S8)",
    ),
    kind("s9", 2, named::cap, "a viscosity cap of 1e8 Pa s (S9)"),
    kind("s10", 2, named::grains, "grains of 1 um and of 5 cm (S10)"),
    kind(
        "s11",
        2,
        named::long_rest,
        "a rest of many sqrt(H/g) with sleep off, or of an hour with sleep on (S11)",
    ),
    kind("s15", 2, named::corner, "a block shot into a corner (S15)"),
    kind(
        "s20",
        2,
        named::communication,
        "the same with communication steps from 1e-4 to 1e-1 s (S20)",
    ),
    kind("s21", 2, named::sleeper, "the same with sleep off (S21)"),
    kind(
        "s14",
        2,
        named::plug,
        "a plug that turns with its drum (S14)",
    ),
    kind(
        "tank",
        10,
        phases::tank,
        "a block of fluid in a closed box: water, clay, up to 1e8 Pa s, with and without shifting",
    ),
    kind(
        "fluids",
        8,
        phases::fluids,
        "two fluids of up to ten times each other's density, the heavy one below or on top (S7)",
    ),
    kind(
        "bed",
        10,
        phases::bed,
        "water over saturated grains: at rest, and dam breaks of both",
    ),
    kind(
        "sump",
        7,
        phases::sump,
        "a silo of fluid, or of silt under water, under random histories of its gate",
    ),
    kind(
        "film",
        5,
        phases::film,
        "a film of fluid on a slope, periodic",
    ),
    kind(
        "round",
        5,
        phases::round,
        "a round tank of fluid, or of silt under water, axisymmetric",
    ),
    kind(
        "pool",
        3,
        phases::pool,
        "a block of fluid in a box in space",
    ),
];

/// How often a draft is drawn again when the reader refuses it.
const ATTEMPTS: u64 = 20;

/// The kind of this name.
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Kind> {
    KINDS.iter().find(|kind| kind.name == name)
}

/// The case of a kind and a seed.
///
/// # Errors
/// There is no such kind, or no legal draft was found: why the last one was refused.
pub fn of_kind(name: &str, seed: u64) -> Result<Case, String> {
    let kind = by_name(name).ok_or_else(|| format!("there is no kind {name}"))?;
    let mut dice = Dice::new(kind.name, seed);
    let mut refused = String::new();
    for _ in 0..ATTEMPTS {
        let Draft { scene, mut drive } = (kind.make)(&mut dice);
        drive.kind = kind.name.to_owned();
        drive.seed = seed;
        // What the generator writes is TOML, but for its own mistakes.
        let case = match scene.parse() {
            Ok(scene) => Case { scene, drive },
            Err(error) => {
                refused = error.to_string();
                continue;
            }
        };
        match case.scene() {
            Err(problems) if case.drive.expect == Expect::Run => refused = problems.to_string(),
            _ => return Ok(case),
        }
    }
    Err(format!(
        "no legal scene was found in {ATTEMPTS} drafts; the last: {refused}"
    ))
}

/// The kind of scene that a seed gives in a campaign: all kinds in turn, by weight.
#[must_use]
pub fn kind_of(seed: u64) -> &'static Kind {
    let total: usize = KINDS.iter().map(|kind| kind.weight).sum();
    // A step that shares no factor with the total goes through all before it repeats.
    let mut place = (seed as usize).wrapping_mul(79) % total;
    for kind in &KINDS {
        if place < kind.weight {
            return kind;
        }
        place -= kind.weight;
    }
    &KINDS[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::Component;

    #[test]
    fn every_kind_makes_small_legal_scenes_again_and_again_the_same() {
        for kind in &KINDS {
            for seed in [1, 2, 3] {
                let case = of_kind(kind.name, seed)
                    .unwrap_or_else(|why| panic!("{} of seed {seed}: {why}", kind.name));
                assert_eq!(of_kind(kind.name, seed), Ok(case.clone()));
                if case.drive.expect == Expect::Refusal {
                    continue;
                }
                let component = Component::new(&case.scene().unwrap());
                let component = component.unwrap_or_else(|e| panic!("{} {seed}: {e}", kind.name));
                let most = if kind.name == "threads" { 3000 } else { 500 };
                let count = component.statistics().particles;
                assert!(count <= most, "{} {seed}: {count} particles", kind.name);
            }
        }
    }

    #[test]
    fn a_campaign_goes_through_all_kinds() {
        let total: usize = KINDS.iter().map(|kind| kind.weight).sum();
        assert!(!total.is_multiple_of(79), "{total}");
        for kind in &KINDS {
            let found = (0..total as u64).filter(|seed| kind_of(*seed).name == kind.name);
            assert_eq!(found.count(), kind.weight, "{}", kind.name);
        }
    }
}
