//! What a run will cost, from a short measurement of its first steps.

use crate::cli::CliError;
use crate::cli::clock::Stopwatch;
use crate::cli::run::bound_name;
use crate::component::{Component, Wish, next_point};
use crate::scene::Scene;
use crate::solver::Scheme;
use indicatif::{ProgressBar, ProgressStyle};

/// Wall time a measurement may take [s]; it ends after the internal step in hand.
const BUDGET: f64 = 3.0;

/// What the first steps took.
pub(super) struct Measured {
    simulated: f64,
    steps: u64,
    iterations: u64,
    particles: u64,
    smallest_step: f64,
    bound_by: &'static str,
    wall: f64,
    cpu: f64,
}

/// Steps the component as `sandgate run` would, for [`BUDGET`] seconds or to the end of the run.
///
/// # Errors
/// [`CliError::Component`] if a step fails.
pub(super) fn measure(component: &mut Component) -> Result<Measured, CliError> {
    let plan = component.scene().run;
    let bar = ProgressBar::new((BUDGET * 1e3) as u64);
    if let Ok(style) = ProgressStyle::with_template("measuring {wide_bar} {percent:>3} %  {msg}") {
        bar.set_style(style);
    }
    let mut measured = Measured {
        simulated: 0.0,
        steps: 0,
        iterations: 0,
        particles: component.statistics().particles,
        smallest_step: f64::INFINITY,
        bound_by: "",
        wall: 0.0,
        cpu: 0.0,
    };
    let watch = Stopwatch::start();
    while let Some(next) = next_point(component.time(), plan.step, plan.until) {
        let time = component.time();
        component.follow_schedules(time, next)?;
        // A communication step of a large scene may take an hour.
        let report = component.do_step_watched(time, next - time, &mut |moment| {
            bar.set_position((watch.wall() * 1e3) as u64);
            bar.set_message(format!("t = {:.4} s", moment.time()));
            if watch.wall() > BUDGET {
                Wish::EndAt(moment.time())
            } else {
                Wish::GoOn
            }
        })?;
        if report.smallest_step < measured.smallest_step {
            measured.smallest_step = report.smallest_step;
            measured.bound_by = bound_name(report.bound_by);
        }
        if watch.wall() > BUDGET {
            break;
        }
    }
    bar.finish_and_clear();
    let figures = component.statistics();
    measured.simulated = component.time();
    measured.steps = figures.steps;
    measured.iterations = figures.iterations;
    measured.wall = watch.wall();
    measured.cpu = watch.cpu();
    Ok(measured)
}

/// Step bounds, expected number of steps and expected cost, for people.
pub(super) fn report(scene: &Scene, m: &Measured, threads: usize) -> String {
    let numerics = &scene.numerics;
    let acoustic = numerics.acoustic_step();
    let times = match numerics.acoustic_steps {
        1 => String::new(),
        n => format!(", {n} of them to an internal step where neighbours are slow"),
    };
    let steps = m.steps.max(1) as f64;
    let mean = m.simulated / steps;
    let expected = scene.run.until / mean;
    let factor = scene.run.until / m.simulated;
    // A gate at rest says little of the steps that it takes once it lets material go.
    let more = if scene.gates.is_empty() && scene.inflows.is_empty() {
        ""
    } else {
        " (more once gates or inflows move what rests: what flows takes smaller steps)"
    };
    let mut text = format!(
        "step       acoustic bound courant h / c0 = {acoustic:.3e} s{times}; {}communication step {} s\n",
        match numerics.scheme {
            Scheme::Implicit => "viscosity is implicit and bounds nothing; ",
            Scheme::PaperA(_) | Scheme::PaperB(_) => {
                "explicit viscosity bounds it too (often by far); "
            }
        },
        scene.run.step,
    );
    text.push_str(&format!(
        "measured   {} internal steps to t = {:.4} s: mean {mean:.3e} s, smallest {:.3e} s ({}), {:.1} iterations a step\n",
        m.steps, m.simulated, m.smallest_step, m.bound_by, m.iterations as f64 / steps,
    ));
    text.push_str(&format!(
        "expected   {} s simulated = {} communication steps, about {expected:.0} internal steps{more}\n",
        scene.run.until,
        (scene.run.until / scene.run.step).ceil(),
    ));
    let each = if m.particles == 0 {
        // What flows in makes the cost, and how much of it there was on the way is not known.
        String::new()
    } else {
        let each = m.cpu * 1e6 / (steps * m.particles as f64);
        format!(" ({each:.2} us a particle and step)")
    };
    text.push_str(&format!(
        "cost       about {:.3} s of wall time and {:.3} s of CPU time on {threads} threads{each}, if the rest is like the \
         beginning\n",
        m.wall * factor,
        m.cpu * factor,
    ));
    text
}
