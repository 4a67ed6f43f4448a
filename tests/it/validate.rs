//! `sandgate validate` from outside, and the pages that lie in the repository. Studies are not run here: they are long.

use std::path::Path;
use std::process::Command;

use sandgate::validate::{page, studies};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn validate(arguments: &[&str], folder: &Path) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sandgate"));
    let output = command
        .arg("validate")
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
fn the_list_names_every_study_and_runs_nothing() {
    let folder = temp_dir::TempDir::new().unwrap();
    let (code, out, _) = validate(&["--list"], folder.path());
    assert_eq!(code, Some(0));
    for study in studies::ALL {
        assert!(
            out.contains(study.name) && out.contains(study.title),
            "{out}"
        );
    }
    assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none());
}

#[test]
fn an_unknown_study_is_refused_with_those_there_are() {
    let folder = temp_dir::TempDir::new().unwrap();
    let (code, _, error) = validate(&["colums"], folder.path());
    assert_eq!(code, Some(2), "{error}");
    assert!(
        error.contains("colums") && error.contains("inclined_plane"),
        "{error}"
    );
}

#[test]
fn pages_of_nothing_are_an_index_that_says_so() {
    let folder = temp_dir::TempDir::new().unwrap();
    let (code, out, error) = validate(&["--only-pages"], folder.path());
    assert_eq!(code, Some(0), "{error}");
    assert!(out.contains("nothing is finished"), "{out}");
    let index = folder.path().join("docs/validation/README.md");
    let index = std::fs::read_to_string(index).unwrap();
    assert!(index.contains("not run yet"), "{index}");
}

/// The committed index is made from the committed pages, which say themselves that they are made.
#[test]
fn the_repository_s_index_is_that_of_its_pages() {
    let folder = root().join("docs/validation");
    let index = std::fs::read_to_string(folder.join("README.md")).unwrap();
    assert!(
        index == page::index(&folder, &studies::ALL),
        "docs/validation/README.md is stale: run `sandgate validate --only-pages`"
    );
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|e| e == "md") {
            let text = std::fs::read_to_string(&path).unwrap();
            assert!(
                text.starts_with("<!-- Written by `sandgate validate`; do not edit. -->"),
                "{}",
                path.display()
            );
        }
    }
}

#[test]
fn a_part_of_a_name_chooses_runs_and_one_that_fits_none_is_refused() {
    let folder = temp_dir::TempDir::new().unwrap();
    let quick = ["film", "--quick", "--members"];
    let (code, _, error) = validate(&[&quick[..], &["newtn"]].concat(), folder.path());
    assert_eq!(code, Some(2), "{error}");
    assert!(
        error.contains("newtn") && error.contains("newton_4_h2.0"),
        "{error}"
    );
    let (code, _, error) = validate(&[&quick[..], &["newton_4_h2"]].concat(), folder.path());
    assert_eq!(code, Some(0), "{error}");
    let page = folder.path().join("out/validation/quick/pages/film.md");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("1 of 26 runs"), "{page}");
}
