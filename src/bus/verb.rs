//! What may be asked: one row a verb.

use super::fields::cut;
use super::refusal::{Code, Refusal};

/// What may be asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verb {
    /// Variables, keys, verbs.
    Describe,
    /// Time, mode, ledger; answered also while a step runs.
    Status,
    /// Values of variables.
    Get,
    /// Sets inputs.
    Set,
    /// One communication step.
    Step,
    /// Steps by itself from now on.
    Run,
    /// Waits for `step` from now on.
    Pause,
    /// Back to the start.
    Reset,
    /// The state, as base64.
    Save,
    /// Back to a saved state.
    Restore,
    /// A line for people, into the log and on `out/log`.
    Log,
    /// Ends the component and the server.
    Terminate,
}

/// One row a verb: name, fields besides `req` and `client`, whether it changes something (then `req` is a must).
const VERBS: [(Verb, &str, &[&str], bool); 12] = [
    (Verb::Describe, "describe", &[], false),
    (Verb::Status, "status", &[], false),
    (Verb::Get, "get", &["outputs"], false),
    (
        Verb::Set,
        "set",
        &["inputs", "outputs", "expect_step"],
        true,
    ),
    (
        Verb::Step,
        "step",
        &["t_ns", "dt_ns", "inputs", "outputs", "expect_step"],
        true,
    ),
    (Verb::Run, "run", &["realtime_factor", "expect_step"], true),
    (Verb::Pause, "pause", &["expect_step"], true),
    (Verb::Reset, "reset", &["inputs", "expect_step"], true),
    (Verb::Save, "save", &["expect_step"], false),
    (Verb::Restore, "restore", &["state", "expect_step"], true),
    (Verb::Log, "log", &["message", "level"], true),
    (Verb::Terminate, "terminate", &["expect_step"], true),
];

/// Longest body of most requests (bytes).
const BODY: usize = 1 << 20;

impl Verb {
    /// Longest state that `restore` takes, as base64 (bytes): 47 MiB of state.
    pub const MOST_STATE: usize = 63 << 20;

    /// All of them.
    pub fn all() -> impl Iterator<Item = Self> {
        VERBS.iter().map(|row| row.0)
    }

    /// By name.
    ///
    /// # Errors
    /// [`Code::BadRequest`], naming those that exist.
    pub fn from_name(name: &str) -> Result<Self, Refusal> {
        VERBS
            .iter()
            .find(|row| row.1 == name)
            .map(|row| row.0)
            .ok_or_else(|| {
                let known: Vec<_> = VERBS.iter().map(|row| row.1).collect();
                let name = cut(name);
                Refusal::new(
                    Code::BadRequest,
                    format!("unknown verb {name:?}; there are {}", known.join(", ")),
                )
            })
    }

    fn row(self) -> &'static (Verb, &'static str, &'static [&'static str], bool) {
        // `VERBS` has one row a verb, in the order of declaration (tested).
        &VERBS[self as usize]
    }

    /// As it stands in keys.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().1
    }

    /// Fields it takes besides `req` and `client`.
    #[must_use]
    pub fn fields(self) -> &'static [&'static str] {
        self.row().2
    }

    /// Whether it changes something: then `req` must be there, and a second request with it gets the first reply.
    #[must_use]
    pub fn changes(self) -> bool {
        self.row().3
    }

    /// Whether it changes the component or who steps it: then whoever sends it counts as the orchestrator. Anybody may
    /// write a line into the log.
    #[must_use]
    pub fn drives(self) -> bool {
        self.changes() && self != Self::Log
    }

    /// Longest body (bytes): room for a state in `restore`, little else.
    #[must_use]
    pub fn max_body(self) -> usize {
        match self {
            Self::Restore => Self::MOST_STATE + BODY,
            _ => BODY,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn verbs_have_one_row_each_in_the_order_of_declaration() {
        for (position, verb) in Verb::all().enumerate() {
            assert_eq!(verb as usize, position);
            assert_eq!(Verb::from_name(verb.name()), Ok(verb));
        }
        let names: Vec<_> = Verb::all().map(Verb::name).collect();
        assert_eq!(names, crate::wire::keys::VERBS);
        let changing = Verb::all().filter(|verb| verb.changes() && !verb.drives());
        assert_eq!(changing.collect::<Vec<_>>(), [Verb::Log]);
        let refusal = Verb::from_name("stepp").unwrap_err();
        assert_eq!(refusal.code, Code::BadRequest);
        assert!(refusal.message.contains("terminate"), "{refusal}");
    }
}
