//! Values with units on the command line: "2 s", "5 ms" or plain SI numbers, as in scene files.

use crate::units::{Quantity, parse};

/// A time span greater than 0 [s].
///
/// # Errors
/// What was found and what is allowed, for clap's message.
pub(super) fn positive_time(text: &str) -> Result<f64, String> {
    let seconds = parse(text, Quantity::Time).map_err(|error| error.to_string())?;
    if seconds > 0.0 {
        Ok(seconds)
    } else {
        Err(format!("found {seconds} s, allowed more than 0 s"))
    }
}

/// A speed against the clock, greater than 0 and perhaps infinite [1].
///
/// # Errors
/// As [`positive_time`].
pub(super) fn speed(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(factor) if factor > 0.0 => Ok(factor),
        _ => Err("allowed: a number above 0, or inf for as fast as possible".to_owned()),
    }
}

/// A time span of 0 or more [s].
///
/// # Errors
/// As [`positive_time`].
pub(super) fn time(text: &str) -> Result<f64, String> {
    let seconds = parse(text, Quantity::Time).map_err(|error| error.to_string())?;
    if seconds >= 0.0 {
        Ok(seconds)
    } else {
        Err(format!("found {seconds} s, allowed 0 s or more"))
    }
}

#[cfg(test)]
mod tests {
    use super::{positive_time, time};

    #[test]
    fn times_may_be_zero() {
        assert_eq!(time("0"), Ok(0.0));
        assert!(time("-1 ms").unwrap_err().contains("0 s or more"));
    }

    #[test]
    fn durations_take_units_and_must_be_positive() {
        assert_eq!(positive_time("20 ms"), Ok(0.02));
        assert_eq!(positive_time("1.5"), Ok(1.5));
        for (text, reason) in [
            ("0", "more than 0 s"),
            ("-1 s", "more than 0 s"),
            ("2 mm", "a length"),
            ("nan", "not a decimal number"),
        ] {
            let message = positive_time(text).unwrap_err();
            assert!(message.contains(reason), "{text}: {message}");
        }
    }
}
