//! Where the bytes of a log go, and the latch that keeps a failed log whole up to its cut.

use std::fs::File;
use std::io::{self, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Takes the bytes of a log in order.
pub(super) trait Sink: Write + Send {
    /// Asks the system to bring all bytes to the disk.
    fn sync(&mut self) -> io::Result<()>;

    /// The same for who does not have the sink at hand; none if it has no disk.
    fn syncer(&self) -> Option<Syncer> {
        None
    }
}

/// Asks the system to bring all bytes of a sink to the disk.
pub(super) type Syncer = Box<dyn FnMut() -> io::Result<()> + Send>;

impl Sink for File {
    fn sync(&mut self) -> io::Result<()> {
        match self.sync_all() {
            // Pipes and devices cannot be synchronised; they have no disk either.
            Err(error) if error.kind() == io::ErrorKind::InvalidInput => Ok(()),
            other => other,
        }
    }

    fn syncer(&self) -> Option<Syncer> {
        let mut own = self.try_clone().ok()?;
        Some(Box::new(move || Sink::sync(&mut own)))
    }
}

/// Refuses everything after the first error. A disk that was full may take a later, smaller write: the file would then
/// have a hole, and readers would stop at it or worse.
pub(super) struct Latch {
    sink: Box<dyn Sink>,
    failed: Option<io::ErrorKind>,
    passed: Passed,
}

/// Bytes that the system has taken, for who does not have the latch at hand.
pub(super) type Passed = Arc<AtomicU64>;

impl Latch {
    pub(super) fn new(sink: Box<dyn Sink>) -> Self {
        Self {
            sink,
            failed: None,
            passed: Passed::default(),
        }
    }

    pub(super) fn passed(&self) -> Passed {
        self.passed.clone()
    }

    pub(super) fn sync(&mut self) -> io::Result<()> {
        self.guard(|sink| sink.sync())
    }

    fn guard<T>(&mut self, write: impl FnOnce(&mut dyn Sink) -> io::Result<T>) -> io::Result<T> {
        if let Some(kind) = self.failed {
            return Err(kind.into());
        }
        let result = write(self.sink.as_mut());
        if let Err(error) = &result
            && error.kind() != io::ErrorKind::Interrupted
        {
            self.failed = Some(error.kind());
        }
        result
    }
}

impl Write for Latch {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.guard(|sink| sink.write(bytes))?;
        self.passed.fetch_add(written as u64, Relaxed);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.guard(|sink| sink.flush())
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use std::sync::Mutex;

    /// Keeps bytes in memory; has room for `room` of them until somebody makes more.
    #[derive(Clone, Default)]
    pub(in crate::record) struct Disk {
        pub(in crate::record) bytes: Arc<Mutex<Vec<u8>>>,
        pub(in crate::record) room: Arc<Mutex<usize>>,
    }

    impl Disk {
        pub(in crate::record) fn with_room(room: usize) -> Self {
            let disk = Self::default();
            *disk.room.lock().unwrap() = room;
            disk
        }
    }

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let mut stored = self.bytes.lock().unwrap();
            let left = self.room.lock().unwrap().saturating_sub(stored.len());
            if left == 0 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            let n = bytes.len().min(left);
            stored.extend_from_slice(&bytes[..n]);
            Ok(n)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    impl Sink for Disk {
        fn sync(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn nothing_is_written_after_a_failed_write_even_if_room_comes_back() {
        let disk = Disk::with_room(10);
        let mut latch = Latch::new(Box::new(disk.clone()));
        latch.write_all(b"12345678").unwrap();
        assert!(latch.write_all(b"90ab").is_err());
        *disk.room.lock().unwrap() = 1000;
        assert!(latch.write_all(b"cd").is_err());
        assert!(latch.sync().is_err());
        assert_eq!(disk.bytes.lock().unwrap().as_slice(), b"1234567890");
    }
}
