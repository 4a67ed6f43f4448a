//! Set-points as typed: what is published to `B/in/VARIABLE`.

use super::fields::{Given, bad, cut, given, text, text_in};
use super::json;
use super::refusal::{Code, Refusal};
use serde_json::Value;

/// Longest body that is kept to be told only (bytes): values are far shorter.
const LONGEST_TOLD: usize = 4096;

/// A set-point: a value, or `{"value": ..., "client": "..."}` to say who sent it.
#[derive(Clone, Debug, PartialEq)]
pub struct SetPoint {
    /// Variable's name.
    pub variable: String,
    /// What it is given.
    pub given: Given,
    /// Who sent it; may be empty.
    pub client: String,
    /// As it came.
    pub body: String,
}

impl SetPoint {
    /// Who sent it, as logs and `out/applied` name it.
    #[must_use]
    pub fn source(&self) -> &str {
        if self.client.is_empty() {
            "set-point"
        } else {
            &self.client
        }
    }

    /// Reads a set-point.
    ///
    /// # Errors
    /// As [`Request::parse`](super::Request::parse).
    pub fn parse(variable: &str, body: &[u8]) -> Result<Self, Refusal> {
        if body.len() > 1 << 20 {
            return Err(Refusal::new(
                Code::TooLarge,
                format!(
                    "{variable}: found a body of {} bytes, allowed {}",
                    body.len(),
                    1 << 20
                ),
            ));
        }
        let value = json::parse(body)
            .map_err(|error| bad(format!("{variable}: set-point is not JSON: {error}")))?;
        let (value, client) = match value {
            Value::Object(mut map) => {
                if let Some(key) = map.keys().find(|key| *key != "value" && *key != "client") {
                    return Err(bad(format!(
                        "{variable}: unknown field {key:?}; a set-point takes value, client"
                    )));
                }
                let client = text(&mut map, "client")?.unwrap_or_default();
                match map.remove("value") {
                    Some(value) => (value, client),
                    None => return Err(bad(format!("{variable}: missing \"value\""))),
                }
            }
            value => (value, String::new()),
        };
        Ok(Self {
            variable: variable.to_owned(),
            given: given(variable, &value)?,
            client,
            body: String::from_utf8_lossy(body).into_owned(),
        })
    }

    /// What is kept of one that was refused or superseded, to tell it: not its values.
    #[must_use]
    pub(super) fn told(variable: &str, body: &[u8]) -> Self {
        let told = &body[..body.len().min(LONGEST_TOLD)];
        Self {
            variable: cut(variable),
            given: Given::default(),
            client: cut(&text_in(body, "client")),
            body: String::from_utf8_lossy(told).into_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn set_points_are_values_with_or_without_a_sender() {
        let read = |body: &str| SetPoint::parse("v", body.as_bytes());
        assert_eq!(read("0.5").unwrap().given.flat, [0.5]);
        let flags = read("[1,true]").unwrap().given;
        assert_eq!((flags.flat, flags.has_flags), (vec![1.0, 1.0], true));
        let sent = read(r#"{"value":0.25,"client":"plc"}"#).unwrap();
        assert_eq!((sent.given.flat, sent.client.as_str()), (vec![0.25], "plc"));
        for (body, code) in [
            ("NaN", Code::BadRequest),
            ("", Code::BadRequest),
            ("\"open\"", Code::Type),
            ("null", Code::Type),
            ("{}", Code::BadRequest),
            (r#"{"value":1,"who":"x"}"#, Code::BadRequest),
        ] {
            assert_eq!(read(body).unwrap_err().code, code, "{body}");
        }
    }

    #[test]
    fn what_is_told_of_a_refused_one_is_who_sent_what_in_bounds() {
        let told = SetPoint::told("v", br#"{"value":7,"client":"plc"}"#);
        assert_eq!(told.client, "plc");
        assert_eq!(told.body, r#"{"value":7,"client":"plc"}"#);
        let long = SetPoint::told(&"v".repeat(60_000), &[b'7'; 60_000]);
        assert_eq!(long.variable.len(), 67);
        assert_eq!(long.body.len(), LONGEST_TOLD);
    }
}
