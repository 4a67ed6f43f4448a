//! `sandgate log export FILE`: tables and pictures for other programs.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::{Path, PathBuf};

use super::{Window, parquet, vtk, warn_unless_complete};
use crate::cli::{CliError, say};
use crate::record::{Ending, Table};

/// What may be typed after `sandgate log export`.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
#[group(id = "formats", required = true, multiple = true, args = ["csv", "parquet", "vtk"])]
pub(super) struct Args {
    /// A log file
    file: PathBuf,
    /// All scalars over time, a row each communication point, as the run's gauges.csv has them
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,
    /// The same and the step as Parquet; its metadata has units and descriptions as unit.NAME and description.NAME
    #[arg(long, value_name = "FILE")]
    parquet: Option<PathBuf>,
    /// Particles, walls and gates as VTK in a new folder; open particles.pvd and walls.pvd in ParaView
    #[arg(long, value_name = "DIR")]
    vtk: Option<PathBuf>,
    #[command(flatten)]
    window: Window,
}

const AFTER_HELP: &str = "\
Examples:
  sandgate log export run.mcap --csv gauges.csv --parquet gauges.parquet
  sandgate log export run.mcap --vtk vtk --from '1 s'

All values are SI. Files that exist are not overwritten.";

/// Carries out `sandgate log export`.
///
/// # Errors
/// [`CliError::Table`], [`CliError::Read`], [`CliError::File`]. A cut is told on standard error and is no error.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let mut ending = Ending::Complete;
    if args.csv.is_some() || args.parquet.is_some() {
        let table = Table::read(&args.file, args.window.span())?;
        if table.time.is_empty() {
            let whole = Table::read(&args.file, (f64::NEG_INFINITY, f64::INFINITY))?;
            let nothing = nothing_between(args.window.span(), &whole.time);
            tell!("warning: {}: {nothing}", args.file.display());
        }
        // Both before either is written, so that a name that is taken leaves nothing behind.
        let csv = args.csv.as_deref().map(create).transpose()?;
        let parquet = args.parquet.as_deref().map(create).transpose();
        let parquet = parquet.inspect_err(|_| args.csv.iter().for_each(|path| remove(path)))?;
        // Beside the scalars a CSV file has the time, a Parquet file time and step.
        let shape = |more: usize| {
            let columns = table.columns.len() + more;
            format!("{} rows, {columns} columns", table.time.len())
        };
        let mut unwritten = [&args.csv, &args.parquet].into_iter().flatten();
        let mut written = |path: &Path, done: std::io::Result<()>, more: usize| {
            if let Err(error) = done {
                unwritten.by_ref().for_each(|path| remove(path));
                return Err(cannot_write(path, error));
            }
            unwritten.next();
            say(&format!("{}: {}", path.display(), shape(more)))
        };
        if let (Some(path), Some(file)) = (&args.csv, csv) {
            let mut file = BufWriter::new(file);
            let done = write_csv(&mut file, &table).and_then(|()| file.flush());
            written(path, done, 1)?;
        }
        if let (Some(path), Some(file)) = (&args.parquet, parquet) {
            let done = parquet::write(file, &table);
            written(path, done.map_err(std::io::Error::other), 2)?;
        }
        ending = table.ending;
    }
    if let Some(folder) = &args.vtk {
        let (line, ends) = vtk::write(&args.file, folder, &args.window)?;
        say(&line)?;
        ending = ends;
    }
    warn_unless_complete(&args.file, &ending);
    Ok(())
}

/// Why a table has no rows: times of the log's own rows [s] beside what was asked for.
fn nothing_between((from, until): (f64, f64), time: &[f64]) -> String {
    let asked = match (from.is_finite(), until.is_finite()) {
        (true, true) => format!(" from {from} to {until} s"),
        (true, false) => format!(" from {from} s on"),
        (false, true) => format!(" to {until} s"),
        (false, false) => String::new(),
    };
    let (Some(first), Some(last)) = (time.first(), time.last()) else {
        return format!("no communication point{asked}: the log holds none; the table has no rows");
    };
    format!(
        "no communication point{asked}: the log holds {first} to {last} s; the table has no rows. Give another --from or --until"
    )
}

/// The shortest decimals that read back to the same bits; empty where the log says nothing.
fn write_csv(out: &mut impl std::io::Write, table: &Table) -> std::io::Result<()> {
    write!(out, "time")?;
    for column in &table.columns {
        write!(out, ",{}", column.name)?;
    }
    writeln!(out)?;
    for (row, time) in table.time.iter().enumerate() {
        write!(out, "{time:?}")?;
        for column in &table.columns {
            match column.values[row] {
                value if value.is_nan() => write!(out, ",")?,
                value => write!(out, ",{value:?}")?,
            }
        }
        writeln!(out)?;
    }
    Ok(())
}

/// What could not be written whole goes, so that the same command can be given again.
fn remove(path: &Path) {
    let _ = std::fs::remove_file(path);
}

/// A new file.
pub(super) fn create(path: &Path) -> Result<File, CliError> {
    File::create_new(path).map_err(|source| CliError::File {
        action: "create",
        path: path.to_owned(),
        source,
        remedy: "choose a name that is free, in a folder that can be written",
    })
}

pub(super) fn cannot_write(path: &Path, source: std::io::Error) -> CliError {
    CliError::File {
        action: "write",
        path: path.to_owned(),
        source,
        remedy: "make room or choose another folder",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_empty_table_is_told_with_the_times_that_the_log_holds() {
        let infinite = f64::INFINITY;
        let beyond = nothing_between((5.0, infinite), &[0.0, 0.5, 1.0]);
        assert!(
            beyond.contains("from 5 s on: the log holds 0 to 1 s"),
            "{beyond}"
        );
        let between = nothing_between((0.1, 0.2), &[0.0, 0.5]);
        assert!(between.contains("from 0.1 to 0.2 s:"), "{between}");
        let none = nothing_between((-infinite, infinite), &[]);
        assert!(none.contains("the log holds none"), "{none}");
    }
}
