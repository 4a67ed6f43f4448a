//! terminalsAndIcons/terminalsAndIcons.xml of FMI 3: a terminal for each gate, inflow, outflow, gauge and wall with
//! variables, so that an importer can connect a device as a whole, and where they stand round the icon.
//!
//! A variable `kind.name.member` belongs to terminal `kind.name`. The matching rule is "bus": members of the same name
//! are connected, and a partner need not have all of them. Inputs stand on the left of the icon, the others on the right.

use super::xml::{Attributes, Xml};
use crate::component::{Causality, Component, Variable};

/// Icon of the whole FMU: a hopper, its gate and a pile.
pub(super) const ICON_PNG: &[u8] = include_bytes!("icon/icon.png");
/// The same drawing without pixels.
pub(super) const ICON_SVG: &[u8] = include_bytes!("icon/icon.svg");

/// Half the width of the icon in its coordinate system [1].
const HALF: f64 = 100.0;

/// A device or gauge and its variables.
struct Terminal<'a> {
    kind: &'a str,
    name: &'a str,
    members: Vec<(&'a str, &'a Variable)>,
}

/// The document.
pub(super) fn terminals(component: &Component) -> String {
    let terminals = grouped(component.variables().rows());
    let mut xml = Xml::document();
    xml.begin("fmiTerminalsAndIcons", &text(&[("fmiVersion", "3.0")]));
    xml.begin("GraphicalRepresentation", &vec![]);
    let mut system = corners(-HALF, -HALF, HALF, HALF);
    system.push(("suggestedScalingFactorTo_mm", "0.1".to_owned()));
    xml.leaf("CoordinateSystem", &system);
    xml.leaf("Icon", &corners(-HALF, -HALF, HALF, HALF));
    xml.end();
    if !terminals.is_empty() {
        xml.begin("Terminals", &vec![]);
        for terminal in &terminals {
            write(&mut xml, terminal, place(terminal, &terminals));
        }
        xml.end();
    }
    xml.finish()
}

/// Rows named `kind.name.member`, by kind and name in the order of the table; elements of arrays left out.
fn grouped(rows: &[Variable]) -> Vec<Terminal<'_>> {
    let mut terminals: Vec<Terminal<'_>> = Vec::new();
    for row in rows.iter().filter(|row| row.element_of.is_none()) {
        let mut parts = row.name.splitn(3, '.');
        let (Some(kind), Some(name), Some(member)) = (parts.next(), parts.next(), parts.next())
        else {
            continue;
        };
        let same = |t: &&mut Terminal<'_>| t.kind == kind && t.name == name;
        match terminals.iter_mut().find(same) {
            Some(terminal) => terminal.members.push((member, row)),
            None => terminals.push(Terminal {
                kind,
                name,
                members: vec![(member, row)],
            }),
        }
    }
    terminals
}

fn write(xml: &mut Xml, terminal: &Terminal<'_>, (x, y): (f64, f64)) {
    let full = format!("{}.{}", terminal.kind, terminal.name);
    xml.begin(
        "Terminal",
        &text(&[
            ("name", full.as_str()),
            ("matchingRule", "bus"),
            ("terminalKind", &format!("org.sandgate.{}", terminal.kind)),
            (
                "description",
                &format!("{} {}", terminal.kind, terminal.name),
            ),
        ]),
    );
    for (member, row) in &terminal.members {
        xml.leaf(
            "TerminalMemberVariable",
            &text(&[
                ("variableName", row.name.as_str()),
                ("memberName", member),
                ("variableKind", "signal"),
            ]),
        );
    }
    let mut picture = corners(x - 5.0, y - 5.0, x + 5.0, y + 5.0);
    picture.push(("iconBaseName", "icon".to_owned()));
    xml.leaf("TerminalGraphicalRepresentation", &picture);
    xml.end();
}

/// Middle of a terminal: with inputs on the left edge of the icon, else on the right one, evenly spaced.
fn place(terminal: &Terminal<'_>, all: &[Terminal<'_>]) -> (f64, f64) {
    let takes_input =
        |t: &Terminal<'_>| t.members.iter().any(|m| m.1.causality == Causality::Input);
    let left = takes_input(terminal);
    let side: Vec<_> = all.iter().filter(|t| takes_input(t) == left).collect();
    let index = side.iter().position(|t| std::ptr::eq(*t, terminal));
    let step = 2.0 * HALF / (side.len() + 1) as f64;
    let y = HALF - step * (index.unwrap_or(0) + 1) as f64;
    (if left { -HALF } else { HALF }, y)
}

fn corners(x1: f64, y1: f64, x2: f64, y2: f64) -> Attributes {
    let corners = [("x1", x1), ("y1", y1), ("x2", x2), ("y2", y2)];
    corners
        .into_iter()
        .map(|(key, value)| (key, super::xml::number(value)))
        .collect()
}

fn text(pairs: &[(&'static str, &str)]) -> Attributes {
    pairs
        .iter()
        .map(|(key, value)| (*key, (*value).to_owned()))
        .collect()
}
