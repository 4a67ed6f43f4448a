//! `sandgate stress`: random scenes that try to break the scheme, and kept cases again.
//!
//! What is made and checked stands in [`crate::stress`]; here are arguments, progress and files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::{CliError, say, stop, threads};
use crate::stress::{
    Bounds, Campaign, Case, Check, Tried, generate, limits, page, run as run_case, shrink::shrink,
    store,
};

/// What may be typed after `sandgate stress`.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Args {
    /// Kept cases to run again, instead of random scenes
    #[arg(value_name = "CASE")]
    cases: Vec<PathBuf>,
    /// First seed
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Number of scenes
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = clap::value_parser!(u64).range(1..))]
    count: u64,
    /// Only this kind of scene; `--list` shows them
    #[arg(long, value_name = "KIND")]
    kind: Option<String>,
    /// Say which kinds of scenes and which checks there are; run nothing
    #[arg(long)]
    list: bool,
    /// Scenes side by side, each on one thread; 0 means all cores
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = threads::parser())]
    jobs: u16,
    /// CPU time that one run of a scene may take [s]; more is a failure
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = super::bench::positive)]
    cpu_limit: f64,
    /// Folder for what was tried and for cases that failed
    #[arg(long, value_name = "DIR", default_value = "out/stress")]
    out: PathBuf,
    /// Sweep single settings of two small scenes instead: where they break
    #[arg(long, conflicts_with_all = ["cases", "list", "kind"])]
    limits: bool,
    /// Folder in which the summary is kept for the page: stress.json, or limits.json of --limits
    #[arg(long, value_name = "DIR")]
    store: Option<PathBuf>,
    /// Run nothing; write the page from the runs in benches/runs (or --store) and the cases in cases/stress
    #[arg(long, requires = "page")]
    only_page: bool,
    /// Page to write, as docs/stability.md
    #[arg(long, value_name = "FILE", requires = "only_page")]
    page: Option<PathBuf>,
    /// Runs spent on making a failed case smaller; 0 keeps it as it is
    #[arg(long, value_name = "N", default_value_t = 150)]
    shrink: usize,
}

const AFTER_HELP: &str = "\
Each scene has at most 500 particles (kind threads: 3,000) and 2,000 internal steps (rests: more), and is the same for the
same seed. A scene that fails a check is made smaller and kept as OUT/KIND-SEED.toml; exit code 7 says that there was one.
What was tried is kept in OUT/tried.jsonl: the same command after Ctrl-C goes on from there.

Examples:
  sandgate stress --count 1000
  sandgate stress --kind silo --seed 42 --count 1
  sandgate stress out/stress/silo-42.toml";

/// Wall time between lines where nobody watches a terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);

impl Args {
    fn bounds(&self) -> Bounds {
        Bounds {
            cpu: self.cpu_limit,
        }
    }
}

/// Carries out `sandgate stress`.
///
/// # Errors
/// [`CliError::Differs`] if a check was failed; [`CliError`].
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    if args.list {
        return list();
    }
    if let Some(to) = &args.page {
        let runs = args.store.as_deref().unwrap_or(Path::new("benches/runs"));
        let stored = page::Stored::read(runs, Path::new("cases/stress"))?;
        store::write_text(to, &page::text(&stored))?;
        return say(&format!("page in {}", to.display()));
    }
    if args.limits {
        return limits(args);
    }
    if !args.cases.is_empty() {
        return again(args);
    }
    if let Some(kind) = &args.kind
        && generate::by_name(kind).is_none()
    {
        let known: Vec<&str> = generate::KINDS.iter().map(|k| k.name).collect();
        return Err(CliError::Usage(format!(
            "there is no kind of scene {}; the kinds are {}",
            crate::units::quote(kind),
            known.join(", ")
        )));
    }
    campaign(args)
}

fn list() -> Result<(), CliError> {
    let kinds = generate::KINDS
        .iter()
        .map(|k| format!("  {:10} {}", k.name, k.about));
    let checks = Check::ALL
        .iter()
        .map(|(_, name, what)| format!("  {name:11} {what}"));
    let mut lines = vec!["kinds of scenes".to_owned()];
    lines.extend(kinds);
    lines.push("checks".to_owned());
    lines.extend(checks);
    say(&lines.join("\n"))
}

/// The map of limits.
fn limits(args: &Args) -> Result<(), CliError> {
    let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
        bar.set_style(style);
    }
    let (started, mut line) = (Instant::now(), Instant::now());
    let run = limits::measure(&args.bounds(), &mut |share, what| {
        bar.set_position((1000.0 * share) as u64);
        let left = started.elapsed().as_secs_f64() * (1.0 - share) / share.max(0.01);
        let eta = HumanDuration(Duration::from_secs_f64(left.ceil()));
        bar.set_message(format!("ETA {eta}  {what}"));
        if bar.is_hidden() && line.elapsed() >= LINE_EVERY {
            line = Instant::now();
            tell!("{:.0} %  ETA {eta}  {what}", 100.0 * share);
        }
    });
    bar.finish_and_clear();
    let folder = args.store.as_deref().unwrap_or(&args.out);
    let path = folder.join("limits.json");
    store::write(&path, &run)?;
    let mut lines = Vec::new();
    for sweep in &run.sweeps {
        let failed = sweep.points.iter().filter(|p| !p.failed.is_empty());
        let failed: Vec<String> = failed
            .map(|p| format!("{} ({})", p.value, p.failed.join(", ")))
            .collect();
        let failed = if failed.is_empty() {
            "passes everywhere".to_owned()
        } else {
            format!("fails at {}", failed.join("; "))
        };
        lines.push(format!("{:6} {:20} {failed}", sweep.scene, sweep.key));
    }
    lines.push(format!("map in {}", path.display()));
    say(&lines.join("\n"))
}

/// Kept cases again.
fn again(args: &Args) -> Result<(), CliError> {
    let mut failed = 0;
    for path in &args.cases {
        let case = read(path)?;
        let outcome = run_case::run(&case, &args.bounds());
        let figures = &outcome.figures;
        let mut lines = vec![format!(
            "{}: {} particles, {} internal steps, {:.2} s of CPU time: {}",
            path.display(),
            figures.particles,
            figures.internal_steps,
            figures.cpu,
            if outcome.failures.is_empty() {
                "passed"
            } else {
                "FAILED"
            }
        )];
        for failure in &outcome.failures {
            lines.push(format!("  {}: {}", failure.check.name(), failure.what));
        }
        failed += usize::from(!outcome.failures.is_empty());
        say(&lines.join("\n"))?;
    }
    verdict(failed, args.cases.len())
}

fn verdict(failed: usize, count: usize) -> Result<(), CliError> {
    if failed == 0 {
        return Ok(());
    }
    Err(CliError::Differs(format!(
        "{failed} of {count} scenes failed"
    )))
}

fn read(path: &Path) -> Result<Case, CliError> {
    let text = std::fs::read_to_string(path).map_err(|source| CliError::File {
        action: "open case file",
        path: path.to_path_buf(),
        source,
        remedy: "give the path of a case that `sandgate stress` kept",
    })?;
    Case::read(&text).map_err(|problem| CliError::Content {
        path: path.to_path_buf(),
        problem,
        remedy: "give a case that `sandgate stress` kept",
    })
}

fn campaign(args: &Args) -> Result<(), CliError> {
    let campaign = Campaign {
        seed: args.seed,
        count: args.count,
        kind: args.kind.clone(),
        jobs: match args.jobs {
            0 => super::clock::cores(),
            n => usize::from(n),
        },
        bounds: args.bounds(),
    };
    let journal = store::Journal::open(&args.out, &campaign)?;
    let known = journal.known().to_vec();
    let stop = stop::on_interrupt("stopping after these scenes; what was tried is kept")?;
    let display = Mutex::new(Display::new(campaign.count, known.len() as u64));
    let journal = Mutex::new(journal);
    let broken = Mutex::new(None);
    let started = Instant::now();
    let earlier: BTreeSet<u64> = known.iter().map(|t| t.seed).collect();
    let tried = campaign.run(known, &stop, &|tried| {
        let kept = journal.lock().map(|mut j| j.add(tried));
        if let (Ok(Err(error)), Ok(mut slot)) = (kept, broken.lock()) {
            stop.store(true, Ordering::SeqCst);
            slot.get_or_insert(error);
        }
        if let Ok(mut display) = display.lock() {
            display.tell(tried);
        }
    });
    if let Ok(display) = display.lock() {
        display.bar.finish_and_clear();
    }
    if let Ok(Some(error)) = broken.into_inner() {
        return Err(error.into());
    }
    let failed: Vec<&Tried> = tried.iter().filter(|t| !t.failures.is_empty()).collect();
    for one in &failed {
        let path = args.out.join(format!("{}-{}.toml", one.kind, one.seed));
        // What an earlier call of this command kept stays: making it smaller again may take hours.
        if !(earlier.contains(&one.seed) && path.exists()) {
            keep(args, &campaign, one, &path, &stop)?;
        }
        if stop.load(Ordering::SeqCst) {
            break;
        }
    }
    if stop.load(Ordering::SeqCst) {
        return Err(CliError::Interrupted(format!(
            "interrupted after {} of {} scenes, {} of which failed; the same command goes on",
            tried.len(),
            campaign.count,
            failed.len()
        )));
    }
    let run = store::StressRun::new(&campaign, &tried, started.elapsed().as_secs_f64());
    let summary = match &args.store {
        Some(folder) => folder.join("stress.json"),
        None => args.out.join("summary.json"),
    };
    store::write(&summary, &run)?;
    say(&format!(
        "{}\nsummary in {}",
        run.table(),
        summary.display()
    ))?;
    verdict(failed.len(), tried.len())
}

/// Makes a failed case smaller and writes it; nothing of it once `stop` is true, and the next call begins it again.
fn keep(
    args: &Args,
    campaign: &Campaign,
    tried: &Tried,
    path: &Path,
    stop: &AtomicBool,
) -> Result<(), CliError> {
    if stop.load(Ordering::SeqCst) {
        return Ok(());
    }
    let Ok(case) = campaign.case(tried.seed) else {
        return Ok(());
    };
    let small = if args.shrink > 0 {
        tell!("making {} {} smaller", tried.kind, tried.seed);
        shrink(&case, &campaign.bounds, args.shrink, stop)
    } else {
        case
    };
    if stop.load(Ordering::SeqCst) {
        return Ok(());
    }
    let outcome = run_case::run(&small, &campaign.bounds);
    let mut head = vec![format!(
        "Made smaller from `sandgate stress --kind {} --seed {} --count 1`. It failed:",
        tried.kind, tried.seed
    )];
    for failure in &outcome.failures {
        for line in failure.what.lines() {
            head.push(format!("{}: {line}", failure.check.name()));
        }
    }
    store::write_text(path, &small.text(&head))?;
    tell!("kept {}", path.display());
    Ok(())
}

/// Progress with the time left.
struct Display {
    bar: ProgressBar,
    started: Instant,
    last_line: Instant,
    count: u64,
    before: u64,
    done: u64,
    failed: u64,
}

impl Display {
    fn new(count: u64, before: u64) -> Self {
        let bar = ProgressBar::with_draw_target(Some(count), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len}  {msg}") {
            bar.set_style(style);
        }
        let now = Instant::now();
        Self {
            bar,
            started: now,
            last_line: now,
            count,
            before,
            done: before,
            failed: 0,
        }
    }

    fn tell(&mut self, tried: &Tried) {
        self.done += 1;
        self.bar.set_position(self.done);
        let (done, left) = (
            self.done - self.before,
            self.count - self.done.min(self.count),
        );
        let seconds = self.started.elapsed().as_secs_f64() * left as f64 / done as f64;
        // Of a count like 1e19 it is longer than any clock.
        let eta = Duration::try_from_secs_f64(seconds.ceil()).unwrap_or(Duration::MAX);
        let eta = HumanDuration(eta);
        if let Some(failure) = tried.failures.first() {
            self.failed += 1;
            let text = format!(
                "FAILED {} --seed {}: {}: {}",
                tried.kind,
                tried.seed,
                failure.check.name(),
                failure.what.lines().next().unwrap_or_default()
            );
            self.bar.suspend(|| tell!("{text}"));
        }
        self.bar
            .set_message(format!("{} failed  ETA {eta}", self.failed));
        if self.bar.is_hidden() && self.last_line.elapsed() >= LINE_EVERY {
            self.last_line = Instant::now();
            tell!(
                "[{}/{}] {} failed; ETA {eta}",
                self.done,
                self.count,
                self.failed
            );
        }
    }
}
