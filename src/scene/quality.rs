//! What `numerics.quality` stands for: a resolution, which is what the work-precision studies found worth its time
//! (docs/precision.md, "What the quality knob picks").

use super::raw::{QualityWord, RawScene};

/// A choice of resolution.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quality {
    /// For a first look.
    Draft,
    /// The scene's own spacing, defaults.
    Standard,
    /// For numbers that count.
    Fine,
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

    /// Particles per length over those of the scene's spacing [1]. Steps and tolerances stay: the defaults' lie on the front
    /// of most studies, a looser solve makes slow slopes run away, and shorter steps cost more than they give.
    #[must_use]
    pub fn resolution(self) -> f64 {
        match self {
            Quality::Draft => 0.5,
            Quality::Standard => 1.0,
            Quality::Fine => 1.5,
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

/// Puts the spacing of a scene's quality in place of the one it gives, which is that of `standard`.
pub(super) fn apply(raw: &mut RawScene) {
    let Some(numerics) = raw.numerics.as_mut().map(|n| &mut n.value) else {
        return;
    };
    let Some(quality) = numerics.quality.as_ref() else {
        return;
    };
    let resolution = Quality::of_word(quality.value).resolution();
    if let Some(spacing) = numerics.spacing.as_mut()
        && resolution != 1.0
    {
        spacing.value.0 /= resolution;
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
    fn a_quality_is_a_resolution() {
        let standard = scene("");
        assert_eq!(scene("quality = \"standard\"").numerics, standard.numerics);
        let draft = scene("quality = \"draft\"");
        assert_eq!(draft.quality, Quality::Draft);
        assert_eq!(draft.numerics.spacing, 2.0 * standard.numerics.spacing);
        assert_eq!(draft.numerics.courant, standard.numerics.courant);
        let fine = scene("quality = \"fine\"");
        assert_eq!(fine.numerics.spacing, standard.numerics.spacing / 1.5);
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
