//! What the first reading of a log keeps of a snapshot: where it is, and what the scales of colours need of it.

use super::pack::{Cloud, Scale};
use crate::wire::foxglove::PointCloud;

/// A snapshot of the log that stands.
pub(super) struct Shot {
    /// Its number among all snapshots of the file, from 0.
    pub(super) number: usize,
    /// Particles in it.
    pub(super) particles: usize,
    /// What it needs of the scale.
    pub(super) scale: Scale,
}

impl Shot {
    pub(super) fn of(number: usize, cloud: &PointCloud) -> Self {
        let cloud = Cloud::of(cloud);
        Self {
            number,
            particles: cloud.len(),
            scale: Scale::of(cloud),
        }
    }
}
