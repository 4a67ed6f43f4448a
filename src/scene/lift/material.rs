//! Materials. To add a law: a table in `raw/materials.rs`, a line in its `RawMaterial`, a function here or in `friction`.

use super::Lift;
use super::friction::{FrictionKeys, friction_keys};
use crate::material::{
    AngleMatch, BarkerGray, ConstantFriction, FLUID_PACKING, Friction as _, Grains, Law, Material,
    SAND_LAYER_FACTOR, Viscous,
};
use crate::scene::raw::{
    AngleMatchWord, At, FluidPreset, Length, Place, Preset, Pressure, Ratio, RawBarkerGray,
    RawConstantFriction, RawFluid, RawMaterial, RawMuI, Speed, Text,
};
use crate::scene::types::NamedMaterial;

/// The keys that all materials with friction have.
struct CommonKeys<'a> {
    cohesion: &'a Option<At<Pressure>>,
    bulk_friction: &'a Option<At<Ratio>>,
    parted_density: &'a Option<At<Ratio>>,
    pore_fluid: &'a Option<At<Text>>,
    sound_speed: &'a Option<At<Speed>>,
}

macro_rules! common_keys {
    ($raw:ident) => {
        CommonKeys {
            cohesion: &$raw.cohesion,
            bulk_friction: &$raw.bulk_friction,
            parted_density: &$raw.parted_density,
            pore_fluid: &$raw.pore_fluid,
            sound_speed: &$raw.sound_speed,
        }
    };
}

const FLUID_NAME: &str = "the name of a material with law = \"fluid\"";
const ADD_FLUID: &str =
    "add for example [materials.water] with law = \"fluid\" and preset = \"water\"";

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
                Some(RawMaterial::Fluid(raw)) => self.fluid(&entry.place, raw),
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
        let law = match (&raw.layer_depth, &raw.layer_factor) {
            (Some(depth), _) => law.of_layer(self.layer_shift(depth, raw, &keys, &grains)?),
            (None, Some(factor)) => {
                self.problems.report(
                    &factor.place,
                    "a layer_factor without layer_depth",
                    "both, or layer_depth alone",
                    "add layer_depth, the depth of the thin layer, or leave layer_factor out",
                );
                return None;
            }
            (None, None) => law,
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
            AngleMatchWord::Cone => AngleMatch::Cone,
        };
        let (phi_min, phi_max) = FLUID_PACKING;
        let grains = Grains {
            diameter: 0.0,
            density: raw.density.as_ref()?.value.0 / phi_max,
            phi_max,
            phi_min,
            pore_density: 0.0,
        };
        let law = Law::ConstantFriction(ConstantFriction::of_angle(angle, kind));
        let material = self.material(grains, law, &common_keys!(raw))?;
        // Its density is the whole one, with what fills the pores: the grains' own follows.
        let pore_density = material.grains.pore_density;
        let density = (raw.density.as_ref()?.value.0 - (1.0 - phi_max) * pore_density) / phi_max;
        if density <= pore_density {
            self.problems.report(
                &raw.density.as_ref()?.place,
                format!("{} kg/m^3, saturated", raw.density.as_ref()?.value.0),
                format!("more than that of its pore fluid, {pore_density} kg/m^3"),
                "give the density of grains and pore fluid together",
            );
            return None;
        }
        Some(Material {
            cohesion: ConstantFriction::cohesion_of(material.cohesion, angle, kind),
            viscous: Viscous {
                consistency: raw.consistency.as_ref()?.value.0,
                flow_index: raw.flow_index.as_ref()?.value.0,
            },
            grains: Grains {
                density,
                ..material.grains
            },
            ..material
        })
    }

    /// tau_0 + K gamma^n.
    fn fluid(&mut self, table: &Place, raw: &RawFluid) -> Option<Material> {
        let (density, viscous, yield_stress) = self.fluid_values(table, raw)?;
        Some(Material {
            sound_speed: raw.sound_speed.as_ref().map(|at| at.value.0),
            parted_density: raw.parted_density.as_ref()?.value.0,
            artificial_viscosity: raw.artificial_viscosity.as_ref()?.value.0,
            ..Material::fluid(density, viscous, yield_stress)
        })
    }

    /// Density, viscous stress and yield stress, from a preset and what a scene overrides.
    fn fluid_values(&mut self, table: &Place, raw: &RawFluid) -> Option<(f64, Viscous, f64)> {
        let preset = fluid_preset(raw);
        let reported = |key| raw.given.contains(&key) || raw.given.contains(&"preset");
        let density = raw.density.as_ref().map(|v| v.value.0);
        let consistency = raw.consistency.as_ref().map(|v| v.value.0);
        let missing = [("density", density), ("consistency", consistency)];
        for (key, value) in missing {
            if value.is_none() && preset.is_none() && !reported(key) {
                self.problems.report(
                    &table.child(key),
                    "nothing, and no preset",
                    "density and consistency, or a preset to take them from",
                    format!("add {key}, or preset = \"water\""),
                );
            }
        }
        let index = raw.flow_index.as_ref().map(|v| v.value.0);
        let yield_stress = raw.yield_stress.as_ref().map(|v| v.value.0);
        Some((
            density.or(preset.map(|p| p.0))?,
            Viscous {
                consistency: consistency.or(preset.map(|p| p.1.consistency))?,
                flow_index: index.or(preset.map(|p| p.1.flow_index)).unwrap_or(1.0),
            },
            yield_stress.or(preset.map(|p| p.2)).unwrap_or(0.0),
        ))
    }

    /// Density of the fluid that fills a material's pores [kg/m^3]; 0 for dry material, `None` where a problem was reported.
    fn pore_density(&mut self, name: &Option<At<Text>>) -> Option<f64> {
        let Some(name) = name else {
            return Some(0.0);
        };
        let entries = &self.raw.materials.as_ref()?.value.0;
        let Some(entry) = entries.iter().find(|e| e.name == name.value.0) else {
            let fluids = entries
                .iter()
                .filter(|e| matches!(e.value, Some(RawMaterial::Fluid(_))));
            let known: Vec<_> = fluids.map(|e| e.name.as_str()).collect();
            let (allowed, remedy) = if known.is_empty() {
                (FLUID_NAME.to_owned(), ADD_FLUID)
            } else {
                (
                    format!("{FLUID_NAME}: {}", known.join(", ")),
                    "choose one of these",
                )
            };
            let found = format!("unknown name {}", crate::units::quote(&name.value.0));
            self.problems.report(&name.place, found, allowed, remedy);
            return None;
        };
        match &entry.value {
            // What is missing there is reported there.
            Some(RawMaterial::Fluid(fluid)) => {
                let given = fluid.density.as_ref().map(|v| v.value.0);
                given.or(fluid_preset(fluid).map(|p| p.0))
            }
            Some(_) => {
                self.problems.report(
                    &name.place,
                    format!("{}, which is no fluid", crate::units::quote(&name.value.0)),
                    FLUID_NAME,
                    ADD_FLUID,
                );
                None
            }
            None => None,
        }
    }

    /// Reports what a pore fluid means nothing for.
    fn pores_make_sense(
        &mut self,
        name: &At<Text>,
        law: &Law,
        grains: f64,
        pores: f64,
    ) -> Option<()> {
        let (found, allowed, remedy) = if law.static_friction() == 0.0 {
            (
                "a pore fluid in a material without friction".to_owned(),
                "in one with friction, which is made of the pressure that the fluid does not carry"
                    .to_owned(),
                "give a friction angle, or leave pore_fluid out: its density is that of the whole",
            )
        } else if grains <= pores {
            (
                format!("grains of {grains} kg/m^3 in a fluid of {pores} kg/m^3"),
                "grains heavier than their pore fluid".to_owned(),
                "correct the densities",
            )
        } else {
            return Some(());
        };
        self.problems.report(&name.place, found, allowed, remedy);
        None
    }

    fn material(&mut self, grains: Grains, law: Law, keys: &CommonKeys<'_>) -> Option<Material> {
        let parted = keys.parted_density.as_ref()?;
        let touching = grains.phi_min / grains.phi_max;
        if parted.value.0 >= touching {
            self.problems.report(
                &parted.place,
                format!("parted_density {}", parted.value.0),
                format!("below {touching:.4}, where grains touch (phi_min over phi_max)"),
                format!("lower it, for example to {:.4}", 0.6 * touching),
            );
            return None;
        }
        let pore_density = self.pore_density(keys.pore_fluid)?;
        if let Some(name) = keys.pore_fluid {
            self.pores_make_sense(name, &law, grains.density, pore_density)?;
        }
        Some(Material {
            grains: Grains {
                pore_density,
                ..grains
            },
            law,
            viscous: Viscous::NONE,
            artificial_viscosity: 0.0,
            sound_speed: keys.sound_speed.as_ref().map(|at| at.value.0),
            cohesion: keys.cohesion.as_ref()?.value.0,
            bulk_friction: keys.bulk_friction.as_ref()?.value.0,
            parted_density: parted.value.0,
        })
    }
}

/// Density [kg/m^3], viscous stress and yield stress [Pa] of a preset.
pub(in crate::scene) fn fluid_preset(raw: &RawFluid) -> Option<(f64, Viscous, f64)> {
    let preset = raw.preset.as_ref()?.value;
    Some(match preset {
        FluidPreset::Water => (1000.0, Viscous::newtonian(1e-3), 0.0),
        FluidPreset::Clay => {
            let viscous = Viscous {
                consistency: 4.472,
                flow_index: 0.472,
            };
            (1540.0, viscous, 30.0)
        }
    })
}
