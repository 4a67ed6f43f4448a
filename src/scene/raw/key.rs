//! One key of a table: how it is read, what stands in for it where it is left out, and its JSON Schema.

use schemars::SchemaGenerator;
use serde_json::{Map, Value, json};
use toml::de::DeValue;

use super::problems::{Place, Problems};
use super::range::Range;
use super::read::{At, Field, Node};
use crate::units::shown;

/// Whether a key must be there.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Need {
    /// Its absence is a problem.
    Required,
    /// It may be left out.
    Optional,
}

/// One key of a table: what `table!` knows of it.
pub(super) struct KeySpec {
    /// Its name.
    pub(super) name: &'static str,
    /// Whether it must be there.
    pub(super) need: Need,
    /// Range of its numbers.
    pub(super) range: Option<Range>,
    /// Its value when left out, as TOML.
    pub(super) default: Option<&'static str>,
    /// What it means, one line per doc comment line.
    pub(super) doc: &'static [&'static str],
}

impl KeySpec {
    /// Reads this key from a table's entries, or its default.
    pub(super) fn get<T: Field>(
        &self,
        table: &Place,
        entries: &[(&str, Node)],
        problems: &mut Problems,
    ) -> Option<At<T>> {
        let Some((_, node)) = entries.iter().find(|(name, _)| *name == self.name) else {
            return self.absent(table, problems);
        };
        let value = T::read(node, problems)?;
        let outside = |r: Range| value.numbers().into_iter().find(|&n| !r.contains(n));
        if let Some(range) = self.range
            && let Some(number) = outside(range)
        {
            // A ratio's unit is 1, and its example may lie outside this range.
            let (unit, example) = match T::unit() {
                "1" => ("", String::new()),
                unit => (unit, T::example()),
            };
            let remedy = if example.is_empty() {
                "choose a value in this range".to_owned()
            } else {
                format!("choose a value in this range; write for example {example}")
            };
            let found = format!("{} {unit}", shown(number));
            problems.report(node.place(), found.trim(), range.text(T::unit()), remedy);
            return None;
        }
        let place = node.place().clone();
        Some(At { value, place })
    }

    fn absent<T: Field>(&self, table: &Place, problems: &mut Problems) -> Option<At<T>> {
        let place = table.child(self.name);
        if self.need == Need::Required {
            let about = self.doc.first().map_or("", |d| d.trim());
            let about = about.trim_end_matches(['.', ':']);
            let allowed = format!("the key {}: {about}", self.name);
            problems.report(&place, "nothing", allowed, T::remedy(self.name));
            return None;
        }
        let value = DeValue::parse(self.default?).ok()?;
        let node = Node::new(value.get_ref(), place.clone());
        let value = T::read(&node, problems)?;
        Some(At { value, place })
    }

    /// Adds this key to a JSON Schema.
    pub(super) fn describe<T: Field>(
        &self,
        generator: &mut SchemaGenerator,
        properties: &mut Map<String, Value>,
        required: &mut Vec<Value>,
    ) {
        let mut schema = generator.subschema_for::<T>().to_value();
        if let Value::Object(object) = &mut schema {
            let doc: Vec<_> = self.doc.iter().map(|d| d.trim()).collect();
            object.insert("description".into(), json!(doc.join(" ")));
            if let Some(default) = self.default.and_then(|d| serde_json::from_str(d).ok()) {
                object.insert("default".into(), default);
            }
            if let Some(range) = self.range {
                range.describe(T::unit(), object);
            }
        }
        properties.insert(self.name.to_owned(), schema);
        if self.need == Need::Required {
            required.push(json!(self.name));
        }
    }
}
