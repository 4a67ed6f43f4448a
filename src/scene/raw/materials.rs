//! Tables of materials.

use super::*;

// Far beyond anything real, and far from where sums overflow, which a step would report as a failure of its own.
/// Grain diameters: up to that of a mountain.
pub(in crate::scene) const GRAIN_DIAMETERS: Range = Range::above_to(0.0, 1e3);
/// Densities: from well below gases to well above metals.
pub(in crate::scene) const DENSITIES: Range = Range::within(1e-6, 1e6);
/// Cohesions and yield stresses: up to a thousand times those of rock and steel.
pub(in crate::scene) const STRENGTHS: Range = Range::within(0.0, 1e12);
/// Consistencies: up to more than that of the Earth's mantle.
pub(in crate::scene) const CONSISTENCIES: Range = Range::within(0.0, 1e24);
/// Flow indices: those of all fluids that have been measured.
pub(in crate::scene) const FLOW_INDICES: Range = Range::within(0.1, 3.0);
/// Friction angles of constant friction: up to slopes of 3 to 1.
pub(in crate::scene) const FRICTION_ANGLES: Range = Range::within(0.0, 1.25);
/// Friction angles of mu(I), which is no fluid.
pub(in crate::scene) const GRANULAR_ANGLES: Range = Range::above_to(0.0, 1.25);

tagged! {
    /// A material: a law and its parameters.
    RawMaterial by law {
        "mu_i" => MuI(RawMuI),
        "barker_gray" => BarkerGray(RawBarkerGray),
        "constant_friction" => ConstantFriction(RawConstantFriction),
        "fluid" => Fluid(RawFluid),
    }
}

/// Declares a table of a law that is made of the inertial number: the keys that all have, and between them the law's own.
macro_rules! inertial_law {
    ($(#[doc = $about:literal])+ $name:ident { $($own:tt)* }) => {
        table! {
            $(#[doc = $about])+
            $name {
                /// Values to start from.
                optional preset: Preset;
                /// Friction angle at vanishing shear rate; tan of it is mu_s.
                optional static_friction_angle: Angle, in GRANULAR_ANGLES;
                /// Friction angle at large shear rate, not below the static one; tan of it is mu_2.
                optional dynamic_friction_angle: Angle, in GRANULAR_ANGLES;
                /// Inertial number I0 at which friction is half way between the two.
                optional inertial_number_scale: Ratio, in Range::above(0.0);
                $($own)*
                /// Grain diameter.
                optional grain_diameter: Length, in GRAIN_DIAMETERS;
                /// Density of the grains' own material.
                optional grain_density: Density, in DENSITIES;
                /// Largest volume fraction of grains (0.6 if left out).
                optional phi_max: Ratio, in Range::above_to(0.0, 1.0);
                /// Smallest volume fraction of grains that touch, below phi_max (0.5 if left out). Looser material has parted: it carries no stress until it is this dense again.
                optional phi_min: Ratio, in Range::above_to(0.0, 1.0);
                /// Shear strength without pressure, added to friction. It is no tensile strength: material that is pulled parts.
                optional cohesion: Pressure, in STRENGTHS, default 0;
                /// Bulk friction coefficient mu_b: resists changes of volume. 0 is none; equations are well-posed above 1 - 7 mu/6.
                optional bulk_friction: Ratio, in Range::within(0.0, 10.0), default 0;
                /// Name of the fluid material that fills the pores: friction is then made of the effective pressure, and grains of mu(I) weigh what they do with their pores full. Left out: dry.
                optional pore_fluid: Text;
                /// Artificial sound speed of this material, not above that of the scene; left out: that of the scene.
                optional sound_speed: Speed, in Range::above(0.0);
                /// Lowest density of parted material that is kept track of, over the density at rest; below the density at which grains touch.
                optional parted_density: Ratio, in Range::within(0.1, 0.9), default 0.5;
            }
        }
    };
}

inertial_law! {
    /// Dense granular flow, friction mu(I). Start from a preset and override what differs, or give every value.
    RawMuI {
        /// Growth of friction at large I: mu_inf I^2/(I0 + I) is added; 0 is none, 0.05 a published value.
        optional high_inertia_friction: Ratio, in Range::within(0.0, 1.0), default 0;
        /// Depth H of a thin layer of sand: I + layer_factor x grain_diameter/H stands in place of I. Left out: no correction.
        optional layer_depth: Length, in Range::above(0.0);
        /// Factor of the layer correction (2.61, that of sand, if left out; glass beads have none).
        optional layer_factor: Ratio, in Range::above(0.0);
    }
}

inertial_law! {
    /// Friction mu(I) as Barker and Gray made it well-posed at low I: no yield stress, so that piles creep. Starts from
    /// the values of mu(I).
    RawBarkerGray {
        /// Growth of friction at large I: mu_inf I^2/(I0 + I) is added.
        optional high_inertia_friction: Ratio, in Range::within(0.0, 1.0), default 0.05;
    }
}

table! {
    /// Constant friction (Mohr-Coulomb, Drucker-Prager) at constant volume: no rate dependence, no dilatancy.
    RawConstantFriction {
        /// Mohr-Coulomb friction angle.
        required friction_angle: Angle, in FRICTION_ANGLES;
        /// How the angle becomes a friction coefficient.
        optional r#match: AngleMatchWord, default "plane_strain";
        /// Density of the material at rest, pores and what fills them included.
        required density: Density, in DENSITIES;
        /// Viscous stress beside friction, consistency x (shear rate)^flow_index; 0 is none.
        optional consistency: Viscosity, in CONSISTENCIES, default 0;
        /// Flow index: 1 makes the consistency a viscosity; below 1 shear-thinning, above 1 shear-thickening.
        optional flow_index: Ratio, in FLOW_INDICES, default 1;
        /// Mohr-Coulomb cohesion c. It is no tensile strength: material that is pulled parts.
        optional cohesion: Pressure, in STRENGTHS, default 0;
        /// Bulk friction coefficient mu_b: resists changes of volume. 0 is none; equations are well-posed above 1 - 7 mu/6.
        optional bulk_friction: Ratio, in Range::within(0.0, 10.0), default 0;
        /// Name of the fluid material that fills the pores: friction is then made of the effective pressure, and grains of mu(I) weigh what they do with their pores full. Left out: dry.
        optional pore_fluid: Text;
        /// Artificial sound speed of this material, not above that of the scene; left out: that of the scene.
        optional sound_speed: Speed, in Range::above(0.0);
        /// Lowest density of parted material that is kept track of, over the density at rest; below the density at which grains touch.
        optional parted_density: Ratio, in Range::within(0.1, 0.9), default 0.5;
    }
}

choice! {
    /// Friction coefficient of an angle phi.
    AngleMatchWord {
        /// tau = c cos phi + p sin phi: Mohr-Coulomb's line in plane strain at constant volume
        "plane_strain" => PlaneStrain,
        /// tau = c + p tan phi: a layer that slips along its bed; phi is the angle of repose
        "simple_shear" => SimpleShear,
        /// tau = (c cos phi + p sin phi) 2 sqrt(3)/(3 - sin phi): the cone of Drucker and Prager in triaxial compression; 20 to 40 % too strong in plane strain
        "cone" => Cone,
    }
}

choice! {
    /// Measured materials.
    Preset {
        /// glass beads of 0.5 mm, 20.90 and 32.76 deg, I0 0.279, 2500 kg/m^3
        "glass_beads" => GlassBeads,
        /// sand of 0.8 mm, 27.00 and 43.40 deg, I0 1.09, 2600 kg/m^3
        "sand_08" => Sand08,
        /// sand of 0.4 mm, 30.50 and 51.30 deg, I0 2.65, 2600 kg/m^3
        "sand_04" => Sand04,
    }
}

table! {
    /// A fluid: stress yield_stress + consistency x (shear rate)^flow_index (Herschel and Bulkley), whatever the pressure. Newton's fluid if there is no yield stress and the index is 1, Bingham's if there is one.
    RawFluid {
        /// Values to start from.
        optional preset: FluidPreset;
        /// Density at rest.
        optional density: Density, in DENSITIES;
        /// Consistency K: the viscosity where flow_index is 1; in Pa s^n otherwise.
        optional consistency: Viscosity, in CONSISTENCIES;
        /// Flow index n (1 if left out): 1 Newton and Bingham, below 1 shear-thinning, above 1 shear-thickening.
        optional flow_index: Ratio, in FLOW_INDICES;
        /// Yield stress (0 if left out): below it nothing shears, and with it the fluid hangs together: it bears tension of up to (1 + pi) times its shear stress.
        optional yield_stress: Pressure, in STRENGTHS;
        /// Artificial viscosity alpha, what the viscosity of Newton's fluids is made up to where they are compressed or hardly move: damps what water leaves undamped, adds little to what is sheared alone, and nothing to a fluid whose viscosity is at least alpha density h c/(2 (D + 2)). Fluids that yield or thin have none.
        optional artificial_viscosity: Ratio, in Range::within(0.0, 1.0), default 0.02;
        /// Artificial sound speed of this fluid, not above that of the scene; left out: that of the scene.
        optional sound_speed: Speed, in Range::above(0.0);
        /// Lowest density of parted fluid, drops and spray, that is kept track of, over the density at rest.
        optional parted_density: Ratio, in Range::within(0.1, 0.83), default 0.5;
    }
}

choice! {
    /// Common fluids.
    FluidPreset {
        /// 1000 kg/m^3, 1 mPa s
        "water" => Water,
        /// the clay of Monge-Gapper et al. (2024), Table 1: 1540 kg/m^3, 30 Pa, 4.472 Pa s^n, n 0.472
        "clay" => Clay,
    }
}
