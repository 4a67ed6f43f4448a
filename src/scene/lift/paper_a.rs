//! Scheme `paper_a`: its keys, and what of a scene it supports.

use super::{Lift, cross_product, dot, length};
use crate::material::Friction;
use crate::scene::raw::{At, Place, RawNumerics, RawWall, SchemeWord, SlipWord};
use crate::scene::types::NamedMaterial;
use crate::solver::{PaperA, Scheme};

/// What scheme `paper_a` supports, for messages.
const SUPPORTED: &str = "with scheme = \"paper_a\": bodies without bulk friction, and fixed walls without slip that are planes, straight \
                         polylines or polylines with inner corners only";
const REMEDY: &str = "delete it, or choose scheme = \"implicit\"";

/// A key and where it stands; keys that were left out hold their default.
type Key<'r> = (&'static str, Option<&'r Place>);

/// Keys of [numerics] that only the default scheme uses.
fn default_only(raw: &RawNumerics) -> Vec<Key<'_>> {
    vec![
        ("yield", place(&raw.r#yield)),
        ("yield_iterations", place(&raw.yield_iterations)),
        ("cap_time", place(&raw.cap_time)),
        ("density_diffusion", place(&raw.density_diffusion)),
        ("diffusion_gate_time", place(&raw.diffusion_gate_time)),
        ("strain_relaxation_time", place(&raw.strain_relaxation_time)),
        ("pair_viscosity_share", place(&raw.pair_viscosity_share)),
        ("solver_tolerance", place(&raw.solver_tolerance)),
        ("solver_max_iterations", place(&raw.solver_max_iterations)),
    ]
}

/// Keys of [numerics] that only scheme `paper_a` uses.
fn paper_only(raw: &RawNumerics) -> Vec<Key<'_>> {
    vec![
        ("reference_yield_stress", place(&raw.reference_yield_stress)),
        ("scaling_time", place(&raw.scaling_time)),
        ("ghost_velocity_factor", place(&raw.ghost_velocity_factor)),
    ]
}

fn place<T>(at: &Option<At<T>>) -> Option<&Place> {
    at.as_ref().map(|at| &at.place)
}

impl Lift<'_> {
    /// The scheme with its own keys; reports keys that it does not use.
    pub(super) fn scheme(
        &mut self,
        raw: &RawNumerics,
        table: &Place,
        materials: &[Option<NamedMaterial>],
    ) -> Option<Scheme> {
        let word = raw.scheme.as_ref()?.value;
        let (unused, other) = match word {
            SchemeWord::Implicit => (paper_only(raw), "paper_a"),
            SchemeWord::PaperA => (default_only(raw), "implicit"),
        };
        for (key, place) in unused {
            if let Some(place) = place.filter(|_| raw.given.contains(&key)) {
                self.problems.report(
                    place,
                    format!("{key}, which this scheme does not use"),
                    format!("{key} only with scheme = \"{other}\""),
                    "delete it, or choose the other scheme",
                );
            }
        }
        match word {
            SchemeWord::Implicit => Some(Scheme::Implicit),
            SchemeWord::PaperA => {
                if self.axisymmetric() {
                    self.problems.report(
                        &raw.scheme.as_ref()?.place,
                        "\"paper_a\" in an axisymmetric scene",
                        "\"implicit\", the only scheme that knows hoop strain",
                        "leave scheme out, or set dimension = 2",
                    );
                }
                self.check_paper_a(materials);
                self.paper_a(raw, table, materials).map(Scheme::PaperA)
            }
        }
    }

    fn paper_a(
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
        self.problems.report(
            &table.child("reference_yield_stress"),
            "nothing, and no weight of material that it follows from",
            "the largest yield stress that is expected",
            "add it, for example \"500 Pa\"",
        );
        None
    }

    /// Devices and walls that the scheme has no equations for.
    fn check_paper_a(&mut self, materials: &[Option<NamedMaterial>]) {
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
        let gates = raw
            .gates
            .iter()
            .flat_map(|s| s.value.0.iter().map(|e| &e.place));
        let inflows = raw
            .inflows
            .iter()
            .flat_map(|s| s.value.0.iter().map(|e| &e.place));
        let outflows = raw
            .outflows
            .iter()
            .flat_map(|s| s.value.0.iter().map(|e| &e.place));
        let devices = gates.map(|p| (p, "a gate"));
        let devices = devices.chain(inflows.map(|p| (p, "an inflow")));
        let devices = devices.chain(outflows.map(|p| (p, "an outflow")));
        for (place, what) in devices.collect::<Vec<_>>() {
            self.problems.report(place, what, SUPPORTED, REMEDY);
        }
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
        let moves = |v: &Vec<f64>| v.iter().any(|c| *c != 0.0);
        if wall
            .velocity
            .as_ref()
            .is_some_and(|v| moves(&v.value.values))
        {
            return Some("a wall that moves");
        }
        if wall.angular_velocity.is_some() {
            return Some("a wall that turns");
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
            let (s, t) = (super::minus(b, a), super::minus(c, b));
            // The material is on the left: a turn to the right is a corner that stands out into it.
            let right = cross_product(s, t)[2] < -1e-9 * length(s) * length(t);
            let back =
                dot(s, t) < 0.0 && cross_product(s, t)[2].abs() <= 1e-9 * length(s) * length(t);
            (right || back).then_some("a corner that stands out into the material")
        })
    }
}
