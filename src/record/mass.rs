//! Proof of a file's account of mass: at every line, initial + inflow - outflow = present, exactly.

use super::ending::Ending;
use super::error::ReadError;
use super::read::{Body, Entry, LogReader};
use crate::component::MassLedger;
use std::path::Path;

/// What the account of a file says.
#[derive(Clone, Debug, PartialEq)]
pub struct MassCheck {
    /// Lines with an account.
    pub lines: u64,
    /// The first line whose account is wrong, if there is one.
    pub wrong: Option<WrongLine>,
    /// The account of the last line.
    pub last: Option<MassLedger>,
    /// How the file ends.
    pub ending: Ending,
}

/// A line whose account is wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct WrongLine {
    /// Simulated time [s].
    pub time: f64,
    /// Communication steps done.
    pub step: u64,
    /// The account.
    pub ledger: MassLedger,
}

impl std::fmt::Display for WrongLine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let MassLedger {
            initial,
            inflow,
            outflow,
            present,
        } = self.ledger;
        write!(
            f,
            "step {} at {} s: initial {initial} + in {inflow} - out {outflow} = {} kg, \
             but {present} kg is present",
            self.step,
            self.time,
            initial + inflow - outflow
        )
    }
}

/// Checks every line of `path`; no tolerance.
///
/// # Errors
/// Those of [`LogReader`]. A wrong account is not an error but a result.
pub fn check_mass(path: &Path) -> Result<MassCheck, ReadError> {
    let mut log = LogReader::open(path)?;
    let mut check = MassCheck {
        lines: 0,
        wrong: None,
        last: None,
        ending: Ending::Complete,
    };
    for entry in log.by_ref() {
        let Entry::Message {
            body: Body::Stats(stats),
            ..
        } = entry?
        else {
            continue;
        };
        let account = stats.ledger.unwrap_or_default();
        let ledger = MassLedger {
            initial: account.initial,
            inflow: account.inflow,
            outflow: account.outflow,
            present: account.present,
        };
        check.lines += 1;
        // Not `!= 0`, so that NaN is wrong as well.
        let exact = ledger.error() == 0.0;
        if !exact && check.wrong.is_none() {
            check.wrong = Some(WrongLine {
                time: stats.time,
                step: stats.step,
                ledger,
            });
        }
        check.last = Some(ledger);
    }
    if let Some(ending) = log.ending() {
        check.ending = ending.clone();
    }
    Ok(check)
}
