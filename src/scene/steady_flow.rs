//! Layers that start in steady flow down a slope (`velocity_profile = "bagnold"`).

use crate::material::Bagnold;
use crate::math::{dot, norm, scale};

use super::{Body, Point, Scene, VelocityProfile};

/// A layer that starts in steady flow.
pub(super) struct SteadyFlow {
    profile: Bagnold,
    /// Unit vector down the slope.
    direction: Point,
    /// Bulk density without load, phi rho_s0 [kg/m^3].
    pub(super) loose_density: f64,
    /// Bulk density at rest without load [kg/m^3].
    dense_density: f64,
    /// "Up" and the bed's height along it [m].
    up: Point,
    bed: f64,
}

/// The flow at a place.
pub(super) struct Here {
    /// [m/s].
    pub(super) velocity: Point,
    /// Bulk density [kg/m^3].
    pub(super) density: f64,
    /// [1/s].
    pub(super) shear_rate: f64,
}

impl SteadyFlow {
    /// Velocity, density and shear rate at a place, for the material's artificial sound speed c0 [m/s].
    // A call of its own: inlined, its powers are taken before the loop over particles, also of what a body at rest does
    // not have. Nobody uses them, but Valgrind (tests/it/shared_library.rs) tells of numbers that are not there.
    #[inline(never)]
    pub(super) fn at(&self, x: &Point, c0: f64) -> Here {
        let height = dot(&self.up, x) - self.bed;
        // K_t p with K_t = 1/(rho_max c0^2).
        let compression = self.profile.pressure(height) / (self.dense_density * c0 * c0);
        Here {
            velocity: scale(self.profile.speed(height), &self.direction),
            density: self.loose_density * (1.0 + compression),
            shear_rate: self.profile.shear_rate(height),
        }
    }
}

/// Bagnold's flow of a body that asks for it; the bed is its lower side.
pub(super) fn steady_flow(scene: &Scene, body: &Body) -> Option<SteadyFlow> {
    if body.profile != VelocityProfile::Bagnold {
        return None;
    }
    let material = &scene.materials[body.material].material;
    let (up, gravity) = (scene.up(), scene.domain.gravity);
    let across = -dot(&up, &gravity);
    let in_bed: Point = std::array::from_fn(|k| gravity[k] + across * up[k]);
    let along = norm(&in_bed);
    let (lower, upper) = body.shape.bounds();
    let (a, b) = (dot(&up, &lower), dot(&up, &upper));
    let (bed, top) = (a.min(b), a.max(b));
    let top = body.level.map_or(top, |level| level.min(top));
    let profile = Bagnold::new(material, top - bed, across, along)?;
    Some(SteadyFlow {
        loose_density: profile.phi * material.grains.density,
        dense_density: material.rest_density(),
        profile,
        direction: scale(1.0 / along, &in_bed),
        up,
        bed,
    })
}
