//! Loose particles on rough walls rub as Coulomb says: single ones, which no pressure bears but the push by place of (W5), and heaps.

use super::Unit;
use sandgate::scene;

/// A particle of sand, or a ring of it, at 0.8 m/s along a floor; after 1 s its way [m], kinetic energy [J/kg], and the impulse along
/// it that the floor has got [N s/kg].
fn glide(dimension: &str, slip: &str) -> (f64, f64, f64) {
    let space = dimension == "3";
    let vector = |x: f64, height: f64| match space {
        true => format!("[{x}, 0.0, {height}]"),
        false => format!("[{x}, {height}]"),
    };
    let corner = |x: f64, y: f64, height: f64| match space {
        true => format!("[{x}, {y}, {height}]"),
        false => format!("[{x}, {height}]"),
    };
    let text = format!(
        r#"
name = "glide"
dimension = {dimension}
[domain]
lower = {}
upper = {}
[numerics]
spacing = "5 mm"
expected_speed = 1
[materials.sand]
law = "constant_friction"
friction_angle = "30 deg"
match = "simple_shear"
density = 1500
[bodies.grain]
material = "sand"
box = {{ lower = {}, upper = {} }}
velocity = {}
[walls.floor]
plane = {{ point = {}, normal = {} }}
{slip}
[gauges.floor]
kind = "force"
on = "wall.floor"
[run]
step = "10 ms"
until = 1
"#,
        corner(0.0, -0.1, -0.04),
        corner(2.0, 0.1, 0.1),
        corner(0.05, 0.0, 0.0),
        corner(0.055, 0.005, 0.005),
        vector(0.8, 0.0),
        vector(0.0, 0.0),
        vector(0.0, 1.0),
    );
    let mut unit = Unit::new(&scene::parse("glide", &text).unwrap());
    let mut impulse = 0.0;
    while unit.component.time() < 0.995 {
        unit.step();
        impulse += 0.01 * unit.get("gauge.floor.force_x");
    }
    let mass = unit.get("mass.present");
    let way = f64::from(unit.component.particles().position[0][0]) - 0.0525;
    (way, unit.get("energy.kinetic") / mass, impulse / mass)
}

/// v^2/(2 mu g) is 65 mm with mu_w = 0.5 and 57 mm without slip, tan 30 deg: first contacts bounce, so half and double of it.
#[test]
fn loose_particles_on_rough_walls_stop() {
    for dimension in ["2", "3", "\"axisymmetric\""] {
        for slip in [
            "slip = \"friction\"\nwall_friction = 0.5",
            "slip = \"no_slip\"",
        ] {
            let (way, energy, impulse) = glide(dimension, slip);
            println!("{dimension}, {slip}: {way:.3} m");
            assert!((0.03..0.13).contains(&way), "{dimension}, {slip}: {way} m");
            assert!(energy < 1e-8, "{dimension}, {slip}: {energy} J/kg");
            // All of its momentum; of rings only what goes along the axis is kept.
            let kept = dimension.len() > 1 || (impulse - 0.8).abs() < 1e-3;
            assert!(kept, "{dimension}, {slip}: {impulse} N s/kg");
        }
        let (way, ..) = glide(dimension, "slip = \"free_slip\"");
        // A ring that is still dense is also braked by its hoop stress.
        assert!((0.7..0.81).contains(&way), "{dimension}, smooth: {way} m");
    }
}

/// Loose sand that slides rubs with mu_w times what it weighs, too, though its lowest rows hop: a heap on a slope steeper than it bears, in steps of one and of two acoustic
/// steps, in the plane and in space.
#[test]
fn loose_sand_slides_as_coulomb_says() {
    let share = |space: bool, steps: u32| {
        let dimension = if space { 3 } else { 2 };
        let point = |x: f64, y: f64| {
            if space {
                format!("[{x}, {}, {y}]", 0.5 * x)
            } else {
                format!("[{x}, {y}]")
            }
        };
        let up = if space { "[0, 0, 1]" } else { "[0, 1]" };
        let text = format!(
            r#"
name = "loose"
dimension = {dimension}
[domain]
lower = {}
upper = {}
slope = "35 deg"
[numerics]
spacing = "12 mm"
expected_speed = 2
acoustic_steps = {steps}
[materials.sand]
law = "constant_friction"
friction_angle = "38 deg"
density = 1600
[bodies.heap]
material = "sand"
box = {{ lower = {}, upper = {} }}
[walls.bed]
plane = {{ point = {}, normal = {up} }}
slip = "friction"
wall_friction = 0.4
[gauges.bed]
kind = "force"
on = "wall.bed"
[run]
step = "10 ms"
until = "1 s"
"#,
            point(-0.5, -0.1),
            point(2.5, 0.4),
            point(0.0, 0.0),
            point(0.24, 0.1),
            point(0.0, 0.0),
        );
        let mut unit = Unit::new(&scene::parse("loose", &text).unwrap());
        unit.run_to(0.2);
        let (mut along, mut down) = (0.0, 0.0);
        for k in 1..=30 {
            unit.run_to(0.2 + 0.01 * f64::from(k));
            along += unit.get("gauge.bed.force_x");
            down -= unit.get(if space {
                "gauge.bed.force_z"
            } else {
                "gauge.bed.force_y"
            });
        }
        along / down
    };
    for (space, steps) in [(false, 1), (false, 2), (true, 2)] {
        let mu = share(space, steps);
        println!("space {space}, {steps} acoustic steps: {mu:.4}");
        assert!(mu > 0.38 && mu < 0.41, "{mu}");
    }
}

/// Ten rows that slide as one down the slope at which friction bears them, tan 16.7 deg = mu_w: the share of their weight across the bed that
/// rubs, over half a second.
fn share_of_a_plug(speed: f64, material: &str, numerics: &str) -> f64 {
    let text = format!(
        r#"
name = "plug"
dimension = 2
[domain]
lower = [0, -0.04]
upper = [0.04, 0.1]
periodic = ["x"]
slope = "16.69924423399362 deg"
[numerics]
spacing = "5 mm"
expected_speed = 5
{numerics}
[materials.sand]
{material}
[bodies.plug]
material = "sand"
box = {{ lower = [0, 0], upper = [0.04, 0.05] }}
velocity = [{speed}, 0]
[walls.bed]
polyline = [[0, 0], [0.04, 0]]
slip = "friction"
wall_friction = 0.3
[gauges.bed]
kind = "force"
on = "wall.bed"
[run]
step = "10 ms"
until = 1
"#
    );
    let mut unit = Unit::new(&scene::parse("plug", &text).unwrap());
    unit.run_to(0.1);
    let (mut along, mut down) = (0.0, 0.0);
    for _ in 0..50 {
        unit.step();
        along += unit.get("gauge.bed.force_x");
        down -= unit.get("gauge.bed.force_y");
    }
    along / down
}

/// What a solve leaves must not grow with the speed at which all slides: it took up to a quarter of the friction, and gave half of it with
/// the capped yield, which holds it to a twentieth.
#[test]
fn plugs_slide_as_coulomb_says_at_any_speed() {
    let sand = "law = \"mu_i\"\npreset = \"sand_04\"";
    let clay = format!("{sand}\ncohesion = \"2 kPa\"");
    for (material, numerics, most) in [
        (sand, "", 0.003),
        (sand, "yield = \"capped\"", 0.06),
        (&clay, "", 0.005),
    ] {
        for speed in [1.0, 4.0, 8.0] {
            let mu = share_of_a_plug(speed, material, numerics);
            println!("{material:?} {numerics}, {speed} m/s: {mu:.4}");
            assert!(
                (mu - 0.3).abs() < most * 0.3,
                "{material:?} {numerics}, {speed} m/s: {mu}"
            );
        }
    }
}

/// Water in the pores does not rub: what of the weight the grains bear does, up to the wall. A light layer rubbed with 1.21 of that, as its first row
/// had the pores' pressure of its place and the load of the wall's.
#[test]
fn saturated_layers_rub_with_what_presses_their_grains() {
    for density in [1300.0, 1990.0] {
        let material = format!(
            "law = \"constant_friction\"\nfriction_angle = \"40 deg\"\ndensity = {density}\npore_fluid = \"water\"\n\
             [materials.water]\nlaw = \"fluid\"\npreset = \"water\""
        );
        let exact = 0.3 * (density - 1000.0) / density;
        let share = share_of_a_plug(1.0, &material, "") / exact;
        println!("{density} kg/m^3: {share:.4} of mu_w (rho - rho_w)/rho");
        assert!((share - 1.0).abs() < 0.03, "{density} kg/m^3: {share}");
    }
}
