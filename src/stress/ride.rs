//! Steps a component as a case's drive says: inputs from the scene's schedules, communication steps in turn, cut after so
//! many internal steps.

use cpu_time::ThreadTime;

use crate::component::{Component, Error, StepReport, ValueReference, Wish};
use crate::scene::{InputTarget, Scene, Schedule};

use super::Case;

/// Most pieces of a communication step.
const MOST_PIECES: f64 = 5000.0;

/// One communication step that was done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Done {
    /// The step that was asked for [s].
    pub(super) asked: f64,
    /// Internal steps after which it was cut, if it was.
    pub(super) cut: Option<u64>,
    /// What the component said.
    pub(super) report: StepReport,
}

/// A component on its way.
pub(super) struct Ride<'a> {
    case: &'a Case,
    scene: &'a Scene,
    /// The component.
    pub(super) component: Component,
    inputs: Vec<(ValueReference, &'a Schedule)>,
    /// Communication steps so far.
    pub(super) index: usize,
    /// Internal steps so far.
    pub(super) internal: u64,
    /// Set when internal steps or CPU time ran out.
    pub(super) over: bool,
    /// CPU time spent in steps [s], and what is allowed.
    pub(super) cpu: f64,
    most_cpu: f64,
    /// Estimate of an internal step [s].
    internal_step: f64,
    /// Each communication step is done in so many; inputs change at the first of them only.
    pieces: usize,
    /// Internal steps that are allowed.
    most_steps: u64,
    told: Vec<f64>,
}

impl<'a> Ride<'a> {
    /// At the start, initialised.
    ///
    /// # Errors
    /// The component's refusals.
    pub(super) fn new(case: &'a Case, scene: &'a Scene, most_cpu: f64) -> Result<Self, Error> {
        let mut component = Component::new(scene)?;
        component.initialize(0.0, None)?;
        let table = component.variables();
        let schedules = scene.schedules.iter();
        let inputs = schedules.map(|s| (table.input(s.input), s)).collect();
        let internal_step = scene.numerics.longest_step();
        Ok(Self {
            case,
            scene,
            component,
            inputs,
            index: 0,
            internal: 0,
            over: false,
            cpu: 0.0,
            most_cpu,
            internal_step,
            pieces: 1,
            most_steps: case.drive.most_steps,
            told: Vec::new(),
        })
    }

    /// Each communication step in pieces of about an internal step, told the same at the same times: what gates do to
    /// the material is then known force by force, and not by the mean over a step in which a plate moved for a moment.
    pub(super) fn in_pieces(mut self) -> Self {
        let longest = self.case.drive.steps.iter().copied().fold(0.0, f64::max);
        let pieces = (longest / self.internal_step).ceil();
        self.pieces = pieces.clamp(1.0, MOST_PIECES) as usize;
        // Each piece ends with an internal step that is cut short.
        self.most_steps = self.most_steps.saturating_mul(2);
        self
    }

    /// Whether the CPU time ran out.
    pub(super) fn is_hung(&self) -> bool {
        self.cpu > self.most_cpu
    }

    /// What each input will be told at the next communication point.
    pub(super) fn wanted(&self) -> Vec<(InputTarget, f64)> {
        let time = self.component.time();
        let fresh = self.index.is_multiple_of(self.pieces);
        let told = |(n, (_, s)): (usize, &(ValueReference, &Schedule))| {
            let held = self.told.get(n).copied().filter(|_| !fresh);
            (s.input, held.unwrap_or_else(|| s.value_at(time)))
        };
        self.inputs.iter().enumerate().map(told).collect()
    }

    /// The next communication step; `None` at the end.
    ///
    /// # Errors
    /// The component's.
    pub(super) fn next(&mut self) -> Option<Result<Done, Error>> {
        if self.over || self.index >= self.case.drive.count * self.pieces {
            return None;
        }
        let steps = &self.case.drive.steps;
        let asked = steps[self.index / self.pieces % steps.len()] / self.pieces as f64;
        let left = self.most_steps.saturating_sub(self.internal);
        // Watched only where it may have to be cut: plain steps are what most users do.
        let watched = asked > self.internal_step * left as f64 / 3.0;
        Some(self.step(asked, watched.then_some(left)))
    }

    /// A step that another ride did, watched at every internal step and cut at the same one.
    ///
    /// # Errors
    /// The component's.
    pub(super) fn again(&mut self, done: &Done) -> Result<Done, Error> {
        self.step(done.asked, Some(done.cut.unwrap_or(u64::MAX)))
    }

    fn step(&mut self, asked: f64, watch: Option<u64>) -> Result<Done, Error> {
        let time = self.component.time();
        if self.index.is_multiple_of(self.pieces) {
            let inputs = self.inputs.iter();
            self.told = inputs.map(|(_, s)| s.value_at(time)).collect();
        }
        for ((reference, _), value) in self.inputs.iter().zip(&self.told) {
            self.component.set(&[*reference], &[*value])?;
        }
        let clock = ThreadTime::try_now().ok();
        let spent = || clock.and_then(|c| c.try_elapsed().ok());
        let left = self.most_cpu - self.cpu;
        let mut cut = None;
        let report = match watch {
            None => self.component.do_step(time, asked),
            Some(most) => {
                let mut count = 0;
                self.component.do_step_watched(time, asked, &mut |moment| {
                    count += 1;
                    let late = count % 16 == 0 && spent().is_some_and(|s| s.as_secs_f64() > left);
                    if count >= most || late {
                        cut = Some(count);
                        return Wish::EndAt(moment.time());
                    }
                    Wish::GoOn
                })
            }
        };
        self.cpu += spent().map_or(0.0, |s| s.as_secs_f64());
        let report = report?;
        self.index += 1;
        self.internal += report.substeps;
        self.over |= self.internal >= self.most_steps || self.is_hung();
        Ok(Done { asked, cut, report })
    }

    /// The scene.
    pub(super) fn scene(&self) -> &'a Scene {
        self.scene
    }
}
