//! Members, store, queue and pages on tiny studies: resume, side by side, hashes, staleness.

use std::path::Path;
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

#[test]
fn a_member_keeps_its_series_and_particles() {
    let desk = Desk::new();
    for (event, points) in run_all(&desk) {
        assert!(matches!(event, Some(Event::Ended(Outcome::Finished, cpu)) if cpu > 0.0));
        assert_eq!(points, 10);
    }
    let first = &desk.recordings()[0];
    assert_eq!(first.time.len(), 11);
    assert_eq!((first.time[0], first.time[10]), (0.0, 0.02));
    assert_eq!(first.curve("gauge.depth.depth").len(), 11);
    assert!((first.at("gauge.depth.depth", 0.0).unwrap() - 0.024).abs() < 0.002);
    assert!(first.last("energy.kinetic").unwrap() > 0.0);
    let times: Vec<f64> = first.snapshots.iter().map(|s| s.time).collect();
    assert_eq!(times, [0.0, 0.01]);
    assert_eq!(first.snapshots[1].position.len() as u64, first.particles);
    assert!(first.steps >= 10);
}

#[test]
fn a_finished_member_is_not_run_again() {
    let desk = Desk::new();
    run_all(&desk);
    let before = desk.recordings();
    for (event, points) in run_all(&desk) {
        assert_eq!((event, points), (Some(Event::Kept), 0));
    }
    assert_eq!(desk.recordings(), before);
}

#[test]
fn jobs_side_by_side_give_what_one_after_the_other_gives() {
    let (one, three) = (Desk::new(), Desk::new());
    run_all(&one);
    three.run(3, &AtomicBool::new(false), None);
    let bare = |desk: &Desk| {
        desk.recordings()
            .into_iter()
            .map(without_clock)
            .collect::<Vec<_>>()
    };
    assert_eq!(bare(&one), bare(&three));
}

#[test]
fn an_interrupted_study_goes_on_where_it_was() {
    let (whole, broken) = (Desk::new(), Desk::new());
    run_all(&whole);
    // Stops in the middle of the second member.
    let stopped = broken.run(1, &AtomicBool::new(false), Some(14));
    assert!(matches!(stopped[0].0, Some(Event::Ended(..))));
    assert_eq!((&stopped[1].0, stopped[1].1), (&Some(Event::Saved), 4));
    assert_eq!(stopped[2].0, None);
    let went_on = run_all(&broken);
    assert_eq!(went_on[0].0, Some(Event::Kept));
    assert_eq!(went_on[1].1, 6);
    let bare = |desk: &Desk| {
        desk.recordings()
            .into_iter()
            .map(without_clock)
            .collect::<Vec<_>>()
    };
    assert_eq!(bare(&whole), bare(&broken));
}

/// A killed run leaves the part it saved last, an older one than where it was.
#[test]
fn a_killed_study_goes_on_from_its_last_save() {
    let (desk, killed) = (Desk::new(), Desk::new());
    let member = member(1);
    let job = Job {
        study: "drops",
        member: &member,
    };
    let stop = AtomicBool::new(false);
    let copy = |progress: Progress| {
        if (progress.share - 0.5).abs() < 1e-6 {
            let part = desk.store.path("drops", &member, "part");
            let there = killed.store.path("drops", &member, "part");
            std::fs::create_dir_all(there.parent().unwrap()).unwrap();
            std::fs::copy(part, there).unwrap();
        }
    };
    let whole = job
        .run(alone(&desk.store, Duration::ZERO, &stop), &copy)
        .unwrap();
    let points = Mutex::new(0);
    let count = |_| *points.lock().unwrap() += 1;
    let resumed = job
        .run(alone(&killed.store, Duration::ZERO, &stop), &count)
        .unwrap();
    // Saved at the start of the fifth step.
    assert_eq!(*points.lock().unwrap(), 6);
    assert_eq!(without_clock(whole), without_clock(resumed));
    assert!(!killed.store.path("drops", &member, "part").exists());
}

#[test]
fn a_part_cut_short_or_of_other_sources_starts_again() {
    let desk = Desk::new();
    let member = member(1);
    let job = Job {
        study: "drops",
        member: &member,
    };
    let stop = AtomicBool::new(true);
    job.run(alone(&desk.store, Duration::ZERO, &stop), &|_| {})
        .unwrap();
    let path = desk.store.path("drops", &member, "part");
    let bytes = std::fs::read(&path).unwrap();
    assert!(desk.store.part("drops", &member).is_some());
    let others = Store::new(desk.folder.path(), "sources-2");
    assert!(others.part("drops", &member).is_none());
    std::fs::write(&path, &bytes[..bytes.len() - 100]).unwrap();
    stop.store(false, Ordering::SeqCst);
    let points = Mutex::new(0);
    let done = job
        .run(alone(&desk.store, Duration::MAX, &stop), &|_| {
            *points.lock().unwrap() += 1
        })
        .unwrap();
    assert_eq!(
        (done.outcome, *points.lock().unwrap()),
        (Outcome::Finished, 10)
    );
}

#[test]
fn another_scene_plan_or_solver_is_another_member() {
    let desk = Desk::new();
    let member = member(1);
    let key = desk.store.key(&member);
    let mut scene = member.clone();
    scene.scene.push_str("\n# another text\n");
    let mut plan = member.clone();
    plan.plan.snapshots.push(0.02);
    let others = Store::new(desk.folder.path(), "sources-2");
    assert_ne!(desk.store.key(&scene), key);
    assert_ne!(desk.store.key(&plan), key);
    assert_ne!(others.key(&member), key);
    run_all(&desk);
    assert!(desk.store.current("drops", &member).is_some());
    assert!(others.current("drops", &member).is_none());
    assert!(others.any("drops", &member).is_some());
}

#[test]
fn a_scene_that_fails_is_kept_as_failed_with_its_reason() {
    let desk = Desk::new();
    // The body falls out of the domain: there is no floor.
    let text = template::Template::new(SCENE)
        .unwrap()
        .without("walls")
        .with("run.until", 0.4)
        .text()
        .unwrap();
    let member = Member::new("lost".into(), text, &SERIES, Vec::new());
    let job = Job {
        study: "drops",
        member: &member,
    };
    let stop = AtomicBool::new(false);
    let recording = job
        .run(alone(&desk.store, Duration::MAX, &stop), &|_| {})
        .unwrap();
    assert!(
        matches!(&recording.outcome, Outcome::Failed(why) if !why.is_empty()),
        "{:?}",
        recording.outcome
    );
    assert_eq!(desk.store.current("drops", &member), Some(recording));
}

#[test]
fn a_variable_that_is_not_there_is_a_defect_of_the_study() {
    let desk = Desk::new();
    let member = Member::new(
        "odd".into(),
        SCENE.into(),
        &["gauge.nowhere.depth"],
        Vec::new(),
    );
    let job = Job {
        study: "drops",
        member: &member,
    };
    let error = job
        .run(
            alone(&desk.store, Duration::MAX, &AtomicBool::new(false)),
            &|_| {},
        )
        .unwrap_err();
    assert!(error.to_string().contains("gauge.nowhere.depth"), "{error}");
}

#[test]
fn pages_say_what_was_found_and_whether_it_is_current() {
    let desk = Desk::new();
    let look = |store: &Store| Found::new(&STUDY, Effort::Full, store).unwrap();
    let pages = desk.pages();
    let page = || std::fs::read_to_string(pages.join("drops.md")).unwrap();
    page::write(&pages, &STUDY, &look(&desk.store), None).unwrap();
    assert!(
        page().contains("**no result**") && page().contains("0 of 4 runs"),
        "{}",
        page()
    );
    assert!(page().starts_with("<!-- Written by `sandgate validate`; do not edit. -->\n"));
    run_all(&desk);
    assert_eq!(
        page::standing(&pages, &STUDY, &look(&desk.store)),
        Standing::Stale
    );

    let summary = page::write(&pages, &STUDY, &look(&desk.store), None).unwrap();
    assert_eq!(
        (summary.met, summary.short, summary.missing, summary.members),
        (1, 0, 0, (4, 4))
    );
    assert_eq!(Summary::read(&page()), Some(summary));
    assert!(
        page().contains("| met |") && page().contains("drops_none.svg"),
        "{}",
        page()
    );
    assert!(pages.join("drops_none.svg").exists());
    assert_eq!(
        page::standing(&pages, &STUDY, &look(&desk.store)),
        Standing::Current
    );
    // Again from the same recordings: the same bytes.
    let before = page();
    page::write(&pages, &STUDY, &look(&desk.store), None).unwrap();
    assert_eq!(page(), before);

    // Another solver: the recordings are old, and the page says so.
    let newer = Store::new(desk.folder.path(), "sources-2");
    assert_eq!(look(&newer).outdated, 4);
    page::write(&pages, &STUDY, &look(&newer), None).unwrap();
    assert!(page().contains("4 of 4 runs are older"), "{}", page());
    page::write(
        &pages,
        &STUDY,
        &Found::new(&STUDY, Effort::Quick, &newer).unwrap(),
        None,
    )
    .unwrap();
    assert!(page().contains("judge nothing"), "{}", page());
    page::write(&pages, &STUDY, &look(&newer), None).unwrap();

    page::write_index(&pages, &[STUDY]).unwrap();
    let index = std::fs::read_to_string(pages.join("README.md")).unwrap();
    assert!(
        index.contains("[drops](drops.md)") && index.contains("met (1 of 1)"),
        "{index}"
    );
    page::write_index(Path::new(&desk.folder.path().join("empty")), &[STUDY]).unwrap();
}

/// Every member of every study is a scene, has the variables it keeps, and has a name that makes a file name.
#[test]
fn the_studies_are_sound() {
    for study in studies::ALL {
        for effort in [Effort::Full, Effort::Quick] {
            let members = (study.members)(effort).unwrap();
            assert!(!members.is_empty());
            let mut names = std::collections::BTreeSet::new();
            for member in &members {
                let job = Job {
                    study: study.name,
                    member,
                };
                let scene = job.scene().unwrap_or_else(|e| panic!("{e}"));
                let table = crate::component::VariableTable::of(&scene);
                for name in &member.plan.series {
                    assert!(
                        table.by_name(name).is_some(),
                        "{} {}: {name}",
                        study.name,
                        member.name
                    );
                }
                assert!(member.plan.snapshots.iter().all(|t| *t <= scene.run.until));
                let plain =
                    |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || "_.".contains(c);
                assert!(member.name.chars().all(plain), "{}", member.name);
                assert!(names.insert(member.name.clone()), "{} twice", member.name);
            }
            // Without a single result a page is still made, and nothing is met.
            let report = (study.analyse)(&Results::new(effort, None, Vec::new())).unwrap();
            assert_eq!(report.count(Verdict::Met), 0, "{}", study.name);
            assert!(report.count(Verdict::NoResult) > 0, "{}", study.name);
            assert_eq!(report.count(Verdict::NoResult), report.metrics.len());
        }
    }
}
