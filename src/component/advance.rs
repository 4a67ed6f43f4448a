//! One communication step: check, advance the engine to t + h, sample outputs.

use super::access::saturated;
use super::engine::{Advance, Ramp, SolverError, input_ranges};
use super::lifecycle::{self, Call};
use super::outputs::{self, FlowMass};
use super::watch::{Intermediate, Wish};
use super::{Component, Error, Mode, StepReport};
use crate::units::{shown, shown_bound};

/// Who looks at the internal steps of a communication step.
type Watcher<'w> = dyn FnMut(&mut Intermediate<'_>) -> Wish + 'w;

/// Orchestrators add up step sizes, so their time may differ from ours by rounding: by this share of it (below 1 s this
/// many seconds), ...
const TIME_SLACK: f64 = 1e-9;
/// ... but by no more than this share of the step, which is what the step gets longer or shorter by. Far from 0 (seconds since
/// 1970) the first one alone would let whole steps pass.
const STEP_SLACK: f64 = 1e-3;
/// Any time may be off by so many of the smallest differences between doubles of its size: start + n h, once by multiplying
/// and once from the point before, differ by up to two.
const ROUNDINGS: f64 = 4.0;

/// A slope of (1 - x) / h reaches 1 only but for rounding; more than this share of the range beyond it is a mistake.
const SLOPE_SLACK: f64 = 1e-9;

/// Whether two times are the same but for an orchestrator's rounding, at the start or end of a step of length `h`.
fn is_same_time(a: f64, b: f64, h: f64) -> bool {
    let size = b.abs();
    let added_up = (TIME_SLACK * size.max(1.0)).min(STEP_SLACK * h.abs());
    (a - b).abs() <= added_up.max(ROUNDINGS * (size.next_up() - size))
}

impl Component {
    /// Advances from `t` to `t + h` exactly, in as many internal steps as stability asks for.
    ///
    /// `t` may differ from [`Component::time`] by a billionth (of it, or of a second below 1 s) but no more than a thousandth
    /// of `h`, or by the rounding of doubles, for orchestrators that add up steps: the step then begins at the component's
    /// own time and ends at `t + h`, bit for bit. It may end as much later than the stop time.
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

    /// Whether [`Component::do_step`] would begin this step, for adapters that change something first.
    ///
    /// # Errors
    /// [`Error::NotAllowedNow`], [`Error::BadArgument`], as there.
    pub fn check_step(&self, t: f64, h: f64) -> Result<(), Error> {
        lifecycle::check(Call::DoStep, self.life.mode)?;
        let end = self.step_end(t, h)?;
        self.check_ramps(end - self.life.time).map(drop)
    }

    fn step(
        &mut self,
        t: f64,
        h: f64,
        watcher: Option<&mut Watcher<'_>>,
    ) -> Result<StepReport, Error> {
        lifecycle::check(Call::DoStep, self.life.mode)?;
        let wanted = self.step_end(t, h)?;
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
        self.life.half_stepped = true;
        self.step_failed = true;
        Error::Solver(why)
    }

    /// One internal step after the other; gives the end that was met.
    fn advance_watched(
        &mut self,
        (start, wanted): (f64, f64),
        before: &FlowMass,
        watcher: &mut Watcher<'_>,
    ) -> Result<(Advance, f64), SolverError> {
        let mut advance = Advance::none();
        self.engine.begin(start, &self.life.inputs);
        let (mut time, mut end) = (start, wanted);
        while time < end {
            time = self
                .engine
                .substep((start, end), &self.life.inputs, &mut advance)?;
            let mut moment = Intermediate {
                component: self,
                start,
                end: wanted,
                time,
                before,
                outputs: None,
            };
            match watcher(&mut moment) {
                Wish::GoOn => {}
                Wish::EndAt(earlier) if earlier > time => end = end.min(earlier),
                // What has passed, or is no time at all: now.
                Wish::EndAt(_) => end = time,
            }
        }
        Ok((advance, end))
    }

    /// End of the step.
    fn step_end(&self, t: f64, h: f64) -> Result<f64, Error> {
        let refuse = |what: &str, found: f64, allowed: String| {
            Err(Error::BadArgument {
                call: "do_step",
                what: what.to_owned(),
                found: format!("{} s", shown(found)),
                allowed,
                remedy: String::new(),
            })
        };
        let time = self.life.time;
        if !(h.is_finite() && h >= f64::MIN_POSITIVE) {
            let allowed = "a finite step above 0 s, not denormal";
            return refuse("h", h, allowed.to_owned());
        }
        // Written so that NaN is refused.
        if !is_same_time(t, time, h) {
            return refuse("t", t, format!("{} s, the current time", shown(time)));
        }
        let end = t + h;
        self.check_fineness("do_step", "t + h", end)?;
        if end <= time {
            let (now, next) = (shown(time), shown(time.next_up()));
            let allowed = format!("a time after {now} s, the current time: {next} s or more");
            return refuse("t + h", end, allowed);
        }
        match self.life.stop {
            Some(stop) if end > stop && !is_same_time(end, stop, h) => {
                let allowed = format!("a step that ends by {} s, the stop time", shown(stop));
                refuse("t + h", end, allowed)
            }
            _ => Ok(end),
        }
    }

    /// Inputs stay in range over the step, but for the rounding of the slope; where `saturate_inputs` lets them end
    /// beyond, a note each.
    fn check_ramps(&self, h: f64) -> Result<Vec<String>, Error> {
        let mut notes = Vec::new();
        let ranges = self.life.inputs.all().zip(input_ranges(&self.scene));
        for (ramp, (input, (least, most))) in ranges {
            let reached = ramp.at(h);
            let slack = SLOPE_SLACK * (most - least);
            if ramp.slope == 0.0 || (least - slack..=most + slack).contains(&reached) {
                continue;
            }
            let slope = shown(ramp.slope);
            let name = &self.table.rows()[self.table.input(input) as usize].name;
            let what = format!("{name} at the end of the step, by its slope {slope}");
            // An end that is not finite cannot be held to a range.
            if !self.life.saturate_inputs || !reached.is_finite() {
                return Err(Error::BadArgument {
                    call: "do_step",
                    what,
                    found: shown(reached),
                    allowed: format!("{} to {}", shown_bound(least), shown_bound(most)),
                    remedy: "give another slope; 0 holds the value".to_owned(),
                });
            }
            notes.push(saturated(&what, reached, reached.clamp(least, most)));
        }
        Ok(notes)
    }

    /// Inputs hold the value they reached, inside their range; slopes were for one step.
    fn hold_inputs(&mut self, h: f64) {
        let inputs = self.life.inputs.all_mut();
        for (ramp, (_, (least, most))) in inputs.zip(input_ranges(&self.scene)) {
            if ramp.slope != 0.0 {
                *ramp = Ramp {
                    value: ramp.at(h).clamp(least, most),
                    slope: 0.0,
                };
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::is_same_time;

    #[test]
    fn a_million_steps_of_any_driver_are_taken() {
        for start in [0.0, -3.7, 1.0, 1e3, 86_400.0, 1.7e9] {
            for h in [1e-3, 1e-2, 0.1 / 3.0, 1.0 / 256.0, 0.3] {
                let (mut time, mut summed) = (start, start);
                for n in 0..1_000_000_u32 {
                    let t = start + f64::from(n) * h;
                    assert!(is_same_time(t, time, h), "{start} {h} {n}: {t} {time}");
                    time = t + h;
                    summed += h;
                }
                // One who has added up goes on as one who multiplies.
                assert!(
                    start != 0.0 || is_same_time(summed, time, h),
                    "{h}: {summed}"
                );
            }
        }
    }

    #[test]
    fn no_step_is_lengthened_or_skipped_by_more_than_a_thousandth() {
        for (t, h) in [(1.7e9, 0.01), (1e6, 1e-3), (1e5, 1e-5), (0.0, 1e-7)] {
            assert!(!is_same_time(t + 1.1e-3 * h, t, h), "{t} {h}");
            assert!(!is_same_time(t - h, t, h), "{t} {h}");
        }
        // As before where times are small.
        assert!(is_same_time(1.0 + 0.9e-9, 1.0, 0.01) && !is_same_time(1.0 + 1.1e-9, 1.0, 0.01));
        assert!(!is_same_time(f64::NAN, 0.0, 0.01));
    }
}
