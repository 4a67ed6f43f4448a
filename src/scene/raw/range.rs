//! Ranges of numbers: checked when a scene is read, stated in its schema and in messages.

use serde_json::{Map, Value, json};

/// A number as people write it: 1e-14, not 0.00000000000001.
fn short(number: f64) -> String {
    let small = number != 0.0 && number.abs() < 1e-4;
    if small || number.abs() >= 1e7 {
        format!("{number:e}")
    } else {
        format!("{number}")
    }
}

/// An interval; each end may be open, closed or absent (infinite).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::scene) struct Range {
    lower: f64,
    upper: f64,
    lower_open: bool,
}

impl Range {
    /// Above `lower`.
    pub(super) const fn above(lower: f64) -> Self {
        Self {
            lower,
            upper: f64::INFINITY,
            lower_open: true,
        }
    }

    /// `lower` or more.
    pub(super) const fn from(lower: f64) -> Self {
        Self {
            lower,
            upper: f64::INFINITY,
            lower_open: false,
        }
    }

    /// From `lower` to `upper`, ends included.
    pub(super) const fn within(lower: f64, upper: f64) -> Self {
        Self {
            lower,
            upper,
            lower_open: false,
        }
    }

    /// Above `lower` and at most `upper`.
    pub(super) const fn above_to(lower: f64, upper: f64) -> Self {
        Self {
            lower,
            upper,
            lower_open: true,
        }
    }

    /// Its two ends; an open one is no part of it.
    pub(in crate::scene) fn ends(self) -> (f64, f64) {
        (self.lower, self.upper)
    }

    /// Whether a number lies inside.
    pub(super) fn contains(self, number: f64) -> bool {
        let low = if self.lower_open {
            number > self.lower
        } else {
            number >= self.lower
        };
        low && number <= self.upper
    }

    /// In words, with a unit.
    pub(super) fn text(self, unit: &str) -> String {
        if unit == "rad" {
            // People think of slopes and friction in degrees.
            let degrees = |a: f64| (a.to_degrees() * 10.0).round() / 10.0;
            let (lower, upper) = (degrees(self.lower), degrees(self.upper));
            let range = Self {
                lower,
                upper,
                ..self
            };
            return format!(
                "{}, that is {}",
                self.plain_text("rad"),
                range.plain_text("deg")
            );
        }
        self.plain_text(if unit == "1" { "" } else { unit })
    }

    fn plain_text(self, unit: &str) -> String {
        let [lower, upper] = [self.lower, self.upper].map(short);
        let text = match (self.lower_open, self.upper.is_finite()) {
            (true, false) => format!("above {lower} {unit}"),
            (false, false) => format!("{lower} {unit} or more"),
            (true, true) => format!("above {lower} and at most {upper} {unit}"),
            (false, true) => format!("{lower} to {upper} {unit}"),
        };
        text.replace("  ", " ").trim().to_owned()
    }

    /// States it in a JSON Schema: for numbers as limits, for people as text.
    pub(super) fn describe(self, unit: &str, schema: &mut Map<String, Value>) {
        let key = if self.lower_open {
            "exclusiveMinimum"
        } else {
            "minimum"
        };
        schema.insert(key.into(), json!(self.lower));
        if self.upper.is_finite() {
            schema.insert("maximum".into(), json!(self.upper));
        }
        schema.insert("x-range".into(), json!(self.text(unit)));
    }
}
