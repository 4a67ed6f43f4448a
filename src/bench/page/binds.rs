//! What a step is made of, and what binds.

use super::{percent, plane, table};
use crate::bench::SpeedRun;
use crate::bench::kernels::Kernels;
use crate::solver::Pass;

/// What a step of the column is made of, by the sweeps' times at the nearest size.
pub(super) fn budget(run: &SpeedRun) -> String {
    let Some((default, sweeps)) = run.column.get(1).zip(plane(run).min_by_key(|k| {
        let n = run.column.first().map_or(0, |c| c.particles as usize);
        k.particles.abs_diff(n)
    })) else {
        return String::new();
    };
    let whole = default.ns_per_particle_step();
    let ns = |pass: Pass| sweeps.pass(pass).map_or(f64::NAN, |p| p.ns);
    let products = 1.0 + default.iterations_per_step();
    let parts = [
        ("pair sweep", ns(Pass::Pairs)),
        ("pressure sweep", ns(Pass::Pressure)),
        ("stress sweeps", products * ns(Pass::Stress)),
        ("force sweeps", products * ns(Pass::Force)),
    ];
    let known: f64 = parts.iter().map(|p| p.1).sum();
    let rest = ("all else", whole - known);
    let rows: Vec<Vec<String>> = parts
        .into_iter()
        .chain([rest])
        .map(|(what, ns)| vec![what.to_owned(), format!("{ns:.0}"), percent(ns / whole)])
        .collect();
    format!(
        "## What binds\n\nA step of the column (exact yield, sleep off) by the sweeps' times at {} particles, {products:.2} \
         stress and force sweeps a step. All else is walls, the law of friction, the yield's projection, vectors of the \
         conjugate gradients, lists, gauges.\n\n{}\n\n{}",
        sweeps.particles,
        table(&["", "ns a particle and step", "share"], &rows),
        binds(run)
    )
}

/// What the figures mean; shares of a profile are of the machine and the day that the text names.
fn binds(run: &SpeedRun) -> String {
    let ends = plane(run).next().zip(plane(run).last());
    let growth = |ns: &dyn Fn(&Kernels) -> Option<f64>| {
        let (small, large) = ends?;
        Some(ns(large)? / ns(small)?)
    };
    let of = |pass: Pass| growth(&|k| Some(k.pass(pass)?.ns)).unwrap_or(f64::NAN);
    let kernel = growth(&|k| Some(k.roofline.as_ref()?.ns)).unwrap_or(f64::NAN);
    let (small, large) = ends.map_or((0, 0), |(s, l)| (s.particles, l.particles));
    format!(
        "- **Memory, from some thousand particles on.** A group of four pairs keeps 112 bytes in the plane (neighbours, two \
         components of the gradient, one coefficient), about 0.9 kB a particle: 2,000 particles are 1.8 MB, about \
         what a core's own cache holds, 8,000 are 7 MB. From {small} to {large} particles the pair sweep, which writes them, takes {:.1} times as long for a \
         particle, the stress sweep, which reads most of them, {:.1} times, the force sweep {:.1} times; the roofline kernel, \
         which keeps nothing for a pair, {kernel:.1} times. This, not arithmetic, makes the cost a particle grow. \
         Coefficients made anew from places (48 bytes a group instead of 80 in the stress sweep) cost more than they save at any size \
         (docs/decisions/005-lanes-of-four.md).\n\
         - **In the cache, the pair sweep's own work.** It has about a third of its time outside the sums over pairs: finding \
         the neighbours within the support, sums across lanes, the correction of the gradient. Within them it gathers four \
         neighbours by transposing their records where the kernel broadcasts one, and keeps more running sums than there are \
         registers.\n\
         - **The count of iterations.** Steps are at the acoustic bound and as many as the sound speed asks for; what makes the \
         beginning of a collapse dear is the solve: see the iterations in the tables. The plain cap is *not* cheaper than the \
         exact yield: its viscosity in the plug is larger, and the solve takes more iterations.\n\
         - **The rest of the step.** {PROFILE}",
        of(Pass::Pairs),
        of(Pass::Stress),
        of(Pass::Force),
    )
}

/// Not from the stored run: a sampling profile, which a reader repeats with the command it names.
const PROFILE: &str = "A sampling profile of the column's first 0.3 s on 2026-11-21 (`perf record -e cpu-clock` of `sandgate \
run cases/column_collapse.toml --until 0.3 --threads 1`, built with `CARGO_PROFILE_RELEASE_DEBUG=line-tables-only`, samples sorted by \
source line) had 25 % in the pair sweep (14 % sums and \
coefficients, 4 % finding neighbours, 3 % each particle's end, 2 % walls), 18 % in stress sweeps, 13 % in force sweeps, 12 % in \
building lists, 8 % in the pressure sweep, 8 % in the law of friction, 5 % in gauges, 4 % in the solve's vectors and the yield's \
projection.";
