//! Scene text from a template and edits by key.

use toml::{Table, Value};

/// A scene file to make members from.
#[derive(Clone, Debug)]
pub struct Template(Table);

impl Template {
    /// From the text of a scene file.
    ///
    /// # Errors
    /// The text is not TOML.
    pub fn new(text: &str) -> Result<Self, String> {
        text.parse()
            .map(Self)
            .map_err(|error| format!("template: {error}"))
    }

    /// Sets one key, given as `section.key` or `section.NAME.key`; sections are made where they are missing. That the key
    /// exists in scene files is checked when the scene is read.
    #[must_use]
    pub fn with(mut self, path: &str, value: impl Into<Value>) -> Self {
        let mut parts: Vec<&str> = path.split('.').collect();
        let Some(key) = parts.pop() else {
            return self;
        };
        let mut table = &mut self.0;
        for part in parts {
            let entry = table
                .entry(part)
                .or_insert_with(|| Value::Table(Table::new()));
            if !entry.is_table() {
                *entry = Value::Table(Table::new());
            }
            match entry {
                Value::Table(inner) => table = inner,
                _ => return self,
            }
        }
        table.insert(key.to_owned(), value.into());
        self
    }

    /// Takes a key or section out.
    #[must_use]
    pub fn without(mut self, path: &str) -> Self {
        let (sections, key) = path.rsplit_once('.').unwrap_or(("", path));
        let mut table = Some(&mut self.0);
        for part in sections.split('.').filter(|part| !part.is_empty()) {
            table = table.and_then(|t| t.get_mut(part)?.as_table_mut());
        }
        if let Some(table) = table {
            table.remove(key);
        }
        self
    }

    /// The scene file's text.
    ///
    /// # Errors
    /// It cannot be written as TOML.
    pub fn text(&self) -> Result<String, String> {
        toml::to_string(&self.0).map_err(|error| error.to_string())
    }
}

/// A point or vector for [`Template::with`], SI.
#[must_use]
pub fn point(x: f64, y: f64) -> Value {
    Value::Array(vec![Value::Float(x), Value::Float(y)])
}

/// A chain of points.
#[must_use]
pub fn points(chain: &[[f64; 2]]) -> Value {
    Value::Array(chain.iter().map(|p| point(p[0], p[1])).collect())
}

/// A box, as bodies have it.
#[must_use]
pub fn rectangle(lower: [f64; 2], upper: [f64; 2]) -> Value {
    let mut table = Table::new();
    table.insert("lower".to_owned(), point(lower[0], lower[1]));
    table.insert("upper".to_owned(), point(upper[0], upper[1]));
    Value::Table(table)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edits_replace_add_and_remove_keys() {
        let template =
            Template::new("name = \"a\"\n[numerics]\nspacing = \"1 mm\"\n[log]\nrequired = true\n")
                .unwrap();
        let text = template
            .with("numerics.spacing", 0.25)
            .with("bodies.one.velocity", point(1.0, 2.0))
            .without("log")
            .without("nothing.here")
            .text()
            .unwrap();
        let table: Table = text.parse().unwrap();
        assert_eq!(table["numerics"]["spacing"].as_float(), Some(0.25));
        assert_eq!(table["bodies"]["one"]["velocity"][1].as_float(), Some(2.0));
        assert_eq!(table["name"].as_str(), Some("a"));
        assert!(!table.contains_key("log"));
    }
}
