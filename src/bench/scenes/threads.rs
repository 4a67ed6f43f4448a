//! The column at finer resolution on one thread and on two.

use serde::{Deserialize, Serialize};

use super::{COLUMN, Runner, Stretch, template};
use crate::bench::Error;
use crate::bench::clock::{median, timed_threads};

/// Section of the column [m^2]: 2 r0 H0.
const SECTION: f64 = 0.1944 * 0.0875;

/// The column at finer resolution, on one and on two threads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Threads {
    /// The steps that were timed, on one thread.
    pub one: Stretch,
    /// Wall time of them, on one thread and on two: the least of the rounds, which others on the machine disturbed least [s].
    pub wall: [f64; 2],
    /// CPU time of them, on one thread and on two: medians [s].
    pub cpu: [f64; 2],
    /// Rounds.
    pub rounds: usize,
    /// Steps before those that were timed.
    pub warm_up: u64,
}

impl Threads {
    /// Wall time of one thread over that of two.
    #[must_use]
    pub fn speed_up(&self) -> f64 {
        self.wall[0] / self.wall[1]
    }
}

/// Spacing at which the column has about so many particles [m].
fn spacing(particles: f64) -> f64 {
    (SECTION / particles).sqrt()
}

/// Times `steps` internal steps of the column with about `particles` particles after `warm_up` steps, on one and two threads
/// in turn, each from the same saved state.
///
/// # Errors
/// [`Error::Scene`] if a step fails.
pub fn threads(
    particles: f64,
    (warm_up, steps): (usize, usize),
    rounds: usize,
    watch: &mut dyn FnMut(f64),
) -> Result<Threads, Error> {
    let name = format!("{particles} particles");
    // Gauges are read in the calling thread, once a communication step: here that would be once a few internal steps.
    let scene = template(COLUMN, &name)?
        .with("numerics.spacing", spacing(particles))
        .without("gauges");
    let mut runner = Runner::new(&name, &scene)?;
    let bound = runner.component.scene().numerics.longest_step();
    let total = (warm_up + 2 * rounds * steps) as f64;
    for step in 0..warm_up {
        runner.step(bound)?;
        watch(step as f64 / total);
    }
    let saved = runner.component.save().map_err(|e| runner.failed(e))?;
    let before = runner.stretch();
    let mut one = before.clone();
    let (mut wall, mut cpu) = ([const { Vec::new() }; 2], [const { Vec::new() }; 2]);
    for round in 0..rounds {
        for (k, count) in [1, 2].into_iter().enumerate() {
            let restored = runner.component.restore(&saved);
            restored.map_err(|e| runner.failed(e))?;
            runner.component.set_threads(count);
            let time = runner.component.time();
            let h = steps as f64 * bound;
            let (seconds, spent, done) = timed_threads(|| runner.component.do_step(time, h));
            done.map_err(|e| runner.failed(e))?;
            wall[k].push(seconds);
            cpu[k].push(spent);
            one = runner.stretch();
            watch((warm_up + (2 * round + k + 1) * steps) as f64 / total);
        }
    }
    let least = |v: &Vec<f64>| v.iter().copied().fold(f64::INFINITY, f64::min);
    let cpu = cpu.each_ref().map(|v| median(v));
    one.simulated -= before.simulated;
    one.steps -= before.steps;
    one.iterations -= before.iterations;
    one.cpu = cpu[0];
    Ok(Threads {
        one,
        wall: wall.each_ref().map(least),
        cpu,
        rounds,
        warm_up: before.steps,
    })
}
