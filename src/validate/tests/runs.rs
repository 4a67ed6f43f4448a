//! Members that are run, kept, interrupted, resumed and refused.

use super::*;

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
