//! Scenes with gates, inflows and outflows.

use super::super::dice::{Dice, short};
use super::Draft;
use super::parts::{
    Scale, Tub, body, drive, force, head, history, material, numerics, plain_drive, plain_material,
    plain_numerics, schedule, slip, wall,
};
use super::plane::{PARTICLES, STEPS};

/// A gate and the force on it: the ends of its plate, its largest speed and its opening at the start, its slip.
pub(super) fn gate(
    name: &str,
    [from, to]: [[f64; 2]; 2],
    (max_speed, start): (f64, f64),
    slip: &str,
) -> String {
    format!(
        "[gates.{name}]\nfrom = {from:?}\nto = {to:?}\nmax_speed = {max_speed:?}\nstart = {start:?}\n{slip}{}",
        force(name, "gate")
    )
}

/// An outflow from a box.
pub(super) fn outflow(name: &str, lower: &[f64], upper: &[f64]) -> String {
    format!("[outflows.{name}]\nlower = {lower:?}\nupper = {upper:?}\n")
}

/// An inflow of beads through a face.
fn feed(from: [f64; 2], to: [f64; 2], velocity: [f64; 2]) -> String {
    format!(
        "[inflows.feed]\nmaterial = \"beads\"\nfrom = {from:?}\nto = {to:?}\nvelocity = {velocity:?}\n"
    )
}

/// A silo's geometry: width, height of the fill, opening, spacing.
pub(super) struct Silo {
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) opening: f64,
    pub(super) spacing: f64,
}

impl Silo {
    /// Domain, walls, gate and drain.
    pub(super) fn text(&self, slips: [&str; 2], max_speed: f64, start: f64) -> String {
        let (w, dp) = (self.width, self.spacing);
        let top = short(self.height + 6.0 * dp);
        let (a, b) = (
            short(0.5 * (w - self.opening)),
            short(0.5 * (w + self.opening)),
        );
        let fall = short(12.0 * dp + 0.3 * self.height);
        let side = short(0.5 * w + 12.0 * dp);
        let mut text = head(
            "2",
            &[-side, -fall],
            &[short(w + side), short(top + 6.0 * dp)],
            "",
        );
        text += &wall(
            "left",
            &[[w, top], [0.0, top], [0.0, 0.0], [a, 0.0]],
            false,
            slips[0],
        );
        text += &wall("right", &[[b, 0.0], [w, 0.0], [w, top]], false, slips[0]);
        text += &gate("main", [[a, 0.0], [b, 0.0]], (max_speed, start), slips[1]);
        let drain = short(fall - 7.0 * dp);
        text + &outflow("drain", &[-side, -fall], &[short(w + side), -drain])
    }
}

/// A silo under a random history of its gate.
pub(super) fn silo(dice: &mut Dice) -> Draft {
    let width = dice.log(0.03, 0.5);
    let height = short(width * dice.from(0.4, 4.0));
    let scale = Scale::of(dice, width * height, (60.0, PARTICLES.1), 1.4 * height);
    let opening = short((width * dice.from(0.1, 0.8)).max(2.5 * scale.spacing));
    let silo = Silo {
        width,
        height,
        opening,
        spacing: scale.spacing,
    };
    let (walls, gate) = (slip(dice), slip(dice));
    let start = dice.pick(&[0.0, 0.0, 1.0, 0.37]);
    let speed = dice.log(0.02, 50.0);
    let mut scene = silo.text([&walls, &gate], speed, start);
    scene += &numerics(dice, &scale);
    scene += &material(dice, "beads");
    scene += &body("fill", "beads", &[0.0, 0.0], &[width, height], "");
    let drive = drive(dice, scale.internal_step(), STEPS);
    let time = drive.most_steps as f64 * scale.internal_step();
    scene += &history(dice, "gate.main.opening", 1.0, time);
    Draft { scene, drive }
}

/// A chute with everything.
pub(super) fn chute(dice: &mut Dice) -> Draft {
    let dp = dice.log(1e-3, 0.02);
    let rows = dice.whole(3, 6) as f64;
    let length = short(dp * dice.whole(35, 60) as f64);
    let depth = short(rows * dp);
    let slope = dice.from(0.1, 0.7);
    let speed = dice.from(0.2, 1.5);
    let mut scale = Scale {
        spacing: dp,
        height: short(length * slope.sin()),
        speed,
    };
    scale.speed += 0.5;
    // A jet against a shut gate splashes: to four times its head.
    let splash = 4.0 * speed * speed / (2.0 * 9.81);
    let (below, above) = (short(10.0 * dp), short(24.0 * dp + splash));
    let mut scene = head(
        "2",
        &[-short(6.0 * dp), -below],
        &[short(length + 16.0 * dp), above],
        &format!("slope = {slope:?}"),
    );
    scene += &numerics(dice, &scale);
    scene += &material(dice, "beads");
    let rubs = slip(dice);
    scene += &wall(
        "bed",
        &[[0.0, short(18.0 * dp)], [0.0, 0.0], [length, 0.0]],
        false,
        &rubs,
    );
    if dice.chance(0.7) {
        let (from, to) = (short(6.0 * dp), short(18.0 * dp));
        scene += &body("heap", "beads", &[from, 0.0], &[to, depth], "");
    }
    let face = short(3.0 * dp);
    scene += &feed([face, depth], [face, 0.0], [speed, 0.0]);
    let at = short(length - 12.0 * dp);
    let (max_speed, start) = (dice.log(0.02, 50.0), dice.pick(&[0.0, 1.0, 0.5]));
    scene += &gate(
        "sluice",
        [[at, 0.0], [at, short(10.0 * dp)]],
        (max_speed, start),
        &slip(dice),
    );
    scene += &outflow(
        "end",
        &[short(length + dp), -below],
        &[short(length + 16.0 * dp), above],
    );
    let drive = drive(dice, scale.internal_step(), STEPS);
    let time = drive.most_steps as f64 * scale.internal_step();
    scene += &history(dice, "gate.sluice.opening", 1.0, time);
    // What the face passes at the least density that a material may have: 0.3 of 200 kg/m^3.
    let most = short(60.0 * depth * speed * 0.9);
    scene += &history(dice, "inflow.feed.rate", most, time);
    Draft { scene, drive }
}

/// An inflow into a closed box.
pub(super) fn jam(dice: &mut Dice) -> Draft {
    let dp = dice.log(1e-3, 0.02);
    let (width, height) = (
        short(dp * dice.whole(8, 16) as f64),
        short(dp * dice.whole(16, 24) as f64),
    );
    let speed = dice.from(0.3, 3.0);
    let scale = Scale {
        spacing: dp,
        height,
        speed,
    };
    let tub = Tub { width, height };
    let mut scene = tub.head(dp, "");
    scene += &numerics(dice, &scale);
    // One material whose rate at its fullest is known.
    scene += "[materials.beads]\nlaw = \"mu_i\"\npreset = \"glass_beads\"\n";
    scene += &wall("tub", &tub.outline(), true, &slip(dice));
    let face = short(height - 6.0 * dp);
    let (left, right) = (short(1.5 * dp), short(width - 1.5 * dp));
    scene += &feed([right, face], [left, face], [0.0, -speed]);
    let most = short(1490.0 * (right - left) * speed);
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    let time = drive.most_steps as f64 * scale.internal_step();
    if dice.chance(0.6) {
        scene += &schedule("inflow.feed.rate", &[[0.0, most]], "hold");
    } else {
        scene += &history(dice, "inflow.feed.rate", most, time);
    }
    drive.inside = tub.outline();
    Draft { scene, drive }
}

/// A small silo that sleeps until its gate is told something.
pub(super) fn wake(dice: &mut Dice) -> Draft {
    let dp = dice.log(2e-3, 0.02);
    let (width, height) = (
        short(dp * dice.whole(5, 8) as f64),
        short(dp * dice.whole(2, 3) as f64),
    );
    let scale = Scale {
        spacing: dp,
        height: 0.5 * height,
        speed: 0.0,
    };
    let silo = Silo {
        width,
        height,
        opening: short(3.0 * dp),
        spacing: dp,
    };
    let walls = slip(dice);
    let mut scene = silo.text([&walls, ""], 0.5, 0.0);
    scene += &plain_numerics(dice, &scale, "");
    scene += &plain_material(dice, "beads");
    scene += &body("fill", "beads", &[0.0, 0.0], &[width, height], "");
    let step = short(100.0 * scale.internal_step());
    let count = dice.whole(62, 70);
    let opens = short(step * (count as f64 - dice.from(3.0, 8.0)));
    let points = [[0.0, 0.0], [opens, dice.pick(&[1.0, 0.5, 0.1])]];
    scene += &schedule("gate.main.opening", &points, "hold");
    let drive = plain_drive(dice, vec![step], count, 9000);
    Draft { scene, drive }
}
