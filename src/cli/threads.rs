//! Numbers of threads on the command line.

use clap::builder::RangedI64ValueParser;

use crate::component::Component;

/// 0, which means all cores, to as many as a component takes.
pub(super) fn parser() -> RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(0..=i64::from(Component::MOST_THREADS))
}
