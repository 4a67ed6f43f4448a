//! The FMI 2.0 document: scalars only, model structure by place in the list.

use super::description::{
    Enumeration, VALIDITY, enumeration, head, identifier, is_initial_unknown,
    is_known_to_initialisation, is_output, variable_head, variable_value, write_experiment,
    write_log_categories, write_units,
};
use super::xml::{Attributes, Xml};
use super::{FmiVersion, capabilities};
use crate::component::{Causality, Start, ValueKind, Variable, VariableTable};
use crate::scene::Scene;

/// As [`variable_head`], but time is a local variable: FMI Library up to 2.x (libcosim, FMU Compliance Checker) takes
/// `independent` for an error unless it has the start value that the standard forbids, and FMI 2 can do without.
fn head_of_scalar(row: &Variable) -> Attributes {
    if row.causality != Causality::Independent {
        return variable_head(row);
    }
    vec![
        ("name", row.name.clone()),
        ("valueReference", row.reference.to_string()),
        ("description", row.description.clone()),
        ("causality", "local".to_owned()),
        ("variability", "continuous".to_owned()),
        ("initial", "calculated".to_owned()),
    ]
}

pub(super) fn write(xml: &mut Xml, scene: &Scene, table: &VariableTable, token: &str) {
    // FMI 2 has no arrays: their elements are rows of their own.
    let rows: Vec<&Variable> = table
        .rows()
        .iter()
        .filter(|row| row.shape.is_empty())
        .collect();
    xml.begin(
        "fmiModelDescription",
        &head(scene, FmiVersion::V2, ("guid", token)),
    );
    xml.leaf("CoSimulation", &co_simulation(scene));
    write_units(xml, table);
    if rows.iter().any(|row| enumeration(row).is_some()) {
        xml.begin("TypeDefinitions", &vec![]);
        write_type(xml, &VALIDITY);
        xml.end();
    }
    write_log_categories(xml);
    write_experiment(xml, scene);
    xml.begin("ModelVariables", &vec![]);
    for row in &rows {
        xml.begin("ScalarVariable", &head_of_scalar(row));
        let element = match row.kind {
            ValueKind::Real => "Real",
            ValueKind::Integer if enumeration(row).is_some() => "Enumeration",
            ValueKind::Integer => "Integer",
            ValueKind::Boolean => "Boolean",
            ValueKind::Text => "String",
        };
        let mut value = variable_value(row);
        if row.start == Start::Empty {
            value.push(("start", String::new()));
        }
        xml.leaf(element, &value);
        xml.end();
    }
    xml.end();
    write_structure(xml, &rows);
    xml.end();
}

fn co_simulation(scene: &Scene) -> Attributes {
    let mut all = vec![("modelIdentifier", identifier(scene))];
    all.extend(capabilities::attributes(FmiVersion::V2));
    all
}

fn write_type(xml: &mut Xml, enumeration: &Enumeration) {
    xml.begin(
        "SimpleType",
        &vec![
            ("name", enumeration.name.to_owned()),
            ("description", enumeration.description.to_owned()),
        ],
    );
    xml.begin("Enumeration", &vec![]);
    for (name, value, description) in enumeration.items {
        xml.leaf(
            "Item",
            &vec![
                ("name", name.to_owned()),
                ("value", value.to_string()),
                ("description", description.to_owned()),
            ],
        );
    }
    xml.end();
    xml.end();
}

/// Outputs depend on no input at the same instant: they are sampled at the end of a step.
fn write_structure(xml: &mut Xml, rows: &[&Variable]) {
    xml.begin("ModelStructure", &vec![]);
    write_unknowns(xml, "Outputs", rows, is_output, "");
    let known = places(rows, is_known_to_initialisation).map(|place| place.to_string());
    let known = known.collect::<Vec<_>>().join(" ");
    write_unknowns(xml, "InitialUnknowns", rows, is_initial_unknown, &known);
    xml.end();
}

/// Places of rows in the list of variables, from 1.
fn places(rows: &[&Variable], wanted: fn(&Variable) -> bool) -> impl Iterator<Item = usize> {
    let places = (1_usize..).zip(rows);
    places.filter_map(move |(place, row)| wanted(row).then_some(place))
}

fn write_unknowns(
    xml: &mut Xml,
    list: &'static str,
    rows: &[&Variable],
    wanted: fn(&Variable) -> bool,
    dependencies: &str,
) {
    let mut places = places(rows, wanted).peekable();
    if places.peek().is_none() {
        return;
    }
    xml.begin(list, &vec![]);
    for place in places {
        xml.leaf(
            "Unknown",
            &vec![
                ("index", place.to_string()),
                ("dependencies", dependencies.to_owned()),
            ],
        );
    }
    xml.end();
}
