//! Materials. To add a law: a table in `raw/sections.rs`, a line in its `RawMaterial`, a function here or in `friction`.

use super::Lift;
use super::friction::{FrictionKeys, friction_keys};
use crate::material::{
    AngleMatch, BarkerGray, ConstantFriction, Grains, Law, Material, SAND_LAYER_FACTOR,
};
use crate::scene::raw::{
    AngleMatchWord, At, Length, Place, Preset, Pressure, Ratio, RawBarkerGray, RawConstantFriction,
    RawMaterial, RawMuI,
};
use crate::scene::types::NamedMaterial;

/// Packing of a material whose grains a scene does not state: only says at which density it parts, phi_min/phi_max.
const PHI: (f64, f64) = (0.5, 0.6);

/// The keys that all materials have.
struct CommonKeys<'a> {
    cohesion: &'a Option<At<Pressure>>,
    bulk_friction: &'a Option<At<Ratio>>,
    parted_density: &'a Option<At<Ratio>>,
}

macro_rules! common_keys {
    ($raw:ident) => {
        CommonKeys {
            cohesion: &$raw.cohesion,
            bulk_friction: &$raw.bulk_friction,
            parted_density: &$raw.parted_density,
        }
    };
}

impl Lift<'_> {
    /// One for each `[materials.NAME]`, in order; `None` where a problem was reported.
    pub(super) fn materials(&mut self) -> Vec<Option<NamedMaterial>> {
        let entries = self.raw.materials.as_ref().map(|m| &m.value.0);
        let mut lifted = Vec::new();
        for entry in entries.into_iter().flatten() {
            let material = match &entry.value {
                Some(RawMaterial::MuI(raw)) => self.mu_i(&entry.place, raw),
                Some(RawMaterial::BarkerGray(raw)) => self.barker_gray(&entry.place, raw),
                Some(RawMaterial::ConstantFriction(raw)) => {
                    self.constant_friction(&entry.place, raw)
                }
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
        let keys = friction_keys!(raw);
        let (law, grains) = self.friction(table, &keys)?;
        let law = match &raw.layer_depth {
            Some(depth) => law.of_layer(self.layer_shift(depth, raw, &keys, &grains)?),
            None => law,
        };
        self.material(grains, Law::MuI(law), &common_keys!(raw))
    }

    /// s = factor d/H of (A.18).
    fn layer_shift(
        &mut self,
        depth: &At<Length>,
        raw: &RawMuI,
        keys: &FrictionKeys<'_>,
        grains: &Grains,
    ) -> Option<f64> {
        let beads = keys.preset_is(Preset::GlassBeads);
        if raw.layer_factor.is_none() && beads {
            self.problems.report(
                &depth.place,
                "a layer depth for glass beads",
                "a layer depth for sand: measured glass beads need no correction (gamma = 0)",
                "leave layer_depth out, or give a layer_factor",
            );
            return None;
        }
        let factor = raw.layer_factor.as_ref();
        let factor = factor.map_or(SAND_LAYER_FACTOR, |at| at.value.0);
        Some(factor * grains.diameter / depth.value.0)
    }

    fn barker_gray(&mut self, table: &Place, raw: &RawBarkerGray) -> Option<Material> {
        let (law, grains) = self.friction(table, &friction_keys!(raw))?;
        let Some(made) = BarkerGray::new(law) else {
            self.problems.report(
                table,
                format!(
                    "mu_s {:.4}, mu_2 {:.4} and I0 {}: ill-posed at every inertial number",
                    law.mu_s, law.mu_2, law.inertial_number_scale
                ),
                "a mu(I) with a well-posed range to join at",
                "raise dynamic_friction_angle, or use law = \"mu_i\"",
            );
            return None;
        };
        self.material(grains, Law::BarkerGray(made), &common_keys!(raw))
    }

    fn constant_friction(&mut self, _: &Place, raw: &RawConstantFriction) -> Option<Material> {
        let angle = raw.friction_angle.as_ref()?.value.0;
        let kind = match raw.r#match.as_ref()?.value {
            AngleMatchWord::PlaneStrain => AngleMatch::PlaneStrain,
            AngleMatchWord::SimpleShear => AngleMatch::SimpleShear,
        };
        let (phi_min, phi_max) = PHI;
        let grains = Grains {
            diameter: 0.0,
            density: raw.density.as_ref()?.value.0 / phi_max,
            phi_max,
            phi_min,
        };
        let law = Law::ConstantFriction(ConstantFriction::of_angle(angle, kind));
        let material = self.material(grains, law, &common_keys!(raw))?;
        Some(Material {
            cohesion: ConstantFriction::cohesion_of(material.cohesion, angle, kind),
            ..material
        })
    }

    fn material(&mut self, grains: Grains, law: Law, keys: &CommonKeys<'_>) -> Option<Material> {
        let parted = keys.parted_density.as_ref()?;
        let touching = grains.phi_min / grains.phi_max;
        if parted.value.0 >= touching {
            self.problems.report(
                &parted.place,
                format!("parted_density {}", parted.value.0),
                format!("below {touching:.4}, where grains touch (phi_min over phi_max)"),
                "lower it, for example to 0.5",
            );
            return None;
        }
        Some(Material {
            grains,
            law,
            cohesion: keys.cohesion.as_ref()?.value.0,
            bulk_friction: keys.bulk_friction.as_ref()?.value.0,
            parted_density: parted.value.0,
        })
    }
}
