//! What is read back: whole files, files cut at any byte, damaged ones, others, and a wrong account of mass.

use super::*;
use crate::record::{RedriveOptions, Table, check_mass, redrive};

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
fn what_ends_before_its_scene_and_what_is_empty_is_told_as_that() {
    let folder = temp_dir::TempDir::new().unwrap();
    let bytes = whole(&[line(0)], 2);
    let refusals = |length: usize| {
        let path = on_disk(folder.path(), &bytes[..length]);
        let nobody = &mut |_: f64| {};
        let table = Table::read(&path, (f64::NEG_INFINITY, f64::INFINITY)).unwrap_err();
        let redriven = redrive(&path, &RedriveOptions::default(), nobody).map(|_| ());
        [table.to_string(), redriven.unwrap_err().to_string()]
    };
    for (length, why) in [
        (0, "it is empty"),
        (5, "it ends within the magic bytes"),
        (mcap::MAGIC.len() + 20, "ends before its scene"),
    ] {
        for told in refusals(length) {
            assert!(told.contains(why), "{length}: {told}");
        }
    }
    let other = on_disk(folder.path(), b"%PDF-1.7 and more");
    let told = LogReader::open(&other).err().unwrap().to_string();
    assert!(
        told.contains("does not begin with the magic bytes"),
        "{told}"
    );
}
