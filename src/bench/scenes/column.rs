//! The column: with other settings, at rest, at other resolutions.

use serde::{Deserialize, Serialize};
use toml::Value;

use super::{COLUMN, Runner, Stretch, in_turns, template};
use crate::bench::Error;
use crate::bench::clock::median;
use crate::validate::template::Template;

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
    let edited = settings.iter().map(|(name, edits)| {
        let with = |scene: Template, (key, value): &(&str, Value)| scene.with(key, value.clone());
        let scene = edits.iter().fold(template(COLUMN, name)?, with);
        Ok((*name, scene))
    });
    let scenes = edited.collect::<Result<Vec<_>, Error>>()?;
    Ok(in_turns(&scenes, simulated, repeats, watch)?.stretches)
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
