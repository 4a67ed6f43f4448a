//! The cases of work-precision studies; how each is measured stands in `measure`.

mod measure;

use super::super::Error;
use super::Setting;
use crate::validate::template::{Template, point, points, rectangle};
use measure::Measure;

const COLUMN: &str = include_str!("../../../cases/column_collapse.toml");
const ROUND: &str = include_str!("../../../cases/column_collapse_axisymmetric.toml");
const INCLINE: &str = include_str!("../../../cases/validation/incline.toml");
const HYDROSTATIC: &str = include_str!("../../../cases/hydrostatic.toml");
const SILO: &str = include_str!("../../../cases/validation/silo.toml");
const CHANNEL: &str = include_str!("../../../cases/validation/channel.toml");
const DAM: &str = include_str!("../../../cases/validation/dam_break.toml");

/// What a value is held against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reference {
    /// The value is an error itself: 0 is exact.
    Error,
    /// Its own value at the finest resolution; the change to it from the next one is the reference's own error.
    Finest,
}

/// A case to study.
#[derive(Clone, Copy)]
pub struct Study {
    /// Its name.
    pub name: &'static str,
    /// What is measured, and against what.
    pub about: &'static str,
    /// What was published of the same, for the table.
    pub published: Option<(&'static str, f64)>,
    /// What the value is held against.
    pub reference: Reference,
    /// Resolutions, over that of the case; 1 among them, ascending.
    pub resolutions: &'static [f64],
    /// CPU time of the case with defaults, roughly [s]: for the time left only.
    pub cost: f64,
    make: fn(Template, f64) -> Template,
    template: &'static str,
    /// Spacing of the case [m].
    spacing: f64,
    measure: Measure,
}

/// All studies.
pub const STUDIES: [Study; 8] = [
    Study {
        name: "bagnold",
        about: "steady flow down a slope of 25 deg, 5 mm grains, 0.1 m deep, started from the exact profile, 1.5 s: root mean square of velocity against Bagnold's profile over the surface's velocity, mean of the second half",
        published: None,
        reference: Reference::Error,
        resolutions: &[0.5, 0.75, 1.0, 1.5],
        cost: 7.0,
        // Long enough for the kernel of the coarsest, and a whole number of spacings at each resolution.
        make: |t, _| {
            t.with("bodies.layer.velocity_profile", "bagnold")
                .with("bodies.layer.box", rectangle([0.0, 0.0], [0.12, 0.1]))
                .with("domain.upper", point(0.12, 0.15))
                .with(
                    "walls.bed.polyline",
                    crate::validate::template::points(&[[0.0, 0.0], [0.12, 0.0]]),
                )
                .with("run.until", 1.5)
        },
        template: INCLINE,
        spacing: 5e-3,
        measure: Measure::Bagnold,
    },
    Study {
        name: "hydrostatic",
        about: "a box of almost frictionless material (0.6 deg) for 0.5 s, sleep as said: root mean square of pressure against rho g (H - y) over rho g H",
        published: None,
        reference: Reference::Error,
        resolutions: &[0.5, 0.8, 1.0, 1.6],
        cost: 2.5,
        make: |t, _| {
            let sand = toml::Table::from_iter([
                ("law".to_owned(), "constant_friction".into()),
                ("friction_angle".to_owned(), 0.01.into()),
                ("density".to_owned(), 1500.0.into()),
            ]);
            t.with("materials.sand", sand).with("run.until", 0.5)
        },
        template: HYDROSTATIC,
        spacing: 5e-3,
        measure: Measure::Hydrostatic,
    },
    Study {
        name: "column",
        about: "collapse of a column, a = 0.90, planar, to 0.6 s = 6.3 sqrt(H0/g): run-out over half width, against the finest resolution",
        published: Some((
            "axisymmetric experiments of Lube et al. (2004), as in [A]",
            1.116,
        )),
        reference: Reference::Finest,
        resolutions: &[0.35, 0.5, 0.7, 1.0, 1.4, 2.0],
        cost: 2.5,
        make: |t, _| t.with("run.until", 0.6).without("gauges.surface"),
        template: COLUMN,
        spacing: 4.5e-3,
        measure: Measure::RunOut {
            gauge: "front_right",
            radius: 97.2e-3,
        },
    },
    Study {
        name: "tall_column",
        about: "collapse of a column, a = 2.75, planar, to 1.0 s = 6.1 sqrt(H0/g): run-out over half width, against the finest resolution",
        published: Some((
            "2-D law 1.9 a^(2/3) of channels, Lajeunesse et al. (2005)",
            3.73,
        )),
        reference: Reference::Finest,
        resolutions: &[0.35, 0.5, 0.7, 1.0, 1.4, 2.0],
        cost: 5.0,
        make: |t, _| {
            t.with("run.until", 1.0)
                .without("gauges.surface")
                .with("domain.lower", point(-0.9, -0.04))
                .with("domain.upper", point(0.9, 0.35))
                .with(
                    "walls.floor.polyline",
                    crate::validate::template::points(&[[-0.9, 0.0], [0.9, 0.0]]),
                )
                .with(
                    "bodies.column.box",
                    rectangle([-97.2e-3, 0.0], [97.2e-3, 267.3e-3]),
                )
        },
        template: COLUMN,
        spacing: 8e-3,
        measure: Measure::RunOut {
            gauge: "front_right",
            radius: 97.2e-3,
        },
    },
    Study {
        name: "round_column",
        about: "collapse of a round column, a = 0.90, axisymmetric, to 0.6 s: run-out over radius, against the finest resolution",
        published: Some(("experiments of Lube et al. (2004)", 1.116)),
        reference: Reference::Finest,
        resolutions: &[0.5, 0.7, 1.0, 1.4, 2.0],
        cost: 3.0,
        // One start in six throws a single grain ahead, which slides on where the front has stopped.
        make: |t, _| {
            t.with("run.until", 0.6)
                .without("gauges.surface")
                .with("domain.upper", point(1.0, 0.15))
                .with("walls.floor.polyline", points(&[[0.0, 0.0], [1.0, 0.0]]))
        },
        template: ROUND,
        spacing: 3.02e-3,
        measure: Measure::RunOut {
            gauge: "front",
            radius: 97.2e-3,
        },
    },
    Study {
        name: "silo",
        about: "discharge of glass beads from a planar silo, outlet D = 50 mm (10 spacings), 0.4 s: C of Q = C sqrt(g) D^1.5, mean of the second half, against the finest resolution",
        published: Some((
            "1.45 +- 0.12, mu(I) of the Basilisk wiki's silo, another material",
            1.45,
        )),
        reference: Reference::Finest,
        resolutions: &[0.5, 0.7, 1.0, 1.4, 2.0],
        cost: 3.0,
        make: |t, _| t,
        template: SILO,
        spacing: 5e-3,
        measure: Measure::Silo,
    },
    Study {
        name: "channel",
        about: "clay (Herschel and Bulkley) between two plates 40 mm apart (10 spacings to the middle), 2500 Pa/m, from rest to 1.6 s: root mean square of velocity against the exact profile over that of the profile, mean of the second half",
        published: None,
        reference: Reference::Error,
        resolutions: &[0.5, 0.7, 1.0, 1.4],
        cost: 4.0,
        // Sixteen particles along it at each resolution, eight in a draft: a period must hold the kernel.
        make: |t, spacing| {
            let length = 16.0 * spacing;
            let clay = toml::Table::from_iter([
                ("law".to_owned(), "fluid".into()),
                ("preset".to_owned(), "clay".into()),
            ]);
            t.with("domain.lower", point(0.0, -6.0 * spacing))
                .with("domain.upper", point(length, 0.04 + 6.0 * spacing))
                .with("domain.gravity", point(2500.0 / 1540.0, -0.3))
                .with("materials.fluid", clay)
                .with("bodies.fluid.box", rectangle([0.0, 0.0], [length, 0.04]))
                .with(
                    "walls.low.polyline",
                    crate::validate::template::points(&[[0.0, 0.0], [length, 0.0]]),
                )
                .with(
                    "walls.high.polyline",
                    crate::validate::template::points(&[[length, 0.04], [0.0, 0.04]]),
                )
                .with("run.until", 1.6)
        },
        template: CHANNEL,
        spacing: 2e-3,
        measure: Measure::Channel,
    },
    Study {
        name: "dam_break",
        about: "clear water 0.30 m deep (15 spacings) let go over a dry bed, to 1.05 s = 6 sqrt(H/g): root mean square of depth against Ritter's solution of the shallow-water equations over H, where it is 10 to 80 % of H",
        published: None,
        reference: Reference::Error,
        resolutions: &[0.6, 1.0, 1.4, 2.0],
        cost: 3.0,
        make: |t, _| t.without("bodies.downstream"),
        template: DAM,
        spacing: 0.02,
        measure: Measure::DamBreak,
    },
];

/// The study of this name.
#[must_use]
pub fn by_name(name: &str) -> Option<&'static Study> {
    STUDIES.iter().find(|s| s.name == name)
}

impl Study {
    /// The scene of a setting.
    ///
    /// # Errors
    /// [`Error::Scene`].
    pub fn scene(&self, setting: &Setting) -> Result<String, Error> {
        let refused = |why: String| Error::Scene {
            scene: self.name.to_owned(),
            why,
        };
        let template = Template::new(self.template).map_err(refused)?;
        let spacing = self.spacing / setting.resolution;
        let mut template = (self.make)(template, spacing).with("numerics.spacing", spacing);
        if let Some((key, value)) = setting.change {
            let value: toml::Table = format!("v = {value}")
                .parse()
                .map_err(|e| refused(format!("{e}")))?;
            if let Some(value) = value.get("v") {
                template = template.with(&format!("numerics.{key}"), value.clone());
            }
        }
        template.text().map_err(refused)
    }

    /// Particles across the smallest length of the case at a resolution, for tables: the spacing [m].
    #[must_use]
    pub fn spacing(&self, resolution: f64) -> f64 {
        self.spacing / resolution
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene;

    #[test]
    fn every_setting_of_every_study_is_a_scene_with_its_gauge() {
        for study in &STUDIES {
            assert!(study.resolutions.contains(&1.0));
            for setting in super::super::settings(study) {
                let text = study.scene(&setting).unwrap();
                let scene = scene::parse(study.name, &text)
                    .unwrap_or_else(|e| panic!("{} {}: {e}", study.name, setting.name()));
                let spacing = study.spacing(setting.resolution) / scene.quality.resolution();
                assert!((scene.numerics.spacing - spacing).abs() < 1e-12);
                if let Measure::RunOut { gauge, .. } = study.measure {
                    assert!(scene.gauges.iter().any(|g| g.name == gauge));
                }
            }
        }
    }
}
