//! Exact steady profile of a layer of a fluid of Herschel and Bulkley that a force drives along a wall.
//!
//! Symbols: tau = tau_0 + K gamma^n, G force per volume, b thickness of the layer from the wall to where nothing shears (the
//! middle of a channel, the surface of a film), y distance from there, y_c = tau_0/G.

/// What flows, and what drives it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer {
    /// K [Pa s^n].
    pub(super) consistency: f64,
    /// n [1].
    pub(super) index: f64,
    /// tau_0 [Pa].
    pub(super) yield_stress: f64,
    /// G [Pa/m].
    pub(super) force: f64,
    /// b [m].
    pub(super) thickness: f64,
}

impl Layer {
    /// y_c, half the plug of a channel or the plug of a film [m].
    pub(super) fn plug(&self) -> f64 {
        self.yield_stress / self.force
    }

    /// Exact velocity at y >= 0 [m/s]: u_p = n/(n+1) (G/K)^(1/n) (b-y_c)^(1+1/n), u = u_p [1 - ((y-y_c)/(b-y_c))^(1+1/n)].
    pub(super) fn velocity(&self, y: f64) -> f64 {
        let n = self.index;
        let sheared = self.thickness - self.plug();
        if sheared <= 0.0 {
            return 0.0;
        }
        let most = n / (n + 1.0)
            * (self.force / self.consistency).powf(1.0 / n)
            * sheared.powf(1.0 + 1.0 / n);
        let s = ((y - self.plug()) / sheared).max(0.0);
        most * (1.0 - s.powf(1.0 + 1.0 / n))
    }

    /// Root of the mean square of u - exact over that of the exact u, and the spread of the plug's velocity over its exact one,
    /// 0 without a plug; of distances y >= 0 and velocities of particles. `None` without particles that should move.
    pub(super) fn errors(&self, found: impl Iterator<Item = (f64, f64)>) -> Option<(f64, f64)> {
        let (mut error, mut size, mut plug) = (0.0, 0.0, Vec::new());
        let fastest = self.velocity(0.0);
        for (y, u) in found {
            let exact = self.velocity(y);
            error += (u - exact).powi(2);
            size += exact * exact;
            // Not within two spacings of the yield surface, where the kernel sees sheared fluid.
            if y < 0.8 * self.plug() {
                plug.push(u / fastest);
            }
        }
        let mean = crate::validate::statistics::mean(&plug).unwrap_or(0.0);
        let squares: f64 = plug.iter().map(|u| (u - mean).powi(2)).sum();
        let spread = (squares / plug.len().max(1) as f64).sqrt();
        (size > 0.0).then(|| ((error / size).sqrt(), spread))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_solves_its_equation() {
        // A clay film of 60 mm at 3 degrees: 0.1264 m/s.
        let film = Layer {
            consistency: 4.472,
            index: 0.472,
            yield_stress: 30.0,
            force: 1540.0 * 9.81 * 3f64.to_radians().sin(),
            thickness: 0.06,
        };
        assert!((film.velocity(0.0) - 0.1264).abs() < 1e-4);
        assert_eq!(film.velocity(0.06), 0.0);
        // tau = G y wherever it shears.
        for y in [0.04, 0.05, 0.058] {
            let rate = (film.velocity(y - 1e-6) - film.velocity(y + 1e-6)) / 2e-6;
            let stress = film.yield_stress + film.consistency * rate.powf(film.index);
            assert!((stress / (film.force * y) - 1.0).abs() < 1e-5, "{y}");
        }
        assert_eq!(film.velocity(0.03), film.velocity(0.0));
    }
}
