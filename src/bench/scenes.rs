//! Whole scenes: what a simulated second costs, of which steps, and with how many threads.
//!
//! What is compared runs side by side: a communication step of one, then the same step of the other, so that both see the
//! same neighbours on the machine.

use serde::{Deserialize, Serialize};
use toml::Value;

use super::Error;
use super::clock::{median, timed, timed_threads};
use crate::component::Component;
use crate::scene;
use crate::validate::template::Template;

/// [A]'s column of aspect ratio 0.90 at its resolution, default scheme.
const COLUMN: &str = include_str!("../../cases/column_collapse.toml");
/// The same by [A]'s scheme as printed.
const PAPER_A: &str = include_str!("../../cases/paper_a/column_3.toml");

/// Section of that column [m^2]: 2 r0 H0.
const SECTION: f64 = 0.1944 * 0.0875;

/// How a scene went over a stretch of simulated time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Stretch {
    /// What it is.
    pub name: String,
    /// Number of particles.
    pub particles: u64,
    /// Simulated time [s].
    pub simulated: f64,
    /// CPU time [s].
    pub cpu: f64,
    /// Internal steps.
    pub steps: u64,
    /// Iterations of viscous solves.
    pub iterations: u64,
    /// When it fell asleep, if it did [s].
    pub asleep_from: Option<f64>,
}

impl Stretch {
    /// CPU time of a simulated second [s].
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.cpu / self.simulated
    }

    /// Iterations a step.
    #[must_use]
    pub fn iterations_per_step(&self) -> f64 {
        self.iterations as f64 / self.steps.max(1) as f64
    }

    /// CPU time of a particle and internal step [ns].
    #[must_use]
    pub fn ns_per_particle_step(&self) -> f64 {
        1e9 * self.cpu / (self.particles.max(1) * self.steps.max(1)) as f64
    }

    /// Mean internal step [s].
    #[must_use]
    pub fn mean_step(&self) -> f64 {
        self.simulated / self.steps.max(1) as f64
    }
}

/// A scene and how far it is.
struct Runner {
    component: Component,
    stretch: Stretch,
    /// CPU time of each communication step [s].
    cpu: Vec<f64>,
}

impl Runner {
    fn new(name: &str, template: &Template) -> Result<Self, Error> {
        let refused = |why: String| Error::Scene {
            scene: name.to_owned(),
            why,
        };
        let text = template.text().map_err(refused)?;
        let scene = scene::parse(name, &text).map_err(|e| refused(e.to_string()))?;
        let mut component = Component::new(&scene).map_err(|e| refused(e.to_string()))?;
        component
            .initialize(0.0, None)
            .map_err(|e| refused(e.to_string()))?;
        let stretch = Stretch {
            name: name.to_owned(),
            particles: component.statistics().particles,
            ..Stretch::default()
        };
        Ok(Self {
            component,
            stretch,
            cpu: Vec::new(),
        })
    }

    fn failed(&self, why: impl ToString) -> Error {
        Error::Scene {
            scene: self.stretch.name.clone(),
            why: why.to_string(),
        }
    }

    /// One communication step, timed.
    fn step(&mut self, h: f64) -> Result<(), Error> {
        let time = self.component.time();
        let (spent, done) = timed(|| self.component.do_step(time, h));
        done.map_err(|e| self.failed(e))?;
        self.cpu.push(spent);
        if self.stretch.asleep_from.is_none() && self.is_asleep() {
            self.stretch.asleep_from = Some(self.component.time());
        }
        Ok(())
    }

    fn is_asleep(&self) -> bool {
        let asleep = self.component.particles().asleep;
        !asleep.is_empty() && asleep.iter().all(|a| *a == 1)
    }

    /// What was spent so far.
    fn stretch(&self) -> Stretch {
        let figures = self.component.statistics();
        Stretch {
            simulated: self.component.time(),
            cpu: self.cpu.iter().sum(),
            steps: figures.steps,
            iterations: figures.iterations,
            ..self.stretch.clone()
        }
    }
}

fn template(text: &str, name: &str) -> Result<Template, Error> {
    Template::new(text).map_err(|why| Error::Scene {
        scene: name.to_owned(),
        why,
    })
}

/// A name, and keys with values.
type Setting<'a> = (&'a str, &'a [(&'a str, Value)]);

/// What the column costs with the exact yield and with the plain cap, sleep on and off.
///
/// Communication steps of 10 ms over `simulated` seconds, all settings in turn; all of it `repeats` times, of which each
/// step's median is taken.
///
/// # Errors
/// [`Error::Scene`] if a step fails.
pub fn column(
    simulated: f64,
    repeats: usize,
    watch: &mut dyn FnMut(f64),
) -> Result<Vec<Stretch>, Error> {
    let capped = ("numerics.yield", Value::from("capped"));
    let awake = ("numerics.sleep", Value::from(false));
    let (only_capped, only_awake) = ([capped.clone()], [awake.clone()]);
    let both = [capped, awake];
    let settings: [Setting; 4] = [
        ("exact yield (default)", &[]),
        ("exact yield, sleep off", &only_awake),
        ("plain cap", &only_capped),
        ("plain cap, sleep off", &both),
    ];
    let steps = (simulated / 0.01).round().max(1.0) as usize;
    let mut all: Vec<Vec<Runner>> = Vec::new();
    for repeat in 0..repeats.max(1) {
        let mut runners = Vec::new();
        for (name, edits) in &settings {
            let mut scene = template(COLUMN, name)?;
            for (key, value) in *edits {
                scene = scene.with(key, value.clone());
            }
            runners.push(Runner::new(name, &scene)?);
        }
        for step in 0..steps {
            for runner in &mut runners {
                runner.step(0.01)?;
            }
            watch((repeat * steps + step + 1) as f64 / (repeats.max(1) * steps) as f64);
        }
        all.push(runners);
    }
    let of = |k: usize| {
        let mut stretch = all[0][k].stretch();
        let at = |s: usize| median(&all.iter().map(|r| r[k].cpu[s]).collect::<Vec<_>>());
        stretch.cpu = (0..steps).map(at).sum();
        stretch
    };
    Ok((0..settings.len()).map(of).collect())
}

/// What the pile costs once it rests.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rest {
    /// When it fell asleep [s].
    pub asleep_from: f64,
    /// CPU time of a simulated second then, in ten communication steps, gauges read and no log: median [s].
    pub cpu: f64,
    /// CPU time of a simulated second of the same pile that is not allowed to sleep [s].
    pub awake_cpu: f64,
    /// Iterations of viscous solves a step of that.
    pub awake_iterations: f64,
}

/// Runs the column until it sleeps, `latest` seconds at most, then times it; `None` if it did not fall asleep.
///
/// # Errors
/// [`Error::Scene`] if a step fails.
pub fn rest(latest: f64, watch: &mut dyn FnMut(f64)) -> Result<Option<Rest>, Error> {
    let name = "pile at rest";
    let mut sleeper = Runner::new(name, &template(COLUMN, name)?)?;
    let scene = template(COLUMN, name)?.with("numerics.sleep", false);
    let mut awake = Runner::new("pile at rest, sleep off", &scene)?;
    while sleeper.stretch.asleep_from.is_none() && sleeper.component.time() < latest {
        sleeper.step(0.1)?;
        awake.step(0.1)?;
        watch(sleeper.component.time() / latest);
    }
    let Some(asleep_from) = sleeper.stretch.asleep_from else {
        return Ok(None);
    };
    let before = awake.stretch();
    let mut seconds = Vec::new();
    for _ in 0..5 {
        sleeper.cpu.clear();
        for _ in 0..10 {
            sleeper.step(0.1)?;
        }
        seconds.push(sleeper.cpu.iter().sum());
    }
    for _ in 0..10 {
        awake.step(0.1)?;
    }
    let after = awake.stretch();
    Ok(Some(Rest {
        asleep_from,
        cpu: median(&seconds),
        awake_cpu: after.cpu - before.cpu,
        awake_iterations: (after.iterations - before.iterations) as f64
            / (after.steps - before.steps).max(1) as f64,
    }))
}

/// [A]'s scheme as printed beside the default, over the same simulated time from the start.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AgainstPaperA {
    /// [A]'s scheme.
    pub paper_a: Stretch,
    /// The default with the exact yield.
    pub default: Stretch,
    /// Ends of the windows [s], and in each CPU time of [A]'s scheme over that of the default.
    pub windows: Vec<(f64, f64)>,
}

impl AgainstPaperA {
    /// CPU time of [A]'s scheme over that of the default.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.paper_a.cpu / self.default.cpu
    }
}

/// Steps both in turn until [A]'s scheme has taken `budget` CPU seconds or `latest` simulated seconds are over.
///
/// # Errors
/// [`Error::Scene`] if a step fails.
pub fn against_paper_a(
    budget: f64,
    latest: f64,
    watch: &mut dyn FnMut(f64),
) -> Result<AgainstPaperA, Error> {
    /// Communication step [s]: short, so that the budget is kept; a few internal steps of the default.
    const STEP: f64 = 0.002;
    let mut paper_a = Runner::new("paper_a", &template(PAPER_A, "paper_a")?)?;
    let mut default = Runner::new("default", &template(COLUMN, "default")?)?;
    let mut spent = 0.0;
    while spent < budget && paper_a.component.time() < latest - 0.5 * STEP {
        paper_a.step(STEP)?;
        default.step(STEP)?;
        spent += paper_a.cpu.last().copied().unwrap_or(f64::INFINITY);
        watch((spent / budget).max(paper_a.component.time() / latest));
    }
    let ends = 1..=paper_a.cpu.len();
    let windows = ends.clone().filter(|n| n % 10 == 0).map(|n| {
        let of = |cpu: &[f64]| cpu[n - 10..n].iter().sum::<f64>();
        (n as f64 * STEP, of(&paper_a.cpu) / of(&default.cpu))
    });
    Ok(AgainstPaperA {
        windows: windows.collect(),
        paper_a: paper_a.stretch(),
        default: default.stretch(),
    })
}

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
    let numerics = &runner.component.scene().numerics;
    let bound =
        numerics.courant * numerics.smoothing_ratio * numerics.spacing / numerics.sound_speed;
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

/// The column at half and a quarter of the spacing over the same simulated time: cost and iterations against size.
///
/// # Errors
/// [`Error::Scene`] if a step fails.
pub fn sizes(
    refinements: &[f64],
    simulated: f64,
    watch: &mut dyn FnMut(f64),
) -> Result<Vec<Stretch>, Error> {
    let work = |r: f64| r.powi(3);
    let total: f64 = refinements.iter().map(|r| work(*r)).sum();
    let mut done = 0.0;
    let mut found = Vec::new();
    for &refinement in refinements {
        let dp = 3.02e-3 / refinement;
        let name = format!("dp = {:.3} mm", 1e3 * dp);
        let mut runner = Runner::new(
            &name,
            &template(COLUMN, &name)?.with("numerics.spacing", dp),
        )?;
        while runner.component.time() < simulated - 0.005 {
            runner.step(0.01)?;
            let share = runner.component.time() / simulated;
            watch((done + share * work(refinement)) / total);
        }
        done += work(refinement);
        found.push(runner.stretch());
    }
    Ok(found)
}
