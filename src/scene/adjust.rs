//! What of a scene may be changed without touching its text: resolution, values of materials worth calibrating, wall
//! friction, places of gauges. A component shows these numbers as fixed parameters.
//!
//! A change goes into what was read of the text, before it is checked, so that every rule of scenes holds for the
//! changed scene too and everything derived (sound speed, time scales, lengths of lines) follows. A number at its
//! start value changes nothing, not even a bit.

use super::Quality;
use super::lift;
use super::raw::{
    Angle, At, Coordinates, Entry, Length, Named, Place, Pressure, Ratio, RawGauge, RawMaterial,
    RawScene, Viscosity,
};
use super::types::{Point, Scene};
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
    WallFriction(usize),
    /// Section, point of the gauge, axis.
    Gauge(usize, usize, usize),
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum MaterialKey {
    StaticAngle,
    DynamicAngle,
    Angle,
    InertialScale,
    Diameter,
    Consistency,
    YieldStress,
}

/// 180/pi: degrees of a radian.
const DEGREES: Option<(&str, f64)> = Some(("deg", 57.295_779_513_082_32));
const MILLIMETRES: Option<(&str, f64)> = Some(("mm", 1000.0));
/// Friction angles [rad]: the scene's own limits, and not so small that nothing but a fluid is left.
const ANGLES: (f64, f64) = (0.01, 1.25);

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
        })?;
        // Start values stay those of the text.
        scene.adjustables = self.adjustables.clone();
        Ok(scene)
    }
}

/// All numbers of a scene that may be changed: resolution, quality, materials, walls, gauges.
pub(super) fn adjustables(
    raw: &RawScene,
    lower: Point,
    upper: Point,
    axes: usize,
) -> Vec<Adjustable> {
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
        materials(i, name, material, &mut list);
    }
    for (i, (name, wall)) in sections(raw.walls.as_ref()).enumerate() {
        if let Some(friction) = &wall.wall_friction {
            let start = friction.value.0;
            list.push(Adjustable {
                name: format!("wall.{name}.friction"),
                description: format!("Coulomb friction coefficient of wall {name}"),
                unit: "1",
                display_unit: None,
                start,
                range: around((0.0, 10.0), start),
                target: Target::WallFriction(i),
            });
        }
    }
    for (i, (name, gauge)) in sections(raw.gauges.as_ref()).enumerate() {
        for (p, (point, at)) in points(gauge).into_iter().enumerate() {
            for axis in 0..axes {
                let start = at.values.get(axis).copied().unwrap_or(0.0);
                let letter = ["x", "y", "z"][axis];
                list.push(Adjustable {
                    name: format!("gauge.{name}.{point}_{letter}"),
                    description: format!("{letter} of `{point}`, a place of gauge {name}"),
                    unit: "m",
                    display_unit: MILLIMETRES,
                    start,
                    range: around((lower[axis], upper[axis]), start),
                    target: Target::Gauge(i, p, axis),
                });
            }
        }
    }
    list
}

fn materials(i: usize, name: &str, material: &RawMaterial, list: &mut Vec<Adjustable>) {
    let mut add = |key: &str, text: &str, target, start: Option<f64>, range| {
        let (unit, display_unit) = match target {
            MaterialKey::InertialScale => ("1", None),
            MaterialKey::Diameter => ("m", MILLIMETRES),
            MaterialKey::Consistency => ("Pa.s", None),
            MaterialKey::YieldStress => ("Pa", None),
            _ => ("rad", DEGREES),
        };
        if let Some(start) = start {
            list.push(Adjustable {
                name: format!("material.{name}.{key}"),
                description: format!("{text} of material {name}"),
                unit,
                display_unit,
                start,
                range: around(range, start),
                target: Target::Material(i, target),
            });
        }
    };
    let (preset, statically, dynamically, scale, diameter) = match material {
        RawMaterial::MuI(m) => (
            &m.preset,
            &m.static_friction_angle,
            &m.dynamic_friction_angle,
            &m.inertial_number_scale,
            &m.grain_diameter,
        ),
        RawMaterial::BarkerGray(m) => (
            &m.preset,
            &m.static_friction_angle,
            &m.dynamic_friction_angle,
            &m.inertial_number_scale,
            &m.grain_diameter,
        ),
        RawMaterial::ConstantFriction(m) => {
            let start = m.friction_angle.as_ref().map(|a| a.value.0);
            add(
                "friction_angle",
                "friction angle",
                MaterialKey::Angle,
                start,
                (0.0, 1.25),
            );
            return;
        }
        RawMaterial::Fluid(m) => {
            let preset = lift::fluid_preset(m);
            let consistency = m.consistency.as_ref().map(|v| v.value.0);
            add(
                "consistency",
                "consistency, the viscosity where the flow index is 1,",
                MaterialKey::Consistency,
                consistency.or(preset.map(|p| p.1.consistency)),
                (0.0, 1e9),
            );
            let yield_stress = m.yield_stress.as_ref().map(|v| v.value.0);
            add(
                "yield_stress",
                "yield stress",
                MaterialKey::YieldStress,
                yield_stress.or(preset.map(|p| p.2)).or(Some(0.0)),
                (0.0, 1e9),
            );
            return;
        }
    };
    let preset = preset.as_ref().map(|p| lift::preset_values(p.value));
    let angle = |at: &Option<At<Angle>>, mu: Option<f64>| {
        at.as_ref().map(|a| a.value.0).or(mu.map(f64::atan))
    };
    add(
        "static_friction_angle",
        "friction angle at vanishing shear rate, tan of it is mu_s,",
        MaterialKey::StaticAngle,
        angle(statically, preset.map(|(law, _)| law.mu_s)),
        ANGLES,
    );
    add(
        "dynamic_friction_angle",
        "friction angle at large shear rate, tan of it is mu_2, not below the static one,",
        MaterialKey::DynamicAngle,
        angle(dynamically, preset.map(|(law, _)| law.mu_2)),
        ANGLES,
    );
    let scale = scale.as_ref().map(|s| s.value.0);
    add(
        "inertial_number_scale",
        "inertial number I0 at which friction is half way between its two values,",
        MaterialKey::InertialScale,
        scale.or(preset.map(|(law, _)| law.inertial_number_scale)),
        (1e-3, 1e3),
    );
    let diameter = diameter.as_ref().map(|d| d.value.0);
    add(
        "grain_diameter",
        "grain diameter",
        MaterialKey::Diameter,
        diameter.or(preset.map(|(_, grains)| grains.diameter)),
        (1e-6, 1.0),
    );
}

/// The range, wide enough for what the scene says.
fn around((least, most): (f64, f64), start: f64) -> (f64, f64) {
    (least.min(start), most.max(start))
}

/// Places of a gauge that may be moved, with the names of their keys.
fn points(gauge: &RawGauge) -> Vec<(&'static str, &Coordinates<Length>)> {
    let all = match gauge {
        RawGauge::Depth(g) => vec![("foot", &g.foot)],
        RawGauge::Profile(g) => vec![("from", &g.from), ("to", &g.to)],
        RawGauge::Discharge(g) => vec![("from", &g.from), ("to", &g.to)],
        RawGauge::Pressure(g) => vec![("at", &g.at)],
        RawGauge::Front(g) => vec![("origin", &g.origin)],
        RawGauge::Force(_) | RawGauge::Mass(_) => Vec::new(),
    };
    all.into_iter()
        .filter_map(|(name, at)| Some((name, &at.as_ref()?.value)))
        .collect()
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
                    apply_material(material, &place, key, value);
                }
            }
        }
        Target::WallFriction(i) => {
            let wall = entry(raw.walls.as_mut(), i).and_then(|e| e.value.as_mut());
            if let Some(friction) = wall.and_then(|w| w.wall_friction.as_mut()) {
                friction.value = Ratio(value);
            }
        }
        Target::Gauge(i, point, axis) => {
            let gauge = entry(raw.gauges.as_mut(), i).and_then(|e| e.value.as_mut());
            let at = match (gauge, point) {
                (Some(RawGauge::Depth(g)), _) => &mut g.foot,
                (Some(RawGauge::Profile(g)), 0) => &mut g.from,
                (Some(RawGauge::Profile(g)), _) => &mut g.to,
                (Some(RawGauge::Discharge(g)), 0) => &mut g.from,
                (Some(RawGauge::Discharge(g)), _) => &mut g.to,
                (Some(RawGauge::Pressure(g)), _) => &mut g.at,
                (Some(RawGauge::Front(g)), _) => &mut g.origin,
                (Some(RawGauge::Force(_) | RawGauge::Mass(_)) | None, _) => return,
            };
            let values = at.as_mut().map(|at| &mut at.value.values);
            if let Some(coordinate) = values.and_then(|v| v.get_mut(axis)) {
                *coordinate = value;
            }
        }
    }
}

fn apply_material(material: &mut RawMaterial, place: &Place, key: MaterialKey, value: f64) {
    macro_rules! apply_to {
        ($raw:ident) => {
            match key {
                MaterialKey::StaticAngle => {
                    $raw.static_friction_angle = at(place, "static_friction_angle", Angle(value));
                }
                MaterialKey::DynamicAngle => {
                    $raw.dynamic_friction_angle = at(place, "dynamic_friction_angle", Angle(value));
                }
                MaterialKey::InertialScale => {
                    $raw.inertial_number_scale = at(place, "inertial_number_scale", Ratio(value));
                }
                MaterialKey::Diameter => {
                    $raw.grain_diameter = at(place, "grain_diameter", Length(value));
                }
                MaterialKey::Angle | MaterialKey::Consistency | MaterialKey::YieldStress => {}
            }
        };
    }
    match material {
        RawMaterial::MuI(raw) => apply_to!(raw),
        RawMaterial::BarkerGray(raw) => apply_to!(raw),
        RawMaterial::ConstantFriction(raw) => {
            raw.friction_angle = at(place, "friction_angle", Angle(value));
        }
        RawMaterial::Fluid(raw) if key == MaterialKey::Consistency => {
            raw.consistency = at(place, "consistency", Viscosity(value));
        }
        RawMaterial::Fluid(raw) => raw.yield_stress = at(place, "yield_stress", Pressure(value)),
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
        parse("devices", include_str!("../../tests/scenes/devices.toml")).expect("it is a scene")
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
}
