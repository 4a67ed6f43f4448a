//! The values of mu(I) and of its grains, from a preset and what a scene overrides.

use super::Lift;
use crate::material::{Grains, Law, Material, MuI};
use crate::scene::raw::{Angle, At, Density, Length, Place, Preset, Ratio};

/// The keys of laws that are made from mu(I).
pub(in crate::scene) struct FrictionKeys<'a> {
    pub(in crate::scene) given: &'a [&'static str],
    pub(in crate::scene) preset: &'a Option<At<Preset>>,
    pub(in crate::scene) static_friction_angle: &'a Option<At<Angle>>,
    pub(in crate::scene) dynamic_friction_angle: &'a Option<At<Angle>>,
    pub(in crate::scene) inertial_number_scale: &'a Option<At<Ratio>>,
    pub(in crate::scene) high_inertia_friction: &'a Option<At<Ratio>>,
    pub(in crate::scene) grain_diameter: &'a Option<At<Length>>,
    pub(in crate::scene) grain_density: &'a Option<At<Density>>,
    pub(in crate::scene) phi_max: &'a Option<At<Ratio>>,
    pub(in crate::scene) phi_min: &'a Option<At<Ratio>>,
}

macro_rules! friction_keys {
    ($raw:ident) => {
        FrictionKeys {
            given: &$raw.given,
            preset: &$raw.preset,
            static_friction_angle: &$raw.static_friction_angle,
            dynamic_friction_angle: &$raw.dynamic_friction_angle,
            inertial_number_scale: &$raw.inertial_number_scale,
            high_inertia_friction: &$raw.high_inertia_friction,
            grain_diameter: &$raw.grain_diameter,
            grain_density: &$raw.grain_density,
            phi_max: &$raw.phi_max,
            phi_min: &$raw.phi_min,
        }
    };
}
pub(in crate::scene) use friction_keys;

impl FrictionKeys<'_> {
    /// Whether the preset is this one.
    pub(super) fn preset_is(&self, preset: Preset) -> bool {
        self.preset.as_ref().is_some_and(|p| p.value == preset)
    }
}

/// The values of a preset.
pub(in crate::scene) fn values(preset: Preset) -> (MuI, Grains) {
    let (law, material) = match preset {
        Preset::GlassBeads => (MuI::glass_beads(), Material::glass_beads()),
        Preset::Sand08 => (MuI::sand_08(), Material::sand_08()),
        Preset::Sand04 => (MuI::sand_04(), Material::sand_04()),
    };
    debug_assert_eq!(material.law, Law::MuI(law));
    (law, material.grains)
}

impl Lift<'_> {
    /// mu(I) and grains; `None` where a problem was reported.
    pub(super) fn friction(
        &mut self,
        table: &Place,
        keys: &FrictionKeys<'_>,
    ) -> Option<(MuI, Grains)> {
        let law = self.friction_law(table, keys);
        let grains = self.grains(table, keys);
        let (law, grains) = (law?, grains?);
        let angles = self.check_friction_order(table, keys, &law);
        let fractions = self.check_fraction_order(table, keys, &grains);
        (angles && fractions).then_some((law, grains))
    }

    fn friction_law(&mut self, table: &Place, keys: &FrictionKeys<'_>) -> Option<MuI> {
        let preset = keys.preset.as_ref().map(|p| values(p.value).0);
        let tan = |a: &At<Angle>| a.value.0.tan();
        let mu_s = keys.static_friction_angle.as_ref().map(tan);
        let mu_s = mu_s.or(preset.map(|law| law.mu_s));
        let mu_s = self.parameter(table, keys, "static_friction_angle", mu_s);
        let mu_2 = keys.dynamic_friction_angle.as_ref().map(tan);
        let mu_2 = mu_2.or(preset.map(|law| law.mu_2));
        let mu_2 = self.parameter(table, keys, "dynamic_friction_angle", mu_2);
        let scale = keys.inertial_number_scale.as_ref().map(|v| v.value.0);
        let scale = scale.or(preset.map(|law| law.inertial_number_scale));
        let scale = self.parameter(table, keys, "inertial_number_scale", scale);
        Some(MuI {
            mu_s: mu_s?,
            mu_2: mu_2?,
            inertial_number_scale: scale?,
            mu_inf: keys.high_inertia_friction.as_ref()?.value.0,
        })
    }

    fn grains(&mut self, table: &Place, keys: &FrictionKeys<'_>) -> Option<Grains> {
        let preset = keys.preset.as_ref().map(|p| values(p.value).1);
        let diameter = keys.grain_diameter.as_ref().map(|v| v.value.0);
        let diameter = diameter.or(preset.map(|grains| grains.diameter));
        let diameter = self.parameter(table, keys, "grain_diameter", diameter);
        let density = keys.grain_density.as_ref().map(|v| v.value.0);
        let density = density.or(preset.map(|grains| grains.density));
        let density = self.parameter(table, keys, "grain_density", density);
        // Without a preset: the dense regime of [A], section 2.
        let phi_max = keys.phi_max.as_ref().map(|v| v.value.0);
        let phi_min = keys.phi_min.as_ref().map(|v| v.value.0);
        Some(Grains {
            diameter: diameter?,
            density: density?,
            phi_max: phi_max.or(preset.map(|g| g.phi_max)).unwrap_or(0.6),
            phi_min: phi_min.or(preset.map(|g| g.phi_min)).unwrap_or(0.5),
            pore_density: 0.0,
        })
    }

    /// A parameter that is given, or a preset's; that there is none is reported.
    fn parameter(
        &mut self,
        table: &Place,
        keys: &FrictionKeys<'_>,
        key: &'static str,
        value: Option<f64>,
    ) -> Option<f64> {
        // A parameter or preset that is there but could not be read has been reported.
        let reported = keys.given.contains(&key) || keys.given.contains(&"preset");
        if value.is_none() && !reported {
            self.problems.report(
                &table.child(key),
                "nothing, and no preset",
                "every parameter, or a preset to take the others from",
                format!("add {key}, or preset = \"glass_beads\""),
            );
        }
        value
    }

    /// Friction grows with the shear rate.
    fn check_friction_order(&mut self, table: &Place, keys: &FrictionKeys<'_>, law: &MuI) -> bool {
        let good = law.mu_2 >= law.mu_s;
        if !good {
            let degrees = |mu: f64| format!("{:.4} deg", mu.atan().to_degrees());
            let both = [keys.dynamic_friction_angle, keys.static_friction_angle];
            let place = both.into_iter().flatten().next().map(|at| &at.place);
            self.problems.report(
                place.unwrap_or(table),
                format!(
                    "static_friction_angle {} above dynamic_friction_angle {}",
                    degrees(law.mu_s),
                    degrees(law.mu_2)
                ),
                "a static angle not above the dynamic one",
                "set both angles",
            );
        }
        good
    }

    /// Flowing material is looser.
    fn check_fraction_order(
        &mut self,
        table: &Place,
        keys: &FrictionKeys<'_>,
        grains: &Grains,
    ) -> bool {
        let good = grains.phi_min < grains.phi_max;
        if !good {
            let place = [keys.phi_min, keys.phi_max].into_iter().flatten().next();
            self.problems.report(
                place.map_or(table, |at| &at.place),
                format!("phi_min {} and phi_max {}", grains.phi_min, grains.phi_max),
                "phi_min below phi_max",
                "set both, for example phi_min = 0.5 and phi_max = 0.6",
            );
        }
        good
    }
}
