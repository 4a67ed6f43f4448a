//! FMUs for other machines: several binaries in one archive, and libraries that cargo-zigbuild builds, where it is.

use std::collections::BTreeSet;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

use sandgate::fmi::library::{BUILT_FROM, Kind};
use sandgate::fmi::{self, Extent, FmiVersion, Packing, Platform, cross, slot};
use sandgate::scene;

use crate::python::{program, root, run, target};
use crate::shared_library::{declared, library, scratch};

/// Names of the entries of an archive.
fn entries(archive: &Path) -> Vec<String> {
    let list = "import sys, zipfile; print(*zipfile.ZipFile(sys.argv[1]).namelist(), sep='\\n')";
    let output = run(
        "zipfile",
        Command::new(program("python"))
            .args(["-c", list])
            .arg(archive),
        "it is Python's own",
    );
    let text = String::from_utf8_lossy(&output.stdout);
    text.lines().map(str::to_owned).collect()
}

/// As much of a Windows library as packing looks at: its header, a scene slot, and what it was built from.
fn imitation(folder: &Path) -> PathBuf {
    let mut bytes = b"MZ".to_vec();
    bytes.resize(128, 0);
    bytes[60] = 64;
    bytes[64..70].copy_from_slice(b"PE\0\0\x64\x86");
    bytes[64 + 23] = 0x20;
    bytes.extend(slot::empty());
    bytes.extend(BUILT_FROM.as_bytes());
    let path = folder.join("imitation.dll");
    fs::write(&path, bytes).expect("the scratch folder is writable");
    path
}

fn packing(version: FmiVersion, libraries: &[&Path]) -> Packing {
    Packing {
        version,
        libraries: libraries.iter().map(|path| path.to_path_buf()).collect(),
        reference: Extent::Until(0.0),
        kind: Kind::Plain,
    }
}

#[test]
fn one_fmu_may_hold_binaries_of_several_platforms() {
    let folder = scratch("platforms");
    let scene = scene::load(&root().join("tests/scenes/small_silo.toml")).expect("it is a scene");
    let dll = imitation(&folder);
    let out = folder.join("both.fmu");
    for (version, names) in [
        (
            FmiVersion::V2,
            ["linux64/small_silo.so", "win64/small_silo.dll"],
        ),
        (
            FmiVersion::V3,
            [
                "x86_64-linux/small_silo.so",
                "x86_64-windows/small_silo.dll",
            ],
        ),
    ] {
        fmi::pack_with(&scene, &packing(version, &[library(), &dll]), &out).expect("packed");
        let found = entries(&out);
        for name in names {
            assert!(found.contains(&format!("binaries/{name}")), "{found:?}");
        }
        let twice = packing(version, &[library(), library()]);
        let refusal = fmi::pack_with(&scene, &twice, &out).expect_err("refused");
        let refusal = refusal.to_string();
        assert!(
            refusal.contains("a second library for x86_64-linux"),
            "{refusal}"
        );
    }
    let none = fmi::pack_with(&scene, &packing(FmiVersion::V3, &[]), &out).expect_err("refused");
    assert!(none.to_string().contains("at least one"), "{none}");
}

#[test]
fn without_the_tool_the_program_says_what_to_install() {
    let folder = scratch("no_zig");
    let sandgate = |options: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_sandgate"))
            .arg("fmu")
            .arg(root().join("tests/scenes/small_silo.toml"))
            .args(options)
            .arg("-o")
            .arg(folder.join("out.fmu"))
            .env("PATH", &folder)
            .output()
            .expect("the program starts");
        assert!(!output.status.success());
        String::from_utf8_lossy(&output.stderr).into_owned()
    };
    for options in [&["--portable"][..], &["--platform", "x86_64-windows"]] {
        let said = sandgate(options);
        assert!(said.contains("needs cargo-zigbuild"), "{said}");
        assert!(said.contains(cross::SET_UP), "{said}");
    }
    let said = sandgate(&["--platform", "x86_64-linux,vax"]);
    assert!(
        said.contains("found vax, allowed x86_64-linux, x86_64-windows"),
        "{said}"
    );
    assert!(!folder.join("out.fmu").exists());
}

/// A library for a platform by cargo-zigbuild, or `None` (said on the terminal) where the tools are not installed.
fn cross_built(platform: Platform, triple: &str) -> Option<PathBuf> {
    let sysroot = run(
        "rustc --print sysroot",
        Command::new("rustc").args(["--print", "sysroot"]),
        "cargo has brought it",
    );
    let sysroot = String::from_utf8_lossy(&sysroot.stdout).trim().to_owned();
    let has_std = Path::new(&sysroot)
        .join("lib/rustlib")
        .join(triple)
        .is_dir();
    let has_tool = Command::new("cargo-zigbuild")
        .arg("--version")
        .output()
        .is_ok();
    if has_std && has_tool {
        let built = cross::build(root(), &target(), platform);
        return Some(built.unwrap_or_else(|why| panic!("{why}")));
    }
    // Straight to the terminal: what a passed test prints is not shown.
    let _ = writeln!(
        std::io::stderr(),
        "\nNOT RUN: exports of the library for {} ({} and `rustup target add {triple}` are needed)\n",
        platform.name(),
        cross::SET_UP
    );
    None
}

#[test]
fn a_portable_library_needs_glibc_2_17_at_most_and_exports_the_same_names() {
    let Some(library) = cross_built(Platform::X64Linux, "x86_64-unknown-linux-gnu") else {
        return;
    };
    let symbols = |options: &[&str]| {
        let output = run(
            "nm",
            Command::new("nm").arg("-D").args(options).arg(&library),
            "these tests need `nm` (Debian: binutils)",
        );
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let exported: BTreeSet<String> = symbols(&["--defined-only"])
        .lines()
        .filter_map(|line| line.split_whitespace().last().map(str::to_owned))
        .collect();
    assert_eq!(exported, declared());
    let undefined = symbols(&["--undefined-only"]);
    let versions = undefined.split("@GLIBC_2.").skip(1);
    let versions = versions.filter_map(|rest| {
        let digits = rest.chars().take_while(char::is_ascii_digit);
        digits.collect::<String>().parse::<u32>().ok()
    });
    let newest = versions.max().expect("it uses the C library");
    assert!(newest <= 17, "needs GLIBC_2.{newest}");
}

#[test]
fn the_library_for_windows_exports_the_same_names() {
    let Some(library) = cross_built(Platform::X64Windows, "x86_64-pc-windows-gnu") else {
        return;
    };
    let bytes = fs::read(&library).expect("it was just built");
    assert_eq!(Platform::of(&bytes), Some(Platform::X64Windows));
    let output = run(
        "objdump -p",
        Command::new("objdump").arg("-p").arg(&library),
        "these tests need `objdump` with PE files (Debian: binutils)",
    );
    let text = String::from_utf8_lossy(&output.stdout);
    let (_, table) = text
        .split_once("[Ordinal/Name Pointer] Table")
        .expect("it exports");
    let exported: BTreeSet<String> = table
        .lines()
        .skip(1)
        .skip_while(|line| !line.contains('['))
        .take_while(|line| line.contains('['))
        .filter_map(|line| line.split_whitespace().last().map(str::to_owned))
        .collect();
    assert_eq!(exported, declared());
    // It can be packed: its scene slot is there, once.
    let folder = scratch("windows");
    let scene = scene::load(&root().join("tests/scenes/small_silo.toml")).expect("it is a scene");
    let out = folder.join("windows.fmu");
    fmi::pack_with(&scene, &packing(FmiVersion::V3, &[&library]), &out).expect("packed");
    let size = fs::metadata(&out).expect("it was just packed").len();
    assert!(size < 4_000_000, "{size} bytes");
}
