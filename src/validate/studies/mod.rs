//! The studies, one a file. A new one: its file, a line of [`ALL`], and its reference data under cases/reference.

mod channel;
mod choices;
mod clay_dam;
mod columns;
mod contact;
mod controls;
mod dam_breaks;
mod film;
mod incline;
mod janssen;
mod rest;
mod silo;
mod silted_dams;
mod silted_depths;
mod slump;
mod surge;
mod thin_layer;
mod two_layers;
mod yield_profile;

use super::Study;

/// All studies, in the order in which they are listed and run.
pub const ALL: [Study; 19] = [
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
    film::STUDY,
    surge::STUDY,
    dam_breaks::STUDY,
    slump::STUDY,
    two_layers::STUDY,
    clay_dam::STUDY,
    silted_dams::STUDY,
    silted_depths::STUDY,
];

/// A study by name.
#[must_use]
pub fn by_name(name: &str) -> Option<Study> {
    ALL.into_iter().find(|study| study.name == name)
}
