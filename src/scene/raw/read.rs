//! Reading the parsed file without stopping at the first problem: nodes that know their place, and the trait of
//! everything that can stand behind a key.

use schemars::JsonSchema;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::problems::{Place, Problems};
use crate::units::quote;

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
    /// A value at a place, of which no key has been read yet.
    pub(super) fn new(value: &'a DeValue<'a>, place: Place) -> Self {
        Node {
            value,
            place,
            tag: None,
        }
    }

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
        let element = |(i, v): (usize, &'a Spanned<DeValue<'a>>)| {
            let place = Place {
                offset: v.span().start,
                key: format!("{}[{i}]", self.place.key),
            };
            Node::new(v.get_ref(), place)
        };
        Some(array.iter().enumerate().map(element).collect())
    }

    /// Whether it is what double brackets make.
    pub(super) fn is_list_of_tables(&self) -> bool {
        let array = self.value.as_array();
        array.is_some_and(|all| !all.is_empty() && all.iter().all(|v| v.get_ref().is_table()))
    }

    /// Its entries in the order of the file, if it is a table; reports it otherwise.
    pub(super) fn entries(&self, problems: &mut Problems) -> Option<Vec<(&'a str, Node<'a>)>> {
        let Some(table) = self.value.as_table() else {
            let remedy = match self.is_list_of_tables() {
                true => format!("write it in single brackets: [{}]", self.place.key),
                false => "write it as a [section] or as { key = value }".to_owned(),
            };
            problems.report(&self.place, describe(self.value), "a table", remedy);
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
            let place = Place {
                offset: key.span().start,
                ..place.child(name)
            };
            (name, Node::new(value.get_ref(), place))
        })
        .collect();
    entries.sort_by_key(|(_, node)| node.place.offset);
    entries
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
    T::read(&Node::new(&value, Place::default()), problems)
}
