//! Groups of values that may stand behind a key: points, lists, time series, sections that the author names.

use std::borrow::Cow;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};

use super::problems::{Place, Problems};
use super::read::{At, Field, Node, describe};
use super::values::{
    Acceleration, Loose, Scalar, Time, check_name, name_pattern, quantity_schema, schemas,
};
use crate::units::{Quantity, quote};

/// A point or vector of two or three values.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) struct Coordinates<Q> {
    /// Two or three SI values.
    pub(in crate::scene) values: Vec<f64>,
    quantity: PhantomData<Q>,
}

impl<Q: Scalar> Coordinates<Q> {
    /// How to write one of each size. A value of every kind is wanted, so that units are seen.
    fn examples() -> String {
        let planar = match Q::QUANTITY {
            Quantity::Length => "[0.1, \"20 mm\"]".to_owned(),
            _ => Self::example(),
        };
        let space = planar.replacen('[', "[0, ", 1);
        format!("write for example {planar}, in space {space}")
    }
}

impl<Q: Scalar> Field for Coordinates<Q> {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        let elements = node.elements().unwrap_or_default();
        if !(2..=3).contains(&elements.len()) {
            let one = Q::QUANTITY.allowed();
            problems.report(
                node.place(),
                describe(node.value()),
                format!("[x, y] in a planar scene, [x, y, z] in space; each {one}"),
                Self::examples(),
            );
            return None;
        }
        let values: Vec<f64> = elements
            .iter()
            .filter_map(|e| Q::read(e, problems).map(|q| q.si()))
            .collect();
        (values.len() == elements.len()).then_some(Self {
            values,
            quantity: PhantomData,
        })
    }

    fn numbers(&self) -> Vec<f64> {
        self.values.clone()
    }

    fn unit() -> &'static str {
        Q::QUANTITY.si()
    }

    fn example() -> String {
        match Q::QUANTITY {
            Quantity::Length => "[0, 0]".to_owned(),
            // A direction.
            Quantity::Ratio => "[1, 0]".to_owned(),
            Quantity::Acceleration => "[0, \"-9.81 m/s^2\"]".to_owned(),
            quantity => format!("[0, {:?}]", quantity.example()),
        }
    }
}

/// An acceleration along "down", or a whole vector.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) enum Gravity {
    /// Its size; `slope` turns it.
    Size(f64),
    /// Its components [m/s^2].
    Vector(Coordinates<Acceleration>),
}

impl Field for Gravity {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        if node.elements().is_some() {
            return Coordinates::read(node, problems).map(Self::Vector);
        }
        Acceleration::read(node, problems).map(|a| Self::Size(a.0))
    }

    fn example() -> String {
        Acceleration::example()
    }
}

/// A list of values; at most [`LONGEST_LIST`].
#[derive(Clone, Debug)]
pub(in crate::scene) struct List<T>(pub(in crate::scene) Vec<At<T>>);

/// Longest list read: enough for a measured time series.
const LONGEST_LIST: usize = 100_000;

impl<T: Field> Field for List<T> {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        let elements = node.elements();
        let Some(elements) = elements.filter(|e| e.len() <= LONGEST_LIST) else {
            problems.report(
                node.place(),
                describe(node.value()),
                format!("an array of at most {LONGEST_LIST} values"),
                Self::remedy_of(node),
            );
            return None;
        };
        let read: Vec<_> = elements
            .iter()
            .filter_map(|e| {
                let place = e.place().clone();
                T::read(e, problems).map(|value| At { value, place })
            })
            .collect();
        (read.len() == elements.len()).then_some(Self(read))
    }
}

impl<T: Field> List<T> {
    /// How to write what stands there as a list.
    fn remedy_of(node: &Node) -> String {
        // Of what is written in quotes one is a list without its brackets.
        let is_word = T::example().starts_with('"');
        match node.value().as_str().filter(|_| is_word) {
            Some(word) => format!("put it in brackets: [{}]", quote(word)),
            None if node.value().is_table() && T::example().is_empty() => {
                format!("write it in double brackets: [[{}]]", node.place().key)
            }
            None => "write it as [value, value, ...]".to_owned(),
        }
    }
}

/// One point of a time series: `[time, value]`.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) struct SeriesPoint {
    /// Time [s].
    pub(in crate::scene) time: f64,
    /// Value; its quantity depends on the input.
    pub(in crate::scene) value: Loose,
}

impl Field for SeriesPoint {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        let elements = node.elements().unwrap_or_default();
        let [time, value] = &elements[..] else {
            problems.report(
                node.place(),
                describe(node.value()),
                "[time, value]",
                "write for example [\"0.5 s\", 1]",
            );
            return None;
        };
        let time = Time::read(time, problems);
        let value = Loose::read(value, problems);
        Some(Self {
            time: time?.0,
            value: value?,
        })
    }
}

/// Sections that the scene's author names: `[gates.main]`.
#[derive(Clone, Debug)]
pub(in crate::scene) struct Named<T>(pub(in crate::scene) Vec<Entry<T>>);

/// A named section.
#[derive(Clone, Debug)]
pub(in crate::scene) struct Entry<T> {
    /// Its name.
    pub(in crate::scene) name: String,
    /// Where it stands.
    pub(in crate::scene) place: Place,
    /// What it says; `None` if that could not be read, which has been reported.
    pub(in crate::scene) value: Option<T>,
}

/// Most named sections of a kind: phases are counted in bytes.
const MOST_SECTIONS: usize = 250;

impl<T> Named<T> {
    /// Reports a section of this kind without a name of its own: `[bodies]` or `[[bodies]]` for `[bodies.NAME]`.
    fn are_named(node: &Node, problems: &mut Problems) -> bool {
        let kind = &node.place().key;
        let entries = node.value().as_table().into_iter().flatten();
        // `[[bodies.fill]]` has a name: it is told where the section is read.
        let bare = entries
            .map(|(key, value)| (key, Node::new(value.get_ref(), Place::default())))
            .filter(|(_, node)| !node.value().is_table() && !node.is_list_of_tables());
        let first = bare.map(|(key, _)| key).min_by_key(|key| key.span().start);
        let found = match first {
            Some(key) => format!("[{kind}] with the key {}", quote(key.get_ref())),
            None if node.is_list_of_tables() => format!("[[{kind}]]"),
            None => return true,
        };
        problems.report(
            node.place(),
            found,
            format!("sections with names of their own: [{kind}.NAME]"),
            format!("name it, for example [{kind}.main]"),
        );
        false
    }
}

impl<T: Field> Field for Named<T> {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        if !Self::are_named(node, problems) {
            return None;
        }
        let sections = node.entries(problems)?;
        if sections.len() > MOST_SECTIONS {
            problems.report(
                node.place(),
                format!("{} sections", sections.len()),
                format!("at most {MOST_SECTIONS} sections of a kind"),
                "join walls into polylines, or split the scene",
            );
            return None;
        }
        let mut entries = Vec::new();
        for (name, node) in sections {
            check_name(name, node.place(), problems);
            entries.push(Entry {
                name: name.to_owned(),
                place: node.place().clone(),
                value: T::read(&node, problems),
            });
        }
        Some(Self(entries))
    }

    fn remedy(name: &str) -> String {
        format!("add [{name}.NAME]")
    }
}

schemas! {
    [Q: Scalar] Coordinates<Q>, format!("Coordinates of {}", Q::QUANTITY.name()), {
        "type": "array",
        "items": quantity_schema(Q::QUANTITY),
        "minItems": 2,
        "maxItems": 3
    };
    [] Gravity, "Gravity", { "anyOf": [
        quantity_schema(Quantity::Acceleration),
        { "type": "array", "items": quantity_schema(Quantity::Acceleration), "minItems": 2, "maxItems": 3 }
    ] };
    [] SeriesPoint, "SeriesPoint", { "type": "array", "minItems": 2, "maxItems": 2, "items": { "type": ["number", "string"] } };
}

impl<T: Field> JsonSchema for List<T> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        format!("List of {}", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let items = generator.subschema_for::<T>();
        json_schema!({ "type": "array", "items": items, "maxItems": LONGEST_LIST })
    }
}

impl<T: Field> JsonSchema for Named<T> {
    fn inline_schema() -> bool {
        true
    }
    fn schema_name() -> Cow<'static, str> {
        format!("Named {}", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let item = generator.subschema_for::<T>();
        json_schema!({
            "type": "object",
            "patternProperties": { name_pattern(): item },
            "additionalProperties": false
        })
    }
}
