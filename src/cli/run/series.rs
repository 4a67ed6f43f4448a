//! The run's scalars over time: one row a communication point in `gauges.csv`, and in memory, which does not grow with the run,
//! what the summary says of all rows and what the picture shows of them.
//!
//! Numbers are written as the shortest decimals that read back to the same bits. A resumed run keeps the rows up to its
//! starting time and goes on below them.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::columns::{Column, Figures, GateColumns, flag_of, gates, header, place, scalars};
use super::profile::Profile;
use super::table::{EarlierRows, Patient};
use crate::cli::CliError;
use crate::component::{Component, ValueReference};

/// Bytes of kept rows that are written at once.
const AT_ONCE: usize = 1 << 20;

/// What is known of the rows so far, and the file they go to.
pub(super) struct Series {
    references: Vec<ValueReference>,
    /// Times of the first and the last row [s].
    pub(super) span: Option<(f64, f64)>,
    /// The scalars, in the order of the variables table.
    pub(super) columns: Vec<Column>,
    /// In the order of the scene.
    pub(super) gates: Vec<GateColumns>,
    /// In the order of the scene.
    pub(super) profiles: Vec<Profile>,
    /// For each column the one that says whether it is a measurement.
    validity: Vec<Option<usize>>,
    file: Patient,
    /// The same file, to have it on the disk itself.
    disk: File,
    path: PathBuf,
    flushed: Instant,
    warned: bool,
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
        let (references, columns) = scalars(component.variables());
        let header = header(&columns);
        let earlier = match keep_until {
            Some(until) if path.exists() => Some((EarlierRows::open(path, &header)?, until)),
            _ => None,
        };
        let fresh = path.with_extension("csv.part");
        let file = File::create(&fresh).map_err(|e| cannot_write(&fresh, e))?;
        let disk = file.try_clone().map_err(|e| cannot_write(&fresh, e))?;
        let mut series = Self {
            span: None,
            gates: gates(component, &references),
            profiles: Profile::all(component.scene(), &columns),
            validity: columns.iter().map(|c| flag_of(c, &columns)).collect(),
            references,
            columns,
            file: Patient::new(file),
            disk,
            path: path.to_path_buf(),
            flushed: Instant::now(),
            warned: false,
        };
        series.file.push(&header);
        let kept = earlier.map_or(Ok(()), |(rows, until)| series.keep(rows, until));
        if let Err(error) = kept.and_then(|()| series.flush()) {
            // The table as it was is still there; half a new one is of no use, and may be in the way of a full disk.
            let _ = std::fs::remove_file(&fresh);
            return Err(error);
        }
        // The open file follows its new name: a crash from here on leaves a complete table.
        std::fs::rename(&fresh, path).map_err(|e| cannot_write(path, e))?;
        Ok(series)
    }

    /// Takes over the rows up to `until` [s].
    fn keep(&mut self, mut rows: EarlierRows, until: f64) -> Result<(), CliError> {
        while let Some(row) = rows.next()?.filter(|row| row[0] <= until) {
            self.push(row[0], &row[1..]);
            if self.file.waiting() > AT_ONCE {
                self.flush()?;
            }
        }
        Ok(())
    }

    /// Adds a row with the component's values now. Rows that cannot be written (the disk is full) wait in memory and are
    /// tried again every second; a warning of that comes back once.
    ///
    /// # Errors
    /// [`CliError::Component`] if values cannot be read.
    pub(super) fn sample(&mut self, component: &Component) -> Result<Option<String>, CliError> {
        let mut values = vec![0.0; self.references.len()];
        component.get(&self.references, &mut values)?;
        self.push(component.time(), &values);
        if self.flushed.elapsed() > Duration::from_secs(1)
            && let Err(error) = self.flush()
            && !std::mem::replace(&mut self.warned, true)
        {
            let text = error.as_warning();
            return Ok(Some(format!(
                "warning: {text}; the run goes on and tries again every second"
            )));
        }
        Ok(None)
    }

    /// Hands everything written so far to the system.
    ///
    /// # Errors
    /// [`CliError::File`].
    pub(super) fn flush(&mut self) -> Result<(), CliError> {
        self.flushed = Instant::now();
        self.file.flush().map_err(|e| cannot_write(&self.path, e))
    }

    /// Has everything written so far on the disk itself: a power cut takes nothing of it.
    ///
    /// # Errors
    /// [`CliError::File`].
    pub(super) fn sync(&mut self) -> Result<(), CliError> {
        self.flush()?;
        self.disk
            .sync_data()
            .map_err(|e| cannot_write(&self.path, e))
    }

    /// A warning if the rows of an earlier part end before the state at `from` [s] that the run goes on with.
    pub(super) fn missing_before(&self, from: f64) -> Option<String> {
        let ends = match self.span {
            Some((_, last)) if last >= from => return None,
            Some((_, last)) => format!("ends at t = {last} s"),
            None => "has no rows".to_owned(),
        };
        Some(format!(
            "warning: {} {ends}, before the saved state at t = {from} s: rows between are missing there and in what the \
             summary says of the run; start the run anew if you need them",
            self.path.display()
        ))
    }

    /// Takes a row off the file's end of which the disk took only a part; this needs no room.
    pub(super) fn end_with_whole_row(&self) {
        if self.file.begun() == 0 {
            return;
        }
        // That rows are missing is told already; readers still skip a last one that was cut.
        let cut = || {
            let file = File::options().write(true).open(&self.path)?;
            file.set_len(file.metadata()?.len() - self.file.begun())
        };
        let _: std::io::Result<()> = cut();
    }

    /// The column of a scalar; none of an array.
    pub(super) fn column(&self, reference: ValueReference) -> Option<&Column> {
        let place = place(&self.references, reference)?;
        Some(&self.columns[place])
    }

    fn push(&mut self, time: f64, values: &[f64]) {
        let (first, before) = self.span.unwrap_or((time, time));
        self.span = Some((first, time));
        let mut line = format!("{time:?}");
        for ((column, &value), flag) in self.columns.iter_mut().zip(values).zip(&self.validity) {
            line.push_str(&format!(",{value:?}"));
            match &mut column.figures {
                Some(figures) => figures.add(time, time - before, value),
                none => *none = Some(Figures::of(time, value)),
            }
            if let Some(curve) = &mut column.curve {
                let since = if column.is_input { before } else { time };
                let valid = flag.is_none_or(|flag| values[flag] == 0.0) && value.is_finite();
                curve.add(since, time, valid.then_some(value));
            }
        }
        self.gates.iter_mut().for_each(|gate| gate.see(values));
        for profile in &mut self.profiles {
            profile.see(time, values);
        }
        self.file.push(&line);
    }
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

    fn silo() -> Component {
        let text = include_str!("../../../tests/scenes/small_silo.toml");
        let scene = crate::scene::parse("small_silo.toml", text).unwrap();
        Component::new(&scene).unwrap()
    }

    /// Rows that no two are alike of, a gate that is blocked now and then among them.
    fn push(series: &mut Series, rows: std::ops::Range<u32>) {
        let width = series.columns.len();
        let blocked = series.gates[0].blocked;
        for n in rows {
            let row = 0..width;
            let mut values: Vec<f64> = row.map(|k| (f64::from(n) + 0.1 * k as f64).sin()).collect();
            values[blocked] = f64::from(u8::from(n % 7 == 3));
            series.push(1e-3 * f64::from(n), &values);
        }
        series.flush().unwrap();
    }

    /// Everything but the time at which it was written last.
    fn known(series: &Series) -> (Option<(f64, f64)>, String) {
        let columns: Vec<_> = series.columns.iter().collect();
        let (gates, profiles) = (&series.gates, &series.profiles);
        (series.span, format!("{columns:?} {gates:?} {profiles:?}"))
    }

    #[test]
    fn a_resumed_run_knows_and_writes_what_an_unbroken_one_does() {
        let (component, folder) = (silo(), temp_dir::TempDir::new().unwrap());
        let (one, two) = (folder.path().join("one.csv"), folder.path().join("two.csv"));
        let mut whole = Series::open(&one, &component, None).unwrap();
        push(&mut whole, 0..9000);
        let mut first = Series::open(&two, &component, None).unwrap();
        push(&mut first, 0..7000);
        drop(first);
        // From a checkpoint before the last row.
        let mut second = Series::open(&two, &component, Some(5.0)).unwrap();
        assert_eq!(second.span, Some((0.0, 5.0)));
        assert_eq!(second.missing_before(5.0), None);
        let told = second.missing_before(5.5).unwrap();
        assert!(
            told.contains("ends at t = 5 s, before the saved state at t = 5.5 s"),
            "{told}"
        );
        push(&mut second, 5001..9000);
        let read = |path: &Path| std::fs::read_to_string(path).unwrap();
        assert_eq!(read(&one), read(&two));
        assert_eq!(read(&one).lines().count(), 9001);
        assert!(known(&whole) == known(&second));
    }

    #[test]
    fn an_earlier_table_of_another_case_stays_as_it_is() {
        let (component, folder) = (silo(), temp_dir::TempDir::new().unwrap());
        let path = folder.path().join("gauges.csv");
        let header = header(&scalars(component.variables()).1);
        for text in ["time,other\n".to_owned(), format!("{header}\n1,2\n3,4\n")] {
            std::fs::write(&path, &text).unwrap();
            let refused = Series::open(&path, &component, Some(5.0)).map(drop);
            assert!(matches!(refused, Err(CliError::Content { .. })));
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
            assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        }
    }
}
