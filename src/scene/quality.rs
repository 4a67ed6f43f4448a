//! What `numerics.quality` stands for: a resolution, which is what the work-precision studies found worth its time
//! (docs/precision.md, "What the quality knob picks").

use super::lift::CIRCLES;
use super::raw::{QualityWord, RawScene};
use crate::boundary::ROWS;
use crate::solver::SHORTEST_PERIOD;

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

/// Puts the spacing of a scene's quality in place of the one it gives, which is that of `standard`: the nearest to it that
/// keeps the scene valid.
pub(super) fn apply(raw: &mut RawScene) {
    let Some(numerics) = raw.numerics.as_ref().map(|n| &n.value) else {
        return;
    };
    let (Some(quality), Some(given)) = (&numerics.quality, &numerics.spacing) else {
        return;
    };
    let resolution = Quality::of_word(quality.value).resolution();
    let ratio = numerics.smoothing_ratio.as_ref();
    let given = given.value.0;
    if resolution == 1.0 || given.is_nan() || given <= 0.0 {
        return;
    }
    let coarsest = coarsest(raw, ratio.map_or(0.0, |r| r.value.0));
    let finest = radii(raw).map(|r| r / CIRCLES.1).fold(0.0, f64::max);
    // What does not fit the spacing that the scene gives is for `lift` to refuse.
    let wanted = (given / resolution)
        .min(coarsest.max(given))
        .max(finest.min(given));
    let spacing = fitting(&periods(raw), given, wanted);
    if let Some(at) = raw.numerics.as_mut().and_then(|n| n.value.spacing.as_mut()) {
        at.value.0 = spacing;
    }
}

/// Lengths of the periodic sides [m].
fn periods(raw: &RawScene) -> Vec<f64> {
    let Some(domain) = raw.domain.as_ref().map(|d| &d.value) else {
        return Vec::new();
    };
    let (Some(lower), Some(upper)) = (&domain.lower, &domain.upper) else {
        return Vec::new();
    };
    let axes = domain.periodic.iter().flat_map(|list| &list.value.0);
    axes.filter_map(|at| {
        let axis = at.value as usize;
        Some(upper.value.values.get(axis)? - lower.value.values.get(axis)?)
    })
    .collect()
}

/// Coarsest spacing at which plates of gates that have a thickness are four spacings deep, the radii of circles as much, and periods
/// as long as neighbour lists need them, as `lift` wants them [m].
fn coarsest(raw: &RawScene, ratio: f64) -> f64 {
    let gates = raw.gates.iter().flat_map(|g| &g.value.0);
    let thickness = gates.filter_map(|g| Some(g.value.as_ref()?.thickness.as_ref()?.value.0));
    let plates = thickness.map(|length| length / ROWS as f64);
    let circles = radii(raw).map(|radius| radius / CIRCLES.0);
    let periods = periods(raw)
        .into_iter()
        .map(|p| p / (SHORTEST_PERIOD * ratio));
    let all = plates.chain(circles).chain(periods);
    all.fold(f64::INFINITY, f64::min)
}

/// Radii of circles, of bodies and of walls [m].
fn radii(raw: &RawScene) -> impl Iterator<Item = f64> {
    let bodies = raw.bodies.iter().flat_map(|b| &b.value.0);
    let bodies = bodies.filter_map(|b| b.value.as_ref()?.circle.as_ref());
    let walls = raw.walls.iter().flat_map(|w| &w.value.0);
    let walls = walls.filter_map(|w| w.value.as_ref()?.circle.as_ref());
    let circles = bodies.chain(walls);
    circles.filter_map(|circle| Some(circle.value.radius.as_ref()?.value.0))
}

/// The spacing nearest to `wanted` that goes into all periods a whole number of times, as the one that is `given` does.
fn fitting(periods: &[f64], given: f64, wanted: f64) -> f64 {
    let counts: Vec<f64> = periods.iter().map(|p| p / given).collect();
    let is_whole = |n: &f64| *n >= 1.0 && (n - n.round()).abs() <= 1e-6 * n;
    if counts.is_empty() || !counts.iter().all(is_whole) {
        return wanted;
    }
    // What goes into all of them: any part of it does.
    let common = counts.iter().fold(0, |a, n| divisor(a, n.round() as u64));
    let length = given * common as f64;
    let parts = length / wanted;
    let nearest = if wanted > given {
        // Not coarser than may be.
        (parts - 1e-6).ceil()
    } else {
        parts.round()
    };
    let is_exact = (nearest - parts).abs() <= 1e-6;
    if is_exact { wanted } else { length / nearest }
}

/// Greatest common divisor.
fn divisor(a: u64, b: u64) -> u64 {
    if b == 0 { a } else { divisor(b, a % b) }
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

    /// A tank with a gate and water, with these keys of the domain and the gate.
    fn tank(quality: &str, domain: &str, gate: &str) -> super::super::Scene {
        let text = format!(
            "name = \"tank\"\n[domain]\nlower = [0, -0.1]\nupper = [0.25, 0.5]\n{domain}\n\
             [numerics]\nspacing = 0.01\nquality = \"{quality}\"\n\
             [materials.water]\nlaw = \"fluid\"\npreset = \"water\"\n\
             [bodies.w]\nmaterial = \"water\"\nbox = {{ lower = [0, 0], upper = [0.1, 0.1] }}\n\
             [walls.floor]\nplane = {{ point = [0, 0], normal = [0, 1] }}\n\
             [gates.g]\nfrom = [0.1, 0]\nto = [0.1, 0.2]\n{gate}\n\
             [run]\nstep = 0.01\nuntil = 0.1\n"
        );
        parse("tank", &text).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn a_gate_that_is_thick_enough_as_given_is_so_at_every_quality() {
        for (thickness, spacing) in [(0.04, 0.01), (0.06, 0.015), (0.08, 0.02), (0.2, 0.02)] {
            let gate = format!("thickness = {thickness}");
            let draft = tank("draft", "", &gate);
            let made = draft.numerics.spacing;
            assert!((made - spacing).abs() < 1e-12, "{thickness}: {made}");
            assert_eq!(draft.gates[0].thickness, thickness);
        }
        assert_eq!(tank("draft", "", "").gates[0].thickness, 0.08);
    }

    #[test]
    fn what_is_too_thin_for_a_draft_is_told_with_the_spacing_that_the_draft_makes() {
        let text = SCENE.replace("[numerics]\n", "[numerics]\nquality = \"draft\"\n");
        let spacing = 2.0 * scene("").numerics.spacing;
        let gate = format!(
            "\n[gates.g]\nfrom = [0.3, 0.05]\nto = [0.3, {}]\n",
            0.05 + 1.5 * spacing
        );
        let error = parse("column", &(text + &gate)).unwrap_err().to_string();
        assert!(
            error.contains(&format!("(quality = \"draft\" makes it {spacing} m)")),
            "{error}"
        );
    }

    #[test]
    fn a_circle_that_fits_as_given_does_so_at_every_quality() {
        let circle = |radius: f64, quality: &str| {
            let text = format!(
                "name = \"drum\"\n[domain]\nlower = [-3, -3]\nupper = [3, 3]\n\
                 [numerics]\nspacing = 0.01\nquality = \"{quality}\"\n\
                 [materials.water]\nlaw = \"fluid\"\npreset = \"water\"\n\
                 [bodies.w]\nmaterial = \"water\"\nbox = {{ lower = [-0.02, -0.02], upper = [0.02, 0.02] }}\n\
                 [walls.drum]\ncircle = {{ centre = [0, 0], radius = {radius} }}\n\
                 [run]\nstep = 0.01\nuntil = 0.1\n"
            );
            let scene = parse("drum", &text).unwrap_or_else(|e| panic!("{e}"));
            scene.numerics.spacing
        };
        for (radius, quality, spacing) in [
            (0.06, "draft", 0.015),
            (0.2, "draft", 0.02),
            (2.4, "fine", 0.008),
            (0.2, "fine", 0.01 / 1.5),
        ] {
            let made = circle(radius, quality);
            assert!((made - spacing).abs() < 1e-12, "{radius} {quality}: {made}");
        }
    }

    #[test]
    fn a_period_holds_a_whole_number_of_spacings_at_every_quality() {
        let count = |quality| 0.25 / tank(quality, "periodic = [\"x\"]", "").numerics.spacing;
        // 25 as given, 12.5 and 37.5 wanted.
        for (quality, expected) in [("draft", 13.0), ("standard", 25.0), ("fine", 38.0)] {
            let count: f64 = count(quality);
            assert!((count - expected).abs() < 1e-9, "{quality}: {count}");
        }
    }

    #[test]
    fn several_periods_share_a_spacing_and_none_is_coarser_than_it_may_be() {
        assert_eq!(fitting(&[0.3, 0.2], 0.01, 0.02), 0.02);
        assert!((fitting(&[0.25, 0.15], 0.01, 0.02) - 0.05 / 3.0).abs() < 1e-12);
        // Nothing goes into both but what is given.
        assert!((fitting(&[0.25, 0.24], 0.01, 0.02) - 0.01).abs() < 1e-12);
        assert!((fitting(&[0.25, 0.24], 0.01, 0.01 / 1.5) - 0.005).abs() < 1e-12);
        // As it was not whole before, it is for the checks of periods to say.
        assert_eq!(fitting(&[0.255], 0.02, 0.04), 0.04);
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
