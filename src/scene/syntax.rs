//! Text that is not TOML: what stands where it goes wrong, and how to write it.

use super::raw::{self, Problems};
use crate::units::quote;

/// Every syntax error with its line, column and what stands there, one a place.
pub(super) fn report_syntax(text: &str, errors: &[toml::de::Error], problems: &mut Problems) {
    let mut repeated = Vec::new();
    let mut told = Vec::new();
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        let is_double = error.message().contains("duplicate key");
        if is_double && is_repeated(text, span.start, &mut repeated) {
            continue;
        }
        let (start, token) = token_at(text, span.start);
        if told.contains(&start) {
            // A number that is wrong in two ways, such as "-.5".
            continue;
        }
        told.push(start);
        let found = if is_double {
            let key = text.get(span.clone()).unwrap_or_default();
            format!("duplicate key {}", quote(key))
        } else if token.is_empty() {
            error.message().to_owned()
        } else {
            let column = column(text, start);
            format!("{} at column {column}: {}", quote(token), error.message())
        };
        let remedy = if is_double {
            "rename or delete one of the two: every name and key stands once in its section"
                .to_owned()
        } else if text.trim_start().starts_with(['{', '<']) {
            "scene files are TOML, not JSON or XML: see docs/scene.md".to_owned()
        } else if let Some(number) = as_number(token) {
            format!("write {number}")
        } else {
            "correct the line: keys are written key = value, text in double quotes, sections as [name]"
                .to_owned()
        };
        problems.report(&raw::syntax_place(span.start), found, "TOML", remedy);
    }
}

/// Whether a duplicate key belongs to a section that stands twice and has been told: its keys are reported again one by
/// one, which says nothing new.
fn is_repeated(text: &str, offset: usize, told: &mut Vec<usize>) -> bool {
    let header = section_start(text, offset);
    if told.contains(&header) {
        return true;
    }
    if text.get(header..offset).is_some_and(|t| !t.contains('\n')) {
        told.push(header);
    }
    false
}

/// Offset of the `[section]` line that an offset belongs to; 0 before the first.
fn section_start(text: &str, offset: usize) -> usize {
    let before = text.get(..offset).unwrap_or_default();
    let line = before.rfind('\n').map_or(0, |at| at + 1);
    if before[line..].starts_with('[') {
        return line;
    }
    before.rfind("\n[").map_or(0, |at| at + 1)
}

/// What stands at an offset between signs that part values, and where it starts; empty on such a sign.
fn token_at(text: &str, offset: usize) -> (usize, &str) {
    let parts = |c: char| c.is_whitespace() || "[]{},=#\"'".contains(c);
    let (Some(before), Some(after)) = (text.get(..offset), text.get(offset..)) else {
        return (offset, "");
    };
    // The error of "2." is behind it.
    let start = before.char_indices().rev().find(|(_, c)| parts(*c));
    let start = start.map_or(0, |(at, c)| at + c.len_utf8());
    let end = offset + after.find(parts).unwrap_or(after.len());
    (start, &text[start..end])
}

/// Column of an offset, in characters from 1.
fn column(text: &str, offset: usize) -> usize {
    let before = &text[..offset];
    let line = before.rfind('\n').map_or(0, |at| at + 1);
    before[line..].chars().count() + 1
}

/// A number that other languages know, as TOML has it: digits on both sides of the point, none leading in vain.
fn as_number(token: &str) -> Option<String> {
    let unsigned = token.trim_start_matches(['+', '-']);
    let sign = &token[..token.len() - unsigned.len()];
    let (mantissa, exponent) = match unsigned.find(['e', 'E']) {
        Some(at) => unsigned.split_at(at),
        None => (unsigned, ""),
    };
    let (whole, fraction) = match mantissa.split_once('.') {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (mantissa, None),
    };
    let digits = |s: &str| s.chars().all(|c| c.is_ascii_digit());
    if !digits(whole) || !fraction.is_none_or(digits) || sign.len() > 1 {
        return None;
    }
    let whole = match whole.trim_start_matches('0') {
        "" => "0",
        rest => rest,
    };
    let fraction = match fraction {
        None => String::new(),
        Some("") => ".0".to_owned(),
        Some(digits) => format!(".{digits}"),
    };
    let number = format!("{sign}{whole}{fraction}{exponent}");
    let is_one = mantissa.contains(|c: char| c.is_ascii_digit())
        && number.parse::<f64>().is_ok_and(f64::is_finite);
    (is_one && number != token).then_some(number)
}

#[cfg(test)]
mod tests {
    use super::super::parse;
    use super::*;

    /// Line, found and remedy of each problem.
    fn told(text: &str) -> Vec<(usize, String, String)> {
        let errors = parse("scene", text).unwrap_err();
        let all = errors.problems().iter();
        all.map(|p| (p.line, p.found.clone(), p.remedy.clone()))
            .collect()
    }

    #[test]
    fn a_number_without_a_digit_before_or_behind_its_point_is_told_once_with_what_to_write() {
        let told = told("a = .2\nb = [1.0, 2., -.5, 3.e2]\nc = 007\n");
        let expected = [
            (1, "\".2\" at column 5", "write 0.2"),
            (2, "\"2.\" at column 11", "write 2.0"),
            (2, "\"-.5\" at column 15", "write -0.5"),
            (2, "\"3.e2\" at column 20", "write 3.0e2"),
            (3, "\"007\" at column 5", "write 7"),
        ];
        assert_eq!(told.len(), expected.len(), "{told:?}");
        for ((line, found, remedy), (at, token, number)) in told.iter().zip(expected) {
            assert_eq!((*line, remedy.as_str()), (at, number), "{found}");
            assert!(found.starts_with(token), "{found}");
        }
    }

    #[test]
    fn what_is_no_number_is_told_as_it_stands() {
        let told = told("a = 1.2.3\nb = fast\n");
        assert_eq!(told.len(), 2, "{told:?}");
        assert!(told[0].1.contains("\"1.2.3\" at column 5"), "{told:?}");
        assert!(told[1].1.contains("\"fast\" at column 5"), "{told:?}");
        assert!(told.iter().all(|t| t.2.starts_with("correct the line")));
        for token in ["", ".", "+", "e5", "nan", "-", "1.5", "--.5", "mm"] {
            assert_eq!(as_number(token), None, "{token}");
        }
    }
}
