//! Friction laws mu(I): what a law answers ([`Friction`]), and the enum of those that a scene can choose from ([`Law`]).

use super::{BarkerGray, ConstantFriction, MuI};

/// A friction law mu(I): shear stress over pressure against the inertial number I >= 0. Dimensionless.
pub trait Friction {
    /// mu(I) [1].
    fn friction(&self, inertial_number: f64) -> f64;
    /// d mu/dI [1].
    fn slope(&self, inertial_number: f64) -> f64;
    /// What people call the static friction coefficient [1]: mu(0), or of a law that vanishes at rest the one it is
    /// made from. Scales the cap of the viscosity.
    fn static_friction(&self) -> f64;
    /// The I >= 0 with mu(I) + a I = y for a > 0; 0 where y <= mu(0) [1].
    fn resolvent(&self, a: f64, y: f64) -> f64;
}

/// The friction laws a scene can choose from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Dense granular flow, mu(I) ([A]).
    MuI(MuI),
    /// Mohr-Coulomb's angle, no rate dependence.
    ConstantFriction(ConstantFriction),
    /// mu(I) without a yield stress, well-posed at low I.
    BarkerGray(BarkerGray),
    /// None: stress does not depend on pressure, and what has strength hangs together. Grains without friction are not this.
    Fluid,
}

/// Calls a method of whichever law it is: a branch per particle, no pointer.
macro_rules! of_law {
    ($self:ident, $law:ident => $call:expr) => {
        match $self {
            Law::MuI($law) => $call,
            Law::ConstantFriction($law) => $call,
            Law::BarkerGray($law) => $call,
            Law::Fluid => {
                let $law = ConstantFriction { mu: 0.0 };
                $call
            }
        }
    };
}

impl Friction for Law {
    #[inline]
    fn friction(&self, inertial_number: f64) -> f64 {
        of_law!(self, law => law.friction(inertial_number))
    }

    #[inline]
    fn slope(&self, inertial_number: f64) -> f64 {
        of_law!(self, law => law.slope(inertial_number))
    }

    #[inline]
    fn static_friction(&self) -> f64 {
        of_law!(self, law => law.static_friction())
    }

    #[inline]
    fn resolvent(&self, a: f64, y: f64) -> f64 {
        of_law!(self, law => law.resolvent(a, y))
    }
}
