//! Walls that are steered: at full speed they are what walls are that move by themselves, and they go where and as fast as they are told.

use std::f64::consts::PI;

use super::Unit;
use sandgate::component::Component;
use sandgate::scene::{self, Scene};

const G: f64 = 9.81;

/// Sand in a box of two walls, the floor and the rest, with these keys of the floor, of the right side, and of all else.
fn sand_box(floor: &str, side: &str, more: &str) -> Scene {
    let text = format!(
        r#"
name = "box"
[domain]
lower = [-0.1, -0.1]
upper = [0.6, 0.4]
[numerics]
spacing = "10 mm"
expected_speed = 1
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.heap]
material = "sand"
box = {{ lower = [0.12, 0], upper = [0.25, 0.06] }}
[walls.floor]
polyline = [[0, 0], [0.5, 0]]
{floor}
[walls.rest]
polyline = [[0.5, 0.3], [0, 0.3], [0, 0]]
[walls.side]
polyline = [[0.3, 0.01], [0.3, 0.29]]
{side}
{more}
[run]
step = "10 ms"
until = "1 s"
"#
    );
    scene::parse("box", &text).unwrap_or_else(|e| panic!("{e}"))
}

/// Places and velocities in single precision, and what they add up to.
fn bits(component: &Component) -> (Vec<u32>, sandgate::component::Totals) {
    let view = component.particles();
    let places = view.position.iter().flatten();
    let speeds = view.velocity.iter().flatten();
    let each = places.chain(speeds).map(|x| x.to_bits());
    (each.collect(), component.totals())
}

#[test]
fn at_full_speed_steered_walls_are_walls_that_move() {
    let piston = "motion = \"rigid\"\nvelocity = [-0.2, 0]";
    let paddle = "motion = \"rigid\"\nangular_velocity = -3\ncentre = [0.3, 0.29]";
    let belt = "velocity = [0.3, 0]";
    for (floor, side) in [(belt, ""), ("", piston), (belt, paddle)] {
        let steered = |keys: &str| match keys {
            "" => String::new(),
            keys => format!("{keys}\ninput = \"speed\"\nstart = 1"),
        };
        let mut free = Unit::new(&sand_box(floor, side, ""));
        let mut told = Unit::new(&sand_box(&steered(floor), &steered(side), ""));
        free.run_to(0.2);
        told.run_to(0.2);
        assert_eq!(
            bits(&free.component),
            bits(&told.component),
            "{floor} {side}"
        );
    }
}

#[test]
fn a_belt_ramps_up_wakes_what_sleeps_and_goes_on_from_a_saved_state() {
    let belt = "velocity = [0.3, 0]\ninput = \"speed\"\nramp = \"0.1 s\"";
    let scene = sand_box(belt, "", "");
    let mut unit = Unit::new(&scene);
    while unit.get("solver.step_size") > 0.0 || unit.component.steps() == 0 {
        let before = unit.component.steps();
        unit.step();
        if unit.component.steps() == before {
            break;
        }
        assert!(unit.component.time() < 20.0, "it does not fall asleep");
    }
    let momentum = |unit: &Unit| unit.component.totals().momentum[0];
    assert_eq!(momentum(&unit), 0.0);
    let start = unit.component.time();
    unit.set("wall.floor.speed", -0.15);
    unit.step();
    // 10 ms of a ramp of 0.1 s to 0.3 m/s.
    let speed = unit.get("wall.floor.actual_speed");
    assert!((speed + 0.03).abs() < 1e-12, "{speed}");
    let saved = unit.component.save().unwrap();
    unit.run_to(start + 0.2);
    assert_eq!(unit.get("wall.floor.actual_speed"), -0.15);
    // The heap rides along: its mass at most as fast as the belt, and most of it nearly so.
    let mass = unit.get("mass.present");
    let mean = momentum(&unit) / mass;
    assert!((-0.151..-0.12).contains(&mean), "{mean} m/s");
    let mut other = Component::new(&scene).unwrap();
    other.restore(&saved).unwrap();
    for _ in 0..19 {
        other.do_step(other.time(), scene.run.step).unwrap();
    }
    assert_eq!(other.state_hash(), unit.component.state_hash());
    // Told to stop it does, and so does the heap.
    unit.set("wall.floor.speed", 0.0);
    unit.run_to(start + 0.5);
    assert_eq!(unit.get("wall.floor.actual_speed"), 0.0);
    assert!(momentum(&unit).abs() < 1e-3 * mass * 0.15);
}

#[test]
fn a_piston_goes_where_it_is_told_and_no_further_than_its_end_stop() {
    let piston = "motion = \"rigid\"\nvelocity = [-0.5, 0]\ninput = \"position\"\nstroke = 0.04\nstroke_back = 0.01";
    let force = "[gauges.push]\nkind = \"force\"\non = \"wall.side\"\n[gauges.at]\nkind = \"depth\"\nfoot = [0.28, 0]";
    let mut unit = Unit::new(&sand_box("", piston, force));
    unit.set("wall.side.position", 0.0275);
    unit.step();
    let way = unit.get("wall.side.actual_position");
    assert!((way - 0.005).abs() < 1e-12, "{way}");
    assert!((unit.get("wall.side.actual_speed") - 0.5).abs() < 1e-9);
    unit.run_to(0.05);
    unit.step();
    // The mean of the step in which it arrived, half way through.
    assert!((unit.get("wall.side.actual_speed") - 0.25).abs() < 1e-9);
    unit.run_to(0.1);
    let way = unit.get("wall.side.actual_position");
    assert!((way - 0.0275).abs() < 1e-12, "{way}");
    assert_eq!(unit.get("wall.side.actual_speed"), 0.0);
    // Its points are there, too, and gauges know it.
    let points = unit.component.wall_points();
    let first = points
        .iter()
        .filter(|x| x[1] > 0.15 && x[1] < 0.2 && x[0] > 0.2);
    let nearest = first.map(|x| x[0]).fold(f64::INFINITY, f64::min);
    assert!((nearest - 0.2775).abs() < 1e-9, "{nearest}");
    assert_eq!(unit.get("gauge.at.validity"), 3.0, "behind the piston");
    let reference = unit.reference("wall.side.position");
    let refused = unit.component.set(&[reference], &[0.05]).unwrap_err();
    assert!(refused.to_string().contains("-0.01 to 0.04 m"), "{refused}");
    unit.set("wall.side.position", 0.0);
    unit.run_to(0.2);
    assert_eq!(unit.get("wall.side.actual_position"), 0.0);
    // Backwards past where it is drawn, saved half way.
    unit.set("wall.side.position", -0.01);
    unit.step();
    let saved = unit.component.save().unwrap();
    unit.step();
    unit.step();
    let way = unit.get("wall.side.actual_position");
    assert!((way + 0.01).abs() < 1e-12, "{way}");
    let after = unit.component.state_hash();
    unit.component.restore(&saved).unwrap();
    unit.step();
    unit.step();
    assert_eq!(unit.component.state_hash(), after);
    unit.set("wall.side.position", 0.0);
    unit.run_to(0.3);
    assert_eq!(unit.get("wall.side.actual_position"), 0.0);
    // Before it again: it reads, or there is nothing.
    assert!(unit.get("gauge.at.validity") < 2.0);
}

/// A flap between two tanks, hinged at the floor, with water before it: the moment that holds it is that of statics at each angle.
#[test]
fn a_flap_that_is_lowered_bears_the_moment_of_the_water_before_it() {
    let text = r#"
name = "flap"
[domain]
lower = [-0.1, -0.1]
upper = [0.8, 0.5]
[numerics]
spacing = "5 mm"
[materials.water]
law = "fluid"
preset = "water"
[bodies.pool]
material = "water"
box = { lower = [0, 0], upper = [0.4, 0.1] }
[walls.tank]
polyline = [[0, 0.4], [0, 0], [0.7, 0]]
slip = "free_slip"
[walls.flap]
polyline = [[0.4, 0], [0.4, 0.3]]
slip = "free_slip"
motion = "rigid"
angular_velocity = "-30 deg/s"
centre = [0.4, 0]
input = "position"
swing = "40 deg"
[gauges.hinge]
kind = "force"
on = "wall.flap"
about = [0.4, 0]
[gauges.level]
kind = "depth"
foot = [0.2, 0]
[run]
step = "20 ms"
until = "3 s"
"#;
    let mut unit = Unit::new(&scene::parse("flap", text).unwrap());
    for (angle, until) in [(0.0, 1.0), (40.0_f64, 4.6)] {
        unit.set("wall.flap.angle", angle.to_radians());
        unit.run_to(until);
        let reached = unit.get("wall.flap.actual_angle");
        assert!((reached - angle.to_radians()).abs() < 1e-12, "{reached}");
        let (mut moment, mut level) = (0.0, 0.0);
        // Over two periods of what sloshes.
        for _ in 0..100 {
            unit.step();
            moment += unit.get("gauge.hinge.moment") / 100.0;
            level += unit.get("gauge.level.depth") / 100.0;
        }
        // Area is kept: L d + d^2 tan(a)/2 = 0.04 m^2; the moment of rho g (d - s cos a) s along the flap, clockwise.
        let (tan, cos) = (angle.to_radians().tan(), angle.to_radians().cos());
        let depth = if angle == 0.0 {
            0.1
        } else {
            (-0.4 + (0.16 + 2.0 * tan * 0.04).sqrt()) / tan
        };
        let expected = -1000.0 * G * depth.powi(3) / (6.0 * cos * cos);
        println!("{angle} deg: moment {moment} for {expected} N m, depth {level} for {depth} m");
        assert!((level / depth - 1.0).abs() < 0.01);
        assert!((moment / expected - 1.0).abs() < 0.02);
    }
}

/// Steps along the scene's schedules as `sandgate run` does, until `end` [s].
fn run_scheduled(component: &mut Component, end: f64, mut look: impl FnMut(&Component)) {
    let step = component.scene().run.step;
    while component.time() < end - 0.5 * step {
        let time = component.time();
        component.follow_schedules(time, time + step).unwrap();
        component.do_step(time, step).unwrap();
        look(component);
    }
}

#[test]
fn a_schedule_turns_a_paddle() {
    let mill = "motion = \"rigid\"\nangular_velocity = \"-30 rpm\"\ncentre = [0.3, 0.29]\ninput = \"speed\"";
    let schedule = "[[schedule]]\ninput = \"wall.side.speed\"\npoints = [[0, \"15 rpm\"], [0.1, \"15 rpm\"], [0.11, 0]]";
    let mut unit = Unit::new(&sand_box("", mill, schedule));
    run_scheduled(&mut unit.component, 0.2, |_| {});
    // 15 rpm over 0.11 s: inputs of runs are held over steps.
    let turned = unit.get("wall.side.actual_angle");
    assert!((turned - 0.055 * PI).abs() < 1e-9, "{turned}");
    assert_eq!(unit.get("wall.side.actual_speed"), 0.0);
    // In the sense of its angular velocity, which is clockwise: its lower end goes to the left, by 0.28 sin(9.9 deg).
    let points = unit.component.wall_points();
    let paddle = points
        .iter()
        .filter(|x| x[0] > 0.1 && x[0] < 0.45 && x[1] > 0.005 && x[1] < 0.28);
    let left = paddle.map(|x| x[0]).fold(f64::INFINITY, f64::min);
    assert!((left - 0.25).abs() < 0.01, "{left}");
}

/// A position that is told with a slope is gone to steadily, whatever the steps; held over steps it would be one jerk a step.
#[test]
fn a_position_with_a_slope_is_gone_to_steadily() {
    let piston = "motion = \"rigid\"\nvelocity = [-0.5, 0]\ninput = \"position\"\nstroke = 0.04";
    let schedule = "[[schedule]]\ninput = \"wall.side.position\"\npoints = [[0, 0], [0.2, 0.01]]";
    let mut unit = Unit::new(&sand_box("", piston, schedule));
    let reference = unit.reference("wall.side.actual_speed");
    let mut speeds = Vec::new();
    run_scheduled(&mut unit.component, 0.1, |component| {
        let mut speed = [0.0];
        component.get(&[reference], &mut speed).unwrap();
        speeds.push(speed[0]);
    });
    assert!(speeds.iter().all(|v| (v - 0.05).abs() < 1e-9), "{speeds:?}");
    // Steps of other lengths, each with the slope.
    let (position, at) = (
        unit.reference("wall.side.position"),
        unit.reference("wall.side.actual_position"),
    );
    for h in [1.1e-3, 0.3e-3, 1.1e-3, 7e-3] {
        let time = unit.component.time();
        unit.component.set(&[position], &[0.05 * time]).unwrap();
        unit.component
            .set_input_derivatives(&[position], &[0.05])
            .unwrap();
        unit.component.do_step(time, h).unwrap();
        let speed = unit.get("wall.side.actual_speed");
        assert!((speed - 0.05).abs() < 1e-9, "{speed} at {time} over {h}");
        let mut way = [0.0];
        unit.component.get(&[at], &mut way).unwrap();
        assert!((way[0] - 0.05 * (time + h)).abs() < 1e-12, "{way:?}");
    }
}

/// On a flat stretch of its line a wall stands, and its scene falls asleep: a slope of rounding kept it awake.
#[test]
fn a_position_on_a_plateau_lets_its_scene_sleep() {
    let piston = "motion = \"rigid\"\nvelocity = [-0.5, 0]\ninput = \"position\"\nstroke = 0.04";
    let schedule = "[[schedule]]\ninput = \"wall.side.position\"\npoints = [[0, 0], [0.1, 0.03], [19.7, 0.03], [19.8, 0]]";
    let mut unit = Unit::new(&sand_box("", piston, schedule));
    run_scheduled(&mut unit.component, 10.0, |_| {});
    let steps = unit.component.steps();
    run_scheduled(&mut unit.component, 10.1, |_| {});
    assert_eq!(unit.component.steps(), steps);
}
