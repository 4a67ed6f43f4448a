//! What a call was asked, for its log: arguments that stand nowhere else once it was refused.

/// Arguments of a call.
#[cfg_attr(
    not(feature = "record"),
    expect(dead_code, reason = "only a log reads them")
)]
pub(crate) enum Asked<'a> {
    /// None, or such as are too large for a log.
    Nothing,
    /// Variables to read, or to set in vain.
    Variables(&'a [u32]),
    /// Texts to set.
    Texts(&'a [u32], &'a [&'a str]),
    /// The name of a variable.
    Name(&'a str),
    /// A number of threads.
    Threads(u32),
    /// Start and stop time [s].
    Times(f64, Option<f64>),
}
