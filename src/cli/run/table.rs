//! `gauges.csv`: the file of the run's rows, complete whatever is kept in memory, and its rows read back.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};

use crate::cli::CliError;

/// A file that keeps what the disk does not take, and tries again.
pub(super) struct Patient {
    sink: Box<dyn Write>,
    /// Bytes that are not in the file yet.
    waiting: Vec<u8>,
    /// Bytes in the file of a line whose rest is not.
    begun: u64,
}

impl Patient {
    pub(super) fn new(sink: impl Write + 'static) -> Self {
        Self {
            sink: Box::new(sink),
            waiting: Vec::new(),
            begun: 0,
        }
    }

    pub(super) fn push(&mut self, line: &str) {
        self.waiting.extend_from_slice(line.as_bytes());
        self.waiting.push(b'\n');
    }

    /// Bytes that are not in the file yet.
    pub(super) fn waiting(&self) -> usize {
        self.waiting.len()
    }

    /// Bytes in the file of a line whose rest is not.
    pub(super) fn begun(&self) -> u64 {
        self.begun
    }

    /// Writes what waits, as far as there is room; a line that was cut is gone on with.
    pub(super) fn flush(&mut self) -> std::io::Result<()> {
        let (mut written, mut result) = (0, Ok(()));
        while written < self.waiting.len() && result.is_ok() {
            match self.sink.write(&self.waiting[written..]) {
                Ok(0) => result = Err(std::io::ErrorKind::WriteZero.into()),
                Ok(n) => written += n,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
                Err(error) => result = Err(error),
            }
        }
        let (done, end) = (&self.waiting[..written], |byte: &u8| *byte == b'\n');
        self.begun = match done.iter().rposition(end) {
            Some(last) => (written - 1 - last) as u64,
            None => self.begun + written as u64,
        };
        self.waiting.drain(..written);
        result
    }
}

/// Rows of an earlier part of a run, read one after the other.
pub(super) struct EarlierRows {
    path: PathBuf,
    reader: BufReader<File>,
    /// Numbers of a row.
    width: usize,
    /// Rows read, the header among them.
    number: usize,
}

impl EarlierRows {
    /// Opens a table that must have this header.
    ///
    /// # Errors
    /// [`CliError::File`], [`CliError::Content`].
    pub(super) fn open(path: &Path, header: &str) -> Result<Self, CliError> {
        let file = File::open(path).map_err(|source| cannot_read(path, source))?;
        let mut rows = Self {
            path: path.to_path_buf(),
            reader: BufReader::new(file),
            width: header.split(',').count(),
            number: 0,
        };
        match rows.line()? {
            Some(line) if line.trim_end() == header => Ok(rows),
            _ => Err(rows.wrong("its columns are not those of this case".into())),
        }
    }

    /// The next row, its time first.
    ///
    /// # Errors
    /// [`CliError::File`], [`CliError::Content`].
    pub(super) fn next(&mut self) -> Result<Option<Vec<f64>>, CliError> {
        let Some(line) = self.line()? else {
            return Ok(None);
        };
        let cells = line.trim_end().split(',');
        let row: Vec<f64> = cells.map_while(|cell| cell.parse().ok()).collect();
        // Only the last line may be cut short (by a crash), if within a number it still is a row; it is computed again.
        if !line.ends_with('\n') {
            return Ok(None);
        }
        match row.len() == self.width {
            true => Ok(Some(row)),
            false => Err(self.wrong(format!("line {} is not a row of numbers", self.number))),
        }
    }

    fn line(&mut self) -> Result<Option<String>, CliError> {
        let mut line = String::new();
        let read = self.reader.read_line(&mut line);
        let read = read.map_err(|source| cannot_read(&self.path, source))?;
        self.number += 1;
        Ok((read > 0).then_some(line))
    }

    fn wrong(&self, problem: String) -> CliError {
        CliError::Content {
            path: self.path.clone(),
            problem,
            remedy: ELSEWHERE,
        }
    }
}

const ELSEWHERE: &str = "resume into another folder with --out";

fn cannot_read(path: &Path, source: std::io::Error) -> CliError {
    CliError::File {
        action: "read",
        path: path.to_path_buf(),
        source,
        remedy: ELSEWHERE,
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
        assert_eq!(file.begun(), 7);
        disk.0.lock().unwrap().1 = 100;
        file.flush().unwrap();
        file.flush().unwrap();
        assert_eq!(disk.0.lock().unwrap().0, b"0.0,1.5\n0.5,2.5\n");
        assert_eq!(file.begun(), 0);
    }

    #[test]
    fn only_the_last_line_of_an_earlier_table_may_be_cut_short() {
        let folder = temp_dir::TempDir::new().unwrap();
        let path = folder.path().join("gauges.csv");
        let read = |text: &str| -> Result<Vec<Vec<f64>>, String> {
            std::fs::write(&path, text).unwrap();
            let mut rows = EarlierRows::open(&path, "time,a").map_err(|e| e.to_string())?;
            let mut all = Vec::new();
            while let Some(row) = rows.next().map_err(|e| e.to_string())? {
                all.push(row);
            }
            Ok(all)
        };
        assert_eq!(read("time,a\n0.0,1.5\n0.5,2.5\n").unwrap().len(), 2);
        for cut in ["0.5", "0.5,2.5"] {
            let text = format!("time,a\n0.0,1.5\n{cut}");
            assert_eq!(read(&text).unwrap(), [[0.0, 1.5]], "{cut}");
        }
        assert!(read("time,b\n").unwrap_err().contains("columns"));
        assert!(read("").unwrap_err().contains("columns"));
        let wrong = read("time,a\n0.0,1.5\n0.5\n1.0,2.0\n").unwrap_err();
        assert!(wrong.contains("line 3 is not a row"), "{wrong}");
    }
}
