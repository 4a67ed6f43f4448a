//! The scene's types. Lengths in m, times in s, masses in kg, angles resolved to vectors.
//!
//! Points are `[x, y, z]`; planar scenes use x and y (y is up unless gravity says otherwise) and leave z at 0.
//! Extensive values of a planar scene (mass, force, discharge) are for the scene's out-of-plane `width`, those of an
//! axisymmetric one for whole rings.

use super::Adjustable;
use crate::material::Material;
use crate::shape::Shape;
use crate::solver::Numerics;

/// A point or vector; planar scenes leave the third component at 0. [m], [m/s] or [m/s^2]
pub type Point = [f64; 3];

/// What the coordinates of a scene stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dimension {
    /// Plane strain in x and y.
    Two,
    /// x is the radius r >= 0, y the height along the axis of symmetry r = 0; particles are rings.
    Axisymmetric,
    /// Full space.
    Three,
}

impl Dimension {
    /// Number of coordinates, 2 or 3.
    #[must_use]
    pub fn axes(self) -> usize {
        match self {
            Dimension::Two | Dimension::Axisymmetric => 2,
            Dimension::Three => 3,
        }
    }
}

/// A whole scene, checked: every value SI and in range, every name unique and known.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// Identifier, `[a-z0-9_]+`: names the FMU and the default Zenoh instance.
    pub name: String,
    /// One line for people.
    pub title: String,
    /// The text the scene was read from, byte for byte (embedded in FMUs, logs and fingerprints).
    pub source: String,
    /// What coordinates stand for.
    pub dimension: Dimension,
    /// Extent, periodic sides, width, gravity.
    pub domain: Domain,
    /// What resolution and tolerances were taken from, with the numbers in `numerics`.
    pub quality: super::Quality,
    /// Every numerical choice.
    pub numerics: Numerics,
    /// Materials by name; bodies and inflows refer to them by index.
    pub materials: Vec<NamedMaterial>,
    /// What is there at the start.
    pub bodies: Vec<Body>,
    /// Walls: they stand, slide along themselves like a belt, or move as a whole.
    pub walls: Vec<Wall>,
    /// Moving walls whose opening is an input.
    pub gates: Vec<Gate>,
    /// Sources whose rate is an input.
    pub inflows: Vec<Inflow>,
    /// Drains that count what leaves.
    pub outflows: Vec<Outflow>,
    /// What is measured.
    pub gauges: Vec<Gauge>,
    /// Communication step and end of runs without an orchestrator.
    pub run: Run,
    /// Inputs of runs without an orchestrator.
    pub schedules: Vec<Schedule>,
    /// What a run writes to its log.
    pub log: LogSettings,
    /// Numbers that may be changed without touching the text; a component shows them as parameters.
    pub adjustables: Vec<Adjustable>,
}

/// Extent and gravity.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// Lower corner [m]. A particle that leaves the box other than by an outflow or a periodic side is lost: an error.
    pub lower: Point,
    /// Upper corner [m].
    pub upper: Point,
    /// Which axes are periodic.
    pub periodic: [bool; 3],
    /// Out-of-plane width of a planar scene [m]; 1 otherwise.
    pub width: f64,
    /// Gravitational acceleration [m/s^2]; a tilted vector makes an inclined plane.
    pub gravity: Point,
}

/// A material and the name scenes call it by.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMaterial {
    /// Name in the scene file.
    pub name: String,
    /// Its laws and parameters.
    pub material: Material,
}

/// Material that is there at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Name in the scene file.
    pub name: String,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Region to fill with particles.
    pub shape: Shape,
    /// Reservoirs: fill only below this height along "up" (against gravity's main axis) [m].
    pub level: Option<f64>,
    /// Initial velocity [m/s].
    pub velocity: Point,
    /// What is added to it, over the body's height.
    pub profile: VelocityProfile,
}

/// Velocity over the height of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VelocityProfile {
    /// The same everywhere.
    Uniform,
    /// Steady flow of a layer down a slope, along gravity's part in the bed ([A] eq. 56); a box on its bed.
    Bagnold,
}

/// What a wall does to material that slides along it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Slip {
    /// Material sticks to the wall.
    NoSlip,
    /// No shear stress at the wall.
    FreeSlip,
    /// Coulomb friction: a shear stress of at most mu_w times the normal one.
    Friction {
        /// mu_w >= 0 [1].
        coefficient: f64,
    },
}

impl Slip {
    /// mu_w of Coulomb friction, else 0 [1].
    #[must_use]
    pub fn friction(self) -> f64 {
        match self {
            Slip::NoSlip | Slip::FreeSlip => 0.0,
            Slip::Friction { coefficient } => coefficient,
        }
    }
}

/// A wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Name in the scene file (force gauges refer to it).
    pub name: String,
    /// Where it is.
    pub geometry: WallGeometry,
    /// No slip, free slip or Coulomb friction.
    pub slip: Slip,
    /// Whether the wall moves as a whole; otherwise its surface slides along itself and the geometry stays.
    pub rigid: bool,
    /// Velocity of the wall's material [m/s].
    pub velocity: Point,
    /// Rotation, if it turns.
    pub rotation: Option<Rotation>,
}

impl Wall {
    /// Whether the two stay where they are to each other.
    #[must_use]
    pub fn moves_with(&self, other: &Self) -> bool {
        let motion = |w: &Self| w.rigid.then_some((w.velocity, w.rotation));
        motion(self) == motion(other)
    }
}

/// How a wall turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// Angular velocity [rad/s], anticlockwise in the plane, right-handed about `axis` in space.
    pub rate: f64,
    /// Centre of rotation at the start; it moves with the wall's velocity [m].
    pub centre: Point,
    /// Unit axis of rotation; z in the plane.
    pub axis: Point,
}

/// Where a wall is.
#[derive(Clone, Debug, PartialEq)]
pub enum WallGeometry {
    /// Planar: a chain of points with the material on its left; the wall lies on its right, four particle rows deep.
    Polyline {
        /// Corners in order, at least two [m].
        points: Vec<[f64; 2]>,
        /// Whether the last point joins the first.
        closed: bool,
    },
    /// A solid box (an obstacle), 2D and 3D.
    Box {
        /// Lower corner [m].
        lower: Point,
        /// Upper corner [m].
        upper: Point,
    },
    /// Space (and plane): a plane through `point`; material on the side of `normal`.
    Plane {
        /// A point of the plane [m].
        point: Point,
        /// Unit normal, towards the material.
        normal: Point,
    },
}

/// A plate that slides along its own length to open the gap between `from` and `to`.
///
/// Planar: the plate's face is the segment `from`-`to` with material on its left, its body lies on the right,
/// `thickness` deep. Opening 0 covers the whole segment; opening o uncovers the share o next to `from`
/// (the plate retracts towards `to` and disappears behind it). In space the plate is that profile extruded
/// along `span`.
#[derive(Clone, Debug, PartialEq)]
pub struct Gate {
    /// Name in the scene file: input `gate.NAME.opening`.
    pub name: String,
    /// End that opens first [m].
    pub from: Point,
    /// End the plate retracts to [m].
    pub to: Point,
    /// In space: the extrusion vector [m]; ignored in planar scenes.
    pub span: Point,
    /// Depth of the plate behind its face [m]; at least four particle spacings.
    pub thickness: f64,
    /// Largest speed of the plate [m/s].
    pub max_speed: f64,
    /// Opening at the start, 0 to 1.
    pub start: f64,
    /// Faces: free slip unless the scene says otherwise.
    pub slip: Slip,
}

/// A source of material: rows of particles that enter through a face at a set velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct Inflow {
    /// Name in the scene file: input `inflow.NAME.rate`.
    pub name: String,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// One end of the face (planar), or one corner (space) [m].
    pub from: Point,
    /// Other end of the face (planar), or the corner next to it (space) [m].
    pub to: Point,
    /// In space: second edge of the face, from `from` [m].
    pub span: Point,
    /// Velocity of entering material [m/s]: it points to the left of the way from `from` to `to` (in space: along
    /// (to - from) x span), so material enters on that side and comes from the other.
    pub velocity: Point,
    /// Rate at the start [kg/s].
    pub rate: f64,
    /// Largest rate the face can pass: bulk density x face area x normal velocity [kg/s].
    pub max_rate: f64,
}

/// A box in which particles are taken out and counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Outflow {
    /// Name in the scene file: outputs `outflow.NAME.mass` and `outflow.NAME.rate`.
    pub name: String,
    /// Lower corner [m].
    pub lower: Point,
    /// Upper corner [m].
    pub upper: Point,
}

/// Something measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Gauge {
    /// Name in the scene file: outputs `gauge.NAME.*`.
    pub name: String,
    /// What it measures.
    pub kind: GaugeKind,
    /// Index into [`Scene::materials`] of the one that it sees; all if `None`.
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
    },
    /// Pressure at a point, that of a linear fit to particles [Pa].
    Pressure {
        /// The point [m].
        at: Point,
        /// Which pressure.
        quantity: PressureQuantity,
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
    /// Index into [`Scene::walls`].
    Wall(usize),
    /// Index into [`Scene::gates`].
    Gate(usize),
}

/// Time settings of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Communication step [s].
    pub step: f64,
    /// End time of a run without an orchestrator, and DefaultExperiment's stop time [s].
    pub until: f64,
}

impl Run {
    /// Most communication steps of a run.
    pub const MOST_STEPS: f64 = 1e8;
}

/// What an input variable is told over time when nobody else sets it.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    /// Which input.
    pub input: InputTarget,
    /// (time [s], value) in ascending time; held before the first and after the last.
    pub points: Vec<(f64, f64)>,
    /// Between points: a straight line, or hold the earlier value.
    pub interpolation: Interpolation,
}

impl Schedule {
    /// Value at time `t` [s]: what the input is set to at a communication point.
    ///
    /// Lines are weighted as FMPy weights its input tables, so that both give the same bits.
    #[must_use]
    pub fn value_at(&self, t: f64) -> f64 {
        let held = |i: usize| self.points.get(i).map_or(0.0, |p| p.1);
        match self.interpolation {
            Interpolation::Hold => {
                let next = self.points.partition_point(|p| p.0 <= t);
                held(next.saturating_sub(1))
            }
            Interpolation::Linear => {
                let next = self.points.partition_point(|p| p.0 < t);
                if next == 0 || next == self.points.len() {
                    return held(next.saturating_sub(1));
                }
                let ((t0, v0), (t1, v1)) = (self.points[next - 1], self.points[next]);
                let w0 = (t1 - t) / (t1 - t0);
                w0 * v0 + (1.0 - w0) * v1
            }
        }
    }
}

/// An input variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputTarget {
    /// Opening of a gate, index into [`Scene::gates`].
    GateOpening(usize),
    /// Rate of an inflow, index into [`Scene::inflows`].
    InflowRate(usize),
}

/// How a schedule goes from point to point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Interpolation {
    /// Piecewise constant.
    Hold,
    /// Piecewise linear.
    Linear,
}

/// What a run writes to its log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogSettings {
    /// Particle snapshots every so many seconds of simulated time; 0 means none [s].
    pub particles_every: f64,
    /// Whether a run stops when its log cannot be written.
    pub required: bool,
    /// Whether equal runs give equal bytes.
    pub deterministic: bool,
    /// A new file every so many seconds of simulated time; 0 means never [s].
    pub rotate_every: f64,
    /// A new file when the messages of one take so many bytes; 0 means never.
    pub rotate_bytes: u64,
    /// Whether every flush goes to the disk itself, not only the end of a file.
    pub sync_every_flush: bool,
}

/// The axis that gravity mostly points against, as a unit vector.
pub(super) fn up(gravity: Point, dimension: Dimension) -> Point {
    let last = dimension.axes() - 1;
    // The last axis wins ties, so that a slope of 45 deg still has its bed along x.
    let steepest = (0..=last).rev().fold(last, |best, axis| {
        if gravity[axis].abs() > gravity[best].abs() {
            axis
        } else {
            best
        }
    });
    let mut up = [0.0; 3];
    up[steepest] = if gravity[steepest] > 0.0 { -1.0 } else { 1.0 };
    up
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn schedules_hold_or_go_straight_between_points() {
        let mut schedule = Schedule {
            input: InputTarget::GateOpening(0),
            points: vec![(1.0, 0.0), (2.0, 1.0), (4.0, 0.5)],
            interpolation: Interpolation::Linear,
        };
        let at = |s: &Schedule| [0.0, 1.0, 1.25, 2.0, 3.0, 4.0, 9.0].map(|t| s.value_at(t));
        assert_eq!(at(&schedule), [0.0, 0.0, 0.25, 1.0, 0.75, 0.5, 0.5]);
        schedule.interpolation = Interpolation::Hold;
        assert_eq!(at(&schedule), [0.0, 0.0, 0.0, 1.0, 1.0, 0.5, 0.5]);
    }
}
