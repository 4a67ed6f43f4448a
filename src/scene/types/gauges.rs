//! What is measured, and where.

use super::Point;

/// Something measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Gauge {
    /// Name in the scene file: outputs `gauge.NAME.*`.
    pub name: String,
    /// What it measures.
    pub kind: GaugeKind,
    /// Index into [`Scene::materials`](super::Scene::materials) of the one that it sees; all if `None`.
    pub material: Option<usize>,
}

/// What a gauge measures; definitions in docs/gauges.md.
#[derive(Clone, Debug, PartialEq)]
pub enum GaugeKind {
    /// Depth along a line: distance from `foot` to the highest point along `up` where the Shepard sum is 0.5 [m].
    Depth {
        /// Foot of the line, on the bed [m].
        foot: Point,
        /// Unit vector along the line.
        up: Point,
        /// Length of the line searched [m].
        length: f64,
    },
    /// Depths at evenly spaced feet from `from` to `to`.
    Profile {
        /// First foot [m].
        from: Point,
        /// Last foot [m].
        to: Point,
        /// Number of feet, at least 2.
        count: usize,
        /// Unit vector along the lines.
        up: Point,
        /// Length of the lines searched [m].
        length: f64,
    },
    /// Mass that crossed the segment (planar) or parallelogram (space) from its left to its right side in the
    /// communication step, over the step [kg/s].
    Discharge {
        /// One end (planar), or one corner (space) [m].
        from: Point,
        /// Other end, or the corner next to it [m].
        to: Point,
        /// In space: second edge, from `from` [m].
        span: Point,
    },
    /// Force of the material on a wall or gate, mean over the communication step [N].
    Force {
        /// The wall or gate.
        on: ForceTarget,
        /// The point that its moment is taken about, if it is [m].
        about: Option<Point>,
    },
    /// Pressure at a point, that of a linear fit to particles [Pa].
    Pressure {
        /// The point [m].
        at: Point,
        /// Which pressure.
        quantity: PressureQuantity,
    },
    /// Velocity at a point, that of a linear fit to particles [m/s].
    Velocity {
        /// The point [m].
        at: Point,
    },
    /// Shear stress at the highest point of one material on a line [Pa]: between it and what lies above.
    InterfaceStress {
        /// Foot of the line [m].
        foot: Point,
        /// Unit vector along the line.
        up: Point,
        /// Length searched [m].
        length: f64,
    },
    /// Mass in a box [kg].
    Mass {
        /// Lower corner [m].
        lower: Point,
        /// Upper corner [m].
        upper: Point,
    },
    /// Outermost position along `direction` with a depth of at least `least_depth`, from `origin` [m],
    /// with the 99.5 % mass quantile beside it.
    Front {
        /// Where distances start; a point of the bed [m].
        origin: Point,
        /// Unit vector along the bed.
        direction: Point,
        /// Unit vector of depth.
        up: Point,
        /// Depth that counts [m], at least one spacing.
        least_depth: f64,
    },
}

/// Which pressure a gauge reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum PressureQuantity {
    /// Of the whole material, what is in its pores included.
    #[default]
    Total,
    /// Of the fluid: of fluids, and in the pores of saturated material.
    Pore,
    /// Of grain on grain: of materials with friction, what the pores do not carry.
    Effective,
}

/// What a force gauge reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceTarget {
    /// Index into [`Scene::walls`](super::Scene::walls).
    Wall(usize),
    /// Index into [`Scene::gates`](super::Scene::gates).
    Gate(usize),
}
