//! Text that is not TOML: what stands where it goes wrong, and how to write it.

use super::raw::{self, Problems};
use crate::units::quote;

/// More than so many are not told, and not looked for.
const MOST: usize = 100;

/// Every syntax error with its line, column and what stands there, one a place.
pub(super) fn report_syntax(text: &str, errors: &[toml::de::Error], problems: &mut Problems) {
    let mut repeated = Vec::new();
    let mut told = Vec::new();
    let unclosed = unclosed(text);
    if let Some(start) = unclosed {
        let bracket = &text[start..=start];
        let column = column(text, start);
        problems.report(
            &raw::syntax_place(start),
            format!("{} at column {column}, which is not closed", quote(bracket)),
            "TOML",
            format!("add {} where its value ends", quote(closing(bracket))),
        );
    }
    for error in errors {
        let span = error.span().unwrap_or(0..0);
        if unclosed.is_some_and(|start| span.start >= start) {
            // What follows is read as a part of that value.
            continue;
        }
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
        if told.len() > MOST {
            break;
        }
        let found = if is_double {
            let key = text.get(span.clone()).unwrap_or_default();
            format!(
                "duplicate key {}{}",
                quote(key),
                first_place(text, span.start)
            )
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

/// Where what stands at an offset a second time stands first, for messages: `, first in line 3`; empty where that is not found.
fn first_place(text: &str, offset: usize) -> String {
    let section = section_start(text, offset);
    let line = text[..offset].rfind('\n').map_or(0, |at| at + 1);
    let up_to = |line: &str, end: char| line.split_once(end).map(|(key, _)| key.trim().to_owned());
    // A header stands again anywhere, a key in its section.
    let (from, end) = if line == section && text[line..].starts_with('[') {
        (0, ']')
    } else {
        (section, '=')
    };
    let again = up_to(&text[line..], end);
    let mut at = from;
    for candidate in text[from..line].split_inclusive('\n') {
        if again.is_some() && up_to(candidate, end) == again {
            let number = text[..at].matches('\n').count() + 1;
            return format!(", first in line {number}");
        }
        at += candidate.len();
    }
    String::new()
}

fn closing(bracket: &str) -> &'static str {
    if bracket == "[" { "]" } else { "}" }
}

/// Offset of the bracket of a value that is not closed before a line that can only be a next one: a key behind `[`, a section
/// behind `{`, or the end of the text.
fn unclosed(text: &str) -> Option<usize> {
    let mut open: Vec<usize> = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let start = at;
        at += line.len();
        match open.last().map(|last| &text[*last..=*last]) {
            Some("[") if begins_a_key(line) => return open.first().copied(),
            Some("{") if begins_a_section(line) => return open.first().copied(),
            // A header's brackets are no value's.
            None if line.trim_start().starts_with('[') => continue,
            _ => {}
        }
        for (offset, sign) in outside_of_texts(line) {
            match sign {
                '[' | '{' => open.push(start + offset),
                ']' | '}' => drop(open.pop()),
                _ => {}
            }
        }
    }
    open.first().copied()
}

/// The signs of a line that are in no text and no comment. Texts over several lines are taken for several.
fn outside_of_texts(line: &str) -> impl Iterator<Item = (usize, char)> {
    let mut within: Option<char> = None;
    let mut is_escaped = false;
    let code = line.char_indices().filter(move |(_, sign)| {
        let was_within = within;
        match within {
            Some('"') if is_escaped => is_escaped = false,
            Some('"') if *sign == '\\' => is_escaped = true,
            Some(quote) if *sign == quote => within = None,
            None if matches!(sign, '"' | '\'' | '#') => within = Some(*sign),
            _ => {}
        }
        was_within.is_none()
    });
    code.filter(|(_, sign)| "[]{}".contains(*sign))
}

fn begins_a_key(line: &str) -> bool {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
    let rest = line.trim_start().trim_start_matches(is_bare);
    rest.len() < line.trim_start().len() && rest.trim_start().starts_with('=')
}

fn begins_a_section(line: &str) -> bool {
    let name = line.trim_start().trim_start_matches('[');
    line.starts_with('[') && name.starts_with(|c: char| c.is_ascii_alphabetic())
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
    fn a_bracket_that_is_not_closed_is_told_once_where_it_opens() {
        let rest = "b = 2 # ]\n[walls.bed]\npolyline = [[0, 0],\n  [1, 0]]\n";
        for (text, line, found) in [
            ("a = [1, \"]\",\n", 1, "\"[\" at column 5"),
            ("c = 1\na = [[1, 2], [3, 4]\n", 2, "\"[\" at column 5"),
            ("a = { x = [0, 1],\n\n[c]\n", 1, "\"{\" at column 5"),
        ] {
            let told = told(&format!("{text}{rest}"));
            let [(at, what, _)] = &told[..] else {
                panic!("{text}: {told:?}");
            };
            assert_eq!(*at, line, "{told:?}");
            assert!(what.starts_with(found), "{told:?}");
        }
        // What is wrong before it is told, too, and closed ones are no matter.
        assert_eq!(told("a = .2\nb = [1,\nc = 3\n").len(), 2);
        for closed in [rest, "a = [\n  1, # [\n  2,\n]\n", "a = { b = '[' }\n"] {
            assert_eq!(unclosed(closed), None, "{closed}");
        }
    }

    #[test]
    fn what_stands_twice_is_told_with_where_it_stands_first() {
        let told = told("a = 1\n[b]\nc = 1\nd = 1\n[e]\nc = 2\n c = 3\n[b] # again\nf = 1\n");
        let found: Vec<_> = told.iter().map(|t| (t.0, t.1.as_str())).collect();
        let expected = [
            (7, "duplicate key \"c\", first in line 6"),
            (8, "duplicate key \"b\", first in line 2"),
        ];
        assert_eq!(found, expected);
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
