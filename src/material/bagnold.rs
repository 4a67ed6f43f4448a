//! Steady flow of a layer down a plane: Bagnold's profile for friction mu(I) ([A] eq. 56, with powers of 3/2 for the
//! printed squares).
//!
//! Symbols: y height over the bed, H depth of the layer, g_n gravity across it, tan = tangent of the slope.
//! tau/p = tan at every height, so mu(I) = tan gives one I, and A.8 one phi (for mu(I) of [A]: I = I0 (tan - mu_s)/(mu_2 - tan)),
//! p = phi rho_s0 g_n (H - y),  dv/dy = (I/d) sqrt(p/rho_s0),
//! v = (2/3) (I/d) sqrt(phi g_n) (H^(3/2) - (H - y)^(3/2)).
//! In the plane the grains' compression x changes none of these (d sqrt(rho_s) does not depend on it), only rho = x phi rho_s0.

use super::{Friction, Grains, Material};

/// A layer in steady flow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bagnold {
    /// Inertial number, the same at every height [1].
    pub inertial_number: f64,
    /// Volume fraction, the same at every height [1].
    pub phi: f64,
    grains: Grains,
    gravity: f64,
    depth: f64,
}

impl Bagnold {
    /// For a depth H > 0 [m], gravity across the layer g_n > 0 and along it [m/s^2]; `None` where nothing flows (the slope
    /// is not above that of mu(0)), nothing is steady (it is too steep), or there is no such profile (cohesion, or water in the pores, which bears and moves with them).
    #[must_use]
    pub fn new(
        material: &Material,
        depth: f64,
        gravity_across: f64,
        gravity_along: f64,
    ) -> Option<Self> {
        let tan = gravity_along / gravity_across;
        if material.cohesion != 0.0 || material.is_saturated() || !tan.is_finite() {
            return None;
        }
        let inertial_number = inertial_number_at(material, tan)?;
        let grains = material.grains;
        let loosening = (grains.phi_max - grains.phi_min) * inertial_number;
        Some(Self {
            inertial_number,
            phi: (grains.phi_max - loosening).max(grains.phi_min),
            grains,
            gravity: gravity_across,
            depth,
        })
    }

    /// Speed along the plane at a height over the bed [m/s]; that of the surface above it.
    #[must_use]
    pub fn speed(&self, height: f64) -> f64 {
        let below = (self.depth - height).clamp(0.0, self.depth);
        let scale = self.inertial_number / self.grains.diameter * (self.phi * self.gravity).sqrt();
        2.0 / 3.0 * scale * (self.depth.powf(1.5) - below.powf(1.5))
    }

    /// Pressure at a height over the bed [Pa].
    #[must_use]
    pub fn pressure(&self, height: f64) -> f64 {
        self.phi * self.grains.density * self.gravity * (self.depth - height).max(0.0)
    }

    /// Shear rate at a height over the bed [1/s].
    #[must_use]
    pub fn shear_rate(&self, height: f64) -> f64 {
        let root = (self.pressure(height) / self.grains.density).sqrt();
        self.inertial_number / self.grains.diameter * root
    }
}

/// The I with mu(I) = tan, by bisection of a law that grows with I.
fn inertial_number_at(material: &Material, tan: f64) -> Option<f64> {
    let (mut low, mut high) = (0.0, MOST);
    // mu(0) is that of grains at rest or, of a law without a yield stress, 0.
    if tan <= material.law.friction(0.0) || tan >= material.law.friction(high) {
        return None;
    }
    // Halving the interval ends at two neighbouring numbers.
    loop {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            return Some(high);
        }
        if material.law.friction(middle) < tan {
            low = middle;
        } else {
            high = middle;
        }
    }
}

/// Largest inertial number looked for: far outside the dense regime, I < 0.3.
const MOST: f64 = 1e3;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Rheology;

    #[test]
    fn friction_carries_the_weight_at_every_height() {
        let m = Material::glass_beads();
        let (sin, cos) = 25f64.to_radians().sin_cos();
        let flow = Bagnold::new(&m, 0.1, 9.81 * cos, 9.81 * sin).unwrap();
        for y in [0.0, 0.03, 0.09] {
            let (gamma, p) = (flow.shear_rate(y), flow.pressure(y));
            let stress = m.shear_stress(gamma, p, 1.0);
            assert!((stress / p - sin / cos).abs() < 1e-12);
            let slope = (flow.speed(y + 1e-6) - flow.speed(y)) / 1e-6;
            assert!((slope / gamma - 1.0).abs() < 1e-4, "{y}: {slope} {gamma}");
        }
        assert_eq!(flow.speed(0.0), 0.0);
        // The surface of [A]'s layer: 12.8 m/s.
        assert!((flow.speed(0.1) - 12.8).abs() < 0.05, "{}", flow.speed(0.1));
        assert!(
            Bagnold::new(&m, 0.1, 9.81, 9.81 * 0.3).is_none(),
            "too flat"
        );
        assert!(
            Bagnold::new(&m, 0.1, 9.81, 9.81 * 0.7).is_none(),
            "too steep"
        );
    }
}
