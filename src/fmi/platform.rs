//! Platforms whose shared library can go into an FMU, and what an importer calls them.

use super::FmiVersion;

/// A platform of importers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Platform {
    /// Linux on x86-64.
    X64Linux,
    /// Windows on x86-64.
    X64Windows,
}

impl Platform {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::X64Linux, Self::X64Windows];

    /// Its name in FMI 3, which the command line uses too.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::X64Linux => "x86_64-linux",
            Self::X64Windows => "x86_64-windows",
        }
    }

    /// Its folder below `binaries/`.
    #[must_use]
    pub fn folder(self, version: FmiVersion) -> &'static str {
        match (version, self) {
            (FmiVersion::V2, Self::X64Linux) => "linux64",
            (FmiVersion::V2, Self::X64Windows) => "win64",
            (FmiVersion::V3, platform) => platform.name(),
        }
    }

    /// How names of shared libraries end there.
    #[must_use]
    pub fn ending(self) -> &'static str {
        match self {
            Self::X64Linux => "so",
            Self::X64Windows => "dll",
        }
    }

    /// The platform that a shared library is for, by its first bytes.
    #[must_use]
    pub fn of(library: &[u8]) -> Option<Self> {
        // ELF, 64 bits, little-endian, machine 62 (x86-64).
        if library.starts_with(b"\x7fELF\x02\x01") && library.get(18..20) == Some(&[62, 0]) {
            return Some(Self::X64Linux);
        }
        // PE: an MZ stub that says at byte 60 where the header is, machine 0x8664 (x86-64), 0x2000 marks a DLL.
        let place = library
            .get(60..64)
            .filter(|_| library.starts_with(b"MZ"))
            .map(|p| usize::from(p[0]) | usize::from(p[1]) << 8 | usize::from(p[2]) << 16)?;
        let header = library.get(place..place + 24)?;
        let is_dll = header[23] & 0x20 != 0;
        (header.starts_with(b"PE\0\0\x64\x86") && is_dll).then_some(Self::X64Windows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn libraries_are_told_by_their_first_bytes() {
        let mut elf = b"\x7fELF\x02\x01".to_vec();
        elf.resize(64, 0);
        assert_eq!(Platform::of(&elf), None);
        elf[18] = 62;
        assert_eq!(Platform::of(&elf), Some(Platform::X64Linux));
        let mut pe = b"MZ".to_vec();
        pe.resize(128, 0);
        pe[60] = 80;
        pe[80..86].copy_from_slice(b"PE\0\0\x64\x86");
        assert_eq!(Platform::of(&pe), None, "a program");
        pe[80 + 23] = 0x20;
        assert_eq!(Platform::of(&pe), Some(Platform::X64Windows));
        pe.truncate(90);
        assert_eq!(Platform::of(&pe), None, "cut short");
        assert_eq!(Platform::of(b""), None);
    }
}
