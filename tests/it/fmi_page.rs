//! docs/fmi.md: not stale, and every test that it names is there.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use sandgate::fmi::capabilities::{fmi_markdown, proofs};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// SANDGATE_REGENERATE=1 writes the page anew.
#[test]
fn fmi_page_is_not_stale() {
    let path = root().join("docs/fmi.md");
    let text = fmi_markdown();
    if std::env::var_os("SANDGATE_REGENERATE").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let found = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        found == text,
        "docs/fmi.md is stale; run: SANDGATE_REGENERATE=1 cargo test --release fmi_page"
    );
}

#[test]
fn fmi_page_names_tests_that_exist() {
    let mut sources = String::new();
    for folder in [
        "tests/it",
        "tests/contract",
        "tests/python",
        "fmu/src",
        "src/component",
    ] {
        read(&root().join(folder), &mut sources);
    }
    let names: BTreeSet<_> = proofs().collect();
    assert!(names.len() > 30);
    for name in names {
        let (rust, python) = (format!("fn {name}("), format!("def {name}("));
        assert!(
            sources.contains(&rust) || sources.contains(&python),
            "no test is called {name}"
        );
    }
}

fn read(folder: &Path, into: &mut String) {
    let entries = std::fs::read_dir(folder).unwrap();
    let paths: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    for path in paths {
        if path.is_dir() {
            read(&path, into);
        } else if path.extension().is_some_and(|e| e == "rs" || e == "py") {
            into.push_str(&std::fs::read_to_string(path).unwrap());
        }
    }
}
