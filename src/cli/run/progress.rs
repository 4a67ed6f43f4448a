//! What a run shows while it runs: a bar with the time left on a terminal, a plain line now and then elsewhere.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::summary::pace;
use crate::component::{Component, Intermediate};

/// Parts a bar is divided into; indicatif counts in whole numbers.
const PARTS: f64 = 1e6;

/// How often a bar is drawn anew inside a communication step.
const BAR_EVERY: Duration = Duration::from_millis(200);

/// How often a plain line is printed when nobody watches a terminal.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Progress of a run from one simulated time to another.
pub(super) struct Progress {
    name: String,
    from: f64,
    until: f64,
    started: Instant,
    last_line: Instant,
    last_shown: Instant,
    bar: Option<ProgressBar>,
}

impl Progress {
    /// Starts at simulated time `from` [s]; standard error decides between bar and lines. Nothing is drawn before
    /// [`Progress::show`], so that what is told until then has lines of its own.
    pub(super) fn start(name: &str, from: f64, until: f64) -> Self {
        let bar = std::io::IsTerminal::is_terminal(&std::io::stderr()).then(|| {
            let target = ProgressDrawTarget::stderr();
            let bar = ProgressBar::with_draw_target(Some(PARTS as u64), target);
            // A line that wraps is taken away with those around it, such as the answer to Ctrl-C: the text is cut at the
            // terminal's width, and what it can do without stands last.
            match ProgressStyle::with_template("{bar:16} {percent:>3} %  {wide_msg}") {
                Ok(style) => bar.with_style(style),
                Err(_) => bar,
            }
        });
        let now = Instant::now();
        Self {
            name: name.to_owned(),
            from,
            until,
            started: now,
            last_line: now,
            last_shown: now,
            bar,
        }
    }

    /// Shows where the component is.
    pub(super) fn show(&mut self, component: &Component) {
        self.show_at(component, component.time());
    }

    /// The same inside a long communication step.
    pub(super) fn show_within(&mut self, moment: &Intermediate<'_>) {
        if self.last_shown.elapsed() >= BAR_EVERY {
            self.show_at(moment.component(), moment.time());
        }
    }

    fn show_at(&mut self, component: &Component, time: f64) {
        self.last_shown = Instant::now();
        match &self.bar {
            Some(bar) => {
                let share = (time - self.from) / (self.until - self.from);
                bar.set_position((share.clamp(0.0, 1.0) * PARTS) as u64);
                bar.set_message(self.text(component, time));
            }
            None if self.last_line.elapsed() >= LINE_EVERY => {
                self.last_line = Instant::now();
                tell!("{}  {}", self.name, self.text(component, time));
            }
            None => {}
        }
    }

    /// Tells a line above the bar.
    pub(super) fn tell(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.suspend(|| tell!("{text}")),
            None => tell!("{text}"),
        }
    }

    /// Takes the bar away; the summary follows.
    pub(super) fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn text(&self, component: &Component, time: f64) -> String {
        let ledger = component.ledger();
        let wall = self.started.elapsed().as_secs_f64();
        let done = time - self.from;
        let seconds = wall / done * (self.until - time).max(0.0);
        let left = match Duration::try_from_secs_f64(seconds.ceil()) {
            Ok(left) if done > 0.0 => indicatif::HumanDuration(left).to_string(),
            _ => "unknown".to_owned(),
        };
        format!(
            "t = {:.3} of {} s  ETA {left}  {}  {} particles  mass in {:.4} out {:.4} present {:.4} error {} kg",
            time,
            self.until,
            pace(done, wall),
            component.statistics().particles,
            ledger.inflow,
            ledger.outflow,
            ledger.present,
            ledger.error(),
        )
    }
}
