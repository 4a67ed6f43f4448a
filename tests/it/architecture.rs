//! The house rules that a compiler does not check: who may know whom, module pages, paths named in documents,
//! and things that must not be there.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Ranks of ARCHITECTURE.md. A module uses modules of lower rank, and of its own rank only itself.
const RANKS: [(&str, u8); 22] = [
    ("math", 0),
    ("units", 0),
    ("kernel", 1),
    ("material", 1),
    ("shape", 1),
    ("state", 2),
    ("boundary", 3),
    ("solver", 4),
    ("gauge", 4),
    ("scene", 5),
    ("component", 6),
    ("wire", 7),
    ("whole_file", 7),
    ("fmi", 8),
    ("record", 8),
    ("bus", 8),
    ("report", 9),
    ("validate", 9),
    ("bench", 10),
    ("stress", 11),
    ("cli", 12),
    ("main", 13),
];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// All files below `folder` with this ending, sorted.
fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, ending));
        } else if path.to_string_lossy().ends_with(ending) {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn shown(path: &Path) -> String {
    path.strip_prefix(root()).unwrap().display().to_string()
}

/// Lines without their comments; strings and test modules are left in: enough to find paths and words.
fn code_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines()
        .enumerate()
        .map(|(number, line)| (number + 1, line.split("//").next().unwrap_or_default()))
}

/// The module a file of src/ belongs to: its first folder or its name.
fn module(path: &Path) -> String {
    let inside = path.strip_prefix(root().join("src")).unwrap();
    let first = inside.iter().next().unwrap().to_string_lossy().into_owned();
    first.trim_end_matches(".rs").to_owned()
}

/// Modules named after `path` (`crate::`) in a line, also in `use crate::{a, b::c}`.
fn named_modules(text: &str, path: &str) -> Vec<(usize, String)> {
    let mut found = Vec::new();
    let code: String = code_lines(text)
        .map(|(_, line)| format!("{line}\n"))
        .collect();
    for (at, _) in code.match_indices(path) {
        let before = code[..at].chars().next_back();
        if before.is_some_and(|c| c.is_alphanumeric() || c == '_') {
            continue;
        }
        let line = code[..at].matches('\n').count() + 1;
        let rest = &code[at + path.len()..];
        let names: Vec<String> = match rest.strip_prefix('{') {
            Some(list) => top_level_names(list),
            None => vec![leading_name(rest)],
        };
        found.extend(names.into_iter().map(|name| (line, name)));
    }
    found
}

fn leading_name(text: &str) -> String {
    text.trim_start()
        .chars()
        .take_while(|c| c.is_alphanumeric() || *c == '_')
        .collect()
}

/// First names of the entries of `a, b::{c, d}, e}`.
fn top_level_names(list: &str) -> Vec<String> {
    let mut names = Vec::new();
    let (mut depth, mut entry) = (0, String::new());
    for c in list.chars() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                names.push(leading_name(&entry));
                entry.clear();
                continue;
            }
            _ => {}
        }
        entry.push(c);
    }
    names.push(leading_name(&entry));
    names.retain(|name| !name.is_empty());
    names
}

#[test]
fn modules_use_only_what_lies_below_them() {
    let rank = |name: &str| {
        RANKS
            .iter()
            .find(|(n, _)| *n == name)
            .map(|(_, rank)| *rank)
    };
    let mut wrong = Vec::new();
    let mut seen = BTreeSet::new();
    for path in files(&root().join("src"), ".rs") {
        let user = module(&path);
        if user == "lib" {
            continue;
        }
        let Some(own) = rank(&user) else {
            wrong.push(format!("{}: module {user} has no rank", shown(&path)));
            continue;
        };
        seen.insert(user.clone());
        for (line, used) in named_modules(&std::fs::read_to_string(&path).unwrap(), "crate::") {
            let allowed = used == user || rank(&used).is_some_and(|other| other < own);
            if !allowed {
                wrong.push(format!(
                    "{}:{line}: {user} must not use {used}",
                    shown(&path)
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    // The test would be worthless if it looked at the wrong folder.
    for module in ["solver", "scene", "component", "cli"] {
        assert!(seen.contains(module), "no file of {module} was looked at");
    }
}

/// What ARCHITECTURE.md says of the packages in fmu/.
#[test]
fn the_shared_libraries_use_what_the_page_says() {
    let used = |folder: &str| -> BTreeSet<String> {
        let texts = files(&root().join(folder), ".rs").into_iter();
        texts
            .map(|path| std::fs::read_to_string(path).unwrap())
            .flat_map(|text| named_modules(&text, "sandgate::"))
            .map(|(_, name)| name)
            .collect()
    };
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let from = text
        .find("The package in `fmu/` uses")
        .expect("ARCHITECTURE.md says what the package in fmu/ uses");
    let paragraph = text[from..].split("\n`src/").next().unwrap();
    let said: BTreeSet<String> = paragraph
        .split('`')
        .skip(1)
        .step_by(2)
        .filter(|word| *word != "cli" && RANKS.iter().any(|(module, _)| module == word))
        .map(str::to_owned)
        .collect();
    assert_eq!(used("fmu"), said);
}

#[test]
fn the_rule_finds_what_it_should() {
    let text = "use crate::{scene::{a, b}, bus};\nfn f() { crate::cli::main() } // crate::fmi\nuse mycrate::x;";
    let found: Vec<String> = named_modules(text, "crate::")
        .into_iter()
        .map(|(_, name)| name)
        .collect();
    assert_eq!(found, ["scene", "bus", "cli"]);
}

#[test]
fn every_module_opens_with_its_page() {
    let folders = ["src", "fmu/src", "tests", "examples", "benches"];
    let bare: Vec<String> = folders
        .iter()
        .map(|folder| root().join(folder))
        .filter(|folder| folder.is_dir())
        .flat_map(|folder| files(&folder, ".rs"))
        .filter(|path| !std::fs::read_to_string(path).unwrap().starts_with("//! "))
        .map(|path| shown(&path))
        .collect();
    assert!(bare.is_empty(), "no `//!` on the first line of: {bare:?}");
}

#[test]
fn nothing_is_unsafe_unfinished_or_switched_off() {
    let forbid = "#![forbid(unsafe_code)]";
    let lib = std::fs::read_to_string(root().join("src/lib.rs")).unwrap();
    assert!(lib.contains(forbid), "src/lib.rs lost {forbid}");
    // Built from pieces, so that this file does not find itself.
    let unfinished = ["todo", "unimplemented", "dbg"].map(|name| format!("{name}!("));
    let off = format!("#[{}", "ignore");
    let mut wrong = Vec::new();
    for folder in ["src", "fmu/src", "tests"] {
        for path in files(&root().join(folder), ".rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            for (number, line) in code_lines(&text) {
                let bad = unfinished.iter().any(|word| line.contains(word))
                    || line.contains(&off)
                    || (folder == "src" && line.contains("unsafe ") && !line.contains("forbid"));
                if bad {
                    wrong.push(format!("{}:{number}: {}", shown(&path), line.trim()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Documents whose paths must exist.
fn documents() -> Vec<PathBuf> {
    let mut documents: Vec<PathBuf> = [
        "README.md",
        "ARCHITECTURE.md",
        "CONTRIBUTING.md",
        "fmu/README.md",
    ]
    .iter()
    .map(|name| root().join(name))
    .collect();
    documents.extend(files(&root().join("docs"), ".md"));
    documents.extend(files(&root().join("cases"), ".md"));
    documents
}

/// What looks like a path of the tree in backticks, or as the target of a link.
fn named_paths(text: &str) -> BTreeSet<String> {
    let mut paths = BTreeSet::new();
    // Pictures of data flow and commands stand between fences.
    let prose: String = text.split("```").step_by(2).collect();
    let ticks = prose.split('`').skip(1).step_by(2);
    for word in ticks.flat_map(str::split_whitespace) {
        let folders = [
            "src/",
            "fmu/",
            "cases/",
            "tests/",
            "docs/",
            "include/",
            "examples/",
            "benches/",
            ".ci/",
        ];
        if folders.iter().any(|folder| word.starts_with(folder)) {
            paths.insert(word.to_owned());
        }
    }
    for target in text
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split(')').next())
    {
        if !target.contains("://") && !target.starts_with('#') {
            paths.insert(target.split('#').next().unwrap().to_owned());
        }
    }
    paths
}

#[test]
fn every_path_named_in_the_documents_exists() {
    let mut missing = Vec::new();
    let mut checked = 0;
    for document in documents() {
        let text = std::fs::read_to_string(&document)
            .unwrap_or_else(|error| panic!("{}: {error}", shown(&document)));
        for path in named_paths(&text) {
            // `src/material/<name>.rs`, `cases/NAME.toml` and `cases/*.toml` are patterns; `src/lib.rs:12` names a line.
            let plain = path
                .split(':')
                .next()
                .unwrap()
                .trim_end_matches([',', '.', ';']);
            let pattern = plain.contains(['<', '*', '{']) || plain.contains("NAME");
            if pattern || plain.is_empty() {
                continue;
            }
            checked += 1;
            let beside = document.parent().unwrap().join(plain);
            if !root().join(plain).exists() && !beside.exists() {
                missing.push(format!("{}: {plain}", shown(&document)));
            }
        }
    }
    assert!(
        missing.is_empty(),
        "paths that do not exist:\n{}",
        missing.join("\n")
    );
    assert!(
        checked > 30,
        "only {checked} paths were found in the documents"
    );
}

#[test]
fn the_layer_table_of_the_document_is_the_one_tested() {
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let shown: BTreeSet<String> = text
        .lines()
        .filter_map(|line| {
            let mut cells = line.strip_prefix("| ")?.split(" | ");
            let rank: u32 = cells.next()?.parse().ok()?;
            Some(format!("{rank} {}", cells.next()?.trim_matches('`')))
        })
        .collect();
    // The program itself is above them all, and no module.
    let tested = RANKS.iter().filter(|(module, _)| *module != "main");
    let tested: BTreeSet<String> = tested
        .map(|(module, rank)| format!("{rank} {module}"))
        .collect();
    assert_eq!(shown, tested);
    let lines = text.lines().count();
    assert!(
        lines <= 150,
        "ARCHITECTURE.md has {lines} lines, allowed 150"
    );
}

#[test]
fn ci_runs_the_readme_s_test_command() {
    let ci = std::fs::read_to_string(root().join(".ci/run")).unwrap();
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    for command in [
        "cargo run --release -- run cases/silo_gate.toml",
        "cargo test --release",
    ] {
        assert!(readme.contains(command), "README.md lost `{command}`");
    }
    let words: Vec<&str> = ci.lines().map(str::trim).collect();
    for command in ["cargo test --release", "cargo fmt --all --check"] {
        assert!(words.contains(&command), ".ci/run lost `{command}`");
    }
}
