//! Library + description + scene → .fmu. The same inputs give the same bytes.

use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::library::{self, Kind};
use super::reference::{self, Extent, Reference, manifest};
use super::slot::{self, SlotError};
use super::{Error, FmiVersion, Platform, description, identifier, page::page, terminals};
use crate::component::Component;
use crate::scene::Scene;
use crate::whole_file;

const LICENSE_APACHE: &str = include_str!("../../LICENSE-APACHE");
const LICENSE_MIT: &str = include_str!("../../LICENSE-MIT");
/// Of the crates inside the shared library, and of those inside the one with Zenoh; tests/it/licenses.rs writes them.
const THIRD_PARTY: &str = include_str!("licenses/third_party.txt");
const THIRD_PARTY_ZENOH: &str = include_str!("licenses/third_party_zenoh.txt");

/// What goes into an FMU beside the scene.
#[derive(Clone, Debug)]
pub struct Packing {
    /// Version of the standard.
    pub version: FmiVersion,
    /// Shared libraries, one a platform, at least one.
    pub libraries: Vec<PathBuf>,
    /// How far the reference results go.
    pub reference: Extent,
    /// Which libraries these are: their licences differ.
    pub kind: Kind,
}

/// What an FMU was packed with.
#[derive(Clone, Debug, PartialEq)]
pub struct Packed {
    /// Where the reference results end [s].
    pub reference_until: f64,
    /// Why, if the step after that failed.
    pub cut_short: Option<String>,
}

/// Writes an FMU of `scene` to `out`, with the scene inside a copy of the shared library at `library` and short
/// reference results: [`pack_with`] the defaults.
///
/// # Errors
/// As [`pack_with`].
pub fn pack(
    scene: &Scene,
    version: FmiVersion,
    library: &Path,
    out: &Path,
) -> Result<Packed, Error> {
    let packing = Packing {
        version,
        libraries: vec![library.to_path_buf()],
        reference: Extent::Short,
        kind: Kind::Plain,
    };
    pack_with(scene, &packing, out)
}

/// Writes an FMU of `scene` to `out`, with the scene inside a copy of each shared library.
///
/// Same inputs, same bytes: time stamps are fixed, entries are deflated, names have forward slashes. The file appears
/// under its name only when it is complete.
///
/// # Errors
/// [`Error`]: the scene cannot be built, stepped as far as [`Extent::Until`] says, or is too long, a library is missing or of another kind, two are for
/// the same platform, a file cannot be read or written.
pub fn pack_with(scene: &Scene, packing: &Packing, out: &Path) -> Result<Packed, Error> {
    let binaries = binaries(scene, packing)?;
    let component = Component::new(scene)?;
    let reference = reference::reference(scene, packing.reference)?;
    let version = packing.version;
    let mut entries = vec![entry(
        "modelDescription.xml",
        description(&component, version),
    )];
    entries.extend(binaries);
    entries.push(entry("resources/scene.toml", &scene.source));
    entries.push(entry(
        "documentation/index.html",
        page(&component, version, &reference),
    ));
    entries.extend(licenses(packing.kind));
    entries.extend(reference_files(&identifier(scene), &reference));
    entries.extend(icons(&component, version));
    let archive = archive(&entries).map_err(|source| file("write", out, source))?;
    whole_file::replace(out, &archive).map_err(|source| file("write", out, source))?;
    Ok(Packed {
        reference_until: reference.until,
        cut_short: reference.cut_short,
    })
}

/// Name in the archive, and bytes.
type Entry = (String, Vec<u8>);

fn entry(name: impl Into<String>, bytes: impl AsRef<[u8]>) -> Entry {
    (name.into(), bytes.as_ref().to_vec())
}

fn licenses(kind: Kind) -> [Entry; 3] {
    let own = format!(
        "Sandgate {} is licensed under either of the two licences below, at your choice.\n\n\
         ==== MIT ====\n\n{LICENSE_MIT}\n==== Apache-2.0 ====\n\n{LICENSE_APACHE}",
        env!("CARGO_PKG_VERSION")
    );
    let third_party = match kind {
        Kind::Plain => THIRD_PARTY,
        Kind::Zenoh => THIRD_PARTY_ZENOH,
    };
    let folder = "documentation/licenses";
    [
        entry(format!("{folder}/license.txt"), own),
        entry(
            format!("{folder}/license.spdx"),
            concat!(env!("CARGO_PKG_LICENSE"), "\n"),
        ),
        entry(format!("{folder}/third_party.txt"), third_party),
    ]
}

fn reference_files(identifier: &str, reference: &Reference) -> [Entry; 3] {
    let folder = reference::FOLDER;
    [
        entry(
            format!("{folder}/fmi-ls-manifest.xml"),
            manifest(identifier, reference),
        ),
        entry(format!("{folder}/{identifier}_in.csv"), &reference.inputs),
        entry(format!("{folder}/{identifier}_out.csv"), &reference.outputs),
    ]
}

/// A picture for tools, and in FMI 3 the terminals beside it.
fn icons(component: &Component, version: FmiVersion) -> Vec<Entry> {
    match version {
        FmiVersion::V2 => vec![entry("model.png", terminals::ICON_PNG)],
        FmiVersion::V3 => {
            let folder = "terminalsAndIcons";
            let document = terminals::terminals(component);
            vec![
                entry(format!("{folder}/terminalsAndIcons.xml"), document),
                entry(format!("{folder}/icon.png"), terminals::ICON_PNG),
                entry(format!("{folder}/icon.svg"), terminals::ICON_SVG),
            ]
        }
    }
}

/// Names in the archive and bytes of the libraries, each with the scene in its slot.
fn binaries(scene: &Scene, packing: &Packing) -> Result<Vec<Entry>, Error> {
    let id = identifier(scene);
    let mut binaries: Vec<Entry> = Vec::new();
    for library in &packing.libraries {
        let (platform, bytes) = with_scene(library, scene)?;
        let folder = platform.folder(packing.version);
        let name = format!("binaries/{folder}/{id}.{}", platform.ending());
        if binaries.iter().any(|(other, _)| *other == name) {
            return Err(Error::WrongLibrary {
                path: library.clone(),
                found: format!("a second library for {}, one is allowed", platform.name()),
            });
        }
        binaries.push((name, bytes));
    }
    if binaries.is_empty() {
        return Err(Error::Library(
            "found no shared library to pack, at least one is needed".to_owned(),
        ));
    }
    Ok(binaries)
}

/// The library's platform and its bytes with the scene in its slot.
fn with_scene(library: &Path, scene: &Scene) -> Result<(Platform, Vec<u8>), Error> {
    let wrong = |found: String| Error::WrongLibrary {
        path: library.to_path_buf(),
        found,
    };
    let mut bytes = fs::read(library).map_err(|source| file("read", library, source))?;
    let Some(platform) = Platform::of(&bytes) else {
        let known = Platform::ALL.map(Platform::name).join(" or ");
        return Err(wrong(format!("it is no shared library for {known}")));
    };
    match slot::fill(&mut bytes, &scene.source) {
        Ok(()) if !library::says(&bytes, library::BUILT_FROM) => Err(wrong(
            "it was built from other sources than this program and would refuse the description packed with it; where sources \
             were edited since this program was built, it is the older one: `cargo build --release`, then again"
                .to_owned(),
        )),
        Ok(()) => Ok((platform, bytes)),
        Err(SlotError::TooLong(found)) => Err(Error::SceneTooLong {
            found,
            allowed: slot::CAPACITY,
        }),
        Err(error) => Err(wrong(error.to_string())),
    }
}

fn archive(entries: &[Entry]) -> std::io::Result<Vec<u8>> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in entries {
        let executable = name.starts_with("binaries/");
        let options = SimpleFileOptions::default()
            .compression_method(CompressionMethod::Deflated)
            .last_modified_time(DateTime::default())
            .unix_permissions(if executable { 0o755 } else { 0o644 });
        zip.start_file(name.as_str(), options)?;
        zip.write_all(bytes)?;
    }
    Ok(zip.finish()?.into_inner())
}

fn file(action: &'static str, path: &Path, source: std::io::Error) -> Error {
    Error::File {
        action,
        path: path.to_path_buf(),
        source,
    }
}
