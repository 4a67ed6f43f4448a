//! Single values that may stand behind a key: quantities, numbers, flags, text, words. Groups of them: `groups`.

use std::borrow::Cow;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use toml::de::DeValue;

use super::problems::{Place, Problems};
use super::read::{Field, Node, describe};
use super::unknown::nearest;
use crate::units::{self, Quantity, quote};

/// Schemas of values that are written in place.
macro_rules! schemas {
    ($( [$($generic:ident : $bound:ident)?] $ty:ty, $name:expr, $schema:tt; )*) => {$(
        impl $(<$generic: $bound>)? JsonSchema for $ty {
            fn inline_schema() -> bool {
                true
            }
            fn schema_name() -> Cow<'static, str> {
                $name.into()
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!($schema)
            }
        }
    )*};
}

pub(super) use schemas;

/// A quantity's type: says which quantity it is.
pub(in crate::scene) trait Scalar: Field {
    /// The quantity.
    const QUANTITY: Quantity;
    /// Its SI value.
    fn si(&self) -> f64;
}

macro_rules! scalars {
    ($($(#[doc = $doc:literal])+ $name:ident => $quantity:expr;)*) => {$(
        $(#[doc = $doc])+
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub(in crate::scene) struct $name(pub(in crate::scene) f64);

        impl Scalar for $name {
            const QUANTITY: Quantity = $quantity;
            fn si(&self) -> f64 {
                self.0
            }
        }

        impl Field for $name {
            fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
                read_quantity(node, $quantity, problems).map(Self)
            }
            fn numbers(&self) -> Vec<f64> {
                vec![self.0]
            }
            fn unit() -> &'static str {
                $quantity.si()
            }
            fn example() -> String {
                format!("{:?}", $quantity.example())
            }
        }

        impl JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                quantity_schema($quantity)
            }
        }
    )*};
}

scalars! {
    /// A length [m].
    Length => Quantity::Length;
    /// A time [s].
    Time => Quantity::Time;
    /// An angle [rad].
    Angle => Quantity::Angle;
    /// A speed [m/s].
    Speed => Quantity::Velocity;
    /// An angular velocity [rad/s].
    AngularSpeed => Quantity::AngularVelocity;
    /// An acceleration [m/s^2].
    Acceleration => Quantity::Acceleration;
    /// Mass per time [kg/s].
    MassRate => Quantity::MassRate;
    /// A density [kg/m^3].
    Density => Quantity::Density;
    /// A pressure or stress [Pa].
    Pressure => Quantity::Pressure;
    /// A compressibility [1/Pa].
    Compressibility => Quantity::Compressibility;
    /// A viscosity, or a consistency [Pa s].
    Viscosity => Quantity::Viscosity;
    /// A number \[1\].
    Ratio => Quantity::Ratio;
}

pub(super) fn quantity_schema(quantity: Quantity) -> Schema {
    let symbols: Vec<_> = quantity.symbols().collect();
    json_schema!({
        "type": ["number", "string"],
        "pattern": pattern(&symbols),
        "examples": [quantity.example()],
        "x-quantity": quantity.name(),
        "x-units": symbols
    })
}

/// What text with one of these units looks like, or with none: all that is taken, and of numbers a little more.
fn pattern(symbols: &[&str]) -> String {
    let mut units = vec![String::new()];
    for symbol in symbols {
        let mut escaped = String::new();
        for c in symbol.chars() {
            if matches!(c, '^' | '.') {
                escaped.push('\\');
            }
            escaped.push(c);
        }
        units.push(escaped);
        units.extend(match *symbol {
            "um" => vec!["[µμ]m".to_owned()],
            "deg" => vec!["°".to_owned()],
            _ => Vec::new(),
        });
    }
    format!(r"^\s*[-+.0-9][-+.0-9eE]*\s*({})\s*$", units.join("|"))
}

/// A finite number, if the value is one.
fn number(value: &DeValue) -> Option<f64> {
    let parsed: f64 = match value {
        DeValue::Integer(i) if i.radix() == 10 => i.as_str().parse().ok()?,
        DeValue::Integer(i) => i64::from_str_radix(i.as_str(), i.radix()).ok()? as f64,
        DeValue::Float(f) => f.as_str().parse().ok()?,
        _ => return None,
    };
    parsed.is_finite().then_some(parsed)
}

fn read_quantity(node: &Node, quantity: Quantity, problems: &mut Problems) -> Option<f64> {
    let found = match node.value() {
        DeValue::String(text) => match units::parse(text, quantity) {
            Ok(value) => return Some(value),
            Err(error) => error.found,
        },
        other => match number(other) {
            Some(value) => return Some(value),
            None => describe(other),
        },
    };
    let remedy = format!("write for example {:?}", quantity.example());
    problems.report(node.place(), found, quantity.allowed(), remedy);
    None
}

/// A whole number, 0 or more.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) struct Whole(pub(in crate::scene) u64);

impl Field for Whole {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        let value = match node.value() {
            DeValue::Integer(i) => u64::from_str_radix(i.as_str(), i.radix()).ok(),
            _ => None,
        };
        if value.is_none() {
            let found = describe(node.value());
            let is_large =
                matches!(node.value(), DeValue::Integer(i) if !i.as_str().starts_with('-'));
            let allowed = match is_large {
                true => format!("a whole number, 0 to {}", u64::MAX),
                false => "a whole number, 0 or more".to_owned(),
            };
            problems.report(node.place(), found, allowed, "write for example 500");
        }
        value.map(Self)
    }

    fn numbers(&self) -> Vec<f64> {
        vec![self.0 as f64]
    }
}

/// True or false.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene) struct Flag(pub(in crate::scene) bool);

impl Field for Flag {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        let value = node.value().as_bool();
        if value.is_none() {
            let found = describe(node.value());
            problems.report(
                node.place(),
                found,
                "true or false",
                "write true or false without quotes",
            );
        }
        value.map(Self)
    }
}

/// Any text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::scene) struct Text(pub(in crate::scene) String);

impl Field for Text {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        read_text(node, problems).map(|text| Self(text.to_owned()))
    }

    fn example() -> String {
        "\"text\"".to_owned()
    }
}

fn read_text<'a>(node: &Node<'a>, problems: &mut Problems) -> Option<&'a str> {
    let text = node.value().as_str();
    if text.is_none() {
        let found = describe(node.value());
        problems.report(
            node.place(),
            found,
            "text in quotes",
            "put it in double quotes",
        );
    }
    text
}

/// Letters, digits and underscores, beginning with a letter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::scene) struct Name(pub(in crate::scene) String);

/// Longest name: names become FMI variable names and Zenoh keys.
const LONGEST_NAME: usize = 48;

/// What names look like, for schemas.
pub(super) fn name_pattern() -> String {
    format!("^[a-z][a-z0-9_]{{0,{}}}$", LONGEST_NAME - 1)
}

pub(super) fn check_name(name: &str, place: &Place, problems: &mut Problems) -> bool {
    let letters = name
        .bytes()
        .all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_');
    let start = name.bytes().next().is_some_and(|b| b.is_ascii_lowercase());
    let good = letters && start && name.len() <= LONGEST_NAME;
    if !good {
        problems.report(
            place,
            format!("the name {}", quote(name)),
            format!(
                "lower-case letters a-z, digits and _, beginning with a letter, at most {LONGEST_NAME} characters"
            ),
            "rename it, for example main_gate",
        );
    }
    good
}

impl Field for Name {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        let text = read_text(node, problems)?;
        check_name(text, node.place(), problems).then(|| Self(text.to_owned()))
    }

    fn example() -> String {
        "\"my_scene\"".to_owned()
    }
}

/// A number, or text that a later check reads as a quantity known only then.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) enum Loose {
    /// A plain number.
    Number(f64),
    /// A number with a unit.
    Text(String),
}

impl Loose {
    /// Its SI value as `quantity`, or a message what was found.
    pub(in crate::scene) fn resolve(&self, quantity: Quantity) -> Result<f64, String> {
        match self {
            Loose::Number(n) => Ok(*n),
            Loose::Text(text) => units::parse(text, quantity).map_err(|e| e.found),
        }
    }
}

impl Field for Loose {
    fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
        let value = match node.value() {
            DeValue::String(text) => Some(Self::Text(text.to_string())),
            other => number(other).map(Self::Number),
        };
        if value.is_none() {
            let found = describe(node.value());
            problems.report(
                node.place(),
                found,
                "a finite number, or text with a unit",
                "write for example 0.5 or \"0.5 kg/s\"",
            );
        }
        value
    }
}

/// Reads one of a few words; reports anything else with the nearest.
pub(super) fn read_word(
    node: &Node,
    words: &[&'static str],
    problems: &mut Problems,
) -> Option<&'static str> {
    let text = node.value().as_str();
    let word = text.and_then(|t| words.iter().find(|w| **w == t));
    if word.is_none() {
        let near = text.and_then(|t| nearest(t, words.iter().copied()));
        let remedy = match near {
            Some(near) => format!("did you mean \"{near}\"?"),
            None => "choose one of these".to_owned(),
        };
        let quoted: Vec<_> = words.iter().map(|w| format!("\"{w}\"")).collect();
        problems.report(
            node.place(),
            describe(node.value()),
            quoted.join(", "),
            remedy,
        );
    }
    word.copied()
}

/// Reads the key that tells tables apart.
pub(super) fn choose(
    tag: &str,
    words: &[&'static str],
    table: &Node,
    entries: &[(&str, Node)],
    problems: &mut Problems,
) -> Option<&'static str> {
    if let Some((_, node)) = entries.iter().find(|(name, _)| *name == tag) {
        return read_word(node, words, problems);
    }
    let quoted: Vec<_> = words.iter().map(|w| format!("\"{w}\"")).collect();
    problems.report(
        &table.place().child(tag),
        "nothing",
        quoted.join(", "),
        format!("add {tag} = {}", quoted[0]),
    );
    None
}

schemas! {
    [] Whole, "Whole", { "type": "integer", "minimum": 0 };
    [] Flag, "Flag", { "type": "boolean" };
    [] Text, "Text", { "type": "string" };
    [] Name, "Name", { "type": "string", "pattern": name_pattern() };
    [] Loose, "Loose", { "type": ["number", "string"] };
}
