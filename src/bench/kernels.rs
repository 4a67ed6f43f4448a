//! The solver's sweeps alone, against their plain scalar forms and the roofline kernel, over particle counts.

use serde::{Deserialize, Serialize};

use super::clock::{median, median_ratio, timed};
use super::roofline::Roofline;
use crate::solver::{Pass, Passes};

/// Displacement of the lattice over dp [1]: that of scenes.
const JITTER: f64 = 0.1;

/// Least number of particles that one timing goes through: short sweeps are repeated.
const LEAST_WORK: usize = 30_000;

/// Timings of one size.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Kernels {
    /// 2 in the plane, 3 in space.
    pub dimension: usize,
    /// Number of particles.
    pub particles: usize,
    /// Pairs within the support, each counted from both sides.
    pub pairs: usize,
    /// Rounds of which medians are taken.
    pub rounds: usize,
    /// The sweeps.
    pub passes: Vec<PassTime>,
    /// The kernel that does nothing but sums; in the plane.
    pub roofline: Option<RooflineTime>,
    /// Largest difference between fast and plain results over the largest result [1].
    pub disagreement: f64,
}

/// One sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PassTime {
    /// [`Pass::name`].
    pub name: String,
    /// CPU time a particle [ns].
    pub ns: f64,
    /// Of the plain scalar form [ns].
    pub plain_ns: Option<f64>,
    /// Plain over fast, median of rounds [1].
    pub times_plain: Option<f64>,
}

/// The roofline kernel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RooflineTime {
    /// CPU time a particle [ns].
    pub ns: f64,
    /// Of its plain scalar form over neighbour lists [ns].
    pub plain_ns: f64,
    /// Of its plain scalar form that searches cells [ns].
    pub cells_ns: f64,
    /// Share of its lanes' work inside the support [1].
    pub filled: f64,
    /// Pairs a second of the solver's pair sweep over those of the kernel, median of rounds [1].
    pub reached: f64,
    /// Pairs a second of the solver's pair sweep over those of the kernel's plain form over lists, median of rounds [1].
    pub times_plain: f64,
    /// The same over its plain form that searches cells [1].
    pub times_cells: f64,
}

impl Kernels {
    /// The timing of a sweep.
    #[must_use]
    pub fn pass(&self, pass: Pass) -> Option<&PassTime> {
        self.passes.iter().find(|p| p.name == pass.name())
    }

    /// Million pairs a second at so many nanoseconds a particle.
    #[must_use]
    pub fn rate(&self, ns: f64) -> f64 {
        1e3 * self.pairs as f64 / (self.particles as f64 * ns)
    }

    /// Pairs a particle.
    #[must_use]
    pub fn neighbours(&self) -> f64 {
        self.pairs as f64 / self.particles as f64
    }
}

/// Times all sweeps over about `count` particles, in the plane (D = 2) or in space (D = 3). `watch` hears of each round.
#[must_use]
pub fn measure<const D: usize>(count: usize, rounds: usize, watch: &mut dyn FnMut(f64)) -> Kernels {
    let side = (count as f64).powf(1.0 / D as f64).round().max(1.0) as usize;
    let mut passes = Passes::<D>::new(side, JITTER);
    let mut roofline = roofline(&passes);
    let disagreement = passes
        .disagreement()
        .into_iter()
        .map(|(_, difference)| difference)
        .chain(roofline.as_mut().map(Roofline::disagreement))
        .fold(0.0, f64::max);
    let mut times = Times::default();
    for round in 0..rounds {
        if let Some(roofline) = &mut roofline {
            times.add_roofline(roofline, passes.particles());
        }
        times.add_passes(&mut passes);
        watch((round + 1) as f64 / rounds as f64);
    }
    let neighbours = passes.pairs() as f64 / passes.particles() as f64;
    Kernels {
        dimension: D,
        particles: passes.particles(),
        pairs: passes.pairs(),
        rounds,
        passes: times.of_passes(),
        roofline: roofline.and_then(|kernel| times.of_roofline(&kernel, neighbours)),
        disagreement,
    }
}

/// CPU time a particle in each round [ns].
#[derive(Default)]
struct Times {
    /// Of each sweep, and of its plain form if it has one, in the order of [`Pass::ALL`].
    fast: [Vec<f64>; Pass::ALL.len()],
    plain: [Vec<f64>; Pass::ALL.len()],
    /// Of the roofline kernel, its plain form over lists, and its plain form that searches cells.
    kernel: Vec<f64>,
    kernel_plain: Vec<f64>,
    kernel_cells: Vec<f64>,
}

impl Times {
    /// A round of the kernel, as often as sweeps over `particles` are repeated.
    fn add_roofline(&mut self, roofline: &mut Roofline, particles: usize) {
        let (count, repeats) = (roofline.particles(), LEAST_WORK.div_ceil(particles));
        let run = each(count, repeats, || timed(|| roofline.run()).0);
        self.kernel.push(run);
        let plain = each(count, repeats, || timed(|| roofline.run_plain()).0);
        self.kernel_plain.push(plain);
        let cells = each(count, repeats, || timed(|| roofline.run_cells()).0);
        self.kernel_cells.push(cells);
    }

    /// A round of all sweeps.
    fn add_passes<const D: usize>(&mut self, passes: &mut Passes<D>) {
        let particles = passes.particles();
        let repeats = LEAST_WORK.div_ceil(particles);
        for (k, pass) in Pass::ALL.into_iter().enumerate() {
            self.fast[k].push(each(particles, repeats, || {
                passes.prepare(pass);
                timed(|| passes.run(pass)).0
            }));
            if pass.has_plain() {
                self.plain[k].push(each(particles, repeats, || {
                    timed(|| passes.run_plain(pass)).0
                }));
            }
        }
    }

    fn of_passes(&self) -> Vec<PassTime> {
        let time = |(k, pass): (usize, Pass)| {
            let (fast, plain) = (&self.fast[k], &self.plain[k]);
            PassTime {
                name: pass.name().to_owned(),
                ns: median(fast),
                plain_ns: pass.has_plain().then(|| median(plain)),
                times_plain: pass.has_plain().then(|| median_ratio(plain, fast)),
            }
        };
        Pass::ALL.into_iter().enumerate().map(time).collect()
    }

    /// The kernel against the sweep over pairs, which has so many neighbours a particle.
    fn of_roofline(&self, kernel: &Roofline, neighbours: f64) -> Option<RooflineTime> {
        let pairs = Pass::ALL.iter().position(|p| *p == Pass::Pairs)?;
        let fast = &self.fast[pairs];
        // Both go through the same particles but for at most three.
        let same = neighbours * kernel.particles() as f64 / kernel.pairs() as f64;
        Some(RooflineTime {
            ns: median(&self.kernel),
            plain_ns: median(&self.kernel_plain),
            cells_ns: median(&self.kernel_cells),
            filled: kernel.filled(),
            reached: same * median_ratio(&self.kernel, fast),
            times_plain: same * median_ratio(&self.kernel_plain, fast),
            times_cells: same * median_ratio(&self.kernel_cells, fast),
        })
    }
}

/// The kernel over the same particles; there is none in space.
fn roofline<const D: usize>(passes: &Passes<D>) -> Option<Roofline> {
    let flat = |rows: &[[f64; D]]| -> Vec<[f64; 2]> { rows.iter().map(|r| [r[0], r[1]]).collect() };
    let h = passes.smoothing_length();
    (D == 2).then(|| {
        Roofline::new(
            &flat(passes.positions()),
            &flat(passes.velocities()),
            h / passes.smoothing_ratio(),
            h,
        )
    })
}

/// Mean of repeated timings, a particle [ns].
fn each(particles: usize, repeats: usize, mut once: impl FnMut() -> f64) -> f64 {
    let spent: f64 = (0..repeats).map(|_| once()).sum();
    1e9 * spent / (repeats * particles) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fast_and_plain_agree_and_all_figures_are_numbers() {
        let mut heard = Vec::new();
        let plane = measure::<2>(400, 2, &mut |share| heard.push(share));
        assert_eq!(heard, [0.5, 1.0]);
        let space = measure::<3>(400, 1, &mut |_| ());
        assert!(space.roofline.is_none());
        for kernels in [&plane, &space] {
            assert!(kernels.disagreement < 1e-11, "{}", kernels.disagreement);
            assert!(kernels.neighbours() > 10.0);
            for pass in &kernels.passes {
                let figures = [Some(pass.ns), pass.plain_ns, pass.times_plain];
                let positive = |f: &f64| f.is_finite() && *f > 0.0;
                assert!(figures.iter().flatten().all(positive), "{pass:?}");
            }
        }
        let roofline = plane.roofline.unwrap();
        for figure in [
            roofline.ns,
            roofline.plain_ns,
            roofline.reached,
            roofline.times_plain,
        ] {
            assert!(figure.is_finite() && figure > 0.0);
        }
    }
}
