//! Where and with what a run was measured.

use serde::{Deserialize, Serialize};

/// A machine, a program and a day.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Name of the processor, as the system tells it; "unknown" where it does not.
    pub processor: String,
    /// Cores that this process may use.
    pub cores: usize,
    /// Operating system and instruction set.
    pub system: String,
    /// Whether sweeps run on AVX2.
    pub avx2: bool,
    /// Processes that wanted to run while this was measured, this one included: mean of a minute at the start and at the
    /// end; `None` where the system does not tell.
    pub load: Option<(f64, f64)>,
    /// Version of this package.
    pub version: String,
    /// [`crate::validate::SOURCES`]: what the program was built from.
    pub sources: String,
    /// Commit of the folder in which it was run, if it is a repository.
    pub commit: Option<String>,
    /// Day of the run, UTC, as year-month-day.
    pub date: String,
}

impl Machine {
    /// This one, now.
    #[must_use]
    pub fn here() -> Self {
        let seconds = std::time::SystemTime::now()
            .duration_since(std::time::UNIX_EPOCH)
            .map_or(0, |d| d.as_secs());
        Self {
            processor: processor().unwrap_or_else(|| "unknown".to_owned()),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            system: format!("{} {}", std::env::consts::OS, std::env::consts::ARCH),
            avx2: !matches!(crate::math::Arch::detect(), crate::math::Arch::Portable),
            load: load().map(|now| (now, now)),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            sources: crate::validate::SOURCES.to_owned(),
            commit: commit(),
            date: date(seconds / 86_400),
        }
    }

    /// Notes the load at the end.
    pub fn finish(&mut self) {
        self.load = self.load.zip(load()).map(|((start, _), end)| (start, end));
    }
}

fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

fn load() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/loadavg").ok()?;
    text.split_whitespace().next()?.parse().ok()
}

fn commit() -> Option<String> {
    let output = std::process::Command::new("git")
        .args(["rev-parse", "--short=10", "HEAD"])
        .output()
        .ok()
        .filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    Some(text.trim().to_owned()).filter(|text| !text.is_empty())
}

/// Year-month-day of a day since 1970-01-01 (H. Hinnant, "chrono-compatible low-level date algorithms", civil_from_days).
fn date(day: u64) -> String {
    let z = day + 719_468;
    let era = z / 146_097;
    let of_era = z % 146_097;
    let year = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let shifted = (5 * of_year + 2) / 153;
    let day = of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 {
        shifted + 3
    } else {
        shifted - 9
    };
    let year = year + era * 400 + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_those_of_the_calendar() {
        assert_eq!(date(0), "1970-01-01");
        assert_eq!(date(11_016), "2000-02-29");
        assert_eq!(date(20_454), "2026-01-01");
    }

    #[test]
    fn a_machine_has_a_core_and_a_version() {
        let machine = Machine::here();
        assert!(machine.cores >= 1 && !machine.version.is_empty());
        assert!(machine.date.starts_with("20"));
    }
}
