//! `sandgate fmu CASE`: packs the case and the shared library into one FMU file.

use std::path::PathBuf;

use super::{CliError, load_scene, say};
use crate::fmi::{FmiVersion, library, pack};

/// What may be typed after `sandgate fmu`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene file, for example cases/silo_gate.toml
    case: PathBuf,
    /// FMI version: 2 (2.0.5) or 3 (3.0.2), co-simulation
    #[arg(long, value_name = "VERSION", default_value_t = 3, value_parser = clap::value_parser!(u8).range(2..=3))]
    fmi: u8,
    /// The file to write [default: <case>.fmu in this folder]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The shared library to put into it [default: the one beside this program, or built if this is a source tree]
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
}

/// Packs the FMU.
///
/// # Errors
/// [`CliError::Scene`]; [`CliError::Fmu`] if there is no library, or files cannot be read or written.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let scene = load_scene(&args.case)?;
    let version = match args.fmi {
        2 => FmiVersion::V2,
        _ => FmiVersion::V3,
    };
    let output = args
        .output
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("{}.fmu", scene.name)));
    let library = library::locate(args.library.as_deref())?;
    pack(&scene, version, &library, &output)?;
    let size = std::fs::metadata(&output).map_or(0, |file| file.len());
    say(&format!(
        "{}: FMI {} co-simulation FMU of {}, {:.1} MB",
        output.display(),
        version.name(),
        scene.name,
        size as f64 / 1e6
    ))
}
