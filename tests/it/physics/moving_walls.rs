//! Walls that move as a whole: they push as they are pushed, material rides on them, nothing gets through.

use super::{Unit, case};
use sandgate::boundary::Course;
use sandgate::scene::{self, Scene};
use sandgate::solver::{Solver, StepInputs};
use sandgate::state::State;

const G: f64 = 9.81;

/// A solver and its state, stepped without devices.
struct Bench {
    solver: Solver<2>,
    state: State<2>,
}

impl Bench {
    fn new(scene: &Scene) -> Self {
        let (plan, mut state) = scene::build::<2>(scene).unwrap();
        let mut solver = Solver::new(plan, 1);
        solver.start(&mut state);
        Self { solver, state }
    }

    fn run_to(&mut self, end: f64) {
        let inputs = StepInputs {
            openings: &[],
            rates: &[],
            drives: &[],
        };
        while self.state.time < end - 1e-9 {
            self.solver
                .step(&mut self.state, end, &inputs, &mut |_, _| {})
                .unwrap();
        }
    }

    fn momentum(&self) -> [f64; 2] {
        let grains = &self.state.grains;
        let mut sum = [0.0; 2];
        for (v, m) in grains.velocity.iter().zip(&grains.mass) {
            sum = [sum[0] + m * v[0], sum[1] + m * v[1]];
        }
        sum
    }
}

/// What the drum gives, and gravity, is the change of momentum of the sand.
#[test]
fn a_drum_pushes_as_it_is_pushed() {
    for (name, slip) in [
        ("no slip", ""),
        ("friction", "slip = \"friction\"\nwall_friction = 0.5"),
    ] {
        for tolerance in ["1e-13", "3e-4", "1e-2"] {
            let spacing = format!("spacing = \"6 mm\"\nsolver_tolerance = {tolerance}");
            let motion = format!("motion = \"rigid\"\n{slip}");
            let mut bench = Bench::new(&case(
                "rotating_drum",
                &[
                    ("spacing = \"4 mm\"", spacing.as_str()),
                    ("motion = \"rigid\"", motion.as_str()),
                ],
            ));
            let weight = bench.state.grains.present_mass() * G;
            let start = bench.momentum();
            bench.run_to(0.3);
            let end = bench.momentum();
            let given = bench.state.impulse[0];
            let fall = [0.0, -weight * bench.state.time];
            let error = (0..2)
                .map(|k| (end[k] - start[k] + given[k] - fall[k]).abs())
                .fold(0.0, f64::max);
            println!(
                "{name}, tolerance {tolerance}: {:.1e} of the impulse of gravity",
                error / -fall[1]
            );
            assert!(error < -1e-10 * fall[1]);
        }
    }
}

/// Sand in a drum that turns by half a turn: nothing gets out, and its surface comes to lie near the angle of repose, 30.5
/// deg for this sand: in a half-full drum that is the angle of the centre of mass. It flows steadily a little above,
/// and no more than 10 deg. A restored state goes on with the same bits.
#[test]
fn sand_in_a_drum_lies_near_its_angle_of_repose() {
    let mut unit = Unit::new(&case(
        "rotating_drum",
        &[("spacing = \"4 mm\"", "spacing = \"5 mm\"")],
    ));
    let mut saved = Vec::new();
    let mut angles = Vec::new();
    for step in 1..=30 {
        unit.run_to(0.1 * f64::from(step));
        let particles = unit.component.particles();
        let mut centre = [0.0; 2];
        for x in &particles.position {
            // The wall's first row is half a spacing behind the surface.
            assert!(x[0].hypot(x[1]) < 0.1 + 0.0025, "out of the drum: {x:?}");
            centre = [centre[0] + f64::from(x[0]), centre[1] + f64::from(x[1])];
        }
        angles.push(centre[0].atan2(-centre[1]).to_degrees());
        if step == 25 {
            saved = unit.component.save().unwrap();
        }
    }
    let steady = angles[20..].iter().sum::<f64>() / 10.0;
    println!("angles {angles:.0?} deg; {steady:.1} deg at the end");
    assert!((30.5..40.5).contains(&steady));
    let end = unit.component.save().unwrap();
    unit.component.restore(&saved).unwrap();
    unit.run_to(3.0);
    assert!(
        unit.component.save().unwrap() == end,
        "other bits after restoring"
    );
}

/// A bin of sand, at rest or moving as a whole.
fn bin(velocity: &str, motion: &str) -> Bench {
    let text = format!(
        r#"
name = "bin"
[domain]
lower = [-0.2, -0.2]
upper = [0.6, 0.6]
[numerics]
spacing = "10 mm"
sound_speed = 20
solver_tolerance = 1e-10
sleep = false
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.fill]
material = "sand"
box = {{ lower = [0, 0], upper = [0.15, 0.12] }}
velocity = [{velocity}]
[walls.bin]
polyline = [[0, 0.2], [0, 0], [0.15, 0], [0.15, 0.2]]
slip = "friction"
wall_friction = 0.4
{motion}
[run]
step = "10 ms"
until = "1 s"
"#
    );
    Bench::new(&scene::parse("bin", &text).unwrap())
}

/// A bin that moves at constant velocity is a bin at rest, seen from a train. Solved far below the tolerance of a usual run: one
/// iteration more or less is that much.
#[test]
fn sand_rests_in_a_bin_that_moves() {
    let mut still = bin("0, 0", "");
    let mut moving = bin("0.3, 0.2", "motion = \"rigid\"\nvelocity = [0.3, 0.2]");
    let end = 0.5;
    let mut worst: f64 = 0.0;
    still.run_to(end);
    moving.run_to(end);
    let by_number = |b: &Bench| {
        let grains = &b.state.grains;
        let mut rows: Vec<_> = (0..grains.len())
            .map(|i| (grains.id[i], grains.position[i], grains.velocity[i]))
            .collect();
        rows.sort_by_key(|r| r.0);
        rows
    };
    let mut fastest: f64 = 0.0;
    for ((_, x, v), (_, y, w)) in by_number(&still).iter().zip(&by_number(&moving)) {
        for (k, speed) in [0.3, 0.2].into_iter().enumerate() {
            worst = worst.max((v[k] - (w[k] - speed)).abs());
            worst = worst.max((x[k] - (y[k] - speed * end)).abs());
            fastest = fastest.max(v[k].abs());
        }
    }
    println!("differs by {worst:.1e} m and m/s; the still one has {fastest:.1e} m/s");
    assert!(worst < 1e-12);
}

/// A piston on a floor, so slow that water stays at rest: it bears rho g h^2/2, the floor nothing across, be it a box that moves, one that
/// stands, or a chain. Coarse, 15 rows: 1.5 %.
#[test]
fn a_piston_bears_what_is_pushed_on_its_foot() {
    let chain = "polyline = [[0.1, 0.5], [0.1, 0]]\nmotion = \"rigid\"\nvelocity = [-0.002, 0]";
    let stands = "box = { lower = [0, 0], upper = [0.1, 0.5] }";
    let moves = format!("{stands}\nmotion = \"rigid\"\nvelocity = [-0.002, 0]");
    for piston in [chain, stands, &moves] {
        let text = format!(
            r#"
name = "piston"
[domain]
lower = [-0.4, -0.2]
upper = [1, 0.6]
[numerics]
spacing = 0.02
[materials.water]
law = "fluid"
preset = "water"
[bodies.water]
material = "water"
box = {{ lower = [0.1, 0], upper = [0.6, 0.3] }}
[walls.floor]
polyline = [[-0.2, 0], [0.6, 0], [0.6, 0.5]]
slip = "free_slip"
[walls.piston]
slip = "free_slip"
{piston}
[gauges.piston]
kind = "force"
on = "wall.piston"
[run]
step = 0.02
until = 2
"#
        );
        let mut unit = Unit::new(&scene::parse("piston", &text).unwrap());
        unit.run_to(1.6);
        let mut force = 0.0;
        for k in 1..=20 {
            unit.run_to(1.6 + 0.02 * f64::from(k));
            force += unit.get("gauge.piston.force_x") / 20.0;
        }
        let thrust = 0.5 * 1000.0 * G * 0.3 * 0.3;
        println!("{force} N for {}", -thrust);
        assert!((force / -thrust - 1.0).abs() < 0.015, "{piston}: {force} N");
    }
}

/// The points in a paddle's acute corners come after the rows of all walls: they stood still, and points of the floor went round
/// with it instead.
#[test]
fn a_wall_takes_all_of_its_points_along_and_no_others() {
    let triangle = "[[0.4, 0.2], [0.5, 0.373], [0.6, 0.2]]\nclosed = true";
    // A gentle bend before an acute corner: some of its points know the centre of a bend, and those in the tip do not.
    let bent = "[[0.6, 0.2], [0.5, 0.21], [0.4, 0.24], [0.3, 0.29], [0.36, 0.2]]";
    for paddle in [triangle, bent] {
        let text = format!(
            r#"
name = "paddle"
[domain]
lower = [0, 0]
upper = [1, 1]
[numerics]
spacing = "10 mm"
expected_speed = 1
[materials.sand]
law = "mu_i"
preset = "glass_beads"
[bodies.heap]
material = "sand"
box = {{ lower = [0.7, 0], upper = [0.9, 0.1] }}
[walls.paddle]
polyline = {paddle}
motion = "rigid"
velocity = [0.1, 0.05]
angular_velocity = 1.5
centre = [0.5, 0.25]
[walls.floor]
polyline = [[0, 0], [1, 0]]
[walls.side]
polyline = [[1, 0.5], [0.8, 0.45], [0.99, 0.8]]
[run]
step = "10 ms"
until = "1 s"
"#
        );
        let (plan, _) = scene::build::<2>(&scene::parse("paddle", &text).unwrap()).unwrap();
        let (mover, mut walls) = (&plan.movers[0], plan.walls.clone());
        let after = Course {
            way: 0.7,
            rate: 1.0,
        };
        mover.place(&mut walls, after);
        let (sin, cos) = 1.05_f64.sin_cos();
        for i in 0..walls.len() {
            let [x, y] = plan.walls.position[i];
            let arm = [x - 0.5, y - 0.25];
            let place = if walls.group[i] == 0 {
                [
                    0.57 + cos * arm[0] - sin * arm[1],
                    0.285 + sin * arm[0] + cos * arm[1],
                ]
            } else {
                [x, y]
            };
            let off = (0..2).map(|k| (walls.position[i][k] - place[k]).abs());
            assert!(
                off.fold(0.0, f64::max) < 1e-12,
                "{i} {:?} {place:?}",
                walls.position[i]
            );
            let turned = |v: [f64; 2]| [cos * v[0] - sin * v[1], sin * v[0] + cos * v[1]];
            if let Some(to) = plan.walls.bend(i).filter(|_| walls.group[i] == 0) {
                let (to, now) = (turned(*to), walls.bend(i).unwrap());
                assert!(
                    (to[0] - now[0]).abs() + (to[1] - now[1]).abs() < 1e-12,
                    "{i}"
                );
            }
        }
    }
}
