//! Keys of one instance: those of [`wire::keys`](crate::wire::keys), and what only the bus needs beside them: which
//! expressions to listen on, and which verb or variable a key that came in names.
//!
//! Does not know Zenoh: keys are text here.

use super::refusal::{Code, Refusal};
use crate::wire::keys::{self, BadInstance, ROOT};

/// The keys of one instance.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Keys {
    base: String,
}

impl Keys {
    /// Keys below `sandgate/v1/INSTANCE`.
    ///
    /// # Errors
    /// [`BadInstance`] unless the name is 1 to 64 of `a-z 0-9 _ -`.
    pub fn new(instance: &str) -> Result<Self, BadInstance> {
        keys::base(ROOT, instance).map(|base| Self { base })
    }

    /// `sandgate/v1/INSTANCE`.
    #[must_use]
    pub fn base(&self) -> &str {
        &self.base
    }

    /// `INSTANCE`.
    #[must_use]
    pub fn instance(&self) -> &str {
        self.base.rsplit('/').next().unwrap_or_default()
    }

    /// Liveliness token: there while the process lives.
    #[must_use]
    pub fn alive(&self) -> String {
        format!("{}/@alive", self.base)
    }

    /// Every request, also one for a verb that does not exist (which is answered, too).
    #[must_use]
    pub fn every_request(&self) -> String {
        keys::control(&self.base, "rpc", "**")
    }

    /// Requests of one verb.
    #[must_use]
    pub fn request(&self, verb: &str) -> String {
        keys::control(&self.base, "rpc", verb)
    }

    /// Every set-point.
    #[must_use]
    pub fn every_input(&self) -> String {
        keys::input(&self.base, "**")
    }

    /// Everything that is published.
    #[must_use]
    pub fn every_output(&self) -> String {
        format!("{}/out/**", self.base)
    }

    /// The verb of a request's key. The key must be the exact one: an expression would ask several at once.
    ///
    /// # Errors
    /// [`Code::Wildcard`] for expressions, [`Code::BadRequest`] for other keys.
    pub fn verb_of<'k>(&self, key: &'k str) -> Result<&'k str, Refusal> {
        chunk(key, &self.request(""), "a request", "VERB")
    }

    /// The variable of a set-point's key. The key must be concrete.
    ///
    /// # Errors
    /// As [`Keys::verb_of`].
    pub fn variable_of<'k>(&self, key: &'k str) -> Result<&'k str, Refusal> {
        chunk(key, &keys::input(&self.base, ""), "a set-point", "VARIABLE")
    }
}

fn chunk<'k>(key: &'k str, prefix: &str, what: &str, name: &str) -> Result<&'k str, Refusal> {
    if key.contains(['*', '$']) {
        return Err(Refusal::new(
            Code::Wildcard,
            format!(
                "found key {key:?}: {what} goes to one exact key {prefix}{name}, without * or $"
            ),
        ));
    }
    match key.strip_prefix(prefix) {
        Some(found) if !found.is_empty() && !found.contains('/') => Ok(found),
        _ => Err(Refusal::new(
            Code::BadRequest,
            format!(
                "found key {key:?}: {what} goes to {prefix}{name}, the name as it is, with its dots"
            ),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_those_of_the_documentation() {
        let keys = Keys::new("silo-1").unwrap();
        assert_eq!(keys.base(), "sandgate/v1/silo-1");
        assert_eq!(keys.alive(), "sandgate/v1/silo-1/@alive");
        assert_eq!(keys.request("step"), "sandgate/v1/silo-1/@rpc/step");
        assert_eq!(keys.every_request(), "sandgate/v1/silo-1/@rpc/**");
        assert_eq!(keys.every_input(), "sandgate/v1/silo-1/in/**");
        assert!(Keys::new("Silo").is_err());
    }

    #[test]
    fn only_exact_keys_name_a_verb_or_a_variable() {
        let keys = Keys::new("silo-1").unwrap();
        assert_eq!(keys.verb_of("sandgate/v1/silo-1/@rpc/step"), Ok("step"));
        assert_eq!(
            keys.variable_of("sandgate/v1/silo-1/in/gate.main.opening"),
            Ok("gate.main.opening")
        );
        for (key, code) in [
            ("sandgate/v1/silo-1/@rpc/*", Code::Wildcard),
            ("sandgate/v1/*/@rpc/step", Code::Wildcard),
            ("sandgate/v1/silo-1/@rpc/**", Code::Wildcard),
            ("sandgate/v1/silo-1/@rpc/st$*", Code::Wildcard),
            ("sandgate/v1/silo-1/@rpc", Code::BadRequest),
            ("sandgate/v1/silo-1/@rpc/step/now", Code::BadRequest),
            ("sandgate/v1/other/@rpc/step", Code::BadRequest),
        ] {
            assert_eq!(keys.verb_of(key).unwrap_err().code, code, "{key}");
        }
        assert_eq!(
            keys.variable_of("sandgate/v1/silo-1/in/**")
                .unwrap_err()
                .code,
            Code::Wildcard
        );
    }
}
