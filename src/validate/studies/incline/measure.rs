//! What is read from a flow down a plane: errors of velocity and pressure against the exact profile.

use crate::validate::bagnold::Layer;
use crate::validate::statistics::rms;
use crate::validate::{Recording, Snapshot};

/// Window of time means [s].
pub(super) const WINDOW: f64 = 3.0;
const BINS: usize = 20;

/// Snapshots of the last [`WINDOW`] seconds.
pub(super) fn window(recording: &Recording) -> &[Snapshot] {
    let end = recording.time.last().copied().unwrap_or(0.0);
    let first = recording
        .snapshots
        .partition_point(|s| s.time < end - WINDOW - 1e-9);
    &recording.snapshots[first..]
}

/// Mean over particles of velocity minus exact velocity in bins over the depth, over the exact surface velocity.
pub(super) fn velocity_errors(snapshots: &[Snapshot], layer: &Layer) -> Vec<f64> {
    let top = layer.dilated_depth();
    let mut bins = vec![(0.0, 0_u32); BINS];
    let particles = snapshots
        .iter()
        .flat_map(|s| s.position.iter().zip(&s.velocity));
    for (x, v) in particles {
        let z = f64::from(x[1]);
        let bin = &mut bins[((z / top * BINS as f64).max(0.0) as usize).min(BINS - 1)];
        *bin = (bin.0 + f64::from(v[0]) - layer.velocity(z), bin.1 + 1);
    }
    let full = bins.iter().filter(|bin| bin.1 > 0);
    full.map(|(sum, count)| sum / f64::from(*count) / layer.surface_velocity())
        .collect()
}

/// Root mean square over particles of pressure minus exact pressure, over that of the bed.
pub(super) fn pressure_error(snapshots: &[Snapshot], layer: &Layer) -> Option<f64> {
    let particles = snapshots
        .iter()
        .flat_map(|s| s.position.iter().zip(&s.pressure));
    let errors: Vec<f64> = particles
        .map(|(x, p)| f64::from(*p) - layer.pressure(f64::from(x[1])))
        .collect();
    Some(rms(&errors)? / layer.pressure(0.0))
}

/// Largest root mean square of [`velocity_errors`] over any whole second after the first two; `None` of shorter runs.
pub(super) fn worst_second(recording: &Recording, layer: &Layer) -> Option<f64> {
    let all = &recording.snapshots;
    let end = all.last()?.time.floor() as u32;
    let seconds = (2..end).filter_map(|second| {
        let from = f64::from(second);
        let first = all.partition_point(|s| s.time < from);
        let last = all.partition_point(|s| s.time < from + 1.0);
        rms(&velocity_errors(&all[first..last], layer))
    });
    seconds.max_by(f64::total_cmp)
}

/// Mean velocity along the plane of the mass (all particles weigh the same) over time.
pub(super) fn mean_velocity(recording: &Recording) -> Vec<(f64, f64)> {
    let of = |s: &Snapshot| {
        let sum: f64 = s.velocity.iter().map(|v| f64::from(v[0])).sum();
        (s.time, sum / s.velocity.len().max(1) as f64)
    };
    recording.snapshots.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::validate::bagnold::Grains;

    fn layer() -> Layer {
        Layer {
            material: Grains::glass_beads(5e-3),
            slope: 25.0_f64.to_radians(),
            depth: 0.1,
            gravity: 9.81,
        }
    }

    /// Particles on the exact profile, with a factor on velocity and an offset of pressure.
    fn flow(layer: &Layer, factor: f64, offset: f64) -> Snapshot {
        let heights = (0..400).map(|k| (f64::from(k) + 0.5) / 400.0 * layer.dilated_depth());
        let mut snapshot = Snapshot::default();
        for z in heights {
            snapshot.position.push([0.0, z as f32, 0.0]);
            snapshot
                .velocity
                .push([(factor * layer.velocity(z)) as f32, 0.0, 0.0]);
            snapshot.pressure.push((layer.pressure(z) + offset) as f32);
        }
        snapshot
    }

    #[test]
    fn an_exact_flow_has_no_error_and_a_known_one_has_its_own() {
        let layer = layer();
        let exact = [flow(&layer, 1.0, 0.0)];
        assert!(rms(&velocity_errors(&exact, &layer)).unwrap() < 1e-6);
        assert!(pressure_error(&exact, &layer).unwrap() < 1e-6);
        let fast = [flow(&layer, 1.02, 0.01 * layer.pressure(0.0))];
        let errors = velocity_errors(&fast, &layer);
        assert_eq!(errors.len(), BINS);
        // Two per cent of a velocity that is almost the surface's in the last bin.
        assert!(
            (errors[BINS - 1] - 0.02).abs() < 1e-4,
            "{}",
            errors[BINS - 1]
        );
        assert!((pressure_error(&fast, &layer).unwrap() - 0.01).abs() < 1e-6);

        // Five seconds, of which the one from 3 s on is wrong, and a start that nobody looks at.
        let mut recording = Recording::empty("key".to_owned());
        recording.snapshots = [2.0, 1.0, 1.0, 1.02, 1.0, 1.0]
            .iter()
            .enumerate()
            .map(|(k, factor)| Snapshot {
                time: k as f64,
                ..flow(&layer, *factor, 0.0)
            })
            .collect();
        recording.time = vec![5.0];
        let worst = worst_second(&recording, &layer).unwrap();
        assert!((worst - rms(&errors).unwrap()).abs() < 1e-9, "{worst}");
        assert!(rms(&velocity_errors(window(&recording), &layer)).unwrap() < worst);
    }
}
