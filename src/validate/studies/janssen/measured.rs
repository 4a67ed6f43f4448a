//! What the walls and the floor of a silo felt, and what of the weight went into the walls.

use super::{FOOT, FRICTION, GRAVITY, PIECE, PIECES, SPEED, WIDTH, foot};
use crate::validate::Recording;
use crate::validate::statistics::mean;

/// What a run measured.
pub(super) struct Measured {
    /// Weight over area, rho g [Pa/m].
    weight: f64,
    /// Shear over normal force of the walls.
    pub(super) mobilised: f64,
    /// Integral of sigma_xx over that of sigma_zz.
    pub(super) k: f64,
    /// Force on the floor over its width [Pa].
    pub(super) floor: f64,
    /// Depth of the floor [m].
    pub(super) depth: f64,
    /// Depth [m] and sigma_zz there [Pa], at the lower end of each piece.
    pub(super) stress: Vec<(f64, f64)>,
    /// Depth of the middle [m] and sigma_xx over sigma_zz of each piece.
    pub(super) local: Vec<(f64, f64)>,
}

impl Measured {
    /// Janssen's sigma_zz at a depth [Pa].
    pub(super) fn janssen(&self, depth: f64) -> f64 {
        let length = WIDTH / (2.0 * self.k * FRICTION);
        self.weight * length * (1.0 - (-depth / length).exp())
    }

    /// Largest |sigma_zz - Janssen's| over Janssen's.
    pub(super) fn worst(&self) -> f64 {
        let off = |(z, s): &(f64, f64)| (s / self.janssen(*z) - 1.0).abs();
        self.stress.iter().map(off).fold(0.0, f64::max)
    }
}

/// Means over the last second of a run; `None` where a variable is missing.
pub(super) fn measure(recording: &Recording) -> Option<Measured> {
    let end = *recording.time.last()?;
    let late = |variable: &str| {
        let curve = recording.curve(variable);
        let values = curve.iter().filter(|p| p.0 > end - 1.0).map(|p| p.1);
        mean(&values.collect::<Vec<f64>>())
    };
    let bottom = -SPEED * (end - 0.5);
    let top = FOOT + late("gauge.depth.depth")?;
    let depth = top - bottom;
    let weight = recording.last("mass.present")? * GRAVITY / (WIDTH * depth);
    let mut normal = Vec::new();
    let mut shear = 0.0;
    for k in 0..PIECES {
        let force = |side: &str, axis: &str| late(&format!("gauge.{side}_{k}.force_{axis}"));
        normal.push(force("right", "x")? - force("left", "x")?);
        shear -= force("right", "y")? + force("left", "y")?;
    }
    let mobilised = shear / normal.iter().sum::<f64>();
    let (mut carried, mut above) = (0.0, 0.0);
    let (mut horizontal, mut vertical) = (0.0, 0.0);
    let (mut stress, mut local) = (Vec::new(), Vec::new());
    for k in (0..PIECES).rev() {
        let (low, high) = (foot(k).max(bottom), foot(k + 1).min(top));
        if high <= low {
            continue;
        }
        carried += mobilised * normal[k];
        let z = top - low;
        let below = weight * z - carried / WIDTH;
        let between = 0.5 * (above + below);
        horizontal += 0.5 * normal[k];
        vertical += between * (high - low);
        stress.push((z, below));
        // Where sand touches a part of a piece only, the piece's force is no stress.
        if high - low > 0.9 * PIECE {
            let middle = top - 0.5 * (low + high);
            local.push((middle, 0.5 * normal[k] / (high - low) / between));
        }
        above = below;
    }
    Some(Measured {
        weight,
        mobilised,
        k: horizontal / vertical,
        floor: -late("gauge.floor.force_y")? / WIDTH,
        depth,
        stress,
        local,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces of a silo that obeys Janssen's law with K = 0.5.
    #[test]
    fn the_law_is_found_in_a_silo_that_obeys_it() {
        let (weight, k, end) = (1.5e4, 0.5, 5.0);
        let length = WIDTH / (2.0 * k * FRICTION);
        let (bottom, top) = (-SPEED * (end - 0.5), 0.4955);
        // Integral of sigma_zz from the surface to a depth.
        let integral = |z: f64| weight * length * (z - length * (1.0 - (-z / length).exp()));
        let mut recording = Recording::empty("key".to_owned());
        recording.time = vec![0.0, end];
        let mut keep = |name: String, value: f64| {
            recording.series.insert(name, vec![vec![0.0], vec![value]]);
        };
        let depth = top - bottom;
        keep("gauge.depth.depth".to_owned(), top - FOOT);
        keep("mass.present".to_owned(), weight * WIDTH * depth / GRAVITY);
        for piece in 0..PIECES {
            let (low, high) = (foot(piece).max(bottom), foot(piece + 1).min(top));
            let force = if high > low {
                k * (integral(top - low) - integral(top - high))
            } else {
                0.0
            };
            for (side, sign) in [("left", -1.0), ("right", 1.0)] {
                keep(format!("gauge.{side}_{piece}.force_x"), sign * force);
                keep(format!("gauge.{side}_{piece}.force_y"), -FRICTION * force);
            }
        }
        let floor = weight * length * (1.0 - (-depth / length).exp());
        keep("gauge.floor.force_y".to_owned(), -floor * WIDTH);
        let found = measure(&recording).unwrap();
        assert!((found.mobilised / FRICTION - 1.0).abs() < 1e-9);
        // The mean over a piece stands for its integral.
        assert!((found.k / k - 1.0).abs() < 0.01, "{}", found.k);
        assert!(found.worst() < 0.01, "{}", found.worst());
        assert!((found.floor / found.janssen(found.depth) - 1.0).abs() < 0.01);
        assert!(
            found
                .local
                .iter()
                .all(|(_, local)| (local / k - 1.0).abs() < 0.04)
        );
    }
}
