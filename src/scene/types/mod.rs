//! The scene's types. Lengths in m, times in s, masses in kg, angles resolved to vectors.
//!
//! Points are `[x, y, z]`; planar scenes use x and y (y is up unless gravity says otherwise) and leave z at 0.
//! Extensive values of a planar scene (mass, force, discharge) are for the scene's out-of-plane `width`, those of an
//! axisymmetric one for whole rings.

mod devices;
mod gauges;
mod run;

pub use devices::{
    Gate, Inflow, Outflow, OutflowPlace, Rotation, Slip, Wall, WallDrive, WallGeometry,
};
pub use gauges::{ForceTarget, Gauge, GaugeKind, PressureQuantity};
pub use run::{InputTarget, Interpolation, LogSettings, Run, Schedule};

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
    /// Names of those in the file that no body, inflow or gauge refers to: left out.
    pub unused_materials: Vec<String>,
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
    /// Area of a circle over that of the polygon that stands for it in `shape`; 1 of all that is no circle [1].
    pub roundness: f64,
    /// Reservoirs: fill only below this height along "up" (against gravity's main axis) [m].
    pub level: Option<f64>,
    /// Initial velocity [m/s].
    pub velocity: Point,
    /// How it turns at the start; its own velocity comes on top.
    pub rotation: Option<Rotation>,
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
