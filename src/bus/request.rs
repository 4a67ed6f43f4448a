//! Requests as typed: verb and JSON body → [`Request`], or a [`Refusal`] that says what was found, what is allowed
//! and what to do. Pure, quick (it runs in network callbacks), and knows no component: names of variables and ranges
//! are checked in `protocol`.

use super::fields::{self, Given, bad};
use super::json;
use super::refusal::{Code, Refusal};
use super::verb::Verb;
use crate::wire::foxglove::LogLevel;
use serde_json::Value;

/// A request, checked as far as it can be without the component.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// What is asked.
    pub verb: Verb,
    /// Identifier of this request, chosen by the client; empty only for verbs that change nothing.
    pub req: String,
    /// Who asks; may be empty.
    pub client: String,
    /// Time at which the client believes the component to be (ns).
    pub t_ns: Option<i64>,
    /// Length of the step (ns).
    pub dt_ns: Option<u64>,
    /// Inputs: name and what it is given.
    pub inputs: Vec<(String, Given)>,
    /// Names of variables to answer with.
    pub outputs: Option<Vec<String>>,
    /// Count of steps at which the client believes the component to be.
    pub expect_step: Option<u64>,
    /// Simulated over wall time of `run`; none means as fast as possible.
    pub realtime_factor: Option<f64>,
    /// State of `restore`.
    pub state: Vec<u8>,
    /// Line of `log`, and how grave it is.
    pub line: Option<(LogLevel, String)>,
    /// SHA-256 of the body, whatever its white space and order of keys.
    pub fingerprint: [u8; 32],
}

impl Request {
    /// Reads a body. Nothing (no bytes) is the same as `{}`.
    ///
    /// # Errors
    /// [`Code::BadRequest`], [`Code::Type`], [`Code::Range`], [`Code::TooLarge`].
    pub fn parse(verb: Verb, body: &[u8]) -> Result<Self, Refusal> {
        if body.len() > verb.max_body() {
            return Err(Refusal::new(
                Code::TooLarge,
                format!(
                    "{}: found a body of {} bytes, allowed {}",
                    verb.name(),
                    body.len(),
                    verb.max_body()
                ),
            ));
        }
        let body: &[u8] = if body.is_empty() { b"{}" } else { body };
        let value = json::parse(body).map_err(|error| {
            let text = String::from_utf8_lossy(body);
            let names_no_number = ["NaN", "Infinity"].iter().any(|word| text.contains(word));
            let also = if names_no_number {
                " (NaN and Infinity are not JSON either)"
            } else {
                ""
            };
            bad(format!("body is not JSON as it must be: {error}{also}"))
        })?;
        let fingerprint = json::fingerprint(&value);
        let Value::Object(mut map) = value else {
            return Err(bad(format!(
                "body: found {}, allowed an object such as {{\"req\":\"1\"}}",
                fields::kind(&value)
            )));
        };
        fields::check(verb, &map)?;
        let request = Self {
            verb,
            req: fields::text(&mut map, "req")?.unwrap_or_default(),
            client: fields::text(&mut map, "client")?.unwrap_or_default(),
            t_ns: fields::time(&mut map)?,
            dt_ns: fields::whole(&mut map, "dt_ns", 1, MAX_DT_NS)?,
            inputs: fields::inputs(&mut map)?,
            outputs: fields::outputs(&mut map)?,
            expect_step: fields::whole(&mut map, "expect_step", 0, u64::MAX)?,
            realtime_factor: fields::factor(&mut map)?,
            state: fields::state(&mut map)?,
            line: fields::line(&mut map)?,
            fingerprint,
        };
        if verb.changes() && request.req.is_empty() {
            return Err(bad(format!(
                "{}: missing \"req\", an identifier of your choice; send the same again to repeat a request safely",
                verb.name()
            )));
        }
        let missing = match verb {
            Verb::Set if request.inputs.is_empty() => "inputs",
            Verb::Restore if request.state.is_empty() => "state",
            Verb::Log if request.line.is_none() => "message",
            _ => return Ok(request),
        };
        Err(bad(format!(
            "{}: missing or empty {missing:?}",
            verb.name()
        )))
    }

    /// `req` of a body that could not be read as a request, so that its refusal can name it.
    #[must_use]
    pub fn req_of(body: &[u8]) -> String {
        fields::text_in(body, "req")
    }
}

/// Longest body that is looked into or kept after it was refused (bytes).
pub(super) const LONGEST_TOLD: usize = 1 << 20;

/// Longest step (ns): one hour. Longer is several steps.
const MAX_DT_NS: u64 = 3_600_000_000_000;

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(verb: Verb, body: &str) -> Refusal {
        Request::parse(verb, body.as_bytes()).unwrap_err()
    }

    /// Requests that are refused, by what code, and a part of what is said.
    #[rustfmt::skip]
    const REFUSED: [(Verb, &str, Code, &str); 19] = [
        (Verb::Step, r#"{"req":"1","dt_ns":NaN}"#, Code::BadRequest, "NaN and Infinity"),
        (Verb::Step, r#"[1]"#, Code::BadRequest, "an array of 1"),
        (Verb::Step, r#"{"req":"1","dt":1}"#, Code::BadRequest, "unknown field \"dt\"; it takes req, client, t_ns, dt_ns"),
        (Verb::Get, r#"{"inputs":{}}"#, Code::BadRequest, "get: unknown field"),
        (Verb::Step, r#"{"req":7}"#, Code::Type, "req: found 7, allowed a string"),
        (Verb::Step, r#"{"req":""}"#, Code::Type, "1 to 64"),
        (Verb::Step, r#"{"req":"1","dt_ns":0}"#, Code::Range, "dt_ns: found 0, allowed 1 to"),
        (Verb::Step, r#"{"req":"1","dt_ns":-5}"#, Code::Range, "dt_ns: found -5"),
        (Verb::Step, r#"{"req":"1","dt_ns":0.01}"#, Code::Type, "a whole number"),
        (Verb::Step, r#"{"req":"1","dt_ns":1e30}"#, Code::Range, "dt_ns: found 1e+30, allowed 1 to"),
        (Verb::Step, r#"{"req":"1","t_ns":"now"}"#, Code::Type, "nanoseconds"),
        (Verb::Step, r#"{"req":"1","req":"2"}"#, Code::BadRequest, "stands there twice"),
        (Verb::Set, r#"{"req":"1"}"#, Code::BadRequest, "missing or empty \"inputs\""),
        (Verb::Set, r#"{"req":"1","inputs":{"a":"NaN"}}"#, Code::Type, "a: found \"NaN\""),
        (Verb::Set, r#"{"req":"1","inputs":[1]}"#, Code::Type, "inputs: found an array"),
        (Verb::Get, r#"{"outputs":"a"}"#, Code::Type, "names of variables"),
        (Verb::Run, r#"{"req":"1","realtime_factor":0}"#, Code::Range, "more than 0"),
        (Verb::Restore, r#"{"req":"1","state":"?"}"#, Code::BadRequest, "save gave"),
        (Verb::Restore, r#"{"req":"1"}"#, Code::BadRequest, "missing or empty \"state\""),
    ];

    #[test]
    fn a_step_is_read_whole() {
        let body = r#"{"req":"c7e1","client":"orch-1","t_ns":1200000000,"dt_ns":10000000,
            "inputs":{"gate.main.opening":0.35,"flag":true,"row":[1,2]},
            "outputs":["gauge.weir.depth"],"expect_step":120}"#;
        let request = Request::parse(Verb::Step, body.as_bytes()).unwrap();
        assert_eq!(
            (request.req.as_str(), request.client.as_str()),
            ("c7e1", "orch-1")
        );
        assert_eq!(request.t_ns, Some(1_200_000_000));
        assert_eq!(request.dt_ns, Some(10_000_000));
        assert_eq!(request.expect_step, Some(120));
        assert_eq!(
            request.outputs.as_deref(),
            Some(&["gauge.weir.depth".to_owned()][..])
        );
        let given = |name: &str, flat: &[f64], has_flags| {
            let flat = flat.to_vec();
            (name.to_owned(), Given { flat, has_flags })
        };
        assert_eq!(
            request.inputs,
            [
                given("gate.main.opening", &[0.35], false),
                given("flag", &[1.0], true),
                given("row", &[1.0, 2.0], false)
            ]
        );
    }

    #[test]
    fn whole_numbers_may_have_a_point_or_an_exponent() {
        let parse = |dt: &str| {
            let body = format!(r#"{{"req":"1","t_ns":0.0,"dt_ns":{dt}}}"#);
            Request::parse(Verb::Step, body.as_bytes()).map(|r| (r.t_ns, r.dt_ns))
        };
        for dt in ["10000000", "10000000.0", "1e7", "1.0E+7"] {
            assert_eq!(parse(dt).unwrap(), (Some(0), Some(10_000_000)), "{dt}");
        }
        for dt in ["10000000.5", "1e300", "-1e7"] {
            assert!(parse(dt).is_err(), "{dt}");
        }
    }

    #[test]
    fn reading_needs_no_body_and_changing_needs_an_identifier() {
        assert!(Request::parse(Verb::Status, b"").is_ok());
        let refusal = refused(Verb::Step, "");
        assert!(refusal.message.contains("missing \"req\""), "{refusal}");
    }

    #[test]
    fn fields_are_refused_by_code_and_with_what_is_allowed() {
        for (verb, body, code, part) in REFUSED {
            let refusal = refused(verb, body);
            assert_eq!(refusal.code, code, "{body}: {refusal}");
            assert!(refusal.message.contains(part), "{body}: {refusal}");
        }
        let long = vec![b' '; (1 << 20) + 1];
        assert_eq!(
            Request::parse(Verb::Step, &long).unwrap_err().code,
            Code::TooLarge
        );
    }

    #[test]
    fn a_state_goes_to_text_and_back() {
        let bytes: Vec<u8> = (0..=255).collect();
        let body = format!(r#"{{"req":"1","state":"{}"}}"#, fields::base64_text(&bytes));
        assert_eq!(
            Request::parse(Verb::Restore, body.as_bytes())
                .unwrap()
                .state,
            bytes
        );
    }
}
