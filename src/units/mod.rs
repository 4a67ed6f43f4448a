//! Quantities as they may be written in a scene: plain SI numbers, or text with a unit ("2 mm", "25 deg").
//!
//! The only unit code of the project: everything below a scene file is SI. Knows no physics and no files.

mod quantity;

use std::fmt;

pub use quantity::Quantity;

/// Text that is no value of the quantity asked for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitError {
    /// What was found, with its meaning where it has one: `"2 s" (a time)`.
    pub found: String,
    /// What was asked for.
    pub expected: Quantity,
}

impl fmt::Display for UnitError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "found {}, allowed {}; write for example \"{}\"",
            self.found,
            self.expected.allowed(),
            self.expected.example()
        )
    }
}

impl std::error::Error for UnitError {}

/// Longest text that can be a quantity; more is refused unread.
const LONGEST: usize = 64;

/// Reads a quantity from text, as its SI value; text without a unit is in SI.
///
/// # Errors
/// [`UnitError`] if the text is no finite decimal number followed by a unit of `expected`.
///
/// # Examples
/// ```
/// use sandgate::units::{parse, Quantity};
/// assert_eq!(parse("2 mm", Quantity::Length), Ok(0.002));
/// assert_eq!(parse("40%", Quantity::Ratio), Ok(0.4));
/// assert!(parse("2 s", Quantity::Length).unwrap_err().to_string().contains("(a time)"));
/// ```
pub fn parse(text: &str, expected: Quantity) -> Result<f64, UnitError> {
    let refuse = |note: &str| {
        Err(UnitError {
            found: format!("{}{note}", quote(text)),
            expected,
        })
    };
    let Some((number, symbol)) = split(text) else {
        return refuse(" (not a decimal number with a unit)");
    };
    let symbol = match symbol {
        "°" => "deg",
        "µm" | "μm" => "um",
        other => other,
    };
    let known = expected
        .units()
        .iter()
        .find(|u| u.symbol == symbol || symbol.is_empty());
    let Some(unit) = known else {
        return match Quantity::ALL
            .iter()
            .find(|q| q.symbols().any(|s| s == symbol))
        {
            Some(other) => refuse(&format!(" ({})", with_article(other.name()))),
            None if symbol.starts_with(',') => refuse(&format!(
                " (unknown unit {}; decimals come after a point)",
                quote(symbol)
            )),
            None => refuse(&format!(" (unknown unit {})", quote(symbol))),
        };
    };
    let value = number * unit.times / unit.over;
    if value.is_finite() {
        Ok(value)
    } else {
        refuse(" (too large for a number)")
    }
}

/// Quotes text for a message, cut to a readable length, control characters escaped.
#[must_use]
pub fn quote(text: &str) -> String {
    let mut shown: String = text.chars().take(LONGEST).collect();
    if shown.len() < text.len() {
        shown.push_str("...");
    }
    format!("{shown:?}")
}

/// Bytes as lower-case hexadecimal.
#[must_use]
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// A number for a message: the shortest text that reads as it, with an exponent where zeros would fill the line.
#[must_use]
pub fn shown(number: f64) -> String {
    let size = number.abs();
    if size != 0.0 && size.is_finite() && !(1e-4..1e15).contains(&size) {
        format!("{number:e}")
    } else {
        format!("{number}")
    }
}

/// A bound for a message: as [`shown`], but for the rounding of a product (3.75, not 3.7499999999999996).
#[must_use]
pub fn shown_bound(number: f64) -> String {
    let rounded = format!("{number:.14e}").parse().ok();
    // The largest double is rounded to more than it.
    let finite = rounded.filter(|r: &f64| r.is_finite());
    shown(finite.unwrap_or(number))
}

fn with_article(name: &str) -> String {
    let article = if name.starts_with(['a', 'e', 'i', 'o', 'u']) {
        "an"
    } else {
        "a"
    };
    format!("{article} {name}")
}

/// Splits "2.5e-3 mm" into its number and its unit; the number is the longest prefix that is one.
fn split(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    if text.len() > LONGEST {
        return None;
    }
    let digits = text
        .find(|c: char| !(c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | 'e' | 'E')))
        .unwrap_or(text.len());
    (1..=digits).rev().find_map(|end| {
        let number: f64 = text[..end].parse().ok()?;
        Some((number, text[end..].trim_start()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_in_messages() {
        for (number, text) in [
            (1e300, "1e300"),
            (-5e-324, "-5e-324"),
            (0.0, "0"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1_700_000_000.01, "1700000000.01"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(shown(number), text);
        }
        let bounds = [3.749_999_999_999_999_6, 0.1, f64::MAX, 1.0 / 3.0];
        let texts = ["3.75", "0.1", "1.7976931348623157e308", "0.333333333333333"];
        assert_eq!(bounds.map(shown_bound), texts);
    }

    #[test]
    fn every_unit_reads_as_its_si_value() {
        let cases = [
            ("3.02 mm", Quantity::Length, 0.003_02),
            ("3.02mm", Quantity::Length, 0.003_02),
            (" 7 ", Quantity::Length, 7.0),
            ("-1.5e1 cm", Quantity::Length, -0.15),
            ("320 µm", Quantity::Length, 0.000_32),
            ("5 ms", Quantity::Time, 0.005),
            ("2 min", Quantity::Time, 120.0),
            ("1.5 h", Quantity::Time, 5400.0),
            ("180 deg", Quantity::Angle, std::f64::consts::PI),
            ("180°", Quantity::Angle, std::f64::consts::PI),
            ("36 km/h", Quantity::Velocity, 10.0),
            ("9.81 m/s^2", Quantity::Acceleration, 9.81),
            ("3.6 t/h", Quantity::MassRate, 1.0),
            ("2.6 g/cm^3", Quantity::Density, 2600.0),
            ("2.6 g/cm3", Quantity::Density, 2600.0),
            ("1.9 t/m3", Quantity::Density, 1900.0),
            ("20 kPa", Quantity::Pressure, 20_000.0),
            ("20 kN/m^2", Quantity::Pressure, 20_000.0),
            ("20 kN/m2", Quantity::Pressure, 20_000.0),
            ("4.1e-5 Pa^-1", Quantity::Compressibility, 4.1e-5),
            ("1 mPa s", Quantity::Viscosity, 1e-3),
            ("40 %", Quantity::Ratio, 0.4),
        ];
        for (text, quantity, si) in cases {
            assert_eq!(parse(text, quantity), Ok(si), "{text}");
        }
    }

    #[test]
    fn wrong_units_say_what_they_are_and_what_is_allowed() {
        let message = parse("2 s", Quantity::Length).unwrap_err().to_string();
        assert_eq!(
            message,
            "found \"2 s\" (a time), allowed a length: a number in m, or text with a unit (m, mm, cm, um, km); \
             write for example \"2 mm\""
        );
        for (text, note) in [
            ("2 parsec", "unknown unit \"parsec\""),
            ("nan", "not a decimal number"),
            ("inf m", "not a decimal number"),
            ("", "not a decimal number"),
            ("mm", "not a decimal number"),
            (
                "2,5 mm",
                "unknown unit \",5 mm\"; decimals come after a point",
            ),
            ("1e999 m", "too large"),
            ("2 e", "unknown unit \"e\""),
        ] {
            let message = parse(text, Quantity::Length).unwrap_err().to_string();
            assert!(message.contains(note), "{text}: {message}");
        }
        assert!(parse(&"9".repeat(10_000), Quantity::Length).is_err());
    }
}
