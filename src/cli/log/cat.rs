//! `sandgate log cat FILE`: messages as lines, for people or as JSON.

use std::collections::HashMap;
use std::io::{BufWriter, Write as _};
use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Value, json};

use super::{Choice, warn_unless_complete};
use crate::cli::{CliError, cannot_print, printable};
use crate::record::{JsonReader, RawChannel, RawEntry, RawMessage, RawReader, below_base};
use crate::wire::keys::VERBS;

/// What may be typed after `sandgate log cat`.
#[derive(Debug, clap::Args)]
#[command(after_help = AFTER_HELP)]
pub(super) struct Args {
    /// A log file
    file: PathBuf,
    #[command(flatten)]
    choice: Choice,
    /// One JSON object a line, all fields
    #[arg(long)]
    json: bool,
}

const AFTER_HELP: &str = "\
Examples:
  sandgate log cat run.mcap --topic 'out/gauge/*' --from '1 s' --until '2 s'
  sandgate log cat run.mcap --topic out/applied                what was set, and when
  sandgate log cat run.mcap --topic '@rpc/**'                  who asked what, and the answers
  sandgate log cat run.mcap --topic out/stats --json | jq .value.kinetic_energy";

type Readers = HashMap<Arc<RawChannel>, Result<JsonReader, String>>;

/// Carries out `sandgate log cat`.
///
/// # Errors
/// [`CliError::Read`]. A cut is told on standard error and is no error.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let mut reader = RawReader::open(&args.file)?;
    let topics = args.choice.topics();
    let mut readers = Readers::new();
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut printed = 0_u64;
    for entry in reader.by_ref() {
        let RawEntry::Message(message) = entry? else {
            continue;
        };
        if !topics.has(&message.channel.topic) || !args.choice.window.has(message.log_time) {
            continue;
        }
        let value = value_of(&mut readers, &message);
        let line = if args.json {
            as_json(&message, value).to_string()
        } else {
            printable(&as_text(&message, &value)).into_owned()
        };
        writeln!(out, "{line}").map_err(cannot_print)?;
        printed += 1;
    }
    out.flush().map_err(cannot_print)?;
    if printed == 0 {
        tell!(
            "warning: {}: no message has such a topic and time; see both with `sandgate log info`, and note that * stands \
             for one level of a topic, ** for any number",
            args.file.display()
        );
    }
    if let Some(ending) = reader.ending() {
        warn_unless_complete(&args.file, ending);
    }
    Ok(())
}

fn value_of(readers: &mut Readers, message: &RawMessage) -> Value {
    if !readers.contains_key(&message.channel) {
        let reader = JsonReader::new(&message.channel.schema);
        readers.insert(message.channel.clone(), reader);
    }
    let unread = |why: &str| json!({"unread": why, "bytes": message.data.len()});
    match readers.get(&message.channel) {
        Some(Ok(reader)) => reader
            .read(&message.data)
            .unwrap_or_else(|why| unread(&why)),
        Some(Err(why)) => unread(why),
        None => Value::Null,
    }
}

fn as_json(message: &RawMessage, value: Value) -> Value {
    json!({
        "topic": message.channel.topic,
        "schema": message.channel.schema.name,
        "sequence": message.sequence,
        "log_time_ns": message.log_time,
        "publish_time_ns": message.publish_time,
        "value": value,
    })
}

fn as_text(message: &RawMessage, value: &Value) -> String {
    let topic = below_base(&message.channel.topic);
    let time = message.log_time as f64 / 1e9;
    let number = message.sequence;
    format!(
        "{time:>14.9} s  {topic}  #{number}  {}",
        words(message, value)
    )
}

/// The message in one line; long ones by what they hold.
fn words(message: &RawMessage, value: &Value) -> String {
    let text = |key: &str| value[key].as_str().unwrap_or_default().to_owned();
    match message.channel.schema.name.as_str() {
        "sandgate.Gauge" => {
            let flag = match value["validity"].as_str() {
                Some("VALID") | None => String::new(),
                Some(other) => format!("  ({})", other.to_lowercase()),
            };
            let values = match &value["values"] {
                Value::Array(list) if list.len() == 1 => list[0].to_string(),
                other => other.to_string(),
            };
            format!("{values} {}{flag}", text("unit"))
        }
        "sandgate.Applied" => {
            format!(
                "{} {} at t = {}, h = {}, by {:?}{}{}",
                text("event").to_lowercase(),
                value["step"],
                value["t"],
                value["h"],
                text("source"),
                inputs_of(value),
                moments_of(value)
            )
        }
        "sandgate.Command" => {
            let who = match (text("interface").as_str(), text("verb").as_str()) {
                ("in", variable) => format!("{variable} by {:?}", text("client")),
                // Of these alone the topic does not say what was asked.
                ("rpc", verb) if !VERBS.contains(&verb) => {
                    format!("{verb:?}: {:?} of {:?}", text("request"), text("client"))
                }
                _ => format!("{:?} of {:?}", text("request"), text("client")),
            };
            format!("{who} {} {}", text("status"), text("body"))
        }
        "foxglove.Log" => format!("{} {}: {}", text("level"), text("name"), text("message")),
        "foxglove.PointCloud" => {
            let count = value["points"].as_array().map_or(0, Vec::len);
            format!("{count} particles")
        }
        "foxglove.SceneUpdate" => {
            let list = value["entities"].as_array().into_iter().flatten();
            let names: Vec<_> = list.filter_map(|entity| entity["id"].as_str()).collect();
            names.join(", ")
        }
        _ => plain(value),
    }
}

/// What was set by a call, or at a moment of it.
fn inputs_of(value: &Value) -> String {
    let inputs = value["inputs"].as_array().into_iter().flatten();
    let inputs = inputs.map(|input| {
        let by = input["source"].as_str().unwrap_or_default();
        let name = input["name"].as_str().unwrap_or_default();
        let slope = match input["slope"].as_bool() {
            Some(true) => " changing per second by",
            _ => " =",
        };
        format!("  {name}{slope} {} by {by:?}", input["values"])
    });
    inputs.collect()
}

/// What was done inside a step, at which times.
fn moments_of(value: &Value) -> String {
    let time = |bits: &Value| f64::from_bits(bits.as_u64().unwrap_or_default());
    let moments = value["moments"].as_array().into_iter().flatten();
    let moments = moments.map(|moment| {
        let end = match moment["ends"].as_bool() {
            Some(true) => format!("  to end at t = {}", time(&moment["end_bits"])),
            _ => String::new(),
        };
        format!(
            "  inside it, at t = {}:{}{end}",
            time(&moment["t_bits"]),
            inputs_of(moment)
        )
    });
    moments.collect()
}

/// Fields and their values, without the time, which stands before them.
fn plain(value: &Value) -> String {
    let fields = value.as_object().into_iter().flatten();
    let fields = fields.filter(|(name, _)| !matches!(name.as_str(), "timestamp" | "time"));
    let parts: Vec<_> = fields
        .map(|(name, value)| match value {
            Value::Object(_) => format!("{name} {{{}}}", plain(value)),
            other => format!("{name} {other}"),
        })
        .collect();
    parts.join("  ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_set_says_whether_it_is_a_slope_and_when_inside_a_step() {
        let opening = |values: f64, slope: bool| json!({"name": "gate.a.opening", "values": [values], "slope": slope, "source": "fmi3"});
        let applied = json!({
            "inputs": [opening(0.05, false), opening(4.0, true)],
            "moments": [
                {"t_bits": 0.25_f64.to_bits(), "inputs": [opening(0.5, false)], "ends": false, "end_bits": 0},
                {"t_bits": 0.5_f64.to_bits(), "inputs": [], "ends": true, "end_bits": 0.75_f64.to_bits()},
            ],
        });
        assert_eq!(
            inputs_of(&applied),
            "  gate.a.opening = [0.05] by \"fmi3\"  gate.a.opening changing per second by [4.0] by \"fmi3\""
        );
        assert_eq!(
            moments_of(&applied),
            "  inside it, at t = 0.25:  gate.a.opening = [0.5] by \"fmi3\"  inside it, at t = 0.5:  to end at t = 0.75"
        );
    }
}
