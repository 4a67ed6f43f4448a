//! `sandgate validate [NAME...]`: runs what is missing of the studies, then writes their pages.
//!
//! What is run, judged and written stands in [`crate::validate`]; here are arguments, progress and the table at the end.

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::{CliError, say, stop, threads};
use crate::validate::member::Job;
use crate::validate::page::{self, Found, Standing};
use crate::validate::queue::{self, Event};
use crate::validate::{Effort, Member, Outcome, SOURCES, Store, Study, studies};

/// What may be typed after `sandgate validate`.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Args {
    /// Studies to run, all if none is named; `--list` shows them
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Run only those whose name holds this text ("_6mm"); pages are then written from all that is finished
    #[arg(long, value_name = "TEXT", conflicts_with_all = ["list", "only_pages"])]
    members: Option<String>,
    /// Say which studies there are, what of them is finished and whether their pages are current; run nothing
    #[arg(long)]
    list: bool,
    /// Runs side by side, each on one thread; 0 means all cores
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads::parser())]
    jobs: u16,
    /// Threads of each run, for runs one after the other; 0 means all cores. Results do not depend on it; CPU times are those of all threads
    #[arg(long, value_name = "N", default_value_t = 1, conflicts_with = "jobs", value_parser = threads::parser())]
    threads: u16,
    /// Coarser and fewer runs that take some minutes in all: to see that all works, not to judge
    #[arg(long)]
    quick: bool,
    /// Run nothing; write the pages from what is finished
    #[arg(long, conflicts_with = "list")]
    only_pages: bool,
    /// Folder in which finished runs are kept [default: out/validation, or out/validation/quick]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Folder with reference data that are not part of the program (cases/reference/SOURCE.md says which)
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Folder for the pages [default: docs/validation, or out/validation/quick/pages]
    #[arg(long, value_name = "DIR")]
    pages: Option<PathBuf>,
}

const AFTER_HELP: &str = "\
Each study compares runs with published data or an exact solution and writes one page (NAME.md) with what is compared,
figures, errors, tolerances with their reasons and verdicts, and README.md, the index of all.

A finished run is kept and not run again as long as its scene and all source files that can change a result are the
same. Ctrl-C saves what is under way; the same command goes on from there, also after a kill.

Examples:
  sandgate validate --list
  sandgate validate columns --jobs 2
  sandgate validate silted_depths --members _6mm
  sandgate validate silted_dams --members paper_b_66_3mm --threads 0
  sandgate validate --quick";

/// Wall time between saves of a run under way, and between lines where nobody watches a terminal.
const SAVED_EVERY: Duration = Duration::from_secs(60);
const LINE_EVERY: Duration = Duration::from_secs(30);

impl Args {
    fn effort(&self) -> Effort {
        if self.quick {
            Effort::Quick
        } else {
            Effort::Full
        }
    }

    fn store(&self) -> Store {
        let default = if self.quick {
            "out/validation/quick"
        } else {
            "out/validation"
        };
        Store::new(self.out.as_deref().unwrap_or(Path::new(default)), SOURCES)
    }

    fn pages(&self) -> &Path {
        let default = if self.quick {
            "out/validation/quick/pages"
        } else {
            "docs/validation"
        };
        self.pages.as_deref().unwrap_or(Path::new(default))
    }

    fn studies(&self) -> Result<Vec<Study>, CliError> {
        if self.names.is_empty() {
            return Ok(studies::ALL.to_vec());
        }
        let find = |name: &String| {
            studies::by_name(name).ok_or_else(|| {
                let known: Vec<&str> = studies::ALL.iter().map(|s| s.name).collect();
                CliError::Usage(format!(
                    "there is no study {}; the studies are {}",
                    crate::units::quote(name),
                    known.join(", ")
                ))
            })
        };
        self.names.iter().map(find).collect()
    }
}

/// Carries out `sandgate validate`.
///
/// # Errors
/// [`CliError`]; what was finished or under way before it is kept.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let (studies, store, effort) = (args.studies()?, args.store(), args.effort());
    if args.list {
        return list(args, &studies, &store);
    }
    if !args.only_pages {
        let mut members = Vec::new();
        for study in &studies {
            members.extend(
                page::members(study, effort)?
                    .into_iter()
                    .map(|m| (study.name, m)),
            );
        }
        if let Some(text) = &args.members {
            let known: Vec<String> = members.iter().map(|(_, m)| m.name.clone()).collect();
            members.retain(|(_, m)| m.name.contains(text));
            if members.is_empty() {
                return Err(CliError::Usage(format!(
                    "no run's name holds {}; their names are {}",
                    crate::units::quote(text),
                    known.join(", ")
                )));
            }
        }
        run_missing(args, &store, &members)?;
    }
    let mut lines = vec![format!("pages in {}", args.pages().display())];
    for study in &studies {
        let found = Found::new(study, effort, &store)?;
        if args.only_pages && found.recordings.iter().all(Option::is_none) {
            lines.push(format!(
                "  {:24} nothing is finished, its page stays as it is",
                study.name
            ));
            continue;
        }
        let summary = page::write(args.pages(), study, &found, args.data.as_deref())?;
        lines.push(format!("  {:24} {}", study.name, summary.verdict()));
    }
    page::write_index(args.pages(), &studies::ALL)?;
    say(&lines.join("\n"))
}

/// So many, or as many as there are cores for 0.
fn or_all_cores(n: u16) -> usize {
    match n {
        0 => super::clock::cores(),
        n => usize::from(n),
    }
}

/// Runs what is not finished.
fn run_missing(args: &Args, store: &Store, members: &[(&str, Member)]) -> Result<(), CliError> {
    let mut jobs = Vec::new();
    for (study, member) in members {
        if store.current(study, member).is_none() {
            let job = Job { study, member };
            jobs.push((job.weight()?, job));
        }
    }
    // The longest first, so that no single one is left for one thread at the end.
    jobs.sort_by(|a, b| b.0.total_cmp(&a.0));
    tell!(
        "{} runs, {} of them finished before",
        members.len(),
        members.len() - jobs.len()
    );
    let (weights, jobs): (Vec<f64>, Vec<Job>) = jobs.into_iter().unzip();
    let stop = stop::on_interrupt("stopping after this step and saving")?;
    let tally = Mutex::new(Tally::new(weights));
    let plan = queue::Plan {
        store,
        jobs: or_all_cores(args.jobs),
        threads: or_all_cores(args.threads),
        saved_every: SAVED_EVERY,
        stop: &stop,
    };
    let told = queue::run(plan, &jobs, &|index, event| {
        if let Ok(mut tally) = tally.lock() {
            tally.tell(&jobs[index], index, &event);
        }
    });
    if let Ok(tally) = tally.lock() {
        tally.bar.finish_and_clear();
    }
    told?;
    if stop.load(Ordering::SeqCst) {
        return Err(CliError::Interrupted(
            "interrupted; finished runs are kept and those under way saved. The same command goes on, \
             --only-pages writes pages from what is finished"
                .to_owned(),
        ));
    }
    Ok(())
}

/// How far all jobs are together.
struct Tally {
    weights: Vec<f64>,
    /// Share of each job done, and the share it had when it was first heard of.
    shares: Vec<Option<(f64, f64)>>,
    ended: usize,
    started: Instant,
    last_line: Instant,
    bar: ProgressBar,
}

impl Tally {
    fn new(weights: Vec<f64>) -> Self {
        let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        let now = Instant::now();
        Self {
            shares: vec![None; weights.len()],
            weights,
            ended: 0,
            started: now,
            last_line: now,
            bar,
        }
    }

    fn tell(&mut self, job: &Job, index: usize, event: &Event) {
        let name = format!("{} {}", job.study, job.member.name);
        let share = match event {
            Event::Advanced(progress) => progress.share,
            Event::Kept | Event::Ended(..) => 1.0,
            Event::Saved => return,
        };
        let first = self.shares[index].map_or(share, |(_, first)| first);
        self.shares[index] = Some((share, first));
        self.bar.set_position((1000.0 * self.share_done()) as u64);
        self.bar.set_message(format!("ETA {}  {name}", self.left()));
        if let Event::Ended(outcome, cpu) = event {
            self.ended += 1;
            let how = match outcome {
                Outcome::Failed(why) => format!("FAILED: {why}"),
                Outcome::Finished | Outcome::Running => {
                    format!("finished in {cpu:.1} s of CPU time")
                }
            };
            self.line(&format!("{name}: {how}"));
        } else if self.bar.is_hidden() && self.last_line.elapsed() >= LINE_EVERY {
            self.line(&format!("{name}: {:.0} %", 100.0 * share));
        }
    }

    fn line(&mut self, text: &str) {
        self.last_line = Instant::now();
        let text = format!(
            "[{}/{}] {text}; ETA {}",
            self.ended,
            self.weights.len(),
            self.left()
        );
        self.bar.suspend(|| tell!("{text}"));
    }

    fn share_done(&self) -> f64 {
        let parts = self.weights.iter().zip(&self.shares);
        let done: f64 = parts.map(|(w, s)| w * s.map_or(0.0, |s| s.0)).sum();
        done / self.weights.iter().sum::<f64>()
    }

    /// Time left, from what was done since the start.
    fn left(&self) -> String {
        let parts = self.weights.iter().zip(&self.shares);
        let advanced: f64 = parts
            .map(|(w, s)| w * s.map_or(0.0, |(now, first)| now - first))
            .sum();
        let left = (1.0 - self.share_done()) * self.weights.iter().sum::<f64>();
        if advanced <= 0.0 {
            return "unknown".to_owned();
        }
        let seconds = self.started.elapsed().as_secs_f64() * left / advanced;
        HumanDuration(Duration::from_secs_f64(seconds.clamp(0.0, 1e9).ceil())).to_string()
    }
}

/// `--list`.
fn list(args: &Args, studies: &[Study], store: &Store) -> Result<(), CliError> {
    let mut lines = vec![format!(
        "{:24} {:>9}  {:8} what is compared",
        "study", "finished", "page"
    )];
    for study in studies {
        let found = Found::new(study, args.effort(), store)?;
        let there = found.recordings.iter().flatten().count() - found.outdated;
        let page = match page::standing(args.pages(), study, &found) {
            Standing::None => "none",
            Standing::Stale => "stale",
            Standing::Current => "current",
        };
        let finished = format!("{there}/{}", found.members.len());
        lines.push(format!(
            "{:24} {finished:>9}  {page:8} {}",
            study.name, study.title
        ));
    }
    say(&lines.join("\n"))
}
