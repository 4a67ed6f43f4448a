//! Steady flow down a plane against Bagnold's profile, exact for mu(I) ([A] section 5.1, exponents corrected).

use super::{Unit, case};

/// Velocity within 5 % of the surface speed everywhere, mean over the depth (L2) within 5 %, from 11 to 14 s.
#[test]
fn an_inclined_layer_takes_bagnolds_profile() {
    let mut unit = Unit::new(&case("inclined_plane", &[]));
    unit.run_to(11.0);
    // Glass beads of [A] Table 1 with d = 5 mm on 25 degrees; the layer dilates from phi_max to phi.
    let (mu_s, mu_2, i0, d) = (
        20.90_f64.to_radians().tan(),
        32.76_f64.to_radians().tan(),
        0.279,
        5e-3,
    );
    let slope = 25.0_f64.to_radians();
    let inertial = i0 * (slope.tan() - mu_s) / (mu_2 - slope.tan());
    let phi = 0.6 - 0.1 * inertial;
    let height: f64 = 0.1 * 0.6 / phi;
    let scale = 2.0 / 3.0 * inertial / d * (phi * 9.81 * slope.cos()).sqrt();
    let exact = |y: f64| scale * (height.powf(1.5) - (height - y.clamp(0.0, height)).powf(1.5));
    let surface = exact(height);

    let mut bins = [(0.0, 0.0, 0u32); 20];
    while unit.component.time() < 14.0 - 1e-9 {
        unit.step();
        let view = unit.component.particles();
        for (x, v) in view.position.iter().zip(&view.velocity) {
            let y = f64::from(x[1]);
            let bin = &mut bins[((y / height * 20.0) as usize).min(19)];
            *bin = (bin.0 + f64::from(v[0]), bin.1 + exact(y), bin.2 + 1);
        }
    }
    let errors: Vec<f64> = bins
        .iter()
        .map(|b| (b.0 - b.1) / f64::from(b.2) / surface)
        .collect();
    let l2 = (errors.iter().map(|e| e * e).sum::<f64>() / 20.0).sqrt();
    println!(
        "L2 {l2:.4}, surface {:+.4}, worst {:.4}",
        errors[19],
        errors.iter().fold(0.0, |m: f64, e| m.max(e.abs()))
    );
    assert!(l2 < 0.05, "{l2}");
    assert!(errors.iter().all(|e| e.abs() < 0.05), "{errors:?}");
}

/// What a solve leaves, the next one starts with: at a tolerance of 1e-2 that used to add up, and the layer ran 3.6 times too fast.
/// Mean velocity 2 s after the start within 1 % of that of solves to 1e-6.
#[test]
fn a_layer_speeds_up_alike_at_any_tolerance_of_the_solver() {
    let mean = |tolerance: &str| {
        let line = format!("[numerics]\nsolver_tolerance = {tolerance}");
        let mut unit = Unit::new(&case("inclined_plane", &[("[numerics]", &line)]));
        unit.run_to(2.0);
        let velocity = unit.component.particles().velocity;
        let sum: f64 = velocity.iter().map(|v| f64::from(v[0])).sum();
        sum / velocity.len() as f64
    };
    let (loose, tight) = (mean("1e-2"), mean("1e-6"));
    println!("mean velocity {loose:.4} and {tight:.4} m/s");
    assert!(tight > 0.1, "{tight}");
    assert!((loose / tight - 1.0).abs() < 0.01, "{loose} {tight}");
}
