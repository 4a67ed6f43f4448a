//! Runs without an orchestrator: communication points and scheduled inputs.
//!
//! Points are whole multiples of the communication step, so that times never drift and a resumed run meets the points
//! of an unbroken one. Of a step of whole nanoseconds they are the nearest numbers to whole nanoseconds, which are the times
//! on the wire.

use super::{Component, Error, ValueReference};
use crate::boundary::Steers;
use crate::scene::{InputTarget, Interpolation, Schedule};

/// Share of a step within which two times count as the same point.
const SLACK: f64 = 1e-9;

/// The next communication point after `time`: a multiple of `step`, or `until` if that comes first [s].
/// `None` at the end.
#[must_use]
pub fn next_point(time: f64, step: f64, until: f64) -> Option<f64> {
    // An end before the first point is no rounding of the start.
    let slack = SLACK * step.min(until);
    if time >= until - slack {
        return None;
    }
    let multiple = multiple(steps_done(time, step) + 1.0, step);
    Some(if multiple > until - slack {
        until
    } else {
        multiple
    })
}

/// The end of a step of length `step` from `time` [s]: the next multiple if it starts at one.
#[must_use]
pub fn step_end(time: f64, step: f64) -> f64 {
    let count = (time / step).round();
    if (time / step - count).abs() <= slack(count) {
        multiple(count + 1.0, step)
    } else {
        time + step
    }
}

/// Whole steps from 0 to `time`.
fn steps_done(time: f64, step: f64) -> f64 {
    let count = time / step;
    (count + slack(count)).floor()
}

/// By how much a number of steps may be off a whole one that is meant: [`SLACK`], and the rounding of time, step and their ratio.
fn slack(count: f64) -> f64 {
    SLACK + 4.0 * f64::EPSILON * count.abs()
}

/// count x step [s].
fn multiple(count: f64, step: f64) -> f64 {
    const PER_SECOND: f64 = 1e9;
    // Below this every whole number is a double.
    const EXACT: f64 = (1_u64 << 53) as f64;
    let nanoseconds = (step * PER_SECOND).round();
    let whole = (step - nanoseconds / PER_SECOND).abs() <= f64::EPSILON * step;
    if whole && count * nanoseconds < EXACT {
        // Over 1e9 is the nearest double; times 1e-9 is one bit off for many.
        count * nanoseconds / PER_SECOND
    } else {
        count * step
    }
}

impl Component {
    /// The scene's scheduled inputs at `time` [s]: references and values for one [`Component::set`].
    #[must_use]
    pub fn scheduled(&self, time: f64) -> (Vec<ValueReference>, Vec<f64>) {
        let value = |schedule: &Schedule| {
            let reference = self.variables().input(schedule.input);
            (reference, schedule.value_at(time))
        };
        self.scene().schedules.iter().map(value).unzip()
    }

    /// Sets the scheduled inputs for a step from `time` to `next` [s], as runs do: held over it, but for positions of walls along a straight
    /// line, which get its slope. Held, they would be gone to at full speed and waited for in each step.
    ///
    /// # Errors
    /// As [`Component::set`].
    pub fn follow_schedules(&mut self, time: f64, next: f64) -> Result<Followed, Error> {
        let (references, values) = self.scheduled(time);
        self.set(&references, &values)?;
        let schedules = self.scene().schedules.iter();
        let linear = schedules.filter(|s| s.interpolation == Interpolation::Linear);
        let slope = |schedule: &Schedule| {
            let InputTarget::WallDrive(n) = schedule.input else {
                return None;
            };
            let drive = self.scene().drives().nth(n)?.1;
            let change = schedule.value_at(next) - schedule.value_at(time);
            // What does not change but for rounding stands, and lets the scene sleep.
            let stands = change.abs() <= 1e-9 * (drive.stops.1 - drive.stops.0);
            let slope = if stands { 0.0 } else { change / (next - time) };
            (drive.steers == Steers::Way).then(|| (self.variables().input(schedule.input), slope))
        };
        let (sloped, slopes): (Vec<_>, Vec<_>) = linear.filter_map(slope).unzip();
        self.set_input_derivatives(&sloped, &slopes)?;
        Ok(Followed {
            references,
            values,
            sloped,
            slopes,
        })
    }
}

/// What [`Component::follow_schedules`] set.
#[derive(Clone, Debug, PartialEq)]
pub struct Followed {
    /// Inputs.
    pub references: Vec<ValueReference>,
    /// Their values, in the variables' units.
    pub values: Vec<f64>,
    /// Those among them with a slope over the step.
    pub sloped: Vec<ValueReference>,
    /// Their slopes, in the variables' units per second.
    pub slopes: Vec<f64>,
}

#[cfg(test)]
mod tests {
    use super::{multiple, next_point as next, step_end};

    #[test]
    fn points_are_multiples_and_the_end_is_met_exactly() {
        let (step, until) = (0.1, 0.35);
        let mut points = vec![0.0];
        while let Some(point) = next(points[points.len() - 1], step, until) {
            points.push(point);
        }
        // 3 x 0.1 is one bit more than 0.3.
        assert_eq!(points, [0.0, 0.1, 0.2, 0.3, 0.35]);
        assert_eq!(next(0.2, 0.1, 0.3), Some(0.3));
        assert_eq!(next(0.3, 0.1, 0.3), None);
        // A step that is no whole number of nanoseconds; the end wins, there is no step of one bit.
        let third = 0.1 / 3.0;
        assert_eq!(next(2.0 * third, third, 1.0), Some(3.0 * third));
        assert_eq!(next(2.0 * third, third, 0.1), Some(0.1));
        assert_eq!(next(0.0, 0.1, 1e-13), Some(1e-13));
        // A start between two points goes to the next one.
        assert_eq!(next(0.15, 0.1, 1.0), Some(0.2));
    }

    #[test]
    fn a_million_steps_do_not_drift() {
        let step = 1e-3;
        let mut time = 0.0;
        for count in 1..=1_000_000_u32 {
            let point = next(time, step, 1e9).unwrap();
            // What the component reaches: time + h, bit for bit.
            time += point - time;
            assert_eq!(time.to_bits(), (f64::from(count) / 1e3).to_bits());
        }
    }

    #[test]
    fn a_step_ends_at_the_next_point_if_it_starts_at_one() {
        let (step, mut time) = (5e-3, 0.0);
        for count in 1..=100_000_u32 {
            let end = step_end(time, step);
            assert_eq!(Some(end), next(time, step, 1e9));
            time += end - time;
            assert_eq!(time.to_bits(), (f64::from(5 * count) / 1e3).to_bits());
        }
        assert_eq!(step_end(0.0125, 0.005), 0.0175);
    }

    /// A run has at most 1e8 steps (`Run::MOST_STEPS`): up to there no step is lost, empty or double.
    #[test]
    fn the_last_of_the_most_steps_are_whole() {
        for step in [1e-3, 5e-3, 7e-4, 0.1, 1e-9, 0.1 / 3.0, 3e-5] {
            for start in [4e6, 1.1e7, 6.3e7, 9.9e7] {
                for count in 0..2000 {
                    let (now, then) = (start + f64::from(count), start + f64::from(count) + 1.0);
                    let (now, then) = (multiple(now, step), multiple(then, step));
                    assert_eq!(next(now, step, f64::INFINITY), Some(then), "{step} {now}");
                    assert_eq!(step_end(now, step), then, "{step} {now}");
                }
            }
        }
    }
}
