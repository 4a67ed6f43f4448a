//! `sandgate fmu CASE`: packs the case and the shared library into one FMU file.

use std::path::{Path, PathBuf};

use super::{CliError, load_scene, quantity, say};
use crate::fmi::library::Kind;
use crate::fmi::{Error, Extent, FmiVersion, Packing, Platform, cross, library, pack_with};

/// What may be typed after `sandgate fmu`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The scene file, for example cases/silo_gate.toml
    case: PathBuf,
    /// FMI version: 2 (2.0.5) or 3 (3.0.2), co-simulation
    #[arg(long, value_name = "VERSION", default_value_t = 3, value_parser = clap::value_parser!(u8).range(2..=3))]
    fmi: u8,
    /// The file to write; one that is there is replaced [default: <case>.fmu in this folder]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// A shared library to put into it, one a platform [default: the one beside this program, or built if this is a
    /// source tree]
    #[arg(long, value_name = "FILE", conflicts_with_all = ["portable", "platform"])]
    library: Vec<PathBuf>,
    /// Build the library for any Linux with glibc 2.17 or later, with cargo-zigbuild (fmu/README.md says how to set it up)
    #[arg(long)]
    portable: bool,
    /// Platforms whose binaries go into the FMU: x86_64-linux, x86_64-windows (with cargo-zigbuild)
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = platform)]
    platform: Vec<Platform>,
    /// Pack the library with Zenoh: the parameter zenoh.config then publishes gauges and takes set-points; the archive is
    /// larger. With --library, say that the given one has it
    #[arg(long, conflicts_with_all = ["portable", "platform"])]
    zenoh: bool,
    /// How far the reference results in the archive go, in simulated time; 0: initial values only [default: what about
    /// two seconds of computing reach, at least one step]
    #[arg(long, value_name = "TIME", value_parser = quantity::time, allow_hyphen_values = true)]
    reference: Option<f64>,
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
    check_output(args, &output)?;
    let packing = Packing {
        version,
        libraries: libraries(args)?,
        reference: args.reference.map_or(Extent::Short, Extent::Until),
        kind: args.kind(),
    };
    let packed = pack_with(&scene, &packing, &output)
        .map_err(|error| CliError::from(error).of_scene(&args.case))?;
    if let Some(why) = packed.cut_short {
        tell!(
            "warning: reference results end at t = {} s, as the next step of this scene fails on its own: {why}",
            packed.reference_until
        );
    }
    let size = std::fs::metadata(&output).map_or(0, |file| file.len());
    say(&format!(
        "{}: FMI {} co-simulation FMU of {}, {:.1} MB",
        output.display(),
        version.name(),
        scene.name,
        size as f64 / 1e6
    ))
}

/// The archive replaces what is there, but not what it is made of; its folder is there, which is known before all the work.
fn check_output(args: &Args, output: &Path) -> Result<(), CliError> {
    let folder = output.parent().unwrap_or(Path::new(""));
    if !folder.as_os_str().is_empty() && !folder.is_dir() {
        return Err(CliError::Usage(format!(
            "--output: found {}, whose folder does not exist; make {} first, or name a folder that is there",
            output.display(),
            folder.display()
        )));
    }
    let same = |other: &Path| match (output.canonicalize(), other.canonicalize()) {
        (Ok(output), Ok(other)) => output == other,
        _ => false,
    };
    if std::iter::once(&args.case)
        .chain(&args.library)
        .any(|from| same(from))
    {
        return Err(CliError::Usage(format!(
            "--output: found {}, which the FMU is made of; give the name of the archive, for example {}",
            output.display(),
            output.with_extension("fmu").display()
        )));
    }
    Ok(())
}

impl Args {
    fn kind(&self) -> Kind {
        match self.zenoh {
            true => Kind::Zenoh,
            false => Kind::Plain,
        }
    }
}

/// The shared libraries that were given, found or built.
fn libraries(args: &Args) -> Result<Vec<PathBuf>, Error> {
    if !args.library.is_empty() {
        let given = args.library.iter();
        return given
            .map(|path| library::locate(Some(path.as_path()), args.kind()))
            .collect();
    }
    let mut platforms = args.platform.clone();
    if platforms.is_empty() {
        platforms.push(Platform::X64Linux);
    }
    // One that is named twice is meant once.
    platforms.sort_by_key(|platform| platform.name());
    platforms.dedup();
    let found = platforms.into_iter().map(|platform| match platform {
        Platform::X64Linux if !args.portable => {
            if let Some(command) = library::will_run(args.kind()) {
                tell!("shared library: `{command}` (a minute or two where sources have changed)");
            }
            library::locate(None, args.kind())
        }
        _ => cross::portable(platform),
    });
    found.collect()
}

fn platform(name: &str) -> Result<Platform, String> {
    let all = Platform::ALL;
    let found = all.into_iter().find(|platform| platform.name() == name);
    let names = all.map(Platform::name).join(", ");
    found.ok_or_else(|| format!("found {name}, allowed {names}"))
}
