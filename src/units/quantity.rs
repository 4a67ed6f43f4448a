//! Quantities and the units each may be written in.

/// A physical quantity that a scene may state; each has its SI unit and the units it may be written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Length [m].
    Length,
    /// Time [s].
    Time,
    /// Angle [rad].
    Angle,
    /// Velocity [m/s].
    Velocity,
    /// Angular velocity [rad/s].
    AngularVelocity,
    /// Acceleration [m/s^2].
    Acceleration,
    /// Mass per time [kg/s].
    MassRate,
    /// Density [kg/m^3].
    Density,
    /// Pressure or stress [Pa].
    Pressure,
    /// Compressibility [1/Pa].
    Compressibility,
    /// Viscosity, or a consistency [Pa s, Pa s^n].
    Viscosity,
    /// A number without dimension \[1\].
    Ratio,
}

/// A unit: its spelling and the exact fraction that turns a value into SI.
#[derive(Clone, Copy, Debug)]
pub(super) struct Unit {
    pub(super) symbol: &'static str,
    pub(super) times: f64,
    pub(super) over: f64,
}

/// A unit of a quantity: SI value = value * times / over. Dividing keeps "3.02 mm" at the double next to 0.00302.
const fn unit(symbol: &'static str, times: f64, over: f64) -> Unit {
    Unit {
        symbol,
        times,
        over,
    }
}

const LENGTH: &[Unit] = &[
    unit("m", 1.0, 1.0),
    unit("mm", 1.0, 1e3),
    unit("cm", 1.0, 1e2),
    unit("um", 1.0, 1e6),
    unit("km", 1e3, 1.0),
];
const TIME: &[Unit] = &[
    unit("s", 1.0, 1.0),
    unit("ms", 1.0, 1e3),
    unit("us", 1.0, 1e6),
    unit("min", 60.0, 1.0),
    unit("h", 3600.0, 1.0),
];
const ANGLE: &[Unit] = &[
    unit("rad", 1.0, 1.0),
    unit("deg", std::f64::consts::PI, 180.0),
];
const VELOCITY: &[Unit] = &[
    unit("m/s", 1.0, 1.0),
    unit("mm/s", 1.0, 1e3),
    unit("cm/s", 1.0, 1e2),
    unit("km/h", 1.0, 3.6),
];
const ANGULAR_VELOCITY: &[Unit] = &[
    unit("rad/s", 1.0, 1.0),
    unit("deg/s", std::f64::consts::PI, 180.0),
    unit("rpm", std::f64::consts::PI, 30.0),
];
const ACCELERATION: &[Unit] = &[unit("m/s^2", 1.0, 1.0), unit("m/s2", 1.0, 1.0)];
const MASS_RATE: &[Unit] = &[
    unit("kg/s", 1.0, 1.0),
    unit("g/s", 1.0, 1e3),
    unit("kg/min", 1.0, 60.0),
    unit("kg/h", 1.0, 3600.0),
    unit("t/h", 1.0, 3.6),
];
const DENSITY: &[Unit] = &[
    unit("kg/m^3", 1.0, 1.0),
    unit("kg/m3", 1.0, 1.0),
    unit("g/cm^3", 1e3, 1.0),
    unit("g/cm3", 1e3, 1.0),
    unit("t/m^3", 1e3, 1.0),
    unit("t/m3", 1e3, 1.0),
];
const PRESSURE: &[Unit] = &[
    unit("Pa", 1.0, 1.0),
    unit("kPa", 1e3, 1.0),
    unit("MPa", 1e6, 1.0),
    unit("bar", 1e5, 1.0),
    unit("kN/m^2", 1e3, 1.0),
    unit("kN/m2", 1e3, 1.0),
];
const COMPRESSIBILITY: &[Unit] = &[
    unit("Pa^-1", 1.0, 1.0),
    unit("kPa^-1", 1.0, 1e3),
    unit("MPa^-1", 1.0, 1e6),
    unit("bar^-1", 1.0, 1e5),
];
const VISCOSITY: &[Unit] = &[unit("Pa s", 1.0, 1.0), unit("mPa s", 1.0, 1e3)];
const RATIO: &[Unit] = &[unit("1", 1.0, 1.0), unit("%", 1.0, 1e2)];

impl Quantity {
    /// Every quantity.
    pub const ALL: [Quantity; 12] = [
        Quantity::Length,
        Quantity::Time,
        Quantity::Angle,
        Quantity::Velocity,
        Quantity::AngularVelocity,
        Quantity::Acceleration,
        Quantity::MassRate,
        Quantity::Density,
        Quantity::Pressure,
        Quantity::Compressibility,
        Quantity::Viscosity,
        Quantity::Ratio,
    ];

    /// Its units, SI first.
    pub(super) fn units(self) -> &'static [Unit] {
        match self {
            Quantity::Length => LENGTH,
            Quantity::Time => TIME,
            Quantity::Angle => ANGLE,
            Quantity::Velocity => VELOCITY,
            Quantity::AngularVelocity => ANGULAR_VELOCITY,
            Quantity::Acceleration => ACCELERATION,
            Quantity::MassRate => MASS_RATE,
            Quantity::Density => DENSITY,
            Quantity::Pressure => PRESSURE,
            Quantity::Compressibility => COMPRESSIBILITY,
            Quantity::Viscosity => VISCOSITY,
            Quantity::Ratio => RATIO,
        }
    }

    /// What people call it: "length".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Quantity::Length => "length",
            Quantity::Time => "time",
            Quantity::Angle => "angle",
            Quantity::Velocity => "velocity",
            Quantity::AngularVelocity => "angular velocity",
            Quantity::Acceleration => "acceleration",
            Quantity::MassRate => "mass rate",
            Quantity::Density => "density",
            Quantity::Pressure => "pressure",
            Quantity::Compressibility => "compressibility",
            Quantity::Viscosity => "viscosity",
            Quantity::Ratio => "ratio",
        }
    }

    /// Its SI unit, the meaning of plain numbers: "m".
    #[must_use]
    pub fn si(self) -> &'static str {
        self.units()[0].symbol
    }

    /// The units it may be written in, SI first.
    pub fn symbols(self) -> impl Iterator<Item = &'static str> {
        self.units().iter().map(|u| u.symbol)
    }

    /// An example of the text form: "2 mm".
    #[must_use]
    pub fn example(self) -> &'static str {
        match self {
            Quantity::Length => "2 mm",
            Quantity::Time => "5 ms",
            Quantity::Angle => "25 deg",
            Quantity::Velocity => "0.5 m/s",
            Quantity::AngularVelocity => "10 rpm",
            Quantity::Acceleration => "9.81 m/s^2",
            Quantity::MassRate => "0.5 kg/s",
            Quantity::Density => "2600 kg/m^3",
            Quantity::Pressure => "20 kPa",
            Quantity::Compressibility => "4e-5 Pa^-1",
            Quantity::Viscosity => "1 mPa s",
            Quantity::Ratio => "40 %",
        }
    }

    /// What may be written: `a length: a number in m, or text with a unit (m, mm, cm, um, km)`.
    #[must_use]
    pub fn allowed(self) -> String {
        let article = if matches!(
            self,
            Quantity::Angle | Quantity::AngularVelocity | Quantity::Acceleration
        ) {
            "an"
        } else {
            "a"
        };
        let plain = match self {
            Quantity::Ratio => "a plain number".to_owned(),
            _ => format!("a number in {}", self.si()),
        };
        let units: Vec<_> = self.symbols().collect();
        format!(
            "{article} {}: {plain}, or text with a unit ({})",
            self.name(),
            units.join(", ")
        )
    }
}
