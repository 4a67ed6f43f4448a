//! `sandgate bench precision`: measures what is not measured yet, and writes table, page and figures.

use std::path::{Path, PathBuf};
use std::sync::atomic::Ordering::SeqCst;

use super::{Display, Progress};
use crate::bench::precision::{self, PrecisionRun, STUDIES, Study};
use crate::bench::{self, Error};
use crate::cli::{CliError, say, stop};

/// What may be typed after `sandgate bench precision`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Studies, all if none is named
    #[arg(value_name = "NAME")]
    names: Vec<String>,
    /// Say which studies there are; run nothing
    #[arg(long)]
    list: bool,
    /// Run nothing; write from the kept run
    #[arg(long)]
    only_page: bool,
    /// Folder in which the run is kept, as precision.json
    #[arg(long, value_name = "DIR", default_value = "benches/runs")]
    out: PathBuf,
    /// Page to write, as docs/precision.md; its figures go beside it
    #[arg(long, value_name = "FILE")]
    page: Option<PathBuf>,
    /// Table to write as CSV
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
}

/// Carries out `sandgate bench precision`.
///
/// # Errors
/// [`CliError`].
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    if args.list {
        let lines = STUDIES.iter().map(|s| format!("{:14} {}", s.name, s.about));
        return say(&lines.collect::<Vec<_>>().join("\n"));
    }
    let chosen = chosen(&args.names)?;
    let kept = args.out.join("precision.json");
    let run = if args.only_page {
        bench::stored(&kept)?
    } else {
        measure(&chosen, &kept)?
    };
    let mut lines = standings(&chosen, &run);
    if let Some(path) = &args.csv {
        bench::write(path, &precision::csv(&run))?;
    }
    if let Some(path) = &args.page {
        write_page(path, &run)?;
        lines.push(format!("page in {}", path.display()));
    }
    lines.push(format!("run in {}", kept.display()));
    say(&lines.join("\n"))
}

/// The studies that are named; all if none is.
fn chosen(names: &[String]) -> Result<Vec<&'static Study>, CliError> {
    if names.is_empty() {
        return Ok(STUDIES.iter().collect());
    }
    let find = |name: &String| {
        precision::by_name(name).ok_or_else(|| {
            let known: Vec<&str> = STUDIES.iter().map(|s| s.name).collect();
            CliError::Usage(format!(
                "there is no study {}; the studies are {}",
                crate::units::quote(name),
                known.join(", ")
            ))
        })
    };
    names.iter().map(find).collect()
}

/// Measures what is not kept, or was by another version, and keeps it.
fn measure(chosen: &[&'static Study], kept: &Path) -> Result<PrecisionRun, CliError> {
    let known = bench::stored::<PrecisionRun>(kept).map_or(Vec::new(), |run| run.measured);
    let stop = stop::on_interrupt("stopping after this measurement")?;
    let mut display = Display::new();
    let run = precision::measure(
        chosen,
        known,
        &stop,
        &mut |share, what| {
            display.show(&Progress {
                share,
                what: what.to_owned(),
            });
        },
        &mut |run| bench::store(kept, run),
    );
    display.bar.finish_and_clear();
    let run = run?;
    if stop.load(SeqCst) {
        return Err(CliError::Interrupted(
            "interrupted; what was measured is kept, the same command goes on".to_owned(),
        ));
    }
    Ok(run)
}

/// A line for each setting at each resolution: its error, its time, whether it is on the front.
fn standings(chosen: &[&'static Study], run: &PrecisionRun) -> Vec<String> {
    let mut lines = Vec::new();
    for study in chosen {
        for s in precision::standings(study, run).0 {
            let error = s
                .error
                .map_or("-".to_owned(), |e| format!("{:.3} %", 100.0 * e));
            lines.push(format!(
                "{:14} {:28} x{:<5} {error:>10} {:>8.2} s {}",
                study.name,
                s.measured.setting,
                s.measured.resolution,
                s.measured.cpu,
                if s.on_front { "front" } else { "" }
            ));
        }
    }
    lines
}

/// The page and, beside it, a figure of each study.
fn write_page(path: &Path, run: &PrecisionRun) -> Result<(), CliError> {
    bench::write(path, &precision::text(run))?;
    for study in &STUDIES {
        let figure = path.with_file_name(format!("precision_{}.svg", study.name));
        let svg = precision::figure(study, run).map_err(|why| Error::Scene {
            scene: study.name.to_owned(),
            why,
        })?;
        bench::write(&figure, &svg)?;
    }
    Ok(())
}
