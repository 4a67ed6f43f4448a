//! Our figures in the units in which other programs report theirs, beside theirs.

use super::table;
use crate::bench::SpeedRun;
use crate::validate::report::number;

/// What was measured of others, one core of an AMD Zen 3 server, 2026: program, scene, particles, neighbours within
/// the support, million particle updates a second and core, million pairs.
const PEERS: [[&str; 6]; 6] = [
    [
        "DualSPHysics 5.4 (CPU, positions f64, else f32), water",
        "plane dam break, dp 14 mm, h/dp 1.41",
        "11013",
        "25",
        "1.14 to 1.43",
        "29 to 34",
    ],
    [
        "DualSPHysics 5.4, water",
        "dam break in space, dp 8.5 mm, h/dp 1.73",
        "171496",
        "174",
        "0.19 to 0.22",
        "30 to 36",
    ],
    [
        "DualSPHysics-NNewtonian 5.0 (HBP, gradient by SPH)",
        "this column, dp 1.84 mm, h/dp 1.30",
        "3029",
        "21",
        "0.61 to 0.74",
        "13 to 15",
    ],
    [
        "the same, gradient by finite differences",
        "the same",
        "3029",
        "21",
        "0.50",
        "10",
    ],
    [
        "SPHinXsys, July 2026 (f64, Drucker-Prager, elastoplastic)",
        "this column, h/dp 1.3, and 2456 wall particles",
        "2544",
        "21",
        "0.30 to 0.35",
        "6 to 7",
    ],
    [
        "GeoTaichi, June 2026 (material points, f64, Drucker-Prager)",
        "this column, cells of 3.7 mm",
        "2444",
        "9 nodes",
        "1.06 to 2.4",
        "-",
    ],
];

/// CPU seconds of one core for a simulated second of the column: program, time step, steps a simulated second, CPU seconds.
const COLUMN: [[&str; 4]; 4] = [
    [
        "SPHinXsys",
        "1.9e-5 s (c = 48.8 m/s)",
        "51900",
        "375 to 440",
    ],
    [
        "DualSPHysics-NNewtonian, gradient by SPH",
        "4.6e-5 s (c = 9.3 m/s)",
        "21900",
        "90 to 108",
    ],
    [
        "DualSPHysics-NNewtonian, finite differences",
        "viscous bound",
        "49400",
        "300",
    ],
    ["GeoTaichi", "2e-5 s", "50000", "50 to 115"],
];

/// Neighbours within the support 2 h of a particle inside, at h/dp = 1.6 in the plane: pi 3.2^2.
const NEIGHBOURS: f64 = 32.0;

pub(super) fn peers(run: &SpeedRun) -> String {
    let mut rows: Vec<Vec<String>> = Vec::new();
    let stretches = run.column.iter().take(1).chain(&run.sizes);
    for s in stretches {
        let updates = 1e3 / s.ns_per_particle_step();
        rows.push(vec![
            format!(
                "**Sandgate** (f64, mu(I), implicit, {:.1} iterations a step)",
                s.iterations_per_step()
            ),
            format!("column, {}, h/dp 1.6", s.name),
            s.particles.to_string(),
            format!("{NEIGHBOURS}"),
            format!("{updates:.2}"),
            format!("{:.0}", NEIGHBOURS * updates),
        ]);
    }
    let owned = |row: &[&str]| row.iter().map(|c| (*c).to_owned()).collect::<Vec<String>>();
    rows.extend(PEERS.iter().map(|row| owned(row)));
    let mut times: Vec<Vec<String>> = Vec::new();
    for s in run.column.iter().take(1) {
        let steps = s.steps as f64 / s.simulated;
        times.push(vec![
            "**Sandgate**".to_owned(),
            format!("{} s, acoustic bound", number(s.mean_step())),
            format!("{steps:.0}"),
            number(s.cost()),
        ]);
    }
    times.extend(COLUMN.iter().map(|row| owned(row)));
    format!(
        "## In the units of others\n\nThe column of [A]: half width 97.2 mm, height 87.5 mm, planar, sand (mu_s 0.589, mu_2 1.248, I0 2.65, 0.32 mm, \
         2600 kg/m^3), c0 = 10 sqrt(g H), h/dp = 1.6, Courant number 0.7, one core. A particle update is one particle over one whole step, \
         whatever sweeps and iterations that takes; pairs are updates times neighbours within the support, each pair counted from both sides. \
         Others' figures were measured with their own programs as they are shipped, one core of an AMD Zen 3 server, in 2026; each has its own \
         sound speed, step and law (none has a local mu(I)), so that the second table compares what a user waits for and the first what \
         a step costs.\n\n{}\n\n{}",
        table(
            &[
                "program",
                "scene",
                "particles",
                "neighbours",
                "Mupdates/s and core",
                "Mpairs/s and core"
            ],
            &rows
        ),
        table(
            &[
                "one simulated second of the column, about 2,500 particles (Sandgate: 1,856)",
                "time step",
                "steps",
                "CPU s"
            ],
            &times
        )
    )
}
