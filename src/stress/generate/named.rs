//! The stress scenes that the project has a number for (S1 to S21), as far as the solver has what they need. S3 is kind
//! `drop`, S4 `layer`, S7 `strata`, S12 `fall`, S13 `frame`, S16 `jam`, S17 `illegal`, S18 what every case does in its
//! middle, S19 `threads`. S22 (convergence) takes more than 500 particles: it is a study of `sandgate validate`. S23
//! (gravity flips) and S24 (a floor that vibrates) need a gravity and a wall whose motion changes with time: there is
//! neither.

use super::super::case::Twin;
use super::super::dice::{Dice, short};
use super::devices::{Silo, gate, outflow};
use super::parts::{
    G, Scale, Tub, body, drive, head, plain_drive, plain_material, plain_numerics, schedule, wall,
};
use super::plane::{PARTICLES, STEPS};
use super::{Draft, moving};

/// A heap on a floor in a closed box with friction, of this material and with these further numerics.
fn heap(dice: &mut Dice, size: (f64, f64), material: &str, numerics: &str) -> (Draft, Scale) {
    let (width, height) = size;
    let scale = Scale::of(dice, width * height, PARTICLES, height);
    let tub = Tub {
        width: short(2.5 * width + 8.0 * scale.spacing),
        height: short(height + 6.0 * scale.spacing),
    };
    let mut scene = tub.head(scale.spacing, "");
    scene += &plain_numerics(dice, &scale, numerics);
    scene += material;
    scene += &body("heap", "sand", &[0.0, 0.0], &[width, height], "");
    scene += &wall("tub", &tub.outline(), true, "");
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = tub.outline();
    (Draft { scene, drive }, scale)
}

/// S1: shut in 1 ms on a full chute.
pub(super) fn slam(dice: &mut Dice) -> Draft {
    let dp = dice.log(2e-3, 0.01);
    let (length, depth) = (short(40.0 * dp), short(4.0 * dp));
    let mut scale = Scale {
        spacing: dp,
        height: 0.5 * length,
        speed: 0.0,
    };
    let plate = short(8.0 * dp);
    // All of its way in a millisecond.
    let speed = short(plate / 1e-3);
    scale.speed = 1.0;
    let mut scene = head(
        "2",
        &[-short(6.0 * dp), -short(8.0 * dp)],
        &[short(length + 40.0 * dp), short(30.0 * dp)],
        "slope = \"25 deg\"",
    );
    scene += &plain_numerics(dice, &scale, "");
    scene += &plain_material(dice, "sand");
    scene += &body(
        "flow",
        "sand",
        &[0.0, 0.0],
        &[length, depth],
        "velocity = [0.5, 0.0]",
    );
    // A roof: a plate at 10 m/s throws grains high.
    let (roof, end) = (short(18.0 * dp), short(length + 14.0 * dp));
    let bed = [[end, roof], [0.0, roof], [0.0, 0.0], [length, 0.0]];
    scene += &wall("bed", &bed, false, "");
    let at = short(0.6 * length);
    scene += &gate("sluice", [[at, 0.0], [at, plate]], (speed, 1.0), "");
    scene += &outflow(
        "end",
        &[short(length + dp), -short(8.0 * dp)],
        &[short(length + 40.0 * dp), short(17.0 * dp)],
    );
    let at = short(300.0 * scale.internal_step());
    scene += &schedule("gate.sluice.opening", &[[0.0, 1.0], [at, 0.0]], "hold");
    let drive = drive(dice, scale.internal_step(), (900.0, 1900.0));
    Draft { scene, drive }
}

/// S2: open at once, or over 10 s.
pub(super) fn creep(dice: &mut Dice) -> Draft {
    let width = dice.log(0.05, 0.3);
    let height = short(1.5 * width);
    let scale = Scale::of(dice, width * height, (80.0, PARTICLES.1), 1.4 * height);
    let silo = Silo {
        width,
        height,
        opening: short(0.4 * width + 2.0 * scale.spacing),
        spacing: scale.spacing,
    };
    let at_once = dice.chance(0.5);
    let mut scene = silo.text(["", ""], if at_once { 1e3 } else { 0.5 }, 0.0);
    scene += &plain_numerics(dice, &scale, "");
    scene += &plain_material(dice, "beads");
    scene += &body("fill", "beads", &[0.0, 0.0], &[width, height], "");
    let points = if at_once {
        [[0.0, 0.0], [1e-9, 1.0]]
    } else {
        [[0.0, 0.0], [10.0, 1.0]]
    };
    scene += &schedule("gate.main.opening", &points, "linear");
    let drive = drive(dice, scale.internal_step(), STEPS);
    Draft { scene, drive }
}

/// S5: 20 to 50 times as high as wide, planar or round.
pub(super) fn tall(dice: &mut Dice) -> Draft {
    let round = dice.chance(0.5);
    let dp = dice.log(1e-3, 0.02);
    let rows = dice.whole(2, 3) as f64;
    let width = short(rows * dp);
    let height = short(width * dice.from(20.0, 50.0));
    let scale = Scale {
        spacing: dp,
        height,
        speed: 0.0,
    };
    let (wide, high) = (short(0.6 * height), short(height + 8.0 * dp));
    let margin = short(6.0 * dp);
    let left = if round { 0.0 } else { short(0.3 * height) };
    let mut scene = head(
        if round { "\"axisymmetric\"" } else { "2" },
        &[if round { 0.0 } else { -margin }, -margin],
        &[short(wide + margin), short(high + margin)],
        "",
    );
    scene += &plain_numerics(dice, &scale, "");
    scene += &plain_material(dice, "sand");
    scene += &body(
        "heap",
        "sand",
        &[left, 0.0],
        &[short(left + width), height],
        "",
    );
    let shell = [[0.0, 0.0], [wide, 0.0], [wide, high], [0.0, high]];
    scene += &wall("tub", &shell, !round, "");
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = shell.to_vec();
    Draft { scene, drive }
}

/// S6: a = 0.05.
pub(super) fn sheet(dice: &mut Dice) -> Draft {
    let height = dice.log(0.002, 0.05);
    let material = plain_material(dice, "sand");
    heap(dice, (short(20.0 * height), height), &material, "").0
}

/// S8: mu_s 2.0 and mu_2 2.5, or 0.01.
pub(super) fn friction(dice: &mut Dice) -> Draft {
    let angles: (f64, f64) = dice.pick(&[(2.0, 2.5), (0.01, 0.02)]);
    let material = format!(
        "[materials.sand]\nlaw = \"mu_i\"\npreset = \"sand_08\"\nstatic_friction_angle = {:?}\ndynamic_friction_angle = {:?}\n",
        short(angles.0.atan()),
        short(angles.1.atan())
    );
    let width = dice.log(0.03, 0.3);
    let height = short(width * dice.from(0.5, 2.0));
    heap(dice, (width, height), &material, "").0
}

/// S9: the cap is eta = cap_time mu_s p.
pub(super) fn cap(dice: &mut Dice) -> Draft {
    let width = dice.log(0.03, 0.3);
    let height = short(width * dice.from(0.5, 2.0));
    // Of sand: 1490 kg/m^3, mu_s 0.59.
    let time = short(1e8 / (0.59 * 1490.0 * G * height));
    let form = dice.pick(&["capped", "exact"]);
    let numerics =
        format!("yield = \"{form}\"\ncap_time = {time:?}\nsolver_max_iterations = 20000");
    let material = "[materials.sand]\nlaw = \"mu_i\"\npreset = \"sand_04\"\n";
    heap(dice, (width, height), material, &numerics).0
}

/// S10: d = 1e-6 and 0.05 m.
pub(super) fn grains(dice: &mut Dice) -> Draft {
    let size = dice.pick(&[1e-6, 0.05]);
    let preset = dice.pick(&["glass_beads", "sand_08", "sand_04"]);
    let material = format!(
        "[materials.sand]\nlaw = \"mu_i\"\npreset = \"{preset}\"\ngrain_diameter = {size:?}\n"
    );
    let width = dice.log(0.03, 0.5);
    let height = short(width * dice.from(0.5, 2.0));
    heap(dice, (width, height), &material, "").0
}

/// S11: a low fill, many sqrt(H/g) with sleep off, or an hour with sleep on.
pub(super) fn long_rest(dice: &mut Dice) -> Draft {
    let dp = dice.log(2e-3, 0.02);
    let (width, height) = (short(dp * dice.whole(4, 6) as f64), short(2.0 * dp));
    let scale = Scale {
        spacing: dp,
        height: 0.5 * height,
        speed: 0.0,
    };
    let tub = Tub {
        width,
        height: short(height + 6.0 * dp),
    };
    let sleeps = dice.chance(0.5);
    let mut scene = tub.head(dp, "");
    scene += &plain_numerics(dice, &scale, if sleeps { "" } else { "sleep = false" });
    scene += &plain_material(dice, "sand");
    scene += &body("fill", "sand", &[0.0, 0.0], &[width, height], "");
    scene += &wall("tub", &tub.outline(), true, "");
    let mut drive = if sleeps {
        let step = short(250.0 * scale.internal_step());
        let mut steps = vec![step; 40];
        steps.extend([60.0, 3600.0]);
        plain_drive(dice, steps, 42, 12_000)
    } else {
        let step = short(300.0 * scale.internal_step());
        plain_drive(dice, vec![step], 40, 12_000)
    };
    drive.inside = tub.outline();
    drive.rest = true;
    Draft { scene, drive }
}

/// S15: a block shot into a corner.
pub(super) fn corner(dice: &mut Dice) -> Draft {
    let size = dice.log(0.02, 0.2);
    let mut scale = Scale::of(dice, size * size, (9.0, 200.0), 2.0 * size);
    let speed = dice.from(1.0, 5.0);
    scale.speed = speed;
    let tub = Tub {
        width: short(2.0 * size + 4.0 * scale.spacing),
        height: short(2.0 * size + 4.0 * scale.spacing),
    };
    let mut scene = tub.head(scale.spacing, "");
    scene += &plain_numerics(dice, &scale, "");
    scene += &plain_material(dice, "sand");
    let low = short(0.6 * size);
    let way = short(-speed / 2.0_f64.sqrt());
    scene += &body(
        "block",
        "sand",
        &[low, low],
        &[short(low + size), short(low + size)],
        &format!("velocity = [{way:?}, {way:?}]"),
    );
    scene += &wall("tub", &tub.outline(), true, &super::parts::slip(dice));
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = tub.outline();
    Draft { scene, drive }
}

/// A heap that collapses for `time`, with a twin of it.
fn twins(dice: &mut Dice, numerics: &str) -> (Draft, Scale, f64) {
    let width = dice.from(0.08, 0.12);
    let material = plain_material(dice, "sand");
    let (mut draft, scale) = heap(dice, (width, width), &material, numerics);
    let time = 0.2;
    draft.drive.steps = vec![0.01];
    draft.drive.count = 20;
    draft.drive.restore_after = 7;
    draft.drive.most_steps = 100_000;
    (draft, scale, time)
}

/// S20: other communication steps.
pub(super) fn communication(dice: &mut Dice) -> Draft {
    let (mut draft, scale, time) = twins(dice, "");
    let step = dice.pick(&[1e-4, 1e-3, 0.1]);
    draft.drive.twin = Some(Twin {
        changes: toml::Table::new(),
        steps: vec![step],
        boost: [0.0; 2],
        // Steps of other lengths are another discretisation in time: a quarter of a spacing.
        within: 0.25 * scale.spacing,
        speed_within: 0.25 * scale.spacing / time,
    });
    draft
}

/// S21: sleep off.
pub(super) fn sleeper(dice: &mut Dice) -> Draft {
    let (mut draft, scale, time) = twins(dice, "");
    let mut changes = toml::Table::new();
    changes.insert("numerics.sleep".to_owned(), toml::Value::Boolean(false));
    draft.drive.twin = Some(Twin {
        changes,
        steps: Vec::new(),
        boost: [0.0; 2],
        within: 1e-3 * scale.spacing,
        speed_within: 1e-3 * scale.spacing / time,
    });
    draft
}

/// S14: a full drum turns as one.
pub(super) fn plug(dice: &mut Dice) -> Draft {
    let radius = dice.log(0.03, 0.3);
    let rate = dice.from(1.0, 10.0);
    let section = std::f64::consts::PI * radius * radius;
    let mut scale = Scale::of(dice, section, PARTICLES, radius);
    scale.speed = rate * radius;
    moving::turning(dice, &scale, radius, rate, "")
}
