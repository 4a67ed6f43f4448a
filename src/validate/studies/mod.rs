//! The studies, one a file. A new one: its file, a line of [`ALL`], and its reference data under cases/reference.

mod channel;
mod columns;
mod contact;
mod controls;
mod dam_breaks;
mod incline;
mod janssen;
mod rest;
mod silo;
mod silted_dams;
mod slump;

use super::Study;

/// All studies, in the order in which they are listed and run.
pub const ALL: [Study; 14] = [
    incline::STUDY,
    columns::STUDY,
    columns::axisymmetric::STUDY,
    columns::paper_a::STUDY,
    contact::STUDY,
    rest::STUDY,
    janssen::STUDY,
    silo::STUDY,
    silo::cohesion::STUDY,
    controls::STUDY,
    channel::STUDY,
    dam_breaks::STUDY,
    slump::STUDY,
    silted_dams::STUDY,
];

/// A study by name.
#[must_use]
pub fn by_name(name: &str) -> Option<Study> {
    ALL.into_iter().find(|study| study.name == name)
}
