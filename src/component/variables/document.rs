//! docs/variables.md, written from the table: which variables each kind of device brings, and those of each case.

use std::fmt::Write;

use super::{Causality, Start, ValueKind, Variability, Variable, VariableTable};
use crate::scene::Scene;

const HEAD: &str = "# Variables

Written by `SANDGATE_REGENERATE=1 cargo test --release variables` from the one table in
src/component/variables/rows.rs; a test fails when it is stale.

Every adapter shows these names: FMI 2 and 3, the C ABI, Zenoh, MCAP and `sandgate run`; `log.path`, `log.required` and `zenoh.config` are for
FMI and C alone. Value references are those of FMI and C. Names in brackets, `depth[1]`, are the elements of an array; FMI 2 lists elements only, FMI 3 both.

An input is held over a communication step. All outputs are sampled once, at the end of a step (and once before the
first), so reading them is cheap and never changes anything. Gates, inflows and steered walls start from the scene's own start values
and move only in steps. A reading whose `validity` is not 0 is 0.

Extensive values of a planar scene (mass, force, discharge) are for the scene's out-of-plane width, those of an
axisymmetric scene for whole rings (there x is the radius; force_x is the sum of radial forces around the ring).
";

/// The text of docs/variables.md for these scenes; `more` have devices that none of them has.
#[must_use]
pub fn variables_markdown(scenes: &[Scene], more: &[Scene]) -> String {
    let mut text = HEAD.to_owned();
    text += "\n## What each device brings\n\n";
    text +=
        "| variable | causality | kind | unit | shown in | meaning |\n|---|---|---|---|---|---|\n";
    let mut seen: Vec<String> = Vec::new();
    for scene in scenes.iter().chain(more) {
        for row in VariableTable::of(scene).rows() {
            let name = general_name(&row.name);
            if row.element_of.is_some() || seen.contains(&name) {
                continue;
            }
            let device = row.name.split('.').nth(1).unwrap_or_default();
            let meaning = row.description.replace(&format!(" {device}"), " NAME");
            let meaning = meaning.replace(&format!(".{device}."), ".NAME.");
            let general = is_device(&row.name);
            let meaning = if general {
                meaning
            } else {
                row.description.clone()
            };
            line(
                &mut text,
                &[
                    &code(&name, row),
                    causality(row),
                    kind(row),
                    row.unit,
                    shown(row),
                    &meaning,
                ],
            );
            seen.push(name);
        }
    }
    for scene in scenes {
        case(&mut text, scene);
    }
    text
}

fn case(text: &mut String, scene: &Scene) {
    // Writing to a String cannot fail.
    let _ = write!(text, "\n## {}\n\n{}\n\n", scene.name, scene.title);
    *text +=
        "| reference | variable | causality | start | range | unit |\n|---|---|---|---|---|---|\n";
    for row in VariableTable::of(scene).rows() {
        if row.element_of.is_some_and(|(_, k)| k > 0) {
            continue; // the array's row and its first element say it all
        }
        let reference = row.reference.to_string();
        let start = match &row.start {
            Start::Exact(values) => values
                .iter()
                .map(f64::to_string)
                .collect::<Vec<_>>()
                .join(" "),
            Start::Empty => "\"\"".to_owned(),
            Start::Calculated => String::new(),
        };
        let range = row
            .range
            .map_or(String::new(), |(least, most)| format!("{least} to {most}"));
        line(
            text,
            &[
                &reference,
                &code(&row.name, row),
                causality(row),
                &start,
                &range,
                row.unit,
            ],
        );
    }
}

fn line(text: &mut String, cells: &[&str]) {
    for cell in cells {
        let _ = write!(text, "| {cell} ");
    }
    *text += "|\n";
}

/// Whether the second part of a name is a name of the scene.
fn is_device(name: &str) -> bool {
    [
        "material.",
        "wall.",
        "gate.",
        "inflow.",
        "outflow.",
        "gauge.",
    ]
    .iter()
    .any(|kind| name.starts_with(kind))
}

/// A device's own name replaced by NAME.
fn general_name(name: &str) -> String {
    let mut parts: Vec<&str> = name.split('.').collect();
    if is_device(name) && parts.len() == 3 {
        parts[1] = "NAME";
    }
    parts.join(".")
}

fn code(name: &str, row: &Variable) -> String {
    let shape: String = row.shape.iter().map(|n| format!(" ({n} values)")).collect();
    format!("`{name}`{shape}")
}

fn causality(row: &Variable) -> &'static str {
    match (row.causality, row.variability) {
        (Causality::Independent, _) => "independent",
        (Causality::Parameter, Variability::Tunable) => "parameter (tunable)",
        (Causality::Parameter, _) => "parameter (fixed)",
        (Causality::Input, _) => "input",
        (Causality::Output, _) => "output",
    }
}

fn kind(row: &Variable) -> &'static str {
    match row.kind {
        ValueKind::Real => "real",
        ValueKind::Integer => "whole number",
        ValueKind::Boolean => "flag",
        ValueKind::Text => "text",
    }
}

fn shown(row: &Variable) -> &'static str {
    row.display_unit.map_or("", |(unit, _)| unit)
}
