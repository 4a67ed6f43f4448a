//! Files that break: cut at any byte, damaged, on a full disk, with a wrong account of mass.

mod full_disk;
mod next_file;
mod reading;

use super::channels::add;
use super::file::{LogFile, Pace};
use super::sink::Sink;
use super::sink::tests::Disk;
use super::{Body, Ending, Entry, LogReader};
use crate::wire::convert::nanoseconds;
use crate::wire::messages::{MassLedger, StepStats};
use prost::Message;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

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
