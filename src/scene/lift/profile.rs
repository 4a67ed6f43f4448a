//! Layers that start in steady flow down a slope.

use super::Lift;
use crate::material::{Bagnold, Friction, Material};
use crate::math::dot;
use crate::scene::types::{Body, NamedMaterial, VelocityProfile};

impl Lift<'_> {
    /// Bagnold's profile needs a box, a bed along an axis and a slope between the friction angles of mu(0) and of fast flow.
    pub(super) fn check_velocity_profiles(
        &mut self,
        materials: &[Option<NamedMaterial>],
        bodies: &[Body],
    ) {
        for (entry, raw) in Self::readable(self.raw.bodies.as_ref()) {
            let Some(at) = &raw.velocity_profile else {
                continue;
            };
            let body = bodies.iter().find(|b| b.name == entry.name);
            let Some(body) = body.filter(|b| b.profile == VelocityProfile::Bagnold) else {
                continue;
            };
            if !matches!(body.shape, crate::shape::Shape::Box { .. }) {
                self.problems.report(
                    &at.place,
                    "a profile of a body that is no box",
                    "velocity_profile only for a box: a layer of one depth",
                    "use a box, or delete it",
                );
                continue;
            }
            if body.rotation.is_some() {
                self.problems.report(
                    &at.place,
                    "a profile of a body that turns",
                    "velocity_profile or angular_velocity",
                    "delete one of them",
                );
                continue;
            }
            let Some(Some(named)) = materials.get(body.material) else {
                continue;
            };
            let material = &named.material;
            let gravity = self.domain.as_ref().map_or([0.0; 3], |d| d.gravity);
            let across = -dot(&self.up(), &gravity);
            let along = (dot(&gravity, &gravity) - across * across).max(0.0).sqrt();
            if across > 0.0 && Bagnold::new(material, 1.0, across, along).is_some() {
                continue;
            }
            self.problems.report(
                &at.place,
                unsteady(material, across, along),
                format!(
                    "a slope steeper than the angle of rest of {}, {}, at which its friction balances the weight; no cohesion and no pore_fluid",
                    named.name,
                    degrees(material.law.friction(0.0)),
                ),
                "correct the material, domain.slope or domain.gravity, or delete velocity_profile",
            );
        }
    }
}

/// Why a layer has no steady flow, under gravity across the bed and along it [m/s^2].
fn unsteady(material: &Material, across: f64, along: f64) -> String {
    if material.is_saturated() {
        "grains with a pore_fluid".to_owned()
    } else if material.cohesion != 0.0 {
        "grains with cohesion".to_owned()
    } else if across > 0.0 {
        format!("a slope of {}", degrees(along / across))
    } else {
        "no gravity".to_owned()
    }
}

fn degrees(tan: f64) -> String {
    format!("{:.2} deg", tan.atan().to_degrees())
}
