//! Macros that declare tables and choices once: struct, reader, keys and JSON Schema come from the same lines.

/// Declares a table of the scene file.
///
/// Every key becomes an `Option<At<T>>`: `None` means that a problem has been reported, or that an optional key
/// without default was left out. `in` restricts numbers (SI), `default` is TOML for a key that was left out.
macro_rules! table {
    (
        $(#[doc = $about:literal])+
        $name:ident {
            $(
                $(#[doc = $doc:literal])+
                $need:ident $field:ident : $ty:ty $(, in $range:expr)? $(, default $default:tt)? ;
            )*
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug)]
        pub(in crate::scene) struct $name {
            /// The keys that stand in the file, readable or not.
            #[allow(dead_code, reason = "few tables have checks that need it")]
            pub(in crate::scene) given: Vec<&'static str>,
            $( $(#[doc = $doc])+ pub(in crate::scene) $field: Option<At<$ty>>, )*
        }

        impl $name {
            const KEYS: &'static [KeySpec] = &[$( KeySpec {
                name: declare::plain(stringify!($field)),
                need: declare::need!($need),
                range: declare::optional!($($range)?),
                default: declare::optional!($(stringify!($default))?),
                doc: &[$($doc),+],
            } ),*];
        }

        impl Field for $name {
            #[allow(unused_assignments, reason = "the index of the last key is not read again")]
            fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
                let entries = node.entries(problems)?;
                let keys = Self::KEYS.iter().map(|k| k.name).chain(node.tag());
                refuse_unknown(&entries, keys, problems);
                let mut key = 0;
                let known = Self::KEYS.iter().map(|k| k.name);
                let stands = |key: &&str| entries.iter().any(|(name, _)| name == key);
                Some(Self {
                    given: known.filter(stands).collect(),
                    $( $field: {
                        let spec = &Self::KEYS[key];
                        key += 1;
                        spec.get::<$ty>(node.place(), &entries, problems)
                    }, )*
                })
            }

            fn remedy(name: &str) -> String {
                let needed = Self::KEYS.iter().filter(|key| key.need == Need::Required);
                let needed: Vec<_> = needed.map(|key| key.name).collect();
                format!("add [{name}] with {}", needed.join(", "))
            }
        }

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).trim_start_matches("Raw").into()
            }

            #[allow(unused_assignments, reason = "the index of the last key is not read again")]
            fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                let mut properties = serde_json::Map::new();
                let mut required = Vec::new();
                let mut key = 0;
                $(
                    Self::KEYS[key].describe::<$ty>(generator, &mut properties, &mut required);
                    key += 1;
                )*
                schemars::json_schema!({
                    "type": "object",
                    "description": declare::join(&[$($about),+]),
                    "properties": properties,
                    "required": required,
                    "additionalProperties": false
                })
            }
        }
    };
}

/// Declares a set of tables, told apart by the text behind one key.
macro_rules! tagged {
    (
        $(#[doc = $about:literal])+
        $name:ident by $tag:ident {
            $( $text:literal => $variant:ident($ty:ty), )*
        }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Debug)]
        pub(in crate::scene) enum $name {
            $(
                #[doc = concat!("`", stringify!($tag), " = \"", $text, "\"`")]
                $variant($ty),
            )*
        }

        impl Field for $name {
            fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
                let entries = node.entries(problems)?;
                let tag = choose(stringify!($tag), &[$($text),*], node, &entries, problems)?;
                let node = node.tagged(stringify!($tag));
                match tag {
                    $( $text => <$ty as Field>::read(&node, problems).map(Self::$variant), )*
                    _ => None,
                }
            }
        }

        impl schemars::JsonSchema for $name {
            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).trim_start_matches("Raw").into()
            }

            fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
                let mut variants = Vec::new();
                $( variants.push(declare::with_tag::<$ty>(stringify!($tag), $text, generator)); )*
                schemars::json_schema!({
                    "description": declare::join(&[$($about),+]),
                    "oneOf": variants
                })
            }
        }
    };
}

/// Declares a value that is one of a few words.
macro_rules! choice {
    (
        $(#[doc = $about:literal])+
        $name:ident { $( $(#[doc = $doc:literal])+ $text:literal => $variant:ident, )* }
    ) => {
        $(#[doc = $about])+
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(in crate::scene) enum $name { $( $(#[doc = $doc])+ $variant, )* }

        impl Field for $name {
            fn read(node: &Node, problems: &mut Problems) -> Option<Self> {
                match read_word(node, &[$($text),*], problems)? {
                    $( $text => Some(Self::$variant), )*
                    _ => None,
                }
            }

            fn example() -> String {
                format!("{:?}", [$($text),*][0])
            }
        }

        impl schemars::JsonSchema for $name {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> std::borrow::Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!({
                    "enum": [$($text),*],
                    "x-words": [$( format!("{}: {}", $text, declare::join(&[$($doc),+])) ),*]
                })
            }
        }
    };
}

macro_rules! need {
    (required) => {
        Need::Required
    };
    (optional) => {
        Need::Optional
    };
}

macro_rules! optional {
    () => {
        None
    };
    ($value:expr) => {
        Some($value)
    };
}

pub(super) use {choice, need, optional, table, tagged};

use super::read::Field;
use schemars::SchemaGenerator;
use serde_json::{Value, json};

/// A field's name without the mark of raw identifiers.
pub(super) const fn plain(name: &'static str) -> &'static str {
    match name.as_bytes() {
        [b'r', b'#', ..] => name.split_at(2).1,
        _ => name,
    }
}

/// Doc comment lines as one text.
pub(super) fn join(lines: &[&str]) -> String {
    let lines: Vec<_> = lines.iter().map(|l| l.trim()).collect();
    lines.join(" ")
}

/// The schema of a table with the key that tells it apart.
pub(super) fn with_tag<T: Field>(tag: &str, text: &str, generator: &mut SchemaGenerator) -> Value {
    let mut schema = T::json_schema(generator).to_value();
    let word = json!({ "const": text, "description": format!("{text:?} chooses this table.") });
    let properties = schema["properties"].take();
    let mut all = serde_json::Map::new();
    all.insert(tag.to_owned(), word);
    if let Value::Object(properties) = properties {
        all.extend(properties);
    }
    schema["properties"] = Value::Object(all);
    if let Some(required) = schema["required"].as_array_mut() {
        required.insert(0, json!(tag));
    }
    schema
}
