//! Runs without an orchestrator: their times, their inputs, their log.

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
                if v0 == v1 {
                    return v0;
                }
                let w0 = (t1 - t) / (t1 - t0);
                w0 * v0 + (1.0 - w0) * v1
            }
        }
    }
}

/// An input variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputTarget {
    /// Opening of a gate, index into [`Scene::gates`](super::Scene::gates).
    GateOpening(usize),
    /// Rate of an inflow, index into [`Scene::inflows`](super::Scene::inflows).
    InflowRate(usize),
    /// Speed or position of a steered wall, index into [`Scene::drives`](super::Scene::drives).
    WallDrive(usize),
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
