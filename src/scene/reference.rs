//! What may be written in a scene file, for editors (JSON Schema) and for people (docs/scene.md). Both come from the
//! tables of `raw`; nothing is said here a second time.

use std::fmt::Write;

use schemars::generate::SchemaSettings;
use serde_json::{Map, Value};

use super::raw::RawScene;
use crate::units::Quantity;

/// The JSON Schema (2020-12) of scene files, as text.
///
/// Editors use it to complete and check scene files. `x-quantity`, `x-units` and `x-range` say which quantity a value
/// is, the units it may be written in, and its range in SI. Rules that concern more than one key are not in it.
#[must_use]
pub fn schema() -> String {
    format!("{:#}\n", schema_value())
}

fn schema_value() -> Value {
    let generator = SchemaSettings::draft2020_12().into_generator();
    generator.into_root_schema_for::<RawScene>().to_value()
}

/// The reference of scene files, as Markdown: docs/scene.md.
#[must_use]
pub fn reference_markdown() -> String {
    let schema = schema_value();
    let mut page = Page {
        text: String::new(),
        definitions: schema["$defs"].as_object().cloned().unwrap_or_default(),
        nested: Vec::new(),
    };
    page.introduction();
    page.root(&schema);
    page.nested_tables();
    page.text
}

struct Page {
    text: String,
    definitions: Map<String, Value>,
    /// Names of tables that stand behind keys, to be described at the end.
    nested: Vec<String>,
}

impl Page {
    fn line(&mut self, text: &str) {
        self.text.push_str(text);
        self.text.push('\n');
    }

    fn introduction(&mut self) {
        self.line("<!-- Made by `sandgate::scene::reference_markdown` from src/scene/raw/; do not edit. -->");
        self.line("# Scene files");
        self.line("");
        self.line(
            "A scene is a TOML file. [cases/](../cases/README.md) holds examples to start from;",
        );
        self.line("`sandgate schema` prints this reference as JSON Schema for editors.");
        self.line("");
        self.line("Every quantity is a plain number in SI, or text with a unit:");
        self.line("");
        self.line("| quantity | plain numbers | units in text | example |");
        self.line("|---|---|---|---|");
        for quantity in Quantity::ALL {
            let units: Vec<_> = quantity.symbols().map(|s| format!("`{s}`")).collect();
            let row = format!(
                "| {} | {} | {} | `\"{}\"` |",
                quantity.name(),
                quantity.si(),
                units.join(" "),
                quantity.example()
            );
            self.line(&row);
        }
        self.line("");
        self.line("Points and vectors are `[x, y]` where dimension = 2 (y is up) and `[x, y, z]` where dimension = 3 (z is up).");
        self.line("The *left* of a way from one point to another is the left of a walker who looks along it with z up.");
        self.line("Names (NAME below) are lower-case letters, digits and `_`, begin with a letter and have at most 48 characters. Keys in **bold** are required.");
        self.line("A file has at most 4 MiB. One with problems is refused, all of them reported at once, each with its line and what to do.");
    }

    fn root(&mut self, schema: &Value) {
        let empty = Map::new();
        let properties = schema["properties"].as_object().unwrap_or(&empty);
        let plain = |schema: &Value| self.table_behind(schema).is_none();
        let top: Map<_, _> = properties
            .iter()
            .filter(|(_, s)| plain(s))
            .map(|(k, s)| (k.clone(), s.clone()))
            .collect();
        self.line("\n## Top of the file\n");
        self.keys(&top, &schema["required"]);
        for (key, section) in properties {
            let Some((heading, table)) = self.table_behind(section) else {
                continue;
            };
            let required = if is_required(&schema["required"], key) {
                " (required)"
            } else {
                ""
            };
            self.line(&format!("\n## {}{required}\n", heading.replace("KEY", key)));
            self.line(&text(&section["description"]));
            let named = section.get("$ref").is_none();
            self.section(&table, named);
        }
    }

    /// Heading and schema of a section: `[KEY]`, `[KEY.NAME]` or `[[KEY]]`.
    fn table_behind(&self, schema: &Value) -> Option<(&'static str, Value)> {
        if let Some(table) = self.resolve(schema) {
            return Some(("`[KEY]`", table));
        }
        if let Some(patterns) = schema["patternProperties"].as_object() {
            let item = patterns.values().next()?;
            return Some(("`[KEY.NAME]`", self.resolve(item)?));
        }
        Some(("`[[KEY]]`", self.resolve(&schema["items"])?))
    }

    fn resolve(&self, schema: &Value) -> Option<Value> {
        let name = schema["$ref"].as_str()?.rsplit('/').next()?;
        self.definitions.get(name).cloned()
    }

    /// A section's own description stands above only where the file's author names it.
    fn section(&mut self, table: &Value, named: bool) {
        if named {
            self.line("");
            self.line(&text(&table["description"]));
        }
        let Some(variants) = table["oneOf"].as_array() else {
            self.line("");
            self.keys_of(table);
            return;
        };
        for variant in variants {
            let tag = variant["properties"]
                .as_object()
                .and_then(|p| p.iter().find_map(|(k, v)| Some((k, v["const"].as_str()?))));
            if let Some((key, word)) = tag {
                self.line(&format!("\n### `{key} = \"{word}\"`\n"));
            }
            self.line(&text(&variant["description"]));
            self.line("");
            self.keys_of(variant);
        }
    }

    fn keys_of(&mut self, table: &Value) {
        let properties = table["properties"].as_object().cloned().unwrap_or_default();
        self.keys(&properties, &table["required"]);
    }

    fn keys(&mut self, properties: &Map<String, Value>, required: &Value) {
        self.line("| key | value | if left out | meaning |");
        self.line("|---|---|---|---|");
        for (key, schema) in properties {
            if schema["const"].is_string() {
                continue;
            }
            let (shown, left_out) = if is_required(required, key) {
                (format!("**`{key}`**"), "required".to_owned())
            } else {
                let default = &schema["default"];
                let left_out = match default {
                    Value::Null => String::new(),
                    other => format!("`{other}`"),
                };
                (format!("`{key}`"), left_out)
            };
            let mut value = self.value(schema);
            if let Some(range) = schema["x-range"].as_str() {
                let _ = write!(value, ", {range}");
            }
            let mut meaning = text(&schema["description"]);
            for word in words(schema) {
                let _ = write!(meaning, "<br>{word}");
            }
            let row = format!("| {shown} | {value} | {left_out} | {meaning} |");
            self.line(&row);
        }
    }

    /// What may stand behind a key, in a few words.
    fn value(&mut self, schema: &Value) -> String {
        if let Some(name) = schema["$ref"].as_str().and_then(|r| r.rsplit('/').next()) {
            if !self.nested.iter().any(|n| n == name) {
                self.nested.push(name.to_owned());
            }
            let anchor = name.to_lowercase();
            return format!("table [{name}](#{anchor})");
        }
        if let Some(quantity) = schema["x-quantity"].as_str() {
            return quantity.to_owned();
        }
        if let Some(options) = schema["anyOf"].as_array() {
            let options: Vec<_> = options.iter().map(|o| self.value(o)).collect();
            return options.join(", or ");
        }
        if let Some(words) = schema["enum"].as_array() {
            let words: Vec<_> = words.iter().map(|w| format!("`{w}`")).collect();
            return words.join(", ");
        }
        match (schema["type"].as_str(), &schema["items"]) {
            (Some("array"), items) if schema["maxItems"] == 3 => {
                format!("vector of {}", self.value(items))
            }
            (Some("array"), _) if schema["maxItems"] == 2 => "`[time, value]`".to_owned(),
            (Some("array"), items) => format!("list of {}", self.value(items)),
            (Some("boolean"), _) => "`true` or `false`".to_owned(),
            (Some("integer"), _) => "whole number".to_owned(),
            (Some("string"), _) => "text".to_owned(),
            _ => "value".to_owned(),
        }
    }

    fn nested_tables(&mut self) {
        if self.nested.is_empty() {
            return;
        }
        self.line("\n## Tables behind keys\n");
        self.line("Written in place: `box = { lower = [0, 0], upper = [\"0.2 m\", \"0.1 m\"] }`.");
        let mut done = 0;
        while done < self.nested.len() {
            let name = self.nested[done].clone();
            done += 1;
            let table = self.definitions.get(&name).cloned().unwrap_or_default();
            self.line(&format!("\n### {name}\n"));
            self.line(&text(&table["description"]));
            self.line("");
            self.keys_of(&table);
        }
    }
}

fn text(value: &Value) -> String {
    value.as_str().unwrap_or_default().replace('|', "\\|")
}

fn is_required(required: &Value, key: &str) -> bool {
    required
        .as_array()
        .is_some_and(|keys| keys.iter().any(|k| k == key))
}

fn words(schema: &Value) -> Vec<String> {
    let list = schema["x-words"].as_array();
    list.into_iter().flatten().map(text).collect()
}
