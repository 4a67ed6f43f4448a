//! Gauges: what a component measures, one gauge a file, each as docs/gauges.md defines it.
//!
//! Gauges read particles (and wall particles) and change nothing. They are sampled once per communication step.
//! They know no scene, no variable and no file; `component::sampling` makes them from a scene.
//!
//! To add one: a file here with the definition, its closed-form tests and a `sample` function, an entry in
//! [`Field`] if it reads particles, and its variables in `component::variables`.

mod crossing;
mod depth;
mod fit;
mod front;
mod interface;
mod mass;
mod nearby;
mod pressure;
mod profile;
mod solid;
mod velocity;
mod view;

pub use crossing::Crossing;
pub use depth::DepthLine;
pub use front::Front;
pub use interface::{Edge, interface_stress};
pub use mass::{MassBox, PRESSED_IN};
pub use pressure::PressureProbe;
pub use profile::Profile;
pub use solid::Solid;
pub use velocity::VelocityProbe;
pub use view::{View, is_outside};

/// Whether a reading means something. Its number is what the `gauge.NAME.validity` variable shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Validity {
    /// 0: the reading is good.
    #[default]
    Valid,
    /// 1: no material where the gauge looks; the values are 0.
    Empty,
    /// 2: the gauge's place is outside the domain; the values are 0.
    Outside,
    /// 3: a wall or gate covers the gauge's place; the values are 0.
    Blocked,
}

impl Validity {
    /// The number shown to orchestrators: 0 valid, 1 empty, 2 outside, 3 blocked.
    #[must_use]
    pub fn code(self) -> u8 {
        match self {
            Validity::Valid => 0,
            Validity::Empty => 1,
            Validity::Outside => 2,
            Validity::Blocked => 3,
        }
    }
}

/// What one gauge shows.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Reading {
    /// Values in the gauge's own order and SI units; never NaN.
    pub values: Vec<f64>,
    /// Whether they mean something.
    pub validity: Validity,
}

impl Reading {
    /// A good reading.
    #[must_use]
    pub fn valid(values: Vec<f64>) -> Self {
        Self {
            values,
            validity: Validity::Valid,
        }
    }

    /// A reading of `count` zeros that says why there is none.
    #[must_use]
    pub fn none(count: usize, why: Validity) -> Self {
        Self {
            values: vec![0.0; count],
            validity: why,
        }
    }
}

/// Gauges that read the field of particles (the others read what devices and sections counted).
#[derive(Clone, Debug, PartialEq)]
pub enum Field<const D: usize> {
    /// One value: depth [m].
    Depth(DepthLine<D>),
    /// `count` values: depths [m].
    Profile(Profile<D>),
    /// One value: pressure [Pa].
    Pressure(PressureProbe<D>),
    /// D values: velocity [m/s].
    Velocity(VelocityProbe<D>),
    /// Two values: front and 99.5 % mass quantile [m].
    Front(Front<D>),
    /// One value: mass in a box [kg].
    Mass(MassBox<D>),
}

/// Samples a gauge.
#[must_use]
pub fn sample<const D: usize>(gauge: &Field<D>, view: &View<D>) -> Reading {
    match gauge {
        Field::Depth(line) => line.sample(view),
        Field::Profile(profile) => profile.sample(view),
        Field::Pressure(probe) => probe.sample(view),
        Field::Velocity(probe) => probe.sample(view),
        Field::Front(front) => front.sample(view),
        Field::Mass(counted) => counted.sample(view),
    }
}

/// Place at `distance` [m] from `origin` along `direction`.
fn along<const D: usize>(origin: &[f64; D], direction: &[f64; D], distance: f64) -> [f64; D] {
    std::array::from_fn(|a| origin[a] + distance * direction[a])
}

/// Component of `x - origin` along a unit vector [m].
fn component<const D: usize>(x: &[f64; D], origin: &[f64; D], direction: &[f64; D]) -> f64 {
    (0..D).map(|a| (x[a] - origin[a]) * direction[a]).sum()
}
