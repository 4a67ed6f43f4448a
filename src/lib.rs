//! Sandgate: granular flow as a co-simulation component.
//!
//! A case file is read and checked by [`scene`] (with [`units`]) into a typed [`scene::Scene`]. From it
//! [`component::Component`] is built: the one thing that steps, over one table of variables. Inside, [`shape`] is filled
//! with particles of a [`material`], kept in [`state`], bounded by [`boundary`], advanced by [`solver`] with a [`kernel`]
//! and sums of fixed order ([`math`]), and read by [`gauge`]. Outside, adapters show the component to the world: [`fmi`]
//! packs it, `record` logs it and `bus` serves it (both in the words of `wire`), `validate` compares it with published data, `bench` measures what it costs, `stress` tries to break it, `cli` is the program. The C functions
//! are the package in `fmu/`.
//!
//! No adapter holds physics, a rule about lifecycles or a list of variables; nothing below `scene` sees text from a user
//! or does I/O; no result depends on the number of threads. ARCHITECTURE.md has the layers and what is absent on purpose.
//!
//! ```
//! use sandgate::{component::Component, scene};
//!
//! let case = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scenes/small_silo.toml");
//! let mut component = Component::new(&scene::load(&case)?)?;
//! component.initialize(0.0, None)?;
//! let opening = component.variables().by_name("gate.main.opening").unwrap().reference;
//! component.set(&[opening], &[1.0])?;
//! component.do_step(0.0, 0.05)?;
//! assert_eq!(component.time(), 0.05);
//! assert_eq!(component.ledger().error(), 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![forbid(unsafe_code)]
#![allow(
    rustdoc::broken_intra_doc_links,
    reason = "units stand in brackets, as in [m] and [kg/s], and are no links"
)]

#[cfg(feature = "cli")]
pub mod bench;
pub mod boundary;
#[cfg(feature = "bus")]
pub mod bus;
#[cfg(feature = "cli")]
pub mod cli;
pub mod component;
pub mod fmi;
pub mod gauge;
pub mod kernel;
pub mod material;
pub mod math;
#[cfg(feature = "record")]
pub mod record;
#[cfg(feature = "cli")]
pub mod report;
pub mod scene;
pub mod shape;
pub mod solver;
pub mod state;
#[cfg(feature = "cli")]
pub mod stress;
pub mod units;
#[cfg(feature = "cli")]
pub mod validate;
mod whole_file;
#[cfg(any(feature = "record", feature = "bus"))]
pub mod wire;
