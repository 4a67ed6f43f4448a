//! From one file of a log to the next: what the first lacks, and a next one that cannot be.

use super::*;
use crate::component::Component;
use crate::record::place::Place;
use crate::record::{RecordError, RecordOptions, Recorder};
use crate::scene::Scene;
use crate::wire::messages::AppliedEvent;

fn silo() -> Scene {
    let text = include_str!("../../../tests/scenes/small_silo.toml");
    crate::scene::parse("small_silo.toml", text).unwrap()
}

fn step(component: &mut Component, recorder: &mut Recorder) -> Result<(), RecordError> {
    let t = component.time();
    let report = component.do_step(t, 0.005).unwrap();
    recorder.record_step(component, &report, t, 0.005, "test")
}

/// Communication points in a log that is complete.
fn points(path: &Path) -> usize {
    let (entries, ending) = read(path);
    assert_eq!(ending, Ending::Complete);
    let points = entries.iter().filter(|entry| {
        let body = match entry {
            Entry::Message { body, .. } => body,
            _ => return false,
        };
        matches!(body, Body::Stats(_))
    });
    points.count()
}

#[test]
fn what_a_file_lacks_is_not_forgotten_when_the_next_one_begins() {
    let scene = silo();
    for jumps in [false, true] {
        let folder = temp_dir::TempDir::new().unwrap();
        let mut component = Component::new(&scene).unwrap();
        component.initialize(0.0, None).unwrap();
        let options = RecordOptions {
            rotate_every: if jumps { 0.0 } else { 0.004 },
            required: false,
            ..RecordOptions::of(&component)
        };
        let place = Place {
            rotates: !jumps,
            ..Place::alone(&folder.path().join("silo.mcap"))
        };
        let disk = Disk::with_room(PLENTY);
        let sink = Box::new(disk.clone());
        let mut recorder = Recorder::start(sink, Some(place), &component, options, None).unwrap();
        let trouble = Err(RecordError::Exists {
            path: "earlier".into(),
        });
        recorder.keep(trouble);
        *disk.room.lock().unwrap() = 0;
        step(&mut component, &mut recorder).unwrap();
        if jumps {
            component.reset().unwrap();
            recorder
                .record_jump(&component, AppliedEvent::Reset, "test")
                .unwrap();
        }
        assert!(recorder.failure().is_some());
        assert!(recorder.dropped() > 0);
        let trouble = recorder.take_trouble();
        assert!(matches!(trouble, Some(RecordError::Exists { .. })));
        let finished = recorder.finish(&component, "finished").unwrap();
        let path = finished.path.unwrap();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let expected = if jumps {
            "silo-1-0000.mcap"
        } else {
            "silo-0-0001.mcap"
        };
        assert_eq!(name, expected);
        assert!(finished.dropped > 0 && finished.failure.is_some());
    }
}

#[test]
fn a_log_that_cannot_go_on_in_a_next_file_ends_whole() {
    let scene = silo();
    for (jumps, required) in [(false, false), (true, false), (false, true), (true, true)] {
        let folder = temp_dir::TempDir::new().unwrap();
        let taken = match jumps {
            true => "silo-1-0000.mcap",
            false => "silo-0-0001.mcap",
        };
        std::fs::write(folder.path().join(taken), "somebody's").unwrap();
        let mut component = Component::new(&scene).unwrap();
        let options = RecordOptions {
            rotate_every: if jumps { 0.0 } else { 0.009 },
            required,
            ..RecordOptions::of(&component)
        };
        let path = folder.path().join("silo.mcap");
        let mut recorder = Recorder::create(&path, &component, options).unwrap();
        component.initialize(0.0, None).unwrap();
        recorder
            .record_initialization(&component, 0.0, None, "test")
            .unwrap();
        step(&mut component, &mut recorder).unwrap();
        let told = if jumps {
            component.reset().unwrap();
            recorder.record_jump(&component, AppliedEvent::Reset, "test")
        } else {
            step(&mut component, &mut recorder)
        };
        assert_eq!(told.is_err(), required);
        let failure = recorder.failure().unwrap().to_string();
        assert!(failure.contains(taken), "{failure}");
        if jumps {
            component.initialize(0.0, None).unwrap();
        }
        let later = step(&mut component, &mut recorder);
        assert!(later.is_ok() && recorder.dropped() > 0);
        let finished = recorder.finish(&component, "finished");
        assert_eq!(finished.is_err(), required);

        let whole = match jumps {
            true => "silo.mcap",
            false => "silo-0-0000.mcap",
        };
        let whole = folder.path().join(whole);
        assert_eq!(points(&whole), if jumps { 2 } else { 3 });
        if let Ok(finished) = finished {
            assert_eq!(finished.path, Some(whole));
            assert!(finished.dropped > 0 && finished.failure.is_some());
        }
        assert_eq!(
            std::fs::read(folder.path().join(taken)).unwrap(),
            b"somebody's"
        );
    }
}
