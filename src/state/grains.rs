//! Particles as a structure of arrays. One list of fields for reordering and removal, so that none is forgotten.

use serde::{Deserialize, Serialize};

use crate::math::{Tensor, Vector};

/// The particles of a scene. All arrays have the same length.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Grains<const D: usize> {
    /// Whether viscosity is implicit: `viscous_change` is kept.
    pub implicit: bool,
    /// Whether the exact yield is on: `stress` and `plastic_rate` are kept.
    pub exact_yield: bool,
    /// Whether walls have Coulomb friction: `wall_traction` and `wall_slip` are kept.
    pub wall_friction: bool,
    /// Whether a material is saturated: pore pressures are kept.
    pub saturated: bool,
    /// Position x [m].
    #[serde(with = "flat")]
    pub position: Vec<Vector<D>>,
    /// Velocity v [m/s].
    #[serde(with = "flat")]
    pub velocity: Vec<Vector<D>>,
    /// Bulk density rho [kg/m^3].
    pub density: Vec<f64>,
    /// Bulk density at the last sweep over pairs, before the step's own change: pair coefficients are made of it
    /// [kg/m^3]. Scheme `paper_b`: the one at the start of the step.
    pub swept_density: Vec<f64>,
    /// Mass m, a multiple of a power of two [kg].
    pub mass: Vec<f64>,
    /// Shear rate relaxed in time, for the equation of state [1/s].
    pub relaxed_shear: Vec<f64>,
    /// Velocity change of the last viscous solve over its step: its next first guess. Scheme `paper_a`: the whole
    /// acceleration at the last half step, from which the next is predicted; scheme `paper_b`: that at
    /// the start of the step [m/s^2].
    #[serde(with = "flat")]
    pub viscous_acceleration: Vec<Vector<D>>,
    /// How it changed over the last step [m/s^2]; empty where viscosity is explicit.
    #[serde(with = "flat")]
    pub viscous_change: Vec<Vector<D>>,
    /// Stress multiplier lambda of the exact yield [Pa]; empty without it.
    #[serde(with = "flat_tensors")]
    pub stress: Vec<Tensor<D>>,
    /// Plastic strain rate q of the exact yield [1/s]; empty without it.
    #[serde(with = "flat_tensors")]
    pub plastic_rate: Vec<Tensor<D>>,
    /// Multiplier T of wall friction, along the slip that it resists [Pa]; empty without wall friction.
    #[serde(with = "flat")]
    pub wall_traction: Vec<Vector<D>>,
    /// Slip velocity s along frictional walls that belongs to it [m/s]; empty without wall friction.
    #[serde(with = "flat")]
    pub wall_slip: Vec<Vector<D>>,
    /// Pore pressure of the last seepage solve, the next one's first guess [Pa]; empty without saturated material.
    pub pore_pressure: Vec<f64>,
    /// Pore pressure relaxed in time, what the pressure of resting material follows [Pa]; empty without saturated material.
    pub relaxed_pore_pressure: Vec<f64>,
    /// Position when the neighbour lists were built [m].
    #[serde(with = "flat")]
    pub listed: Vec<Vector<D>>,
    /// Persistent number, for messages.
    pub id: Vec<u64>,
    /// Phase: index of the material.
    pub phase: Vec<u8>,
    /// Taken by an outflow and counted, or joined to another ring; removed when lists are rebuilt.
    pub drained: Vec<bool>,
}

macro_rules! for_each_field {
    ($self:ident, $f:ident, $($extra:tt)*) => {
        $f(&mut $self.position, $($extra)*);
        $f(&mut $self.velocity, $($extra)*);
        $f(&mut $self.density, $($extra)*);
        $f(&mut $self.swept_density, $($extra)*);
        $f(&mut $self.mass, $($extra)*);
        $f(&mut $self.relaxed_shear, $($extra)*);
        $f(&mut $self.viscous_acceleration, $($extra)*);
        $f(&mut $self.viscous_change, $($extra)*);
        $f(&mut $self.stress, $($extra)*);
        $f(&mut $self.plastic_rate, $($extra)*);
        $f(&mut $self.wall_traction, $($extra)*);
        $f(&mut $self.wall_slip, $($extra)*);
        $f(&mut $self.pore_pressure, $($extra)*);
        $f(&mut $self.relaxed_pore_pressure, $($extra)*);
        $f(&mut $self.listed, $($extra)*);
        $f(&mut $self.id, $($extra)*);
        $f(&mut $self.phase, $($extra)*);
        $f(&mut $self.drained, $($extra)*);
    };
}

impl<const D: usize> Grains<D> {
    /// Number of particles, drained ones included until they are removed.
    #[must_use]
    pub fn len(&self) -> usize {
        self.position.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.position.is_empty()
    }

    /// Adds a particle at rest in its own frame.
    pub fn push(
        &mut self,
        id: u64,
        phase: u8,
        position: Vector<D>,
        velocity: Vector<D>,
        mass: f64,
        density: f64,
    ) {
        self.position.push(position);
        self.velocity.push(velocity);
        self.density.push(density);
        self.swept_density.push(density);
        self.mass.push(mass);
        self.relaxed_shear.push(0.0);
        self.viscous_acceleration.push([0.0; D]);
        if self.implicit {
            self.viscous_change.push([0.0; D]);
        }
        if self.exact_yield {
            self.stress.push([[0.0; D]; D]);
            self.plastic_rate.push([[0.0; D]; D]);
        }
        if self.wall_friction {
            self.wall_traction.push([0.0; D]);
            self.wall_slip.push([0.0; D]);
        }
        if self.saturated {
            self.pore_pressure.push(0.0);
            self.relaxed_pore_pressure.push(0.0);
        }
        self.listed.push(position);
        self.id.push(id);
        self.phase.push(phase);
        self.drained.push(false);
    }

    /// Keeps the particles named by `order`, in that order.
    pub fn reorder(&mut self, order: &[u32]) {
        fn pick<T: Copy>(field: &mut Vec<T>, order: &[u32]) {
            // Fields of an option that is off are empty.
            if !field.is_empty() {
                *field = order.iter().map(|&i| field[i as usize]).collect();
            }
        }
        for_each_field!(self, pick, order);
    }

    /// Gives half of particle i's mass to a new one at `position` that is as it in all else.
    pub fn halve(&mut self, i: usize, id: u64, position: Vector<D>) {
        fn repeat<T: Copy>(field: &mut Vec<T>, i: usize) {
            // Fields of an option that is off are empty.
            if let Some(&own) = field.get(i) {
                field.push(own);
            }
        }
        self.mass[i] *= 0.5;
        for_each_field!(self, repeat, i);
        let new = self.len() - 1;
        (self.id[new], self.position[new]) = (id, position);
    }

    /// Whether all arrays have the same length, every number that must be is finite and positive, and there are no more phases than
    /// this.
    #[must_use]
    pub fn is_consistent(&self, phases: usize) -> bool {
        let n = self.len();
        let lengths = [
            self.velocity.len(),
            self.density.len(),
            self.swept_density.len(),
            self.mass.len(),
            self.relaxed_shear.len(),
            self.viscous_acceleration.len(),
            self.listed.len(),
            self.id.len(),
            self.phase.len(),
            self.drained.len(),
        ];
        let kept = |option: bool| [if option { n } else { 0 }; 2];
        lengths.iter().all(|&l| l == n)
            && self.viscous_change.len() == kept(self.implicit)[0]
            && [self.stress.len(), self.plastic_rate.len()] == kept(self.exact_yield)
            && [self.wall_traction.len(), self.wall_slip.len()] == kept(self.wall_friction)
            && [self.pore_pressure.len(), self.relaxed_pore_pressure.len()] == kept(self.saturated)
            && self.phase.iter().all(|&p| usize::from(p) < phases)
            && self
                .pore_pressure
                .iter()
                .chain(&self.relaxed_pore_pressure)
                .chain(&self.relaxed_shear)
                .all(|p| p.is_finite())
            && self
                .density
                .iter()
                .chain(&self.swept_density)
                .chain(&self.mass)
                .all(|v| v.is_finite() && *v > 0.0)
            && self
                .position
                .iter()
                .chain(&self.velocity)
                .chain(&self.listed)
                .chain(&self.viscous_acceleration)
                .chain(&self.viscous_change)
                .chain(&self.wall_traction)
                .chain(&self.wall_slip)
                .chain(self.stress.as_flattened())
                .chain(self.plastic_rate.as_flattened())
                .flatten()
                .all(|v| v.is_finite())
    }

    /// Sum of masses present [kg]; exact, whatever the order.
    #[must_use]
    pub fn present_mass(&self) -> f64 {
        self.mass
            .iter()
            .zip(&self.drained)
            .filter(|(_, d)| !**d)
            // Not `sum`: it begins at -0, the mass of no particles is 0.
            .fold(0.0, |sum, (m, _)| sum + m)
    }
}

/// Arrays of vectors as flat arrays of numbers, for serde.
pub mod flat {
    use super::Vector;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    /// Writes the components one after the other.
    ///
    /// # Errors
    /// Those of the serializer.
    pub fn serialize<S: Serializer, const D: usize>(
        rows: &[Vector<D>],
        s: S,
    ) -> Result<S::Ok, S::Error> {
        rows.as_flattened().serialize(s)
    }

    /// Reads them back.
    ///
    /// # Errors
    /// A length that is no multiple of D.
    pub fn deserialize<'de, De: Deserializer<'de>, const D: usize>(
        d: De,
    ) -> Result<Vec<Vector<D>>, De::Error> {
        let values = Vec::<f64>::deserialize(d)?;
        let (rows, rest) = values.as_chunks::<D>();
        if rest.is_empty() {
            Ok(rows.to_vec())
        } else {
            Err(De::Error::custom(
                "array length is no multiple of the dimension",
            ))
        }
    }
}

/// Arrays of tensors as flat arrays of numbers, for serde.
pub mod flat_tensors {
    use super::{Tensor, flat};
    use serde::{Deserializer, Serializer, de::Error};

    /// Writes the components row by row.
    ///
    /// # Errors
    /// Those of the serializer.
    pub fn serialize<S: Serializer, const D: usize>(
        tensors: &[Tensor<D>],
        s: S,
    ) -> Result<S::Ok, S::Error> {
        flat::serialize(tensors.as_flattened(), s)
    }

    /// Reads them back.
    ///
    /// # Errors
    /// A length that is no multiple of D x D.
    pub fn deserialize<'de, De: Deserializer<'de>, const D: usize>(
        d: De,
    ) -> Result<Vec<Tensor<D>>, De::Error> {
        let rows = flat::deserialize::<De, D>(d)?;
        let (tensors, rest) = rows.as_chunks::<D>();
        if rest.is_empty() {
            Ok(tensors.to_vec())
        } else {
            Err(De::Error::custom(
                "array length is no multiple of a tensor's",
            ))
        }
    }
}
