//! The sections of a scene file, in the order people write them, and the first of them: the domain. The tables of the
//! others stand beside this file.

use super::*;

table! {
    /// A scene: everything a case file says.
    RawScene {
        /// Identifier of the scene; names its FMU and its keys on the bus.
        required name: Name;
        /// One line for people.
        optional title: Text, default "";
        /// What coordinates stand for: 2 (plane strain, x and y), 3, or "axisymmetric": x is the radius r >= 0, y the height along the axis of symmetry r = 0; masses, forces and discharges are for whole rings.
        optional dimension: DimensionWord, default 2;
        /// Extent, periodic sides, width and gravity.
        required domain: RawDomain;
        /// Resolution and every numerical choice.
        required numerics: RawNumerics;
        /// At least one; bodies, inflows and gauges refer to them by name. What none refers to is left out.
        required materials: Named<RawMaterial>;
        /// What is there at the start; a scene without bodies needs an inflow.
        optional bodies: Named<RawBody>;
        /// Force gauges refer to them as wall.NAME; with the key `input` wall.NAME.speed, wall.NAME.position or wall.NAME.angle is an input.
        optional walls: Named<RawWall>;
        /// The opening is the input gate.NAME.opening; force gauges refer to gates as gate.NAME.
        optional gates: Named<RawGate>;
        /// The rate is the input inflow.NAME.rate.
        optional inflows: Named<RawInflow>;
        /// Outputs are outflow.NAME.mass and outflow.NAME.rate.
        optional outflows: Named<RawOutflow>;
        /// Outputs are gauge.NAME.*, each with a validity flag.
        optional gauges: Named<RawGauge>;
        /// Communication step and end time.
        required run: RawRun;
        /// For runs without an orchestrator; one for each input at most.
        optional schedule: List<RawSchedule>;
        /// What a run writes to its log.
        optional log: RawLog, default {};
    }
}

table! {
    /// Extent and gravity.
    RawDomain {
        /// Lower corner; a particle that gets more than a quarter of a spacing out of the domain other than by an outflow or a periodic side is an error: where some may fall beside what should catch them, give an outflow with `outside = true`.
        required lower: Coordinates<Length>;
        /// Upper corner.
        required upper: Coordinates<Length>;
        /// Axes along which the domain repeats itself.
        optional periodic: List<Axis>;
        /// Out-of-plane width of a planar scene: masses, forces and discharges are for this width. Not where dimension is 3 or "axisymmetric".
        optional width: Length, in Range::above(0.0), default "1 m";
        /// Gravitational acceleration: its size, downwards along the last axis, or a vector.
        optional gravity: Gravity, default "9.81 m/s^2";
        /// Slope of the bed: turns gravity towards +x, so that a bed along x is an inclined plane. Not with a gravity vector, nor in axisymmetric scenes.
        optional slope: Angle, in Range::within(-1.5, 1.5);
    }
}

choice! {
    /// An axis.
    Axis {
        /// First axis.
        "x" => X,
        /// Second axis.
        "y" => Y,
        /// Third axis, in space.
        "z" => Z,
    }
}
