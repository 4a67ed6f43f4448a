//! Thin-layer flow of Bingham's fluid on a level floor: what a block does on its way to rest (Liu and Mei 1989,
//! doi 10.1017/S0022112089002685).
//!
//! Symbols: h depth, G = rho g |h_x| force per volume, y_c = tau_0/G thickness of the plug, q discharge per width down the slope,
//!
//!   h_t + q_x = 0,   q = G (h - y_c)^2 (2 h + y_c)/(6 K) where h > y_c, else 0.

/// A fluid, and the block that it starts as; the floor's left end is a wall.
#[derive(Clone, Copy, Debug)]
pub(super) struct Block {
    /// rho g [Pa/m].
    pub(super) weight: f64,
    /// tau_0 [Pa].
    pub(super) yield_stress: f64,
    /// K [Pa s].
    pub(super) consistency: f64,
    /// [m]
    pub(super) length: f64,
    /// [m]
    pub(super) height: f64,
}

/// Cells over the block's length.
const CELLS: usize = 26;

impl Block {
    /// Where the depth falls to 0 at each of these times, in order [s -> m].
    pub(super) fn fronts<const N: usize>(&self, times: [f64; N]) -> [f64; N] {
        let dx = self.length / CELLS as f64;
        let mut h = vec![0.0; 5 * CELLS];
        h[..CELLS].fill(self.height);
        let mut time = 0.0;
        times.map(|end| {
            while time < end {
                time += self.advance(&mut h, dx, end - time);
            }
            front(&h, dx)
        })
    }

    /// One explicit step within `left` [s]; returns its length.
    fn advance(&self, h: &mut [f64], dx: f64, left: f64) -> f64 {
        let deepest = h.iter().copied().fold(0.0, f64::max);
        let spreading = self.weight * deepest.powi(3) / (3.0 * self.consistency);
        let dt = (0.25 * dx * dx / spreading).min(left);
        let mut before = 0.0;
        for k in 0..h.len() {
            let after = if k + 1 < h.len() {
                self.discharge(h[k], h[k + 1], dx)
            } else {
                0.0
            };
            h[k] += dt / dx * (before - after);
            before = after;
        }
        dt
    }

    /// q from a depth to the next one, dx on.
    fn discharge(&self, a: f64, b: f64, dx: f64) -> f64 {
        let (h, force) = (0.5 * (a + b), self.weight * (a - b).abs() / dx);
        let sheared = force * h - self.yield_stress;
        if sheared <= 0.0 {
            return 0.0;
        }
        let (plug, s) = (self.yield_stress / force, sheared / force);
        force * s * s * (2.0 * h + plug) / (6.0 * self.consistency) * (a - b).signum()
    }
}

/// h^2 is a line near the front: where it falls to 0.
fn front(h: &[f64], dx: f64) -> f64 {
    let least = 0.02 * h[0];
    let last = h.iter().rposition(|d| *d > least).unwrap_or(0).max(1);
    let (a, b) = (h[last - 1].powi(2), h[last].powi(2));
    let centre = (last as f64 + 0.5) * dx;
    if a > b {
        centre + dx * (b / (a - b)).min(1.0)
    } else {
        centre
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MUD: Block = Block {
        weight: 1540.0 * 9.81,
        yield_stress: 30.0,
        consistency: 50.0,
        length: 0.26,
        height: 0.13,
    };

    #[test]
    fn a_block_comes_to_rest_where_the_floor_bears_its_yield_stress() {
        let area = MUD.length * MUD.height;
        let rest = (9.0 / 8.0 * area * area * MUD.weight / MUD.yield_stress).cbrt();
        // Quicker fluid: the same shape sooner.
        let [front] = Block {
            consistency: 1.0,
            ..MUD
        }
        .fronts([60.0]);
        assert!((front / rest - 1.0).abs() < 0.01, "{front} for {rest}");
    }

    #[test]
    fn no_fluid_is_lost() {
        let mut h = vec![0.0; 40];
        h[..10].fill(0.1);
        for _ in 0..1000 {
            MUD.advance(&mut h, 0.01, 1.0);
        }
        assert!((h.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(h[12] > 0.0 && h.iter().all(|d| *d >= 0.0));
    }
}
