//! What bodies are and weigh as particles, beside what their shapes would.

use super::particles::{bulk_density, lattices, particle_mass};
use crate::scene::{Dimension, Scene};

/// Masses of a body at the start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyMass {
    /// Index into [`Scene::bodies`].
    pub body: usize,
    /// Of its shape below its level, filled with its material [kg].
    pub shape: f64,
    /// Of the particles that it starts as [kg].
    pub particles: f64,
}

impl Scene {
    /// Both masses of each body. Boxes are filled exactly; of other shapes a lattice takes the places inside, whose cells
    /// cover more or less than the shape at its rim. Columns that a level cuts lengthwise are left out.
    #[must_use]
    pub fn body_masses(&self) -> Vec<BodyMass> {
        match self.dimension {
            Dimension::Two | Dimension::Axisymmetric => masses::<2>(self),
            Dimension::Three => masses::<3>(self),
        }
    }

    /// Particles that each body starts as; they stand in the bodies' order.
    #[cfg(feature = "cli")]
    pub(crate) fn body_particles(&self) -> Vec<usize> {
        let lattices = match self.dimension {
            Dimension::Two | Dimension::Axisymmetric => lattices::<2>(self),
            Dimension::Three => lattices::<3>(self),
        };
        lattices.iter().map(|l| l.points.len()).collect()
    }
}

fn masses<const D: usize>(scene: &Scene) -> Vec<BodyMass> {
    let rings = scene.dimension == Dimension::Axisymmetric;
    let width = super::geometry(scene).width();
    let bodies = scene.bodies.iter().zip(lattices::<D>(scene));
    bodies
        .enumerate()
        .filter_map(|(number, (body, lattice))| {
            let level = body.level.map(|height| (scene.up(), height));
            let density = bulk_density(scene, body);
            let places = lattice.points.iter();
            let particles = places
                .map(|place| particle_mass(scene, place, density, lattice.cell_volume))
                .sum();
            Some(BodyMass {
                body: number,
                shape: density * width * body.roundness * body.shape.measure(level, D, rings)?,
                particles,
            })
        })
        .collect()
}
