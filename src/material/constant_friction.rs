//! Constant friction: Mohr-Coulomb's angle in the form tau = mu p of Drucker and Prager, without rate or dilatancy.
//!
//! With the principal stresses s1 >= s3 of a plane, Mohr-Coulomb is (s1 - s3)/2 = c cos phi + sin phi (s1 + s3)/2. In
//! plane strain at constant volume the strain rate has no part across the plane, nor has the stress deviator (flow is
//! along the deviator), so p = (s1 + s3)/2 and |tau| = sqrt(tau:tau/2) = (s1 - s3)/2, in 2D and in 3D alike:
//!
//!   tau = c cos phi + p sin phi                        (`plane_strain`: exact on every such stress)
//!   tau = c + p tan phi                                (`simple_shear`: phi is the angle of a layer that slips along
//!                                                       its bed, where the normal stresses are equal; angle of repose)
//!
//!   tau = (c cos phi + p sin phi) 2 sqrt 3/(3 - sin phi)  (`cone`: [B] eqs. 7 to 9, exact in triaxial compression; 20
//!                                                       to 40 % too strong in plane strain)
//!
//! The associated match 3 tan phi/sqrt(9 + 12 tan^2 phi) is for material that dilates as it shears: not used here.

use super::{Friction, Viscous};

/// How a Mohr-Coulomb angle becomes a friction coefficient.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleMatch {
    /// mu = sin phi, cohesion c cos phi: plane strain at constant volume.
    PlaneStrain,
    /// mu = tan phi, cohesion c: simple shear with equal normal stresses.
    SimpleShear,
    /// mu = 2 sqrt 3 sin phi/(3 - sin phi), cohesion 2 sqrt 3 c cos phi/(3 - sin phi): the cone of Drucker and Prager
    /// through Mohr and Coulomb's corners of triaxial compression ([B] eq. 8, and 9 corrected).
    Cone,
}

/// 2 sqrt 3/(3 - sin phi) of the cone.
fn cone(angle: f64) -> f64 {
    2.0 * 3f64.sqrt() / (3.0 - angle.sin())
}

/// Constant friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantFriction {
    /// Friction coefficient >= 0 [1].
    pub mu: f64,
}

impl ConstantFriction {
    /// Friction of a Mohr-Coulomb angle [rad], 0 to pi/2.
    #[must_use]
    pub fn of_angle(angle: f64, kind: AngleMatch) -> Self {
        Self {
            mu: match kind {
                AngleMatch::PlaneStrain => angle.sin(),
                AngleMatch::SimpleShear => angle.tan(),
                AngleMatch::Cone => cone(angle) * angle.sin(),
            },
        }
    }

    /// Shear strength at p = 0 of Mohr-Coulomb's cohesion c [Pa] at an angle [rad].
    #[must_use]
    pub fn cohesion_of(c: f64, angle: f64, kind: AngleMatch) -> f64 {
        match kind {
            AngleMatch::PlaneStrain => c * angle.cos(),
            AngleMatch::SimpleShear => c,
            AngleMatch::Cone => cone(angle) * c * angle.cos(),
        }
    }
}

impl Friction for ConstantFriction {
    #[inline]
    fn friction(&self, _: f64) -> f64 {
        self.mu
    }

    #[inline]
    fn slope(&self, _: f64) -> f64 {
        0.0
    }

    #[inline]
    fn static_friction(&self) -> f64 {
        self.mu
    }

    #[inline]
    fn resolvent(&self, a: f64, y: f64) -> f64 {
        let excess = y - self.mu;
        if excess > 0.0 { excess / a } else { 0.0 }
    }

    fn cell_resolvent(&self, (a, k): (f64, f64), y: f64, half: f64) -> f64 {
        Viscous::newtonian(k).mean_resolvent(y - self.mu, a, half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::laws_tests::check;

    #[test]
    fn is_a_friction_law() {
        check(&ConstantFriction { mu: 0.4 });
    }

    /// Mohr-Coulomb by its definition: the largest of |shear stress| - (c + normal stress tan phi) over all planes.
    fn most_loaded_plane(p: f64, tau: f64, c: f64, angle: f64) -> f64 {
        (0..20_000)
            .map(|k| std::f64::consts::PI * f64::from(k) / 20_000.0)
            .map(|a| (tau * a.sin()).abs() - (c + (p + tau * a.cos()) * angle.tan()))
            .fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn in_plane_strain_it_touches_mohr_and_coulombs_line() {
        for (degrees, c, p) in [(19.8, 0.0, 1000.0), (30.0, 50.0, 200.0), (35.0, 80.0, 0.0)] {
            let angle = f64::to_radians(degrees);
            let kind = AngleMatch::PlaneStrain;
            let law = ConstantFriction::of_angle(angle, kind);
            let tau = law.mu * p + ConstantFriction::cohesion_of(c, angle, kind);
            // A grid of 20,000 planes misses the most loaded one by at most 1e-8 of tau.
            let over = most_loaded_plane(p, tau, c, angle);
            assert!(over.abs() < 1e-6 * tau, "{degrees}: {over}");
        }
    }

    /// Triaxial compression, s1 > s2 = s3: Mohr and Coulomb ask for s1 - s3 = 2 c cos phi + (s1 + s3) sin phi.
    #[test]
    fn the_cone_goes_through_triaxial_compression() {
        let (angle, c, p) = (30f64.to_radians(), 50.0, 800.0);
        let kind = AngleMatch::Cone;
        let law = ConstantFriction::of_angle(angle, kind);
        assert!((law.mu - 0.6928).abs() < 1e-4);
        let tau = law.mu * p + ConstantFriction::cohesion_of(c, angle, kind);
        let (s1, s3) = (p + 2.0 * tau / 3f64.sqrt(), p - tau / 3f64.sqrt());
        let strength = 2.0 * c * angle.cos() + (s1 + s3) * angle.sin();
        assert!((s1 - s3 - strength).abs() < 1e-9 * strength);
    }

    #[test]
    fn in_simple_shear_it_is_the_tangent() {
        let law = ConstantFriction::of_angle(0.5, AngleMatch::SimpleShear);
        assert!((law.mu - 0.5f64.tan()).abs() < 1e-15);
    }
}
