//! Walls that are steered while a scene runs. All that moves of such a wall is told by its way, how long it would have taken at full
//! speed [s], and its rate, the share of full speed that it has.

use super::wall_points::{GroupSpec, WallPoints};
use crate::math::{Vector, scale};

/// What an input of a wall asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Steers {
    /// The rate, from -1 to 1.
    Rate,
    /// The way, which is gone at full speed.
    Way,
}

/// How a steered wall may move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// What its input asks for.
    pub steers: Steers,
    /// Ways from one end stop to the other [s].
    pub stops: (f64, f64),
    /// Most that the rate changes by in a second, of [`Steers::Rate`] [1/s].
    pub quickness: f64,
    /// Full speed of its fastest point, of a wall that moves as a whole; 0 of a belt [m/s].
    pub speed: f64,
}

/// Way [s] and rate [1] of a steered wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Course {
    /// Time that it would have taken at full speed [s].
    pub way: f64,
    /// Share of full speed, negative: backwards.
    pub rate: f64,
}

impl Course {
    /// At full speed, where a wall is drawn.
    pub const START: Self = Self {
        way: 0.0,
        rate: 1.0,
    };
}

impl Drive {
    /// Where a wall is after `dt` [s], told what is `wanted` of it.
    #[must_use]
    pub fn advance(&self, from: Course, wanted: f64, dt: f64) -> Course {
        let rate = match self.steers {
            Steers::Rate => {
                let most = self.quickness * dt;
                let wanted = wanted.clamp(-1.0, 1.0);
                wanted.clamp(from.rate - most, from.rate + most)
            }
            Steers::Way => ((wanted - from.way) / dt).clamp(-1.0, 1.0),
        };
        let (least, most) = self.stops;
        // What speeds up has the mean of both rates.
        let mean = match self.steers == Steers::Rate && self.quickness.is_finite() {
            true => 0.5 * (from.rate + rate),
            false => rate,
        };
        let way = from.way + mean * dt;
        let held = way.clamp(least, most);
        let rate = if held == way {
            rate
        } else {
            (held - from.way) / dt
        };
        Course { way: held, rate }
    }

    /// Whether it stands where, or moves as, it is told to, but for rounding.
    #[must_use]
    pub fn is_settled(&self, now: Course, wanted: f64) -> bool {
        const SLACK: f64 = 1e-9;
        let (least, most) = self.stops;
        match self.steers {
            Steers::Rate => {
                let stopped =
                    (wanted > 0.0 && now.way >= most) || (wanted < 0.0 && now.way <= least);
                let reached = if stopped { 0.0 } else { wanted };
                (now.rate - reached).abs() < SLACK
            }
            Steers::Way => {
                now.rate.abs() < SLACK && (now.way - wanted).abs() < SLACK * (most - least)
            }
        }
    }

    /// Whether it stands still and is to go on doing so.
    #[must_use]
    pub fn rests(&self, now: Course, wanted: f64) -> bool {
        now.rate.abs() < 1e-9 && self.is_settled(now, wanted)
    }
}

/// A wall whose surface slides along itself at a speed that is steered.
#[derive(Clone, Debug)]
pub struct Belt<const D: usize> {
    /// Index of its drive.
    pub drive: usize,
    group: u16,
    points: Vec<usize>,
    /// At full speed [m/s].
    velocity: Vec<Vector<D>>,
    full: GroupSpec,
}

impl<const D: usize> Belt<D> {
    /// The points of `group` among the wall points, which move at full speed.
    #[must_use]
    pub fn new(walls: &WallPoints<D>, group: u16, drive: usize) -> Self {
        let points: Vec<usize> = (0..walls.len())
            .filter(|&i| walls.group[i] == group)
            .collect();
        Self {
            drive,
            group,
            velocity: points.iter().map(|&i| walls.velocity[i]).collect(),
            points,
            full: walls.groups[usize::from(group)],
        }
    }

    /// Its group among those of the wall points.
    #[must_use]
    pub fn group(&self) -> u16 {
        self.group
    }

    /// Gives its points the velocities of this share of full speed.
    pub fn run(&self, walls: &mut WallPoints<D>, rate: f64) {
        for (full, &i) in self.velocity.iter().zip(&self.points) {
            walls.velocity[i] = scale(rate, full);
        }
        walls.groups[usize::from(self.group)] = self.full.at_rate(rate);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT_REST: Course = Course {
        way: 0.0,
        rate: 0.0,
    };

    fn drive(steers: Steers) -> Drive {
        Drive {
            steers,
            stops: (0.0, 2.0),
            quickness: 4.0,
            speed: 1.0,
        }
    }

    #[test]
    fn a_motor_comes_to_its_speed_and_halts_at_the_end_stop() {
        let drive = drive(Steers::Rate);
        let mut now = AT_REST;
        let mut rates = Vec::new();
        for _ in 0..4 {
            now = drive.advance(now, 0.5, 0.0625);
            rates.push(now.rate);
        }
        assert_eq!(rates, [0.25, 0.5, 0.5, 0.5]);
        // The first two steps at the mean of their rates, 0.125 and 0.375.
        assert_eq!(now.way, 0.09375);
        assert!(drive.is_settled(now, 0.5) && !drive.rests(now, 0.5));
        for _ in 0..64 {
            now = drive.advance(now, 0.5, 0.0625);
        }
        assert_eq!(
            now,
            Course {
                way: 2.0,
                rate: 0.0
            }
        );
        assert!(drive.rests(now, 0.5) && !drive.is_settled(now, -0.5));
        // Back at once, by what the motor gives, and no further than where it was drawn.
        now = drive.advance(now, -9.0, 0.0625);
        assert_eq!(now.rate, -0.25);
        for _ in 0..64 {
            now = drive.advance(now, -9.0, 0.0625);
        }
        assert_eq!(now, AT_REST);
    }

    #[test]
    fn a_positioner_goes_at_full_speed_and_stands_where_it_should() {
        let drive = drive(Steers::Way);
        let mut now = AT_REST;
        let mut ways = Vec::new();
        for _ in 0..4 {
            now = drive.advance(now, 0.6, 0.25);
            ways.push(now.way);
        }
        assert_eq!(ways, [0.25, 0.5, 0.6, 0.6]);
        assert!(drive.rests(now, 0.6) && !drive.rests(now, 0.7));
        now = drive.advance(now, 0.6, 0.25);
        assert_eq!(now.rate, 0.0);
    }
}
