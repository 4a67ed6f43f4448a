//! Scheme `paper_a`: its numbers, and what of a scene it supports.

use super::Lift;
use super::scheme::{REMEDY, motion};
use crate::material::Friction;
use crate::math::{cross, dot, length, sub};
use crate::scene::raw::{Place, RawNumerics, RawWall, SlipWord, SweepsWord};
use crate::scene::types::NamedMaterial;
use crate::solver::{PaperA, Sweeps};

/// What scheme `paper_a` supports, for messages.
const SUPPORTED: &str = "with scheme = \"paper_a\": bodies without bulk friction, and fixed walls without slip that are planes, straight \
                         polylines or polylines with inner corners only";
impl Lift<'_> {
    pub(super) fn paper_a(
        &mut self,
        raw: &RawNumerics,
        table: &Place,
        materials: &[Option<NamedMaterial>],
    ) -> Option<PaperA> {
        let reference = match &raw.reference_yield_stress {
            Some(given) => given.value.0,
            None if raw.given.contains(&"reference_yield_stress") => return None,
            None => self.deepest_yield_stress(table, materials)?,
        };
        Some(PaperA {
            reference_yield_stress: reference,
            scaling_time: raw.scaling_time.as_ref()?.value.0,
            ghost_velocity_factor: raw.ghost_velocity_factor.as_ref()?.value.0,
            sweeps: match raw.sweeps.as_ref()?.value {
                SweepsWord::Lanes => Sweeps::Lanes,
                SweepsWord::Plain => Sweeps::Plain,
            },
        })
    }

    /// mu_s rho g H of the deepest material at rest.
    fn deepest_yield_stress(
        &mut self,
        table: &Place,
        materials: &[Option<NamedMaterial>],
    ) -> Option<f64> {
        let strongest = materials
            .iter()
            .flatten()
            .map(|m| m.material.law.static_friction() * m.material.rest_density())
            .fold(0.0, f64::max);
        let stress = strongest * self.gravity_size() * self.material_height()?;
        if stress > 0.0 {
            return Some(stress);
        }
        // A material that could not be read has been reported, and may be the strong one.
        if materials.iter().any(Option::is_none) {
            return None;
        }
        self.problems.report(
            &table.child("reference_yield_stress"),
            "nothing, and no weight of material that it follows from",
            "the largest yield stress that is expected",
            "add it, for example \"500 Pa\"",
        );
        None
    }

    /// Devices and walls that the scheme has no equations for.
    pub(super) fn check_paper_a(&mut self, materials: &[Option<NamedMaterial>]) {
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
                (material.is_fluid(), "a fluid"),
                (material.is_saturated(), "a saturated material"),
                (
                    material.viscous.consistency > 0.0,
                    "a material with viscosity",
                ),
            ];
            for (_, what) in unsupported.into_iter().filter(|(found, _)| *found) {
                self.problems.report(&entry.place, what, SUPPORTED, REMEDY);
            }
        }
        self.refuse_devices(SUPPORTED);
        for (entry, wall) in Self::readable(raw.walls.as_ref()) {
            if let Some(what) = self.unsupported(wall) {
                self.problems.report(&entry.place, what, SUPPORTED, REMEDY);
            }
        }
    }

    /// What a wall has that ghosts cannot do.
    fn unsupported(&self, wall: &RawWall) -> Option<&'static str> {
        if wall
            .slip
            .as_ref()
            .is_some_and(|s| s.value != SlipWord::NoSlip)
        {
            return Some("a wall with free slip or friction");
        }
        if wall.r#box.is_some() {
            return Some("a box, whose corners stand out into the material");
        }
        if let Some(moving) = motion(wall) {
            return Some(moving);
        }
        let corners: Vec<&Vec<f64>> = match &wall.polyline {
            Some(line) => line.value.0.iter().map(|c| &c.value.values).collect(),
            None => return None,
        };
        let closed = wall.closed.as_ref().is_some_and(|c| c.value.0);
        let turns = if closed {
            corners.len()
        } else {
            corners.len().saturating_sub(2)
        };
        let point = |i: usize| -> Option<[f64; 3]> {
            let corner = corners.get(i % corners.len())?;
            Some([*corner.first()?, *corner.get(1)?, 0.0])
        };
        (0..turns).find_map(|i| {
            let (a, b, c) = (point(i)?, point(i + 1)?, point(i + 2)?);
            let (s, t) = (sub(&b, &a), sub(&c, &b));
            // The material is on the left: a turn to the right is a corner that stands out into it.
            let right = cross(&s, &t)[2] < -1e-9 * length(&s) * length(&t);
            let back =
                dot(&s, &t) < 0.0 && cross(&s, &t)[2].abs() <= 1e-9 * length(&s) * length(&t);
            (right || back).then_some("a corner that stands out into the material")
        })
    }
}
