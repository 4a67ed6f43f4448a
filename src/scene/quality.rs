//! What `numerics.quality` stands for: resolution and tolerances taken together, as the work-precision studies found them
//! (docs/precision.md, "What the quality knob picks").

use super::raw::{QualityWord, Ratio, RawScene};

/// A choice of resolution and tolerances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// For a first look.
    Draft,
    /// The scene's own spacing, defaults.
    Standard,
    /// For numbers that count.
    Fine,
}

/// What a quality sets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Picked {
    /// Particles per length over those of the scene's spacing [1].
    pub resolution: f64,
    /// Courant number, if the scene does not give one [1]; `None`: the default.
    pub courant: Option<f64>,
    /// Relative tolerance of the viscous solve, if the scene does not give one [1]; `None`: the default.
    pub solver_tolerance: Option<f64>,
}

impl Quality {
    /// All, from the cheapest.
    pub const ALL: [Self; 3] = [Self::Draft, Self::Standard, Self::Fine];

    /// Its word in scenes.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Quality::Draft => "draft",
            Quality::Standard => "standard",
            Quality::Fine => "fine",
        }
    }

    /// What it sets. A longer step lies on the front of most studies and costs little accuracy; a shorter one costs more than
    /// it gives, so `fine` spends all on resolution. A looser solve is as cheap but makes slow slopes run away.
    #[must_use]
    pub fn picked(self) -> Picked {
        let (resolution, courant, solver_tolerance) = match self {
            Quality::Draft => (0.5, Some(0.7), None),
            Quality::Standard => (1.0, None, None),
            Quality::Fine => (1.5, None, None),
        };
        Picked {
            resolution,
            courant,
            solver_tolerance,
        }
    }

    /// The one whose number a parameter is nearest to: 0 draft, 1 standard, 2 fine.
    #[must_use]
    pub fn of_number(number: f64) -> Self {
        if number < 0.5 {
            Quality::Draft
        } else if number < 1.5 {
            Quality::Standard
        } else {
            Quality::Fine
        }
    }

    /// Its number as a parameter.
    #[must_use]
    pub fn number(self) -> f64 {
        f64::from(self as u8)
    }

    pub(super) fn of_word(word: QualityWord) -> Self {
        match word {
            QualityWord::Draft => Quality::Draft,
            QualityWord::Standard => Quality::Standard,
            QualityWord::Fine => Quality::Fine,
        }
    }

    pub(super) fn word(self) -> QualityWord {
        match self {
            Quality::Draft => QualityWord::Draft,
            Quality::Standard => QualityWord::Standard,
            Quality::Fine => QualityWord::Fine,
        }
    }
}

/// Puts what a scene's quality sets in place of what it leaves open; its spacing is that of `standard`.
pub(super) fn apply(raw: &mut RawScene) {
    let Some(numerics) = raw.numerics.as_mut().map(|n| &mut n.value) else {
        return;
    };
    let Some(quality) = numerics.quality.as_ref() else {
        return;
    };
    let picked = Quality::of_word(quality.value).picked();
    if let Some(spacing) = numerics.spacing.as_mut()
        && picked.resolution != 1.0
    {
        spacing.value.0 /= picked.resolution;
    }
    let given = &numerics.given;
    for (key, value, field) in [
        ("courant", picked.courant, &mut numerics.courant),
        (
            "solver_tolerance",
            picked.solver_tolerance,
            &mut numerics.solver_tolerance,
        ),
    ] {
        if let (Some(value), Some(field), false) = (value, field.as_mut(), given.contains(&key)) {
            field.value = Ratio(value);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;

    const SCENE: &str = include_str!("../../cases/column_collapse.toml");

    fn scene(more: &str) -> super::super::Scene {
        let text = SCENE.replace("[numerics]\n", &format!("[numerics]\n{more}\n"));
        parse("column", &text).unwrap()
    }

    #[test]
    fn a_quality_sets_what_a_scene_leaves_open() {
        let standard = scene("");
        assert_eq!(scene("quality = \"standard\"").numerics, standard.numerics);
        let draft = scene("quality = \"draft\"");
        assert_eq!(draft.quality, Quality::Draft);
        assert_eq!(draft.numerics.spacing, 2.0 * standard.numerics.spacing);
        assert_eq!(draft.numerics.courant, 0.7);
        let own = scene("quality = \"draft\"\ncourant = 0.3");
        assert_eq!(own.numerics.courant, 0.3);
        assert_eq!(
            own.numerics.solver_tolerance,
            standard.numerics.solver_tolerance
        );
        let fine = scene("quality = \"fine\"");
        assert_eq!(fine.numerics.spacing, standard.numerics.spacing / 1.5);
        assert_eq!(fine.numerics.courant, standard.numerics.courant);
    }

    #[test]
    fn a_parameter_is_the_key() {
        let standard = scene("");
        let at = standard.adjustables.iter();
        let mut values: Vec<f64> = at.map(|a| a.start).collect();
        let place = standard.adjustables.iter();
        let place = place.clone().position(|a| a.name == "solver.quality");
        values[place.unwrap()] = 0.0;
        let draft = standard.adjusted(&values).unwrap();
        assert_eq!(draft.numerics, scene("quality = \"draft\"").numerics);
        assert_eq!(draft.quality, Quality::Draft);
    }

    #[test]
    fn a_wrong_word_is_refused_with_those_that_are_allowed() {
        let text = SCENE.replace("[numerics]\n", "[numerics]\nquality = \"best\"\n");
        let error = parse("column", &text).unwrap_err().to_string();
        assert!(error.contains("best") && error.contains("draft"), "{error}");
    }
}
