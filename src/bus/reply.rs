//! Replies: JSON text with where the component stands.

use super::refusal::{Code, Refusal};
use super::status::Status;
use serde_json::{Map, Value};

/// An answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Reply {
    /// Kind of error; none if all went well.
    pub error: Option<Code>,
    /// JSON text.
    pub body: String,
    /// Whether the server ends after this.
    pub ends: bool,
}

impl Reply {
    /// `ok` or the code of the error.
    #[must_use]
    pub fn status(&self) -> &'static str {
        self.error.map_or("ok", Code::as_str)
    }

    /// A refusal, with where the component stands.
    #[must_use]
    pub fn refusal(req: &str, refusal: &Refusal, status: &Status) -> Self {
        let mut map = Map::new();
        map.insert("ok".into(), false.into());
        map.insert("req".into(), req.into());
        map.insert("code".into(), refusal.code.as_str().into());
        map.insert("message".into(), refusal.message.as_str().into());
        map.extend(status.brief());
        Self {
            error: Some(refusal.code),
            body: Value::Object(map).to_string(),
            ends: false,
        }
    }

    pub(super) fn success(req: &str, status: &Status, fields: Map<String, Value>) -> Self {
        let mut map = Map::new();
        map.insert("ok".into(), true.into());
        map.insert("req".into(), req.into());
        map.extend(status.brief());
        map.extend(fields);
        Self {
            error: None,
            body: Value::Object(map).to_string(),
            ends: false,
        }
    }
}
