//! A wall that moves as a whole, at constant velocity and angular velocity or at a share of them that is steered.

use super::drive::Course;
use super::wall_points::{GroupSpec, WallPoints};
use crate::math::{Tensor, Vector, add, apply, multiply, norm, scale, skew, sub};

/// How a rigid body moves: its centre at `velocity`, turning about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion<const D: usize> {
    /// Velocity of the centre [m/s].
    pub velocity: Vector<D>,
    /// Centre of rotation at time 0 [m].
    pub centre: Vector<D>,
    /// Angular velocity [rad/s], anticlockwise in the plane.
    pub rate: f64,
    /// Unit axis of rotation in space; ignored in the plane.
    pub axis: [f64; 3],
}

impl<const D: usize> RigidMotion<D> {
    /// Where the centre is at time `t` [m].
    #[must_use]
    pub fn centre_at(&self, t: f64) -> Vector<D> {
        add(&self.centre, &scale(t, &self.velocity))
    }

    /// Rotation since time 0 (Rodrigues): I + sin(w t) J + (1 - cos(w t)) J J.
    #[must_use]
    pub fn rotation_at(&self, t: f64) -> Tensor<D> {
        let j = skew::<D>(&self.unit_axis());
        let (sin, cos) = (self.rate * t).sin_cos();
        let jj = multiply(&j, &j);
        std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                f64::from(u8::from(a == b)) + sin * j[a][b] + (1.0 - cos) * jj[a][b]
            })
        })
    }

    /// Velocity of the body's material at `x` at time `t` [m/s].
    #[must_use]
    pub fn velocity_at(&self, x: &Vector<D>, t: f64) -> Vector<D> {
        let arm = sub(x, &self.centre_at(t));
        let turning = scale(self.rate, &apply(&skew(&self.unit_axis()), &arm));
        add(&self.velocity, &turning)
    }

    /// Angular velocity [rad/s].
    #[must_use]
    pub fn spin(&self) -> [f64; 3] {
        scale(self.rate, &self.unit_axis())
    }

    fn unit_axis(&self) -> [f64; 3] {
        if D == 2 { [0.0, 0.0, 1.0] } else { self.axis }
    }
}

/// The points of a wall that moves, where they were at time 0.
#[derive(Clone, Debug)]
pub struct Mover<const D: usize> {
    /// Index of its drive, if it is steered.
    pub drive: Option<usize>,
    motion: RigidMotion<D>,
    group: u16,
    full: GroupSpec,
    points: Vec<usize>,
    position: Vec<Vector<D>>,
    normal: Vec<Vector<D>>,
    to_centre: Vec<Vector<D>>,
    /// Bound of the points' speed [m/s].
    speed: f64,
}

impl<const D: usize> Mover<D> {
    /// The points of `group` among the wall points, which stand where they are at time 0.
    #[must_use]
    pub fn new(
        walls: &WallPoints<D>,
        group: u16,
        motion: RigidMotion<D>,
        drive: Option<usize>,
    ) -> Self {
        // Not one run of points: those in acute corners come after the rows of all walls.
        let points: Vec<usize> = (0..walls.len())
            .filter(|&i| walls.group[i] == group)
            .collect();
        let of_points = |all: &[Vector<D>]| points.iter().map(|&i| all[i]).collect::<Vec<_>>();
        let position = of_points(&walls.position);
        let arm = position
            .iter()
            .map(|x| norm(&sub(x, &motion.centre)))
            .fold(0.0, f64::max);
        Self {
            drive,
            group,
            full: walls.groups[usize::from(group)],
            speed: norm(&motion.velocity) + motion.rate.abs() * arm,
            normal: of_points(&walls.normal),
            to_centre: points
                .iter()
                .map(|&i| walls.to_centre.get(i).copied().unwrap_or([0.0; D]))
                .collect(),
            position,
            motion,
            points,
        }
    }

    /// Puts its points where they are after a way [s], with the velocities of that rate.
    pub fn place(&self, walls: &mut WallPoints<D>, Course { way, rate }: Course) {
        let (turn, centre) = (self.motion.rotation_at(way), self.motion.centre_at(way));
        walls.groups[usize::from(self.group)] = self.full.at_rate(rate);
        for (n, &i) in self.points.iter().enumerate() {
            let arm = sub(&self.position[n], &self.motion.centre);
            let x = add(&centre, &apply(&turn, &arm));
            walls.velocity[i] = scale(rate, &self.motion.velocity_at(&x, way));
            walls.position[i] = x;
            walls.normal[i] = apply(&turn, &self.normal[n]);
            if let Some(to) = walls.to_centre.get_mut(i) {
                *to = apply(&turn, &self.to_centre[n]);
            }
        }
    }

    /// Its group among those of the wall points.
    #[must_use]
    pub fn group(&self) -> u16 {
        self.group
    }

    /// Its points among the wall points, ascending.
    #[must_use]
    pub fn points(&self) -> &[usize] {
        &self.points
    }

    /// How far its points move along a way [s] at most [m].
    #[must_use]
    pub fn travel(&self, way: f64) -> f64 {
        self.speed * way
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::dot;

    #[test]
    fn turning_bodies_keep_their_shape_and_move_at_their_velocity() {
        let motion = RigidMotion::<3> {
            velocity: [0.1, -0.2, 0.3],
            centre: [1.0, 2.0, 3.0],
            rate: -1.7,
            axis: [0.6, 0.0, 0.8],
        };
        let (t, dt) = (2.3, 1e-6);
        let place = |x: &Vector<3>, t: f64| {
            let turned = apply(&motion.rotation_at(t), &sub(x, &motion.centre));
            add(&motion.centre_at(t), &turned)
        };
        let (a, b) = ([0.4, 0.7, -0.3], [1.4, 0.2, 0.9]);
        let size = |x: &Vector<3>, y: &Vector<3>| norm(&sub(x, y));
        assert!((size(&place(&a, t), &place(&b, t)) - size(&a, &b)).abs() < 1e-14);
        let step = scale(0.5 / dt, &sub(&place(&a, t + dt), &place(&a, t - dt)));
        let velocity = motion.velocity_at(&place(&a, t), t);
        assert!(norm(&sub(&step, &velocity)) < 1e-8, "{step:?} {velocity:?}");
        // The rate is right-handed about the axis, which stays.
        let along = apply(&motion.rotation_at(t), &motion.axis);
        assert!((dot(&along, &motion.axis) - 1.0).abs() < 1e-14);
        let plane = RigidMotion::<2> {
            velocity: [0.0; 2],
            centre: [0.0; 2],
            rate: 2.0,
            axis: [0.0, 0.0, 1.0],
        };
        assert_eq!(plane.velocity_at(&[1.0, 0.0], 9.0), [0.0, 2.0]);
        let upright = RigidMotion::<3> {
            velocity: [0.0; 3],
            centre: [0.0; 3],
            rate: 2.0,
            axis: [0.0, 0.0, 1.0],
        };
        assert_eq!(upright.velocity_at(&[1.0, 0.0, 5.0], 9.0), [0.0, 2.0, 0.0]);
    }
}
