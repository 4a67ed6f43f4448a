//! Members, store, queue and pages on tiny studies: resume, side by side, hashes, staleness.

mod pages;
mod runs;
mod sound;

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use temp_dir::TempDir;

use super::member::Job;
use super::page::{self, Found, Standing, Summary};
use super::queue::{self, Event};
use super::*;

/// A drop of sand on a floor: some forty particles, ten communication points.
const SCENE: &str = r#"
name = "drop"
title = "Drop of sand"
dimension = 2
[domain]
lower = [-0.1, -0.05]
upper = [0.1, 0.1]
[numerics]
spacing = "4 mm"
seed = 1
[materials.sand]
law = "mu_i"
preset = "sand_04"
[bodies.drop]
material = "sand"
box = { lower = [-0.012, 0], upper = [0.012, 0.024] }
[walls.floor]
polyline = [[-0.1, 0], [0.1, 0]]
[gauges.depth]
kind = "depth"
foot = [0, 0]
[run]
step = 0.002
until = 0.02
"#;

const SERIES: [&str; 2] = ["gauge.depth.depth", "energy.kinetic"];

fn member(seed: i64) -> Member {
    let template = template::Template::new(SCENE)
        .unwrap()
        .with("numerics.seed", seed);
    Member::new(
        format!("seed{seed}"),
        template.text().unwrap(),
        &SERIES,
        vec![0.0, 0.01],
    )
}

fn members(_: Effort) -> Result<Vec<Member>, String> {
    Ok((1..=4).map(member).collect())
}

/// Judges the depth of the first member.
fn analyse(results: &Results) -> Result<Report, String> {
    let depth = results
        .finished("seed1")
        .and_then(|r| r.last("gauge.depth.depth"));
    Ok(Report {
        metrics: vec![
            Metric::new(
                "depth",
                depth,
                Rule::Between(0.001, 0.03),
                "a drop is no taller than it was",
            )
            .unit("m"),
        ],
        figures: vec![Figure {
            name: "none".into(),
            caption: "nothing".into(),
            svg: "<svg/>\n".into(),
        }],
        ..Report::default()
    })
}

const STUDY: Study = Study {
    name: "drops",
    title: "Drops",
    about: "Drops of sand.",
    members,
    analyse,
};

struct Desk {
    folder: TempDir,
    store: Store,
}

impl Desk {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        let store = Store::new(folder.path(), "sources-1");
        Self { folder, store }
    }

    fn pages(&self) -> std::path::PathBuf {
        self.folder.path().join("pages")
    }

    /// Runs all members; answers each job's last event and how many communication points it stepped.
    fn run(
        &self,
        jobs: usize,
        stop: &AtomicBool,
        after: Option<usize>,
    ) -> Vec<(Option<Event>, usize)> {
        let members = members(Effort::Full).unwrap();
        let list: Vec<Job> = members
            .iter()
            .map(|member| Job {
                study: "drops",
                member,
            })
            .collect();
        let seen = Mutex::new(vec![(None, 0); list.len()]);
        let total = Mutex::new(0);
        let plan = queue::Plan {
            store: &self.store,
            jobs,
            threads: if jobs == 1 { 2 } else { 1 },
            saved_every: Duration::ZERO,
            stop,
        };
        queue::run(plan, &list, &|index, event| {
            let mut seen = seen.lock().unwrap();
            if let Event::Advanced(_) = event {
                seen[index].1 += 1;
                let mut total = total.lock().unwrap();
                *total += 1;
                if after == Some(*total) {
                    stop.store(true, Ordering::SeqCst);
                }
            }
            seen[index].0 = Some(event);
        })
        .unwrap();
        seen.into_inner().unwrap()
    }

    fn recordings(&self) -> Vec<Recording> {
        let found = Found::new(&STUDY, Effort::Full, &self.store).unwrap();
        found.recordings.into_iter().map(Option::unwrap).collect()
    }
}

fn run_all(desk: &Desk) -> Vec<(Option<Event>, usize)> {
    desk.run(1, &AtomicBool::new(false), None)
}

/// One job on one thread.
fn alone<'a>(store: &'a Store, saved_every: Duration, stop: &'a AtomicBool) -> queue::Plan<'a> {
    queue::Plan {
        store,
        jobs: 1,
        threads: 1,
        saved_every,
        stop,
    }
}

/// Everything but the clock and what it counted.
fn without_clock(mut recording: Recording) -> Recording {
    recording.cpu = 0.0;
    recording.threads = 1;
    recording
}
