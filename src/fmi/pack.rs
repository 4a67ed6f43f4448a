//! Library + description + scene → .fmu. The same inputs give the same bytes.

use std::fs;
use std::io::{Cursor, Write};
use std::path::Path;

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipWriter};

use super::slot::{self, SlotError};
use super::{Error, FmiVersion, description, identifier, page::page, terminals};
use crate::component::Component;
use crate::scene::Scene;

const LICENSE_APACHE: &str = include_str!("../../LICENSE-APACHE");
const LICENSE_MIT: &str = include_str!("../../LICENSE-MIT");

/// Writes an FMU of `scene` to `out`, with the scene inside a copy of the shared library at `library`.
///
/// Same inputs, same bytes: time stamps are fixed, entries are deflated, names have forward slashes. The file appears
/// under its name only when it is complete.
///
/// # Errors
/// [`Error`]: the scene cannot be built or is too long, the library is missing or of another kind, a file cannot be
/// read or written.
pub fn pack(scene: &Scene, version: FmiVersion, library: &Path, out: &Path) -> Result<(), Error> {
    let component = Component::new(scene)?;
    let binary = with_scene(library, scene)?;
    let id = identifier(scene);
    let folder = match version {
        FmiVersion::V2 => "linux64",
        FmiVersion::V3 => "x86_64-linux",
    };
    let mut entries = vec![
        (
            "modelDescription.xml".to_owned(),
            description(&component, version).into_bytes(),
        ),
        (format!("binaries/{folder}/{id}.so"), binary),
        (
            "resources/scene.toml".to_owned(),
            scene.source.clone().into_bytes(),
        ),
        (
            "documentation/index.html".to_owned(),
            page(&component).into_bytes(),
        ),
        (
            "documentation/licenses/license.txt".to_owned(),
            licenses().into_bytes(),
        ),
        (
            "documentation/licenses/license.spdx".to_owned(),
            format!("{}\n", env!("CARGO_PKG_LICENSE")).into_bytes(),
        ),
    ];
    let mut add = |name: &str, bytes: &[u8]| entries.push((name.to_owned(), bytes.to_vec()));
    match version {
        FmiVersion::V2 => add("model.png", terminals::ICON_PNG),
        FmiVersion::V3 => {
            let folder = "terminalsAndIcons";
            let document = terminals::terminals(&component);
            add(
                &format!("{folder}/terminalsAndIcons.xml"),
                document.as_bytes(),
            );
            add(&format!("{folder}/icon.png"), terminals::ICON_PNG);
            add(&format!("{folder}/icon.svg"), terminals::ICON_SVG);
        }
    }
    let archive = archive(&entries).map_err(|source| file("write", out, source))?;
    let part = out.with_extension("fmu.part");
    fs::write(&part, archive).map_err(|source| file("write", &part, source))?;
    fs::rename(&part, out).map_err(|source| file("write", out, source))
}

/// The library's bytes with the scene in its slot.
fn with_scene(library: &Path, scene: &Scene) -> Result<Vec<u8>, Error> {
    let wrong = |found: String| Error::WrongLibrary {
        path: library.to_path_buf(),
        found,
    };
    let mut bytes = fs::read(library).map_err(|source| file("read", library, source))?;
    // ELF, 64 bits, little-endian, machine 62 (x86-64): the only platform whose folder names `pack` knows.
    if !bytes.starts_with(b"\x7fELF\x02\x01") || bytes.get(18..20) != Some(&[62, 0]) {
        return Err(wrong(
            "it is no shared library for Linux on x86-64".to_owned(),
        ));
    }
    match slot::fill(&mut bytes, &scene.source) {
        Ok(()) => Ok(bytes),
        Err(SlotError::TooLong(found)) => Err(Error::SceneTooLong {
            found,
            allowed: slot::CAPACITY,
        }),
        Err(error) => Err(wrong(error.to_string())),
    }
}

fn archive(entries: &[(String, Vec<u8>)]) -> std::io::Result<Vec<u8>> {
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

fn licenses() -> String {
    format!(
        "Sandgate {} is licensed under either of the two licences below, at your choice.\n\n\
         ==== MIT ====\n\n{LICENSE_MIT}\n==== Apache-2.0 ====\n\n{LICENSE_APACHE}",
        env!("CARGO_PKG_VERSION")
    )
}

fn file(action: &'static str, path: &Path, source: std::io::Error) -> Error {
    Error::File {
        action,
        path: path.to_path_buf(),
        source,
    }
}
