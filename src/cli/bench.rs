//! `sandgate bench speed`: times sweeps and scenes, keeps the run and writes docs/performance.md.
//!
//! What is timed and written stands in [`crate::bench`]; here are arguments, progress and the table at the end.

mod precision;

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressStyle};

use super::{CliError, say};
use crate::bench::speed::{self, Progress};
use crate::bench::{self, Choices, SpeedRun, page};

/// What may be typed after `sandgate bench`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    #[command(subcommand)]
    what: What,
}

/// The benchmarks.
#[derive(Debug, clap::Subcommand)]
enum What {
    /// Where the time goes: sweeps alone against plain ones and a roofline kernel, whole scenes, threads
    Speed(Speed),
    /// Error against CPU time over resolutions and numerical choices, with the Pareto front
    Precision(precision::Args),
    /// What several phases cost a scene that has none of them
    Phases(PhasesArgs),
    /// Each part by itself: search, sweeps, equation of state, solve, step, save, restore, outputs, log, publish
    Units(Units),
    /// Two kept runs of `bench units`, of two commits: each part's time and the ratio
    Compare(Compare),
}

/// What may be typed after `sandgate bench phases`.
#[derive(Debug, clap::Args)]
struct PhasesArgs {
    /// Short stretches that take seconds: to see that all works, not to judge
    #[arg(long)]
    quick: bool,
    /// Time nothing; write the page from the kept run
    #[arg(long, requires = "page")]
    only_page: bool,
    /// Folder in which the run is kept, as phases.json
    #[arg(long, value_name = "DIR", default_value = "benches/runs")]
    out: PathBuf,
    /// Page to write from the run, as docs/phases.md
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

/// What may be typed after `sandgate bench units`.
#[derive(Debug, clap::Args)]
struct Units {
    /// Small sizes that take seconds
    #[arg(long)]
    quick: bool,
    /// Name of the run, the file NAME.json; name it after the commit to compare it with another
    #[arg(long, value_name = "NAME", default_value = "units", value_parser = file_name)]
    name: String,
    /// Folder in which runs are kept
    #[arg(long, value_name = "DIR", default_value = "benches/runs")]
    out: PathBuf,
}

/// What may be typed after `sandgate bench compare`.
#[derive(Debug, clap::Args)]
struct Compare {
    /// The run to compare with, a file of `bench units`
    first: PathBuf,
    /// The other
    second: PathBuf,
}

/// What may be typed after `sandgate bench speed`.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
struct Speed {
    /// Small sizes and short stretches that take seconds: to see that all works, not to judge
    #[arg(long)]
    quick: bool,
    /// Time nothing; write the page from a kept run
    #[arg(long, requires = "page")]
    only_page: bool,
    /// CPU time that scheme paper_a may take [s]
    #[arg(long, value_name = "SECONDS", default_value_t = 60.0, value_parser = positive)]
    paper_a_budget: f64,
    /// Name of the run, the file NAME.json
    #[arg(long, value_name = "NAME", default_value = "speed", value_parser = file_name)]
    name: String,
    /// Folder in which runs are kept
    #[arg(long, value_name = "DIR", default_value = "benches/runs")]
    out: PathBuf,
    /// Page to write from the run, as docs/performance.md
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
}

const AFTER_HELP: &str = "\
It takes some minutes. CPU times, medians, and what is compared runs in turns; still, do it on a machine that does
nothing else. The run is kept only when it is whole.

Examples:
  sandgate bench speed --page docs/performance.md
  sandgate bench speed --quick --out /tmp/runs";

/// Wall time between lines where nobody watches a terminal.
const LINE_EVERY: Duration = Duration::from_secs(30);

pub(super) fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("allowed is a number of seconds above 0".to_owned()),
    }
}

fn file_name(text: &str) -> Result<String, String> {
    let allowed = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    if !text.is_empty() && !text.starts_with('.') && text.chars().all(allowed) {
        Ok(text.to_owned())
    } else {
        Err("allowed are letters, digits, -, _ and . (not first)".to_owned())
    }
}

/// Carries out `sandgate bench`.
///
/// # Errors
/// [`CliError`].
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    match &args.what {
        What::Speed(args) => speed(args),
        What::Precision(args) => precision::run(args),
        What::Phases(args) => phases(args),
        What::Units(args) => units(args),
        What::Compare(args) => {
            let first = bench::stored(&args.first)?;
            let second = bench::stored(&args.second)?;
            say(bench::units::table(&first, Some(&second)).trim_end())
        }
    }
}

fn phases(args: &PhasesArgs) -> Result<(), CliError> {
    let kept = args.out.join("phases.json");
    let run = if args.only_page {
        bench::stored(&kept)?
    } else {
        let mut display = Display::new();
        let run = bench::phases::run(args.quick, &mut |share| {
            display.show(&Progress {
                share,
                what: "the column beside other phases".to_owned(),
            });
        });
        display.bar.finish_and_clear();
        let run = run?;
        bench::store(&kept, &run)?;
        run
    };
    let alone = run.phases.stretches[0].cost();
    let mut lines: Vec<String> = Vec::new();
    for stretch in &run.phases.stretches {
        lines.push(format!(
            "{:55} {:>6.2} CPU s a simulated s, {:.3} times sand alone",
            stretch.name,
            stretch.cost(),
            stretch.cost() / alone
        ));
    }
    lines.push(format!("run in {}", kept.display()));
    if let Some(page) = &args.page {
        bench::write(page, &page::phases::text(&run))?;
        lines.push(format!("page in {}", page.display()));
    }
    say(&lines.join("\n"))
}

fn units(args: &Units) -> Result<(), CliError> {
    let mut display = Display::new();
    let run = bench::units::run(args.quick, &args.out, &mut |share, what| {
        display.show(&Progress {
            share,
            what: what.to_owned(),
        });
    });
    display.bar.finish_and_clear();
    let run = run?;
    let kept = args.out.join(format!("{}.json", args.name));
    bench::store(&kept, &run)?;
    let table = bench::units::table(&run, None);
    say(&format!("{table}run in {}", kept.display()))
}

fn speed(args: &Speed) -> Result<(), CliError> {
    let kept = args.out.join(format!("{}.json", args.name));
    let run = if args.only_page {
        bench::stored(&kept)?
    } else {
        measure(args, &kept)?
    };
    if let Some(page) = &args.page {
        bench::write(page, &page::text(&run))?;
    }
    let mut lines: Vec<String> = Vec::new();
    for demand in page::demands(&run) {
        lines.push(demand.what.to_owned());
        let verdict = match run.quick {
            true => String::new(),
            false => format!("; {}", demand.verdict().replace('*', "")),
        };
        lines.push(format!(
            "    {}   (asked: {}{verdict})",
            demand.measured, demand.asked
        ));
    }
    if run.quick {
        lines.push(
            "small sizes and short stretches (--quick): nothing of this is judged".to_owned(),
        );
    }
    lines.push(format!("run in {}", kept.display()));
    if let Some(page) = &args.page {
        lines.push(format!("page in {}", page.display()));
    }
    say(&lines.join("\n"))
}

fn measure(args: &Speed, kept: &Path) -> Result<SpeedRun, CliError> {
    let choices = Choices {
        quick: args.quick,
        paper_a_budget: args.paper_a_budget,
    };
    let mut display = Display::new();
    let run = speed::run(&choices, &mut |progress| display.show(&progress));
    display.bar.finish_and_clear();
    let run = run?;
    bench::store(kept, &run)?;
    Ok(run)
}

/// Progress with the time left.
struct Display {
    bar: ProgressBar,
    started: Instant,
    last_line: Instant,
}

impl Display {
    fn new() -> Self {
        let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{wide_bar} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        let now = Instant::now();
        Self {
            bar,
            started: now,
            last_line: now,
        }
    }

    fn show(&mut self, progress: &Progress) {
        let share = progress.share.clamp(1e-6, 1.0);
        let left = self.started.elapsed().as_secs_f64() * (1.0 - share) / share;
        let left = HumanDuration(Duration::from_secs_f64(left.min(1e9).ceil()));
        let text = format!("ETA {left}  {}", progress.what);
        self.bar.set_position((1000.0 * share) as u64);
        self.bar.set_message(text.clone());
        if self.bar.is_hidden() && self.last_line.elapsed() >= LINE_EVERY {
            self.last_line = Instant::now();
            tell!("{:.0} %  {text}", 100.0 * share);
        }
    }
}
