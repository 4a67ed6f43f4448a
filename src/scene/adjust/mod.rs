//! What of a scene may be changed without touching its text: resolution, values of materials worth calibrating, extents
//! and fill levels of bodies, wall friction, places of gauges. A component shows these numbers as fixed parameters.
//!
//! A change goes into what was read of the text, before it is checked, so that every rule of scenes holds for the
//! changed scene too and everything derived (sound speed, time scales, lengths of lines) follows. A number at its
//! start value changes nothing, not even a bit.

mod bodies;
mod gauges;
mod materials;
mod walls;

use self::bodies::BodyKey;
use self::materials::MaterialKey;
use super::Quality;
use super::raw::{At, Entry, Named, Place, RawScene};
use super::types::{Body, Dimension, Domain, Scene, up};
use super::{SceneErrors, parse_changed};

/// A number of a scene that may be changed before a component is initialised.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjustable {
    /// Name of the parameter: `material.sand.grain_diameter`.
    pub name: String,
    /// One line for people.
    pub description: String,
    /// SI unit as FMI spells it.
    pub unit: &'static str,
    /// Unit people like to see, with its factor.
    pub display_unit: Option<(&'static str, f64)>,
    /// What the scene's text says.
    pub start: f64,
    /// Smallest and largest value; rules between several values are checked when the scene is built.
    pub range: (f64, f64),
    target: Target,
}

/// Where the number stands; indices count sections in the order of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Target {
    Resolution,
    Quality,
    Material(usize, MaterialKey),
    Body(usize, BodyKey),
    WallFriction(usize),
    /// Section, point of the gauge, axis.
    Gauge(usize, usize, usize),
}

const MILLIMETRES: Option<(&str, f64)> = Some(("mm", 1000.0));

impl Scene {
    /// The scene with other values of its [`Scene::adjustables`], in their order.
    ///
    /// # Errors
    /// [`SceneErrors`] with every rule of scenes that the values break.
    pub fn adjusted(&self, values: &[f64]) -> Result<Scene, SceneErrors> {
        let pairs = self.adjustables.iter().zip(values);
        let changed: Vec<(Target, f64)> = pairs
            .filter(|(row, value)| row.start.to_bits() != value.to_bits())
            .map(|(row, value)| (row.target, *value))
            .collect();
        let mut scene = parse_changed(&self.name, &self.source, |raw| {
            for (target, value) in changed {
                apply(raw, target, value);
            }
            // What an inflow lets in is its input's; whether that may be, whoever holds the inputs knows.
            let inflows = raw.inflows.iter_mut().flat_map(|list| &mut list.value.0);
            let rates = inflows.filter_map(|inflow| inflow.value.as_mut()?.rate.as_mut());
            rates.for_each(|rate| rate.value.0 = 0.0);
        })?;
        // Start values stay those of the text.
        scene.adjustables = self.adjustables.clone();
        for (inflow, own) in scene.inflows.iter_mut().zip(&self.inflows) {
            inflow.rate = own.rate;
        }
        Ok(scene)
    }
}

/// All numbers of a scene that may be changed: resolution, quality, materials, bodies, walls, gauges. `lifted` are the scene's
/// bodies.
pub(super) fn adjustables(
    raw: &RawScene,
    lifted: &[Body],
    domain: &Domain,
    dimension: Dimension,
) -> Vec<Adjustable> {
    let axes = dimension.axes();
    let mut list = vec![Adjustable {
        name: "solver.resolution_scale".to_owned(),
        description:
            "resolution over the scene's own: 2 halves the particle spacing, 0.5 doubles it"
                .to_owned(),
        unit: "1",
        display_unit: None,
        start: 1.0,
        range: (0.1, 10.0),
        target: Target::Resolution,
    }];
    let quality = raw.numerics.as_ref().and_then(|n| n.value.quality.as_ref());
    if let Some(word) = quality {
        list.push(Adjustable {
            name: "solver.quality".to_owned(),
            description: "how accurate, how fast: 0 draft, 1 standard, 2 fine (the nearest counts)"
                .to_owned(),
            unit: "1",
            display_unit: None,
            start: Quality::of_word(word.value).number(),
            range: (0.0, 2.0),
            target: Target::Quality,
        });
    }
    for (i, (name, material)) in sections(raw.materials.as_ref()).enumerate() {
        materials::list(i, name, material, &mut list);
    }
    let numerics = raw.numerics.as_ref().map(|n| &n.value);
    let space = bodies::Space {
        domain,
        up: up(domain.gravity, dimension),
        axes,
        spacing: numerics.and_then(|n| Some(n.spacing.as_ref()?.value.0)),
    };
    for (i, (name, body)) in sections(raw.bodies.as_ref()).enumerate() {
        let shape = lifted.iter().find(|b| b.name == name).map(|b| &b.shape);
        bodies::list(i, name, body, shape, &space, &mut list);
    }
    for (i, (name, wall)) in sections(raw.walls.as_ref()).enumerate() {
        list.extend(walls::friction(i, name, wall));
    }
    for (i, (name, gauge)) in sections(raw.gauges.as_ref()).enumerate() {
        gauges::list(i, name, gauge, domain, axes, &mut list);
    }
    list
}

/// The range, wide enough for what the scene says.
fn around((least, most): (f64, f64), start: f64) -> (f64, f64) {
    (least.min(start), most.max(start))
}

fn apply(raw: &mut RawScene, target: Target, value: f64) {
    match target {
        Target::Resolution => {
            let numerics = raw.numerics.as_mut().map(|n| &mut n.value);
            if let Some(spacing) = numerics.and_then(|n| n.spacing.as_mut()) {
                spacing.value.0 /= value;
            }
        }
        Target::Quality => {
            let numerics = raw.numerics.as_mut().map(|n| &mut n.value);
            if let Some(word) = numerics.and_then(|n| n.quality.as_mut()) {
                word.value = Quality::of_number(value).word();
            }
        }
        Target::Material(i, key) => {
            if let Some(entry) = entry(raw.materials.as_mut(), i) {
                let place = entry.place.clone();
                if let Some(material) = &mut entry.value {
                    materials::apply(material, &place, key, value);
                }
            }
        }
        Target::Body(i, key) => {
            if let Some(entry) = entry(raw.bodies.as_mut(), i) {
                let place = entry.place.clone();
                if let Some(body) = &mut entry.value {
                    bodies::apply(body, &place, key, value);
                }
            }
        }
        Target::WallFriction(i) => {
            if let Some(wall) = entry(raw.walls.as_mut(), i).and_then(|e| e.value.as_mut()) {
                walls::apply(wall, value);
            }
        }
        Target::Gauge(i, point, axis) => {
            if let Some(gauge) = entry(raw.gauges.as_mut(), i).and_then(|e| e.value.as_mut()) {
                gauges::apply(gauge, point, axis, value);
            }
        }
    }
}

#[allow(clippy::unnecessary_wraps, reason = "what a key of a table is")]
fn at<T>(table: &Place, key: &str, value: T) -> Option<At<T>> {
    Some(At {
        value,
        place: table.child(key),
    })
}

fn sections<T>(named: Option<&At<Named<T>>>) -> impl Iterator<Item = (&str, &T)> {
    let entries = named.map_or(&[][..], |n| &n.value.0);
    entries
        .iter()
        .filter_map(|e| Some((e.name.as_str(), e.value.as_ref()?)))
}

fn entry<T>(named: Option<&mut At<Named<T>>>, i: usize) -> Option<&mut Entry<T>> {
    named?.value.0.get_mut(i)
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use crate::scene::{GaugeKind, Scene};

    fn scene() -> Scene {
        parse(
            "devices",
            include_str!("../../../tests/scenes/devices.toml"),
        )
        .expect("it is a scene")
    }

    fn with(scene: &Scene, changes: &[(&str, f64)]) -> Result<Scene, String> {
        let mut values: Vec<f64> = scene.adjustables.iter().map(|a| a.start).collect();
        for (name, value) in changes {
            let place = scene.adjustables.iter().position(|a| a.name == *name);
            values[place.unwrap_or_else(|| panic!("no parameter {name}"))] = *value;
        }
        scene.adjusted(&values).map_err(|e| e.to_string())
    }

    #[test]
    fn start_values_change_nothing() {
        let scene = scene();
        assert_eq!(with(&scene, &[]).expect("a scene"), scene);
    }

    #[test]
    fn what_follows_from_a_value_follows_from_a_changed_one() {
        let scene = scene();
        let finer = with(&scene, &[("solver.resolution_scale", 2.0)]).expect("a scene");
        assert_eq!(finer.numerics.spacing, scene.numerics.spacing / 2.0);
        assert_eq!(finer.source, scene.source);
        // The plate is four particles thick.
        assert!((finer.gates[0].thickness - scene.gates[0].thickness / 2.0).abs() < 1e-15);
        let coarse = with(&scene, &[("material.beads.grain_diameter", 2e-3)]).expect("a scene");
        assert_eq!(coarse.materials[0].material.grains.diameter, 2e-3);
        let moved = with(
            &scene,
            &[("gauge.depth.foot_x", 0.06), ("gauge.probe.at_y", 0.01)],
        );
        let moved = moved.expect("a scene");
        assert!(matches!(moved.gauges[0].kind, GaugeKind::Depth { foot, .. } if foot[0] == 0.06));
    }

    #[test]
    fn rules_between_values_hold_for_changed_scenes() {
        let scene = scene();
        let steep = with(&scene, &[("material.beads.static_friction_angle", 0.9)]);
        let steep = steep.expect_err("above the dynamic angle");
        assert!(steep.contains("dynamic_friction_angle"), "{steep}");
        let both = [
            ("material.beads.static_friction_angle", 0.9),
            ("material.beads.dynamic_friction_angle", 1.0),
        ];
        assert!(with(&scene, &both).is_ok());
    }

    fn dam() -> Scene {
        let text = include_str!("../../../cases/silted_dam_reduced.toml");
        parse("silted_dam_reduced", text).expect("it is a scene")
    }

    #[test]
    fn levels_of_layers_move_together_or_not_at_all() {
        let scene = dam();
        let gap = with(&scene, &[("body.silt.upper_y", 0.24)]).expect_err("into the water");
        assert!(gap.contains("overlaps"), "{gap}");
        let both = [
            ("body.silt.upper_y", 0.24),
            ("body.reservoir.lower_y", 0.24),
        ];
        let deeper = with(&scene, &both).expect("a scene");
        let (silt, water) = (
            deeper.bodies[0].shape.bounds(),
            deeper.bodies[1].shape.bounds(),
        );
        assert_eq!((silt.1[1], water.0[1]), (0.24, 0.24));
        let bad = with(&scene, &[("body.silt.upper_y", -0.05)]).expect_err("below its foot");
        assert!(bad.contains("upper"), "{bad}");
        let rows = scene.adjustables.iter();
        let top = rows.clone().find(|a| a.name == "body.silt.upper_y");
        assert!(top.is_some_and(|a| a.description.contains("fill level")));
    }

    #[test]
    fn shapes_without_corners_have_a_level() {
        let text = include_str!("../../../tests/scenes/devices.toml");
        let of = text.find("box = ").expect("its body is a box");
        let line = text[of..].lines().next().expect("a line");
        let round = "polygon = [[0, 0], [\"60 mm\", 0], [\"60 mm\", \"40 mm\"], [0, \"40 mm\"]]";
        let scene = parse("polygon", &text.replace(line, round)).unwrap_or_else(|e| panic!("{e}"));
        let row = scene
            .adjustables
            .iter()
            .find(|a| a.name.ends_with(".level"));
        let row = row.expect("a polygon can be filled less");
        assert_eq!(row.start, 0.04);
        // What is within the range is a scene.
        assert_eq!(row.range, (scene.numerics.spacing, 0.04));
        assert!(with(&scene, &[(&row.name, row.range.0)]).is_ok());
        let lower = with(&scene, &[(&row.name, 0.02)]).expect("a scene");
        assert_eq!(lower.bodies[0].level, Some(0.02));
        let over = with(&scene, &[(&row.name, 0.05)]).expect_err("higher than the shape");
        assert!(over.contains("within the body's height"), "{over}");
    }

    #[test]
    fn where_a_box_has_a_level_that_is_its_fill_level() {
        let text = include_str!("../../../tests/scenes/devices.toml");
        let body = "box = { lower = [\"40 mm\", 0], upper = [\"120 mm\", \"20 mm\"] }";
        assert!(text.contains(body));
        let text = text.replace(body, &format!("{body}\nlevel = \"16 mm\""));
        let scene = parse("level", &text).unwrap_or_else(|e| panic!("{e}"));
        let row = |end: &str| scene.adjustables.iter().find(|a| a.name.ends_with(end));
        let top = row(".upper_y").expect("a box has corners");
        let level = row(".level").expect("it is given");
        assert!(!top.description.contains(": its fill level"));
        assert!(top.description.ends_with(&level.name), "{top:?}");
        let filled = |changes: &[(&str, f64)]| with(&scene, changes).map(|s| s.bodies[0].level);
        assert_eq!(filled(&[(&top.name, 0.018)]), Ok(Some(0.016)));
        assert!(filled(&[(&top.name, 0.012)]).is_err());
        assert_eq!(filled(&[(&level.name, 0.012)]), Ok(Some(0.012)));
    }

    #[test]
    fn what_fluids_and_saturated_beds_flow_by_can_be_changed() {
        let scene = dam();
        let changes = [
            ("material.silt.consistency", 2.5),
            ("material.silt.flow_index", 0.8),
            ("material.silt.cohesion", 20.0),
            ("material.silt.density", 1900.0),
            ("material.water.flow_index", 0.9),
            ("material.water.yield_stress", 0.1),
            ("material.water.consistency", 0.01),
        ];
        let changed = with(&scene, &changes).expect("a scene");
        let (water, silt) = (
            &changed.materials[0].material,
            &changed.materials[1].material,
        );
        assert_eq!(
            (silt.viscous.consistency, silt.viscous.flow_index),
            (2.5, 0.8)
        );
        assert!((silt.rest_density() - 1900.0).abs() < 1e-9);
        // c cos phi: the line of Mohr and Coulomb in plane strain.
        assert!((silt.cohesion - 20.0 * 30_f64.to_radians().cos()).abs() < 1e-9);
        assert_eq!(
            (water.viscous.consistency, water.viscous.flow_index),
            (0.01, 0.9)
        );
        let names: Vec<&str> = scene.adjustables.iter().map(|a| a.name.as_str()).collect();
        assert!(names.contains(&"material.water.density"));
        // Dry sand has no viscous stress to calibrate.
        let dry = self::scene();
        assert!(
            dry.adjustables
                .iter()
                .all(|a| !a.name.ends_with("flow_index"))
        );
    }
}
