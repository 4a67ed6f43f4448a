//! The sweeps alone and the roofline kernel.

use super::{pairs_ns, percent, plane, table};
use crate::bench::SpeedRun;
use crate::validate::report::number;

pub(super) fn kernels(run: &SpeedRun) -> String {
    let mut rows = Vec::new();
    for k in &run.kernels {
        for pass in &k.passes {
            let or_none = |v: Option<String>| v.unwrap_or_else(|| "-".to_owned());
            rows.push(vec![
                if k.dimension == 2 { "plane" } else { "space" }.to_owned(),
                k.particles.to_string(),
                format!("{:.1}", k.neighbours()),
                pass.name.clone(),
                format!("{:.1}", pass.ns),
                format!("{:.0}", k.rate(pass.ns)),
                or_none(pass.plain_ns.map(|ns| format!("{ns:.0}"))),
                or_none(pass.times_plain.map(|t| format!("{t:.1}"))),
            ]);
        }
    }
    let (rounds, worst) = run.kernels.iter().fold((0, 0.0f64), |(rounds, worst), k| {
        (k.rounds.max(rounds), k.disagreement.max(worst))
    });
    format!(
        "## Sweeps alone\n\nA lattice displaced by up to 0.1 dp, h/dp = 1.6, no walls, one thread; the sides are free, so small \
         ones have fewer pairs a particle. Pairs are those within the support, counted from both sides. *lists* sorts the \
         particles and builds neighbour lists (every few steps), *pairs* finds the neighbours within the support and makes \
         velocity gradients, moments and pair coefficients, *pressure* makes the pressure force, density diffusion and pair \
         viscosities (each once a step); *stress* and *force* are one product of the viscous solve (once an iteration). \
         *Plain* is the same sweep as one would write it first, one pair after the other (`src/solver/plain.rs`), in the same \
         program. Medians of {rounds} rounds; the two forms differ by at most {} of the largest result.\n\n{}",
        number(worst),
        table(
            &[
                "",
                "particles",
                "pairs a particle",
                "sweep",
                "ns a particle",
                "Mpair/s",
                "plain, ns a particle",
                "plain / fast"
            ],
            &rows
        )
    )
}

pub(super) fn roofline(run: &SpeedRun) -> String {
    let mut rows = Vec::new();
    for k in plane(run) {
        let Some(r) = &k.roofline else { continue };
        rows.push(vec![
            k.particles.to_string(),
            format!("{:.1}", r.ns),
            format!("{:.0}", k.rate(r.ns)),
            format!("{:.0}", k.rate(r.plain_ns)),
            format!("{:.0}", k.rate(r.cells_ns)),
            format!("{:.0}", k.rate(pairs_ns(k))),
            percent(r.reached),
            format!("{:.1}", r.times_plain),
            format!("{:.1}", r.times_cells),
            percent(r.filled),
        ]);
    }
    format!(
        "## The roofline kernel\n\n`src/bench/roofline.rs`: velocity gradient, density diffusion, a plane stress tensor's \
         force and Monaghan's viscosity in one pass of 44 operations a pair, four particles side by side in the lanes, their \
         common neighbours from records of one cache line, neighbours found beforehand, nothing stored for a pair. It uses the \
         solver's lanes and so, like it, no fused multiply-add. The solver's pair sweep does other work: it also finds the \
         neighbours within the support among those listed, and stores three numbers a pair that the viscous solve reads in \
         each iteration. *Plain* are the same sums as one would write them first, over neighbour lists with a skin, or by a search of the nine cells around each particle as codes without lists do. *Filled* is the share of the kernel's lanes that holds a pair within the support.\n\n{}",
        table(
            &[
                "particles",
                "kernel, ns a particle",
                "kernel, Mpair/s",
                "plain, lists, Mpair/s",
                "plain, cells, Mpair/s",
                "pair sweep, Mpair/s",
                "sweep / kernel",
                "sweep / plain, lists",
                "sweep / plain, cells",
                "filled"
            ],
            &rows
        )
    )
}
