//! The run's scalars over time: one row a communication point, in memory for the picture and in `gauges.csv`.
//!
//! Numbers are written as the shortest decimals that read back to the same bits. A resumed run keeps the rows
//! up to its starting time and goes on below them.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::cli::CliError;
use crate::component::{Causality, Component, ValueKind, ValueReference};

/// One scalar variable of the run.
#[derive(Clone, Debug)]
pub(super) struct Column {
    /// Name in the variables table, as the header of `gauges.csv` has it.
    pub(super) name: String,
    /// SI unit.
    pub(super) unit: &'static str,
    /// Unit people like to see, with factor.
    pub(super) display_unit: Option<(&'static str, f64)>,
    /// Real, whole or yes-no.
    pub(super) kind: ValueKind,
    /// Whether it is an input: its value is the one that held over the step that ended at the row's time.
    pub(super) is_input: bool,
    /// Whether it is one element of an array (a profile).
    pub(super) is_element: bool,
    /// One value a row, SI.
    pub(super) values: Vec<f64>,
}

/// All rows so far, and the file they go to.
pub(super) struct Series {
    references: Vec<ValueReference>,
    /// Time of each row [s].
    pub(super) time: Vec<f64>,
    /// The scalars, in the order of the variables table.
    pub(super) columns: Vec<Column>,
    file: Patient,
    path: PathBuf,
    flushed: Instant,
    warned: bool,
}

/// A file that keeps what the disk does not take, and tries again.
struct Patient {
    sink: Box<dyn Write>,
    /// Bytes that are not in the file yet.
    waiting: Vec<u8>,
}

impl Patient {
    fn new(sink: impl Write + 'static) -> Self {
        Self {
            sink: Box::new(sink),
            waiting: Vec::new(),
        }
    }

    fn push(&mut self, line: &str) {
        self.waiting.extend_from_slice(line.as_bytes());
        self.waiting.push(b'\n');
    }

    /// Writes what waits, as far as there is room; a line that was cut is gone on with.
    fn flush(&mut self) -> std::io::Result<()> {
        let (mut written, mut result) = (0, Ok(()));
        while written < self.waiting.len() && result.is_ok() {
            match self.sink.write(&self.waiting[written..]) {
                Ok(0) => result = Err(std::io::ErrorKind::WriteZero.into()),
                Ok(n) => written += n,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) => result = Err(error),
            }
        }
        self.waiting.drain(..written);
        result
    }
}

impl Series {
    /// Opens `path`. With `keep_until` the rows of an earlier part of the same run up to that time [s] are kept.
    ///
    /// # Errors
    /// [`CliError::File`] if it cannot be read or written, [`CliError::Content`] if its columns are not this case's.
    pub(super) fn open(
        path: &Path,
        component: &Component,
        keep_until: Option<f64>,
    ) -> Result<Self, CliError> {
        let (references, columns) = scalars(component);
        let kept = match keep_until {
            Some(time) if path.exists() => read_rows(path, &columns, time)?,
            _ => Vec::new(),
        };
        let fresh = path.with_extension("csv.part");
        let file = File::create(&fresh).map_err(|e| cannot_write(&fresh, e))?;
        let mut series = Self {
            references,
            time: Vec::new(),
            columns,
            file: Patient::new(file),
            path: path.to_path_buf(),
            flushed: Instant::now(),
            warned: false,
        };
        series.file.push(&header(&series.columns));
        for row in &kept {
            series.push(row[0], &row[1..]);
        }
        series.flush()?;
        // The open file follows its new name: a crash from here on leaves a complete table.
        std::fs::rename(&fresh, path).map_err(|e| cannot_write(path, e))?;
        Ok(series)
    }

    /// Adds a row with the component's values now. Rows that cannot be written (the disk is full) wait in memory and are
    /// tried again every second; that is told once.
    ///
    /// # Errors
    /// [`CliError::Component`] if values cannot be read.
    pub(super) fn sample(&mut self, component: &Component) -> Result<(), CliError> {
        let mut values = vec![0.0; self.references.len()];
        component.get(&self.references, &mut values)?;
        self.push(component.time(), &values);
        if self.flushed.elapsed() > Duration::from_secs(1)
            && let Err(error) = self.flush()
            && !std::mem::replace(&mut self.warned, true)
        {
            let text = error.as_warning();
            tell!("warning: {text}; the run goes on and tries again every second");
        }
        Ok(())
    }

    /// Hands everything written so far to the system.
    ///
    /// # Errors
    /// [`CliError::File`].
    pub(super) fn flush(&mut self) -> Result<(), CliError> {
        self.flushed = Instant::now();
        self.file.flush().map_err(|e| cannot_write(&self.path, e))
    }

    fn push(&mut self, time: f64, values: &[f64]) {
        self.time.push(time);
        let mut line = format!("{time:?}");
        for (column, &value) in self.columns.iter_mut().zip(values) {
            column.values.push(value);
            line.push_str(&format!(",{value:?}"));
        }
        self.file.push(&line);
    }
}

/// Inputs and outputs with one value each; elements of arrays are among them, arrays as a whole are not.
fn scalars(component: &Component) -> (Vec<ValueReference>, Vec<Column>) {
    component
        .variables()
        .rows()
        .iter()
        .filter(|v| matches!(v.causality, Causality::Input | Causality::Output))
        .filter(|v| v.shape.is_empty())
        .map(|v| {
            let column = Column {
                name: v.name.clone(),
                unit: v.unit,
                display_unit: v.display_unit,
                kind: v.kind,
                is_input: v.causality == Causality::Input,
                is_element: v.element_of.is_some(),
                values: Vec::new(),
            };
            (v.reference, column)
        })
        .unzip()
}

fn header(columns: &[Column]) -> String {
    let mut header = String::from("time");
    for column in columns {
        header.push(',');
        header.push_str(&column.name);
    }
    header
}

/// Rows of an earlier part up to `until`, each with its time first.
fn read_rows(path: &Path, columns: &[Column], until: f64) -> Result<Vec<Vec<f64>>, CliError> {
    let text = std::fs::read_to_string(path).map_err(|source| CliError::File {
        action: "read",
        path: path.to_path_buf(),
        source,
        remedy: "resume into another folder with --out",
    })?;
    let wrong = |problem: String| CliError::Content {
        path: path.to_path_buf(),
        problem,
        remedy: "resume into another folder with --out",
    };
    let mut lines = text.lines();
    if lines.next() != Some(&header(columns)) {
        return Err(wrong("its columns are not those of this case".into()));
    }
    let mut rows = Vec::new();
    for (number, line) in lines.enumerate() {
        let row: Vec<f64> = line
            .split(',')
            .map_while(|cell| cell.parse().ok())
            .collect();
        if row.len() != columns.len() + 1 {
            // Only the last line may be cut short (by a crash); whatever it was is computed again.
            if text.ends_with('\n') || number + 2 < text.lines().count() {
                return Err(wrong(format!(
                    "line {} is not a row of numbers",
                    number + 2
                )));
            }
            break;
        }
        if row[0] > until {
            break;
        }
        rows.push(row);
    }
    Ok(rows)
}

fn cannot_write(path: &Path, source: std::io::Error) -> CliError {
    CliError::File {
        action: "write",
        path: path.to_path_buf(),
        source,
        remedy: "make room or choose another folder with --out",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::{Arc, Mutex};

    /// Takes so many bytes and no more.
    #[derive(Clone, Default)]
    struct Disk(Arc<Mutex<(Vec<u8>, usize)>>);

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            let (stored, room) = &mut *self.0.lock().unwrap();
            let n = bytes.len().min(*room - stored.len());
            if n == 0 && !bytes.is_empty() {
                return Err(std::io::ErrorKind::StorageFull.into());
            }
            stored.extend_from_slice(&bytes[..n]);
            Ok(n)
        }

        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn what_a_full_disk_does_not_take_is_written_when_there_is_room() {
        let disk = Disk::default();
        disk.0.lock().unwrap().1 = 7;
        let mut file = Patient::new(disk.clone());
        file.push("0.0,1.5");
        assert!(file.flush().is_err());
        file.push("0.5,2.5");
        assert!(file.flush().is_err());
        assert_eq!(disk.0.lock().unwrap().0, b"0.0,1.5");
        disk.0.lock().unwrap().1 = 100;
        file.flush().unwrap();
        file.flush().unwrap();
        assert_eq!(disk.0.lock().unwrap().0, b"0.0,1.5\n0.5,2.5\n");
    }
}
