//! Collapse of a column of sand, a = 0.90 ([A] section 5.2, Table 3 row 3, against Lube et al. 2004).

use super::{Unit, case};

/// r0 and H0 of the case [m].
const R0: f64 = 0.0972;
const H0: f64 = 0.0875;

/// Run-out 1.24 a (Lube et al. 2004, [A] eq. 57) within 15 %, mean of three seeds: single runs scatter by some percent.
/// Height unchanged within 5 %; front at rest after 12 sqrt(H0/g).
#[test]
fn a_column_runs_out_as_measured_and_then_stands_still() {
    let fall = (H0 / 9.81_f64).sqrt();
    let mut run_outs = Vec::new();
    for seed in ["1", "2", "3"] {
        let with_seed = format!("spacing = \"3.02 mm\"\nseed = {seed}");
        let scene = case("column_collapse", &[("spacing = \"3.02 mm\"", &with_seed)]);
        let mut unit = Unit::new(&scene);
        unit.run_to(12.0 * fall);
        let front = |u: &Unit| {
            [
                u.get("gauge.front_left.front"),
                u.get("gauge.front_right.front"),
            ]
        };
        let (before, t) = (front(&unit), unit.component.time());
        unit.run_to(t + 0.1);
        let after = front(&unit);
        let speed = (0..2)
            .map(|s| (after[s] - before[s]).abs() / 0.1)
            .fold(0.0, f64::max);
        let height = unit.get("gauge.depth_centre.depth");
        let run_out = (0.5 * (after[0] + after[1]) - R0) / R0;
        println!(
            "seed {seed}: run-out {run_out:.3}, height {:.2} %, front {speed:.1e} m/s",
            100.0 * (height / H0 - 1.0)
        );
        assert!(
            (height / H0 - 1.0).abs() < 0.05,
            "centre {height} m of {H0} m"
        );
        assert!(
            speed < 1e-3 * (9.81 * H0).sqrt(),
            "front still moves at {speed} m/s"
        );
        run_outs.push(run_out);
    }
    let mean = run_outs.iter().sum::<f64>() / run_outs.len() as f64;
    let measured = 1.24 * 0.90;
    println!("mean run-out {mean:.3}, measured {measured:.3}");
    assert!(
        (mean / measured - 1.0).abs() < 0.15,
        "run-out {mean}, measured {measured}"
    );
}

/// All the density diffusion that a scene can ask for costs no friction: particles were taken past their neighbours' pressure, and the
/// column flew apart.
#[test]
fn a_column_with_all_the_density_diffusion_stands_as_high() {
    let with_diffusion = "spacing = \"3.02 mm\"\ndensity_diffusion = 1";
    let scene = case(
        "column_collapse",
        &[("spacing = \"3.02 mm\"", with_diffusion)],
    );
    let mut unit = Unit::new(&scene);
    unit.run_to(0.6);
    let height = unit.get("gauge.depth_centre.depth");
    assert!(
        (height / H0 - 1.0).abs() < 0.05,
        "centre {height} m of {H0} m"
    );
}
