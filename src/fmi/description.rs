//! modelDescription.xml: what both versions of the standard share. `v2` and `v3` write the two documents.

use std::fmt::Write;

use sha2::{Digest, Sha256};

use super::unit::units;
use super::xml::{Attributes, Xml, number};
use super::{FmiVersion, LOG_CATEGORIES, v2, v3};
use crate::component::{
    Causality, Component, Start, ValueKind, Variability, Variable, VariableTable,
};
use crate::scene::Scene;

/// modelDescription.xml of a component: variables, units, model structure, default experiment.
#[must_use]
pub fn description(component: &Component, version: FmiVersion) -> String {
    let (scene, table) = (component.scene(), component.variables());
    write_document(scene, table, version, &token(component, version))
}

/// Instantiation token (`guid` of FMI 2): a hash of the description, of the scene and of the program's version.
///
/// The library computes it again when it is instantiated, so a description that belongs to another scene or another
/// version of the library is noticed at once.
#[must_use]
pub fn token(component: &Component, version: FmiVersion) -> String {
    let (scene, table) = (component.scene(), component.variables());
    let mut hash = Sha256::new();
    hash.update(env!("CARGO_PKG_VERSION"));
    hash.update([0]);
    hash.update(write_document(scene, table, version, ""));
    hash.update([0]);
    hash.update(&scene.source);
    let mut token = String::from("{");
    for (i, byte) in hash.finalize().iter().take(16).enumerate() {
        if matches!(i, 4 | 6 | 8 | 10) {
            token.push('-');
        }
        // Writing to a String cannot fail.
        let _ = write!(token, "{byte:02x}");
    }
    token.push('}');
    token
}

/// Name of the binary in the archive: the scene's name, made a C identifier.
#[must_use]
pub fn identifier(scene: &Scene) -> String {
    let digit = scene.name.starts_with(|c: char| c.is_ascii_digit());
    let prefix = if digit { "_" } else { "" };
    let rest = scene.name.chars().map(|c| match c {
        c if c.is_ascii_alphanumeric() => c,
        _ => '_',
    });
    prefix.chars().chain(rest).collect()
}

fn write_document(
    scene: &Scene,
    table: &VariableTable,
    version: FmiVersion,
    token: &str,
) -> String {
    let mut xml = Xml::document();
    match version {
        FmiVersion::V2 => v2::write(&mut xml, scene, table, token),
        FmiVersion::V3 => v3::write(&mut xml, scene, table, token),
    }
    xml.finish()
}

/// Attributes of the root element behind the version and before the token.
pub(super) fn head(scene: &Scene, version: FmiVersion, token: (&'static str, &str)) -> Attributes {
    vec![
        ("fmiVersion", version.name().to_owned()),
        ("modelName", scene.name.clone()),
        (token.0, token.1.to_owned()),
        ("description", scene.title.clone()),
        ("version", env!("CARGO_PKG_VERSION").to_owned()),
        ("license", env!("CARGO_PKG_LICENSE").to_owned()),
        (
            "generationTool",
            concat!("Sandgate ", env!("CARGO_PKG_VERSION")).to_owned(),
        ),
        ("variableNamingConvention", "structured".to_owned()),
    ]
}

/// `UnitDefinitions`, the same in both versions.
pub(super) fn write_units(xml: &mut Xml, table: &VariableTable) {
    let units = units(table);
    if units.is_empty() {
        return;
    }
    xml.begin("UnitDefinitions", &vec![]);
    for (name, (base, display)) in units {
        xml.begin("Unit", &vec![("name", name.to_owned())]);
        if let Some(base) = base {
            let powers = [
                ("kg", base.kg),
                ("m", base.m),
                ("s", base.s),
                ("rad", base.rad),
            ];
            let powers = powers.into_iter().filter(|(_, power)| *power != 0);
            xml.leaf(
                "BaseUnit",
                &powers.map(|(k, power)| (k, power.to_string())).collect(),
            );
        }
        for (name, factor) in display {
            xml.leaf(
                "DisplayUnit",
                &vec![("name", name.to_owned()), ("factor", number(factor))],
            );
        }
        xml.end();
    }
    xml.end();
}

/// `LogCategories`, the same in both versions.
pub(super) fn write_log_categories(xml: &mut Xml) {
    xml.begin("LogCategories", &vec![]);
    for (name, description) in LOG_CATEGORIES {
        xml.leaf(
            "Category",
            &vec![
                ("name", name.to_owned()),
                ("description", description.to_owned()),
            ],
        );
    }
    xml.end();
}

/// `DefaultExperiment`: the scene's own run. The tolerance is that of the viscous solve.
pub(super) fn write_experiment(xml: &mut Xml, scene: &Scene) {
    xml.leaf(
        "DefaultExperiment",
        &vec![
            ("startTime", number(0.0)),
            ("stopTime", number(scene.run.until)),
            ("tolerance", number(scene.numerics.solver_tolerance)),
            ("stepSize", number(scene.run.step)),
        ],
    );
}

/// An enumeration of the interface.
pub(super) struct Enumeration {
    /// Name of the type.
    pub(super) name: &'static str,
    /// One line for people.
    pub(super) description: &'static str,
    /// Name, value and meaning of each item.
    pub(super) items: [(&'static str, i64, &'static str); 4],
}

/// Whether a gauge's reading means something; numbers as in `gauge`.
pub(super) const VALIDITY: Enumeration = Enumeration {
    name: "Validity",
    description: "Whether a gauge's reading means something",
    items: [
        ("valid", 0, "the reading is what the gauge measures"),
        ("empty", 1, "no material where the gauge looks"),
        ("outside", 2, "the gauge looks outside the domain"),
        ("blocked", 3, "something stands where the gauge looks"),
    ],
};

/// The enumeration that an integer row takes its values from.
pub(super) fn enumeration(row: &Variable) -> Option<&'static Enumeration> {
    let is_validity = row.kind == ValueKind::Integer && row.name.ends_with(".validity");
    is_validity.then_some(&VALIDITY)
}

/// Attributes that both versions write first for a variable.
pub(super) fn variable_head(row: &Variable) -> Attributes {
    let mut attributes = vec![
        ("name", row.name.clone()),
        ("valueReference", row.reference.to_string()),
        ("description", row.description.clone()),
        ("causality", causality(row.causality).to_owned()),
        ("variability", variability(row.variability).to_owned()),
    ];
    // The standard forbids `initial` for inputs and for time.
    if matches!(row.causality, Causality::Parameter | Causality::Output) {
        let initial = match row.start {
            Start::Exact(_) | Start::Empty => "exact",
            Start::Calculated => "calculated",
        };
        attributes.push(("initial", initial.to_owned()));
    }
    attributes
}

/// Attributes of the value: type, unit, bounds and start.
pub(super) fn variable_value(row: &Variable) -> Attributes {
    let mut attributes = Attributes::new();
    if let Some(enumeration) = enumeration(row) {
        attributes.push(("declaredType", enumeration.name.to_owned()));
    }
    if row.kind == ValueKind::Real {
        attributes.push(("unit", row.unit.to_owned()));
        if let Some((name, _)) = row.display_unit {
            attributes.push(("displayUnit", name.to_owned()));
        }
    }
    if let Some((low, high)) = row.range
        && row.kind != ValueKind::Boolean
        && enumeration(row).is_none()
    {
        let bounds = [("min", low), ("max", high)];
        let bounds = bounds.into_iter().filter(|(_, bound)| bound.is_finite());
        attributes.extend(bounds.map(|(key, bound)| (key, start_value(row.kind, bound))));
    }
    if let Start::Exact(values) = &row.start {
        let values: Vec<_> = values.iter().map(|v| start_value(row.kind, *v)).collect();
        attributes.push(("start", values.join(" ")));
    }
    attributes
}

/// Rows of the model structure: outputs that are listed, in order.
pub(super) fn is_output(row: &Variable) -> bool {
    row.causality == Causality::Output
}

/// Outputs whose value initialisation computes.
pub(super) fn is_initial_unknown(row: &Variable) -> bool {
    is_output(row) && row.start == Start::Calculated
}

/// What initialisation computes outputs from: the parameters that change the scene. Inputs count from the first step on.
pub(super) fn is_known_to_initialisation(row: &Variable) -> bool {
    row.causality == Causality::Parameter
        && row.variability == Variability::Fixed
        && row.kind == ValueKind::Real
}

pub(super) fn start_value(kind: ValueKind, value: f64) -> String {
    match kind {
        ValueKind::Real => number(value),
        ValueKind::Integer => format!("{value:.0}"),
        ValueKind::Boolean => (value != 0.0).to_string(),
        // Texts have a start of their own.
        ValueKind::Text => String::new(),
    }
}

/// As the standard spells it.
pub(super) fn causality(causality: Causality) -> &'static str {
    match causality {
        Causality::Independent => "independent",
        Causality::Parameter => "parameter",
        Causality::Input => "input",
        Causality::Output => "output",
    }
}

fn variability(variability: Variability) -> &'static str {
    match variability {
        Variability::Fixed => "fixed",
        Variability::Tunable => "tunable",
        Variability::Discrete => "discrete",
        Variability::Continuous => "continuous",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gauge::Validity;
    use crate::scene;

    #[test]
    fn validity_has_the_numbers_of_the_gauges() {
        let codes = [
            Validity::Valid,
            Validity::Empty,
            Validity::Outside,
            Validity::Blocked,
        ];
        let items = VALIDITY.items.map(|(_, value, _)| value);
        assert_eq!(codes.map(|code| i64::from(code.code())), items);
    }

    #[test]
    fn token_changes_with_scene_and_version() {
        let text = include_str!("../../tests/scenes/small_silo.toml");
        let tokens = |text: &str| {
            let scene = scene::parse("small_silo.toml", text).expect("it is a scene");
            let component = Component::new(&scene).expect("it builds");
            [FmiVersion::V2, FmiVersion::V3].map(|version| {
                let token = token(&component, version);
                assert!(description(&component, version).contains(&token));
                token
            })
        };
        let [two, three] = tokens(text);
        assert_ne!(two, three);
        assert_eq!(tokens(text), [two.clone(), three]);
        assert_ne!(tokens(&format!("{text}\n# changed\n"))[0], two);
    }
}
