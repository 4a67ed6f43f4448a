//! What is legal in a scene and seldom meant, in words for people: `sandgate info` and `sandgate run` tell it.

use crate::scene::Scene;

/// Remarks on a scene, none for most.
pub(super) fn remarks(scene: &Scene) -> Vec<String> {
    let gates = scene.gates.iter();
    gates
        .filter_map(|gate| {
            let part = scene.opening_behind_wall(gate)?;
            let wall = &scene.walls[part.wall].name;
            Some(format!(
                "note: gate {}: {} of its opening, next to `from`, lie behind wall {wall}: openings up to {} uncover nothing\n  \
                 before that wall. Put `from` on the wall's surface, unless it is meant.",
                gate.name,
                length(part.length),
                rounded(part.share, 4),
            ))
        })
        .collect()
}

fn length(metres: f64) -> String {
    format!("{} m", rounded(metres, 6))
}

/// A number with so many decimals at most.
fn rounded(value: f64, decimals: i32) -> f64 {
    let unit = 10f64.powi(decimals);
    (value * unit).round() / unit
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sluice of the small scene, with its end that opens first at this height.
    fn sluice(from: &str) -> Scene {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/scenes/devices.toml");
        let text = std::fs::read_to_string(path).unwrap();
        let (before, after) = text.split_once("[gates.sluice]").unwrap();
        let (_, after) = after.split_once("from = ").unwrap();
        let (_, after) = after.split_once('\n').unwrap();
        let text = format!("{before}[gates.sluice]\nfrom = {from}\n{after}");
        crate::scene::parse("sluice", &text).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn a_gate_that_opens_below_the_bed_is_told_and_one_that_stands_on_it_is_not() {
        assert_eq!(remarks(&sluice("[0.15, 0]")), Vec::<String>::new());
        let told = remarks(&sluice("[0.15, -0.02]"));
        let [note] = &told[..] else {
            panic!("{told:?}");
        };
        for part in [
            "gate sluice: 0.02 m of its opening",
            "behind wall bed",
            "up to 0.3333",
        ] {
            assert!(note.contains(part), "no {part:?} in {note}");
        }
    }
}
