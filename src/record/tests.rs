//! Files that break: cut at any byte, damaged, on a full disk, with a wrong account of mass.

use super::channels::add;
use super::file::{LogFile, Pace};
use super::place::Place;
use super::sink::Sink;
use super::sink::tests::Disk;
use super::{Body, Ending, Entry, LogReader, RecordError, RecordOptions, Recorder, check_mass};
use crate::wire::convert::nanoseconds;
use crate::wire::messages::{AppliedEvent, MassLedger, StepStats};
use prost::Message;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const PLENTY: usize = 1 << 30;

fn line(step: u64) -> StepStats {
    // Powers of two, as particle masses are: sums are exact.
    let out = step as f64 * 0.125;
    StepStats {
        time: step as f64 * 0.01,
        step,
        bound_by: "acoustic".to_owned(),
        ledger: Some(MassLedger {
            initial: 1024.0,
            inflow: 0.25,
            outflow: out,
            present: 1024.25 - out,
        }),
        ..StepStats::default()
    }
}

/// Writes `lines` with a flush after every `flush_every`-th.
fn write(sink: impl Sink + 'static, lines: &[StepStats], flush_every: usize) -> LogFile {
    let mut file = LogFile::start(Box::new(sink), None, Pace::Caller);
    file.metadata("run", BTreeMap::from([("scene".into(), "tests".into())]));
    file.attachment("scene.toml", "application/toml", 0, b"[domain]");
    let channel = add::<StepStats>(&mut file, "sandgate/v1/tests/out/stats", BTreeMap::new());
    for (i, line) in lines.iter().enumerate() {
        let time = nanoseconds(line.time);
        let data = line.encode_to_vec();
        file.message(line.time, channel.id, i as u32, (time, time), &data);
        if (i + 1) % flush_every == 0 {
            file.flush();
        }
    }
    file
}

fn whole(lines: &[StepStats], flush_every: usize) -> Vec<u8> {
    let disk = Disk::with_room(PLENTY);
    let mut file = write(disk.clone(), lines, flush_every);
    let (counts, failure) = file.finish();
    assert_eq!(
        (counts.written, counts.dropped, failure),
        (lines.len() as u64, 0, None)
    );
    disk.bytes.lock().unwrap().clone()
}

fn on_disk(folder: &Path, bytes: &[u8]) -> PathBuf {
    let path = folder.join("log.mcap");
    std::fs::write(&path, bytes).unwrap();
    path
}

fn read(path: &Path) -> (Vec<Entry>, Ending) {
    let mut log = LogReader::open(path).unwrap();
    let entries = log.by_ref().map(Result::unwrap).collect();
    (entries, log.ending().unwrap().clone())
}

#[test]
fn a_log_reads_back_as_it_was_written() {
    let folder = temp_dir::TempDir::new().unwrap();
    let lines: Vec<_> = (0..50).map(line).collect();
    let (entries, ending) = read(&on_disk(folder.path(), &whole(&lines, 7)));
    assert_eq!(ending, Ending::Complete);
    assert!(matches!(&entries[0], Entry::Metadata { name, .. } if name == "run"));
    assert!(matches!(&entries[1], Entry::Attachment { data, .. } if data == b"[domain]"));
    let stats: Vec<_> = entries[2..]
        .iter()
        .map(|entry| match entry {
            Entry::Message {
                body: Body::Stats(stats),
                log_time,
                topic,
                ..
            } => {
                assert_eq!(*log_time, nanoseconds(stats.time));
                assert_eq!(topic, "sandgate/v1/tests/out/stats");
                stats.clone()
            }
            other => panic!("{other:?}"),
        })
        .collect();
    assert_eq!(stats, lines);
}

#[test]
fn a_log_cut_at_any_byte_reads_up_to_the_cut_and_says_so() {
    let folder = temp_dir::TempDir::new().unwrap();
    let lines: Vec<_> = (0..6).map(line).collect();
    let bytes = whole(&lines, 2);
    let (all, _) = read(&on_disk(folder.path(), &bytes));
    let mut longest = 0;
    for length in mcap::MAGIC.len()..bytes.len() {
        let (entries, ending) = read(&on_disk(folder.path(), &bytes[..length]));
        assert!(all.starts_with(&entries), "cut at {length}");
        assert!(entries.len() >= longest, "cut at {length}");
        longest = entries.len();
        assert!(
            matches!(ending, Ending::Cut { damaged: false, .. }),
            "cut at {length}"
        );
        assert!(ending.to_string().contains("cut short"), "{ending}");
    }
    assert_eq!(longest, all.len());
}

#[test]
fn a_damaged_byte_never_passes_as_a_message() {
    let folder = temp_dir::TempDir::new().unwrap();
    let lines: Vec<_> = (0..20).map(line).collect();
    let mut bytes = whole(&lines, 5);
    let needle = line(12).encode_to_vec();
    let at = bytes
        .windows(needle.len())
        .position(|w| w == needle)
        .unwrap();
    bytes[at + 3] ^= 0x10;
    let path = on_disk(folder.path(), &bytes);
    let mut log = LogReader::open(&path).unwrap();
    let refused = log.by_ref().any(|entry| entry.is_err());
    let cut = matches!(log.ending(), Some(Ending::Cut { why, .. }) if why.contains("CRC"));
    assert!(refused || cut, "{:?}", log.ending());
}

#[test]
fn no_changed_byte_of_a_record_header_passes_as_a_cut() {
    let folder = temp_dir::TempDir::new().unwrap();
    let lines: Vec<_> = (0..6).map(line).collect();
    let bytes = whole(&lines, 2);
    let (mut at, mut records) = (mcap::MAGIC.len(), 0);
    while at < bytes.len() - mcap::MAGIC.len() {
        for byte in at..at + 9 {
            for bit in 0..8 {
                let mut changed = bytes.clone();
                changed[byte] ^= 1 << bit;
                let mut log = LogReader::open(&on_disk(folder.path(), &changed)).unwrap();
                let refused = log.by_ref().any(|entry| entry.is_err());
                let told = matches!(log.ending(), Some(Ending::Cut { damaged: true, .. }));
                assert!(refused || told, "byte {byte}, {bit}: {:?}", log.ending());
            }
        }
        at += 9 + u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        records += 1;
    }
    assert!(records > 10, "{records}");
}

#[test]
fn other_files_are_refused() {
    let folder = temp_dir::TempDir::new().unwrap();
    for bytes in [&b"[domain]\nlower = [0, 0]"[..], b"", b"\x89MCAP"] {
        let Err(error) = LogReader::open(&on_disk(folder.path(), bytes)) else {
            panic!("{bytes:?} was taken for a log");
        };
        assert!(error.to_string().contains("is not an MCAP file"), "{error}");
    }
    let Err(error) = LogReader::open(&folder.path().join("absent.mcap")) else {
        panic!("an absent file was read");
    };
    assert!(error.to_string().contains("cannot read log"), "{error}");
}

#[test]
fn a_disk_that_was_full_for_a_moment_leaves_a_log_without_a_hole() {
    let folder = temp_dir::TempDir::new().unwrap();
    let lines: Vec<_> = (0..2000).map(line).collect();
    let size = whole(&lines, 10).len();
    let disk = Disk::with_room(size / 2);
    let mut file = write(disk.clone(), &lines, 10);
    *disk.room.lock().unwrap() = PLENTY;
    let late = line(2000);
    let channel = add::<StepStats>(&mut file, "sandgate/v1/tests/out/stats", BTreeMap::new());
    file.message(late.time, channel.id, 2000, (0, 0), &late.encode_to_vec());
    file.flush();
    let (counts, failure) = file.finish();

    let failure = failure.expect("half of the room is not enough");
    assert!(
        failure
            .to_string()
            .contains("log stopped at simulated time"),
        "{failure}"
    );
    assert_eq!(counts.written + counts.dropped, 2001);
    assert!(counts.written > 100 && counts.dropped > 100, "{counts:?}");
    assert_eq!(disk.bytes.lock().unwrap().len(), size / 2);
    let bytes = disk.bytes.lock().unwrap().clone();
    let (entries, ending) = read(&on_disk(folder.path(), &bytes));
    assert!(matches!(ending, Ending::Cut { .. }));
    let messages = entries.len() as u64 - 2;
    // Of the flush that failed a part may be there.
    assert!((counts.written..counts.written + 10).contains(&messages));
}

/// Chunks are closed when they are full, too, not only by flushes: what is in them is in the file.
#[test]
fn what_a_full_disk_left_out_is_counted_to_the_chunk() {
    let folder = temp_dir::TempDir::new().unwrap();
    let lines: Vec<_> = (0..60_000).map(line).collect();
    let size = whole(&lines, usize::MAX).len();
    let disk = Disk::with_room(size * 3 / 4);
    let (counts, failure) = write(disk.clone(), &lines, usize::MAX).finish();
    assert!(failure.is_some());
    let bytes = disk.bytes.lock().unwrap().clone();
    let (entries, _) = read(&on_disk(folder.path(), &bytes));
    let messages = entries.len() as u64 - 2;
    assert_eq!(counts.written + counts.dropped, 60_000);
    // A chunk is a MiB, and a part of the last one may be there.
    let chunk = 60_000 * (1 << 20) / size as u64 + 1_000;
    assert!(counts.written > 0, "{counts:?}");
    assert!(
        (counts.written..counts.written + chunk).contains(&messages),
        "{counts:?}, {messages} in the file, {chunk} a chunk"
    );
}

#[test]
fn a_device_without_room_is_reported() {
    let full = std::fs::File::options()
        .write(true)
        .open("/dev/full")
        .unwrap();
    let lines: Vec<_> = (0..100).map(line).collect();
    let (counts, failure) = write(full, &lines, 10).finish();
    assert_eq!((counts.written, counts.dropped), (0, 100));
    let failure = failure.unwrap();
    assert!(
        failure.cause.contains("No space left on device"),
        "{failure}"
    );
}

#[test]
fn without_a_call_the_clock_brings_messages_to_the_disk() {
    let disk = Disk::with_room(PLENTY);
    let mut file = LogFile::start(Box::new(disk.clone()), None, Pace::WallClock);
    let channel = add::<StepStats>(&mut file, "sandgate/v1/tests/out/stats", BTreeMap::new());
    let data = line(7).encode_to_vec();
    file.message(0.07, channel.id, 0, (0, 0), &data);
    let written = Instant::now();
    let there = || {
        let bytes = disk.bytes.lock().unwrap();
        bytes.windows(data.len()).any(|w| w == data)
    };
    // It is a second on a machine that is not busy.
    while !there() {
        assert!(written.elapsed() < Duration::from_secs(20), "not flushed");
        std::thread::sleep(Duration::from_millis(10));
    }
    assert_eq!(file.finish().1, None);
}

#[test]
fn a_wrong_account_of_mass_is_found_to_the_last_bit() {
    let folder = temp_dir::TempDir::new().unwrap();
    let mut lines: Vec<_> = (0..30).map(line).collect();
    let right = check_mass(&on_disk(folder.path(), &whole(&lines, 10))).unwrap();
    assert_eq!((right.lines, &right.wrong), (30, &None));
    assert_eq!(right.last.unwrap().outflow, 29.0 * 0.125);
    assert_eq!(right.ending, Ending::Complete);

    for wrong in [(1024.25f64 - 2.125).next_up(), f64::NAN] {
        lines[17].ledger.as_mut().unwrap().present = wrong;
        let check = check_mass(&on_disk(folder.path(), &whole(&lines, 10))).unwrap();
        let found = check.wrong.expect("one line is wrong");
        assert_eq!(found.step, 17);
        assert!(found.to_string().contains("step 17 at 0.17 s"), "{found}");
    }
}

#[test]
fn what_a_file_lacks_is_not_forgotten_when_the_next_one_begins() {
    let text = include_str!("../../tests/scenes/small_silo.toml");
    let scene = crate::scene::parse("small_silo.toml", text).unwrap();
    for jumps in [false, true] {
        let folder = temp_dir::TempDir::new().unwrap();
        let mut component = crate::component::Component::new(&scene).unwrap();
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
        let report = component.do_step(0.0, 0.005).unwrap();
        recorder
            .record_step(&component, &report, 0.0, 0.005, "test")
            .unwrap();
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
    let text = include_str!("../../tests/scenes/small_silo.toml");
    let scene = crate::scene::parse("small_silo.toml", text).unwrap();
    for (jumps, required) in [(false, false), (true, false), (false, true), (true, true)] {
        let folder = temp_dir::TempDir::new().unwrap();
        let taken = match jumps {
            true => "silo-1-0000.mcap",
            false => "silo-0-0001.mcap",
        };
        std::fs::write(folder.path().join(taken), "somebody's").unwrap();
        let mut component = crate::component::Component::new(&scene).unwrap();
        let options = RecordOptions {
            rotate_every: if jumps { 0.0 } else { 0.009 },
            required,
            ..RecordOptions::of(&component)
        };
        let path = folder.path().join("silo.mcap");
        let mut recorder = super::Recorder::create(&path, &component, options).unwrap();
        component.initialize(0.0, None).unwrap();
        recorder
            .record_initialization(&component, 0.0, None, "test")
            .unwrap();
        let step = |component: &mut crate::component::Component, recorder: &mut super::Recorder| {
            let t = component.time();
            let report = component.do_step(t, 0.005).unwrap();
            recorder.record_step(component, &report, t, 0.005, "test")
        };
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
        let (entries, ending) = read(&folder.path().join(whole));
        assert_eq!(ending, Ending::Complete);
        let points = entries.iter().filter(|entry| {
            let body = match entry {
                Entry::Message { body, .. } => body,
                _ => return false,
            };
            matches!(body, Body::Stats(_))
        });
        assert_eq!(points.count(), if jumps { 2 } else { 3 });
        if let Ok(finished) = finished {
            assert_eq!(finished.path, Some(folder.path().join(whole)));
            assert!(finished.dropped > 0 && finished.failure.is_some());
        }
        assert_eq!(
            std::fs::read(folder.path().join(taken)).unwrap(),
            b"somebody's"
        );
    }
}
