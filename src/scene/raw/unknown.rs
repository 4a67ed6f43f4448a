//! Names that are not known: keys that a table does not have are refused, with what was probably meant.

use super::problems::Problems;
use super::read::Node;
use crate::units::quote;

/// Refuses keys that a table does not have, with the nearest one that it has.
pub(super) fn refuse_unknown<'k>(
    entries: &[(&str, Node)],
    known: impl Iterator<Item = &'k str> + Clone,
    problems: &mut Problems,
) {
    for (name, node) in entries {
        if !known.clone().any(|k| k == *name) {
            let keys: Vec<_> = known.clone().collect();
            let near = meant(name, &keys).or_else(|| nearest(name, known.clone()));
            let remedy = match near {
                Some(near) => format!("did you mean {near}? otherwise delete it"),
                None if *name == STRESS => {
                    "delete it, or give the file to `sandgate stress`".to_owned()
                }
                None => "delete it".to_owned(),
            };
            let found = format!("unknown key {}", quote(name));
            problems.report(node.place(), found, keys.join(", "), remedy);
        }
    }
}

/// Table of the cases that `sandgate stress` keeps: how they are driven.
const STRESS: &str = "stress";

/// What others call a key by a name that is not like ours: theirs, ours.
const OTHER_NAMES: [(&str, &str); 1] = [("viscosity", "consistency")];

/// The key that goes by this name elsewhere, if the table has it.
fn meant<'k>(name: &str, keys: &[&'k str]) -> Option<&'k str> {
    let (_, ours) = OTHER_NAMES.iter().find(|(theirs, _)| *theirs == name)?;
    keys.iter().find(|key| *key == ours).copied()
}

/// The nearest of `known` names, if it is near enough to be meant.
pub(in crate::scene) fn nearest<'k>(
    name: &str,
    known: impl Iterator<Item = &'k str>,
) -> Option<&'k str> {
    let name: String = name.chars().take(64).collect();
    known
        .map(|k| (edits(&name, k), k))
        .filter(|(d, k)| *d <= 1 + k.len() / 3)
        .min_by_key(|(d, _)| *d)
        .map(|(_, k)| k)
}

/// Levenshtein distance.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let replace = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = replace.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[b.len()]
}
