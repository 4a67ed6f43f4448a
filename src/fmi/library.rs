//! Finds the shared library that goes into FMUs, or builds it in a source tree.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::Error;

/// File name of the shared library.
pub const FILE_NAME: &str = "libsandgate_fmu.so";

/// What a library without Zenoh says when it shall publish, before what to do. It stands in its bytes, and not in those of one
/// with Zenoh.
pub const WITHOUT_ZENOH: &str = "this library was built without Zenoh; ";

/// What a library says of the sources it was built from, so far as descriptions depend on them. It stands in its bytes: one of
/// other sources makes another token of the same scene, and would refuse the description that is packed with it.
pub const BUILT_FROM: &str = concat!(
    "this library was built from sources ",
    env!("SANDGATE_LIBRARY_SOURCES"),
    "; "
);

/// Which of the shared libraries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// Without Zenoh.
    #[default]
    Plain,
    /// With Zenoh: an archive is several times as large.
    Zenoh,
}

impl Kind {
    /// The package that makes it.
    fn package(self) -> &'static str {
        match self {
            Self::Plain => "sandgate-fmu",
            Self::Zenoh => "sandgate-fmu-zenoh",
        }
    }

    /// Its file.
    fn file_name(self) -> &'static str {
        match self {
            Self::Plain => FILE_NAME,
            Self::Zenoh => "libsandgate_fmu_zenoh.so",
        }
    }

    /// What builds it.
    fn build_command(self) -> String {
        format!("cargo build --release -p {}", self.package())
    }
}

/// The shared library of a kind: `explicit` if given; in a source tree what a build there gives; else the file beside the program.
///
/// The build comes before the file beside the program, so that a library of yesterday's sources is never packed.
///
/// # Errors
/// [`Error::Library`] names what was looked for and the command that builds it.
pub fn locate(explicit: Option<&Path>, kind: Kind) -> Result<PathBuf, Error> {
    let (file_name, command) = (kind.file_name(), kind.build_command());
    if let Some(path) = explicit {
        let wrong = if !path.is_file() {
            "is not a file"
        } else if kind == Kind::Zenoh && lacks_zenoh(path) {
            "was built without Zenoh"
        } else {
            return Ok(path.to_path_buf());
        };
        return Err(Error::Library(format!(
            "{} {wrong}; give the {file_name} that `{command}` makes, or leave it out",
            path.display()
        )));
    }
    let program = std::env::current_exe()
        .map_err(|e| Error::Library(format!("cannot tell where this program is: {e}")))?;
    if let Some((root, target)) = source_tree(&program) {
        return build_kind(&root, &target, kind);
    }
    let beside = program.with_file_name(file_name);
    if beside.is_file() {
        return Ok(beside);
    }
    Err(Error::Library(format!(
        "no {file_name} beside {}; build it with `{command}` in Sandgate's source tree and give its path",
        program.display()
    )))
}

/// What [`locate`] is going to run to be sure of a library, if none is given.
#[must_use]
pub fn will_run(kind: Kind) -> Option<String> {
    let program = std::env::current_exe().ok()?;
    source_tree(&program).map(|_| kind.build_command())
}

/// A file that cannot be read is refused where it is packed.
fn lacks_zenoh(library: &Path) -> bool {
    let bytes = std::fs::read(library).unwrap_or_default();
    says(&bytes, WITHOUT_ZENOH)
}

/// Whether a text stands among the bytes of a library.
pub(super) fn says(library: &[u8], text: &str) -> bool {
    let text = text.as_bytes();
    library.windows(text.len()).any(|part| part == text)
}

/// Builds the library of the source tree at `root` into `target`.
///
/// # Errors
/// [`Error::Library`] with what cargo printed.
pub fn build(root: &Path, target: &Path) -> Result<PathBuf, Error> {
    build_kind(root, target, Kind::Plain)
}

/// As [`build`], of a kind.
///
/// # Errors
/// As [`build`].
pub fn build_kind(root: &Path, target: &Path, kind: Kind) -> Result<PathBuf, Error> {
    let command = kind.build_command();
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let output = Command::new(cargo)
        .args(["build", "--release", "-p", kind.package(), "--target-dir"])
        .arg(target)
        .current_dir(root)
        .output()
        .map_err(|e| {
            Error::Library(format!(
                "cannot start cargo ({e}); run `{command}` yourself and give the library's path"
            ))
        })?;
    let library = target.join("release").join(kind.file_name());
    if output.status.success() && library.is_file() {
        return Ok(library);
    }
    Err(Error::Library(format!(
        "`{command}` in {} failed ({}):\n{}",
        root.display(),
        output.status,
        String::from_utf8_lossy(&output.stderr)
    )))
}

/// The source tree and target folder a program was built in: ROOT/target/PROFILE/program.
pub(super) fn source_tree(program: &Path) -> Option<(PathBuf, PathBuf)> {
    let target = program
        .ancestors()
        .find(|folder| folder.join("CACHEDIR.TAG").is_file())?;
    let root = target.parent()?;
    let ours = root.join("fmu/Cargo.toml").is_file() && root.join("Cargo.toml").is_file();
    ours.then(|| (root.to_path_buf(), target.to_path_buf()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_in_a_target_folder_knows_its_source_tree() {
        let folder = temp_dir::TempDir::new().expect("a scratch folder");
        let root = folder.path();
        let target = root.join("target");
        let program = target.join("release/deps/sandgate");
        for file in ["Cargo.toml", "fmu/Cargo.toml", "target/CACHEDIR.TAG"] {
            assert_eq!(source_tree(&program), None);
            let file = root.join(file);
            std::fs::create_dir_all(file.parent().expect("it has one")).expect("writable");
            std::fs::write(file, "").expect("writable");
        }
        assert_eq!(source_tree(&program), Some((root.to_path_buf(), target)));
    }

    #[test]
    fn a_library_without_zenoh_is_not_packed_as_one_with_it() {
        let folder = temp_dir::TempDir::new().expect("a scratch folder");
        let library = folder.path().join("lib.so");
        std::fs::write(&library, format!("ELF{WITHOUT_ZENOH}...")).expect("writable");
        let error = locate(Some(&library), Kind::Zenoh).expect_err("it has none");
        let error = error.to_string();
        assert!(error.contains("lib.so was built without Zenoh"), "{error}");
        assert!(error.contains("-p sandgate-fmu-zenoh"), "{error}");
        assert!(locate(Some(&library), Kind::Plain).is_ok());
        std::fs::write(&library, "ELF").expect("writable");
        assert!(locate(Some(&library), Kind::Zenoh).is_ok());
    }

    #[test]
    fn a_library_that_is_not_there_is_named() {
        let error = locate(Some(Path::new("nowhere.so")), Kind::Plain).expect_err("not there");
        assert!(error.to_string().contains("nowhere.so is not a file"));
        assert!(
            error
                .to_string()
                .contains("cargo build --release -p sandgate-fmu")
        );
    }
}
