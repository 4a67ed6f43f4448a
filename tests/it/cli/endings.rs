//! How runs end before their time: signals, kills, output that nobody reads.

use super::{Desk, small_silo, stderr};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A run that is far from its end, already past its first rows.
fn running(desk: &Desk, args: &[&str], out: &str, wanted: &str) -> Child {
    let mut child = desk
        .command(args)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    while !desk.path(out).join(wanted).exists() {
        assert!(
            child.try_wait().unwrap().is_none(),
            "the run ended before it could be stopped"
        );
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "no {wanted} after a minute"
        );
        std::thread::sleep(Duration::from_millis(5));
    }
    child
}

#[cfg(unix)]
fn signal(child: &Child, name: &str) {
    // The shell's own `kill`: the program of that name is not everywhere.
    let line = format!("kill {name} {}", child.id());
    let status = Command::new("sh").args(["-c", &line]).status().unwrap();
    assert!(status.success());
}

#[cfg(unix)]
#[test]
fn ctrl_c_saves_and_says_how_to_go_on() {
    let (desk, silo) = (Desk::new(), small_silo());
    let args = [
        "run", &silo, "--out", "run", "--until", "1000 s", "--step", "2 ms",
    ];
    let child = running(&desk, &args, "run", "summary.json");
    signal(&child, "-INT");
    let output = child.wait_with_output().unwrap();
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(130), "{text}");
    let command =
        format!("sandgate run {silo} --until 1000 --step 0.002 --resume run/checkpoint.state");
    assert!(text.contains(&command), "no {command:?} in: {text}");
    let summary = desk.summary("run");
    assert_eq!(summary["status"], "interrupted");
    let log = std::fs::read(desk.path("run/run.mcap")).unwrap();
    assert!(log.ends_with(b"\x89MCAP0\r\n"), "the log was not finished");

    let reached = summary["time"].as_f64().unwrap();
    let until = format!("{}", reached + 0.02);
    desk.ok(&[
        "run",
        &silo,
        "--resume",
        "run/checkpoint.state",
        "--step",
        "2 ms",
        "--until",
        &until,
    ]);
    desk.ok(&[
        "run", &silo, "--out", "whole", "--step", "2 ms", "--until", &until,
    ]);
    assert_eq!(desk.hash("run"), desk.hash("whole"));
    assert_eq!(desk.table("run"), desk.table("whole"));
}

/// Two runs in one folder would destroy each other: who comes second is refused, however he asks, and leaves no trace.
#[test]
fn a_folder_belongs_to_the_run_that_writes_to_it() {
    let (desk, silo) = (Desk::new(), small_silo());
    let long = ["run", &silo, "--out", "run", "--until", "1000 s"];
    let mut first = running(
        &desk,
        &[&long[..], &["--checkpoint-every", "5 ms"]].concat(),
        "run",
        "checkpoint.state",
    );
    let state = "run/checkpoint.state";
    for more in [
        &["--out", "run"][..],
        &["--out", "run", "--force"],
        &["--resume", state],
    ] {
        let args = [&["run", &silo, "--until", "1000 s"][..], more].concat();
        desk.refused(
            &args,
            2,
            &["another run writes to run now", "give another folder"],
        );
    }
    // Its checkpoint may be gone on with elsewhere: this gets as far as the end that is too early.
    let elsewhere = [
        "run", &silo, "--resume", state, "--out", "copy", "--until", "1 ms", "--step", "1 ms",
    ];
    desk.refused(&elsewhere, 2, &["give a later end"]);
    assert!(first.try_wait().unwrap().is_none());
    // A lock ends with its process.
    first.kill().unwrap();
    first.wait().unwrap();
    desk.ok(&["run", &silo, "--out", "run", "--force", "--until", "10 ms"]);
    assert_eq!(desk.summary("run")["status"], "finished");
    assert!(!desk.path("run/sandgate.lock").exists());
}

/// What batch systems, `timeout` and a closed terminal send; SIGHUP unless these tests run where it is ignored, as under `nohup`.
#[cfg(unix)]
#[test]
fn polite_signals_save_too() {
    let (desk, silo) = (Desk::new(), small_silo());
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.map_or(0, |mask| u64::from_str_radix(mask.trim(), 16).unwrap());
    let hears_hup = ignored & 1 == 0;
    let signals = [("-TERM", "term"), ("-HUP", "hup")];
    for (name, out) in signals.into_iter().filter(|s| s.1 == "term" || hears_hup) {
        let args = ["run", &silo, "--out", out, "--until", "1000 s"];
        let child = running(&desk, &args, out, "summary.json");
        signal(&child, name);
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
        assert_eq!(desk.summary(out)["status"], "interrupted");
        assert!(desk.path(&format!("{out}/checkpoint.state")).exists());
    }
}

/// Neither the exit code nor what is done depends on who reads: standard output may be closed, standard error full.
#[cfg(target_os = "linux")]
#[test]
fn nobody_needs_to_read() {
    let (desk, silo) = (Desk::new(), small_silo());
    let program = env!("CARGO_BIN_EXE_sandgate");
    let packed = desk.path("packed.toml").display().to_string();
    std::fs::copy(&silo, &packed).unwrap();
    let bad = desk.path("bad.toml").display().to_string();
    std::fs::write(&bad, "name = 1\n").unwrap();
    for (line, code) in [
        (format!("run {silo} --until '20 ms' --out closed | true"), 0),
        (
            format!("run {silo} --until '20 ms' --out full 2> /dev/full"),
            0,
        ),
        (format!("run {bad} 2> /dev/full"), 3),
        ("help > /dev/full".to_owned(), 5),
        ("run --help | true".to_owned(), 0),
        (format!("fmu {packed} -o {packed} 2> /dev/full"), 2),
    ] {
        let line = format!("set -o pipefail; {program} {line}");
        let mut shell = Command::new("bash");
        let output = shell
            .args(["-c", &line])
            .current_dir(desk.path("."))
            .output();
        let output = output.unwrap();
        assert_eq!(
            output.status.code(),
            Some(code),
            "{line}: {}",
            stderr(&output)
        );
    }
    for out in ["closed", "full"] {
        assert_eq!(desk.summary(out)["status"], "finished");
    }
    assert!(std::fs::read_to_string(&packed).unwrap().contains("[run]"));
}

#[cfg(unix)]
#[test]
fn a_killed_run_goes_on_from_its_last_checkpoint() {
    let (desk, silo) = (Desk::new(), small_silo());
    let args = [
        "run",
        &silo,
        "--out",
        "run",
        "--until",
        "1000 s",
        "--checkpoint-every",
        "20 ms",
    ];
    let child = running(&desk, &args, "run", "checkpoint.state");
    signal(&child, "-KILL");
    child.wait_with_output().unwrap();
    let summary = desk.summary("run");
    assert_eq!(summary["status"], "running");
    let until = format!("{}", summary["time"].as_f64().unwrap() + 0.1);
    desk.ok(&[
        "run",
        &silo,
        "--resume",
        "run/checkpoint.state",
        "--until",
        &until,
    ]);
    desk.ok(&["run", &silo, "--out", "whole", "--until", &until]);
    assert_eq!(desk.hash("run"), desk.hash("whole"));
    assert_eq!(desk.table("run"), desk.table("whole"));
}
