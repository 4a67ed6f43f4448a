//! Unit benchmarks: each part of a step and of what surrounds it, by particle count, in the plane and in space. Runs are
//! kept, and two of them, of two commits, compared.

mod component;

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::clock::{median, timed};
use super::{Error, Machine, kernels};
use crate::material::grain_compression;
use crate::validate::report::number;
use component::Size;

/// One part at one size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Unit {
    /// What is timed.
    pub name: String,
    /// 2 or 3.
    pub dimension: usize,
    /// Particles.
    pub particles: usize,
    /// CPU time of one call, median of rounds [s].
    pub seconds: f64,
    /// Least and largest of the rounds [s].
    pub spread: (f64, f64),
}

/// A stored run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnitsRun {
    /// Where and when.
    pub machine: Machine,
    /// All parts.
    pub units: Vec<Unit>,
}

/// Sizes asked for: a full run, and one that takes seconds.
#[must_use]
pub fn sizes(quick: bool) -> [&'static [usize]; 2] {
    if quick {
        [&[300, 1_000], &[500]]
    } else {
        [
            &[1_000, 10_000, 100_000, 1_000_000],
            &[1_000, 10_000, 100_000, 1_000_000],
        ]
    }
}

/// Times everything; `folder` takes the logs that are written and removed. `watch` hears the share done and what is next.
///
/// # Errors
/// [`Error::Scene`], [`Error::File`].
pub fn run(
    quick: bool,
    folder: &Path,
    watch: &mut dyn FnMut(f64, &str),
) -> Result<UnitsRun, Error> {
    let mut run = UnitsRun {
        machine: Machine::here(),
        units: Vec::new(),
    };
    std::fs::create_dir_all(folder).map_err(|source| Error::File {
        action: "make folder",
        path: folder.to_path_buf(),
        source,
    })?;
    let [plane, space] = sizes(quick);
    let cost = |(dimension, n): &(usize, usize)| (*n * (4 * dimension - 7)) as f64;
    let plane = plane.iter().map(|n| (2, *n));
    let jobs: Vec<(usize, usize)> = plane.chain(space.iter().map(|n| (3, *n))).collect();
    let total: f64 = jobs.iter().map(cost).sum();
    let mut done = 0.0;
    for job in jobs {
        let (dimension, count) = job;
        let what = format!("{count} particles, {dimension} dimensions");
        watch(done / total, &what);
        let rounds = if quick { 2 } else { rounds(count) };
        if dimension == 2 {
            sweeps::<2>(count, rounds, &mut run.units);
        } else {
            sweeps::<3>(count, rounds, &mut run.units);
        }
        watch((done + 0.3 * cost(&job)) / total, &what);
        let size = Size {
            dimension,
            count,
            rounds,
        };
        component::measure(size, folder, &mut run.units)?;
        done += cost(&job);
    }
    run.machine.finish();
    Ok(run)
}

/// Large ones take long and scatter little.
fn rounds(count: usize) -> usize {
    (3_000_000 / count).clamp(3, 21)
}

/// Lists, sweeps and the equation of state.
fn sweeps<const D: usize>(count: usize, rounds: usize, units: &mut Vec<Unit>) {
    let kernels = kernels::measure::<D>(count, rounds, &mut |_| ());
    for pass in &kernels.passes {
        let seconds = 1e-9 * pass.ns * kernels.particles as f64;
        let name = match pass.name.as_str() {
            "lists" => "neighbour search".to_owned(),
            "stress" | "force" => format!("viscous solve, {} sweep", pass.name),
            other => format!("{other} sweep"),
        };
        units.push(Unit {
            name,
            dimension: D,
            particles: kernels.particles,
            seconds,
            spread: (seconds, seconds),
        });
    }
    // Loose, resting and compressed, sheared a little and a lot.
    let at = |i: usize| (0.8 + 0.21 * (i % 97) as f64 / 96.0, 1e-6 * (i % 89) as f64);
    let mut sum = 0.0;
    units.push(unit(
        "equation of state",
        D,
        kernels.particles,
        rounds,
        || {
            for i in 0..kernels.particles {
                let (r, b) = at(i);
                sum += grain_compression::<D>(r, b, 5.0 / 6.0);
            }
        },
    ));
    // The optimiser must not see that nobody reads it.
    std::hint::black_box(sum);
}

/// Times a call in rounds.
fn unit(
    name: &str,
    dimension: usize,
    particles: usize,
    rounds: usize,
    mut work: impl FnMut(),
) -> Unit {
    work();
    // Short calls are repeated until the clock sees them.
    let (once, ()) = timed(&mut work);
    let repeats = (2e-4 / once.max(1e-8)).ceil().clamp(1.0, 2e4) as usize;
    let times: Vec<f64> = (0..rounds)
        .map(|_| timed(|| (0..repeats).for_each(|_| work())).0 / repeats as f64)
        .collect();
    let least = times.iter().copied().fold(f64::INFINITY, f64::min);
    let most = times.iter().copied().fold(0.0, f64::max);
    Unit {
        name: name.to_owned(),
        dimension,
        particles,
        seconds: median(&times),
        spread: (least, most),
    }
}

/// A table of a run, or of two with the ratio of the second to the first.
#[must_use]
pub fn table(first: &UnitsRun, second: Option<&UnitsRun>) -> String {
    let of = |m: &Machine| {
        let commit = m.commit.clone().unwrap_or_else(|| "no commit".to_owned());
        format!("{commit} ({}, sources {})", m.date, m.sources)
    };
    let mut text = format!("first:  {}\n", of(&first.machine));
    if let Some(second) = second {
        text += &format!("second: {}\n", of(&second.machine));
        if first.machine.processor != second.machine.processor {
            text += "not the same processor: ratios say little\n";
        }
    }
    text += &format!(
        "{:46} {:>3} {:>9} {:>12} {:>14}{}\n",
        "unit",
        "dim",
        "particles",
        "CPU",
        "ns a particle",
        if second.is_some() {
            "  second/first"
        } else {
            ""
        }
    );
    for u in &first.units {
        let other = second.and_then(|run| {
            let same = |o: &&Unit| {
                o.name == u.name && o.dimension == u.dimension && o.particles == u.particles
            };
            run.units.iter().find(same)
        });
        let ratio = match (second, other) {
            (None, _) => String::new(),
            (_, None) => "  not there".to_owned(),
            (_, Some(o)) => format!("  {:.3}", o.seconds / u.seconds),
        };
        text += &format!(
            "{:46} {:>3} {:>9} {:>9} ms {:>14}{ratio}\n",
            u.name,
            u.dimension,
            u.particles,
            number(1e3 * u.seconds),
            number(1e9 * u.seconds / u.particles as f64)
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_part_is_timed_and_two_runs_compare() {
        let folder = temp_dir::TempDir::new().unwrap();
        let mut units = Vec::new();
        sweeps::<2>(300, 2, &mut units);
        for (dimension, count) in [(2, 300), (3, 500)] {
            let size = Size {
                dimension,
                count,
                rounds: 2,
            };
            component::measure(size, folder.path(), &mut units).unwrap();
        }
        for name in [
            "neighbour search",
            "equation of state",
            "save",
            "log of all particles",
        ] {
            let found = units.iter().find(|u| u.name == name);
            assert!(found.unwrap().seconds > 0.0, "{name}");
        }
        let first = UnitsRun {
            machine: Machine::here(),
            units,
        };
        let mut second = first.clone();
        second.units[0].seconds *= 2.0;
        second.units.pop();
        let text = table(&first, Some(&second));
        assert!(
            text.contains("  2.000") && text.contains("  1.000"),
            "{text}"
        );
        assert!(text.contains("not there"), "{text}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
