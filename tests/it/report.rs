//! The page of `sandgate report`: made of a run's log, then clicked through in a headless browser.

use crate::python;
use std::ffi::OsStr;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Runs the small silo with more snapshots, makes the page, and gives its path.
fn page(folder: &Path) -> PathBuf {
    let text =
        std::fs::read_to_string(python::root().join("tests/scenes/small_silo.toml")).unwrap();
    let (usual, more) = ("particles_every = \"50 ms\"", "particles_every = \"10 ms\"");
    let title = "title = \"Small gated silo for tests\"";
    assert!(text.contains(usual) && text.contains(title));
    // A title that would end the script or open a tag if it were not escaped.
    let awkward = "title = \"Silo </script><b>& \\\"gate\\\"\"";
    let scene = folder.join("small_silo.toml");
    std::fs::write(&scene, text.replace(usual, more).replace(title, awkward)).unwrap();
    let (out, page) = (folder.join("out"), folder.join("report.html"));
    let program = env!("CARGO_BIN_EXE_sandgate");
    python::run(
        "sandgate run",
        Command::new(program)
            .arg("run")
            .arg(&scene)
            .arg("--out")
            .arg(&out),
        "the program says what is wrong",
    );
    let made = python::run(
        "sandgate report",
        Command::new(program)
            .arg("report")
            .arg(out.join("run.mcap"))
            .arg("-o")
            .arg(&page),
        "the program says what is wrong",
    );
    let said = String::from_utf8_lossy(&made.stdout).into_owned();
    assert!(
        said.contains("41 communication points, 21 of 21 snapshots"),
        "{said}"
    );
    page
}

/// A page of a scene with two materials.
fn page_of_phases(folder: &Path) -> PathBuf {
    let (out, page) = (folder.join("dam"), folder.join("dam.html"));
    let program = env!("CARGO_BIN_EXE_sandgate");
    python::run(
        "sandgate run",
        Command::new(program)
            .arg("run")
            .arg(python::root().join("cases/silted_dam_reduced.toml"))
            .args(["--until", "0.2 s", "--out"])
            .arg(&out),
        "the program says what is wrong",
    );
    let log = out.join("run.mcap");
    let mut command = Command::new(program);
    command.arg("report").arg(log).arg("-o").arg(&page);
    python::run(
        "sandgate report",
        &mut command,
        "the program says what is wrong",
    );
    page
}

fn browser() -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let mut files =
        std::env::split_paths(&path).flat_map(|folder| names.map(|name| folder.join(name)));
    files.find(|file| file.is_file())
}

#[test]
fn a_page_holds_all_it_needs() {
    let folder = temp_dir::TempDir::new().unwrap();
    let html = std::fs::read_to_string(page(folder.path())).unwrap();
    for place in [
        "__DATA__",
        "__STYLE__",
        "__SCRIPT__",
        "__TITLE__",
        "<b>",
        "src=",
        "@import",
        "url(",
        "import(",
    ] {
        assert!(!html.contains(place), "{place}");
    }
    // The namespace of SVG is a name and not an address that is asked.
    assert_eq!(
        html.matches("http").count(),
        html.matches("http://www.w3.org/2000/svg").count()
    );
    assert_eq!(html.matches("</script>").count(), 2);
}

#[test]
fn snapshots_are_left_out_evenly_to_keep_a_page_small() {
    let folder = temp_dir::TempDir::new().unwrap();
    page(folder.path());
    let log = folder.path().join("out/run.mcap");
    // 320 particles in 14 bytes, as base64: 6 kB each; a third of 21.
    let small = sandgate::report::report(&log, 45_000).unwrap();
    assert_eq!((small.snapshots, small.snapshots_in_log), (8, 21));
    assert!(small.html.contains("8 of the log's 21 snapshots"));

    let bytes = std::fs::read(&log).unwrap();
    let report = |log: &Path, page: &Path| {
        let program = env!("CARGO_BIN_EXE_sandgate");
        let mut command = Command::new(program);
        let output = command.arg("report").arg(log).arg("-o").arg(page).output();
        let output = output.unwrap();
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        (output.status.code(), said)
    };
    // Not over the log, whatever it is called.
    let (code, said) = report(&log, &folder.path().join("out/../out/run.mcap"));
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("is the log itself"), "{said}");
    assert_eq!(std::fs::read(&log).unwrap(), bytes);
    // Nor where a run that goes on would put it.
    let part = folder.path().join("on.mcap.part");
    std::fs::write(&part, &bytes[..bytes.len() / 2]).unwrap();
    let (code, said) = report(&part, &folder.path().join("on.mcap"));
    assert_eq!(code, Some(2), "{said}");
    assert!(!folder.path().join("on.mcap").exists());
    let (cut, page) = (
        folder.path().join("cut.mcap"),
        folder.path().join("cut.html"),
    );
    std::fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let (code, said) = report(&cut, &page);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("cut short near byte"), "{said}");
    let html = std::fs::read_to_string(&page).unwrap();
    assert!(html.contains("\"ending\":\"cut short near byte"));
}

#[test]
fn a_browser_shows_the_page() {
    let Some(browser) = browser() else {
        // Not through `eprintln!`, which a passing test keeps to itself.
        let warning = "\nWARNING: a_browser_shows_the_page DID NOT RUN: no chromium is installed (Debian: apt-get install chromium)\n";
        std::io::stderr().write_all(warning.as_bytes()).unwrap();
        return;
    };
    let folder = temp_dir::TempDir::new().unwrap();
    let page = page(folder.path());
    let pictures = python::target().join("tmp/report");
    std::fs::create_dir_all(&pictures).unwrap();
    python::pytest(
        "test_report.py",
        &[
            ("SANDGATE_PAGE", page.as_os_str()),
            ("SANDGATE_PHASES", page_of_phases(folder.path()).as_os_str()),
            ("SANDGATE_BROWSER", browser.as_os_str()),
            ("SANDGATE_PICTURES", pictures.as_os_str()),
            (
                "SANDGATE_LOG",
                OsStr::new(&folder.path().join("out/run.mcap")),
            ),
        ],
    );
}
