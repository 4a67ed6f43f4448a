//! `sandgate schema`: the JSON Schema of scene files, for editors and checkers.

use super::{CliError, say};

/// `sandgate schema` takes no arguments.
#[derive(Debug, clap::Args)]
pub(super) struct Args {}

/// Prints the schema.
///
/// # Errors
/// [`CliError::File`] if standard output cannot be written.
pub(super) fn run(_: &Args) -> Result<(), CliError> {
    say(crate::scene::schema().trim_end())
}
