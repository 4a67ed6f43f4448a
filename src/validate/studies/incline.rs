//! `inclined_plane`: steady and starting flow down a plane against the exact solution of mu(I) with dilatancy.

mod figures;
mod measure;

use crate::validate::bagnold::{Grains, Layer};
use crate::validate::statistics::{interpolate, rms};
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{Effort, Member, Metric, Recording, Report, Results, Rule, Study};
use measure::{WINDOW, mean_velocity, pressure_error, velocity_errors, window, worst_second};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "inclined_plane",
    title: "Flow down an inclined plane against the exact dilated profile",
    about: "A layer 0.1 m deep of mu(I) grains with dilatancy on a rough plane, periodic along it (10 particles). Steady flow \
has a closed solution (Bagnold's profile; [A] eq. 56 with its exponents corrected): I = I0 (tan th - mu_s)/(mu_2 - tan th) at \
every height, phi = phi(I), depth H = 0.1 m x 0.6/phi,\n\n\
    v(z) = (2/3) (I/d) sqrt(phi g cos th) (H^(3/2) - (H - z)^(3/2)),   p = phi rho_s g cos th (H - z).\n\n\
Flows start in that profile and run for 10 s. Velocity error: mean of v - exact in twenty bins over the depth, over the last \
3 s, root mean square of the bins over the exact surface velocity. Pressure error: root mean square over all particles of p - exact, over the exact pressure \
of the bed. Material of Table 1 of [A] (Minatti and Paris 2015); no artificial viscosity.\n\n\
The start from rest is held against the one-dimensional transient of the same laws, solved by finite volumes in the mass \
coordinate (src/validate/bagnold.rs, tested against the closed solution).",
    members,
    analyse,
};

const GRAVITY: f64 = 9.81;
const DEPTH: f64 = 0.1;
const TEMPLATE: &str = include_str!("../../../cases/validation/incline.toml");
/// Particles in a period along the plane.
const COLUMNS: f64 = 10.0;

/// How a layer starts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Start {
    /// In the steady profile, with its density.
    Profile,
    /// At rest.
    Rest,
    /// All at one velocity along the plane [m/s].
    Slab(f64),
}

/// One run.
#[derive(Clone, Copy, Debug)]
struct Run {
    name: &'static str,
    /// Slope [deg].
    slope: f64,
    /// Particles over the depth.
    rows: u32,
    /// Preset of the material.
    preset: &'static str,
    /// Grain diameter [m].
    diameter: f64,
    smoothing: f64,
    start: Start,
    /// End [s].
    until: f64,
}

/// 25 degrees, 20 particles over the depth, glass beads of 5 mm.
const BASE: Run = Run {
    name: "glass_25",
    slope: 25.0,
    rows: 20,
    preset: "glass_beads",
    diameter: 5e-3,
    smoothing: 1.6,
    start: Start::Profile,
    until: 10.0,
};

/// From rest: 10 s are three quarters of the way.
const START: Run = Run {
    name: "glass_25_rest",
    start: Start::Rest,
    ..BASE
};

/// Flows that keep the steady profile; the last is [A]'s own layer, 12.8 m/s fast.
const FLOWS: [Run; 9] = [
    BASE,
    Run {
        name: "glass_25_fine",
        rows: 40,
        ..BASE
    },
    Run {
        name: "glass_21.5",
        slope: 21.5,
        ..BASE
    },
    Run {
        name: "glass_23",
        slope: 23.0,
        ..BASE
    },
    Run {
        name: "glass_28",
        slope: 28.0,
        ..BASE
    },
    Run {
        name: "sand_30",
        slope: 30.0,
        preset: "sand_08",
        ..BASE
    },
    Run {
        name: "glass_25_h1.3",
        smoothing: 1.3,
        ..BASE
    },
    Run {
        name: "glass_25_h2.0",
        smoothing: 2.0,
        ..BASE
    },
    Run {
        name: "glass_25_d0.5mm",
        diameter: 0.5e-3,
        ..BASE
    },
];

/// Below the angle of repose, 20.9 degrees.
const STOPS: [Run; 2] = [
    Run {
        name: "stops_19",
        slope: 19.0,
        start: Start::Slab(0.2),
        ..BASE
    },
    Run {
        name: "stops_20.5",
        slope: 20.5,
        start: Start::Slab(0.2),
        ..BASE
    },
];

impl Run {
    fn layer(&self) -> Layer {
        let material = match self.preset {
            "sand_08" => Grains::sand_08(self.diameter),
            _ => Grains::glass_beads(self.diameter),
        };
        Layer {
            material,
            slope: self.slope.to_radians(),
            depth: DEPTH,
            gravity: GRAVITY,
        }
    }

    /// The layer that a run has: its depth at phi_max from its mass, whatever density it started with.
    fn layer_of(&self, recording: &Recording) -> Layer {
        let mut layer = self.layer();
        let rows = recording.particles as f64 / COLUMNS;
        if let Some(mass) = recording.last("mass.present").filter(|_| rows > 0.0) {
            let period = COLUMNS * DEPTH / rows;
            layer.depth = mass / (period * layer.material.grain_density * layer.material.phi_max);
        }
        layer
    }

    /// Largest speed that is expected [m/s].
    fn speed(&self) -> f64 {
        match self.start {
            Start::Slab(speed) => speed,
            Start::Profile | Start::Rest => self.layer().surface_velocity(),
        }
    }

    fn member(&self, effort: Effort) -> Result<Member, String> {
        let rows = effort.pick(self.rows, self.rows / 2);
        let until = effort.pick(self.until, self.until / 6.0);
        let spacing = DEPTH / f64::from(rows);
        let period = COLUMNS * spacing;
        let mut template = Template::new(TEMPLATE)?
            // Fast layers throw grains up.
            .with("domain.upper", point(period, 5.0 * DEPTH))
            .with("domain.slope", self.slope.to_radians())
            .with("numerics.spacing", spacing)
            .with("numerics.smoothing_ratio", self.smoothing)
            .with("numerics.expected_speed", self.speed())
            .with("materials.grains.preset", self.preset)
            .with("materials.grains.grain_diameter", self.diameter)
            .with("bodies.layer.box", rectangle([0.0, 0.0], [period, DEPTH]))
            .with("walls.bed.polyline", points(&[[0.0, 0.0], [period, 0.0]]))
            .with("gauges.depth.foot", point(0.5 * period, 0.0))
            .with("run.until", until);
        match self.start {
            Start::Rest => {}
            Start::Profile => template = template.with("bodies.layer.velocity_profile", "bagnold"),
            Start::Slab(speed) => {
                template = template.with("bodies.layer.velocity", point(speed, 0.0))
            }
        }
        // Five a second: means over three seconds see fifteen, and the start is followed closely.
        let times = (0..=(5.0 * until).floor() as u32).map(|k| f64::from(k) / 5.0);
        let series = ["energy.kinetic", "mass.present", "gauge.depth.depth"];
        Ok(Member::new(
            self.name.to_owned(),
            template.text()?,
            &series,
            times.collect(),
        ))
    }
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    FLOWS
        .iter()
        .chain([&START])
        .chain(&STOPS)
        .map(|run| run.member(effort))
        .collect()
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    for run in &FLOWS {
        report.metrics.extend(steady(results, run));
    }
    report.metrics.push(order(results));
    report.metrics.push(transient(results));
    report
        .metrics
        .extend(STOPS.iter().map(|run| stops(results, run)));
    report.figures.push(figures::profiles(results)?);
    report.figures.push(figures::starts(results)?);
    report.notes.push(
        "The grains of the computation are a little compressible (sound speed ten times the largest speed): at the bed \
         density is up to 0.6 % above the exact solution's, which knows no compression. That is part of the errors above."
            .to_owned(),
    );
    Ok(report)
}

/// What a run gave, if it finished.
fn l2(results: &Results, run: &Run) -> Option<f64> {
    let recording = results.finished(run.name)?;
    rms(&velocity_errors(
        window(recording),
        &run.layer_of(recording),
    ))
}

fn steady(results: &Results, run: &Run) -> Vec<Metric> {
    let recording = results.finished(run.name);
    let errors = recording.map(|r| velocity_errors(window(r), &run.layer_of(r)));
    let name = format!(
        "{} of {} mm at {} deg, {} particles over the depth, h/dp {}",
        run.preset,
        1e3 * run.diameter,
        run.slope,
        run.rows,
        run.smoothing
    );
    let allowed = match run.name {
        "glass_25" => 0.01,
        "glass_25_fine" => 0.005,
        _ => 0.02,
    };
    let pressure = recording.and_then(|r| pressure_error(window(r), &run.layer_of(r)));
    let pressure_rule = match run.name {
        "glass_25" | "glass_25_fine" => Rule::AtMost(0.012),
        _ => Rule::Report(None),
    };
    vec![
        Metric::new(
            format!("{name}: velocity, L2"),
            l2(results, run),
            Rule::AtMost(allowed),
            "exact; a prototype of the same method reached 1.0 % at 20 and 0.5 % at 40 particles",
        ),
        Metric::new(
            format!("{name}: the same of the worst second after the first two"),
            recording.and_then(|r| worst_second(r, &run.layer_of(r))),
            Rule::Report(None),
            "a flow that drifts or breaks up on the way shows here",
        ),
        Metric::new(
            format!("{name}: velocity at the surface"),
            errors.and_then(|e| Some(1.0 + e.last()?)),
            Rule::Report(Some(1.0)),
            "mean of the uppermost bin, over the exact one",
        ),
        Metric::new(
            format!("{name}: pressure, rms"),
            pressure,
            pressure_rule,
            "exact; noise included, a prototype reached 1.1 %",
        ),
    ]
}

fn order(results: &Results) -> Metric {
    let order = l2(results, &FLOWS[0])
        .zip(l2(results, &FLOWS[1]))
        .map(|(c, f)| (c / f).log2());
    Metric::new(
        "observed order of the velocity error, 20 to 40 particles",
        order,
        Rule::AtLeast(1.0),
        "the wall and the surface are first order",
    )
}

/// Root mean square over the first ten seconds of mean velocity minus the transient's, over the steady one.
fn transient(results: &Results) -> Metric {
    let value = results.finished(START.name).and_then(|recording| {
        let layer = START.layer_of(recording);
        let exact = exact_transient(&layer);
        let found = mean_velocity(recording);
        let early = found.iter().filter(|p| p.0 <= 10.0);
        let errors: Option<Vec<f64>> = early
            .map(|(t, v)| Some((v - interpolate(&exact, *t)?) / layer.mean_velocity()))
            .collect();
        rms(&errors?)
    });
    Metric::new(
        "glass_beads at 25 deg from rest: mean velocity against the transient, rms over 10 s",
        value,
        Rule::AtMost(0.02),
        "solved in one dimension with the same laws; as for steady flow at other slopes",
    )
}

fn exact_transient(layer: &Layer) -> Vec<(f64, f64)> {
    layer.mean_velocity_from_rest(10.0, 1000, 100)
}

/// Largest kinetic energy over the last three seconds, over m g H.
fn stops(results: &Results, run: &Run) -> Metric {
    let value = results.finished(run.name).and_then(|recording| {
        let end = recording.time.last()?;
        let energy = recording.curve("energy.kinetic");
        let late = energy.iter().filter(|p| p.0 >= end - WINDOW).map(|p| p.1);
        let mass = recording.last("mass.present")?;
        Some(late.fold(0.0, f64::max) / (mass * GRAVITY * DEPTH))
    });
    Metric::new(
        format!(
            "started at 0.2 m/s on {} deg: kinetic energy from 7 to 10 s, over m g H",
            run.slope
        ),
        value,
        Rule::AtMost(1e-10),
        "below the angle of repose, 20.9 deg, nothing flows: the bound of all rest tests",
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A layer filled at the density of its flow is as deep as one that dilates to it.
    #[test]
    fn the_depth_follows_from_the_mass() {
        let layer = BASE.layer();
        let mut recording = Recording::empty("key".to_owned());
        recording.particles = 200;
        let mass = 0.05 * DEPTH * layer.volume_fraction() * layer.material.grain_density;
        recording
            .series
            .insert("mass.present".to_owned(), vec![vec![mass]]);
        let found = BASE.layer_of(&recording).dilated_depth();
        assert!((found / DEPTH - 1.0).abs() < 1e-12, "{found}");
    }
}
