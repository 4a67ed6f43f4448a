//! Whole scenes: what a simulated second costs, of which steps, and with how many threads.
//!
//! What is compared runs side by side: a communication step of one, then the same step of the other, so that both see the
//! same neighbours on the machine.

mod against;
mod column;
mod phases;
mod threads;

pub use against::{AgainstPaperA, against_paper_a};
pub use column::{Rest, column, rest, sizes};
pub use phases::{Phases, phases};
pub use threads::{Threads, threads};

use serde::{Deserialize, Serialize};

use super::Error;
use super::clock::{median, timed};
use crate::component::Component;
use crate::scene;
use crate::validate::template::Template;

/// [A]'s column of aspect ratio 0.90 at its resolution, default scheme.
const COLUMN: &str = include_str!("../../cases/column_collapse.toml");

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

/// What [`in_turns`] found.
struct Turns {
    /// Each scene, with the medians of its steps.
    stretches: Vec<Stretch>,
    /// Where each scene is at the end.
    ends: Vec<Runner>,
}

/// Steps scenes over `simulated` seconds in communication steps of 10 ms, one after the other in each, all of it `repeats`
/// times: of each communication step the median counts.
fn in_turns(
    scenes: &[(&str, Template)],
    simulated: f64,
    repeats: usize,
    watch: &mut dyn FnMut(f64),
) -> Result<Turns, Error> {
    let steps = (simulated / 0.01).round().max(1.0) as usize;
    let mut all: Vec<Vec<Runner>> = Vec::new();
    for repeat in 0..repeats.max(1) {
        let runners = scenes.iter().map(|(name, scene)| Runner::new(name, scene));
        let mut runners = runners.collect::<Result<Vec<_>, _>>()?;
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
    Ok(Turns {
        stretches: (0..scenes.len()).map(of).collect(),
        ends: all.swap_remove(0),
    })
}
