//! Bins and columns that stand askew in the domain, gravity with them, start as upright ones; so do bins that lean against gravity, with the
//! pressure of the depth below their free surface.

use super::Unit;
use sandgate::scene;

const G: f64 = 9.81;
const DENSITY: f64 = 1500.0;
const SPACING: f64 = 0.005;
const WIDTH: f64 = 0.16;
const HEIGHT: f64 = 0.25;

fn turned([x, y]: [f64; 2], degrees: f64) -> [f64; 2] {
    let (s, c) = degrees.to_radians().sin_cos();
    [c * x - s * y, s * x + c * y]
}

/// Sand between walls of these corners, in a frame of its own, of which all is turned by `degrees`.
fn askew(degrees: f64, body: &[[f64; 2]], walls: &[&[[f64; 2]]]) -> Unit {
    let points = |corners: &[[f64; 2]]| {
        let all: Vec<String> = corners
            .iter()
            .map(|p| turned(*p, degrees))
            .map(|p| format!("[{:.9}, {:.9}]", p[0], p[1]))
            .collect();
        all.join(", ")
    };
    let walls: String = walls
        .iter()
        .enumerate()
        .map(|(n, w)| {
            format!(
                "[walls.w{n}]\npolyline = [{}]\nslip = \"friction\"\nwall_friction = 0.3\n",
                points(w)
            )
        })
        .collect();
    let (gravity, body) = (points(&[[0.0, -G]]), points(body));
    let text = format!(
        r#"
name = "askew"
[domain]
lower = [-0.6, -0.6]
upper = [0.6, 0.6]
gravity = {gravity}
[numerics]
spacing = {SPACING}
expected_speed = 1.6
[materials.beads]
law = "mu_i"
preset = "glass_beads"
[bodies.fill]
material = "beads"
polygon = [{body}]
{walls}
[run]
step = 0.02
until = 0.3
"#
    );
    Unit::new(&scene::parse("askew", &text).unwrap_or_else(|e| panic!("{e}")))
}

/// Mean of the pressures over that of the depth below `HEIGHT` in the scene's frame, and the worst that one is off by, over the pressure on the
/// floor.
fn of_depth(unit: &Unit, degrees: f64) -> (f64, f64) {
    let particles = unit.component.particles();
    let (mut sum, mut exact, mut worst) = (0.0, 0.0, 0.0f64);
    for (x, p) in particles.position.iter().zip(&particles.pressure) {
        let [_, y] = turned([f64::from(x[0]), f64::from(x[1])], -degrees);
        let depth = DENSITY * G * (HEIGHT - y);
        sum += f64::from(*p);
        exact += depth;
        worst = worst.max((f64::from(*p) - depth).abs() / (DENSITY * G * HEIGHT));
    }
    (sum / exact, worst)
}

const BOTH_WAYS: [f64; 9] = [0.0, 17.0, -17.0, 30.0, -30.0, 40.0, -40.0, 60.0, -60.0];

/// A block of sand whose sides stand `aside` of upright at the top, between walls or free.
fn starts_of_blocks(aside: f64, walled: bool) {
    let (left, right) = (-0.5 * WIDTH, 0.5 * WIDTH);
    let up = |x: f64, y: f64| [x + aside * y / HEIGHT, y];
    let body = [
        up(left, 0.0),
        up(right, 0.0),
        up(right, HEIGHT),
        up(left, HEIGHT),
    ];
    let bin = [up(left, 0.35), body[0], body[1], up(right, 0.35)];
    for degrees in BOTH_WAYS {
        let wall = if walled { &bin[..] } else { &bin[1..3] };
        let (mean, worst) = of_depth(&askew(degrees, &body, &[wall]), degrees);
        let found = format!("{aside} aside, {degrees} deg: {mean:.4}, worst {worst:.4}");
        // One place may be off by about a spacing of depth, 2 %, where its way leaves by the edge of the top.
        assert!((mean - 1.0).abs() < 0.01 && worst < 0.03, "{found}");
    }
}

#[test]
fn a_bin_starts_with_the_pressure_of_its_depth_however_it_stands() {
    starts_of_blocks(0.0, true);
}

#[test]
fn a_column_starts_with_the_pressure_of_its_depth_however_it_stands() {
    starts_of_blocks(0.0, false);
}

#[test]
fn a_bin_that_leans_starts_with_the_pressure_of_its_depth() {
    starts_of_blocks(0.12, true);
    starts_of_blocks(-0.12, true);
}

/// On a slope between walls across its bed sand bears what lies on the bed: its top is along that.
#[test]
fn a_bin_on_a_slope_starts_with_the_load_across_its_floor() {
    let text = r#"
name = "slope"
[domain]
lower = [-0.3, -0.1]
upper = [0.3, 0.5]
slope = "25 deg"
[numerics]
spacing = "5 mm"
expected_speed = 1.6
[materials.beads]
law = "mu_i"
preset = "glass_beads"
[bodies.fill]
material = "beads"
box = { lower = [-0.08, 0], upper = [0.08, 0.25] }
[walls.bin]
polyline = [[-0.08, 0.35], [-0.08, 0], [0.08, 0], [0.08, 0.35]]
[run]
step = 0.02
until = 0.3
"#;
    let unit = Unit::new(&scene::parse("slope", text).unwrap());
    let (mean, worst) = of_depth(&unit, 0.0);
    let across = 25f64.to_radians().cos();
    println!("{:.4} of it, worst {worst:.4}", mean / across);
    assert!((mean / across - 1.0).abs() < 0.01, "{mean}");
}
