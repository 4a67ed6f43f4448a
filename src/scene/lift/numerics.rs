//! Numerical choices, and resolution against the bodies.

use super::Lift;
use crate::scene::raw::{RawNumerics, RotationWord, YieldWord};
use crate::scene::types::{Dimension, NamedMaterial};
use crate::solver::{Numerics, Rotation, SHORTEST_PERIOD, Scheme, YieldForm};

/// Most particles of a scene: memory of a large machine.
pub(crate) const MOST_PARTICLES: f64 = 50e6;
/// Most cells of the neighbour grid: those of particles and of walls take some 12 GB then.
const MOST_CELLS: f64 = 1e9;
/// Edge of such a cell: a kernel's support and the skin of neighbour lists, over the smoothing length [1].
const CELL: f64 = 0.5 * SHORTEST_PERIOD;
/// Largest radius of rings over the particle spacing. Masses are whole multiples of one that a ring there has 2^24 of (so that their
/// sum is exact): the innermost, half a spacing from the axis, is right to 0.6 %.
pub(super) const LARGEST_RADIUS: f64 = 1e5;
/// Time scale of the gate on density diffusion, over c0/g [1].
const GATE: f64 = 0.3;

impl Lift<'_> {
    pub(super) fn numerics(&mut self, materials: &[Option<NamedMaterial>]) -> Option<Numerics> {
        let table = self.raw.numerics.as_ref()?;
        let raw = &table.value;
        self.check_particle_count(raw);
        let sound_speed = self.sound_speed(raw, &table.place, materials);
        let scheme = self.scheme(raw, &table.place, materials);
        let yield_form = yield_form(raw)?;
        self.check_own_sound_speeds(sound_speed?);
        Some(Numerics {
            spacing: raw.spacing.as_ref()?.value.0,
            smoothing_ratio: raw.smoothing_ratio.as_ref()?.value.0,
            sound_speed: sound_speed?,
            fall_speed: self.fall_speed(sound_speed?),
            scheme: scheme?,
            courant: match &raw.courant {
                Some(given) => given.value.0,
                None if matches!(scheme, Some(Scheme::Implicit)) => 0.7,
                None => 0.5,
            },
            acoustic_steps: self.acoustic_steps(raw, scheme?, materials)?,
            yield_form,
            cap_time: match &raw.cap_time {
                Some(given) => given.value.0,
                None => self.cap_time(yield_form, sound_speed?),
            },
            density_diffusion: raw.density_diffusion.as_ref()?.value.0,
            diffusion_gate_time: match &raw.diffusion_gate_time {
                Some(given) => given.value.0,
                None => GATE * self.time_scale(sound_speed?),
            },
            friction_into_walls: raw.friction_into_walls.as_ref()?.value.0,
            strain_relaxation_time: raw.strain_relaxation_time.as_ref()?.value.0,
            pair_viscosity_share: pair_viscosity_share(raw, materials),
            rotation: match raw.rotation.as_ref()?.value {
                RotationWord::Cohesive => Rotation::Cohesive,
                RotationWord::All => Rotation::All,
                RotationWord::Off => Rotation::Off,
            },
            artificial_viscosity: raw.artificial_viscosity.as_ref()?.value.0,
            shifting: match &raw.shifting {
                Some(given) => given.value.0,
                None if matches!(scheme, Some(Scheme::PaperB(_))) => 1.0,
                None => 0.0,
            },
            solver_tolerance: raw.solver_tolerance.as_ref()?.value.0,
            solver_max_iterations: u32::try_from(raw.solver_max_iterations.as_ref()?.value.0)
                .unwrap_or(u32::MAX),
            sleep: raw.sleep.as_ref()?.value.0,
            seepage_interval: raw.seepage_interval.as_ref()?.value.0,
            resize_rings: raw.resize_rings.as_ref()?.value.0,
            jitter: raw.jitter.as_ref()?.value.0,
            seed: raw.seed.as_ref()?.value.0,
        })
    }

    /// As many as are asked for, if the scene bears so many; as many as it bears if none are.
    fn acoustic_steps(
        &mut self,
        raw: &RawNumerics,
        scheme: Scheme,
        materials: &[Option<NamedMaterial>],
    ) -> Option<u32> {
        let damping = raw.artificial_viscosity.as_ref()?.value.0;
        let diffusion = raw.density_diffusion.as_ref()?.value.0;
        let materials = materials.iter().flatten().map(|m| &m.material);
        let most = Numerics::most_acoustic_steps(
            scheme,
            self.axisymmetric(),
            (damping, diffusion),
            materials,
        );
        let Some(given) = &raw.acoustic_steps else {
            return Some(most);
        };
        let asked = u32::try_from(given.value.0).unwrap_or(u32::MAX);
        if asked > most && scheme == Scheme::Implicit {
            self.problems.report(
                &given.place,
                format!("{asked} acoustic steps"),
                format!(
                    "at most {most} here: 1 in axisymmetric scenes and with fluids, saturated grains, consistency, bulk friction or artificial viscosity, else 1/density_diffusion"
                ),
                "leave acoustic_steps out",
            );
            return None;
        }
        Some(asked)
    }

    /// c0/g, ten times sqrt(H/g) where nothing is faster than a fall from H; standard gravity stands in where there is none.
    fn time_scale(&self, sound_speed: f64) -> f64 {
        let g = self.gravity_size();
        sound_speed / if g > 0.0 { g } else { 9.806_65 }
    }

    /// A few times the time scale of the scene.
    fn cap_time(&self, form: YieldForm, sound_speed: f64) -> f64 {
        let times = match form {
            YieldForm::Exact { .. } => 2.0,
            YieldForm::Capped => 20.0,
        };
        times * self.time_scale(sound_speed)
    }

    /// No more particles than a machine holds.
    fn check_particle_count(&mut self, raw: &RawNumerics) {
        let Some(spacing) = &raw.spacing else {
            return;
        };
        let axes = i32::try_from(self.axes()).unwrap_or(3);
        let volume: f64 = self.filled.iter().map(|f| f.region.measure()).sum();
        let particles = volume / spacing.value.0.powi(axes);
        if particles > MOST_PARTICLES {
            self.problems.report(
                &spacing.place,
                format!(
                    "a spacing of {} m, which makes {particles:.3e} particles",
                    spacing.value.0
                ),
                format!("at most {MOST_PARTICLES:.0e} particles"),
                "use a coarser spacing or smaller bodies",
            );
        } else {
            self.check_extent(raw, particles);
        }
    }

    /// A domain may be as large as it likes but for two things. The neighbour grid covers the particles, with no more cells than they
    /// deserve, but an axis that repeats it covers whole; and masses of rings are measured by those at the domain's rim.
    fn check_extent(&mut self, raw: &RawNumerics, particles: f64) {
        let (Some(spacing), Some(cells)) = (&raw.spacing, self.cells(raw, particles)) else {
            return;
        };
        let dp = spacing.value.0;
        let mut report = |found: String, allowed: String, remedy: &str| {
            let found = format!("a spacing of {dp} m in this domain, {found}");
            self.problems.report(&spacing.place, found, allowed, remedy);
        };
        if cells > MOST_CELLS {
            report(
                format!("{cells:.3e} cells"),
                format!(
                    "at most {MOST_CELLS:.0e} cells of the neighbour grid, which covers axes that repeat whole"
                ),
                "use a coarser spacing, or a smaller domain along the axes that repeat",
            );
        }
        let rim = self.domain.as_ref().map_or(0.0, |d| d.upper[0]) / dp;
        if self.dimension == Dimension::Axisymmetric && rim > LARGEST_RADIUS {
            report(
                format!("{rim:.3e} spacings to its rim"),
                format!(
                    "at most {LARGEST_RADIUS:.0e} spacings from the axis to the rim: masses of rings are exact to what one there weighs"
                ),
                "use a coarser spacing, or a smaller domain across the axis",
            );
        }
    }

    /// Cells of the neighbour grid at most; 0 where nothing repeats.
    fn cells(&self, raw: &RawNumerics, particles: f64) -> Option<f64> {
        let domain = self.domain.as_ref()?;
        let edge = CELL * raw.smoothing_ratio.as_ref()?.value.0 * raw.spacing.as_ref()?.value.0;
        let axes = self.axes();
        if !domain.periodic[..axes].contains(&true) {
            return Some(0.0);
        }
        // What comes in is not known.
        let inflows = self.raw.inflows.is_some();
        let most = if inflows { MOST_PARTICLES } else { particles };
        // As the grid is made (`solver::grid`).
        let across = 4.0 * (4.0 * most + 64.0).powf(1.0 / axes as f64).max(8.0);
        let cells = (0..axes).map(|a| {
            let count = (domain.upper[a] - domain.lower[a]) / edge;
            match domain.periodic[a] {
                true => count,
                false => count.clamp(1.0, across),
            }
        });
        Some(cells.product())
    }
}

/// What is given; else more where all that flows is a Newton's fluid.
fn pair_viscosity_share(raw: &RawNumerics, materials: &[Option<NamedMaterial>]) -> f64 {
    if let Some(given) = &raw.pair_viscosity_share {
        return given.value.0;
    }
    let mut materials = materials.iter().flatten();
    if materials.all(|m| m.material.is_newtonian()) {
        0.5
    } else {
        0.05
    }
}

fn yield_form(raw: &RawNumerics) -> Option<YieldForm> {
    let iterations = raw.yield_iterations.as_ref()?.value.0;
    Some(match raw.r#yield.as_ref()?.value {
        YieldWord::Capped => YieldForm::Capped,
        YieldWord::Exact => YieldForm::Exact {
            iterations: u32::try_from(iterations).unwrap_or(u32::MAX),
        },
    })
}
