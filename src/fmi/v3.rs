//! The FMI 3.0 document: arrays and their scalar elements, model structure by value reference.

use super::description::{
    Enumeration, VALIDITY, enumeration, head, identifier, is_initial_unknown,
    is_known_to_initialisation, is_output, variable_head, variable_value, write_experiment,
    write_log_categories, write_units,
};
use super::xml::{Attributes, Xml};
use super::{FmiVersion, capabilities};
use crate::component::{Causality, Start, ValueKind, Variability, Variable, VariableTable};
use crate::scene::Scene;

pub(super) fn write(xml: &mut Xml, scene: &Scene, table: &VariableTable, token: &str) {
    xml.begin(
        "fmiModelDescription",
        &head(scene, FmiVersion::V3, ("instantiationToken", token)),
    );
    xml.leaf("CoSimulation", &co_simulation(scene));
    write_units(xml, table);
    if table.rows().iter().any(|row| enumeration(row).is_some()) {
        xml.begin("TypeDefinitions", &vec![]);
        write_type(xml, &VALIDITY);
        xml.end();
    }
    write_log_categories(xml);
    write_experiment(xml, scene);
    xml.begin("ModelVariables", &vec![]);
    for row in table.rows() {
        write_variable(xml, row);
    }
    xml.end();
    write_structure(xml, table);
    xml.end();
}

fn co_simulation(scene: &Scene) -> Attributes {
    let mut all = vec![("modelIdentifier", identifier(scene))];
    all.extend(capabilities::attributes(FmiVersion::V3));
    all
}

fn write_type(xml: &mut Xml, enumeration: &Enumeration) {
    xml.begin(
        "EnumerationType",
        &vec![
            ("name", enumeration.name.to_owned()),
            ("description", enumeration.description.to_owned()),
        ],
    );
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
}

fn write_variable(xml: &mut Xml, row: &Variable) {
    let element = match row.kind {
        ValueKind::Real => "Float64",
        ValueKind::Integer if enumeration(row).is_some() => "Enumeration",
        ValueKind::Integer => "Int64",
        ValueKind::Boolean => "Boolean",
        ValueKind::Text => "String",
    };
    let mut attributes = variable_head(row);
    // What may be read or set while a step is running.
    let continuous = row.variability == Variability::Continuous;
    if continuous && matches!(row.causality, Causality::Input | Causality::Output) {
        attributes.push(("intermediateUpdate", "true".to_owned()));
    }
    attributes.extend(variable_value(row));
    if row.start == Start::Empty {
        xml.begin(element, &attributes);
        xml.leaf("Start", &vec![("value", String::new())]);
        xml.end();
        return;
    }
    if row.shape.is_empty() {
        xml.leaf(element, &attributes);
        return;
    }
    xml.begin(element, &attributes);
    for extent in &row.shape {
        xml.leaf("Dimension", &vec![("start", extent.to_string())]);
    }
    xml.end();
}

/// Outputs depend on no input at the same instant: they are sampled at the end of a step.
fn write_structure(xml: &mut Xml, table: &VariableTable) {
    xml.begin("ModelStructure", &vec![]);
    for row in table.rows().iter().filter(|row| is_output(row)) {
        xml.leaf(
            "Output",
            &vec![
                ("valueReference", row.reference.to_string()),
                ("dependencies", String::new()),
            ],
        );
    }
    let known = table.rows().iter();
    let known = known.filter(|row| is_known_to_initialisation(row));
    let known: Vec<_> = known.map(|row| row.reference.to_string()).collect();
    for row in table.rows().iter().filter(|row| is_initial_unknown(row)) {
        xml.leaf(
            "InitialUnknown",
            &vec![
                ("valueReference", row.reference.to_string()),
                ("dependencies", known.join(" ")),
            ],
        );
    }
    xml.end();
}
