//! Materials. To add a law: a table in `raw/sections.rs`, a line in its `RawMaterial`, a function here.

use super::Lift;
use crate::material::{Grains, Law, Material, MuI};
use crate::scene::raw::{At, Place, Preset, RawMaterial, RawMuI};
use crate::scene::types::NamedMaterial;

impl Lift<'_> {
    /// One for each `[materials.NAME]`, in order; `None` where a problem was reported.
    pub(super) fn materials(&mut self) -> Vec<Option<NamedMaterial>> {
        let entries = self.raw.materials.as_ref().map(|m| &m.value.0);
        let mut lifted = Vec::new();
        for entry in entries.into_iter().flatten() {
            let material = match &entry.value {
                Some(RawMaterial::MuI(raw)) => self.mu_i(&entry.place, raw),
                None => None,
            };
            lifted.push(material.map(|material| NamedMaterial {
                name: entry.name.clone(),
                material,
            }));
        }
        if let (true, Some(at)) = (lifted.is_empty(), &self.raw.materials) {
            self.problems.report(
                &at.place,
                "no material",
                "at least one [materials.NAME]",
                "add one, for example [materials.sand] with law = \"mu_i\" and preset = \"sand_04\"",
            );
        }
        lifted
    }

    fn mu_i(&mut self, table: &Place, raw: &RawMuI) -> Option<Material> {
        let preset = raw.preset.as_ref().map(|p| match p.value {
            Preset::GlassBeads => Material::glass_beads(),
            Preset::Sand08 => Material::sand_08(),
            Preset::Sand04 => Material::sand_04(),
        });
        let mut value = |key: &'static str, given: Option<f64>, from: Option<f64>| {
            let value = given.or(from);
            // A parameter or preset that is there but could not be read has been reported.
            let reported = raw.given.contains(&key) || raw.given.contains(&"preset");
            if value.is_none() && !reported {
                self.report_missing_parameter(table, key);
            }
            value
        };
        let p = preset.as_ref().map(|p| &p.grains);
        let law = preset.as_ref().map(|p| match p.law {
            Law::MuI(law) => law,
            _ => MuI::sand_04(),
        });
        let tan = |a: &At<crate::scene::raw::Angle>| a.value.0.tan();
        let mu_s = value(
            "static_friction_angle",
            raw.static_friction_angle.as_ref().map(tan),
            law.map(|law| law.mu_s),
        );
        let mu_2 = value(
            "dynamic_friction_angle",
            raw.dynamic_friction_angle.as_ref().map(tan),
            law.map(|law| law.mu_2),
        );
        let inertial_number_scale = value(
            "inertial_number_scale",
            raw.inertial_number_scale.as_ref().map(|v| v.value.0),
            law.map(|law| law.inertial_number_scale),
        );
        let grain_diameter = value(
            "grain_diameter",
            raw.grain_diameter.as_ref().map(|v| v.value.0),
            p.map(|p| p.diameter),
        );
        let grain_density = value(
            "grain_density",
            raw.grain_density.as_ref().map(|v| v.value.0),
            p.map(|p| p.density),
        );
        // Without a preset: the dense regime of [A], section 2.
        let phi_max = raw.phi_max.as_ref().map(|v| v.value.0);
        let phi_min = raw.phi_min.as_ref().map(|v| v.value.0);
        let law = MuI {
            mu_s: mu_s?,
            mu_2: mu_2?,
            inertial_number_scale: inertial_number_scale?,
            mu_inf: 0.0,
        };
        let grains = Grains {
            diameter: grain_diameter?,
            density: grain_density?,
            phi_max: phi_max.or(p.map(|p| p.phi_max)).unwrap_or(0.6),
            phi_min: phi_min.or(p.map(|p| p.phi_min)).unwrap_or(0.5),
        };
        let angles = self.check_friction_order(table, raw, &law);
        let fractions = self.check_fraction_order(table, raw, &grains);
        (angles && fractions).then_some(Material {
            grains,
            law: Law::MuI(law),
            cohesion: 0.0,
            bulk_friction: 0.0,
            parted_density: crate::material::PARTED_DENSITY,
        })
    }

    fn report_missing_parameter(&mut self, table: &Place, key: &str) {
        self.problems.report(
            &table.child(key),
            "nothing, and no preset",
            "every parameter, or a preset to take the others from",
            format!("add {key}, or preset = \"glass_beads\""),
        );
    }

    /// Friction grows with the shear rate.
    fn check_friction_order(&mut self, table: &Place, raw: &RawMuI, material: &MuI) -> bool {
        let good = material.mu_2 >= material.mu_s;
        if !good {
            let degrees = |mu: f64| format!("{:.4} deg", mu.atan().to_degrees());
            let both = [&raw.dynamic_friction_angle, &raw.static_friction_angle];
            let place = both.into_iter().flatten().next().map(|at| &at.place);
            self.problems.report(
                place.unwrap_or(table),
                format!(
                    "static_friction_angle {} above dynamic_friction_angle {}",
                    degrees(material.mu_s),
                    degrees(material.mu_2)
                ),
                "a static angle not above the dynamic one",
                "set both angles",
            );
        }
        good
    }

    /// Flowing material is looser.
    fn check_fraction_order(&mut self, table: &Place, raw: &RawMuI, material: &Grains) -> bool {
        let good = material.phi_min < material.phi_max;
        if !good {
            let place = [&raw.phi_min, &raw.phi_max].into_iter().flatten().next();
            self.problems.report(
                place.map_or(table, |at| &at.place),
                format!(
                    "phi_min {} and phi_max {}",
                    material.phi_min, material.phi_max
                ),
                "phi_min below phi_max",
                "set both, for example phi_min = 0.5 and phi_max = 0.6",
            );
        }
        good
    }
}
