//! Scenes in the plane whose walls stand still.

use super::super::dice::{Dice, short};
use super::Draft;
use super::parts::{
    G, Scale, Tub, body, drive, head, material, numerics, plain_drive, plain_material,
    plain_numerics, slip, wall,
};

/// Least and most particles of a random scene.
pub(super) const PARTICLES: (f64, f64) = (25.0, 420.0);

/// Least and most internal steps.
pub(super) const STEPS: (f64, f64) = (150.0, 1900.0);

/// A full turn, nearly: directions are drawn from it [rad].
const TURN: f64 = 628.0 / 100.0;

/// A heap of any slenderness in a closed box.
pub(super) fn column(dice: &mut Dice) -> Draft {
    let width = dice.log(0.01, 1.0);
    let height = short(width * dice.log(0.08, 12.0));
    let scale = Scale::of(dice, width * height, PARTICLES, height);
    let left = if dice.chance(0.5) {
        0.0
    } else {
        short(dice.from(0.5, 2.0) * width)
    };
    let tub = Tub {
        width: short(left + width * dice.from(1.5, 4.0) + 6.0 * scale.spacing),
        height: short(height + 8.0 * scale.spacing),
    };
    let mut scene = tub.head(scale.spacing, "");
    scene += &numerics(dice, &scale);
    scene += &material(dice, "sand");
    scene += &body(
        "heap",
        "sand",
        &[left, 0.0],
        &[short(left + width), height],
        "",
    );
    scene += &wall("tub", &tub.outline(), true, &slip(dice));
    let room = tub.width - left - width;
    if dice.chance(0.3) && room > 12.0 * scale.spacing {
        let from = short(left + width + 2.0 * scale.spacing);
        let (low, high) = (
            [from, 0.0],
            [
                short(from + 5.0 * scale.spacing),
                short(scale.spacing * dice.from(2.0, 6.0)),
            ],
        );
        scene += &format!(
            "[walls.block]\nbox = {{ lower = {low:?}, upper = {high:?} }}\n{}{}",
            slip(dice),
            super::parts::force("block", "wall")
        );
    }
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = tub.outline();
    Draft { scene, drive }
}

/// A block thrown about between tilted walls.
pub(super) fn corners(dice: &mut Dice) -> Draft {
    let radius = dice.log(0.02, 0.5);
    let sides = dice.whole(3, 7);
    let squash = dice.from(0.4, 1.0);
    let turn = dice.from(0.0, TURN);
    let spread = 0.5 / sides as f64;
    let outline: Vec<[f64; 2]> = (0..sides)
        .map(|k| {
            let share = (k as f64 + dice.from(-spread, spread) * sides as f64 * 0.5) / sides as f64;
            let angle = turn + std::f64::consts::TAU * share;
            [
                short(radius * angle.cos()),
                short(radius * squash * angle.sin()),
            ]
        })
        .collect();
    let area = 0.5
        * (0..sides)
            .map(|k| {
                let (a, b) = (outline[k], outline[(k + 1) % sides]);
                a[0] * b[1] - a[1] * b[0]
            })
            .sum::<f64>();
    let share = dice.from(0.35, 0.85);
    let centre: [f64; 2] =
        std::array::from_fn(|k| outline.iter().map(|p| p[k]).sum::<f64>() / sides as f64);
    let inner: Vec<[f64; 2]> = outline
        .iter()
        .map(|p| std::array::from_fn(|k| short(centre[k] + share * (p[k] - centre[k]))))
        .collect();
    let mut scale = Scale::of(dice, area.abs() * share * share, PARTICLES, 2.0 * radius);
    let fall = (2.0 * G * radius).sqrt();
    let throw = dice.from(0.0, 3.0) * fall;
    scale.speed = throw;
    let (way, down) = (dice.from(0.0, TURN), dice.from(0.0, TURN));
    let g = if dice.chance(0.15) { 0.0 } else { G };
    let gravity = [short(g * down.cos()), short(g * down.sin())];
    let margin = 6.0 * scale.spacing + radius;
    let mut scene = head(
        "2",
        &[-short(margin), -short(margin)],
        &[short(margin), short(margin)],
        &format!("gravity = {gravity:?}"),
    );
    scene += &numerics(dice, &scale);
    scene += &material(dice, "sand");
    let velocity = [short(throw * way.cos()), short(throw * way.sin())];
    scene += &format!(
        "[bodies.block]\nmaterial = \"sand\"\npolygon = {inner:?}\nvelocity = {velocity:?}\n"
    );
    scene += &wall("shell", &outline, true, &slip(dice));
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = outline;
    Draft { scene, drive }
}

/// Blocks that fall.
pub(super) fn drop(dice: &mut Dice) -> Draft {
    let size = dice.log(0.02, 0.3);
    let fall = short(size * dice.log(0.3, 10.0));
    let mut scale = Scale::of(dice, 2.0 * size * size, PARTICLES, size + fall);
    scale.speed = dice.from(0.0, 2.0);
    let tub = Tub {
        width: short(3.0 * size),
        height: short(2.5 * size + fall + 4.0 * scale.spacing),
    };
    let mut scene = tub.head(scale.spacing, "");
    scene += &numerics(dice, &scale);
    scene += &material(dice, "sand");
    scene += &material(dice, "rock");
    scene += &body(
        "bed",
        "sand",
        &[0.0, 0.0],
        &[tub.width, short(0.3 * size)],
        "",
    );
    let left = short(dice.from(0.0, 1.9) * size);
    let low = short(0.4 * size + fall);
    let velocity = [
        short(dice.from(-1.0, 1.0) * scale.speed),
        -short(dice.from(0.0, 1.0) * scale.speed),
    ];
    scene += &body(
        "block",
        "rock",
        &[left, low],
        &[short(left + size), short(low + size)],
        &format!("velocity = {velocity:?}"),
    );
    scene += &wall("tub", &tub.outline(), true, &slip(dice));
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = tub.outline();
    Draft { scene, drive }
}

/// A thin layer on a slope.
pub(super) fn layer(dice: &mut Dice) -> Draft {
    let spacing = dice.log(1e-4, 0.05);
    let rows = dice.whole(2, 5) as f64;
    let length = short(spacing * dice.whole(10, 60) as f64);
    let height = short(rows * spacing);
    let scale = Scale {
        spacing,
        height,
        speed: 3.0 * (G * height).sqrt(),
    };
    let slope = dice.from(0.0, 0.8);
    let mut scene = head(
        "2",
        &[0.0, -short(6.0 * spacing)],
        &[length, short(height + 60.0 * spacing)],
        &format!("periodic = [\"x\"]\nslope = {slope:?}"),
    );
    scene += &numerics(dice, &scale);
    let bagnold = dice.chance(0.2);
    if bagnold {
        scene += &plain_material(dice, "sand");
    } else {
        scene += &material(dice, "sand");
    }
    let more = if bagnold {
        "velocity_profile = \"bagnold\""
    } else {
        ""
    };
    scene += &body("layer", "sand", &[0.0, 0.0], &[length, height], more);
    scene += &wall("bed", &[[0.0, 0.0], [length, 0.0]], false, &slip(dice));
    let drive = drive(dice, scale.internal_step(), STEPS);
    Draft { scene, drive }
}

/// Two materials above each other, the heavy one often on top.
pub(super) fn strata(dice: &mut Dice) -> Draft {
    let width = dice.log(0.02, 1.0);
    let height = short(width * dice.from(0.4, 2.0));
    let scale = Scale::of(dice, width * height, PARTICLES, height);
    let tub = Tub {
        width,
        height: short(height + 6.0 * scale.spacing),
    };
    let middle = short(height * dice.from(0.3, 0.7));
    let mut scene = tub.head(scale.spacing, "");
    scene += &numerics(dice, &scale);
    scene += &material(dice, "lower");
    scene += &material(dice, "upper");
    scene += &body("first", "lower", &[0.0, 0.0], &[width, middle], "");
    scene += &body("second", "upper", &[0.0, middle], &[width, height], "");
    scene += &wall("tub", &tub.outline(), true, &slip(dice));
    let mut drive = drive(dice, scale.internal_step(), STEPS);
    drive.inside = tub.outline();
    Draft { scene, drive }
}

/// A level fill that stays at rest.
pub(super) fn rest(dice: &mut Dice) -> Draft {
    let rows = dice.whole(2, 6) as f64;
    let spacing = dice.log(1e-3, 0.02);
    let (width, height) = (
        short(spacing * dice.whole(5, 40) as f64),
        short(rows * spacing),
    );
    let scale = Scale {
        spacing,
        height: 0.5 * height,
        speed: 0.0,
    };
    let tub = Tub {
        width,
        height: short(height + 6.0 * spacing),
    };
    let mut scene = tub.head(spacing, "");
    let sleep = dice.pick(&["sleep = false", ""]);
    scene += &plain_numerics(dice, &scale, sleep);
    scene += &plain_material(dice, "sand");
    scene += &body("fill", "sand", &[0.0, 0.0], &[width, height], "");
    scene += &wall("tub", &tub.outline(), true, &slip(dice));
    let step = short(80.0 * scale.internal_step());
    let mut drive = plain_drive(dice, vec![step], 24, 2000);
    drive.inside = tub.outline();
    drive.rest = true;
    Draft { scene, drive }
}

/// A small column by scheme `paper_a`.
pub(super) fn paper(dice: &mut Dice) -> Draft {
    let width = dice.log(0.02, 0.2);
    let height = short(width * dice.from(0.3, 2.0));
    let scale = Scale::of(dice, width * height, (25.0, 200.0), height);
    let tub = Tub {
        width: short(2.0 * width + 8.0 * scale.spacing),
        height: short(height + 8.0 * scale.spacing),
    };
    let mut scene = tub.head(scale.spacing, "");
    let scheme = format!(
        "scheme = \"paper_a\"\nscaling_time = {:?}\nartificial_viscosity = {:?}",
        dice.log(0.01, 10.0),
        dice.from(0.0, 0.2)
    );
    scene += &plain_numerics(dice, &scale, &scheme);
    scene += &plain_material(dice, "sand");
    scene += &body("heap", "sand", &[0.0, 0.0], &[width, height], "");
    scene += &wall("tub", &tub.outline(), true, "");
    let step = 1e-6;
    let mut drive = drive(dice, step, (150.0, 600.0));
    drive.inside = tub.outline();
    Draft { scene, drive }
}

/// Enough particles for sweeps on several threads, and few steps.
pub(super) fn threads(dice: &mut Dice) -> Draft {
    let (width, height) = (0.2, 0.1);
    let scale = Scale {
        spacing: dice.from(0.002_65, 0.002_75),
        height,
        speed: 0.0,
    };
    let tub = Tub {
        width: 0.4,
        height: 0.13,
    };
    let mut scene = tub.head(scale.spacing, "");
    scene += &plain_numerics(dice, &scale, "");
    scene += &plain_material(dice, "sand");
    scene += &body("heap", "sand", &[0.0, 0.0], &[width, height], "");
    scene += &wall("tub", &tub.outline(), true, &slip(dice));
    let step = short(5.0 * scale.internal_step());
    let mut drive = plain_drive(dice, vec![step], 6, 40);
    drive.threads = dice.pick(&[2, 3, 4, 16]);
    drive.inside = tub.outline();
    Draft { scene, drive }
}
