//! Values of materials worth calibrating: friction, grain size, cohesion, and what a fluid or a saturated bed flows by.

use super::super::lift::{self, FrictionKeys, friction_keys};
use super::super::raw::{
    Angle, At, CONSISTENCIES, DENSITIES, Density, FLOW_INDICES, FRICTION_ANGLES, GRAIN_DIAMETERS,
    GRANULAR_ANGLES, Length, Place, Pressure, Ratio, RawConstantFriction, RawFluid, RawMaterial,
    STRENGTHS, Viscosity,
};
use super::{Adjustable, MILLIMETRES, Target, around, at};

/// Which value of a material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum MaterialKey {
    StaticAngle,
    DynamicAngle,
    Angle,
    InertialScale,
    Diameter,
    Cohesion,
    Density,
    Consistency,
    /// The consistency where no flow index stands beside it: a viscosity.
    ConsistencyOfNewton,
    FlowIndex,
    YieldStress,
}

/// 180/pi: degrees of a radian.
const DEGREES: Option<(&str, f64)> = Some(("deg", 57.295_779_513_082_32));
/// Smallest friction angle of mu(I) [rad]: not so small that nothing but a fluid is left.
const LEAST_ANGLE: f64 = 0.01;
/// Smallest grain diameter [m]; the scene's own limit is above 0.
const LEAST_DIAMETER: f64 = 1e-6;

/// Collects the values of one material.
struct Rows<'a> {
    material: &'a str,
    index: usize,
    list: &'a mut Vec<Adjustable>,
}

impl Rows<'_> {
    /// One value, if the scene gives it.
    fn add(
        &mut self,
        key: &str,
        text: &str,
        target: MaterialKey,
        start: Option<f64>,
        range: (f64, f64),
    ) {
        let (unit, display_unit) = match target {
            MaterialKey::StaticAngle | MaterialKey::DynamicAngle | MaterialKey::Angle => {
                ("rad", DEGREES)
            }
            MaterialKey::InertialScale | MaterialKey::FlowIndex => ("1", None),
            MaterialKey::Diameter => ("m", MILLIMETRES),
            MaterialKey::Density => ("kg/m3", None),
            // With another flow index than 1, which is a parameter beside it, its unit is no product of whole powers.
            MaterialKey::Consistency => ("Pa.s^n", None),
            MaterialKey::ConsistencyOfNewton => ("Pa.s", None),
            MaterialKey::Cohesion | MaterialKey::YieldStress => ("Pa", None),
        };
        let name = self.material;
        self.list.extend(start.map(|start| Adjustable {
            name: format!("material.{name}.{key}"),
            description: format!("{text} of material {name}"),
            unit,
            display_unit,
            start,
            range: around(range, start),
            target: Target::Material(self.index, target),
        }));
    }

    fn cohesion(&mut self, cohesion: Option<&At<Pressure>>) {
        let start = cohesion.map(|c| c.value.0);
        self.add(
            "cohesion",
            "cohesion, no tensile strength,",
            MaterialKey::Cohesion,
            start,
            STRENGTHS.ends(),
        );
    }

    fn density(&mut self, start: Option<f64>) {
        self.add(
            "density",
            "density at rest",
            MaterialKey::Density,
            start,
            DENSITIES.ends(),
        );
    }

    /// Consistency and flow index.
    fn viscous(&mut self, consistency: Option<f64>, index: Option<f64>) {
        let (text, key) = match index {
            Some(_) => (
                "consistency, the viscosity where the flow index n is 1,",
                MaterialKey::Consistency,
            ),
            None => ("viscosity", MaterialKey::ConsistencyOfNewton),
        };
        self.add("consistency", text, key, consistency, CONSISTENCIES.ends());
        self.add(
            "flow_index",
            "flow index n",
            MaterialKey::FlowIndex,
            index,
            FLOW_INDICES.ends(),
        );
    }

    /// Laws that are made from mu(I).
    fn mu_i(&mut self, keys: &FrictionKeys<'_>, cohesion: &Option<At<Pressure>>) {
        let preset = keys.preset.as_ref().map(|p| lift::preset_values(p.value));
        let angle = |at: &Option<At<Angle>>, mu: Option<f64>| {
            at.as_ref().map(|a| a.value.0).or(mu.map(f64::atan))
        };
        self.add(
            "static_friction_angle",
            "friction angle at vanishing shear rate, tan of it is mu_s,",
            MaterialKey::StaticAngle,
            angle(keys.static_friction_angle, preset.map(|(law, _)| law.mu_s)),
            (LEAST_ANGLE, GRANULAR_ANGLES.ends().1),
        );
        self.add(
            "dynamic_friction_angle",
            "friction angle at large shear rate, tan of it is mu_2, not below the static one,",
            MaterialKey::DynamicAngle,
            angle(keys.dynamic_friction_angle, preset.map(|(law, _)| law.mu_2)),
            (LEAST_ANGLE, GRANULAR_ANGLES.ends().1),
        );
        let scale = keys.inertial_number_scale.as_ref().map(|s| s.value.0);
        self.add(
            "inertial_number_scale",
            "inertial number I0 at which friction is half way between its two values,",
            MaterialKey::InertialScale,
            scale.or(preset.map(|(law, _)| law.inertial_number_scale)),
            (1e-3, 1e3),
        );
        let diameter = keys.grain_diameter.as_ref().map(|d| d.value.0);
        self.add(
            "grain_diameter",
            "grain diameter",
            MaterialKey::Diameter,
            diameter.or(preset.map(|(_, grains)| grains.diameter)),
            (LEAST_DIAMETER, GRAIN_DIAMETERS.ends().1),
        );
        self.cohesion(cohesion.as_ref());
    }

    fn fluid(&mut self, raw: &RawFluid) {
        let preset = lift::fluid_preset(raw);
        self.density(
            raw.density
                .as_ref()
                .map(|v| v.value.0)
                .or(preset.map(|p| p.0)),
        );
        let consistency = raw.consistency.as_ref().map(|v| v.value.0);
        let index = raw.flow_index.as_ref().map(|v| v.value.0);
        self.viscous(
            consistency.or(preset.map(|p| p.1.consistency)),
            index.or(preset.map(|p| p.1.flow_index)).or(Some(1.0)),
        );
        let start = raw.yield_stress.as_ref().map(|v| v.value.0);
        let start = start.or(preset.map(|p| p.2)).or(Some(0.0));
        self.add(
            "yield_stress",
            "yield stress",
            MaterialKey::YieldStress,
            start,
            STRENGTHS.ends(),
        );
    }

    fn constant_friction(&mut self, raw: &RawConstantFriction) {
        let start = raw.friction_angle.as_ref().map(|a| a.value.0);
        self.add(
            "friction_angle",
            "friction angle",
            MaterialKey::Angle,
            start,
            FRICTION_ANGLES.ends(),
        );
        self.density(raw.density.as_ref().map(|v| v.value.0));
        self.cohesion(raw.cohesion.as_ref());
        // Only where the scene has viscous stress beside friction: elsewhere they would switch another term on.
        let consistency = raw.consistency.as_ref().map(|v| v.value.0);
        if consistency.is_some_and(|k| k > 0.0) {
            self.viscous(consistency, raw.flow_index.as_ref().map(|v| v.value.0));
        }
    }
}

/// The values of the i-th material.
pub(super) fn list(i: usize, name: &str, material: &RawMaterial, list: &mut Vec<Adjustable>) {
    let mut rows = Rows {
        material: name,
        index: i,
        list,
    };
    match material {
        RawMaterial::MuI(m) => rows.mu_i(&friction_keys!(m), &m.cohesion),
        RawMaterial::BarkerGray(m) => rows.mu_i(&friction_keys!(m), &m.cohesion),
        RawMaterial::ConstantFriction(m) => rows.constant_friction(m),
        RawMaterial::Fluid(m) => rows.fluid(m),
    }
}

/// Puts a value of a material.
pub(super) fn apply(material: &mut RawMaterial, place: &Place, key: MaterialKey, value: f64) {
    macro_rules! grains {
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
                MaterialKey::Cohesion => $raw.cohesion = at(place, "cohesion", Pressure(value)),
                _ => {}
            }
        };
    }
    macro_rules! viscous {
        ($raw:ident) => {
            match key {
                MaterialKey::Density => $raw.density = at(place, "density", Density(value)),
                MaterialKey::Consistency | MaterialKey::ConsistencyOfNewton => {
                    $raw.consistency = at(place, "consistency", Viscosity(value))
                }
                MaterialKey::FlowIndex => $raw.flow_index = at(place, "flow_index", Ratio(value)),
                _ => {}
            }
        };
    }
    match material {
        RawMaterial::MuI(raw) => grains!(raw),
        RawMaterial::BarkerGray(raw) => grains!(raw),
        RawMaterial::ConstantFriction(raw) => match key {
            MaterialKey::Angle => raw.friction_angle = at(place, "friction_angle", Angle(value)),
            MaterialKey::Cohesion => raw.cohesion = at(place, "cohesion", Pressure(value)),
            _ => viscous!(raw),
        },
        RawMaterial::Fluid(raw) => match key {
            MaterialKey::YieldStress => {
                raw.yield_stress = at(place, "yield_stress", Pressure(value))
            }
            _ => viscous!(raw),
        },
    }
}
