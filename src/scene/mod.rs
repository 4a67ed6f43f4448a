//! The typed scene: what a case file means once it has been read, checked and converted to SI.
//!
//! `raw` holds what may be typed, `lift` turns it into the types below and reports every problem at once,
//! `build` turns a [`Scene`] into particles, walls, devices and gauges. No strings with meaning, no missing
//! values and no units exist below this module.

mod adjust;
mod build;
mod elements;
mod error;
mod footing;
mod gates;
mod ghosts;
mod identity;
mod lift;
mod load;
mod meetings;
mod piles;
mod quality;
mod raw;
mod reference;
mod roof;
mod solids;
mod steady_flow;
mod syntax;
mod tops;
mod types;
mod ways;

pub use adjust::Adjustable;
pub(crate) use build::rigid_motion;
pub use build::{BodyMass, build, geometry, narrow};
pub use error::{SceneError, SceneErrors};
pub use gates::{BehindWall, Gap};
pub(crate) use lift::MOST_PARTICLES;
pub use meetings::Meeting;
pub use quality::Quality;
pub use reference::{reference_markdown, schema};
pub(crate) use solids::{moved, plate, solid};
pub use types::*;

use std::io::Read as _;
use std::path::Path;

use raw::{Place, Problems};
use sha2::{Digest, Sha256};
use toml::de::DeTable;

/// Largest scene file [bytes].
const LARGEST_FILE: u64 = 4 << 20;

/// Reads a scene file.
///
/// # Errors
/// [`SceneErrors`] with every problem of the file: not readable, not UTF-8, not TOML, or not a scene.
pub fn load(path: &Path) -> Result<Scene, SceneErrors> {
    let file = path.display().to_string();
    let refuse = |found: String, allowed: &str, remedy: &str| {
        Err(SceneErrors::new(vec![SceneError {
            file: file.clone(),
            line: 0,
            key: String::new(),
            found,
            allowed: allowed.to_owned(),
            remedy: remedy.to_owned(),
        }]))
    };
    match std::fs::metadata(path) {
        Ok(about) if about.is_dir() => {
            return refuse(
                "a folder".into(),
                "a scene file (TOML)",
                "give the path of a file, for example cases/silo_gate.toml",
            );
        }
        Ok(_) => {}
        Err(error) => return refuse(error.to_string(), "a scene file (TOML)", "check the path"),
    }
    // A pipe or device does not say its size, nor has it to end.
    let mut bytes = Vec::new();
    let read = std::fs::File::open(path)
        .and_then(|file| file.take(LARGEST_FILE + 1).read_to_end(&mut bytes));
    if bytes.len() as u64 > LARGEST_FILE {
        let found = format!("more than {LARGEST_FILE} bytes");
        return refuse(found, "a scene file of at most 4 MiB", "give a scene file");
    }
    match read.map(|_| String::from_utf8(bytes)) {
        Ok(Ok(text)) => parse(&file, &text),
        Ok(Err(error)) => {
            let text =
                String::from_utf8_lossy(&error.as_bytes()[..error.utf8_error().valid_up_to()]);
            let mut problems = Problems::new(&file, &text);
            let column = text.lines().last().filter(|_| !text.ends_with('\n'));
            let column = column.map_or(0, |line| line.chars().count()) + 1;
            problems.report(
                &raw::syntax_place(text.len()),
                format!("a byte at column {column} that is not UTF-8"),
                "UTF-8 text",
                "save the file as UTF-8",
            );
            Err(SceneErrors::new(problems.into_vec()))
        }
        Err(error) => refuse(
            error.to_string(),
            "a readable file",
            "check its permissions",
        ),
    }
}

/// Reads a scene from text; `file_name` only appears in messages.
///
/// # Errors
/// [`SceneErrors`] with every problem of the text.
pub fn parse(file_name: &str, text: &str) -> Result<Scene, SceneErrors> {
    parse_changed(file_name, text, |_| {})
}

/// As [`parse`], with what was read changed before it is checked.
fn parse_changed(
    file_name: &str,
    text: &str,
    change: impl FnOnce(&mut raw::RawScene),
) -> Result<Scene, SceneErrors> {
    let mut problems = Problems::new(file_name, text);
    let scene = match DeTable::parse_recoverable(text) {
        (document, errors) if errors.is_empty() => raw::read_document(document, &mut problems)
            .and_then(|mut scene| {
                change(&mut scene);
                quality::apply(&mut scene);
                lift::lift(&scene, text, &mut problems)
            }),
        (_, errors) => {
            syntax::report_syntax(text, &errors, &mut problems);
            None
        }
    };
    if text.len() as u64 > LARGEST_FILE {
        let found = format!("{} bytes", text.len());
        problems.report(
            &Place::default(),
            found,
            "at most 4 MiB",
            "give a scene file",
        );
    }
    match scene {
        Some(scene) if problems.is_empty() => Ok(scene),
        _ => Err(SceneErrors::new(problems.into_vec())),
    }
}

impl Scene {
    /// SHA-256 of the scene's source text, byte for byte: logs and summaries tell it. Saved states go by [`Scene::identity`].
    #[must_use]
    pub fn fingerprint(&self) -> [u8; 32] {
        Sha256::digest(self.source.as_bytes()).into()
    }

    /// "Up" of the scene as a unit vector: the axis that gravity mostly points against; y (planar) or z (space)
    /// without gravity. On an inclined plane this is the axis across the bed.
    #[must_use]
    pub fn up(&self) -> Point {
        types::up(self.domain.gravity, self.dimension)
    }

    /// Whether particles keep the stress of the exact yield: some material yields, or is no Newtonian fluid.
    #[must_use]
    pub fn keeps_stress(&self) -> bool {
        self.numerics.keeps_stress() && self.materials.iter().any(|m| !m.material.is_newtonian())
    }

    /// Whether a material's pores are full.
    #[must_use]
    pub fn has_pore_pressure(&self) -> bool {
        self.materials.iter().any(|m| m.material.is_saturated())
    }

    /// Whether a wall or gate has Coulomb friction.
    #[must_use]
    pub fn has_wall_friction(&self) -> bool {
        self.slips().any(|s| s.friction() > 0.0)
    }

    /// Walls that are steered, and how, in their order.
    pub fn drives(&self) -> impl Iterator<Item = (&Wall, &WallDrive)> {
        let walls = self.walls.iter();
        walls.filter_map(|wall| Some((wall, wall.drive.as_ref()?)))
    }

    /// The number of a wall's drive among [`Scene::drives`].
    #[must_use]
    pub fn drive_of(&self, wall: usize) -> Option<usize> {
        self.walls[wall].drive.as_ref()?;
        let before = self.walls[..wall].iter();
        Some(before.filter(|w| w.drive.is_some()).count())
    }

    /// Walls and gates whose moment a gauge reads, with the points that it is taken about [m], in the order of the gauges.
    pub fn moments(&self) -> impl Iterator<Item = (ForceTarget, Point)> {
        self.gauges.iter().filter_map(|gauge| match gauge.kind {
            GaugeKind::Force { on, about } => Some((on, about?)),
            _ => None,
        })
    }

    /// Whether grains' friction goes on into walls (docs/theory.md, W14): asked for, the exact yield, a wall or gate without slip, and neither fluids nor
    /// full pores, with which the pressure between grains is not all of it.
    #[must_use]
    pub fn friction_goes_on(&self) -> bool {
        let dry = |m: &crate::material::Material| !m.is_fluid() && !m.is_saturated();
        self.numerics.friction_into_walls
            && self.numerics.keeps_stress()
            && self.materials.iter().all(|m| dry(&m.material))
            && self.slips().any(|s| s == Slip::NoSlip)
    }

    fn slips(&self) -> impl Iterator<Item = Slip> {
        let slips = self.walls.iter().map(|w| w.slip);
        slips.chain(self.gates.iter().map(|g| g.slip))
    }
}
