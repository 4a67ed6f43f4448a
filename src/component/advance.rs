//! One communication step: check, advance the engine to t + h, sample outputs.

use super::access::saturated;
use super::engine::{Advance, Ramp, SolverError};
use super::lifecycle::{self, Call};
use super::outputs::{self, FlowMass};
use super::watch::{Intermediate, Wish};
use super::{Component, Error, Mode, StepReport};

/// Who looks at the internal steps of a communication step.
type Watcher<'w> = dyn FnMut(&mut Intermediate<'_>) -> Wish + 'w;

/// Orchestrators add up step sizes, so their time may differ from ours by rounding; more than this share (or this
/// many seconds below 1 s) is a mistake.
const TIME_SLACK: f64 = 1e-9;

/// A slope of (1 - x) / h reaches 1 only but for rounding; more than this share of the range beyond it is a mistake.
const SLOPE_SLACK: f64 = 1e-9;

/// Whether two times are the same but for an orchestrator's rounding.
fn is_same_time(a: f64, b: f64) -> bool {
    (a - b).abs() <= TIME_SLACK * b.abs().max(1.0)
}

impl Component {
    /// Advances from `t` to `t + h` exactly, in as many internal steps as stability asks for.
    ///
    /// `t` may differ from [`Component::time`] by a billionth (of it, or of a second below 1 s), for orchestrators
    /// that add up steps: the step then begins at the component's own time and ends at `t + h`, bit for bit.
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`], [`Error::BadArgument`] (t is not the current time, h not finite and positive, past the
    /// stop time, an input's slope leads out of its range): nothing happened. [`Error::Solver`]: mode is
    /// [`Mode::Failed`] afterwards, time and outputs are those of the last good step.
    pub fn do_step(&mut self, t: f64, h: f64) -> Result<StepReport, Error> {
        self.step(t, h, None)
    }

    /// As [`Component::do_step`], with a look at the component after every internal step, from the calling thread. A
    /// watcher may set inputs for the rest of the step and end it early: then the report's time is that of the early
    /// end, which is met exactly. Watching alone changes no bit.
    ///
    /// # Errors
    /// As [`Component::do_step`].
    pub fn do_step_watched(
        &mut self,
        t: f64,
        h: f64,
        watcher: &mut Watcher<'_>,
    ) -> Result<StepReport, Error> {
        self.step(t, h, Some(watcher))
    }

    fn step(
        &mut self,
        t: f64,
        h: f64,
        watcher: Option<&mut Watcher<'_>>,
    ) -> Result<StepReport, Error> {
        lifecycle::check(Call::DoStep, self.life.mode)?;
        let wanted = self.check_step(t, h)?;
        let start = self.life.time;
        let saturated = self.check_ramps(wanted - start)?;
        self.notes.extend(saturated);
        let before = FlowMass::now(self.engine.devices());
        let advanced = match watcher {
            None => {
                let advance = self.engine.advance(start, wanted, &self.life.inputs);
                advance.map(|advance| (advance, wanted))
            }
            Some(watcher) => self.advance_watched((start, wanted), &before, watcher),
        };
        let (advance, end) = advanced.map_err(|why| self.fail(why.to_string()))?;
        let outputs = outputs::sample(&self.table, self.engine.as_ref(), &before, end - start)
            .map_err(|why| self.fail(format!("at t = {end} s: {why}")))?;
        self.life.before = std::mem::replace(&mut self.life.outputs, outputs);
        self.life.steps = [end - start, self.life.steps[0]];
        self.life.time = end;
        self.life.communication_steps += 1;
        self.hold_inputs(end - start);
        Ok(StepReport {
            time: end,
            ended_early: end < wanted,
            substeps: advance.substeps,
            smallest_step: advance.smallest_step,
            bound_by: advance.bound_by,
            iterations: advance.iterations,
        })
    }

    fn fail(&mut self, why: String) -> Error {
        self.life.mode = Mode::Failed;
        self.step_failed = true;
        Error::Solver(why)
    }

    /// One internal step after the other; gives the end that was met.
    fn advance_watched(
        &mut self,
        (start, mut end): (f64, f64),
        before: &FlowMass,
        watcher: &mut Watcher<'_>,
    ) -> Result<(Advance, f64), SolverError> {
        let mut advance = Advance::none();
        self.engine.begin(start, &self.life.inputs);
        let mut time = start;
        while time < end {
            time = self
                .engine
                .substep((start, end), &self.life.inputs, &mut advance)?;
            let mut moment = Intermediate {
                component: self,
                start,
                time,
                before,
                outputs: None,
            };
            match watcher(&mut moment) {
                Wish::GoOn => {}
                Wish::EndAt(wanted) if wanted > time => end = end.min(wanted),
                // What has passed, or is no time at all: now.
                Wish::EndAt(_) => end = time,
            }
        }
        Ok((advance, end))
    }

    /// End of the step.
    fn check_step(&self, t: f64, h: f64) -> Result<f64, Error> {
        let refuse = |what: &str, found: f64, allowed: String| {
            Err(Error::BadArgument {
                call: "do_step",
                what: what.to_owned(),
                found: format!("{found} s"),
                allowed,
            })
        };
        let time = self.life.time;
        // Written so that NaN is refused.
        if !is_same_time(t, time) {
            return refuse("t", t, format!("{time} s, the current time"));
        }
        if !(h.is_finite() && h >= f64::MIN_POSITIVE) {
            let allowed = "a finite step above 0 s, not denormal";
            return refuse("h", h, allowed.to_owned());
        }
        let end = t + h;
        if end <= time {
            return refuse(
                "h",
                h,
                format!("a step that changes the time {time} s in double precision"),
            );
        }
        match self.life.stop {
            Some(stop) if end > stop && !is_same_time(end, stop) => {
                let allowed = format!("a step that ends by {stop} s, the stop time");
                refuse("t + h", end, allowed)
            }
            _ => Ok(end),
        }
    }

    /// Inputs stay in range over the step, but for the rounding of the slope; where `saturate_inputs` lets them end
    /// beyond, a note each.
    fn check_ramps(&self, h: f64) -> Result<Vec<String>, Error> {
        let mut notes = Vec::new();
        let inputs = &self.life.inputs;
        let openings = inputs.gate_opening.iter().zip(&self.scene.gates);
        let rates = inputs.inflow_rate.iter().zip(&self.scene.inflows);
        let openings = openings.map(|(ramp, g)| (ramp, format!("gate.{}.opening", g.name), 1.0));
        let rates = rates.map(|(ramp, i)| (ramp, format!("inflow.{}.rate", i.name), i.max_rate));
        for (ramp, name, most) in openings.chain(rates) {
            let reached = ramp.at(h);
            let slack = SLOPE_SLACK * most;
            if ramp.slope == 0.0 || (-slack..=most + slack).contains(&reached) {
                continue;
            }
            let what = format!("{name} at the end of the step, by its slope {}", ramp.slope);
            // An end that is not finite cannot be held to a range.
            if !self.life.saturate_inputs || !reached.is_finite() {
                return Err(Error::BadArgument {
                    call: "do_step",
                    what,
                    found: reached.to_string(),
                    allowed: format!("0 to {most}"),
                });
            }
            notes.push(saturated(&what, reached, reached.clamp(0.0, most)));
        }
        Ok(notes)
    }

    /// Inputs hold the value they reached, inside their range; slopes were for one step.
    fn hold_inputs(&mut self, h: f64) {
        let hold = |ramp: &mut Ramp, most: f64| {
            if ramp.slope != 0.0 {
                *ramp = Ramp {
                    value: ramp.at(h).clamp(0.0, most),
                    slope: 0.0,
                };
            }
        };
        let inputs = &mut self.life.inputs;
        inputs
            .gate_opening
            .iter_mut()
            .for_each(|ramp| hold(ramp, 1.0));
        for (ramp, inflow) in inputs.inflow_rate.iter_mut().zip(&self.scene.inflows) {
            hold(ramp, inflow.max_rate);
        }
    }
}
