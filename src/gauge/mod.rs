//! Gauges: what a component measures, one gauge a file, each as docs/theory.md defines it.
//!
//! Gauges read particles (and wall particles) and change nothing. They are sampled once per communication step.
//! They know no scene, no variable and no file; `component::sampling` makes them from a scene.

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
