//! A small JSON Schema checker: what `sandgate::scene::schema` uses, and nothing else. It refuses keywords it does
//! not know, so that a schema can never pass unchecked.
#![allow(
    clippy::unwrap_used,
    reason = "in a test a panic is the report, also in its helpers"
)]

use serde_json::Value;

/// Problems of `value` against `schema`, each with its path.
pub(crate) fn check(schema: &Value, value: &Value) -> Vec<String> {
    let mut problems = Vec::new();
    Checker { root: schema }.check(schema, value, "", &mut problems);
    problems
}

struct Checker<'s> {
    root: &'s Value,
}

impl Checker<'_> {
    fn check(&self, schema: &Value, value: &Value, path: &str, problems: &mut Vec<String>) {
        let object = schema
            .as_object()
            .unwrap_or_else(|| panic!("no schema: {schema}"));
        let mut report = |what: String| problems.push(format!("{path}: {what}"));
        let mut deeper: Vec<(&Value, &Value, String)> = Vec::new();
        for (keyword, rule) in object {
            match keyword.as_str() {
                "$schema" | "$defs" | "title" | "description" | "default" | "examples" => {}
                "x-quantity" | "x-range" | "x-words" => {}
                "x-units" => {
                    if let Some(text) = value.as_str() {
                        let unit = text.trim_start_matches(|c: char| {
                            c.is_ascii_digit() || "+-.eE ".contains(c)
                        });
                        let known = rule.as_array().unwrap().iter().any(|u| u == unit);
                        if !known && !unit.is_empty() {
                            report(format!("unit {unit:?} is none of {rule}"));
                        }
                    }
                }
                "$ref" => {
                    let pointer = rule.as_str().unwrap().trim_start_matches('#');
                    let target = self.root.pointer(pointer).expect("a definition");
                    deeper.push((target, value, path.to_owned()));
                }
                "type" => {
                    let types = rule
                        .as_array()
                        .cloned()
                        .unwrap_or_else(|| vec![rule.clone()]);
                    if !types.iter().any(|t| is_type(value, t.as_str().unwrap())) {
                        report(format!("{value} is no {rule}"));
                    }
                }
                "properties" => {
                    let properties = rule.as_object().unwrap();
                    for (key, rule) in properties {
                        if let Some(inner) = value.get(key) {
                            deeper.push((rule, inner, format!("{path}/{key}")));
                        }
                    }
                }
                "patternProperties" => {
                    let rule = rule.as_object().unwrap().values().next().unwrap();
                    for (key, inner) in value.as_object().into_iter().flatten() {
                        deeper.push((rule, inner, format!("{path}/{key}")));
                    }
                }
                "required" => {
                    for key in rule.as_array().unwrap() {
                        if value.is_object() && value.get(key.as_str().unwrap()).is_none() {
                            report(format!("{key} is missing"));
                        }
                    }
                }
                "additionalProperties" => {
                    assert_eq!(rule, &Value::Bool(false));
                    let named = object.get("properties").and_then(Value::as_object);
                    let open = object.contains_key("patternProperties");
                    for key in value.as_object().into_iter().flatten().map(|(k, _)| k) {
                        if !open && !named.is_some_and(|n| n.contains_key(key)) {
                            report(format!("unknown key {key}"));
                        }
                    }
                }
                "enum" => {
                    if !rule.as_array().unwrap().contains(value) {
                        report(format!("{value} is none of {rule}"));
                    }
                }
                "const" => {
                    if rule != value {
                        report(format!("{value} is not {rule}"));
                    }
                }
                "items" => {
                    for (i, inner) in value.as_array().into_iter().flatten().enumerate() {
                        deeper.push((rule, inner, format!("{path}/{i}")));
                    }
                }
                "oneOf" | "anyOf" => {
                    let fits = |rule: &&Value| check_fits(self, rule, value, path);
                    let count = rule.as_array().unwrap().iter().filter(fits).count();
                    if count == 0 || (count > 1 && keyword == "oneOf") {
                        report(format!("{count} of {keyword} fit {value}"));
                    }
                }
                "minimum" | "exclusiveMinimum" | "maximum" => {
                    let limit = rule.as_f64().unwrap();
                    let outside = |n: f64| match keyword.as_str() {
                        "minimum" => n < limit,
                        "maximum" => n > limit,
                        _ => n <= limit,
                    };
                    if value.as_f64().is_some_and(outside) {
                        report(format!("{value} breaks {keyword} {rule}"));
                    }
                }
                "minItems" | "maxItems" | "maxLength" => {
                    let size = value
                        .as_array()
                        .map(Vec::len)
                        .or(value.as_str().map(str::len));
                    let limit = usize::try_from(rule.as_u64().unwrap()).unwrap();
                    let outside = |n: usize| {
                        if keyword == "minItems" {
                            n < limit
                        } else {
                            n > limit
                        }
                    };
                    if size.is_some_and(outside) {
                        report(format!("{value} breaks {keyword} {rule}"));
                    }
                }
                // The only pattern is that of names.
                "pattern" => {
                    let name = value.as_str().unwrap_or_default();
                    let good = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
                    if !name.chars().all(good) {
                        report(format!("{value} does not match {rule}"));
                    }
                }
                other => panic!("this checker does not know {other}"),
            }
        }
        for (schema, value, path) in deeper {
            self.check(schema, value, &path, problems);
        }
    }
}

fn check_fits(checker: &Checker, schema: &Value, value: &Value, path: &str) -> bool {
    let mut problems = Vec::new();
    checker.check(schema, value, path, &mut problems);
    problems.is_empty()
}

fn is_type(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "boolean" => value.is_boolean(),
        other => panic!("this checker does not know the type {other}"),
    }
}
