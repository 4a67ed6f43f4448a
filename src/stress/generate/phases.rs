//! Fluids, saturated grains, and both in one scene.

use super::super::dice::{Dice, short};
use super::Draft;
use super::devices::Silo;
use super::parts::{Scale, Tub, body, drive, force, head, history, numerics, slip, wall};
use super::plane::PARTICLES;

/// Internal steps: solves of thick fluids take many iterations.
const STEPS: (f64, f64) = (150.0, 1500.0);

/// Numerics with a sound speed that is known, and shifting on or off.
fn fluid_numerics(dice: &mut Dice, scale: &Scale) -> String {
    let text = numerics(dice, scale);
    if dice.chance(0.2) {
        format!("{text}shifting = {:?}\n", dice.from(0.0, 1.0))
    } else {
        text
    }
}

/// A key for a material's own sound speed: down to 7 times the speed that is expected.
fn own_sound_speed(dice: &mut Dice, scale: &Scale) -> String {
    if dice.chance(0.3) {
        let speed = short(scale.expected() * dice.from(7.0, 9.9));
        format!("sound_speed = {speed:?}\n")
    } else {
        String::new()
    }
}

/// A fluid of any kind: water, clay, Newton's up to 1e8 Pa s, Herschel and Bulkley's; its density lies between two.
fn fluid(dice: &mut Dice, name: &str, scale: &Scale, (light, dense): (f64, f64)) -> String {
    let mut text = format!("[materials.{name}]\nlaw = \"fluid\"\n");
    let density = dice.log(light, dense);
    text += &match dice.whole(0, 5) {
        0 | 1 => "preset = \"water\"\n".to_owned(),
        2 => "preset = \"clay\"\n".to_owned(),
        3 => format!(
            "density = {density:?}\nconsistency = {:?}\n",
            dice.log(1e-6, 1e8)
        ),
        _ => format!(
            "density = {density:?}\nconsistency = {:?}\nflow_index = {:?}\nyield_stress = {:?}\n",
            dice.log(1e-4, 1e4),
            dice.from(0.1, 2.0),
            dice.log(1e-2, 1e4)
        ),
    };
    if dice.chance(0.3) {
        text += &format!("artificial_viscosity = {:?}\n", dice.from(0.0, 0.5));
    }
    text + &own_sound_speed(dice, scale)
}

const WATER: &str = "[materials.water]\nlaw = \"fluid\"\npreset = \"water\"\n";

/// Grains whose pores are full of `water`.
fn soaked(dice: &mut Dice, name: &str, scale: &Scale) -> String {
    let mut text = format!("[materials.{name}]\n");
    text += &if dice.chance(0.6) {
        format!(
            "law = \"constant_friction\"\nfriction_angle = {:?}\ndensity = {:?}\nconsistency = {:?}\n",
            short(dice.log(0.02, 1.5).atan()),
            dice.from(1300.0, 2600.0),
            dice.pick(&[0.0, 0.0, 3.97, 100.0])
        )
    } else {
        let preset = dice.pick(&["glass_beads", "sand_08", "sand_04"]);
        format!("law = \"mu_i\"\npreset = {preset:?}\n")
    };
    if dice.chance(0.2) {
        text += &format!("cohesion = {:?}\n", dice.log(1.0, 1e4));
    }
    text + "pore_fluid = \"water\"\n" + &own_sound_speed(dice, scale)
}

/// A block of fluid in a closed box: a dam break, or one that fills it to a level.
pub(super) fn tank(dice: &mut Dice) -> Draft {
    let width = dice.log(0.02, 2.0);
    let height = short(width * dice.log(0.15, 4.0));
    let scale = Scale::of(dice, width * height, PARTICLES, height);
    let room = dice.pick(&[1.0, 1.5, 3.0]);
    let tub = Tub {
        width: short(width * room),
        height: short(height + 10.0 * scale.spacing),
    };
    let mut scene = tub.head(scale.spacing, "");
    scene += &fluid_numerics(dice, &scale);
    scene += &fluid(dice, "fluid", &scale, (100.0, 13_600.0));
    scene += &body("block", "fluid", &[0.0, 0.0], &[width, height], "");
    scene += &wall("tub", &tub.outline(), true, &slip(dice));
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = tub.outline();
    Draft { scene, drive }
}

/// Two fluids, the heavy one below or on top, up to ten times as dense.
pub(super) fn fluids(dice: &mut Dice) -> Draft {
    let width = dice.log(0.02, 1.0);
    let height = short(width * dice.from(0.3, 1.5));
    let scale = Scale::of(dice, width * height, PARTICLES, height);
    let tub = Tub {
        width: short(width * dice.pick(&[1.0, 1.0, 2.0])),
        height: short(height + 8.0 * scale.spacing),
    };
    let mut scene = tub.head(scale.spacing, "");
    scene += &fluid_numerics(dice, &scale);
    scene += &fluid(dice, "lower", &scale, (400.0, 4000.0));
    scene += &fluid(dice, "upper", &scale, (400.0, 4000.0));
    let rows = (height / scale.spacing * dice.from(0.3, 0.7))
        .round()
        .max(1.0);
    let middle = short(rows * scale.spacing);
    scene += &body("first", "lower", &[0.0, 0.0], &[width, middle], "");
    scene += &body("second", "upper", &[0.0, middle], &[width, height], "");
    scene += &wall("tub", &tub.outline(), true, &slip(dice));
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = tub.outline();
    Draft { scene, drive }
}

/// Water over a saturated bed, level, or a dam break of both over a wet or dry floor.
pub(super) fn bed(dice: &mut Dice) -> Draft {
    let width = dice.log(0.03, 2.0);
    let height = short(width * dice.from(0.2, 1.2));
    let scale = Scale::of(dice, width * height, PARTICLES, height);
    let tub = Tub {
        width: short(width * dice.pick(&[1.0, 2.0, 3.0])),
        height: short(height + 10.0 * scale.spacing),
    };
    let rows = (height / scale.spacing * dice.from(0.15, 0.85))
        .round()
        .max(2.0);
    let middle = short(rows * scale.spacing);
    let mut scene = tub.head(scale.spacing, "");
    scene += &fluid_numerics(dice, &scale);
    scene += WATER;
    scene += &soaked(dice, "silt", &scale);
    scene += &body("bed", "silt", &[0.0, 0.0], &[width, middle], "");
    if dice.chance(0.85) {
        let top = short(height.max(middle + 2.0 * scale.spacing));
        scene += &body("water", "water", &[0.0, middle], &[width, top], "");
    }
    scene += &wall("tub", &tub.outline(), true, &slip(dice));
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = tub.outline();
    Draft { scene, drive }
}

/// A silo of fluid, or of silt under water, whose gate has a random history.
pub(super) fn sump(dice: &mut Dice) -> Draft {
    let width = dice.log(0.03, 0.5);
    let height = short(width * dice.from(0.4, 2.0));
    let scale = Scale::of(dice, width * height, (60.0, PARTICLES.1), 1.4 * height);
    let silo = Silo {
        width,
        height,
        opening: short((width * dice.from(0.1, 0.8)).max(2.5 * scale.spacing)),
        spacing: scale.spacing,
    };
    let (walls, gate) = (slip(dice), slip(dice));
    let speed = dice.log(0.02, 50.0);
    let start = dice.pick(&[0.0, 0.0, 1.0, 0.37]);
    let mut scene = silo.text([&walls, &gate], speed, start);
    scene += &fluid_numerics(dice, &scale);
    if dice.chance(0.5) {
        scene += &fluid(dice, "mud", &scale, (300.0, 5000.0));
        scene += &body("fill", "mud", &[0.0, 0.0], &[width, height], "");
    } else {
        let rows = (0.5 * height / scale.spacing).round().max(1.0);
        let middle = short(rows * scale.spacing);
        scene += WATER;
        scene += &soaked(dice, "silt", &scale);
        scene += &body("bed", "silt", &[0.0, 0.0], &[width, middle], "");
        scene += &body("water", "water", &[0.0, middle], &[width, height], "");
    }
    let drive = drive(dice, scale.internal_step(), STEPS);
    let time = drive.most_steps as f64 * scale.internal_step();
    scene += &history(dice, "gate.main.opening", 1.0, time);
    Draft { scene, drive }
}

/// A film of fluid on a slope, periodic.
pub(super) fn film(dice: &mut Dice) -> Draft {
    let spacing = dice.log(2e-4, 0.05);
    let rows = dice.whole(3, 10) as f64;
    let (length, height) = (spacing * dice.whole(10, 36) as f64, short(rows * spacing));
    let scale = Scale {
        spacing,
        height,
        speed: 3.0 * (super::parts::G * height).sqrt(),
    };
    let mut scene = head(
        "2",
        &[0.0, -short(6.0 * spacing)],
        &[length, short(height + 60.0 * spacing)],
        &format!("periodic = [\"x\"]\nslope = {:?}", dice.from(0.0, 0.6)),
    );
    scene += &fluid_numerics(dice, &scale);
    scene += &fluid(dice, "mud", &scale, (300.0, 5000.0));
    scene += &body("film", "mud", &[0.0, 0.0], &[length, height], "");
    scene += &wall("bed", &[[0.0, 0.0], [length, 0.0]], false, &slip(dice));
    let drive = drive(dice, scale.internal_step(), (150.0, 900.0));
    Draft { scene, drive }
}

/// A round tank of fluid, or of silt under water.
pub(super) fn round(dice: &mut Dice) -> Draft {
    let radius = dice.log(0.02, 0.5);
    let height = short(radius * dice.log(0.2, 3.0));
    let scale = Scale::of(dice, radius * height, PARTICLES, height);
    let wide = short(radius * dice.pick(&[1.0, 1.5, 2.5]));
    let high = short(height + 8.0 * scale.spacing);
    let margin = short(6.0 * scale.spacing);
    let mut scene = head(
        "\"axisymmetric\"",
        &[0.0, -margin],
        &[short(wide + margin), short(high + margin)],
        "",
    );
    scene += &fluid_numerics(dice, &scale);
    if dice.chance(0.6) {
        scene += &fluid(dice, "mud", &scale, (300.0, 5000.0));
        scene += &body("fill", "mud", &[0.0, 0.0], &[radius, height], "");
    } else {
        let rows = (0.5 * height / scale.spacing).round().max(1.0);
        let middle = short(rows * scale.spacing);
        scene += WATER;
        scene += &soaked(dice, "silt", &scale);
        scene += &body("bed", "silt", &[0.0, 0.0], &[radius, middle], "");
        scene += &body("water", "water", &[0.0, middle], &[radius, height], "");
    }
    let shell = [[0.0, 0.0], [wide, 0.0], [wide, high], [0.0, high]];
    scene += &wall("tub", &shell, false, &slip(dice));
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = shell.to_vec();
    Draft { scene, drive }
}

/// A block of fluid in a box in space.
pub(super) fn pool(dice: &mut Dice) -> Draft {
    let dp = dice.log(2e-3, 0.03);
    let [x, y, z] = [0, 1, 2].map(|_| short(dice.whole(3, 7) as f64 * dp));
    let wide = [x, y].map(|w| short(w * dice.from(1.0, 2.0)));
    let high = short(z + 5.0 * dp);
    let scale = Scale {
        spacing: dp,
        height: z,
        speed: 0.0,
    };
    let margin = short(6.0 * dp);
    let mut scene = head(
        "3",
        &[-margin; 3],
        &[wide[0] + margin, wide[1] + margin, high + margin].map(short),
        "",
    );
    scene += &fluid_numerics(dice, &scale);
    scene += &fluid(dice, "mud", &scale, (300.0, 5000.0));
    scene += &body("block", "mud", &[0.0; 3], &[x, y, z], "");
    for (name, k, at, towards) in [
        ("west", 0, 0.0, 1.0),
        ("east", 0, wide[0], -1.0),
        ("south", 1, 0.0, 1.0),
        ("north", 1, wide[1], -1.0),
        ("floor", 2, 0.0, 1.0),
        ("roof", 2, high, -1.0),
    ] {
        let (mut point, mut normal) = ([0.0; 3], [0.0; 3]);
        (point[k], normal[k]) = (at, towards);
        scene += &format!(
            "[walls.{name}]\nplane = {{ point = {point:?}, normal = {normal:?} }}\n{}{}",
            slip(dice),
            force(name, "wall")
        );
    }
    let drive = drive(dice, scale.internal_step(), (100.0, 500.0));
    Draft { scene, drive }
}
