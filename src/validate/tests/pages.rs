//! Pages of studies: what was found, and whether it is current.

use super::*;
use std::path::Path;

/// Of the recordings that a store has.
fn look(store: &Store) -> Found {
    Found::new(&STUDY, Effort::Full, store).unwrap()
}

fn page(pages: &Path) -> String {
    std::fs::read_to_string(pages.join("drops.md")).unwrap()
}

#[test]
fn pages_say_what_was_found_and_whether_it_is_current() {
    let desk = Desk::new();
    let pages = desk.pages();
    let page = || page(&pages);
    page::write(&pages, &STUDY, &look(&desk.store), None).unwrap();
    assert!(
        page().contains("**no result**") && page().contains("0 of 4 runs"),
        "{}",
        page()
    );
    assert!(page().starts_with("<!-- Written by `sandgate validate`; do not edit. -->\n"));
    run_all(&desk);
    assert_eq!(
        page::standing(&pages, &STUDY, &look(&desk.store)),
        Standing::Stale
    );

    let summary = page::write(&pages, &STUDY, &look(&desk.store), None).unwrap();
    assert_eq!(
        (summary.met, summary.short, summary.missing, summary.members),
        (1, 0, 0, (4, 4))
    );
    assert_eq!(Summary::read(&page()), Some(summary));
    assert!(
        page().contains("| met |") && page().contains("drops_none.svg"),
        "{}",
        page()
    );
    assert!(pages.join("drops_none.svg").exists());
    assert_eq!(
        page::standing(&pages, &STUDY, &look(&desk.store)),
        Standing::Current
    );
    // Again from the same recordings: the same bytes.
    let before = page();
    page::write(&pages, &STUDY, &look(&desk.store), None).unwrap();
    assert_eq!(page(), before);
}

#[test]
fn pages_of_another_solver_and_of_quick_runs_say_so_and_the_index_has_their_verdicts() {
    let desk = Desk::new();
    let pages = desk.pages();
    let page = || page(&pages);
    run_all(&desk);
    // Another solver: the recordings are old, and the page says so.
    let newer = Store::new(desk.folder.path(), "sources-2");
    assert_eq!(look(&newer).outdated, 4);
    page::write(&pages, &STUDY, &look(&newer), None).unwrap();
    assert!(page().contains("4 of 4 runs are older"), "{}", page());
    let quick = Found::new(&STUDY, Effort::Quick, &newer).unwrap();
    page::write(&pages, &STUDY, &quick, None).unwrap();
    assert!(page().contains("judge nothing"), "{}", page());
    page::write(&pages, &STUDY, &look(&newer), None).unwrap();

    page::write_index(&pages, &[STUDY]).unwrap();
    let index = std::fs::read_to_string(pages.join("README.md")).unwrap();
    assert!(
        index.contains("[drops](drops.md)") && index.contains("met (1 of 1)"),
        "{index}"
    );
    page::write_index(Path::new(&desk.folder.path().join("empty")), &[STUDY]).unwrap();
}
