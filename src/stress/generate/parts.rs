//! What scenes are put together from: materials, numerics, drives, histories of inputs, closed boxes.

use super::super::case::Drive;
use super::super::dice::{Dice, short};

/// Standard gravity [m/s^2].
pub(super) const G: f64 = 9.81;

/// Sizes of a scene that its parts need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scale {
    /// Spacing [m].
    pub(super) spacing: f64,
    /// Height of the material, or how far it can fall [m].
    pub(super) height: f64,
    /// Speed that it may reach beside a fall from that height [m/s].
    pub(super) speed: f64,
}

impl Scale {
    /// Of a body of a section [m^2] that is filled with between `least` and `most` particles.
    pub(super) fn of(
        dice: &mut Dice,
        section: f64,
        (least, most): (f64, f64),
        height: f64,
    ) -> Self {
        let count = dice.log(least, most);
        Self {
            spacing: short((section / count).sqrt()),
            height,
            speed: 0.0,
        }
    }

    /// Expected speed: a fall from the height, and what is added [m/s].
    pub(super) fn expected(&self) -> f64 {
        short((2.0 * G * self.height).sqrt() + self.speed)
    }

    /// The acoustic bound at courant 0.5 and one acoustic step [s].
    pub(super) fn internal_step(&self) -> f64 {
        0.5 * 1.6 * self.spacing / (10.0 * self.expected())
    }

    /// Longest time that so many internal steps cover: two acoustic steps each, and of courant 0.7 [s].
    pub(super) fn longest(&self, steps: u64) -> f64 {
        2.8 * steps as f64 * self.internal_step()
    }
}

/// A table in TOML from keys and values that are TOML already.
fn table(head: &str, keys: &[(&str, String)]) -> String {
    let mut text = format!("[{head}]\n");
    for (key, value) in keys {
        text.push_str(&format!("{key} = {value}\n"));
    }
    text
}

fn text(value: &str) -> String {
    format!("{value:?}")
}

fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A material of any law, over its whole range.
pub(super) fn material(dice: &mut Dice, name: &str) -> String {
    let mut keys: Vec<(&str, String)> = Vec::new();
    let law = dice.pick(&["mu_i", "mu_i", "mu_i", "constant_friction", "barker_gray"]);
    keys.push(("law", text(law)));
    let density = dice.log(200.0, 12_000.0);
    if law == "constant_friction" {
        keys.push(("friction_angle", number(short(dice.log(0.01, 3.0).atan()))));
        keys.push(("density", number(density)));
        keys.push(("match", text(dice.pick(&["plane_strain", "simple_shear"]))));
    } else if dice.chance(0.4) {
        keys.push((
            "preset",
            text(dice.pick(&["glass_beads", "sand_08", "sand_04"])),
        ));
    } else {
        let slow = dice.log(0.01, 2.5);
        let fast = dice.from(slow, 3.0);
        let loosest = dice.from(0.6, 0.97);
        let densest = dice.from(0.4, 0.9);
        keys.extend([
            ("static_friction_angle", number(short(slow.atan()))),
            (
                "dynamic_friction_angle",
                number(short(fast.atan()).max(short(slow.atan()))),
            ),
            ("inertial_number_scale", number(dice.log(0.01, 10.0))),
            ("grain_diameter", number(dice.log(1e-6, 0.05))),
            ("grain_density", number(density)),
            ("phi_max", number(densest)),
            ("phi_min", number(short(densest * loosest))),
        ]);
    }
    if dice.chance(0.25) {
        keys.push(("cohesion", number(dice.log(1.0, 1e5))));
    }
    if dice.chance(0.2) {
        keys.push(("bulk_friction", number(dice.from(0.0, 10.0))));
    }
    if law == "mu_i" && dice.chance(0.15) {
        keys.push(("high_inertia_friction", number(dice.from(0.0, 1.0))));
    }
    table(&format!("materials.{name}"), &keys)
}

/// Grains as most scenes have them.
pub(super) fn plain_material(dice: &mut Dice, name: &str) -> String {
    let preset = dice.pick(&["glass_beads", "sand_08", "sand_04"]);
    table(
        &format!("materials.{name}"),
        &[("law", text("mu_i")), ("preset", text(preset))],
    )
}

/// Numerics: the defaults but for some keys, over their ranges.
pub(super) fn numerics(dice: &mut Dice, scale: &Scale) -> String {
    let mut keys = vec![
        ("spacing", number(scale.spacing)),
        ("expected_speed", number(scale.expected())),
        ("seed", dice.whole(1, 9999).to_string()),
    ];
    if dice.chance(0.2) {
        keys.push(("smoothing_ratio", number(dice.from(1.2, 2.5))));
    }
    if dice.chance(0.2) {
        let speed = short(10.0 * scale.expected() * dice.log(0.8, 10.0));
        keys.push(("sound_speed", number(speed)));
    }
    if dice.chance(0.2) {
        keys.push(("courant", number(dice.from(0.05, COURANT))));
    }
    if dice.chance(0.2) {
        keys.push(("yield", text("capped")));
    } else if dice.chance(0.2) {
        keys.push(("yield_iterations", dice.whole(1, 8).to_string()));
    }
    if dice.chance(0.15) {
        keys.push(("cap_time", number(dice.log(1e-4, 1e4))));
    }
    if dice.chance(0.15) {
        keys.push(("density_diffusion", number(dice.from(0.0, 1.0))));
    }
    if dice.chance(0.1) {
        keys.push(("diffusion_gate_time", number(dice.log(1e-3, 10.0))));
    }
    if dice.chance(0.1) {
        keys.push(("strain_relaxation_time", number(dice.log(1e-3, 10.0))));
    }
    if dice.chance(0.15) {
        keys.push(("pair_viscosity_share", number(dice.from(0.0, 1.0))));
    }
    if dice.chance(0.1) {
        keys.push(("artificial_viscosity", number(dice.log(1e-3, 1.0))));
    }
    if dice.chance(0.15) {
        keys.push(("solver_tolerance", number(dice.log(1e-12, 0.1))));
        keys.push(("solver_max_iterations", "20000".to_owned()));
    }
    if dice.chance(0.3) {
        keys.push(("sleep", "false".to_owned()));
    }
    if dice.chance(0.2) {
        keys.push(("jitter", number(dice.from(0.0, 0.4))));
    }
    // Dice of their own, so that seeds keep their scenes.
    if dice.clone().chance(0.25) {
        keys.push(("friction_into_walls", "true".to_owned()));
    }
    table("numerics", &keys)
}

/// Largest Courant number of random scenes; the map of limits says where it breaks.
const COURANT: f64 = 0.7;

/// Defaults, but for resolution, seed and one line more.
pub(super) fn plain_numerics(dice: &mut Dice, scale: &Scale, more: &str) -> String {
    let keys = [
        ("spacing", number(scale.spacing)),
        ("expected_speed", number(scale.expected())),
        ("seed", dice.whole(1, 9999).to_string()),
    ];
    format!("{}{more}\n", table("numerics", &keys))
}

/// The first lines of a scene in `dimension` (TOML), with its extent (TOML arrays) and other keys of the domain.
pub(super) fn head(dimension: &str, lower: &[f64], upper: &[f64], more: &str) -> String {
    format!(
        "name = \"stress\"\ndimension = {dimension}\n[domain]\nlower = {lower:?}\nupper = {upper:?}\n{more}\n[run]\nstep = 0.01\nuntil = 1.0\n"
    )
}

/// Whether material sticks, slides or rubs, as a wall's or gate's keys.
pub(super) fn slip(dice: &mut Dice) -> String {
    match dice.whole(0, 3) {
        0 => "slip = \"free_slip\"\n".to_owned(),
        1 => "slip = \"no_slip\"\n".to_owned(),
        _ => format!(
            "slip = \"friction\"\nwall_friction = {:?}\n",
            dice.log(0.01, 2.0)
        ),
    }
}

/// A force gauge on a wall or gate.
pub(super) fn force(name: &str, on: &str) -> String {
    format!("[gauges.force_{name}]\nkind = \"force\"\non = \"{on}.{name}\"\n")
}

/// A wall of these points with a force gauge.
pub(super) fn wall(name: &str, points: &[[f64; 2]], closed: bool, more: &str) -> String {
    let closed = if closed { "closed = true\n" } else { "" };
    format!(
        "[walls.{name}]\npolyline = {points:?}\n{closed}{more}{}",
        force(name, "wall")
    )
}

/// A body that fills a box.
pub(super) fn body(name: &str, material: &str, lower: &[f64], upper: &[f64], more: &str) -> String {
    format!(
        "[bodies.{name}]\nmaterial = \"{material}\"\nbox = {{ lower = {lower:?}, upper = {upper:?} }}\n{more}\n"
    )
}

/// A closed box from the origin, and the head of a scene in the plane around it.
pub(super) struct Tub {
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Tub {
    /// Its corners, anticlockwise.
    pub(super) fn outline(&self) -> Vec<[f64; 2]> {
        let (w, h) = (self.width, self.height);
        vec![[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]]
    }

    /// The domain around it.
    pub(super) fn head(&self, spacing: f64, more: &str) -> String {
        let margin = short(6.0 * spacing);
        head(
            "2",
            &[-margin, -margin],
            &[self.width + margin, self.height + margin],
            more,
        )
    }
}

/// How a scene is driven over so many internal steps of about `internal_step`: communication steps of all kinds.
pub(super) fn drive(dice: &mut Dice, internal_step: f64, (least, most): (f64, f64)) -> Drive {
    let most_steps = dice.log(least, most);
    let whole = most_steps * internal_step;
    let (steps, count) = match dice.whole(0, 5) {
        0..=2 => {
            let count = dice.whole(4, 40);
            (vec![short(whole / count as f64)], count)
        }
        3 => {
            let cycle = dice.whole(2, 5);
            let steps: Vec<f64> = (0..cycle).map(|_| dice.log(1e-6, whole / 4.0)).collect();
            let sum: f64 = steps.iter().sum();
            let rounds = (whole / sum).clamp(1.0, 100.0 / cycle as f64);
            (steps, (rounds * cycle as f64) as usize)
        }
        4 => (vec![1.0], 2),
        _ => (vec![1e-6, 1e-6, 1e-5, short(whole / 10.0)], 48),
    };
    plain_drive(dice, steps, count.max(2), most_steps as u64)
}

/// A drive of these communication steps.
pub(super) fn plain_drive(
    dice: &mut Dice,
    steps: Vec<f64>,
    count: usize,
    most_steps: u64,
) -> Drive {
    Drive {
        kind: String::new(),
        seed: 0,
        note: String::new(),
        expect: Default::default(),
        restore_after: dice.whole(0, count - 1),
        steps,
        count,
        most_steps,
        threads: 2,
        rest: false,
        falls: false,
        inside: Vec::new(),
        twin: None,
    }
}

/// A history of an input from 0 to `most` over a time: slam, flutter, ramp, nothing, all, at random.
pub(super) fn history(dice: &mut Dice, input: &str, most: f64, time: f64) -> String {
    let value = |share: f64| short(share * most).min(most);
    let points: Vec<[f64; 2]> = match dice.whole(0, 5) {
        0 => vec![
            [0.0, 0.0],
            [short(0.3 * time), most],
            [short(0.6 * time), 0.0],
        ],
        1 => {
            let count = dice.whole(5, 30);
            let at = |k: usize| {
                [
                    short(time * k as f64 / count as f64),
                    if k.is_multiple_of(2) { most } else { 0.0 },
                ]
            };
            (0..count).map(at).collect()
        }
        2 => vec![[0.0, 0.0], [short(time), most]],
        3 => vec![[0.0, 0.0]],
        4 => vec![[0.0, most]],
        _ => {
            let count = dice.whole(2, 10);
            let mut points = Vec::new();
            for k in 0..count {
                let at = short(time * (k as f64 + 0.9 * dice.unit()) / count as f64);
                points.push([at, value(dice.unit())]);
            }
            points
        }
    };
    schedule(
        input,
        &points,
        if dice.chance(0.6) { "hold" } else { "linear" },
    )
}

/// What an input is told.
pub(super) fn schedule(input: &str, points: &[[f64; 2]], interpolation: &str) -> String {
    format!(
        "[[schedule]]\ninput = \"{input}\"\ninterpolation = \"{interpolation}\"\npoints = {points:?}\n"
    )
}
