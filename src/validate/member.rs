//! One member: its component stepped from start to end, or on from what was saved, recording as its plan says.

use std::sync::atomic::Ordering;
use std::time::Instant;

use cpu_time::{ProcessTime, ThreadTime};

use super::{Error, Member, Outcome, Recording, Snapshot, Store, queue};
use crate::component::{Component, ValueReference, next_point};
use crate::scene::{self, Scene};

/// Slack within which a snapshot's time counts as reached [s], over a communication step.
const SLACK: f64 = 1e-6;

/// How far a member is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Simulated time over its end time, 0 to 1.
    pub share: f64,
    /// CPU time so far, earlier parts included [s].
    pub cpu: f64,
}

/// A study's member with the place it is kept at.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// The study's name.
    pub study: &'a str,
    /// The member.
    pub member: &'a Member,
}

impl Job<'_> {
    fn defect(&self, problem: impl ToString) -> Error {
        Error::Defect {
            study: self.study.to_owned(),
            member: self.member.name.clone(),
            problem: problem.to_string(),
        }
    }

    /// The member's scene.
    ///
    /// # Errors
    /// [`Error::Defect`] if its text is refused.
    pub fn scene(&self) -> Result<Scene, Error> {
        let file = format!("{}/{}", self.study, self.member.name);
        scene::parse(&file, &self.member.scene).map_err(|problems| self.defect(problems))
    }

    /// What a run costs, in particle steps of the default scheme: only for the time left.
    ///
    /// # Errors
    /// [`Error::Defect`] if the scene is refused.
    pub fn weight(&self) -> Result<f64, Error> {
        let scene = self.scene()?;
        let particles = Component::new(&scene).map_or(1, |c| c.statistics().particles);
        let numerics = &scene.numerics;
        let step =
            numerics.courant * numerics.smoothing_ratio * numerics.spacing / numerics.sound_speed;
        Ok(self.member.relative_cost * particles as f64 * scene.run.until / step)
    }

    /// Runs the member to its end and keeps it, or saves it on the way when the plan's `stop` becomes true. With one thread it
    /// computes on the calling one only, so that members side by side do not share cores and CPU times mean something.
    ///
    /// `watch` sees every communication point.
    ///
    /// # Errors
    /// [`Error::Defect`], [`Error::File`]. A step that fails is no error but a recording that says so.
    pub fn run(
        &self,
        plan: queue::Plan,
        watch: &(dyn Fn(Progress) + Sync),
    ) -> Result<Recording, Error> {
        let queue::Plan {
            store,
            saved_every,
            stop,
            threads,
            ..
        } = plan;
        let scene = self.scene()?;
        let mut run = match Run::start(self, store, &scene, threads)? {
            Ok(run) => run,
            Err(failed) => {
                store.keep(self.study, self.member, &failed)?;
                return Ok(failed);
            }
        };
        let mut saved = Instant::now();
        while let Some(next) = next_point(run.component.time(), scene.run.step, scene.run.until) {
            let stopped = stop.load(Ordering::SeqCst);
            if stopped || saved.elapsed() >= saved_every {
                let state = run.component.save().map_err(|e| self.defect(e))?;
                store.save_part(self.study, self.member, &run.recording, &state)?;
                saved = Instant::now();
            }
            if stopped {
                return Ok(run.recording);
            }
            if let Err(why) = run.step_to(next, scene.run.step, self) {
                run.recording.outcome = Outcome::Failed(why);
                break;
            }
            watch(Progress {
                share: next / scene.run.until,
                cpu: run.recording.cpu,
            });
        }
        if run.recording.outcome == Outcome::Running {
            run.recording.outcome = Outcome::Finished;
        }
        store.keep(self.study, self.member, &run.recording)?;
        Ok(run.recording)
    }
}

/// A member on its way.
struct Run {
    component: Component,
    recording: Recording,
    /// Kept variables: name, handle, number of values.
    kept: Vec<(String, ValueReference, usize)>,
    threads: usize,
}

/// CPU time from a moment on: of the calling thread, where it computes alone, else of all threads.
struct CpuClock(Option<ThreadTime>, Option<ProcessTime>);

impl CpuClock {
    fn start(threads: usize) -> Self {
        if threads == 1 {
            Self(ThreadTime::try_now().ok(), None)
        } else {
            Self(None, ProcessTime::try_now().ok())
        }
    }

    /// [s]; 0 where the system does not tell.
    fn elapsed(&self) -> f64 {
        let own = self.0.and_then(|c| c.try_elapsed().ok());
        let all = self.1.and_then(|c| c.try_elapsed().ok());
        own.or(all).unwrap_or_default().as_secs_f64()
    }
}

impl Run {
    /// At the start, or where an earlier run saved it; the inner error is a recording of a scene that cannot be built.
    fn start(
        job: &Job,
        store: &Store,
        scene: &Scene,
        threads: usize,
    ) -> Result<Result<Self, Recording>, Error> {
        let mut recording = Recording::empty(store.key(job.member));
        let mut component = match Component::new(scene) {
            Ok(component) => component,
            Err(error) => {
                recording.outcome = Outcome::Failed(error.to_string());
                return Ok(Err(recording));
            }
        };
        component.set_threads(threads);
        let kept = kept(job, &component)?;
        if let Some((saved, state)) = store.part(job.study, job.member)
            && component.restore(&state).is_ok()
        {
            let mut recording = saved;
            recording.threads = recording.threads.max(threads);
            return Ok(Ok(Self {
                component,
                recording,
                kept,
                threads,
            }));
        }
        component.initialize(0.0, None).map_err(|e| job.defect(e))?;
        recording.particles = component.statistics().particles;
        recording.threads = threads;
        let mut run = Self {
            component,
            recording,
            kept,
            threads,
        };
        run.sample(job, scene.run.step).map_err(|e| job.defect(e))?;
        Ok(Ok(run))
    }

    fn step_to(&mut self, next: f64, step: f64, job: &Job) -> Result<(), String> {
        let clock = CpuClock::start(self.threads);
        let time = self.component.time();
        let (references, values) = self.component.scheduled(time);
        let set = self.component.set(&references, &values);
        set.map_err(|e| e.to_string())?;
        let stepped = self.component.do_step(time, next - time);
        self.recording.cpu += clock.elapsed();
        stepped.map_err(|e| e.to_string())?;
        self.sample(job, step)
    }

    /// Adds the current communication point, and particles where the plan asks for them.
    fn sample(&mut self, job: &Job, step: f64) -> Result<(), String> {
        let time = self.component.time();
        self.recording.time.push(time);
        for (name, reference, length) in &self.kept {
            let mut values = vec![0.0; *length];
            let got = self.component.get(&[*reference], &mut values);
            got.map_err(|e| e.to_string())?;
            let series = self.recording.series.entry(name.clone()).or_default();
            series.push(values);
        }
        let due = job
            .member
            .plan
            .snapshots
            .get(self.recording.snapshots.len());
        if due.is_some_and(|&due| time >= due - SLACK * step) {
            self.recording.snapshots.push(snapshot(&self.component));
        }
        let figures = self.component.statistics();
        (self.recording.steps, self.recording.iterations) = (figures.steps, figures.iterations);
        Ok(())
    }
}

/// The variables that a plan names.
fn kept(job: &Job, component: &Component) -> Result<Vec<(String, ValueReference, usize)>, Error> {
    let find = |name: &String| {
        let row = component.variables().by_name(name);
        row.map(|row| (name.clone(), row.reference, row.len()))
            .ok_or_else(|| job.defect(format!("the scene has no variable {name}")))
    };
    job.member.plan.series.iter().map(find).collect()
}

fn snapshot(component: &Component) -> Snapshot {
    let view = component.particles();
    Snapshot {
        time: component.time(),
        position: view.position,
        velocity: view.velocity,
        pressure: view.pressure,
        inertial_number: view.inertial_number,
    }
}
