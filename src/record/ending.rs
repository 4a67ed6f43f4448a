//! How a log ends, and the words for it.

use std::path::PathBuf;

/// How a log ends.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Ending {
    /// With summary and magic bytes: the writer finished it.
    #[default]
    Complete,
    /// As that, and then there are more bytes, which were not read.
    Followed {
        /// Bytes of the log.
        byte: u64,
        /// Bytes behind it.
        more: u64,
        /// Whether they begin as a log does.
        is_log: bool,
        /// The file, for what is said of it.
        path: PathBuf,
    },
    /// Short of that.
    Cut {
        /// Bytes of the file that were used.
        byte: u64,
        /// Simulated time of the last message before the cut, if there is one [ns].
        last: Option<u64>,
        /// What the reader met there.
        why: String,
        /// Whether bytes are wrong, rather than missing.
        damaged: bool,
    },
}

impl std::fmt::Display for Ending {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Ending::Complete => write!(f, "complete"),
            Ending::Followed {
                byte,
                more,
                is_log,
                path,
            } => {
                write!(
                    f,
                    "complete at byte {byte}; {more} bytes follow its end and were not read"
                )?;
                match is_log {
                    true => write!(
                        f,
                        ": they begin as a log of its own; `tail -c +{} {} > OTHER.mcap` makes a file of it",
                        byte + 1,
                        path.display()
                    ),
                    false => write!(
                        f,
                        ": they are no log; `sandgate log recover` leaves them out"
                    ),
                }
            }
            Ending::Cut {
                byte,
                last,
                why,
                damaged,
            } => {
                match damaged {
                    true => write!(f, "damaged before byte {byte} ({why})")?,
                    false => write!(f, "cut short near byte {byte} ({why})")?,
                }
                if let Some(last) = last {
                    write!(f, ", last message at {} s", *last as f64 / 1e9)?;
                }
                if *damaged {
                    return write!(
                        f,
                        ": bytes were changed after they were written; what was read may be wrong or have gaps, \
                         and nothing behind that byte was read"
                    );
                }
                write!(
                    f,
                    ": the writer was stopped or its disk was full; all before the cut was read"
                )
            }
        }
    }
}
