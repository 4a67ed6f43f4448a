//! What the system still holds of what was published, because nobody took it yet.
//!
//! Zenoh closes a session without it: the batch that is on its way when the session ends is cut, and what follows it is lost
//! (1.10, `TransportLinkUnicastUniversal::close`). Nor does Zenoh say how much that is, so the system is asked.

use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// How often is looked: longer than Zenoh's own queue holds what could leave (1 ms).
const LOOK_EVERY: Duration = Duration::from_millis(10);
/// Looks in a row that must find nothing: between two batches the system's own queue is empty, too.
const QUIET_LOOKS: usize = 3;
/// How long a subscriber may take nothing at all: as long as Zenoh blocks for it (`wait_before_close`).
const PATIENCE: Duration = Duration::from_secs(5);

/// Waits until others took all that this process sent, until nothing moves for [`PATIENCE`], or until `stop`. Gives the bytes
/// that were not taken; 0 where the system does not tell (only Linux does), after as many looks.
pub(super) fn wait_until_taken(stop: &AtomicBool) -> u64 {
    let (mut unsent, mut moved, mut quiet) = (0, Instant::now(), 0);
    while quiet < QUIET_LOOKS {
        if stop.load(Relaxed) || moved.elapsed() > PATIENCE {
            break;
        }
        std::thread::sleep(LOOK_EVERY);
        let now = bytes_unsent().unwrap_or(0);
        if now != unsent {
            (unsent, moved) = (now, Instant::now());
        }
        quiet = if now == 0 { quiet + 1 } else { 0 };
    }
    unsent
}

/// What the TCP connections of this process hold: sent by the program, not yet taken by the other side.
#[cfg(target_os = "linux")]
fn bytes_unsent() -> Option<u64> {
    use procfs::net::TcpState;
    use procfs::process::{FDTarget, Process};
    let process = Process::myself().ok()?;
    let sockets: std::collections::HashSet<u64> = process
        .fd()
        .ok()?
        .filter_map(|descriptor| match descriptor.ok()?.target {
            FDTarget::Socket(inode) => Some(inode),
            _ => None,
        })
        .collect();
    let connections = process.tcp().ok()?;
    // Absent where there is no IPv6.
    let more = process.tcp6().unwrap_or_default();
    let own = connections.iter().chain(&more).filter(|connection| {
        connection.state == TcpState::Established && sockets.contains(&connection.inode)
    });
    Some(own.map(|connection| u64::from(connection.tx_queue)).sum())
}

#[cfg(not(target_os = "linux"))]
fn bytes_unsent() -> Option<u64> {
    None
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::io::{Read, Write};

    /// A connection whose other side reads nothing at first.
    #[test]
    fn waits_for_who_reads_late_until_it_is_stopped() {
        let listener = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
        let mut sending = std::net::TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (mut receiving, _) = listener.accept().unwrap();
        // More than the other side's buffer takes.
        sending.set_nonblocking(true).unwrap();
        let mut sent = 0;
        while let Ok(bytes) = sending.write(&[0; 1 << 16]) {
            sent += bytes;
        }
        assert!(bytes_unsent().unwrap() > 0);
        let stop = std::sync::Arc::new(AtomicBool::new(false));
        let stopping = stop.clone();
        let stopper = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(100));
            stopping.store(true, Relaxed);
        });
        assert!(wait_until_taken(&stop) > 0);
        stopper.join().unwrap();
        let reader = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(300));
            let mut all = vec![0; sent];
            receiving.read_exact(&mut all).unwrap();
            receiving
        });
        let began = Instant::now();
        assert_eq!(wait_until_taken(&AtomicBool::new(false)), 0);
        assert!(began.elapsed() >= Duration::from_millis(300));
        drop(reader.join().unwrap());
    }
}
