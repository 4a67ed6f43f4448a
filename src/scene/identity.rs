//! What makes two scenes the same one: that a saved state of one is a state of the other.

use sha2::{Digest, Sha256};
use toml::de::{DeTable, DeValue};

use super::Scene;

/// Tables and keys at the top of a scene file that no state depends on: what it is called, how far and how finely it is run, what
/// inputs follow, what is logged.
const NO_PART: [&str; 4] = ["title", "run", "schedule", "log"];

impl Scene {
    /// SHA-256 of all that a saved state depends on: keys and values of the scene's text in their order, but for `title`, `[run]`,
    /// `[[schedule]]` and `[log]`. Comments, blanks and line ends are no part of it; a number in another unit is another value.
    #[must_use]
    pub fn identity(&self) -> [u8; 32] {
        let mut sum = Sha256::new();
        match DeTable::parse(&self.source) {
            Ok(document) => add_table(&mut sum, document.get_ref(), &NO_PART),
            // Text that was read as a scene is TOML.
            Err(_) => sum.update(&self.source),
        }
        sum.finalize().into()
    }
}

/// In the order of the text: bodies and materials are numbered by it.
fn add_table(sum: &mut Sha256, table: &DeTable<'_>, left_out: &[&str]) {
    let mut entries: Vec<_> = table.iter().collect();
    entries.retain(|(key, _)| !left_out.contains(&key.get_ref().as_ref()));
    entries.sort_by_key(|(key, _)| key.span().start);
    begin(sum, b't', entries.len());
    for (key, value) in entries {
        add_text(sum, b'k', key.get_ref());
        add_value(sum, value.get_ref());
    }
}

fn add_value(sum: &mut Sha256, value: &DeValue<'_>) {
    match value {
        DeValue::String(text) => add_text(sum, b's', text),
        DeValue::Integer(number) => {
            begin(sum, b'i', number.radix() as usize);
            add_text(sum, b'n', number.as_str());
        }
        DeValue::Float(number) => add_text(sum, b'n', number.as_str()),
        DeValue::Boolean(is) => begin(sum, b'b', usize::from(*is)),
        DeValue::Datetime(time) => add_text(sum, b'd', &time.to_string()),
        DeValue::Array(values) => {
            begin(sum, b'a', values.len());
            values.iter().for_each(|v| add_value(sum, v.get_ref()));
        }
        DeValue::Table(table) => add_table(sum, table, &[]),
    }
}

fn add_text(sum: &mut Sha256, kind: u8, text: &str) {
    begin(sum, kind, text.len());
    sum.update(text);
}

/// Kind and size of what follows, so that no two values look alike.
fn begin(sum: &mut Sha256, kind: u8, size: usize) {
    sum.update([kind]);
    sum.update((size as u64).to_le_bytes());
}

#[cfg(test)]
mod tests {
    use crate::scene;

    const SILO: &str = include_str!("../../tests/scenes/small_silo.toml");

    fn identity(text: &str) -> [u8; 32] {
        let scene = scene::parse("silo.toml", text).unwrap_or_else(|why| panic!("{why}"));
        scene.identity()
    }

    /// A scene with one piece of its text replaced, which must be there.
    fn with(from: &str, to: &str) -> String {
        assert!(SILO.contains(from), "{from}");
        SILO.replacen(from, to, 1)
    }

    #[test]
    fn what_no_state_depends_on_may_change() {
        let changed = [
            SILO.replace('\n', "\r\n"),
            with("dimension = 2", "dimension   =   2   # a plane"),
            with("Small gated silo for tests", "Another title"),
            with("0.2 s", "9 s"),
            with("[\"60 ms\", 1]", "[\"60 ms\", 0.8]"),
            with("particles_every = \"50 ms\"", "required = true"),
        ];
        for text in changed {
            assert_eq!(identity(&text), identity(SILO), "{text}");
        }
    }

    #[test]
    fn what_a_state_depends_on_tells_scenes_apart() {
        let left = "[walls.left]\npolyline = [[0, \"14 cm\"], [0, 0], [\"2.4 cm\", 0]]\n\n";
        let gauge = "[gauges.toe]\nkind = \"front\"\norigin = [0, 0]\ndirection = [1, 0]\n\n[run]";
        let changed = [
            with("\"4 mm\"", "\"3.9 mm\""),
            with("glass_beads", "sand_08"),
            with("[walls.left]", "[walls.west]"),
            with("[run]", gauge),
            // The same tables in another order.
            with(left, "").replacen("[gates.main]", &format!("{left}[gates.main]"), 1),
        ];
        for text in changed {
            assert_ne!(identity(&text), identity(SILO), "{text}");
        }
    }
}
