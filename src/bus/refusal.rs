//! Why something was refused, and the codes by which replies spell it.

use crate::component;

/// Why a request was refused; spelled as in docs/zenoh.md.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Code {
    /// Not JSON, unknown verb or field, missing field.
    BadRequest,
    /// No such variable.
    UnknownVariable,
    /// A value out of its range.
    Range,
    /// A value of the wrong type or length.
    Type,
    /// Not allowed in the present mode.
    State,
    /// The queue is full; nothing happened; send it again.
    Busy,
    /// Somebody else owns time.
    NotOwner,
    /// `expect_step`, `t_ns` or a used `req` do not match.
    Conflict,
    /// The solver gave up; restore or reset.
    Diverged,
    /// The key is an expression.
    Wildcard,
    /// The body is too large.
    TooLarge,
    /// A defect of this program.
    Internal,
}

impl Code {
    /// All of them.
    const ALL: [Self; 12] = [
        Self::BadRequest,
        Self::UnknownVariable,
        Self::Range,
        Self::Type,
        Self::State,
        Self::Busy,
        Self::NotOwner,
        Self::Conflict,
        Self::Diverged,
        Self::Wildcard,
        Self::TooLarge,
        Self::Internal,
    ];

    /// As it stands in replies.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::BadRequest => "bad_request",
            Self::UnknownVariable => "unknown_variable",
            Self::Range => "range",
            Self::Type => "type",
            Self::State => "state",
            Self::Busy => "busy",
            Self::NotOwner => "not_owner",
            Self::Conflict => "conflict",
            Self::Diverged => "diverged",
            Self::Wildcard => "wildcard",
            Self::TooLarge => "too_large",
            Self::Internal => "internal",
        }
    }
}

/// A refusal: nothing happened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}: {message}", code.as_str())]
pub struct Refusal {
    /// Kind.
    pub code: Code,
    /// Found, allowed, what to do.
    pub message: String,
}

impl Refusal {
    /// A refusal with its message.
    #[must_use]
    pub fn new(code: Code, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
        }
    }
}

/// The component says itself which code its errors have.
impl From<component::Error> for Refusal {
    fn from(error: component::Error) -> Self {
        let reply = error.status().reply;
        let code = Code::ALL.into_iter().find(|code| code.as_str() == reply);
        Self::new(code.unwrap_or(Code::Internal), error.to_string())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::component::Mode;

    #[test]
    fn errors_of_the_component_have_codes_of_the_wire() {
        let table = [
            (component::Error::Setup(String::new()), Code::Internal),
            (
                component::Error::NotAllowedNow {
                    call: "do_step".to_owned(),
                    mode: Mode::Failed,
                    allowed: String::new(),
                },
                Code::State,
            ),
            (
                component::Error::BadArgument {
                    call: "set",
                    what: String::new(),
                    found: String::new(),
                    allowed: String::new(),
                    remedy: String::new(),
                },
                Code::Range,
            ),
            (component::Error::Solver(String::new()), Code::Diverged),
            (component::Error::Snapshot(String::new()), Code::BadRequest),
        ];
        for (error, code) in table {
            assert_eq!(error.status().reply, code.as_str());
            assert_eq!(Refusal::from(error).code, code);
        }
    }
}
