//! Tables of gauges.

use super::*;

tagged! {
    /// Something measured at every communication step.
    RawGauge by kind {
        "depth" => Depth(RawDepth),
        "profile" => Profile(RawProfile),
        "discharge" => Discharge(RawDischarge),
        "force" => Force(RawForce),
        "pressure" => Pressure(RawPressure),
        "interface_stress" => InterfaceStress(RawInterfaceStress),
        "front" => Front(RawFront),
        "mass" => Mass(RawMass),
        "velocity" => Velocity(RawVelocity),
    }
}

table! {
    /// Depth along a line: from the foot to the highest point of material on it.
    RawDepth {
        /// Foot of the line, on the bed.
        required foot: Coordinates<Length>;
        /// Direction of the line, of any length; along the axis that gravity mostly points against if left out.
        optional up: Coordinates<Ratio>;
        /// Length of the line; up to the domain's edge if left out.
        optional length: Length, in Range::above(0.0);
        /// Only this material; all if left out.
        optional material: Text;
    }
}

table! {
    /// Shear stress where a material ends and another begins: what water drags on a bed with.
    RawInterfaceStress {
        /// Foot of the line, on the bed.
        required foot: Coordinates<Length>;
        /// Direction of the line, of any length; along the axis that gravity mostly points against if left out.
        optional up: Coordinates<Ratio>;
        /// Length of the line; up to the domain's edge if left out.
        optional length: Length, in Range::above(0.0);
        /// The material whose highest point on the line is looked at.
        required material: Text;
    }
}

table! {
    /// Depths at evenly spaced feet: a surface profile.
    RawProfile {
        /// First foot.
        required from: Coordinates<Length>;
        /// Last foot.
        required to: Coordinates<Length>;
        /// Number of feet.
        required count: Whole, in Range::within(2.0, 10_000.0);
        /// Direction of the lines, of any length; along the axis that gravity mostly points against if left out.
        optional up: Coordinates<Ratio>;
        /// Length of the lines; up to the domain's edge if left out.
        optional length: Length, in Range::above(0.0);
        /// Only this material; all if left out.
        optional material: Text;
    }
}

table! {
    /// Mass that crosses a section from the left of the way `from` - `to` to its right, in space along (to - from) x span, per time.
    RawDischarge {
        /// One end of the section; in space one corner.
        required from: Coordinates<Length>;
        /// Other end; in space the corner next to it.
        required to: Coordinates<Length>;
        /// In space: the section's second edge, from `from`.
        optional span: Coordinates<Length>;
        /// Only this material; all if left out.
        optional material: Text;
    }
}

table! {
    /// Force of the material on a wall or gate, mean over the communication step.
    RawForce {
        /// The wall or gate: wall.NAME or gate.NAME.
        required on: Text;
        /// The moment about this point, too: a hinge, an axle. It stays where it is, whatever moves. Not in axisymmetric scenes, and with scheme "implicit" only.
        optional about: Coordinates<Length>;
    }
}

table! {
    /// Pressure at a point.
    RawPressure {
        /// The point.
        required at: Coordinates<Length>;
        /// Which pressure: of the whole material, in the pores, or of grain on grain.
        optional quantity: QuantityWord, default "total";
        /// Only this material; all if left out.
        optional material: Text;
    }
}

table! {
    /// Velocity at a point, as a current meter reads it: along x and y (of rings along the radius and the axis), in space also along z.
    RawVelocity {
        /// The point.
        required at: Coordinates<Length>;
        /// Only this material; all if left out.
        optional material: Text;
    }
}

choice! {
    /// Which pressure a gauge reads.
    QuantityWord {
        /// that of the material with all that is in its pores
        "total" => Total,
        /// that of fluids, and of the fluid in the pores of saturated materials
        "pore" => Pore,
        /// that of grain on grain, what the pores do not carry: materials with friction only
        "effective" => Effective,
    }
}

table! {
    /// Outermost position of material along a direction.
    RawFront {
        /// Depth that counts as material, at least one spacing; one spacing if left out.
        optional least_depth: Length, in Range::above(0.0);
        /// Where distances start, on the bed.
        required origin: Coordinates<Length>;
        /// Direction along the bed, of any length.
        required direction: Coordinates<Ratio>;
        /// Direction of depth, of any length; along the axis that gravity mostly points against if left out.
        optional up: Coordinates<Ratio>;
        /// Only this material; all if left out.
        optional material: Text;
    }
}

table! {
    /// Mass of material in a box: what of a bed is still there.
    RawMass {
        /// Lower corner of the box.
        required lower: Coordinates<Length>;
        /// Upper corner of the box.
        required upper: Coordinates<Length>;
        /// Only this material; all if left out.
        optional material: Text;
    }
}
