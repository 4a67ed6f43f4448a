//! One case: a scene and how it is driven, as one small TOML file: that of the scene with a section `[stress]`.

use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use crate::component::Component;
use crate::scene::{self, Scene, SceneErrors};

/// What a case should come to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Expect {
    /// It runs to its end.
    #[default]
    Run,
    /// The scene is refused, with a message that says why.
    Refusal,
}

/// How a case is driven: the section `[stress]`. What inputs are told stands in the scene's `[[schedule]]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Drive {
    /// Kind of scene.
    pub kind: String,
    /// Seed it was made from.
    pub seed: u64,
    /// What it is there for.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
    /// What it should come to.
    #[serde(default)]
    pub expect: Expect,
    /// Communication steps [s], over and over until there were `count`.
    pub steps: Vec<f64>,
    /// Number of communication steps.
    pub count: usize,
    /// Internal steps after which the run is cut, also in the middle of a communication step.
    pub most_steps: u64,
    /// After so many communication steps it is saved, restored in a new component and run again from there.
    pub restore_after: usize,
    /// Threads of the run from the restored state.
    pub threads: usize,
    /// Whether the material must be at rest over the last half.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rest: bool,
    /// Whether it is a block that nothing touches: it must fall as one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub falls: bool,
    /// In the plane: a convex outline that no particle may leave, anticlockwise [m].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub inside: Vec<[f64; 2]>,
    /// Another run that must end alike.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub twin: Option<Twin>,
}

/// A run of the same scene with some values changed, and how closely both must end alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Twin {
    /// Keys of the scene (`section.key` or `section.NAME.key`) and their other values.
    #[serde(default)]
    pub changes: Table,
    /// Other communication steps, if any [s].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub steps: Vec<f64>,
    /// By how much its velocities differ [m/s].
    #[serde(default)]
    pub boost: [f64; 2],
    /// How far the centres of mass may be apart [m].
    pub within: f64,
    /// How far the mean velocities may be apart [m/s].
    pub speed_within: f64,
}

/// A scene and how it is driven.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The scene file without `[stress]`.
    pub scene: Table,
    /// The section `[stress]`.
    pub drive: Drive,
}

impl Case {
    /// Reads a case file.
    ///
    /// # Errors
    /// What is wrong with it: not TOML, or no fitting `[stress]`. The scene itself is checked by [`Case::scene`].
    pub fn read(text: &str) -> Result<Self, String> {
        let mut scene: Table = text.parse().map_err(|e| format!("{e}"))?;
        let Some(drive) = scene.remove("stress") else {
            return Err(
                "no section [stress]: cases of `sandgate stress` have one beside the scene; a scene alone is for \
                 `sandgate run`"
                    .to_owned(),
            );
        };
        let drive: Drive = drive
            .try_into()
            .map_err(|e| format!("section [stress]: {e}"))?;
        let bad = |what: &str| Err(format!("section [stress]: {what}"));
        let is_time = |h: &f64| *h > 0.0 && h.is_finite();
        if drive.steps.is_empty() || !drive.steps.iter().all(is_time) {
            return bad("steps: allowed is a list of times above 0 s, at least one");
        }
        if drive
            .twin
            .as_ref()
            .is_some_and(|t| !t.steps.iter().all(is_time))
        {
            return bad("twin.steps: allowed is a list of times above 0 s");
        }
        if drive.count == 0 || drive.most_steps == 0 {
            return bad("count, most_steps: allowed is at least 1, or nothing is checked");
        }
        if drive.restore_after >= drive.count {
            return bad(&format!(
                "restore_after: found {}, allowed is less than count, {}, or nothing is run again",
                drive.restore_after, drive.count
            ));
        }
        let most = usize::from(Component::MOST_THREADS);
        if !(1..=most).contains(&drive.threads) {
            return bad(&format!("threads: allowed is 1 to {most}"));
        }
        Ok(Self { scene, drive })
    }

    /// The case file's text; `head` are comment lines before it, without their `#`.
    #[must_use]
    pub fn text(&self, head: &[String]) -> String {
        let mut table = self.scene.clone();
        // A drive is numbers, flags and text: it always encodes.
        if let Ok(drive) = Value::try_from(&self.drive) {
            table.insert("stress".to_owned(), drive);
        }
        let mut text: String = head.iter().map(|line| format!("# {line}\n")).collect();
        text.push_str(&toml::to_string(&table).unwrap_or_default());
        text
    }

    /// The scene's own text.
    #[must_use]
    pub fn scene_text(&self) -> String {
        toml::to_string(&self.scene).unwrap_or_default()
    }

    /// The scene.
    ///
    /// # Errors
    /// Every problem of the scene.
    pub fn scene(&self) -> Result<Scene, SceneErrors> {
        scene::parse(&self.drive.kind, &self.scene_text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_case_is_read_back_as_it_was_written() {
        let case = crate::stress::generate::of_kind("silo", 3).unwrap();
        let text = case.text(&["about".to_owned()]);
        assert!(text.starts_with("# about\n"));
        assert_eq!(Case::read(&text), Ok(case));
    }

    #[test]
    fn what_is_no_case_is_refused_with_the_reason() {
        let plain = Case::read("name = \"x\"\n").unwrap_err();
        assert!(plain.contains("[stress]"), "{plain}");
        let text = crate::stress::generate::of_kind("silo", 3)
            .unwrap()
            .text(&[]);
        let unknown = Case::read(&text.replace("most_steps", "many_steps")).unwrap_err();
        assert!(unknown.contains("many_steps"), "{unknown}");
        let none = Case::read(&text.replace("threads = 2", "threads = 0")).unwrap_err();
        assert!(none.contains("threads"), "{none}");
        // What would pass without anything checked.
        let drive = Case::read(&text).unwrap().drive;
        let count = format!("count = {}", drive.count);
        let restore = format!("restore_after = {}", drive.restore_after);
        let late = format!("restore_after = {}", drive.count);
        for (old, new, named) in [
            (&count, "count = 0", "count"),
            (&restore, late.as_str(), "restore_after"),
        ] {
            let why = Case::read(&text.replacen(old, new, 1)).unwrap_err();
            assert!(why.contains(named), "{why}");
        }
        assert!(Case::read("[stress").is_err());
    }
}
