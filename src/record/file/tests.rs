//! What a process does with a log that was forked from the one that writes it.

use super::*;
use crate::record::sink::tests::Disk;
use std::sync::mpsc::channel;
use std::time::Duration;

/// As a forked process has it, while the thread that flushes held the lock.
#[test]
fn a_forked_process_neither_waits_for_the_lock_nor_writes() {
    for pace in [Pace::WallClock, Pace::Caller] {
        let disk = Disk::with_room(1 << 20);
        let mut file = LogFile::start(Box::new(disk.clone()), None, pace);
        let shared = Arc::clone(&file.shared);
        let held = shared.lock();
        file.process = file.process.wrapping_add(1);
        let (tell, told) = channel();
        std::thread::spawn(move || {
            file.flush();
            file.message(0.5, ChannelId(0), 0, (0, 0), b"lost");
            let (counts, failure) = file.finish();
            drop(file);
            let _ = tell.send((counts, failure));
        });
        // Far longer than it takes; without the lock it would be for ever.
        let (counts, failure) = told.recv_timeout(Duration::from_secs(60)).unwrap();
        drop(held);
        drop(shared);
        assert_eq!((counts.written, counts.dropped), (0, 1));
        assert!(failure.unwrap().cause.contains("forked"));
        assert_eq!(disk.bytes.lock().unwrap().as_slice(), b"");
    }
}
