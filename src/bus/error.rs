//! Why a server could not be opened or had to end.

use super::advice::Advice;
use super::endpoints::BadEndpoint;
use crate::component;
use crate::wire::keys::BadInstance;

/// What Zenoh says, without the places in its source that it adds to every error (` at FILE:1507.`): they are
/// those of the machine that built this program.
pub(super) fn words(error: impl std::fmt::Display) -> String {
    let mut text = error.to_string();
    while let Some((from, to)) = source_place(&text) {
        text.replace_range(from..to, "");
    }
    text.trim_end().to_owned()
}

/// The first ` at PATH.rs:LINE.`, as bytes from and to. A path may have spaces, but hardly one before and one after "at".
fn source_place(text: &str) -> Option<(usize, usize)> {
    text.match_indices(".rs:").find_map(|(dot, ending)| {
        let line = &text[dot + ending.len()..];
        let digits = line.bytes().take_while(u8::is_ascii_digit).count();
        let from = text[..dot].rfind(" at ")?;
        let to = dot + ending.len() + digits + usize::from(line[digits..].starts_with('.'));
        (digits > 0).then_some((from, to))
    })
}

/// Errors of serving.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BusError {
    /// The instance's name.
    #[error(transparent)]
    Instance(#[from] BadInstance),
    /// An endpoint.
    #[error(transparent)]
    Endpoint(#[from] BadEndpoint),
    /// Zenoh's configuration file.
    #[error("Zenoh configuration {file}: {reason}")]
    Config {
        /// The file.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// Something that Zenoh would not do.
    #[error("{doing}: {reason}")]
    Zenoh {
        /// What was tried.
        doing: String,
        /// Zenoh's words.
        reason: String,
    },
    /// Closing the session took too long.
    #[error(
        "the session was not closed within {seconds} s, because a subscriber takes nothing of what is published; what is left \
         of it ends with the process"
    )]
    LeftOpen {
        /// How long that was waited for [s].
        seconds: u64,
    },
    /// The name is taken.
    #[error(
        "an instance {instance:?} is already served there; choose another name {}, or end the other one",
        advice.instance()
    )]
    Taken {
        /// The name.
        instance: String,
        /// Who reads it.
        advice: Advice,
    },
    /// Zenoh's threads are those of another process.
    #[error(
        "this process was forked from one that had opened a Zenoh session, whose threads it does not have; start it as a new \
         program (Python: multiprocessing.set_start_method(\"spawn\")), or fork before the first session is opened"
    )]
    Forked,
    /// A thread could not be started.
    #[error("cannot start a thread: {0}")]
    Thread(String),
    /// The component could not be brought to its first communication point.
    #[error(transparent)]
    Component(#[from] component::Error),
}

#[cfg(test)]
mod tests {
    use super::words;

    #[test]
    fn paths_of_the_machine_that_built_it_are_not_told() {
        for (told, left) in [
            (
                "JSON error: x at 3:1 at /a/b c/zenoh-config-1.10.2/src/lib.rs:1507.",
                "JSON error: x at 3:1",
            ),
            (
                "no link! at /a/mod.rs:7. - Caused by refused at C:\\b\\tcp.rs:12.",
                "no link! - Caused by refused",
            ),
            ("refused at /a/notes.txt:3.", "refused at /a/notes.txt:3."),
            ("plain", "plain"),
        ] {
            assert_eq!(words(told), left);
        }
    }
}
