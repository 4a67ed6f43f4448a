//! What a solver is made for, what goes into an internal step, and what it says of it.

use std::ops::Range;

use crate::boundary::{Belt, Drive, Mover, Plate, RigidMotion, WallPoints};
use crate::material::Material;
use crate::math::{Geometry, Vector, cross, sub};
use crate::state::Grains;

use super::{Numerics, Periodic, Sink, Source};

/// What a solver is made for: everything about a scene that does not change while it runs.
#[derive(Clone, Debug)]
pub struct Plan<const D: usize> {
    /// Numerical choices.
    pub numerics: Numerics,
    /// Gravity [m/s^2].
    pub gravity: Vector<D>,
    /// What coordinates stand for.
    pub geometry: Geometry,
    /// Lower corner of the domain [m].
    pub lower: Vector<D>,
    /// Upper corner of the domain [m].
    pub upper: Vector<D>,
    /// Whether grains' friction goes on into walls (docs/theory.md, W14).
    pub friction_goes_on: bool,
    /// Periodic axes.
    pub periodic: Periodic<D>,
    /// Materials by phase.
    pub materials: Vec<Material>,
    /// Points of the fixed walls; groups hold walls, then gates.
    pub walls: WallPoints<D>,
    /// Distance of each of these points behind its wall's surface [m]; only scheme `paper_a` needs it, else empty. Those of
    /// scheme `paper_b` are elements of the surface: their weight is length, or area in space, over that of a spacing.
    pub ghost_depth: Vec<f64>,
    /// Walls that move as a whole.
    pub movers: Vec<Mover<D>>,
    /// Walls whose surface slides along itself at a speed that is steered.
    pub belts: Vec<Belt<D>>,
    /// How the walls that are steered may move.
    pub drives: Vec<Drive>,
    /// Gates.
    pub plates: Vec<Plate<D>>,
    /// How bodies that turn move at the start, by the numbers of their particles.
    pub spins: Vec<(Range<u64>, RigidMotion<D>)>,
    /// Inflows.
    pub sources: Vec<Source<D>>,
    /// Outflows.
    pub sinks: Vec<Sink<D>>,
    /// Moments of walls and gates that somebody reads.
    pub moments: Vec<Moment<D>>,
}

/// A moment of what the material pushes a wall or gate with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment<const D: usize> {
    /// Index into the groups of wall points.
    pub group: u16,
    /// The point that it is taken about [m].
    pub about: Vector<D>,
}

impl<const D: usize> Moment<D> {
    /// Of a push at a place: anticlockwise in the first component in the plane, (x - about) x push in space.
    #[must_use]
    pub fn of(&self, place: &Vector<D>, push: &Vector<D>) -> Vector<D> {
        let arm = sub(place, &self.about);
        if D == 3 {
            let three = |v: &Vector<D>| std::array::from_fn(|k| v[k]);
            let whole = cross(&three(&arm), &three(push));
            return std::array::from_fn(|k| whole[k]);
        }
        let turning = arm[0] * push[1] - arm[1] * push[0];
        std::array::from_fn(|k| if k == 0 { turning } else { 0.0 })
    }
}

/// Inputs over one internal step.
#[derive(Clone, Copy, Debug)]
pub struct StepInputs<'a> {
    /// Opening wanted of each gate, 0 to 1.
    pub openings: &'a [f64],
    /// Rate of each inflow [kg/s].
    pub rates: &'a [f64],
    /// What each steered wall is told at the start of the step: its rate, or its way [s]; and what that changes by in a second.
    pub drives: &'a [(f64, f64)],
}

/// Sees each move of an internal step: positions before it [m], and the particles after it.
pub type OnMove<'a, const D: usize> = dyn FnMut(&[Vector<D>], &Grains<D>) + 'a;

/// What one internal step did.
#[derive(Clone, Copy, Debug)]
pub struct SubStep {
    /// Its length [s].
    pub dt: f64,
    /// What bound it.
    pub bound: StepBound,
    /// Iterations of the viscous solve.
    pub iterations: u32,
}

/// What bounds an internal step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum StepBound {
    /// courant h / c0.
    Acoustic,
    /// Relative motion of neighbours or walls.
    Motion,
    /// Explicit viscosity (schemes `paper_a` and `paper_b`).
    Viscous,
    /// The end of the communication step.
    Communication,
    /// Nothing: the scene sleeps, and no step was computed.
    Asleep,
}

impl StepBound {
    /// Name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            StepBound::Acoustic => "acoustic",
            StepBound::Motion => "motion",
            StepBound::Viscous => "viscous",
            StepBound::Communication => "communication",
            StepBound::Asleep => "asleep",
        }
    }
}
