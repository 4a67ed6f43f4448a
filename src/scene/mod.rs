//! The typed scene: what a case file means once it has been read, checked and converted to SI.
//!
//! `raw` holds what may be typed, `lift` turns it into the types below and reports every problem at once,
//! `build` turns a [`Scene`] into particles, walls, devices and gauges. No strings with meaning, no missing
//! values and no units exist below this module.

mod types;

pub use types::*;
