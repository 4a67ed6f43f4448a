//! Sandgate: granular flow as a co-simulation component.
#![forbid(unsafe_code)]

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
pub mod scene;
pub mod shape;
pub mod solver;
pub mod state;
pub mod units;
#[cfg(any(feature = "record", feature = "bus"))]
pub mod wire;
