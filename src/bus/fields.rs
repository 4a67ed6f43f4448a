//! Fields of requests: JSON values → checked values, or a refusal that names the field, what was found and what is
//! allowed.

use super::json;
use super::refusal::{Code, Refusal};
use super::request::LONGEST_TOLD;
use super::verb::Verb;
use crate::wire::foxglove::LogLevel;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde_json::{Map, Value};

pub(super) fn bad(message: String) -> Refusal {
    Refusal::new(Code::BadRequest, message)
}

/// Longest name, identifier or key that is repeated in messages and logs, in characters: as long as `req` may be.
const LONGEST_NAME: usize = 64;

/// A text from outside as far as it is repeated.
pub(super) fn cut(text: &str) -> String {
    match text.char_indices().nth(LONGEST_NAME) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// A text field of a body that was refused, so that it can be told; empty if there is none. A long body is not looked into:
/// whoever sends it would have the callback of everybody work on it.
pub(super) fn text_in(body: &[u8], field: &str) -> String {
    if body.len() > LONGEST_TOLD {
        return String::new();
    }
    match json::parse(body) {
        Ok(Value::Object(map)) => map
            .get(field)
            .and_then(Value::as_str)
            .unwrap_or_default()
            .to_owned(),
        _ => String::new(),
    }
}

/// What a JSON value is, for messages.
pub(super) fn kind(value: &Value) -> String {
    match value {
        Value::Null => "null".into(),
        Value::Array(items) => format!("an array of {}", items.len()),
        Value::Object(_) => "an object".into(),
        Value::String(text) if text.len() > 40 => "a long string".into(),
        plain => plain.to_string(),
    }
}

pub(super) fn check(verb: Verb, map: &Map<String, Value>) -> Result<(), Refusal> {
    let mut known = vec!["req", "client"];
    known.extend(verb.fields());
    match map.keys().find(|key| !known.contains(&key.as_str())) {
        None => Ok(()),
        Some(key) => Err(bad(format!(
            "{}: unknown field {key:?}; it takes {}",
            verb.name(),
            known.join(", ")
        ))),
    }
}

fn wrong(field: &str, found: &Value, allowed: &str) -> Refusal {
    Refusal::new(
        Code::Type,
        format!("{field}: found {}, allowed {allowed}", kind(found)),
    )
}

pub(super) fn text(map: &mut Map<String, Value>, field: &str) -> Result<Option<String>, Refusal> {
    let allowed = format!("a string of 1 to {LONGEST_NAME} characters");
    match map.remove(field) {
        None => Ok(None),
        Some(Value::String(text)) if (1..=LONGEST_NAME).contains(&text.chars().count()) => {
            Ok(Some(text))
        }
        Some(other) => Err(wrong(field, &other, &allowed)),
    }
}

/// Longest line that `log` takes, in characters.
const LONGEST_LINE: usize = 4096;

/// The line of `log` and how grave it is; none if there is no line.
pub(super) fn line(map: &mut Map<String, Value>) -> Result<Option<(LogLevel, String)>, Refusal> {
    let level = match map.remove("level") {
        None => LogLevel::Info,
        Some(Value::String(level)) if level == "info" => LogLevel::Info,
        Some(Value::String(level)) if level == "warning" => LogLevel::Warning,
        Some(Value::String(level)) if level == "error" => LogLevel::Error,
        Some(other) => return Err(wrong("level", &other, "info, warning or error")),
    };
    match map.remove("message") {
        None => Ok(None),
        Some(Value::String(text)) if (1..=LONGEST_LINE).contains(&text.chars().count()) => {
            Ok(Some((level, text)))
        }
        Some(other) => {
            let allowed = format!("a string of 1 to {LONGEST_LINE} characters");
            Err(wrong("message", &other, &allowed))
        }
    }
}

pub(super) fn whole(
    map: &mut Map<String, Value>,
    field: &str,
    least: u64,
    most: u64,
) -> Result<Option<u64>, Refusal> {
    let Some(value) = map.remove(field) else {
        return Ok(None);
    };
    let number = match as_whole(&value) {
        Some(number) => u64::try_from(number).ok(),
        None if is_vast(&value) => None,
        None => return Err(wrong(field, &value, "a whole number")),
    };
    match number.filter(|n| (least..=most).contains(n)) {
        Some(number) => Ok(Some(number)),
        None => Err(Refusal::new(
            Code::Range,
            format!("{field}: found {value}, allowed {least} to {most}"),
        )),
    }
}

/// Beyond it doubles do not tell whole numbers apart.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Whether a number is too large to be told from the whole ones beside it: out of every range here.
fn is_vast(value: &Value) -> bool {
    value.as_f64().is_some_and(|x| x.abs() > EXACT)
}

/// A number that is whole, however it is written: Python's `0.01 * 1e9` becomes 10000000.0.
fn as_whole(value: &Value) -> Option<i128> {
    let exact = |x: f64| (x.fract() == 0.0 && x.abs() <= EXACT).then_some(x as i128);
    let integer = value.as_i64().map(i128::from);
    let integer = integer.or(value.as_u64().map(i128::from));
    integer.or_else(|| value.as_f64().and_then(exact))
}

pub(super) fn time(map: &mut Map<String, Value>) -> Result<Option<i64>, Refusal> {
    match map.remove("t_ns") {
        None => Ok(None),
        Some(value) => as_whole(&value)
            .and_then(|n| i64::try_from(n).ok())
            .map(Some)
            .ok_or_else(|| wrong("t_ns", &value, "a whole number of nanoseconds")),
    }
}

pub(super) fn factor(map: &mut Map<String, Value>) -> Result<Option<f64>, Refusal> {
    match map.remove("realtime_factor") {
        None => Ok(None),
        Some(value) => match value.as_f64() {
            Some(factor) if factor > 0.0 => Ok(Some(factor)),
            Some(_) => Err(Refusal::new(
                Code::Range,
                format!(
                    "realtime_factor: found {value}, allowed more than 0; leave it out to run as fast as possible"
                ),
            )),
            None => Err(wrong("realtime_factor", &value, "a number")),
        },
    }
}

pub(super) fn outputs(map: &mut Map<String, Value>) -> Result<Option<Vec<String>>, Refusal> {
    let allowed = "an array of names of variables";
    match map.remove("outputs") {
        None => Ok(None),
        Some(Value::Array(items)) => items
            .into_iter()
            .map(|item| match item {
                Value::String(name) => Ok(name),
                other => Err(wrong("outputs", &other, allowed)),
            })
            .collect::<Result<_, _>>()
            .map(Some),
        Some(other) => Err(wrong("outputs", &other, allowed)),
    }
}

/// What an input is given.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Given {
    /// Flat values; 1 is true, 0 is false.
    pub flat: Vec<f64>,
    /// Whether `true` or `false` is among them, which only booleans take.
    pub has_flags: bool,
}

pub(super) fn inputs(map: &mut Map<String, Value>) -> Result<Vec<(String, Given)>, Refusal> {
    match map.remove("inputs") {
        None => Ok(Vec::new()),
        Some(Value::Object(entries)) => entries
            .into_iter()
            .map(|(name, value)| given(&name, &value).map(|given| (name, given)))
            .collect(),
        Some(other) => Err(wrong(
            "inputs",
            &other,
            "an object such as {\"gate.main.opening\":0.5}",
        )),
    }
}

/// What an input is given: a number, true or false, or an array of these.
pub(super) fn given(name: &str, value: &Value) -> Result<Given, Refusal> {
    let items = match value {
        Value::Array(items) => items.as_slice(),
        plain => std::slice::from_ref(plain),
    };
    let mut given = Given::default();
    for item in items {
        given.flat.push(match item {
            Value::Bool(flag) => {
                given.has_flags = true;
                f64::from(u8::from(*flag))
            }
            other => other
                .as_f64()
                .ok_or_else(|| wrong(name, other, "a number, true, false, or an array of these"))?,
        });
    }
    Ok(given)
}

pub(super) fn state(map: &mut Map<String, Value>) -> Result<Vec<u8>, Refusal> {
    match map.remove("state") {
        None => Ok(Vec::new()),
        Some(Value::String(text)) => BASE64
            .decode(&text)
            .map_err(|error| bad(format!("state: {error}; send the string that save gave"))),
        Some(other) => Err(wrong("state", &other, "the string that save gave")),
    }
}

/// Bytes in JSON: states as `save` gives and `restore` takes them, schemas.
pub(super) fn base64_text(bytes: &[u8]) -> String {
    BASE64.encode(bytes)
}
