//! A gate's plate: a rigid slab that slides along its own length and vanishes behind the end it retracts to.

mod corners;

pub use corners::Meets;

use super::points::ROWS;
use super::wall_points::WallPoints;
use crate::math::{Vector, add, dot, norm, scale, sub};

/// Share of a point below which it is hidden [1].
const HIDDEN: f64 = 1e-9;

/// A point of a plate.
#[derive(Clone, Copy, Debug)]
struct Point<const D: usize> {
    /// Distance along the axis from the leading edge [m].
    along: f64,
    /// Off the axis [m].
    offset: Vector<D>,
    /// Group that bears what is pushed on it.
    group: u16,
    /// Whether it stays where it is while the plate slides, and is hidden when the plate has left it.
    stays: bool,
}

/// Geometry of a plate: face from `from` along `axis`, body behind it.
#[derive(Clone, Debug)]
pub struct Plate<const D: usize> {
    from: Vector<D>,
    axis: Vector<D>,
    /// Unit normal of the face, towards the material.
    normal: Vector<D>,
    /// Length of the segment it closes [m].
    pub length: f64,
    /// Largest speed [m/s].
    pub max_speed: f64,
    points: Vec<Point<D>>,
    /// Spacing of points along the axis [m].
    step: f64,
    thickness: f64,
    /// Points along the axis, behind each other and across.
    count: [usize; 3],
    /// In space: direction and length of the extrusion [m].
    across: Option<(Vector<D>, f64)>,
    group: u16,
    /// Index of its first point among the wall points.
    first: usize,
}

impl<const D: usize> Plate<D> {
    /// A plate between two ends. In space it is extruded along `span`; the material lies on the side span x (to - from).
    #[must_use]
    pub fn new(
        ends: [Vector<D>; 2],
        span: &Vector<D>,
        thickness: f64,
        max_speed: f64,
        spacing: f64,
        group: u16,
    ) -> Self {
        let d = sub(&ends[1], &ends[0]);
        let length = norm(&d);
        let axis = scale(1.0 / length, &d);
        let mut normal = [0.0; D];
        if D == 2 {
            normal[0] = -axis[1];
            normal[1] = axis[0];
        } else {
            for k in 0..3 {
                normal[k] =
                    span[(k + 1) % 3] * axis[(k + 2) % 3] - span[(k + 2) % 3] * axis[(k + 1) % 3];
            }
            normal = scale(1.0 / norm(&normal), &normal);
        }
        let along = (length / spacing).round().max(1.0) as usize;
        let deep = (thickness / spacing).round().max(1.0) as usize;
        let wide = if D == 2 {
            1
        } else {
            (norm(span) / spacing).round().max(1.0) as usize
        };
        let step = length / along as f64;
        let mut plate = Self {
            from: ends[0],
            axis,
            normal,
            length,
            max_speed,
            points: Vec::new(),
            step,
            thickness,
            count: [along, deep, wide],
            across: (D == 3).then(|| (scale(1.0 / norm(span), span), norm(span))),
            group,
            first: 0,
        };
        for (i, k) in (0..along).flat_map(|i| (0..deep).map(move |k| (i, k))) {
            for m in 0..wide {
                plate.points.push(Point {
                    along: (i as f64 + 0.5) * step,
                    offset: plate.offset(k, m as f64 + 0.5),
                    group,
                    stays: false,
                });
            }
        }
        plate
    }

    /// Off the axis: in a row behind the face, and in space so many steps from the side where it begins [m].
    fn offset(&self, row: usize, steps: f64) -> Vector<D> {
        let [_, deep, wide] = self.count;
        let behind = -(row as f64 + 0.5) * self.thickness / deep as f64;
        let offset = scale(behind, &self.normal);
        self.across.map_or(offset, |(u, width)| {
            add(&offset, &scale(steps * width / wide as f64, &u))
        })
    }

    /// Place of a shut plate's point.
    fn at(&self, along: f64, offset: &Vector<D>) -> Vector<D> {
        add(&add(&self.from, &scale(along, &self.axis)), offset)
    }

    /// Where its points are when it is shut [m].
    pub fn shut(&self) -> impl Iterator<Item = Vector<D>> + '_ {
        self.points.iter().map(|p| self.at(p.along, &p.offset))
    }

    /// Adds its points to the wall points, at opening 0.
    pub fn append(&mut self, walls: &mut WallPoints<D>) {
        self.first = walls.len();
        for point in &self.points {
            walls.push(self.from, [0.0; D], self.normal, 0.0, point.group);
        }
        self.place(walls, 0.0, 0.0);
    }

    /// Range of its points among the wall points.
    #[must_use]
    pub fn range(&self) -> std::ops::Range<usize> {
        self.first..self.first + self.points.len()
    }

    /// Index of its wall group.
    #[must_use]
    pub fn group(&self) -> u16 {
        self.group
    }

    /// Velocity at a rate of opening [1/s].
    #[must_use]
    pub fn velocity(&self, rate: f64) -> Vector<D> {
        scale(rate * self.length, &self.axis)
    }

    /// Puts the points where an opening has them, with the velocity of a rate of opening [1/s].
    pub fn place(&self, walls: &mut WallPoints<D>, opening: f64, rate: f64) {
        let velocity = self.velocity(rate);
        for (n, point) in self.points.iter().enumerate() {
            let u = point.along;
            let moved = opening * self.length;
            let s = if point.stays { u } else { moved + u };
            let i = self.first + n;
            walls.position[i] = self.at(s, &point.offset);
            walls.velocity[i] = if point.stays { [0.0; D] } else { velocity };
            // What has slid past the end is hidden, the last point by its share; of that, rounding is nothing. So is what fills the
            // corner at the leading edge and is in the opening, and what the plate has left.
            let share = if u > self.length {
                (1.0 - opening) * self.length / (ROWS as f64 * self.step)
            } else {
                let left = match (point.stays, u < 0.0) {
                    (true, _) => u - moved,
                    (false, true) => -s,
                    (false, false) => self.length - s,
                };
                left / self.step + 0.5
            };
            let share = share.clamp(0.0, 1.0);
            walls.weight[i] = if share < HIDDEN { 0.0 } else { share };
        }
    }

    /// Its middle when it is shut [m]: what is beside it is asked for by the image that is nearest to this.
    #[must_use]
    pub fn middle(&self) -> Vector<D> {
        let (along, behind) = (0.5 * self.length, -0.5 * self.thickness);
        let middle = self.at(along, &scale(behind, &self.normal));
        self.across
            .map_or(middle, |(u, width)| add(&middle, &scale(0.5 * width, &u)))
    }

    /// Whether a grain at `x` touches the leading edge at an opening: closer to it than `reach` spacings or up to
    /// half a spacing past it, between the plate's faces. What lies in front of a face is not in the way.
    #[must_use]
    pub fn stopped_by(&self, x: &Vector<D>, opening: f64, spacing: f64, reach: f64) -> bool {
        let d = sub(x, &self.from);
        let past = dot(&d, &self.axis) - opening * self.length;
        let depth = -dot(&d, &self.normal);
        (-reach * spacing..0.5 * spacing).contains(&past)
            && (0.0..self.thickness).contains(&depth)
            && self
                .across
                .is_none_or(|(u, width)| (0.0..width).contains(&dot(&d, &u)))
    }

    /// Whether `x` is in the opening, between the edge and what it shuts on, and between the plate's faces.
    #[must_use]
    pub fn shuts_on(&self, x: &Vector<D>, opening: f64, spacing: f64) -> bool {
        self.stopped_by(x, opening, spacing, self.gap(opening) / spacing)
    }

    /// Length of the opening [m].
    #[must_use]
    pub fn gap(&self, opening: f64) -> f64 {
        opening * self.length
    }

    /// Depth of the opening from face to face [m].
    #[must_use]
    pub fn thickness(&self) -> f64 {
        self.thickness
    }

    /// Number of pieces of the leading edge, each about a spacing long: along it in space, from face to face in the plane.
    #[must_use]
    pub fn pieces(&self, spacing: f64) -> usize {
        let length = self.across.map_or(self.thickness, |(_, width)| width);
        (length / spacing).round().max(1.0) as usize
    }

    /// The piece of the leading edge that `x` stands before.
    #[must_use]
    pub fn piece_of(&self, x: &Vector<D>, spacing: f64) -> usize {
        let pieces = self.pieces(spacing);
        let d = sub(x, &self.from);
        let share = self.across.map_or_else(
            || -dot(&d, &self.normal) / self.thickness,
            |(u, width)| dot(&d, &u) / width,
        );
        ((share * pieces as f64).max(0.0) as usize).min(pieces - 1)
    }

    /// Unit normal from the nearest point of the plate's surface to `x`, at an opening.
    #[must_use]
    pub fn normal_at(&self, x: &Vector<D>, opening: f64) -> Vector<D> {
        let d = sub(x, &self.from);
        let along = dot(&d, &self.axis);
        let height = dot(&d, &self.normal);
        let nearest_along = along.clamp(opening * self.length, self.length);
        let nearest_height = height.clamp(-self.thickness, 0.0);
        let (da, dh) = (along - nearest_along, height - nearest_height);
        let r = (da * da + dh * dh).sqrt();
        if r <= 0.0 {
            return self.normal;
        }
        add(&scale(da / r, &self.axis), &scale(dh / r, &self.normal))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boundary::GroupSpec;

    #[test]
    fn half_open_plate_covers_its_far_half() {
        let mut plate = Plate::<2>::new([[0.0, 0.0], [1.0, 0.0]], &[0.0; 2], 0.4, 1.0, 0.1, 0);
        let mut walls = WallPoints {
            groups: vec![GroupSpec {
                free_slip: true,
                friction: 0.0,
                moves: false,
                wants_force: false,
                spin: [0.0; 3],
                drift: [0.0; 3],
            }],
            ..WallPoints::default()
        };
        plate.append(&mut walls);
        plate.place(&mut walls, 0.5, 0.0);
        let covered: f64 = walls.weight.iter().sum::<f64>() / 4.0 * 0.1;
        assert!((covered - 0.5).abs() < 1e-12);
        assert!(
            walls
                .position
                .iter()
                .zip(&walls.weight)
                .all(|(x, w)| *w == 0.0 || (x[0] > 0.5 && x[1] < 0.0))
        );
        // Normals: above the face up, in front of the leading edge along the axis.
        assert_eq!(plate.normal_at(&[0.7, 0.1], 0.5), [0.0, 1.0]);
        assert_eq!(plate.normal_at(&[0.4, -0.2], 0.5), [-1.0, 0.0]);
    }
}
