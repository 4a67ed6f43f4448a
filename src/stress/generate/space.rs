//! Scenes in space.

use super::super::dice::{Dice, short};
use super::Draft;
use super::devices::outflow;
use super::parts::{Scale, body, drive, force, head, history, material, numerics, slip};

/// Internal steps in space: pairs are many.
const STEPS: (f64, f64) = (100.0, 700.0);

/// A plane with its force gauge.
fn plane(name: &str, point: [f64; 3], normal: [f64; 3], more: &str) -> String {
    format!(
        "[walls.{name}]\nplane = {{ point = {point:?}, normal = {normal:?} }}\n{more}{}",
        force(name, "wall")
    )
}

/// A heap in a box of six planes.
pub(super) fn heap(dice: &mut Dice) -> Draft {
    let dp = dice.log(2e-3, 0.03);
    let [nx, ny, nz] = [0, 1, 2].map(|_| dice.whole(3, 7) as f64);
    let [x, y, z] = [nx, ny, nz].map(|n| short(n * dp));
    let wide = [x, y, z].map(|w| short(w * dice.from(1.0, 1.8)));
    let high = short(z + 5.0 * dp);
    let mut scale = Scale {
        spacing: dp,
        height: z,
        speed: 0.0,
    };
    let throw = dice.from(0.0, 1.0);
    scale.speed = throw;
    let margin = short(6.0 * dp);
    let mut scene = head(
        "3",
        &[-margin; 3],
        &[wide[0] + margin, wide[1] + margin, high + margin].map(short),
        "",
    );
    scene += &numerics(dice, &scale);
    scene += &material(dice, "sand");
    let velocity = format!("velocity = [{throw:?}, 0.0, 0.0]");
    scene += &body("heap", "sand", &[0.0; 3], &[x, y, z], &velocity);
    let (top, none) = ([wide[0], wide[1], high], [0.0; 3]);
    for (name, k, at, towards) in [
        ("west", 0, none, 1.0),
        ("east", 0, top, -1.0),
        ("south", 1, none, 1.0),
        ("north", 1, top, -1.0),
        ("floor", 2, none, 1.0),
        ("roof", 2, top, -1.0),
    ] {
        let mut normal = [0.0; 3];
        normal[k] = towards;
        scene += &plane(name, at, normal, &slip(dice));
    }
    let drive = drive(dice, scale.internal_step(), STEPS);
    Draft { scene, drive }
}

/// A heap behind a gate, periodic across.
pub(super) fn sluice(dice: &mut Dice) -> Draft {
    let dp = dice.log(2e-3, 0.02);
    let n = dice.whole(4, 7) as f64;
    let side = short(n * dp);
    // Wide enough that a particle does not see itself around the periodic side.
    let across = 8.0 * dp;
    let scale = Scale {
        spacing: dp,
        height: 2.0 * side,
        speed: 0.0,
    };
    let (far, low) = (short(2.5 * side + 14.0 * dp), short(8.0 * dp));
    let mut scene = head(
        "3",
        &[-low, 0.0, -low],
        &[far, across, short(2.0 * side + 8.0 * dp)],
        "periodic = [\"y\"]",
    );
    scene += &numerics(dice, &scale);
    scene += &material(dice, "sand");
    scene += &body("heap", "sand", &[0.0; 3], &[side, across, side], "");
    scene += &plane("floor", [0.0; 3], [0.0, 0.0, 1.0], &slip(dice));
    scene += &plane("back", [0.0; 3], [1.0, 0.0, 0.0], &slip(dice));
    scene += &format!(
        "[gates.sluice]\nfrom = {:?}\nto = {:?}\nspan = {:?}\nmax_speed = {:?}\n{}",
        [side, across, 0.0],
        [side, across, short(side + 4.0 * dp)],
        [0.0, -across, 0.0],
        dice.log(0.05, 20.0),
        force("sluice", "gate")
    );
    scene += &outflow(
        "end",
        &[short(2.0 * side + 6.0 * dp), 0.0, -low],
        &[far, across, short(2.0 * side + 8.0 * dp)],
    );
    let drive = drive(dice, scale.internal_step(), STEPS);
    let time = drive.most_steps as f64 * scale.internal_step();
    scene += &history(dice, "gate.sluice.opening", 1.0, time);
    Draft { scene, drive }
}
