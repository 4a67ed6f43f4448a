//! `sandgate log info FILE`: what is in a log.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::PathBuf;

use serde_json::{Value, json};

use crate::cli::{CliError, say};
use crate::record::{ChannelSurvey, Ending, Survey, below_base};

/// What may be typed after `sandgate log info`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Log files
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// One JSON object a file
    #[arg(long)]
    json: bool,
}

/// Carries out `sandgate log info`.
///
/// # Errors
/// [`CliError::Read`] for files that are no logs, after all others were shown. A log that was cut is none.
pub(super) fn run(args: &Args) -> Result<(), CliError> {
    let mut refused: Option<CliError> = None;
    for file in &args.files {
        let survey = match Survey::of(file) {
            Ok(survey) => survey,
            Err(error) => {
                // The last one is told by who gets it.
                if let Some(earlier) = refused.replace(error.into()) {
                    tell!("{earlier}");
                }
                continue;
            }
        };
        let shown = if args.json {
            as_json(&survey).to_string()
        } else {
            as_text(&survey)
        };
        say(&shown)?;
    }
    refused.map_or(Ok(()), Err)
}

fn as_text(survey: &Survey) -> String {
    let mut text = format!(
        "{}: {}, {}\n",
        survey.path.display(),
        size(survey.bytes),
        survey.ending
    );
    let mut line = |name: &str, what: String| {
        // Writing to a String does not fail.
        let _ = writeln!(text, "{name:<12} {what}");
    };
    let of = |record: &str| survey.metadata(record).cloned().unwrap_or_default();
    let (run, segment) = (of("run"), of("segment"));
    let get = |record: &BTreeMap<String, String>, key: &str| {
        record.get(key).cloned().unwrap_or_else(|| "?".to_owned())
    };
    if !run.is_empty() {
        line("run", run_line(&run));
        let hash = get(&run, "scene_hash");
        let title = match get(&run, "title") {
            blank if blank.trim().is_empty() => get(&run, "scene"),
            title => title,
        };
        line("scene", format!("{title} (sha256 {hash})"));
        let changed = of("end").remove("parameters");
        if let Some(changed) = changed.or_else(|| run.get("parameters").cloned()) {
            line("parameters", format!("not the scene's: {changed}"));
        }
    }
    if !segment.is_empty() {
        let (epoch, number) = (get(&segment, "epoch"), get(&segment, "number"));
        let reason = get(&segment, "reason");
        let time = get(&segment, "time");
        line(
            "segment",
            format!("file {number} of epoch {epoch}, begins with \"{reason}\" at t = {time} s"),
        );
    }
    if let Some((first, last)) = survey.times() {
        let (first, last) = (first as f64 / 1e9, last as f64 / 1e9);
        line("time", format!("{first} to {last} s simulated"));
    }
    if let Some((first, last)) = survey.published()
        && run.get("deterministic").is_none_or(|d| d != "true")
    {
        let (from, took) = (utc(first / 1_000_000_000), (last - first) as f64 / 1e9);
        line("wall clock", format!("{from}, for {took:.3} s"));
    }
    line("ended", ended(survey));
    let attachments = survey.attachments.iter();
    let attachments = attachments.map(|(name, _, bytes)| format!("{name} ({})", size(*bytes)));
    line("attachments", attachments.collect::<Vec<_>>().join(", "));
    line(
        "messages",
        format!(
            "{} on {} channels",
            survey.messages(),
            survey.channels.len()
        ),
    );
    text.push_str(&channels(survey));
    text.pop();
    text
}

fn run_line(run: &BTreeMap<String, String>) -> String {
    let get = |key: &str| run.get(key).map_or("?", String::as_str);
    let deterministic = match get("deterministic") {
        "true" => ", deterministic",
        _ => "",
    };
    format!(
        "{} as {}, sandgate {}, seed {}, {}, the scene's communication step {} s{deterministic}",
        get("scene"),
        get("instance"),
        get("version"),
        get("seed"),
        get("precision"),
        get("communication_step"),
    )
}

fn ended(survey: &Survey) -> String {
    if let Some(end) = survey.metadata("end") {
        let get = |key: &str| end.get(key).map_or("?", String::as_str);
        return format!(
            "\"{}\" at t = {} s after {} communication steps{}, {} messages dropped{}",
            get("reason"),
            get("time"),
            get("communication_steps"),
            match get("restored") {
                "0" | "?" => String::new(),
                times => format!(" ({times} times back to a saved state)"),
            },
            get("dropped"),
            match end.get("state_hash") {
                Some(hash) => format!(", state hash {hash}"),
                None => String::new(),
            }
        );
    }
    match (survey.metadata("recovered"), &survey.ending) {
        (Some(note), _) => format!(
            "unknown: recovered from {}, which was {}",
            note.get("from").map_or("?", String::as_str),
            note.get("ending").map_or("?", String::as_str)
        ),
        (None, Ending::Cut { .. }) => {
            "unknown: the file is cut short; `sandgate log recover` makes a valid one of it"
                .to_owned()
        }
        (None, Ending::Complete | Ending::Followed { .. }) => {
            "unknown: the file does not say".to_owned()
        }
    }
}

fn channels(survey: &Survey) -> String {
    let used = survey.channels.iter().filter(|(_, c)| c.messages > 0);
    let width = used.clone().map(|(topic, _)| below_base(topic).len()).max();
    let width = width.unwrap_or(0).max(5);
    let mut text = format!(
        "  {:<width$}  {:>9}  {:>9}  {:>8}  message\n",
        "topic", "messages", "bytes", "missing"
    );
    for (topic, channel) in used {
        let ChannelSurvey {
            schema,
            messages,
            bytes,
            missing,
            ..
        } = channel;
        // Writing to a String does not fail.
        let _ = writeln!(
            text,
            "  {:<width$}  {messages:>9}  {bytes:>9}  {missing:>8}  {schema}",
            below_base(topic)
        );
    }
    text
}

fn as_json(survey: &Survey) -> Value {
    let channels = survey.channels.iter().map(|(topic, c)| {
        json!({
            "topic": topic, "schema": c.schema, "messages": c.messages, "bytes": c.bytes,
            "missing": c.missing, "first_ns": c.times.map(|t| t.0), "last_ns": c.times.map(|t| t.1),
        })
    });
    let attachments = survey.attachments.iter().map(
        |(name, media_type, bytes)| json!({"name": name, "media_type": media_type, "bytes": bytes}),
    );
    let metadata = survey
        .metadata
        .iter()
        .map(|(name, values)| (name.clone(), json!(values)));
    let (times, published) = (survey.times(), survey.published());
    json!({
        "file": survey.path.display().to_string(),
        "bytes": survey.bytes,
        "complete": survey.ending == Ending::Complete,
        "ending": survey.ending.to_string(),
        "metadata": metadata.collect::<serde_json::Map<_, _>>(),
        "first_ns": times.map(|t| t.0), "last_ns": times.map(|t| t.1),
        "wall_first_ns": published.map(|t| t.0), "wall_last_ns": published.map(|t| t.1),
        "messages": survey.messages(),
        "attachments": attachments.collect::<Vec<_>>(),
        "channels": channels.collect::<Vec<_>>(),
    })
}

fn size(bytes: u64) -> String {
    match bytes {
        0..10_000 => format!("{bytes} bytes"),
        10_000..10_000_000 => format!("{:.1} kB", bytes as f64 * 1e-3),
        _ => format!("{:.1} MB", bytes as f64 * 1e-6),
    }
}

/// Seconds since 1970 as date and time.
fn utc(seconds: u64) -> String {
    let (days, rest) = (seconds / 86_400, seconds % 86_400);
    // Days from 1 March 0000, in eras of 400 years (H. Hinnant, "chrono-compatible low-level date algorithms").
    let z = days + 719_468;
    let (era, day_of_era) = (z / 146_097, z % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1_460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * shifted + 2) / 5 + 1;
    let month = if shifted < 10 {
        shifted + 3
    } else {
        shifted - 9
    };
    let year = year_of_era + era * 400 + u64::from(month <= 2);
    let (hour, minute, second) = (rest / 3600, rest / 60 % 60, rest % 60);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

#[cfg(test)]
mod tests {
    use super::utc;

    #[test]
    fn seconds_become_dates() {
        assert_eq!(utc(0), "1970-01-01 00:00:00 UTC");
        assert_eq!(utc(951_782_399), "2000-02-28 23:59:59 UTC");
        assert_eq!(utc(951_782_400), "2000-02-29 00:00:00 UTC");
        assert_eq!(utc(1_767_225_599), "2025-12-31 23:59:59 UTC");
    }
}
