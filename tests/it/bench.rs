//! `sandgate bench` from outside, and the page that lies in the repository. Nothing here asserts a time.

use std::path::Path;
use std::process::Command;

use sandgate::bench::phases::PhasesRun;
use sandgate::bench::precision::{self, PrecisionRun};
use sandgate::bench::{SpeedRun, page, stored};

fn bench(arguments: &[&str], folder: &Path) -> (Option<i32>, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_sandgate"))
        .arg("bench")
        .args(arguments)
        .current_dir(folder)
        .output()
        .unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (
        output.status.code(),
        text(&output.stdout),
        text(&output.stderr),
    )
}

#[test]
fn a_quick_run_is_kept_and_makes_its_page() {
    let folder = temp_dir::TempDir::new().unwrap();
    let quick = ["speed", "--quick", "--name", "try", "--page", "page.md"];
    let (code, out, error) = bench(&quick, folder.path());
    assert_eq!(code, Some(0), "{error}");
    let run: SpeedRun = stored(&folder.path().join("benches/runs/try.json")).unwrap();
    assert!(run.quick);
    let text = std::fs::read_to_string(folder.path().join("page.md")).unwrap();
    assert_eq!(text, page::text(&run));
    assert!(text.starts_with(page::MADE) && text.contains("judge nothing"));
    for demand in page::demands(&run) {
        assert!(out.contains(demand.what) && text.contains(&demand.measured));
    }
    assert!(out.contains("nothing of this is judged"), "{out}");
    let verdicts = ["not met", "; met", "| met", "verdict"];
    let judged = |text: &str| verdicts.iter().any(|word| text.contains(word));
    assert!(!judged(&out) && !judged(&text), "{out}{text}");
    let no_number = ["NaN", "inf "];
    assert!(no_number.iter().all(|word| !text.contains(word)), "{text}");
    for kernels in &run.kernels {
        assert!(kernels.disagreement < 1e-11);
        assert_eq!(kernels.passes.len(), 5);
    }
    assert!(run.paper_a.ratio().is_finite() && run.paper_a.ratio() > 0.0);
    // The page is written again from what was kept, without timing anything.
    let again = [
        "speed",
        "--name",
        "try",
        "--only-page",
        "--page",
        "again.md",
    ];
    let (code, _, error) = bench(&again, folder.path());
    assert_eq!(code, Some(0), "{error}");
    assert_eq!(
        std::fs::read_to_string(folder.path().join("again.md")).unwrap(),
        text
    );
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = temp_dir::TempDir::new().unwrap();
    for (arguments, said) in [
        (&["speed", "--paper-a-budget", "0"][..], "above 0"),
        (&["speed", "--name", "../x"], "letters"),
        (&["speed", "--only-page"], "--page"),
    ] {
        let (code, _, error) = bench(arguments, folder.path());
        assert_eq!(code, Some(2), "{error}");
        assert!(error.contains(said), "{error}");
    }
    let missing = ["speed", "--only-page", "--page", "page.md"];
    let (code, _, error) = bench(&missing, folder.path());
    assert_eq!(code, Some(5));
    assert!(error.contains("speed.json"), "{error}");
    std::fs::create_dir_all(folder.path().join("benches/runs")).unwrap();
    std::fs::write(folder.path().join("benches/runs/speed.json"), "{}").unwrap();
    let (code, _, error) = bench(&missing, folder.path());
    assert_eq!(code, Some(5));
    assert!(error.contains("anew"), "{error}");
}

#[test]
fn the_page_in_the_repository_is_that_of_the_run_in_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let run: SpeedRun = stored(&root.join("benches/runs/speed.json")).unwrap();
    assert!(!run.quick);
    let text = std::fs::read_to_string(root.join("docs/performance.md")).unwrap();
    assert_eq!(
        text,
        page::text(&run),
        "docs/performance.md is stale; run: sandgate bench speed --only-page --page docs/performance.md"
    );
}

#[test]
fn phases_that_a_scene_lacks_change_no_bit_of_it() {
    let folder = temp_dir::TempDir::new().unwrap();
    let (code, out, error) = bench(&["phases", "--quick", "--page", "page.md"], folder.path());
    assert_eq!(code, Some(0), "{error}");
    let run: PhasesRun = stored(&folder.path().join("benches/runs/phases.json")).unwrap();
    assert!(run.quick && run.phases.same);
    let [alone, _, unused, tub, ..] = &run.phases.stretches[..] else {
        panic!("{run:?}");
    };
    assert_eq!(alone.particles, unused.particles);
    assert_eq!(alone.particles + 50, tub.particles);
    let text = std::fs::read_to_string(folder.path().join("page.md")).unwrap();
    assert_eq!(text, page::phases::text(&run));
    for stretch in &run.phases.stretches {
        assert!(out.contains(&stretch.name) && text.contains(&stretch.name));
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let run: PhasesRun = stored(&root.join("benches/runs/phases.json")).unwrap();
    assert!(!run.quick && run.phases.same);
    assert_eq!(
        std::fs::read_to_string(root.join("docs/phases.md")).unwrap(),
        page::phases::text(&run),
        "docs/phases.md is stale; run: sandgate bench phases --only-page --page docs/phases.md"
    );
}

#[test]
fn the_page_of_precision_and_its_figures_are_those_of_the_run() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let run: PrecisionRun = stored(&root.join("benches/runs/precision.json")).unwrap();
    let text = std::fs::read_to_string(root.join("docs/precision.md")).unwrap();
    assert!(
        text == precision::text(&run),
        "docs/precision.md is stale; run: sandgate bench precision --only-page --page docs/precision.md"
    );
    for study in &precision::STUDIES {
        let figure = root.join(format!("docs/precision_{}.svg", study.name));
        let figure = std::fs::read_to_string(figure).unwrap();
        assert!(
            figure == precision::figure(study, &run).unwrap(),
            "{}",
            study.name
        );
    }
}
