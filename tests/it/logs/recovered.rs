//! Logs that were cut or killed: what is recovered of them.

use super::{SCENE, logged, sandgate, text};
use crate::python;
use prost::Message;
use sandgate::record::{
    Ending, RawEntry, RawReader, RedriveOptions, Survey, check_mass, recover, redrive,
};
use sandgate::wire::messages::Gauge;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

#[test]
fn an_unfinished_log_is_recovered_to_its_own_name() {
    let folder = temp_dir::TempDir::new().unwrap();
    let bytes = std::fs::read(logged().join("run.mcap")).unwrap();
    let (cut, whole) = (
        folder.path().join("run.mcap.part"),
        folder.path().join("run.mcap"),
    );
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let done = recover(&cut, &whole).unwrap();
    assert!(done.messages > 10);
    assert_eq!(Survey::of(&whole).unwrap().ending, Ending::Complete);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2);
    // What is exported of the cut one comes with a warning.
    let (csv, vtk) = (folder.path().join("run.csv"), folder.path().join("vtk"));
    for (option, to) in [("--csv", &csv), ("--vtk", &vtk)] {
        for (log, cut) in [(&cut, true), (&whole, false)] {
            let words = [OsStr::new("log"), OsStr::new("export"), log.as_os_str()];
            let output = sandgate(&[&words[..], &[OsStr::new(option), to.as_os_str()]].concat());
            let said = text(&output.stderr);
            assert!(output.status.success(), "{said}");
            assert_eq!(said.contains("cut short near byte"), cut, "{said}");
            if to.is_dir() {
                std::fs::remove_dir_all(to).unwrap();
            } else {
                std::fs::remove_file(to).unwrap();
            }
        }
    }
}

/// A run without end: the gate stays closed.
fn endless(folder: &Path) -> (Child, PathBuf) {
    let text = std::fs::read_to_string(python::root().join(SCENE)).unwrap();
    let (before, rest) = text.split_once("[[schedule]]").unwrap();
    let (_, after) = rest.split_once("\n\n").unwrap();
    let scene = folder.join("small_silo.toml");
    std::fs::write(&scene, format!("{before}{after}")).unwrap();
    let out = folder.join("killed");
    let child = Command::new(env!("CARGO_BIN_EXE_sandgate"))
        .arg("run")
        .arg(scene)
        .args(["--until", "10000 s", "--threads", "1", "--out"])
        .arg(&out)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    (child, out.join("run.mcap.part"))
}

fn since_1970() -> f64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap()
        .as_secs_f64()
}

#[test]
fn what_was_killed_at_any_moment_is_recovered_but_for_its_last_second() {
    let folder = temp_dir::TempDir::new().unwrap();
    let mut recovered = Vec::new();
    // Moments from 0 to 2 s after the log began, by a linear congruence (Numerical Recipes).
    let mut random = 20_u32;
    for round in 0..20 {
        random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let moment = Duration::from_secs_f64(2.0 * f64::from(random) / f64::from(u32::MAX));
        let own = folder.path().join(round.to_string());
        std::fs::create_dir(&own).unwrap();
        let (mut child, part) = endless(&own);
        let started = Instant::now();
        while std::fs::metadata(&part).map_or(0, |m| m.len()) == 0 {
            assert!(started.elapsed() < Duration::from_secs(60), "no log");
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(moment);
        let killed_at = since_1970();
        child.kill().unwrap(); // SIGKILL
        child.wait().unwrap();

        let whole = own.join("recovered.mcap");
        let done = recover(&part, &whole).unwrap();
        assert_eq!(done.path, whole);
        let survey = Survey::of(&whole).unwrap();
        assert_eq!(survey.ending, Ending::Complete, "round {round}");
        assert_eq!(survey.messages(), done.messages);
        assert_eq!(survey.metadata("run").unwrap()["scene"], "small_silo");
        assert!(survey.metadata("segment").is_some());
        assert!(survey.metadata("recovered").is_some());
        assert_eq!(survey.attachments[0].0, "scene.toml");
        assert!(survey.channels.values().all(|c| c.missing == 0));
        assert_eq!(check_mass(&whole).unwrap().wrong, None);
        // The scene is written as the log begins, so that there is a message in any case.
        let last = survey.published().unwrap().1 as f64 * 1e-9;
        assert!(
            killed_at - last < 1.0,
            "round {round}, killed after {moment:?}: {} s are lost",
            killed_at - last
        );
        recovered.push(whole);
    }
    // One of them in full: it runs again with the same bits up to the cut.
    let longest = recovered
        .iter()
        .max_by_key(|path| std::fs::metadata(path).unwrap().len())
        .unwrap();
    let done = redrive(longest, &RedriveOptions::default(), &mut |_| {}).unwrap();
    assert!(done.is_same() && done.steps > 10, "{done:?}");
    let logs = std::env::join_paths(&recovered).unwrap();
    python::pytest("test_recovered.py", &[("SANDGATE_LOGS", &logs)]);
}

#[test]
fn whole_messages_of_a_cut_chunk_are_recovered_too() {
    let folder = temp_dir::TempDir::new().unwrap();
    let bytes = std::fs::read(logged().join("run.mcap")).unwrap();
    let mut before = 0;
    for share in 1..20 {
        let cut = folder.path().join(format!("cut-{share}.mcap"));
        std::fs::write(&cut, &bytes[..bytes.len() * share / 20]).unwrap();
        let whole = folder.path().join(format!("whole-{share}.mcap"));
        let done = recover(&cut, &whole).unwrap();
        // What the recovered file has is what the reader of the cut one gives, byte for byte.
        let read = |path: &Path| -> Vec<RawEntry> {
            let entries = RawReader::open(path).unwrap().map(Result::unwrap);
            entries
                .filter(|e| !matches!(e, RawEntry::Metadata { name, .. } if name == "recovered"))
                .collect()
        };
        let messages = |entries: Vec<RawEntry>| -> Vec<RawEntry> {
            entries
                .into_iter()
                .filter(|e| !matches!(e, RawEntry::Channel(_)))
                .collect()
        };
        assert_eq!(
            messages(read(&cut)),
            messages(read(&whole)),
            "cut at {share}/20"
        );
        assert!(done.messages >= before);
        before = done.messages;
    }
    assert!(before > 100);
}

#[test]
fn behind_changed_bytes_nothing_is_recovered() {
    let folder = temp_dir::TempDir::new().unwrap();
    let path = logged().join("run.mcap");
    let mut bytes = std::fs::read(&path).unwrap();
    let gauge = RawReader::open(&path)
        .unwrap()
        .map(Result::unwrap)
        .find_map(|entry| match entry {
            RawEntry::Message(m) if m.channel.schema.name == "sandgate.Gauge" && m.log_time > 0 => {
                Some(m.data)
            }
            _ => None,
        });
    let gauge = gauge.unwrap();
    assert!(Gauge::decode(gauge.as_slice()).is_ok());
    let at = bytes.windows(gauge.len()).position(|w| w == gauge).unwrap();
    bytes[at + gauge.len() / 2] ^= 8;
    let (bad, whole) = (
        folder.path().join("bad.mcap"),
        folder.path().join("whole.mcap"),
    );
    std::fs::write(&bad, &bytes).unwrap();
    let done = recover(&bad, &whole).unwrap();
    assert!(
        matches!(done.ending, Ending::Cut { damaged: true, .. }),
        "{:?}",
        done.ending
    );
    assert_eq!(done.unchecked, 0);
    let survey = Survey::of(&whole).unwrap();
    assert_eq!(survey.ending, Ending::Complete);
    assert_eq!(survey.attachments[0].0, "scene.toml");
    for entry in RawReader::open(&whole).unwrap() {
        if let RawEntry::Message(message) = entry.unwrap() {
            assert!(message.log_time == 0 || message.data != gauge);
        }
    }
}

#[test]
fn bytes_behind_the_end_are_told_and_are_no_part_of_the_log() {
    let folder = temp_dir::TempDir::new().unwrap();
    let log = std::fs::read(logged().join("run.mcap")).unwrap();
    for (name, more, told) in [
        ("noise", b"noise".to_vec(), "they are no log"),
        ("twice", log.clone(), "a log of its own"),
    ] {
        let path = folder.path().join(format!("{name}.mcap"));
        std::fs::write(&path, [&log[..], &more].concat()).unwrap();
        let behind = format!("; {} bytes follow its end and were not read", more.len());
        let said = |words: &[&str]| {
            let words = words.iter().map(OsStr::new);
            let all: Vec<_> = [OsStr::new("log")].into_iter().chain(words).collect();
            let output = sandgate(&all);
            let said = text(&output.stdout) + &text(&output.stderr);
            (output.status.code(), said)
        };
        let file = path.to_str().unwrap();
        for words in [&["info", file][..], &["cat", file, "--topic", "out/log"]] {
            let (code, said) = said(words);
            assert!(code == Some(0) && said.contains(&behind), "{said}");
            assert!(said.contains(told), "{said}");
        }
        let (code, checked) = said(&["redrive", file, "--check"]);
        assert!(code == Some(7) && checked.contains(&behind), "{checked}");
        let whole = folder.path().join(format!("{name}-whole.mcap"));
        let (code, recovered) = said(&["recover", file, whole.to_str().unwrap()]);
        assert!(
            code == Some(0) && recovered.contains(&behind),
            "{recovered}"
        );
        let left_out = format!("the {} bytes that follow its end are not", more.len());
        assert!(recovered.contains(&left_out), "{recovered}");
        assert_eq!(Survey::of(&whole).unwrap().ending, Ending::Complete);
        let (code, _) = said(&["redrive", whole.to_str().unwrap(), "--check"]);
        assert_eq!(code, Some(0));
    }
    // The way that is told to the second log.
    let path = folder.path().join("twice.mcap");
    let Ending::Followed { byte, .. } = Survey::of(&path).unwrap().ending else {
        panic!("not followed")
    };
    assert_eq!(byte, log.len() as u64);
}

#[test]
fn what_is_no_file_is_refused_with_what_to_do() {
    let said = |path: &Path| Survey::of(path).unwrap_err().to_string();
    let device = said(Path::new("/dev/zero"));
    assert!(device.contains("found a pipe or device"), "{device}");
    assert!(device.contains("`cat > run.mcap`"), "{device}");
    // A folder of results tells which of its files are meant.
    let folder = temp_dir::TempDir::new().unwrap();
    let none = said(folder.path());
    assert!(none.contains("found a folder"), "{none}");
    assert!(none.contains("there is none in it"), "{none}");
    for name in ["run.mcap", "run-2.mcap.part", "gauges.csv"] {
        std::fs::write(folder.path().join(name), "").unwrap();
    }
    let two = said(folder.path());
    let named = |name: &str| folder.path().join(name).display().to_string();
    let give = format!("give {} or {}", named("run-2.mcap.part"), named("run.mcap"));
    assert!(two.ends_with(&give), "{two}");
}
