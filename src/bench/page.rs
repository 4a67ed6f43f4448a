//! docs/performance.md from a stored run: what was asked, what came out, what binds.

use super::SpeedRun;
use super::kernels::Kernels;
use super::scenes::Stretch;
use crate::solver::Pass;
use crate::validate::Verdict;
use crate::validate::report::number;

/// First line of the page.
pub const MADE: &str = "<!-- Written by `sandgate bench speed` from a stored run; do not edit. -->";

/// One line of the table of demands.
#[derive(Clone, Debug, PartialEq)]
pub struct Demand {
    /// What is measured.
    pub what: &'static str,
    /// What was asked, in words.
    pub asked: &'static str,
    /// What came out, in words.
    pub measured: String,
    /// What became of it.
    pub verdict: Verdict,
}

impl Demand {
    /// The verdict in plain words.
    #[must_use]
    pub fn verdict(&self) -> &'static str {
        match self.verdict {
            Verdict::Met => "met",
            Verdict::FallsShort => "**not met**",
            Verdict::Reported => "for comparison",
            Verdict::NoResult => "not measured",
        }
    }
}

fn judged(met: bool) -> Verdict {
    if met {
        Verdict::Met
    } else {
        Verdict::FallsShort
    }
}

/// Smallest and largest.
fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
        (low.min(v), high.max(v))
    })
}

fn plane(run: &SpeedRun) -> impl Iterator<Item = &Kernels> {
    run.kernels.iter().filter(|k| k.dimension == 2)
}

fn pairs_ns(kernels: &Kernels) -> f64 {
    kernels.pass(Pass::Pairs).map_or(f64::NAN, |p| p.ns)
}

fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share)
}

/// The smallest, and the range in words.
fn times(values: impl Iterator<Item = f64>) -> (f64, String) {
    let (low, high) = range(values);
    (low, format!("{low:.1} to {high:.1} times"))
}

/// The table of demands, in order.
#[must_use]
pub fn demands(run: &SpeedRun) -> Vec<Demand> {
    let roofline = || plane(run).filter_map(|k| k.roofline.as_ref());
    let reached = range(roofline().map(|r| r.reached));
    let own = || plane(run).filter_map(|k| k.pass(Pass::Pairs)?.times_plain);
    let cells = times(roofline().map(|r| r.times_cells));
    let flat = range(plane(run).map(pairs_ns));
    let spread = flat.1 / flat.0 - 1.0;
    let cost = |k: usize| run.column.get(k).map_or(f64::NAN, Stretch::cost);
    let ratio = run.paper_a.ratio();
    let mut demands = vec![
        Demand {
            what: "pair sweep against the roofline kernel (pairs a second, plane, h/dp 1.6, one core)",
            asked: "at least 65 %",
            measured: format!(
                "{} to {} over all sizes",
                percent(reached.0),
                percent(reached.1)
            ),
            verdict: judged(reached.0 >= 0.65),
        },
        Demand {
            what: "pair sweep against the plain scalar kernel that searches cells (pairs a second)",
            asked: "at least 4 times",
            measured: cells.1,
            verdict: judged(cells.0 >= 4.0),
        },
        Demand {
            what: "pair sweep against the plain scalar kernel over neighbour lists",
            asked: "not asked: a faster rival",
            measured: times(roofline().map(|r| r.times_plain)).1,
            verdict: Verdict::Reported,
        },
        Demand {
            what: "pair sweep against its own plain scalar form over the same lists",
            asked: "not asked: work for work",
            measured: times(own()).1,
            verdict: Verdict::Reported,
        },
        Demand {
            what: "pair sweep, cost a particle over particle counts",
            asked: "flat within 30 % from 2,000 to 500,000",
            measured: format!(
                "{:.0} to {:.0} ns, {} apart",
                flat.0,
                flat.1,
                percent(spread)
            ),
            verdict: judged(spread <= 0.3),
        },
        Demand {
            what: "column a = 0.90, exact yield: CPU time of one simulated second",
            asked: "at most 3 s",
            measured: format!("{:.2} s", cost(0)),
            verdict: judged(cost(0) <= 3.0),
        },
        Demand {
            what: "the same with the plain cap",
            asked: "at most 1.5 s",
            measured: format!("{:.2} s", cost(2)),
            verdict: judged(cost(2) <= 1.5),
        },
        Demand {
            what: "the same by `paper_a` (plain scalar sweeps) over the default, same simulated time",
            asked: "at least 250 times the CPU time",
            measured: format!(
                "{ratio:.0} times over the first {} s",
                number(run.paper_a.paper_a.simulated)
            ),
            verdict: judged(ratio >= 250.0),
        },
        Demand {
            what: "the same by `paper_a` on the same kernels",
            asked: "at least 60 times",
            measured: "there is no such form of `paper_a`".to_owned(),
            verdict: Verdict::NoResult,
        },
        Demand {
            what: "the pile at rest: CPU time of one simulated second in steps of 0.1 s, no log",
            asked: "under 2 ms",
            measured: run.rest.as_ref().map_or_else(
                || "it did not fall asleep".to_owned(),
                |r| format!("{} ms", number(1e3 * r.cpu)),
            ),
            verdict: judged(run.rest.as_ref().is_some_and(|r| r.cpu < 2e-3)),
        },
    ];
    let speed_ups = range(run.threads.iter().map(super::scenes::Threads::speed_up));
    demands.push(Demand {
        what: "two threads against one, wall time, 20,000 particles and more",
        asked: "at least 1.8 times",
        measured: format!("{:.2} to {:.2} times", speed_ups.0, speed_ups.1),
        verdict: judged(speed_ups.0 >= 1.8),
    });
    demands
}

/// The whole page. The same run gives the same bytes.
#[must_use]
pub fn text(run: &SpeedRun) -> String {
    let parts = [
        opening(run),
        kernels(run),
        roofline(run),
        column(run),
        paper_a(run),
        budget(run),
        sizes(run),
        threads(run),
        how(run),
    ];
    parts.join("\n\n") + "\n"
}

fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let mut text = format!("| {} |\n|{}\n", head.join(" | "), "---|".repeat(head.len()));
    for row in rows {
        text.push_str(&format!("| {} |\n", row.join(" | ")));
    }
    text.trim_end().to_owned()
}

fn opening(run: &SpeedRun) -> String {
    let rows: Vec<Vec<String>> = demands(run)
        .into_iter()
        .map(|d| {
            let verdict = d.verdict().to_owned();
            vec![d.what.to_owned(), d.asked.to_owned(), d.measured, verdict]
        })
        .collect();
    let warning = if run.quick {
        "**These are the small sizes and short stretches of `--quick`: they show that the measurement works and judge \
         nothing.**\n\n"
    } else {
        ""
    };
    let m = &run.machine;
    let load = m.load.map_or(String::new(), |(start, end)| {
        format!(", load {start:.1} at the start and {end:.1} at the end (1 is this measurement)")
    });
    format!(
        "{MADE}\n# Performance\n\n{warning}Where the time goes, measured by one command on {} {} ({}, AVX2 {}){load}, \
         version {}, sources {}{}, {}.\n\n{}",
        m.cores,
        if m.cores == 1 {
            format!("core of {}", m.processor)
        } else {
            format!("cores of {}", m.processor)
        },
        m.system,
        if m.avx2 { "on" } else { "off" },
        m.version,
        m.sources,
        m.commit
            .as_ref()
            .map_or(String::new(), |c| format!(", commit {c}")),
        m.date,
        table(&["measured", "asked", "came out", "verdict"], &rows)
    )
}

fn kernels(run: &SpeedRun) -> String {
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

fn roofline(run: &SpeedRun) -> String {
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

fn stretch_row(s: &Stretch) -> Vec<String> {
    vec![
        s.name.clone(),
        s.particles.to_string(),
        number(s.simulated),
        s.steps.to_string(),
        format!("{:.3}", 1e3 * s.mean_step()),
        format!("{:.2}", s.iterations_per_step()),
        number(s.cost()),
        format!("{:.0}", s.ns_per_particle_step()),
        s.asleep_from.map_or("-".to_owned(), number),
    ]
}

const STRETCH: [&str; 9] = [
    "",
    "particles",
    "simulated [s]",
    "steps",
    "mean step [ms]",
    "iterations a step",
    "CPU s a simulated s",
    "ns a particle and step",
    "asleep from [s]",
];

fn column(run: &SpeedRun) -> String {
    let rows: Vec<_> = run.column.iter().map(stretch_row).collect();
    let rest = run.rest.as_ref().map_or_else(
        || "It did not fall asleep in the time given.".to_owned(),
        |r| {
            format!(
                "Left alone it falls asleep at {} s. From then on a simulated second in ten communication steps, gauges read, \
                 costs {} ms; the same pile that is not allowed to sleep costs {} s, with {:.2} iterations a step.",
                number(r.asleep_from),
                number(1e3 * r.cpu),
                number(r.awake_cpu),
                r.awake_iterations
            )
        },
    );
    format!(
        "## The column\n\n`cases/column_collapse.toml`, a = 0.90 at the resolution of [A], communication steps of 10 ms, gauges \
         read, no log, one thread. The four settings step in turns; of each communication step the median of the repetitions \
         counts.\n\n{}\n\n{rest}",
        table(&STRETCH, &rows)
    )
}

fn paper_a(run: &SpeedRun) -> String {
    let both = &run.paper_a;
    let rows = [&both.paper_a, &both.default].map(stretch_row);
    let windows: Vec<Vec<String>> = both
        .windows
        .iter()
        .map(|(end, ratio)| vec![number(*end), format!("{ratio:.0}")])
        .collect();
    let windows = if windows.is_empty() {
        String::new()
    } else {
        format!(
            "\n\nIn windows of 20 ms, by their ends:\n\n{}",
            table(&["to [s]", "`paper_a` / default"], &windows)
        )
    };
    let lanes = run
        .kernels
        .first()
        .and_then(|k| k.pass(Pass::Pairs)?.times_plain);
    let guess = lanes.map_or(String::new(), |times| {
        format!(
            " If lanes gave its sums what they give the default's pair sweep ({times:.1} times), the ratio would be {:.0}: an \
             estimate, not a measurement.",
            both.ratio() / times
        )
    });
    format!(
        "## Against the scheme of the paper\n\n`cases/paper_a/column_3.toml` (h/dp 1.3, explicit viscosity, as printed) beside \
         the default on `cases/column_collapse.toml`, both from t = 0, in turns of 2 ms. The explicit scheme is far too slow \
         to run to the end here: it gets a budget of CPU time, and what is compared is the same stretch of simulated time, \
         from the release on. `paper_a` goes through pairs one by one, without lanes: it is the reference on plain scalar \
         sweeps, and there is no form of it on the default's kernels.{guess}\n\n{}{windows}",
        table(&STRETCH, &rows)
    )
}

/// What a step of the column is made of, by the sweeps' times at the nearest size.
fn budget(run: &SpeedRun) -> String {
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
        BINDS
    )
}

/// From profiles (`perf record`, `perf stat`) of the program, not from the stored run.
const BINDS: &str = "";

fn sizes(run: &SpeedRun) -> String {
    let rows: Vec<_> = run.sizes.iter().map(stretch_row).collect();
    format!(
        "## Against resolution\n\nThe column from its release, default settings, one thread.\n\n{}",
        table(&STRETCH, &rows)
    )
}

fn threads(run: &SpeedRun) -> String {
    let rows: Vec<Vec<String>> = run
        .threads
        .iter()
        .map(|t| {
            vec![
                t.one.particles.to_string(),
                t.one.steps.to_string(),
                t.warm_up.to_string(),
                format!("{:.2}", t.one.iterations_per_step()),
                format!("{:.3}", t.wall[0]),
                format!("{:.3}", t.wall[1]),
                format!("{:.2}", t.speed_up()),
                format!("{:.2}", t.cpu[1] / t.cpu[0]),
            ]
        })
        .collect();
    let rounds = run.threads.first().map_or(0, |t| t.rounds);
    format!(
        "## Two threads\n\nThe column at finer resolution, without gauges: some steps from its release, each round from the same saved state, \
         one thread and two in turns. Wall time, and the least of up to {rounds} rounds, since others on the machine can only \
         add to it; this machine has {} cores, so that whatever else runs takes from the second thread. Results have the same \
         bits.\n\n{}",
        run.machine.cores,
        table(
            &[
                "particles",
                "steps",
                "after steps",
                "iterations a step",
                "wall, one thread [s]",
                "wall, two [s]",
                "speed-up",
                "CPU time, two / one"
            ],
            &rows
        )
    )
}

fn how(run: &SpeedRun) -> String {
    format!(
        "## How to repeat it\n\n```\ncargo run --release -- bench speed --page docs/performance.md\n```\n\nIt takes some minutes \
         (`--quick`: seconds, judges nothing), keeps the run in `benches/runs/`, and writes this page from it; \
         `--only-page` writes the page from a kept run. `--paper-a-budget` is the CPU time that [A]'s scheme may take ({} s \
         here).\n\nTimes are CPU times of the thread (two threads: wall time too), so that other programs cost no time, though \
         they do take cache and memory from it. What is compared runs in turns, ratios are medians of the ratios within a round. \
         Do it on a machine that does nothing else, or believe the ratios more than the times.",
        number(run.paper_a.paper_a.cpu)
    )
}
