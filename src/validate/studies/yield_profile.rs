//! Exact steady profile of a layer of a fluid of Herschel and Bulkley that a force drives along a wall.
//!
//! Symbols: tau = tau_0 + K gamma^n, G force per volume, b thickness of the layer from the wall to where nothing shears (the
//! middle of a channel, the surface of a film), y distance from there, y_c = tau_0/G.

use crate::validate::report::number;
use crate::validate::template::Template;
use crate::validate::{Effort, Metric, Rule};

/// A fluid of Herschel and Bulkley.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fluid {
    pub(super) name: &'static str,
    /// [kg/m^3]
    pub(super) density: f64,
    /// K [Pa s^n].
    pub(super) consistency: f64,
    /// n [1].
    pub(super) index: f64,
    /// tau_0 [Pa].
    pub(super) yield_stress: f64,
}

/// The clay of Monge-Gapper et al. (2024), Table 1.
pub(super) const CLAY: Fluid = Fluid {
    name: "clay",
    density: 1540.0,
    consistency: 4.472,
    index: 0.472,
    yield_stress: 30.0,
};

impl Fluid {
    /// The template with this fluid as its `fluid`.
    pub(super) fn pour(&self, template: Template) -> Template {
        template
            .with("materials.fluid.density", self.density)
            .with("materials.fluid.consistency", self.consistency)
            .with("materials.fluid.flow_index", self.index)
            .with("materials.fluid.yield_stress", self.yield_stress)
    }

    /// A cell of a table: the plug's spread, of fluids that have one.
    pub(super) fn spread_cell(&self, spread: f64) -> String {
        if self.yield_stress > 0.0 {
            number(spread)
        } else {
            "-".to_owned()
        }
    }

    /// Judges errors at three numbers of rows by what is asked of them.
    pub(super) fn judge(
        &self,
        counts: [u32; 3],
        found: [Option<Errors>; 3],
        asked: &Asked,
    ) -> Vec<Metric> {
        let name = format!("{}{}", self.name, asked.of);
        let [coarse, middle, fine] = counts;
        let l2 = |k: usize| found[k].map(|f: Errors| f.particles);
        let profile = |k: usize| found[k].map(|f: Errors| f.profile);
        let order = |(coarse_error, fine_error): (f64, f64)| {
            (coarse_error / fine_error).ln() / (f64::from(fine) / f64::from(coarse)).ln()
        };
        let mut metrics = vec![
            Metric::new(
                format!("{name}: L2 of velocity, {middle} rows"),
                l2(1),
                Rule::AtMost(0.01),
                asked.at,
            ),
            Metric::new(
                format!("{name}: order from {coarse} to {fine} rows"),
                l2(0).zip(l2(2)).map(order),
                asked.order,
                asked.reason,
            ),
            Metric::new(
                format!("{name}: order of the profile from {coarse} to {fine} rows"),
                profile(0).zip(profile(2)).map(order),
                Rule::Report(None),
                "means over rows and times",
            ),
        ];
        if self.yield_stress > 0.0 {
            metrics.push(Metric::new(
                format!("{name}: spread of the plug's speed, {middle} rows"),
                found[1].map(|f| f.spread),
                Rule::AtMost(1e-3),
                "a plug is rigid",
            ));
        }
        metrics
    }
}

/// What is asked of a fluid's errors.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    /// Follows the fluid's name: which of its runs.
    pub(super) of: &'static str,
    /// Why 1 % at the middle number of rows.
    pub(super) at: &'static str,
    /// Of the order of single particles' errors.
    pub(super) order: Rule,
    /// Why that order.
    pub(super) reason: &'static str,
}

/// Rows over the thickness of a layer.
pub(super) fn rows(effort: Effort) -> [u32; 3] {
    effort.pick([10, 20, 40], [4, 6, 8])
}

/// Five times in the last quarter of a run [s].
pub(super) fn last_quarter(until: f64) -> Vec<f64> {
    (0..5)
        .map(|k| until * (0.75 + 0.0625 * f64::from(k)))
        .collect()
}

/// How far a computed layer is from its exact profile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Errors {
    /// Root of the mean square of u - exact over that of the exact u, of single particles [1].
    pub(super) particles: f64,
    /// The same of the means of rows [1].
    pub(super) profile: f64,
    /// Spread of the plug's velocity over its exact one; 0 without a plug [1].
    pub(super) spread: f64,
}

/// What flows, and what drives it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer {
    pub(super) fluid: Fluid,
    /// G [Pa/m].
    pub(super) force: f64,
    /// b [m].
    pub(super) thickness: f64,
}

impl Layer {
    /// y_c, half the plug of a channel or the plug of a film [m].
    pub(super) fn plug(&self) -> f64 {
        self.fluid.yield_stress / self.force
    }

    /// Exact velocity at y >= 0 [m/s]: u_p = n/(n+1) (G/K)^(1/n) (b-y_c)^(1+1/n), u = u_p [1 - ((y-y_c)/(b-y_c))^(1+1/n)].
    pub(super) fn velocity(&self, y: f64) -> f64 {
        let n = self.fluid.index;
        let sheared = self.thickness - self.plug();
        if sheared <= 0.0 {
            return 0.0;
        }
        let most = n / (n + 1.0)
            * (self.force / self.fluid.consistency).powf(1.0 / n)
            * sheared.powf(1.0 + 1.0 / n);
        let s = ((y - self.plug()) / sheared).max(0.0);
        most * (1.0 - s.powf(1.0 + 1.0 / n))
    }

    /// Of distances y >= 0 and velocities of particles, and the number of rows over the thickness. `None` without particles that should
    /// move.
    pub(super) fn errors(
        &self,
        found: impl Iterator<Item = (f64, f64)>,
        rows: u32,
    ) -> Option<Errors> {
        let (mut error, mut size, mut plug) = (0.0, 0.0, Vec::new());
        let fastest = self.velocity(0.0);
        let mut each_row = vec![(0.0, 0.0, 0.0); rows as usize];
        for (y, u) in found {
            let exact = self.velocity(y);
            error += (u - exact).powi(2);
            size += exact * exact;
            let row = ((y / self.thickness * f64::from(rows)) as usize).min(rows as usize - 1);
            let (sum, exact_sum, count) = &mut each_row[row];
            (*sum, *exact_sum, *count) = (*sum + u, *exact_sum + exact, *count + 1.0);
            // Not within two spacings of the yield surface, where the kernel sees sheared fluid.
            if y < 0.8 * self.plug() {
                plug.push(u / fastest);
            }
        }
        let mean = crate::validate::statistics::mean(&plug).unwrap_or(0.0);
        let squares: f64 = plug.iter().map(|u| (u - mean).powi(2)).sum();
        let spread = (squares / plug.len().max(1) as f64).sqrt();
        let full = each_row.iter().filter(|row| row.2 > 0.0);
        let (row_error, row_size) = full.fold((0.0, 0.0), |(e, s), (u, exact, n)| {
            (e + ((u - exact) / n).powi(2), s + (exact / n).powi(2))
        });
        (size > 0.0).then(|| Errors {
            particles: (error / size).sqrt(),
            profile: (row_error / row_size).sqrt(),
            spread,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_solves_its_equation() {
        // A clay film of 60 mm at 3 degrees: 0.1264 m/s.
        let film = Layer {
            fluid: CLAY,
            force: CLAY.density * 9.81 * 3f64.to_radians().sin(),
            thickness: 0.06,
        };
        assert!((film.velocity(0.0) - 0.1264).abs() < 1e-4);
        assert_eq!(film.velocity(0.06), 0.0);
        // tau = G y wherever it shears.
        for y in [0.04, 0.05, 0.058] {
            let rate = (film.velocity(y - 1e-6) - film.velocity(y + 1e-6)) / 2e-6;
            let stress = CLAY.yield_stress + CLAY.consistency * rate.powf(CLAY.index);
            assert!((stress / (film.force * y) - 1.0).abs() < 1e-5, "{y}");
        }
        assert_eq!(film.velocity(0.03), film.velocity(0.0));
    }
}
