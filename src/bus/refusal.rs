//! Why something was refused, and the codes by which replies spell it.

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
