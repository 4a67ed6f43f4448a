//! Numbers in the JSON that logs are read as and that the bus answers with.

use serde_json::{Number, Value};

/// A number. JSON has no NaN and no infinity: these become the strings `NaN`, `Infinity` and `-Infinity`, as in protobuf's JSON.
#[must_use]
pub fn number(x: f64) -> Value {
    match Number::from_f64(x) {
        Some(number) => Value::Number(number),
        None if x.is_nan() => Value::from("NaN"),
        None if x > 0.0 => Value::from("Infinity"),
        None => Value::from("-Infinity"),
    }
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn numbers_that_are_not_finite_are_written_as_text() {
        assert_eq!(number(0.1).to_string(), "0.1");
        assert_eq!(number(f64::NAN).to_string(), "\"NaN\"");
        assert_eq!(number(f64::INFINITY).to_string(), "\"Infinity\"");
        assert_eq!(number(f64::NEG_INFINITY).to_string(), "\"-Infinity\"");
    }
}
