//! Looks for a smaller case that fails in the same way: sections and keys dropped, times and bodies halved, as long as it
//! still fails.

use std::sync::atomic::{AtomicBool, Ordering};

use toml::{Table, Value};

use super::checks::Check;
use super::run::{Bounds, Outcome, run};
use super::{Case, Expect};

/// What a failure is recognised by: the check, and for failed steps the words of the message without its numbers.
fn signature(outcome: &Outcome) -> Option<(Check, String)> {
    let failure = outcome.failure()?;
    let words = failure.what.split_whitespace();
    let plain = words.filter(|word| {
        word.chars()
            .all(|c| c.is_alphabetic() || "-_,;".contains(c))
    });
    let text = match failure.check {
        Check::Step | Check::Expectation | Check::Panic => plain.take(6).collect::<Vec<_>>(),
        _ => Vec::new(),
    };
    Some((failure.check, text.join(" ")))
}

/// Sections whose entries may be dropped.
const SECTIONS: [&str; 6] = ["bodies", "gates", "inflows", "outflows", "gauges", "walls"];

/// Keys that a scene cannot do without.
const NEEDED: [&str; 9] = [
    "spacing",
    "expected_speed",
    "law",
    "preset",
    "friction_angle",
    "density",
    "material",
    "upper",
    "lower",
];

/// Smaller cases than this one, the boldest first.
fn smaller(case: &Case, keep_walls: bool) -> Vec<Case> {
    let mut found = shorter(case);
    found.extend(fewer_entries(case, keep_walls));
    if case.scene.contains_key("schedule") {
        found.push(changed(case, |c| {
            c.scene.remove("schedule");
        }));
    }
    for section in ["numerics", "materials"] {
        for path in keys(case.scene.get(section), section) {
            found.push(changed(case, |c| drop_key(&mut c.scene, &path)));
        }
    }
    found.extend([1.5, 1.15].map(|factor| coarser(case, factor)));
    found
}

fn changed(case: &Case, change: impl FnOnce(&mut Case)) -> Case {
    let mut other = case.clone();
    change(&mut other);
    other
}

/// With a shorter drive.
fn shorter(case: &Case) -> Vec<Case> {
    let mut found = Vec::new();
    let drive = &case.drive;
    if drive.count > 1 {
        for count in [drive.count / 2, drive.count - 1] {
            found.push(changed(case, |c| {
                c.drive.count = count;
                c.drive.restore_after = c.drive.restore_after.min(count - 1);
            }));
        }
    }
    if drive.most_steps > 1 {
        found.push(changed(case, |c| c.drive.most_steps /= 2));
    }
    if drive.steps.len() > 1 {
        found.extend((0..drive.steps.len()).map(|i| {
            changed(case, |c| {
                c.drive.steps.remove(i);
            })
        }));
    }
    if drive.restore_after > 0 {
        found.push(changed(case, |c| c.drive.restore_after /= 2));
    }
    if drive.twin.is_some() {
        found.push(changed(case, |c| c.drive.twin = None));
    }
    found
}

/// Each without a body, a device, a gauge or a wall.
fn fewer_entries(case: &Case, keep_walls: bool) -> Vec<Case> {
    let mut found = Vec::new();
    for section in SECTIONS {
        if keep_walls && section == "walls" {
            continue;
        }
        let names = case.scene.get(section).and_then(Value::as_table);
        for name in names.into_iter().flat_map(Table::keys) {
            found.push(changed(case, |c| {
                if let Some(Value::Table(entries)) = c.scene.get_mut(section) {
                    entries.remove(name);
                }
                // What refers to it goes with it.
                forget(
                    &mut c.scene,
                    &format!("{}.{name}", section.trim_end_matches('s')),
                );
            }));
        }
    }
    found
}

/// With fewer particles.
fn coarser(case: &Case, factor: f64) -> Case {
    changed(case, |c| {
        let numerics = c.scene.get_mut("numerics").and_then(Value::as_table_mut);
        if let Some(Value::Float(spacing)) = numerics.and_then(|n| n.get_mut("spacing")) {
            *spacing *= factor;
        }
    })
}

/// Takes out gauges and schedules that refer to a device.
fn forget(scene: &mut Table, device: &str) {
    if let Some(Value::Table(gauges)) = scene.get_mut("gauges") {
        gauges.retain(|_, gauge| gauge.get("on").and_then(Value::as_str) != Some(device));
    }
    if let Some(Value::Array(schedules)) = scene.get_mut("schedule") {
        let dotted = format!("{device}.");
        schedules.retain(|s| {
            let input = s.get("input").and_then(Value::as_str);
            !input.is_some_and(|input| input.starts_with(&dotted))
        });
        if schedules.is_empty() {
            scene.remove("schedule");
        }
    }
}

/// Paths of all keys below a value that a scene can do without.
fn keys(value: Option<&Value>, path: &str) -> Vec<String> {
    let mut found = Vec::new();
    for (key, inner) in value.and_then(Value::as_table).into_iter().flatten() {
        let path = format!("{path}.{key}");
        if inner.is_table() {
            found.extend(keys(Some(inner), &path));
        } else if !NEEDED.contains(&key.as_str()) {
            found.push(path);
        }
    }
    found
}

fn drop_key(scene: &mut Table, path: &str) {
    let mut parts: Vec<&str> = path.split('.').collect();
    let Some(last) = parts.pop() else { return };
    let mut table = Some(scene);
    for part in parts {
        table = table.and_then(|t| t.get_mut(part)?.as_table_mut());
    }
    if let Some(table) = table {
        table.remove(last);
    }
}

/// The smallest case found that fails as this one does, in at most so many runs, or until `stop` becomes true. The case itself
/// if it does not fail.
#[must_use]
pub fn shrink(case: &Case, bounds: &Bounds, most_runs: usize, stop: &AtomicBool) -> Case {
    let Some(wanted) = signature(&run(case, bounds)) else {
        return case.clone();
    };
    // A wall less would let grains out for another reason.
    let lets_out = matches!(wanted.0, Check::Leak | Check::Speed | Check::Energy);
    let keep_walls =
        lets_out || wanted.1.contains("left the domain") || case.drive.expect == Expect::Refusal;
    let (mut best, mut runs) = (case.clone(), 0);
    'again: loop {
        for candidate in smaller(&best, keep_walls) {
            if runs >= most_runs || stop.load(Ordering::SeqCst) {
                break 'again;
            }
            // What the reader refuses is no smaller case, unless that was the point.
            if best.drive.expect == Expect::Run && candidate.scene().is_err() {
                continue;
            }
            runs += 1;
            if signature(&run(&candidate, bounds)).as_ref() == Some(&wanted) {
                best = candidate;
                continue 'again;
            }
        }
        break;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::generate;

    /// A case with a planted defect: a note that no scene can fulfil, here an outline that the heap is outside of.
    #[test]
    fn a_planted_failure_gets_smaller_and_stays_the_same() {
        let mut case = generate::of_kind("drop", 4).unwrap();
        case.drive.inside = vec![[0.0, 0.0], [1e-3, 0.0], [1e-3, 1e-3]];
        let bounds = Bounds::default();
        let before = run(&case, &bounds);
        assert_eq!(before.failure().unwrap().check, Check::Leak);
        let small = shrink(&case, &bounds, 60, &AtomicBool::new(false));
        let after = run(&small, &bounds);
        assert_eq!(after.failure().unwrap().check, Check::Leak);
        assert!(small.drive.count <= 2, "{}", small.text(&[]));
        assert!(small.text(&[]).len() < case.text(&[]).len());
        let bodies = small.scene["bodies"].as_table().unwrap();
        assert_eq!(bodies.len(), 1);
        assert_eq!(shrink(&case, &bounds, 60, &AtomicBool::new(true)), case);
    }

    #[test]
    fn what_does_not_fail_is_left_alone() {
        let case = generate::of_kind("illegal", 1).unwrap();
        let small = shrink(&case, &Bounds::default(), 10, &AtomicBool::new(false));
        assert_eq!(small, case);
    }
}
