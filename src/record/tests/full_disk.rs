//! What is written: to a disk that is full, for a moment or for good, and by the clock alone.

use super::*;
use std::time::{Duration, Instant};

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

/// The clock notices a full disk late: what is told is how far the file reaches, and when that was noticed.
#[test]
fn a_failure_names_the_time_to_which_the_file_reaches() {
    let lines: Vec<_> = (0..40).map(line).collect();
    let begun = whole(&lines[..20], 10).len();
    let disk = Disk::with_room(begun);
    let mut file = write(disk.clone(), &lines, usize::MAX);
    let (counts, failure) = file.finish();
    assert_eq!(counts.written, 0);
    let told = failure.unwrap().to_string();
    assert!(
        told.starts_with(
            "log stopped at simulated time 0.39 s, before which nothing is known to be written"
        ),
        "{told}"
    );

    let disk = Disk::with_room(PLENTY);
    let mut file = write(disk.clone(), &lines[..20], 10);
    *disk.room.lock().unwrap() = 0;
    let channel = add::<StepStats>(&mut file, "sandgate/v1/tests/out/more", BTreeMap::new());
    for line in &lines[20..] {
        file.message(line.time, channel.id, 0, (0, 0), &line.encode_to_vec());
    }
    let (counts, failure) = file.finish();
    assert_eq!((counts.written, counts.dropped), (20, 20));
    let told = failure.unwrap().to_string();
    assert!(
        told.starts_with(
            "log stopped at simulated time 0.39 s, what is known to be written reaches 0.19 s: "
        ),
        "{told}"
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
