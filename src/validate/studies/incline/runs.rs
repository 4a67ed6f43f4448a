//! The runs of the study `inclined_plane`: slopes, materials, spacings, starts.

use crate::validate::bagnold::{Grains, Layer};
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{Effort, Member, Recording};

pub(super) const GRAVITY: f64 = 9.81;
pub(super) const DEPTH: f64 = 0.1;
const TEMPLATE: &str = include_str!("../../../../cases/validation/incline.toml");
/// Particles in a period along the plane.
pub(super) const COLUMNS: f64 = 10.0;

/// How a layer starts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Start {
    /// In the steady profile, with its density.
    Profile,
    /// At rest.
    Rest,
    /// All at one velocity along the plane [m/s].
    Slab(f64),
}

/// One run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Run {
    pub(super) name: &'static str,
    /// Slope [deg].
    pub(super) slope: f64,
    /// Particles over the depth.
    pub(super) rows: u32,
    /// Preset of the material.
    pub(super) preset: &'static str,
    /// Grain diameter [m].
    pub(super) diameter: f64,
    pub(super) smoothing: f64,
    /// Sound speed over the default's.
    pub(super) stiffness: f64,
    /// Whose rotation makes no stress.
    rotation: &'static str,
    start: Start,
    /// End [s].
    until: f64,
}

/// 25 degrees, 20 particles over the depth, glass beads of 5 mm.
pub(super) const BASE: Run = Run {
    name: "glass_25",
    slope: 25.0,
    rows: 20,
    preset: "glass_beads",
    diameter: 5e-3,
    smoothing: 1.6,
    stiffness: 1.0,
    rotation: "cohesive",
    start: Start::Profile,
    until: 10.0,
};

/// From rest: 10 s are three quarters of the way.
pub(super) const START: Run = Run {
    name: "glass_25_rest",
    start: Start::Rest,
    ..BASE
};

/// Flows that keep the steady profile; the last three are [A]'s own layer, 12.8 m/s fast.
pub(super) const FLOWS: [Run; 11] = [
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
    FAST,
    Run {
        name: "glass_25_d0.5mm_rows40",
        rows: 40,
        ..FAST
    },
    Run {
        name: "glass_25_d0.5mm_rows80",
        rows: 80,
        ..FAST
    },
];

/// The layer of [A] 5.1: at its bed a row of 20 is 0.97 m/s faster than the one below, and rho v^2/2 of that is 0.5 of the pressure there.
const FAST: Run = Run {
    name: "glass_25_d0.5mm",
    diameter: 0.5e-3,
    ..BASE
};

/// The first two of [`FLOWS`] at twice the sound speed: what compression has a part in.
pub(super) const STIFF: [Run; 2] = [
    Run {
        name: "stiff_25",
        stiffness: 2.0,
        ..BASE
    },
    Run {
        name: "stiff_25_fine",
        rows: 40,
        stiffness: 2.0,
        ..BASE
    },
];

/// Some of [`FLOWS`] with sand that turns without stress, too.
pub(super) const TURNS: [Run; 3] = [
    Run {
        name: "turns_25",
        rotation: "all",
        ..BASE
    },
    Run {
        name: "turns_25_fine",
        rows: 40,
        rotation: "all",
        ..BASE
    },
    Run {
        name: "turns_28",
        slope: 28.0,
        rotation: "all",
        ..BASE
    },
];

/// How few particles over the depth will do.
pub(super) const THIN: [Run; 5] = [
    Run {
        name: "glass_25_rows10",
        rows: 10,
        ..BASE
    },
    Run {
        name: "glass_25_rows6",
        rows: 6,
        ..BASE
    },
    Run {
        name: "glass_25_rows4",
        rows: 4,
        ..BASE
    },
    Run {
        name: "glass_25_rows3",
        rows: 3,
        ..BASE
    },
    Run {
        name: "glass_25_rows2",
        rows: 2,
        ..BASE
    },
];

/// Below the angle of repose, 20.9 degrees.
pub(super) const STOPS: [Run; 2] = [
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
    pub(super) fn layer(&self) -> Layer {
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
    pub(super) fn layer_of(&self, recording: &Recording) -> Layer {
        let mut layer = self.layer();
        let rows = recording.particles as f64 / COLUMNS;
        if let Some(mass) = recording.last("mass.present").filter(|_| rows > 0.0) {
            let period = COLUMNS * DEPTH / rows;
            layer.depth = mass / (period * layer.material.grain_density * layer.material.phi_max);
        }
        layer
    }

    /// Largest speed that is expected, a tenth of the sound speed [m/s].
    fn speed(&self) -> f64 {
        let speed = match self.start {
            Start::Slab(speed) => speed,
            Start::Profile | Start::Rest => self.layer().surface_velocity(),
        };
        self.stiffness * speed
    }

    pub(super) fn member(&self, effort: Effort) -> Result<Member, String> {
        let rows = effort.pick(self.rows, (self.rows / 2).max(2));
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
            .with("numerics.rotation", self.rotation)
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
