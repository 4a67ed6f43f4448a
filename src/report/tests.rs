//! Pages of logs made on the spot.

use super::gather::Gathered;
use crate::component::{Component, saved_checksum};
use crate::record::{RecordOptions, Recorder};
use crate::scene;
use std::path::Path;

/// One step, three that are taken back and two more; answers the internal steps of those that count.
fn run_with_steps_taken_back(log: &Path) -> u64 {
    let text = include_str!("../../tests/scenes/small_silo.toml");
    let scene = scene::parse("small_silo.toml", text).unwrap();
    let mut component = Component::new(&scene).unwrap();
    let options = RecordOptions {
        particles_every: 0.005,
        ..RecordOptions::of(&component)
    };
    let mut recorder = Recorder::create(log, &component, options).unwrap();
    component.initialize(0.0, None).unwrap();
    recorder
        .record_initialization(&component, 0.0, None, "test")
        .unwrap();
    let step = |component: &mut Component, recorder: &mut Recorder| {
        let t = component.time();
        let report = component.do_step(t, 0.005).unwrap();
        recorder
            .record_step(component, &report, t, 0.005, "test")
            .unwrap();
    };
    step(&mut component, &mut recorder);
    let state = component.save().unwrap();
    let sum = saved_checksum(&state).unwrap();
    recorder.record_save(&component, &sum, "test").unwrap();
    for _ in 0..3 {
        step(&mut component, &mut recorder);
    }
    component.restore(&state).unwrap();
    recorder.record_restore(&component, &sum, "test").unwrap();
    for _ in 0..2 {
        step(&mut component, &mut recorder);
    }
    recorder.finish(&component, "finished").unwrap();
    component.steps()
}

#[test]
fn what_an_importer_took_back_is_on_no_curve_and_in_no_picture() {
    let folder = temp_dir::TempDir::new().unwrap();
    let log = folder.path().join("run.mcap");
    let steps = run_with_steps_taken_back(&log);
    let gathered = Gathered::read(&log, 1_000_000).unwrap();
    let data = gathered.json();
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        let list = value.as_array().unwrap().iter();
        list.map(|v| v.as_f64().unwrap()).collect()
    };
    let times = numbers(&data["time"]);
    assert_eq!(times.len(), 4, "{times:?}");
    // The scripts find figures by the number of the row.
    for (name, column) in data["stats"].as_object().unwrap() {
        assert_eq!(column.as_array().unwrap().len(), times.len(), "{name}");
    }
    let substeps = numbers(&data["stats"]["total_substeps"]);
    assert_eq!(substeps.last().copied(), Some(steps as f64));
    // The player looks for the snapshot of a time; its times are rounded to nanoseconds.
    let shots = data["snapshots"].as_array().unwrap().iter();
    let shots: Vec<f64> = shots.map(|s| s["time"].as_f64().unwrap()).collect();
    assert_eq!(shots.len(), times.len(), "{shots:?}");
    for (shot, time) in shots.iter().zip(&times) {
        assert!((shot - time).abs() < 1e-9, "{shots:?} for {times:?}");
    }
    // The start, one, three, the state again and two more: all are lines of the log.
    assert_eq!(data["lines_checked"], 8);
    assert_eq!(data["mass_error"], 0.0);
}

/// Five steps, five more and two; a run that looks elsewhere goes back to the fifth after the tenth, tries three other steps, and
/// goes forth to the tenth again.
fn run(log: &Path, elsewhere: bool) {
    let text = include_str!("../../tests/scenes/small_silo.toml");
    let scene = scene::parse("small_silo.toml", text).unwrap();
    let mut component = Component::new(&scene).unwrap();
    let options = RecordOptions {
        particles_every: 0.005,
        ..RecordOptions::of(&component)
    };
    let mut recorder = Recorder::create(log, &component, options).unwrap();
    component.initialize(0.0, None).unwrap();
    recorder
        .record_initialization(&component, 0.0, None, "test")
        .unwrap();
    let gate = component.variables().by_name("gate.main.opening").unwrap();
    let gate = [gate.reference];
    let steps = |component: &mut Component, recorder: &mut Recorder, count, opening: f64| {
        for _ in 0..count {
            component.set(&gate, &[opening]).unwrap();
            recorder.record_inputs(component, &gate, &[opening], "test");
            let t = component.time();
            let report = component.do_step(t, 0.005).unwrap();
            recorder
                .record_step(component, &report, t, 0.005, "test")
                .unwrap();
        }
    };
    let save = |component: &Component, recorder: &mut Recorder| {
        let state = component.save().unwrap();
        let sum = saved_checksum(&state).unwrap();
        recorder.record_save(component, &sum, "test").unwrap();
        (state, sum)
    };
    steps(&mut component, &mut recorder, 5, 0.25);
    let early = save(&component, &mut recorder);
    steps(&mut component, &mut recorder, 5, 0.5);
    let late = save(&component, &mut recorder);
    if elsewhere {
        for ((state, sum), tried) in [(early, 3), (late, 0)] {
            component.restore(&state).unwrap();
            recorder.record_restore(&component, &sum, "test").unwrap();
            steps(&mut component, &mut recorder, tried, 1.0);
        }
    }
    steps(&mut component, &mut recorder, 2, 0.75);
    recorder.finish(&component, "finished").unwrap();
}

#[test]
fn the_page_of_a_run_that_went_back_and_forth_is_that_of_one_that_did_not() {
    let folder = temp_dir::TempDir::new().unwrap();
    let [straight, back] = [false, true].map(|elsewhere| {
        let log = folder.path().join(format!("{elsewhere}.mcap"));
        run(&log, elsewhere);
        Gathered::read(&log, 1_000_000).unwrap().json()
    });
    assert_eq!(straight["time"].as_array().unwrap().len(), 13);
    for part in [
        "time",
        "step",
        "columns",
        "stats",
        "bound_by",
        "snapshots",
        "scale",
    ] {
        assert_eq!(straight[part], back[part], "{part}");
    }
}

/// An importer sets parameters once its log has begun; particles are drawn as large as they are, and the page says what was set.
#[test]
fn parameters_that_are_not_the_scenes_are_told_and_drawn() {
    let folder = temp_dir::TempDir::new().unwrap();
    let log = folder.path().join("run.mcap");
    let text = include_str!("../../tests/scenes/small_silo.toml");
    let scene = scene::parse("small_silo.toml", text).unwrap();
    let mut component = Component::new(&scene).unwrap();
    let options = RecordOptions::of(&component);
    let mut recorder = Recorder::create(&log, &component, options).unwrap();
    let scale = component.variables().by_name("solver.resolution_scale");
    let scale = scale.unwrap().reference;
    component.set(&[scale], &[0.5]).unwrap();
    component.initialize(0.0, None).unwrap();
    recorder
        .record_initialization(&component, 0.0, None, "test")
        .unwrap();
    let report = component.do_step(0.0, 0.005).unwrap();
    recorder
        .record_step(&component, &report, 0.0, 0.005, "test")
        .unwrap();
    recorder.finish(&component, "finished").unwrap();
    let data = Gathered::read(&log, 1_000_000).unwrap().json();
    assert_eq!(data["spacing"], 2.0 * scene.numerics.spacing);
    assert_eq!(data["end"]["parameters"], "solver.resolution_scale = 0.5");
    assert_eq!(data["run"]["parameters"], serde_json::Value::Null);
}
