//! What a result still depends on: what the scheme is free to choose, changed one at a time. A residual is the model's where these
//! together change it by less than [`crate::validate::report::MODEL`].

use crate::validate::report::{Table, number};
use crate::validate::template::Template;

/// What is chosen to compute a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Choice {
    Spacing,
    Seed,
    SoundSpeed,
    Yield,
}

impl Choice {
    pub(super) const ALL: [Self; 4] = [Self::Spacing, Self::Seed, Self::SoundSpeed, Self::Yield];

    /// Part of a member's name.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Spacing => "spacing",
            Self::Seed => "seed",
            Self::SoundSpeed => "sound_speed",
            Self::Yield => "yield",
        }
    }

    /// How it is changed, in words.
    pub(super) fn what(self) -> &'static str {
        match self {
            Self::Spacing => "spacing two thirds",
            Self::Seed => "another start",
            Self::SoundSpeed => "sound speed 1.5 times",
            Self::Yield => "three yield iterations a step",
        }
    }

    /// How much finer the changed scene is.
    pub(super) fn refinement(self) -> f64 {
        if self == Self::Spacing { 1.5 } else { 1.0 }
    }

    /// The scene, already as fine as it is to be, with the choice changed; `speed`: a tenth of its sound speed [m/s].
    pub(super) fn change(self, scene: Template, speed: f64) -> Template {
        match self {
            Self::Spacing => scene,
            Self::Seed => scene.with("numerics.seed", 2),
            Self::SoundSpeed => scene.with("numerics.expected_speed", 1.5 * speed),
            Self::Yield => scene.with("numerics.yield_iterations", 3),
        }
    }
}

/// By what share a number changes.
pub(super) fn change(base: Option<f64>, changed: Option<f64>) -> Option<f64> {
    Some(changed? / base? - 1.0)
}

/// A row for each result: its name and what each choice changes, in the order of [`Choice::ALL`].
pub(super) fn table(title: String, rows: &[(String, [Option<f64>; 4])]) -> Table {
    let mut head = vec!["result".to_owned()];
    head.extend(Choice::ALL.map(|choice| choice.what().to_owned()));
    let row = |(what, changes): &(String, [Option<f64>; 4])| {
        let mut row = vec![what.clone()];
        row.extend(changes.map(|c| c.map_or("-".to_owned(), number)));
        row
    };
    Table {
        title,
        head,
        rows: rows.iter().map(row).collect(),
    }
}
