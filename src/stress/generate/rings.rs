//! Axisymmetric scenes.

use super::super::dice::{Dice, short};
use super::Draft;
use super::devices::outflow;
use super::parts::{Scale, body, drive, force, head, history, material, numerics, slip, wall};
use super::plane::{PARTICLES, STEPS};

/// A round column, or a ring, in a round box.
pub(super) fn column(dice: &mut Dice) -> Draft {
    let radius = dice.log(0.02, 0.5);
    let height = short(radius * dice.log(0.1, 10.0));
    let scale = Scale::of(dice, radius * height, PARTICLES, height);
    let inner = if dice.chance(0.25) {
        short(radius * dice.from(0.1, 0.8))
    } else {
        0.0
    };
    let outer = short(inner + radius);
    let (wide, high) = (
        short(outer + radius * dice.from(0.3, 2.0) + 4.0 * scale.spacing),
        short(height + 8.0 * scale.spacing),
    );
    let margin = short(6.0 * scale.spacing);
    let mut scene = head(
        "\"axisymmetric\"",
        &[0.0, -margin],
        &[short(wide + margin), short(high + margin)],
        "",
    );
    scene += &numerics(dice, &scale);
    scene += &material(dice, "sand");
    scene += &body("column", "sand", &[inner, 0.0], &[outer, height], "");
    let shell = [[0.0, 0.0], [wide, 0.0], [wide, high], [0.0, high]];
    scene += &wall("tub", &shell, false, &slip(dice));
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = shell.to_vec();
    Draft { scene, drive }
}

/// A round silo whose gate slides outwards.
pub(super) fn silo(dice: &mut Dice) -> Draft {
    let radius = dice.log(0.03, 0.3);
    let height = short(radius * dice.from(0.5, 3.0));
    let scale = Scale::of(dice, radius * height, (60.0, PARTICLES.1), 1.4 * height);
    let dp = scale.spacing;
    let opening = short((radius * dice.from(0.2, 0.8)).max(2.5 * dp));
    let top = short(height + 6.0 * dp);
    let fall = short(14.0 * dp + 0.3 * height);
    let wide = short(2.0 * radius + 12.0 * dp);
    let mut scene = head(
        "\"axisymmetric\"",
        &[0.0, -fall],
        &[wide, short(top + 6.0 * dp)],
        "",
    );
    scene += &numerics(dice, &scale);
    scene += &material(dice, "beads");
    scene += &body("fill", "beads", &[0.0, 0.0], &[radius, height], "");
    let shell = [[opening, 0.0], [radius, 0.0], [radius, top], [0.0, top]];
    scene += &wall("shell", &shell, false, &slip(dice));
    scene += &format!(
        "[gates.main]\nfrom = [0.0, 0.0]\nto = {:?}\nmax_speed = {:?}\n{}{}",
        [opening, 0.0],
        dice.log(0.05, 20.0),
        slip(dice),
        force("main", "gate")
    );
    scene += &outflow("drain", &[0.0, -fall], &[wide, -short(fall - 7.0 * dp)]);
    let drive = drive(dice, scale.internal_step(), STEPS);
    let time = drive.most_steps as f64 * scale.internal_step();
    scene += &history(dice, "gate.main.opening", 1.0, time);
    Draft { scene, drive }
}
