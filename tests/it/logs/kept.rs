//! Logs of runs that went back and forth: what is made of them is the trajectory that was kept.

use super::{SCENE, log};
use crate::python;
use sandgate::component::{Component, saved_checksum};
use sandgate::record::{RecordOptions, Recorder};
use sandgate::scene;
use std::collections::BTreeMap;
use std::path::Path;

const H: f64 = 0.005;

/// A component that is logged.
struct Run {
    component: Component,
    recorder: Recorder,
}

impl Run {
    fn start(path: &Path, particles_every: f64) -> Self {
        Self::start_at(path, particles_every, 0.0)
    }

    fn start_at(path: &Path, particles_every: f64, start: f64) -> Self {
        let scene = scene::load(&python::root().join(SCENE)).unwrap();
        let mut component = Component::new(&scene).unwrap();
        let options = RecordOptions {
            particles_every,
            ..RecordOptions::of(&component)
        };
        let mut recorder = Recorder::create(path, &component, options).unwrap();
        component.initialize(start, None).unwrap();
        recorder
            .record_initialization(&component, start, None, "test")
            .unwrap();
        Self {
            component,
            recorder,
        }
    }

    fn gate(&self) -> u32 {
        let gate = self.component.variables().by_name("gate.main.opening");
        gate.unwrap().reference
    }

    fn steps(&mut self, count: usize, opening: f64) {
        let (gate, source) = (self.gate(), "test");
        for _ in 0..count {
            let Self {
                component,
                recorder,
            } = self;
            component.set(&[gate], &[opening]).unwrap();
            recorder.record_inputs(component, &[gate], &[opening], source);
            let t = component.time();
            let report = component.do_step(t, H).unwrap();
            recorder
                .record_step(component, &report, t, H, source)
                .unwrap();
        }
    }

    fn save(&mut self) -> Vec<u8> {
        let state = self.component.save().unwrap();
        let sum = saved_checksum(&state).unwrap();
        self.recorder
            .record_save(&self.component, &sum, "test")
            .unwrap();
        state
    }

    fn restore(&mut self, state: &[u8]) {
        self.component.restore(state).unwrap();
        let sum = saved_checksum(state).unwrap();
        self.recorder
            .record_restore(&self.component, &sum, "test")
            .unwrap();
    }

    fn finish(self) {
        self.recorder.finish(&self.component, "finished").unwrap();
    }
}

/// Ten steps and two more; a run that looks elsewhere goes back to the fifth in between, tries so many other steps, and goes
/// forth to the tenth again.
fn run(path: &Path, elsewhere: Option<usize>) {
    let mut run = Run::start(path, H);
    run.steps(5, 0.25);
    let early = run.save();
    run.steps(5, 0.5);
    let late = run.save();
    if let Some(steps) = elsewhere {
        run.restore(&early);
        run.steps(steps, 1.0);
        run.restore(&late);
    }
    run.steps(2, 0.75);
    run.finish();
}

/// The table and the files for ParaView by name.
fn exported(log_path: &Path) -> (String, BTreeMap<String, Vec<u8>>) {
    let [csv, vtk] = ["csv", "vtk"].map(|ending| log_path.with_extension(ending));
    let path = |path: &Path| path.display().to_string();
    log(&[
        "export",
        &path(log_path),
        "--csv",
        &path(&csv),
        "--vtk",
        &path(&vtk),
    ]);
    let files = std::fs::read_dir(vtk).unwrap().map(|entry| {
        let entry = entry.unwrap();
        let name = entry.file_name().into_string().unwrap();
        (name, std::fs::read(entry.path()).unwrap())
    });
    (std::fs::read_to_string(csv).unwrap(), files.collect())
}

#[test]
fn what_is_exported_of_a_run_that_went_back_and_forth_is_that_of_one_that_did_not() {
    let folder = temp_dir::TempDir::new().unwrap();
    let straight = folder.path().join("straight.mcap");
    run(&straight, None);
    let (table, files) = exported(&straight);
    assert_eq!(table.lines().count(), 14);
    // Thirteen points, each with particles and, as there is a gate, walls; and the two lists.
    assert_eq!(files.len(), 2 * 13 + 2, "{:?}", files.keys());
    // Of a few steps the snapshot of the tenth is due again, of many it is not.
    for steps in [3, 7] {
        let path = folder.path().join(format!("elsewhere_{steps}.mcap"));
        run(&path, Some(steps));
        let (own_table, own_files) = exported(&path);
        assert_eq!(own_table, table);
        assert!(
            own_files.keys().eq(files.keys()),
            "{:?} and {:?}",
            own_files.keys(),
            files.keys()
        );
        for (name, bytes) in &files {
            assert!(own_files[name] == *bytes, "{name} is another");
        }
    }
}

#[test]
fn pictures_have_one_snapshot_a_time_where_each_step_is_tried_three_times() {
    let folder = temp_dir::TempDir::new().unwrap();
    let path = folder.path().join("tried.mcap");
    let mut run = Run::start(&path, H);
    for _ in 0..4 {
        let state = run.save();
        for opening in [0.0, 1.0] {
            run.steps(1, opening);
            run.restore(&state);
        }
        run.steps(1, 0.5);
    }
    run.finish();
    let (table, files) = exported(&path);
    let openings = table.lines().skip(1).map(|line| line.split(',').nth(1));
    assert_eq!(openings.skip(1).collect::<Vec<_>>(), [Some("0.5"); 4]);
    for list in ["particles.pvd", "walls.pvd"] {
        let times = times_in(&files[list]);
        assert_eq!(times.len(), 5, "{list}: {times:?}");
        assert!(times.is_sorted_by(|a, b| a < b), "{list}: {times:?}");
    }
}

/// Times of a collection of pictures [s].
fn times_in(list: &[u8]) -> Vec<f64> {
    let text = std::str::from_utf8(list).unwrap();
    let times = text.split("timestep=\"").skip(1);
    times
        .map(|rest| rest.split('"').next().unwrap().parse().unwrap())
        .collect()
}

/// Messages before 0 have 0 as their time in the file, pictures their own.
#[test]
fn pictures_of_a_run_that_starts_before_0_have_their_own_times() {
    let folder = temp_dir::TempDir::new().unwrap();
    let path = folder.path().join("before.mcap");
    let mut run = Run::start_at(&path, H, -2.0 * H);
    run.steps(3, 0.0);
    run.finish();
    let (_, files) = exported(&path);
    assert_eq!(
        times_in(&files["particles.pvd"]),
        [-0.01, -0.005, 0.0, 0.005]
    );
}

#[test]
fn an_export_of_particles_that_a_log_lacks_says_how_to_get_them() {
    let folder = temp_dir::TempDir::new().unwrap();
    let [path, vtk] = ["run.mcap", "vtk"].map(|name| folder.path().join(name));
    let mut run = Run::start(&path, 0.0);
    run.steps(2, 1.0);
    run.finish();
    let [path, vtk] = [path, vtk].map(|path| path.display().to_string());
    let said = log(&["export", &path, "--vtk", &vtk]);
    assert!(said.contains("0 snapshots"), "{said}");
    let remedy = format!("log redrive {path} --log NEW.mcap --particles-every");
    assert!(said.contains(&remedy), "{said}");
}
