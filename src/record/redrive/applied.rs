//! Does again what was done: sets, steps, saves and restores as the log's [`Applied`] messages say. Where the component
//! refuses today what it took then, that is a difference, not an error.

use super::Run;
use super::outcome::RedriveError;
use crate::component::{StepReport, Wish, saved_checksum};
use crate::record::compare::{disagree, same, same_alone};
use crate::units::hex;
use crate::wire::Moment;
use crate::wire::messages::{Applied, AppliedEvent, AppliedInput, AppliedMoment};

impl Run {
    /// Does what was done then. What is refused now was accepted then, so it is a difference.
    pub(super) fn apply(
        &mut self,
        applied: &Applied,
    ) -> Result<Option<(String, String)>, RedriveError> {
        for input in &applied.inputs {
            self.done.inputs += 1;
            if let Some(different) = self.set(input, &applied.source) {
                return Ok(Some(different));
            }
        }
        let (t, h) = (
            f64::from_bits(applied.t_bits),
            f64::from_bits(applied.h_bits),
        );
        if !(same_alone(applied.t, t) && same_alone(applied.h, h)) {
            return Ok(Some((
                "time".to_owned(),
                disagree(&[t, h], &[applied.t, applied.h]),
            )));
        }
        let refused = |call: &str, error: String| {
            let what = format!("{call} was done then and is refused now: {error}");
            Some(("time".to_owned(), what))
        };
        match applied.event() {
            AppliedEvent::Initialize => {
                let stop = h.is_finite().then_some(h);
                if let Err(error) = self.component.initialize(t, stop) {
                    return Ok(refused("initialize", error.to_string()));
                }
                if let Some(recorder) = &mut self.recorder {
                    recorder.record_initialization(&self.component, t, stop, &applied.source)?;
                }
            }
            AppliedEvent::Step => {
                let report = match self.step(t, h, &applied.moments, &applied.source) {
                    Ok(report) => report,
                    Err(error) => return Ok(refused("this step", error)),
                };
                let inside = applied
                    .moments
                    .iter()
                    .map(|moment| moment.inputs.len() as u64);
                self.done.inputs += inside.sum::<u64>();
                self.done.steps += 1;
                self.report = Some(report);
                if let Some(recorder) = &mut self.recorder {
                    recorder.record_step(&self.component, &report, t, h, &applied.source)?;
                }
            }
            AppliedEvent::Reset => self.component.reset()?,
            AppliedEvent::Save => return self.save(applied),
            AppliedEvent::Restore if !applied.state.is_empty() => return self.restore(applied),
            // The state it was restored to is the one that the file starts from.
            AppliedEvent::Restore | AppliedEvent::Set => {}
        }
        Ok(None)
    }

    /// The step, with what was done inside it then.
    fn step(
        &mut self,
        t: f64,
        h: f64,
        moments: &[AppliedMoment],
        source: &str,
    ) -> Result<StepReport, String> {
        if moments.is_empty() {
            let done = self.component.do_step(t, h);
            return done.map_err(|error| error.to_string());
        }
        let mut left = moments.iter().peekable();
        let mut done = Vec::new();
        let mut refused = None;
        let report = self.component.do_step_watched(t, h, &mut |moment| {
            let now = moment.time().to_bits();
            let Some(applied) = left.next_if(|first| first.t_bits == now) else {
                return Wish::GoOn;
            };
            let mut inputs = Vec::new();
            for input in &applied.inputs {
                let values: Vec<f64> = input.bits.iter().map(|&b| f64::from_bits(b)).collect();
                if let Err(error) = moment.set(&[input.reference], &values) {
                    refused.get_or_insert(error);
                }
                inputs.push((vec![input.reference], values));
            }
            let wish = match applied.ends {
                true => Wish::EndAt(f64::from_bits(applied.end_bits)),
                false => Wish::GoOn,
            };
            done.push(Moment {
                time: moment.time(),
                inputs,
                wish,
            });
            wish
        });
        let report = report.map_err(|error| error.to_string())?;
        if let Some(error) = refused {
            return Err(error.to_string());
        }
        if let Some(applied) = left.next() {
            let time = f64::from_bits(applied.t_bits);
            return Err(format!("no internal step ends at t = {time:?} s"));
        }
        if let Some(recorder) = &mut self.recorder {
            for moment in &done {
                recorder.record_moment(&self.component, moment, source);
            }
        }
        Ok(report)
    }

    /// A state was saved then: the same one now?
    fn save(&mut self, applied: &Applied) -> Result<Option<(String, String)>, RedriveError> {
        let bytes = self.component.save()?;
        let own = saved_checksum(&bytes).unwrap_or_default();
        if applied.state != own {
            let what = format!(
                "the log says checksum {}, computed {}",
                hex(&applied.state),
                hex(&own)
            );
            return Ok(Some(("saved state".to_owned(), what)));
        }
        if let Some(recorder) = &mut self.recorder {
            recorder.record_save(&self.component, &own, &applied.source)?;
        }
        if self.restored.contains_key(&applied.state) {
            self.saved.insert(applied.state.clone(), bytes);
        }
        Ok(None)
    }

    /// The component was brought back to a state then.
    fn restore(&mut self, applied: &Applied) -> Result<Option<(String, String)>, RedriveError> {
        let Some(bytes) = self.saved.get(&applied.state) else {
            let what = format!("no state {} was saved before", hex(&applied.state));
            return Ok(Some(("restored state".to_owned(), what)));
        };
        self.component.restore(bytes)?;
        if let Some(left) = self.restored.get_mut(&applied.state) {
            *left = left.saturating_sub(1);
            if *left == 0 {
                self.restored.remove(&applied.state);
                self.saved.remove(&applied.state);
            }
        }
        self.done.restored += 1;
        self.report = None;
        let state = <[u8; 32]>::try_from(applied.state.as_slice()).unwrap_or_default();
        if let Some(recorder) = &mut self.recorder {
            recorder.record_restore(&self.component, &state, &applied.source)?;
        }
        Ok(None)
    }

    fn set(&mut self, input: &AppliedInput, source: &str) -> Option<(String, String)> {
        let values: Vec<f64> = input
            .bits
            .iter()
            .map(|&bits| f64::from_bits(bits))
            .collect();
        if !same(&values, &input.values) {
            let what = format!("input {}", disagree(&values, &input.values));
            return Some((input.name.clone(), what));
        }
        let known = self.component.variables().by_name(&input.name);
        let Some(reference) = known.map(|row| row.reference) else {
            return Some((input.name.clone(), "no such variable now".to_owned()));
        };
        let done = if input.slope {
            self.component.set_input_derivatives(&[reference], &values)
        } else {
            self.component.set(&[reference], &values)
        };
        if let Err(error) = done {
            let what = format!("was set then and is refused now: {error}");
            return Some((input.name.clone(), what));
        }
        if let Some(recorder) = &mut self.recorder {
            let by = if input.source.is_empty() {
                source
            } else {
                &input.source
            };
            if input.slope {
                recorder.record_slopes(&self.component, &[reference], &values, by);
            } else {
                recorder.record_inputs(&self.component, &[reference], &values, by);
            }
        }
        None
    }
}
