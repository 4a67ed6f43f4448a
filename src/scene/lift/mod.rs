//! From what was typed to the typed scene: every rule that concerns more than one key, as a named check.
//!
//! A problem never stops the reading: what cannot be lifted is reported and left out, and the rest is checked all
//! the same. A scene is built only if nothing was reported.

mod bodies;
mod circle;
mod clearance;
mod densities;
mod devices;
mod domain;
mod drives;
mod faces;
mod friction;
mod full_names;
mod gates;
mod gauges;
mod geometry;
mod material;
mod motion;
mod numerics;
mod outline;
mod paper_a;
mod paper_b;
mod points;
mod pressures;
mod profile;
mod run;
mod scheme;
mod sound_speed;
mod thinness;
mod unused;
mod walls;

use super::Quality;
use super::raw::{At, DimensionWord, Entry, Named, Place, Problems, RawScene, nearest};
use super::types::{Dimension, Domain, NamedMaterial, Point, Scene};
use crate::math::dot;
use crate::units::shown_bound;
pub(super) use circle::CIRCLES;
pub(super) use friction::{FrictionKeys, friction_keys, values as preset_values};
use geometry::Region;
pub(super) use material::fluid_preset;
pub(crate) use numerics::MOST_PARTICLES;

/// The scene, or `None` if a problem was reported.
pub(super) fn lift(raw: &RawScene, source: &str, problems: &mut Problems) -> Option<Scene> {
    let mut lift = Lift::new(raw, problems);
    let mut materials = lift.materials();
    let mut bodies = lift.bodies();
    lift.check_velocity_profiles(&materials, &bodies);
    let walls = lift.walls();
    let gates = lift.gates();
    let mut inflows = lift.inflows(&materials);
    let outflows = lift.outflows();
    let mut gauges = lift.gauges();
    lift.check_bodies_against_devices();
    lift.check_something_flows();
    let unused_materials = if lift.problems.is_empty() {
        unused::drop_unused(&mut materials, &mut bodies, &mut inflows, &mut gauges)
    } else {
        // What refers to a material may be among what was refused.
        Vec::new()
    };
    lift.check_densities(&materials);
    let numerics = lift.numerics(&materials);
    let quality = raw.numerics.as_ref().and_then(|n| n.value.quality.as_ref());
    let quality = quality.map(|word| Quality::of_word(word.value));
    let run = lift.run();
    lift.check_internal_steps(numerics.as_ref(), run);
    let schedules = lift.schedules(&walls, &inflows);
    let log = lift.log(run);
    let (dimension, domain) = (lift.dimension, lift.domain);
    let domain = domain?;
    let mut adjustables = super::adjust::adjustables(raw, &bodies, &domain, dimension);
    let of_unused = |name: &str| {
        let of = |material: &String| name.starts_with(&format!("material.{material}."));
        unused_materials.iter().any(of)
    };
    adjustables.retain(|a| !of_unused(&a.name));
    Some(Scene {
        name: raw.name.as_ref()?.value.0.clone(),
        title: raw.title.as_ref()?.value.0.clone(),
        source: source.to_owned(),
        dimension,
        domain,
        quality: quality?,
        numerics: numerics?,
        materials: materials.into_iter().collect::<Option<_>>()?,
        unused_materials,
        bodies,
        walls,
        gates,
        inflows,
        outflows,
        gauges,
        run: run?,
        schedules,
        log: log?,
        adjustables,
    })
    .filter(|_| problems.is_empty())
}

/// A body lifted, and what it fills.
struct Filled {
    place: Place,
    region: Region,
    /// Its material, if that is known.
    material: Option<usize>,
}

/// What the checks share.
struct Lift<'r> {
    raw: &'r RawScene,
    problems: &'r mut Problems,
    dimension: Dimension,
    domain: Option<Domain>,
    /// Particle spacing [m].
    spacing: Option<f64>,
    /// Bodies lifted so far, with what they fill.
    filled: Vec<Filled>,
    /// Outflows lifted so far.
    drains: Vec<(Place, Region)>,
    /// Plates of planar gates, where they cover their gap at the start.
    plates: Vec<(Place, Region)>,
    /// The same in space: places within the plate.
    space_plates: Vec<(Place, Vec<Point>)>,
    /// Walls, as far as bodies must keep clear of them.
    solids: Vec<(Place, walls::Solid)>,
    /// Heights along "up" of walls and gates [m].
    heights: Vec<f64>,
}

/// Tolerance of geometric checks over the particle spacing: far below a particle, far above rounding.
const TOUCH: f64 = 1e-4;

impl<'r> Lift<'r> {
    fn new(raw: &'r RawScene, problems: &'r mut Problems) -> Self {
        let dimension = match raw.dimension.as_ref().map(|d| d.value) {
            Some(DimensionWord::Three) => Dimension::Three,
            Some(DimensionWord::Axisymmetric) => Dimension::Axisymmetric,
            _ => Dimension::Two,
        };
        let spacing = raw.numerics.as_ref().and_then(|n| n.value.spacing.as_ref());
        let mut lift = Self {
            raw,
            problems,
            dimension,
            domain: None,
            spacing: spacing.map(|s| s.value.0),
            filled: Vec::new(),
            drains: Vec::new(),
            plates: Vec::new(),
            space_plates: Vec::new(),
            solids: Vec::new(),
            heights: Vec::new(),
        };
        lift.domain = lift.domain();
        lift
    }

    /// Whether the scene is drawn in a plane, that of an axisymmetric one included.
    fn planar(&self) -> bool {
        self.axes() == 2
    }

    fn axisymmetric(&self) -> bool {
        self.dimension == Dimension::Axisymmetric
    }

    /// Number of axes.
    fn axes(&self) -> usize {
        self.dimension.axes()
    }

    /// "a planar scene", for messages.
    fn kind(&self) -> &'static str {
        match self.dimension {
            Dimension::Two => "a planar scene",
            Dimension::Three => "a scene in space",
            Dimension::Axisymmetric => "an axisymmetric scene",
        }
    }

    /// The key `dimension` as it stands in the file.
    fn dimension_key(&self) -> &'static str {
        match self.dimension {
            Dimension::Two => "dimension = 2",
            Dimension::Three => "dimension = 3",
            Dimension::Axisymmetric => "dimension = \"axisymmetric\"",
        }
    }

    fn axis_name(axis: usize) -> &'static str {
        ["x", "y", "z"][axis]
    }

    /// Tolerance of geometric checks [m].
    fn eps(&self) -> f64 {
        TOUCH * self.spacing.unwrap_or(1e-3)
    }

    /// "Up": the axis that gravity mostly points against.
    fn up(&self) -> Point {
        let gravity = self.domain.as_ref().map_or([0.0; 3], |d| d.gravity);
        super::types::up(gravity, self.dimension)
    }

    fn height(&self, point: Point) -> f64 {
        dot(&self.up(), &point)
    }

    /// Index of a name among a section's entries; reports unknown names with the nearest.
    fn index_of<T>(
        &mut self,
        name: &str,
        place: &Place,
        section: &str,
        entries: Option<&At<Named<T>>>,
    ) -> Option<usize> {
        if entries.is_none() && self.raw.given.contains(&section) {
            return None;
        }
        let entries: &[Entry<T>] = entries.map_or(&[], |e| &e.value.0);
        let index = entries.iter().position(|e| e.name == name);
        if index.is_none() {
            let known: Vec<_> = entries.iter().map(|e| e.name.as_str()).collect();
            let allowed = if known.is_empty() {
                format!("a name from [{section}.*], but there is none")
            } else {
                format!("a name from [{section}.*]: {}", known.join(", "))
            };
            let remedy = match nearest(name, known.iter().copied()) {
                Some(near) => format!("did you mean {near}?"),
                None => format!("choose one of these, or add [{section}.NAME]"),
            };
            let found = format!("unknown name {}", crate::units::quote(name));
            self.problems.report(place, found, allowed, remedy);
        }
        index
    }

    /// All entries of a section that could be read.
    fn readable<T>(entries: Option<&'r At<Named<T>>>) -> Vec<(&'r Entry<T>, &'r T)> {
        entries.map_or(Vec::new(), |e| {
            let read = |entry: &'r Entry<T>| Some((entry, entry.value.as_ref()?));
            e.value.0.iter().filter_map(read).collect()
        })
    }

    /// Says behind a bound that is made of the spacing where another than the file's comes from; empty for the file's.
    fn of_quality(&self) -> String {
        let numerics = self.raw.numerics.as_ref().map(|n| &n.value);
        let quality = numerics.and_then(|n| n.quality.as_ref());
        match (quality.map(|q| Quality::of_word(q.value)), self.spacing) {
            (None | Some(Quality::Standard), _) | (_, None) => String::new(),
            (Some(quality), Some(spacing)) => format!(
                " (quality = \"{}\" makes it {} m)",
                quality.name(),
                shown_bound(spacing)
            ),
        }
    }

    /// Density at rest of a lifted material [kg/m^3].
    fn rest_density(materials: &[Option<NamedMaterial>], index: usize) -> Option<f64> {
        let named = materials.get(index)?.as_ref()?;
        Some(named.material.rest_density())
    }
}
