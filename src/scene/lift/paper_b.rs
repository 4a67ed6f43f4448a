//! Scheme `paper_b`: its numbers, and what of a scene it supports.

use super::Lift;
use super::scheme::{REMEDY, motion};
use crate::material::Law;
use crate::scene::raw::{RawNumerics, SlipWord};
use crate::scene::types::NamedMaterial;
use crate::solver::PaperB;

/// What scheme `paper_b` supports, for messages.
const SUPPORTED: &str = "with scheme = \"paper_b\": bodies of fluids and of materials with constant friction, without bulk friction, and \
                         fixed walls with free slip or without slip";

/// What is called low, a yield stress below 100 Pa and no friction ([B] Table 2) [Pa].
const LOW_YIELD_STRESS: f64 = 100.0;

/// K_R and m as given, or those of [B] Table 2: of its ranges the values that its text calls good.
pub(super) fn paper_b(raw: &RawNumerics, materials: &[Option<NamedMaterial>]) -> PaperB {
    let materials: Vec<_> = materials.iter().flatten().map(|m| &m.material).collect();
    let low = materials
        .iter()
        .all(|m| m.is_fluid() && m.cohesion < LOW_YIELD_STRESS);
    let relaxation_factor = match (materials.len(), low) {
        (0 | 1, true) => 1.0,
        (0 | 1, false) => 0.05,
        _ => 0.01,
    };
    let given = |at: Option<f64>, other: f64| at.unwrap_or(other);
    PaperB {
        relaxation_factor: given(
            raw.relaxation_factor.as_ref().map(|at| at.value.0),
            relaxation_factor,
        ),
        stiffening_time: given(
            raw.stiffening_time.as_ref().map(|at| at.value.0),
            if low { 0.1 } else { 0.01 },
        ),
    }
}

impl Lift<'_> {
    /// Devices, walls and materials that the scheme has no equations for.
    pub(super) fn check_paper_b(&mut self, materials: &[Option<NamedMaterial>]) {
        let raw = self.raw;
        let entries = raw.materials.iter().flat_map(|s| &s.value.0);
        for (entry, named) in entries.zip(materials) {
            let Some(NamedMaterial { material, .. }) = named else {
                continue;
            };
            let unsupported = [
                (
                    material.bulk_friction > 0.0,
                    "a material with bulk_friction",
                ),
                (
                    !matches!(material.law, Law::ConstantFriction(_) | Law::Fluid),
                    "a material whose friction depends on the inertial number",
                ),
            ];
            for (_, what) in unsupported.into_iter().filter(|(found, _)| *found) {
                self.problems.report(&entry.place, what, SUPPORTED, REMEDY);
            }
        }
        self.refuse_devices(SUPPORTED);
        for (entry, wall) in Self::readable(raw.walls.as_ref()) {
            let rubs = wall
                .slip
                .as_ref()
                .is_some_and(|s| s.value == SlipWord::Friction);
            let what = if rubs {
                Some("a wall with friction")
            } else {
                motion(wall)
            };
            if let Some(what) = what {
                self.problems.report(&entry.place, what, SUPPORTED, REMEDY);
            }
        }
    }
}
