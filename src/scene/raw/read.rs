//! Reading the parsed file without stopping at the first problem: nodes that know their place, the collector of
//! problems, and the trait of everything that can stand behind a key.

use schemars::{JsonSchema, SchemaGenerator};
use serde_json::{Map, Value, json};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::range::Range;
use crate::scene::error::SceneError;
use crate::units::quote;

/// Where something stands: byte offset in the file and path of the key.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in crate::scene) struct Place {
    /// Byte offset in the file.
    pub(in crate::scene) offset: usize,
    /// Path of the key: `bodies.fill.box.lower[0]`.
    pub(in crate::scene) key: String,
}

impl Place {
    /// The place of a key that this table lacks.
    pub(in crate::scene) fn child(&self, key: &str) -> Place {
        Place {
            offset: self.offset,
            key: join(&self.key, key),
        }
    }
}

fn join(parent: &str, key: &str) -> String {
    if parent.is_empty() {
        key.to_owned()
    } else {
        format!("{parent}.{key}")
    }
}

/// A value and where it stands.
#[derive(Clone, Debug)]
pub(in crate::scene) struct At<T> {
    /// The value.
    pub(in crate::scene) value: T,
    /// Where it stands.
    pub(in crate::scene) place: Place,
}

/// A value of the file that is being read.
pub(in crate::scene) struct Node<'a> {
    value: &'a DeValue<'a>,
    place: Place,
    tag: Option<&'static str>,
}

impl<'a> Node<'a> {
    /// The value, untyped.
    pub(super) fn value(&self) -> &'a DeValue<'a> {
        self.value
    }

    /// Where it stands.
    pub(super) fn place(&self) -> &Place {
        &self.place
    }

    /// The key of this table that has been read already, because it tells tables apart.
    pub(super) fn tag(&self) -> Option<&'static str> {
        self.tag
    }

    /// The same table, with the key that tells it apart.
    pub(super) fn tagged(&self, tag: &'static str) -> Node<'a> {
        Node {
            value: self.value,
            place: self.place.clone(),
            tag: Some(tag),
        }
    }

    /// Its elements, if it is an array.
    pub(super) fn elements(&self) -> Option<Vec<Node<'a>>> {
        let array = self.value.as_array()?;
        let element = |(i, v): (usize, &'a Spanned<DeValue<'a>>)| Node {
            value: v.get_ref(),
            place: Place {
                offset: v.span().start,
                key: format!("{}[{i}]", self.place.key),
            },
            tag: None,
        };
        Some(array.iter().enumerate().map(element).collect())
    }

    /// Its entries in the order of the file, if it is a table; reports it otherwise.
    pub(super) fn entries(&self, problems: &mut Problems) -> Option<Vec<(&'a str, Node<'a>)>> {
        let Some(table) = self.value.as_table() else {
            problems.report(
                &self.place,
                describe(self.value),
                "a table",
                "write it as a [section] or as { key = value }",
            );
            return None;
        };
        Some(entries_of(table, &self.place))
    }
}

fn entries_of<'a>(table: &'a DeTable<'a>, place: &Place) -> Vec<(&'a str, Node<'a>)> {
    let mut entries: Vec<_> = table
        .iter()
        .map(|(key, value)| {
            let name: &'a str = key.get_ref();
            let node = Node {
                value: value.get_ref(),
                place: Place {
                    offset: key.span().start,
                    key: join(&place.key, name),
                },
                tag: None,
            };
            (name, node)
        })
        .collect();
    entries.sort_by_key(|(_, node)| node.place.offset);
    entries
}

/// Collects problems while reading goes on.
pub(in crate::scene) struct Problems {
    file: String,
    line_starts: Vec<usize>,
    found: Vec<SceneError>,
}

/// Most problems reported for one file: a file with more is broken in one place that shows early.
const MOST: usize = 100;

impl Problems {
    /// An empty collection for `file` with this `text`.
    pub(in crate::scene) fn new(file: &str, text: &str) -> Self {
        let newlines = text.match_indices('\n').map(|(at, _)| at + 1);
        Self {
            file: file.to_owned(),
            line_starts: std::iter::once(0).chain(newlines).collect(),
            found: Vec::new(),
        }
    }

    /// Adds a problem.
    pub(in crate::scene) fn report(
        &mut self,
        at: &Place,
        found: impl Into<String>,
        allowed: impl Into<String>,
        remedy: impl Into<String>,
    ) {
        if self.found.len() >= MOST {
            return;
        }
        self.found.push(SceneError {
            file: self.file.clone(),
            line: self.line_starts.partition_point(|&s| s <= at.offset),
            key: at.key.clone(),
            found: found.into(),
            allowed: allowed.into(),
            remedy: remedy.into(),
        });
    }

    /// The problems so far.
    pub(in crate::scene) fn into_vec(self) -> Vec<SceneError> {
        self.found
    }

    /// Whether there are none.
    pub(in crate::scene) fn is_empty(&self) -> bool {
        self.found.is_empty()
    }
}

/// Whether a key must be there.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Need {
    /// Its absence is a problem.
    Required,
    /// It may be left out.
    Optional,
}

/// Something that can stand behind a key. `JsonSchema` describes it to editors and people.
pub(in crate::scene) trait Field: Sized + JsonSchema {
    /// Reads it; `None` after at least one problem has been reported.
    fn read(node: &Node, problems: &mut Problems) -> Option<Self>;

    /// The numbers that a range restricts, in SI.
    fn numbers(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Unit of these numbers, for messages.
    fn unit() -> &'static str {
        ""
    }

    /// How to write it right, for messages: `"2 mm"`.
    fn example() -> String {
        String::new()
    }

    /// What to do where the key of this name is missing.
    fn remedy(name: &str) -> String {
        match Self::example() {
            none if none.is_empty() => format!("add {name}"),
            example => format!("add {name} = {example}"),
        }
    }
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
            let found = format!("{number} {unit}");
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
        let node = Node {
            value: value.get_ref(),
            place: place.clone(),
            tag: None,
        };
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

/// Refuses keys that a table does not have, with the nearest one that it has.
pub(super) fn refuse_unknown<'k>(
    entries: &[(&str, Node)],
    known: impl Iterator<Item = &'k str> + Clone,
    problems: &mut Problems,
) {
    for (name, node) in entries {
        if !known.clone().any(|k| k == *name) {
            let keys: Vec<_> = known.clone().collect();
            let remedy = match meant(name, &keys).or_else(|| nearest(name, known.clone())) {
                Some(near) => format!("did you mean {near}? otherwise delete it"),
                None => "delete it".to_owned(),
            };
            let found = format!("unknown key {}", quote(name));
            problems.report(node.place(), found, keys.join(", "), remedy);
        }
    }
}

/// What others call a key by a name that is not like ours: theirs, ours.
const OTHER_NAMES: [(&str, &str); 1] = [("viscosity", "consistency")];

/// The key that goes by this name elsewhere, if the table has it.
fn meant<'k>(name: &str, keys: &[&'k str]) -> Option<&'k str> {
    let (_, ours) = OTHER_NAMES.iter().find(|(theirs, _)| *theirs == name)?;
    keys.iter().find(|key| *key == ours).copied()
}

/// The nearest of `known` names, if it is near enough to be meant.
pub(in crate::scene) fn nearest<'k>(
    name: &str,
    known: impl Iterator<Item = &'k str>,
) -> Option<&'k str> {
    let name: String = name.chars().take(64).collect();
    known
        .map(|k| (edits(&name, k), k))
        .filter(|(d, k)| *d <= 1 + k.len() / 3)
        .min_by_key(|(d, _)| *d)
        .map(|(_, k)| k)
}

/// Levenshtein distance.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let replace = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = replace.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}

/// A value in words: `text "abc"`, `the number 3`.
pub(super) fn describe(value: &DeValue) -> String {
    match value {
        DeValue::String(s) => format!("text {}", quote(s)),
        DeValue::Integer(i) => format!("the number {}", clip(&i.to_string())),
        DeValue::Float(f) => format!("the number {}", clip(f.as_str())),
        DeValue::Boolean(b) => format!("{b}"),
        DeValue::Datetime(d) => format!("the date {d}"),
        DeValue::Array(a) => format!("an array of {}", a.len()),
        DeValue::Table(_) => "a table".to_owned(),
    }
}

fn clip(text: &str) -> String {
    text.chars().take(32).collect()
}

/// Reads the document's root table.
pub(in crate::scene) fn read_document<T: Field>(
    document: Spanned<DeTable>,
    problems: &mut Problems,
) -> Option<T> {
    // Wrapped as a value, the root is read like every other table.
    let value = DeValue::Table(document.into_inner());
    let node = Node {
        value: &value,
        place: Place::default(),
        tag: None,
    };
    T::read(&node, problems)
}

/// The place of a syntax error, which belongs to no key.
pub(in crate::scene) fn syntax_place(offset: usize) -> Place {
    Place {
        offset,
        key: String::new(),
    }
}
