//! Runs without an orchestrator: communication points and scheduled inputs.
//!
//! Points are whole multiples of the communication step, so that times never drift and a resumed run meets the points
//! of an unbroken one.

use super::{Component, ValueReference};
use crate::scene::InputTarget;

/// Share of a step within which two times count as the same point.
const SLACK: f64 = 1e-9;

/// The next communication point after `time`: a multiple of `step`, or `until` if that comes first [s].
/// `None` at the end.
#[must_use]
pub fn next_point(time: f64, step: f64, until: f64) -> Option<f64> {
    if time >= until - SLACK * step {
        return None;
    }
    let multiple = ((time / step + SLACK).floor() + 1.0) * step;
    Some(if multiple > until - SLACK * step {
        until
    } else {
        multiple
    })
}

impl Component {
    /// The scene's scheduled inputs at `time` [s]: references and values for one [`Component::set`].
    #[must_use]
    pub fn scheduled(&self, time: f64) -> (Vec<ValueReference>, Vec<f64>) {
        let scene = self.scene();
        let value = |schedule: &crate::scene::Schedule| {
            let name = match schedule.input {
                InputTarget::GateOpening(gate) => {
                    format!("gate.{}.opening", scene.gates[gate].name)
                }
                InputTarget::InflowRate(inflow) => {
                    format!("inflow.{}.rate", scene.inflows[inflow].name)
                }
            };
            let variable = self.variables().by_name(&name)?;
            Some((variable.reference, schedule.value_at(time)))
        };
        scene.schedules.iter().filter_map(value).unzip()
    }
}

#[cfg(test)]
mod tests {
    use super::next_point as next;

    #[test]
    fn points_are_multiples_and_the_end_is_met_exactly() {
        let (step, until) = (0.1, 0.35);
        let mut points = vec![0.0];
        while let Some(point) = next(points[points.len() - 1], step, until) {
            points.push(point);
        }
        assert_eq!(points, [0.0, 0.1, 0.2, 3.0 * 0.1, 0.35]);
        // 3 x 0.1 is one bit more than 0.3: the end wins, there is no step of one bit.
        assert_eq!(next(0.2, 0.1, 0.3), Some(0.3));
        assert_eq!(next(0.3, 0.1, 0.3), None);
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
            assert_eq!(time.to_bits(), (f64::from(count) * step).to_bits());
        }
    }
}
