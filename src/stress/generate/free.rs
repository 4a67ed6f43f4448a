//! Bodies without walls.

use super::super::case::Twin;
use super::super::dice::{Dice, short};
use super::Draft;
use super::parts::{G, Scale, body, drive, head, material, numerics, plain_drive, plain_numerics};
use super::plane::{PARTICLES, STEPS};

/// Two bodies that fly at each other, with or without gravity.
pub(super) fn free(dice: &mut Dice) -> Draft {
    let size = dice.log(0.02, 0.3);
    let mut scale = Scale::of(dice, 2.0 * size * size, PARTICLES, size);
    let speed = dice.log(0.05, 5.0);
    scale.speed = 2.0 * speed;
    let drive = drive(dice, scale.internal_step(), STEPS);
    let time = scale.longest(drive.most_steps);
    let g = if dice.chance(0.5) { 0.0 } else { G };
    // Far enough for whatever is thrown out of the crash.
    let reach = short(4.0 * size + 6.0 * (speed + g * time) * time);
    let mut scene = head(
        "2",
        &[-reach, -reach],
        &[reach, reach],
        &format!("gravity = {g:?}"),
    );
    scene += &numerics(dice, &scale);
    scene += &material(dice, "sand");
    scene += &material(dice, "rock");
    let gap = short(scale.spacing * dice.from(0.0, 3.0));
    let offset = short(size * dice.from(-0.6, 0.6));
    scene += &body(
        "left",
        "sand",
        &[-short(size + gap), 0.0],
        &[-gap, size],
        &format!("velocity = [{speed:?}, 0.0]"),
    );
    scene += &body(
        "right",
        "rock",
        &[gap + 1e-9, offset],
        &[short(gap + size), short(offset + size)],
        &format!("velocity = [{:?}, 0.0]", -speed),
    );
    Draft { scene, drive }
}

/// Layers that slide past each other in a periodic box, and the same from a frame that moves.
pub(super) fn frame(dice: &mut Dice) -> Draft {
    let dp = dice.log(1e-3, 0.02);
    let (length, height) = (
        short(dp * dice.whole(8, 16) as f64),
        short(dp * dice.whole(3, 6) as f64),
    );
    let speed = dice.from(0.1, 1.0);
    let scale = Scale {
        spacing: dp,
        height,
        speed: 2.0 * speed,
    };
    let mut drive = plain_drive(dice, vec![short(10.0 * scale.internal_step())], 20, 5000);
    let time = drive.steps[0] * drive.count as f64;
    let reach = short(3.0 * height + 4.0 * speed * time);
    let mut scene = head(
        "2",
        &[0.0, -reach],
        &[length, reach],
        "periodic = [\"x\"]\ngravity = 0.0",
    );
    scene += &plain_numerics(dice, &scale, "solver_tolerance = 1e-12\njitter = 0.1");
    scene += &material(dice, "sand");
    let boost = dice.from(-100.0, 100.0);
    let middle = short(0.5 * height);
    for (name, low, high, v) in [
        ("lower", 0.0, middle, speed),
        ("upper", middle, height, -speed),
    ] {
        let velocity = format!("velocity = [{v:?}, 0.0]");
        scene += &body(name, "sand", &[0.0, low], &[length, high], &velocity);
    }
    let mut changes = toml::Table::new();
    for (name, v) in [("lower", speed), ("upper", -speed)] {
        let velocity = vec![toml::Value::Float(v + boost), toml::Value::Float(0.0)];
        changes.insert(
            format!("bodies.{name}.velocity"),
            toml::Value::Array(velocity),
        );
    }
    drive.twin = Some(Twin {
        changes,
        steps: Vec::new(),
        boost: [boost, 0.0],
        within: 1e-6 * dp,
        speed_within: 1e-7,
    });
    Draft { scene, drive }
}

/// A block in free fall.
pub(super) fn fall(dice: &mut Dice) -> Draft {
    let size = dice.log(0.02, 0.3);
    let mut scale = Scale::of(dice, size * size, PARTICLES, size);
    let up = dice.from(0.0, 2.0);
    scale.speed = up;
    let drive_of = drive(dice, scale.internal_step(), STEPS);
    let time = scale.longest(drive_of.most_steps);
    let reach = short(2.0 * size + 2.0 * (up + G * time) * time);
    let mut scene = head("2", &[-reach, -reach], &[reach, reach], "");
    scene += &plain_numerics(dice, &scale, "");
    scene += &material(dice, "sand");
    scene += &body(
        "block",
        "sand",
        &[0.0, 0.0],
        &[size, size],
        &format!("velocity = [0.0, {up:?}]"),
    );
    let mut drive = drive_of;
    drive.falls = true;
    Draft { scene, drive }
}
