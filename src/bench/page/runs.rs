//! Whole scenes: the column, against [A]'s scheme, against resolution, on two threads.

use super::table;
use crate::bench::SpeedRun;
use crate::bench::scenes::Stretch;
use crate::validate::report::number;

pub(super) fn stretch_row(s: &Stretch) -> Vec<String> {
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

pub(super) const STRETCH: [&str; 9] = [
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

pub(super) fn column(run: &SpeedRun) -> String {
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

pub(super) fn paper_a(run: &SpeedRun) -> String {
    let both = &run.paper_a;
    let rows = [&both.paper_a, &both.lanes, &both.default].map(stretch_row);
    let windows: Vec<Vec<String>> = both
        .windows
        .iter()
        .map(|(end, ratio)| vec![number(*end), format!("{ratio:.0}")])
        .collect();
    let windows = both.windows.first().map_or(String::new(), |(length, _)| {
        format!(
            "\n\nIn windows of {} ms, by their ends:\n\n{}",
            number(1e3 * length),
            table(&["to [s]", "`paper_a`, pair by pair / default"], &windows)
        )
    });
    format!(
        "## Against the scheme of the paper\n\n`cases/paper_a/column_3.toml` (h/dp 1.3, explicit viscosity, as printed) beside \
         the default on `cases/column_collapse.toml`, all from t = 0, in turns of 2 ms. The explicit scheme gets a budget of \
         CPU time, and what is compared is the same stretch of simulated time, from the release on. It runs twice: pair by \
         pair, the plain scalar reference (`sweeps = \"plain\"`), and on the default's kernels (`sweeps = \"lanes\"`, what \
         users get).\n\n{}{windows}",
        table(&STRETCH, &rows)
    )
}

pub(super) fn sizes(run: &SpeedRun) -> String {
    let rows: Vec<_> = run.sizes.iter().map(stretch_row).collect();
    format!(
        "## Against resolution\n\nThe column from its release, default settings, one thread.\n\n{}",
        table(&STRETCH, &rows)
    )
}

pub(super) fn threads(run: &SpeedRun) -> String {
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
