//! The two columns of discs, and the scenes that stand for them.

use super::{Profile, profile_error};
use crate::validate::studies::choices::Choice;
use crate::validate::studies::columns::{SERIES, scene};
use crate::validate::template::{Template, point};
use crate::validate::{Effort, Member, Recording, Results};

const GRAVITY: f64 = 9.81;
/// Height of both columns: everything scales with it [m].
pub(super) const HEIGHT: f64 = 0.1;

/// A column of discs; lengths over H0.
pub(super) struct Discs {
    pub(super) name: &'static str,
    pub(super) aspect: f64,
    pub(super) half_width: f64,
    /// H0/d.
    pub(super) grains: f64,
    /// How far the domain goes, and the spacing of the profile in the data.
    pub(super) reach: f64,
    pub(super) place: f64,
}

pub(super) const COLUMNS: [Discs; 2] = [
    Discs {
        name: "a0.49",
        aspect: 0.49,
        half_width: 2.041,
        grains: 30.0,
        reach: 5.4,
        place: 0.2,
    },
    Discs {
        name: "a6.26",
        aspect: 6.26,
        half_width: 0.160,
        grains: 134.0,
        reach: 3.2,
        place: 0.1,
    },
];

/// The column at which the scheme's choices are changed: the one whose profiles leave the band.
pub(super) const CHECKED: &Discs = &COLUMNS[0];

impl Discs {
    /// The column with so many spacings over a grain.
    fn scene(&self, spacings: f64, seed: u32, effort: Effort) -> Result<Template, String> {
        let grain = HEIGHT / self.grains;
        let spacing = spacings * grain;
        let fall = fall();
        let beyond = self.places() as f64 * self.place * HEIGHT;
        let size = [self.half_width * HEIGHT, HEIGHT];
        Ok(scene(size, spacing, self.reach * HEIGHT)?
            .with("materials.sand.static_friction_angle", 0.32_f64.atan())
            .with("materials.sand.dynamic_friction_angle", 0.60_f64.atan())
            .with(
                "materials.sand.inertial_number_scale",
                0.40 / 0.6_f64.sqrt(),
            )
            .with("materials.sand.grain_diameter", grain)
            .with("numerics.seed", i64::from(seed))
            .with("gauges.surface.kind", "profile")
            .with("gauges.surface.from", point(-beyond, 0.0))
            .with("gauges.surface.to", point(beyond, 0.0))
            .with("gauges.surface.count", 2 * self.places() as i64 + 1)
            .with("run.step", fall / 10.0)
            .with("run.until", effort.pick(8.0, 6.0) * fall))
    }

    fn run(&self, seed: u32) -> String {
        format!("{}_seed{seed}", self.name)
    }

    fn check(&self, choice: Choice) -> String {
        format!("check_{}_{}", self.name, choice.name())
    }

    /// Mean of |h - h of the first seed| over H0 by each choice, over the places at which either is above 0.
    pub(super) fn changes(&self, results: &Results, time: f64) -> [Option<f64>; 4] {
        let profile = |name: String| self.profile(results.finished(&name)?, time);
        let base = profile(self.run(1));
        Choice::ALL.map(|choice| {
            let depths = base.as_ref()?.iter().enumerate();
            let base: Profile = depths.map(|(k, h)| (k as f64 * self.place, *h)).collect();
            profile_error(&profile(self.check(choice))?, self.place, &base)
        })
    }

    /// Places of the profile on either side of the middle.
    fn places(&self) -> usize {
        (0.96 * self.reach / self.place) as usize
    }

    /// Depths over H0 at x = 0, dx, 2 dx, ..., both sides averaged.
    pub(super) fn profile(&self, recording: &Recording, time: f64) -> Option<Vec<f64>> {
        let depths = recording.values_at("gauge.surface.depth", time * fall())?;
        let middle = self.places();
        let both = |k: usize| 0.5 * (depths[middle + k] + depths[middle - k]) / HEIGHT;
        (depths.len() == 2 * middle + 1).then(|| (0..=middle).map(both).collect())
    }
}

/// sqrt(H0/g) [s].
pub(super) fn fall() -> f64 {
    (HEIGHT / GRAVITY).sqrt()
}

pub(super) fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let series = [&SERIES[..], &["gauge.surface.depth"]].concat();
    let member = |name: String, scene: Template| {
        scene
            .text()
            .map(|text| Member::new(name, text, &series, Vec::new()))
    };
    let spacings = effort.pick(1.0, 3.0);
    let mut members = Vec::new();
    for column in &COLUMNS {
        for seed in 1..=effort.pick(3, 1) {
            members.push(member(
                column.run(seed),
                column.scene(spacings, seed, effort)?,
            )?);
        }
    }
    for choice in Choice::ALL {
        let scene = CHECKED.scene(spacings / choice.refinement(), 1, effort)?;
        let changed = choice.change(scene, (GRAVITY * HEIGHT).sqrt());
        members.push(member(CHECKED.check(choice), changed)?);
    }
    Ok(members)
}
