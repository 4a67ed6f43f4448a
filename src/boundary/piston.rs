//! The part of a fixed wall that an inflow opens: its points come forward with the stream, row by row, and push what is before them.

use super::wall_points::WallPoints;
use crate::math::{Vector, add, dot, scale, sub};

/// Points of a wall behind the face of an inflow, which come forward by a spacing while a row falls due and go back as it enters.
#[derive(Clone, Debug)]
pub struct Piston<const D: usize> {
    from: Vector<D>,
    /// One for each edge of the face: what a place off `from` times it is the share of that edge [1/m].
    across: Vec<Vector<D>>,
    /// Unit normal of the face, along the stream.
    normal: Vector<D>,
    spacing: f64,
    /// Indices among the wall points, and where those are at advance 0 [m].
    points: Vec<usize>,
    position: Vec<Vector<D>>,
}

impl<const D: usize> Piston<D> {
    /// Of no points yet, behind a face that begins at `from`.
    #[must_use]
    pub fn new(from: Vector<D>, across: Vec<Vector<D>>, normal: Vector<D>, spacing: f64) -> Self {
        Self {
            from,
            across,
            normal,
            spacing,
            points: Vec::new(),
            position: Vec::new(),
        }
    }

    /// Takes those of the wall points that are `wanted`.
    pub fn take(&mut self, walls: &WallPoints<D>, wanted: impl Fn(&Self, usize) -> bool) {
        let all = 0..walls.len();
        self.points = all.filter(|&i| wanted(self, i)).collect();
        self.position = self.points.iter().map(|&i| walls.position[i]).collect();
    }

    /// Where its points are at advance 0 [m].
    #[must_use]
    pub fn position(&self) -> &[Vector<D>] {
        &self.position
    }

    /// Unit normal of the face, along the stream.
    #[must_use]
    pub fn normal(&self) -> &Vector<D> {
        &self.normal
    }

    /// Middle of the face [m].
    #[must_use]
    pub fn middle(&self) -> Vector<D> {
        self.across
            .iter()
            .fold(self.from, |x, a| add(&x, &scale(0.5 / dot(a, a), a)))
    }

    /// How far before the face a place is whose foot is on it [m]; `None` beside it.
    #[must_use]
    pub fn ahead(&self, x: &Vector<D>) -> Option<f64> {
        let off = sub(x, &self.from);
        let on_it = self
            .across
            .iter()
            .all(|a| (0.0..=1.0).contains(&dot(&off, a)));
        on_it.then(|| dot(&off, &self.normal))
    }

    /// Puts its points where they are at an advance [spacings], which grows at a rate [1/s].
    pub fn place(&self, walls: &mut WallPoints<D>, advance: f64, rate: f64) {
        let way = scale(advance * self.spacing, &self.normal);
        let velocity = scale(rate * self.spacing, &self.normal);
        for (x, &i) in self.position.iter().zip(&self.points) {
            walls.position[i] = add(x, &way);
            walls.velocity[i] = velocity;
        }
    }
}
