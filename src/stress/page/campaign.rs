//! What the checks ask, what was tried by kinds of scenes, and the cases that were kept.

use super::{Kept, Stored, table};
use crate::stress::{Check, Figures, generate};
use crate::validate::report::number;

pub(super) fn checks() -> String {
    let rows: Vec<Vec<String>> = Check::ALL
        .iter()
        .map(|(_, name, what)| vec![format!("`{name}`"), (*what).to_owned()])
        .collect();
    format!(
        "## Checks\n\n{}\n\nEnergy: what the pressure may give is 1 % of M g H + the kinetic energy at the start (elastic energy at \
         the scheme's Mach number is gH/200 a kilogram), and half of phi_max/phi_min - 1 of it where the material has a grain \
         size: by (M3) sheared material loosens and lifts what lies above it, which no friction pays for. The work of gates is taken internal step by internal step, with the mean of the forces before and \
         after each move, where the account of whole communication steps finds growth; a belt without friction does none. Not checked where a \
         wall turns (its work needs a torque) or gravity has a part along a periodic side.",
        table(&["check", "what it asks"], &rows)
    )
}

pub(super) fn kinds(stored: &Stored) -> String {
    let about = |name: &str| generate::by_name(name).map_or("", |k| k.about);
    let rows: Vec<Vec<String>> = stored
        .run
        .kinds
        .iter()
        .map(|k| {
            let f = &k.figures;
            vec![
                k.kind.clone(),
                about(&k.kind).to_owned(),
                k.scenes.to_string(),
                if k.failed > 0 {
                    format!("**{}**", k.failed)
                } else {
                    "0".to_owned()
                },
                f.internal_steps.to_string(),
                f.particles.to_string(),
                format!("{:.1}", f.cpu),
                k.slept.to_string(),
            ]
        })
        .collect();
    let head = [
        "kind",
        "what it is",
        "scenes",
        "failed",
        "internal steps",
        "most particles",
        "CPU s",
        "slept",
    ];
    format!("## Scenes by kind\n\n{}", table(&head, &rows))
}

pub(super) fn bounds(stored: &Stored) -> String {
    let most = |of: &dyn Fn(&Figures) -> f64| {
        stored
            .run
            .kinds
            .iter()
            .map(|k| of(&k.figures))
            .fold(0.0, f64::max)
    };
    let rows = [
        (
            "growth of energy over what was given, of M g H",
            most(&|f| f.energy_excess),
            "0.01 and dilatancy",
        ),
        (
            "miss of momentum, of what is allowed",
            most(&|f| f.momentum_error),
            "1",
        ),
        ("speed, of what is allowed", most(&|f| f.speed_share), "1"),
        (
            "share of a particle's neighbourhood that is wall",
            most(&|f| f.deepest),
            "0.9",
        ),
        (
            "centre of mass of a rest, over dp",
            most(&|f| f.creep),
            "0.01",
        ),
    ];
    let rows: Vec<Vec<String>> = rows
        .iter()
        .map(|(what, value, allowed)| {
            vec![(*what).to_owned(), number(*value), (*allowed).to_owned()]
        })
        .collect();
    format!(
        "The worst of all scenes, failed ones included:\n\n{}",
        table(&["figure", "worst", "allowed"], &rows)
    )
}

pub(super) fn cases(stored: &Stored) -> String {
    let rows = |kept: &[Kept], folder: &str| -> Vec<Vec<String>> {
        kept.iter()
            .map(|k| {
                let said = k.head.iter().skip(1).map(|line| {
                    let mut line = line.replace('|', "/");
                    if let Some((at, _)) = line.char_indices().nth(160) {
                        line.truncate(at);
                        line.push_str("...");
                    }
                    line
                });
                vec![
                    format!("[{0}](../{folder}/{0})", k.name),
                    said.take(1).collect::<Vec<_>>().join(" "),
                    k.case.drive.note.clone(),
                ]
            })
            .collect()
    };
    let fixed = table(
        &["case", "it said", "why, and the fix"],
        &rows(&stored.fixed, "cases/stress"),
    );
    let open = if stored.open.is_empty() {
        "No case is open: none that still fails.".to_owned()
    } else {
        format!(
            "These still fail, and the test command says so as soon as one of them does not:\n\n{}",
            table(
                &["case", "it says", "what is known"],
                &rows(&stored.open, "cases/stress/open")
            )
        )
    };
    format!(
        "## Cases\n\nWhat failed on the way, made smaller by the program. They pass now and are part of the test command:\n\n{fixed}\n\n{open}"
    )
}
