//! Scenes in the plane whose walls move.

use super::super::dice::{Dice, short};
use super::Draft;
use super::parts::{Scale, body, drive, force, head, material, numerics, schedule, slip, wall};
use super::plane::{PARTICLES, STEPS};

/// A third of the walls that move are steered: keys that go to the wall, and what its input is told until `time` [s]. `full` is its speed; `way`, of
/// rigid walls, the key of its end stop and the name of its position, by which half of them are steered.
fn steering(
    dice: &mut Dice,
    wall: &str,
    full: f64,
    time: f64,
    way: Option<(&str, &str)>,
) -> (String, String) {
    if !dice.chance(0.33) {
        return Default::default();
    }
    if let Some((stop, place)) = way.filter(|_| dice.chance(0.5)) {
        return positioning(dice, wall, full.abs() * time, time, (stop, place));
    }
    let mut keys = "input = \"speed\"\n".to_owned();
    if dice.chance(0.5) {
        keys += &format!("ramp = {:?}\n", short(dice.log(0.01, 1.0) * time));
    }
    if dice.chance(0.5) {
        keys += &format!("start = {:?}\n", dice.from(-1.0, 1.0));
    }
    let count = dice.whole(1, 6);
    let points: Vec<[f64; 2]> = (0..count)
        .map(|k| {
            let at = short(time * (k as f64 + 0.9 * dice.unit()) / count as f64);
            let share = dice.pick(&[0.0, 1.0, -1.0, 0.5, 0.03]);
            [at, share * full.abs()]
        })
        .collect();
    let kind = dice.pick(&["hold", "linear"]);
    (keys, schedule(&format!("wall.{wall}.speed"), &points, kind))
}

/// A wall that is told where to be, between its end stops.
fn positioning(
    dice: &mut Dice,
    wall: &str,
    farthest: f64,
    time: f64,
    (stop, place): (&str, &str),
) -> (String, String) {
    let forth = short(dice.from(0.1, 1.0) * farthest);
    let mut keys = format!("input = \"position\"\n{stop} = {forth:?}\n");
    let mut back = 0.0;
    if dice.chance(0.5) {
        back = short(dice.from(0.05, 0.5) * farthest);
        keys += &format!("{stop}_back = {back:?}\n");
    }
    let count = dice.whole(1, 6);
    let points: Vec<[f64; 2]> = (0..count)
        .map(|k| {
            let at = short(time * (k as f64 + 0.9 * dice.unit()) / count as f64);
            [at, dice.pick(&[0.0, forth, -back, short(0.3 * forth)])]
        })
        .collect();
    let kind = dice.pick(&["hold", "linear"]);
    (
        keys,
        schedule(&format!("wall.{wall}.{place}"), &points, kind),
    )
}

/// A drum that turns.
pub(super) fn drum(dice: &mut Dice) -> Draft {
    let radius = dice.log(0.02, 0.5);
    let rate = dice.from(-15.0, 15.0);
    let section = 0.6 * std::f64::consts::PI * radius * radius;
    let mut scale = Scale::of(dice, section, PARTICLES, radius);
    scale.speed = rate.abs() * radius;
    let level = short(radius * dice.from(-0.6, 0.3));
    turning(dice, &scale, radius, rate, &format!("level = {level:?}"))
}

/// A round wall that turns about its centre with a fill; `more` are keys of the fill.
pub(super) fn turning(dice: &mut Dice, scale: &Scale, radius: f64, rate: f64, more: &str) -> Draft {
    let margin = short(radius + 6.0 * scale.spacing);
    let mut scene = head("2", &[-margin, -margin], &[margin, margin], "");
    scene += &numerics(dice, scale);
    scene += &material(dice, "sand");
    let drive = drive(dice, scale.internal_step(), STEPS);
    let time = drive.most_steps as f64 * scale.internal_step();
    let (steered, told) = steering(dice, "drum", rate, time, Some(("swing", "angle")));
    let inner = short(radius * 0.99 - 0.1 * scale.spacing);
    scene += &format!(
        "[bodies.fill]\nmaterial = \"sand\"\ncircle = {{ centre = [0.0, 0.0], radius = {inner:?} }}\n{more}\n"
    );
    scene += &format!(
        "[walls.drum]\ncircle = {{ centre = [0.0, 0.0], radius = {radius:?} }}\nmotion = \"rigid\"\nangular_velocity = \
         {rate:?}\ncentre = [0.0, 0.0]\n{steered}{}{}{told}",
        slip(dice),
        force("drum", "wall")
    );
    Draft { scene, drive }
}

/// A floor and the rest of a closed box as two walls.
fn box_in_two(dice: &mut Dice, width: f64, height: f64, scale: &Scale, floor: &str) -> String {
    let margin = short(6.0 * scale.spacing);
    let mut scene = head(
        "2",
        &[-margin, -margin],
        &[short(width + margin), short(height + margin)],
        "",
    );
    scene += &numerics(dice, scale);
    scene += &material(dice, "sand");
    let slips = slip(dice);
    scene += &wall(
        "floor",
        &[[0.0, 0.0], [width, 0.0]],
        false,
        &format!("{slips}{floor}"),
    );
    let rest = [[width, 0.0], [width, height], [0.0, height], [0.0, 0.0]];
    let slips = slip(dice);
    scene += &wall("shell", &rest, false, &slips);
    scene
}

/// A heap on a belt.
pub(super) fn belt(dice: &mut Dice) -> Draft {
    let width = dice.log(0.05, 0.5);
    let height = short(width * dice.from(0.2, 0.6));
    let mut scale = Scale::of(dice, 0.6 * width * height, PARTICLES, height);
    let speed = dice.from(-3.0, 3.0);
    scale.speed = speed.abs();
    let top = short(2.5 * height + 6.0 * scale.spacing);
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    let time = drive.most_steps as f64 * scale.internal_step();
    let (steered, told) = steering(dice, "floor", speed, time, None);
    let moves = format!("velocity = [{speed:?}, 0.0]\n{steered}");
    let mut scene = box_in_two(dice, width, top, &scale, &moves) + &told;
    let left = short(width * dice.from(0.0, 0.4));
    let right = short(left + 0.6 * width);
    scene += &body("heap", "sand", &[left, 0.0], &[right, height], "");
    drive.inside = vec![[0.0, 0.0], [width, 0.0], [width, top], [0.0, top]];
    Draft { scene, drive }
}

/// A wall on the right that moves as a whole.
pub(super) fn piston(dice: &mut Dice) -> Draft {
    let width = dice.log(0.05, 0.5);
    let height = short(width * dice.from(0.2, 0.8));
    let mut scale = Scale::of(dice, width * height, PARTICLES, height);
    let slow = (9.81 * height).sqrt();
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    let time = drive.most_steps as f64 * scale.internal_step();
    // Into the heap by a third of its width at most: there is room above.
    let speed = short((0.3 * width / time).min(0.5 * slow) * dice.from(-1.0, 2.0));
    let speed = if speed == 0.0 { -0.01 } else { speed };
    scale.speed = speed.abs();
    let top = short(3.0 * height + 8.0 * scale.spacing);
    let far = short(width + speed.abs() * (time + 2.0) + 8.0 * scale.spacing);
    let margin = short(8.0 * scale.spacing);
    let mut scene = head(
        "2",
        &[-margin, -margin],
        &[short(far + margin), short(top + margin)],
        "",
    );
    scene += &numerics(dice, &scale);
    scene += &material(dice, "sand");
    scene += &body("heap", "sand", &[0.0, 0.0], &[width, height], "");
    // The piston is the right wall of a box whose floor and roof go on behind it.
    let frame = [[far, top], [0.0, top], [0.0, 0.0], [far, 0.0]];
    scene += &wall("frame", &frame, false, &slip(dice));
    let (steered, told) = steering(dice, "piston", speed, time, Some(("stroke", "position")));
    let face = [[width, 0.0], [width, top]];
    let moves = format!(
        "motion = \"rigid\"\nvelocity = [{speed:?}, 0.0]\n{}{steered}",
        slip(dice)
    );
    scene += &wall("piston", &face, false, &moves);
    scene += &told;
    drive.inside = vec![[0.0, 0.0], [far, 0.0], [far, top], [0.0, top]];
    Draft { scene, drive }
}
