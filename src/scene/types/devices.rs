//! Walls, gates, inflows and outflows.

use super::Point;
use crate::boundary::Steers;

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
    /// How it is steered, if it is: `velocity` and `rotation` are then those of full speed.
    pub drive: Option<WallDrive>,
}

impl Wall {
    /// Whether the two stay where they are to each other.
    #[must_use]
    pub fn moves_with(&self, other: &Self) -> bool {
        let motion = |w: &Self| w.rigid.then_some((w.velocity, w.rotation));
        let is_steered = |w: &Self| w.rigid && w.drive.is_some();
        motion(self) == motion(other)
            && (self.name == other.name || !(is_steered(self) || is_steered(other)))
    }
}

/// How a wall is steered: along its velocity, or if it has none in the sense of its angular velocity.
#[derive(Clone, Debug, PartialEq)]
pub struct WallDrive {
    /// Whether its speed or its position is the input.
    pub steers: Steers,
    /// Whether these are of turning.
    pub turns: bool,
    /// Full speed, above 0 [m/s, of turning rad/s].
    pub full: f64,
    /// Speed at the start over full speed [1].
    pub start: f64,
    /// Time from a standstill to full speed [s].
    pub ramp: f64,
    /// End stops, from where it is drawn; infinite where there are none [m, of turning rad].
    pub stops: (f64, f64),
}

impl WallDrive {
    /// The last part of the name of its input: `wall.NAME.` and this.
    #[must_use]
    pub fn input(&self) -> &'static str {
        match (self.steers, self.turns) {
            (Steers::Rate, _) => "speed",
            (Steers::Way, false) => "position",
            (Steers::Way, true) => "angle",
        }
    }

    /// Smallest and largest value of its input.
    #[must_use]
    pub fn range(&self) -> (f64, f64) {
        match self.steers {
            Steers::Rate => (-self.full, self.full),
            Steers::Way => self.stops,
        }
    }

    /// SI unit of its input.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        match (self.steers, self.turns) {
            (Steers::Rate, false) => "m/s",
            (Steers::Rate, true) => "rad/s",
            (Steers::Way, false) => "m",
            (Steers::Way, true) => "rad",
        }
    }

    /// Its input at the start.
    #[must_use]
    pub fn start_value(&self) -> f64 {
        match self.steers {
            Steers::Rate => self.start * self.full,
            Steers::Way => 0.0,
        }
    }
}

/// How a wall turns, or a body at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// Angular velocity [rad/s], anticlockwise in the plane, right-handed about `axis` in space.
    pub rate: f64,
    /// Centre of rotation at the start; it moves with a wall's velocity [m].
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
    /// Index into [`Scene::materials`](super::Scene::materials).
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

/// Where particles are taken out and counted.
#[derive(Clone, Debug, PartialEq)]
pub struct Outflow {
    /// Name in the scene file: outputs `outflow.NAME.mass` and `outflow.NAME.rate`.
    pub name: String,
    /// Where it is.
    pub place: OutflowPlace,
}

/// Where an outflow is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutflowPlace {
    /// A box.
    Box {
        /// Lower corner [m].
        lower: Point,
        /// Upper corner [m].
        upper: Point,
    },
    /// All that is outside of the domain.
    Outside,
}
