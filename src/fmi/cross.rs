//! Shared libraries for other machines than this one, by cargo-zigbuild: an optional way of packing.
//!
//! The ordinary way needs nothing but cargo, and its library needs the C library of the machine that built it or a later
//! one. Zig links against the symbols of glibc 2.17 (2012) instead, and for Windows. Set-up: fmu/README.md.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use super::library::source_tree;
use super::{Error, Platform};

/// What brings the tool.
pub const SET_UP: &str = "pip install cargo-zigbuild ziglang";

impl Platform {
    /// Rust's name of the target, with the oldest glibc it shall run on.
    fn triple(self) -> (&'static str, &'static str) {
        match self {
            Self::X64Linux => ("x86_64-unknown-linux-gnu", ".2.17"),
            Self::X64Windows => ("x86_64-pc-windows-gnu", ""),
        }
    }

    fn file_name(self) -> &'static str {
        match self {
            Self::X64Linux => super::library::FILE_NAME,
            Self::X64Windows => "sandgate_fmu.dll",
        }
    }
}

/// Builds the library of the source tree that this program was built in, for any machine of a platform.
///
/// # Errors
/// [`Error::Library`]: not in a source tree, no cargo-zigbuild, or what it printed.
pub fn portable(platform: Platform) -> Result<PathBuf, Error> {
    let program = std::env::current_exe()
        .map_err(|e| Error::Library(format!("cannot tell where this program is: {e}")))?;
    let Some((root, target)) = source_tree(&program) else {
        return Err(Error::Library(format!(
            "building for {} needs Sandgate's source tree, and {} does not lie in one; build it there and give the \
             library with --library",
            platform.name(),
            program.display()
        )));
    };
    build(&root, &target, platform)
}

/// Builds the library of the source tree at `root` below `target`/cross: a folder of its own, so that ordinary builds need
/// not wait for it.
///
/// # Errors
/// [`Error::Library`]: no cargo-zigbuild, or what it printed.
pub fn build(root: &Path, target: &Path, platform: Platform) -> Result<PathBuf, Error> {
    let (triple, glibc) = platform.triple();
    let target = target.join("cross");
    let windows = platform == Platform::X64Windows;
    let mut command = Command::new("cargo-zigbuild");
    command
        .arg(if windows { "rustc" } else { "zigbuild" })
        .args(["--release", "-p", "sandgate-fmu", "--target"])
        .arg(format!("{triple}{glibc}"))
        .arg("--target-dir")
        .arg(&target)
        .current_dir(root);
    if windows {
        // Without a list that it reads, zig's linker exports every symbol.
        let exports = root.join("fmu/exports.def");
        command.args(["--", "-C"]);
        command.arg(format!("link-arg={}", exports.display()));
    }
    let output = command.output().map_err(|e| {
        Error::Library(format!(
            "building for {} needs cargo-zigbuild, which cannot be started ({e}); install it with `{SET_UP}` so \
             that it is on the PATH, or leave out --portable and --platform",
            platform.name()
        ))
    })?;
    let library = target
        .join(triple)
        .join("release")
        .join(platform.file_name());
    if output.status.success() && library.is_file() {
        return Ok(library);
    }
    Err(Error::Library(failure(platform, &output)))
}

fn failure(platform: Platform, output: &Output) -> String {
    let said = String::from_utf8_lossy(&output.stderr);
    let (triple, _) = platform.triple();
    let remedy = if said.contains("can't find crate for `std`") || said.contains("target may not") {
        format!("; install Rust's part of it with `rustup target add {triple}`")
    } else if said.contains("ziglang") || said.contains("find zig") {
        format!("; install zig with `{SET_UP}`")
    } else {
        String::new()
    };
    format!(
        "cargo-zigbuild for {} failed ({}){remedy}:\n{said}",
        platform.name(),
        output.status
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::process::ExitStatusExt;
    use std::process::ExitStatus;

    #[test]
    fn a_failed_build_says_what_to_install() {
        let failed = |said: &str| Output {
            status: ExitStatus::from_raw(256),
            stdout: Vec::new(),
            stderr: said.as_bytes().to_vec(),
        };
        for (said, wanted) in [
            (
                "error[E0463]: can't find crate for `std`",
                "rustup target add x86_64-pc-windows-gnu",
            ),
            ("Error: Failed to find zig", SET_UP),
            ("error: something else", "something else"),
        ] {
            let message = failure(Platform::X64Windows, &failed(said));
            assert!(message.contains(wanted), "{message}");
            assert!(message.contains("x86_64-windows"));
        }
    }
}
