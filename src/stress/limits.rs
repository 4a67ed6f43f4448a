//! Where single settings break: one key of a small scene swept over its range, all else as by default.

use serde::{Deserialize, Serialize};

use super::case::{Case, Drive, Expect};
use super::run::{Bounds, Figures, run};
use crate::bench::Machine;
use crate::validate::template::Template;

/// A column of sand, a = 0.9 in the plane, 15 rows high, released in a closed box.
const COLUMN: &str = r#"
name = "limits"
dimension = 2
[domain]
lower = [-0.06, -0.06]
upper = [0.41, 0.2]
[numerics]
spacing = 0.0058
expected_speed = 1.3
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.column]
material = "sand"
box = { lower = [0.0, 0.0], upper = [0.0972, 0.0875] }
[walls.tub]
polyline = [[0.0, 0.0], [0.35, 0.0], [0.35, 0.14], [0.0, 0.14]]
closed = true
[gauges.load]
kind = "force"
on = "wall.tub"
[run]
step = 0.01
until = 0.4
"#;

/// The same sand filling a box to a level, with a gate in a wall that stays shut.
const FILL: &str = r#"
name = "limits"
dimension = 2
[domain]
lower = [-0.06, -0.06]
upper = [0.18, 0.2]
[numerics]
spacing = 0.0058
expected_speed = 1.3
sleep = false
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.fill]
material = "sand"
box = { lower = [0.0, 0.0], upper = [0.116, 0.087] }
[walls.tub]
polyline = [[0.0, 0.0], [0.116, 0.0], [0.116, 0.14], [0.0, 0.14]]
closed = true
[gauges.load]
kind = "force"
on = "wall.tub"
[run]
step = 0.01
until = 0.4
"#;

/// A key that is swept.
struct Key {
    key: &'static str,
    about: &'static str,
    /// What it is by default in these scenes.
    default: f64,
    values: &'static [f64],
}

/// Sound speed of both scenes by default: ten times the expected speed [m/s].
const SOUND: f64 = 13.0;

const KEYS: [Key; 7] = [
    Key {
        key: "courant",
        about: "acoustic Courant number",
        default: 0.7,
        values: &[0.1, 0.25, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0],
    },
    Key {
        key: "smoothing_ratio",
        about: "h/dp",
        default: 1.6,
        values: &[1.2, 1.3, 1.4, 1.6, 1.8, 2.0, 2.25, 2.5],
    },
    Key {
        key: "sound_speed",
        about: "artificial sound speed, 13 m/s by default",
        default: SOUND,
        values: &[1.3, 2.6, 5.2, 13.0, 26.0, 52.0, 104.0],
    },
    Key {
        key: "density_diffusion",
        about: "density diffusion delta",
        default: 0.1,
        values: &[0.0, 0.03, 0.1, 0.3, 0.5, 0.75, 1.0],
    },
    Key {
        key: "cap_time",
        about: "viscosity cap over mu_s p, 2 c0/g by default; 1e5 s caps at 4e7 Pa s under a pressure of 700 Pa",
        default: 2.0 * SOUND / 9.81,
        values: &[1e-4, 1e-2, 0.1, 1.0, 2.65, 10.0, 100.0, 1e4, 1e5],
    },
    Key {
        key: "solver_tolerance",
        about: "relative tolerance of the viscous solve",
        default: 3e-4,
        values: &[1e-10, 1e-6, 1e-4, 3e-4, 1e-3, 1e-2, 0.1],
    },
    Key {
        key: "pair_viscosity_share",
        about: "share of the pair form of viscosity",
        default: 0.05,
        values: &[0.0, 0.01, 0.05, 0.2, 0.5, 0.95],
    },
];

/// One value of a key.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// The value.
    pub value: f64,
    /// Names of the checks that failed.
    pub failed: Vec<String>,
    /// What was measured.
    pub figures: Figures,
}

/// One key in one scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sweep {
    /// The scene: `column` or `fill`.
    pub scene: String,
    /// The key of `[numerics]`.
    pub key: String,
    /// What it is.
    pub about: String,
    /// Its default here.
    pub default: f64,
    /// Its values, ascending.
    pub points: Vec<Point>,
}

/// The map.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitsRun {
    /// Where and when.
    pub machine: Machine,
    /// All sweeps.
    pub sweeps: Vec<Sweep>,
}

/// The case of a scene with one key set.
fn case(text: &str, rest: bool, key: &str, value: f64) -> Option<Case> {
    let template = Template::new(text).ok()?;
    let text = template
        .with(&format!("numerics.{key}"), value)
        .with("numerics.solver_max_iterations", 100_000)
        .text()
        .ok()?;
    Some(Case {
        scene: text.parse().ok()?,
        drive: Drive {
            kind: "limits".to_owned(),
            seed: 0,
            note: String::new(),
            expect: Expect::Run,
            steps: vec![0.01],
            count: 40,
            most_steps: 200_000,
            restore_after: 20,
            threads: 2,
            rest,
            falls: false,
            inside: Vec::new(),
            twin: None,
        },
    })
}

/// Sweeps all keys in both scenes; `watch` hears the share done and what is next.
#[must_use]
pub fn measure(bounds: &Bounds, watch: &mut dyn FnMut(f64, &str)) -> LimitsRun {
    let mut machine = Machine::here();
    let total: usize = KEYS.iter().map(|k| 2 * k.values.len()).sum();
    let (mut done, mut sweeps) = (0, Vec::new());
    for (name, text, rest) in [("column", COLUMN, false), ("fill", FILL, true)] {
        for key in &KEYS {
            let mut points = Vec::new();
            for value in key.values {
                watch(
                    done as f64 / total as f64,
                    &format!("{name}, {} = {value}", key.key),
                );
                let Some(case) = case(text, rest, key.key, *value) else {
                    continue;
                };
                let outcome = run(&case, bounds);
                let failed = outcome.failures.iter();
                points.push(Point {
                    value: *value,
                    failed: failed.map(|f| f.check.name().to_owned()).collect(),
                    figures: outcome.figures,
                });
                done += 1;
            }
            sweeps.push(Sweep {
                scene: name.to_owned(),
                key: key.key.to_owned(),
                about: key.about.to_owned(),
                default: key.default,
                points,
            });
        }
    }
    machine.finish();
    LimitsRun { machine, sweeps }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_makes_a_legal_scene_and_each_sweep_has_its_default() {
        for key in &KEYS {
            let near = |v: &&f64| (*v / key.default - 1.0).abs() < 0.01;
            assert!(key.values.iter().any(|v| near(&v)), "{}", key.key);
            for value in key.values {
                for text in [COLUMN, FILL] {
                    let case = case(text, false, key.key, *value).unwrap();
                    assert!(case.scene().is_ok(), "{} = {value}", key.key);
                }
            }
        }
    }
}
