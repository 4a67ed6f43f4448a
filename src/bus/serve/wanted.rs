//! What is wanted of a session: Zenoh's configuration with scouting, gossip and the admin space off, and in which role, where
//! it listens and whom it joins. Opens nothing.

use super::{ServeOptions, ZenohConfig, named_files};
use crate::bus::advice::Advice;
use crate::bus::endpoints;
use crate::bus::error::{BusError, words};
use serde_json::Value;
use std::path::Path;
use zenoh::Config;

/// How long a publication waits for a subscriber that does not take it before that subscriber misses it [us], unless the
/// configuration says otherwise. Zenoh's own 1 ms loses bursts; who publishes cannot wait for long, because others wait with
/// him. Bursts are held by the sockets and by our queue.
const WAIT_BEFORE_DROP: (&str, i64) = (
    "transport/link/tx/queue/congestion_control/drop/wait_before_drop",
    50_000,
);

/// Largest configuration file [bytes]: as large as a scene's.
const LARGEST_FILE: u64 = 4 << 20;

/// What is wanted of a session. The configuration is whole but for mode, listeners and whom it joins.
#[derive(Clone)]
pub(super) struct Wanted {
    pub(super) config: Config,
    /// `client`, `peer` or `router`, where the configuration says it.
    pub(super) mode: Option<String>,
    pub(super) listen: Vec<String>,
    pub(super) connect: Vec<String>,
    pub(super) advice: Advice,
}

/// The configuration and what it says of roles and places, checked.
pub(super) fn configure(options: &ServeOptions) -> Result<Wanted, BusError> {
    let plain = Config::default();
    let mut config = read(options)?;
    let of_file = |key: &str| match (config.get_json(key), plain.get_json(key)) {
        (Ok(own), Ok(default)) if own != default => {
            serde_json::from_str(&own).map_or_else(|_| Vec::new(), |v| endpoints::listed(&v))
        }
        _ => Vec::new(),
    };
    let mut listen = options.listen.clone();
    if listen.is_empty() {
        listen = of_file("listen/endpoints");
    }
    for endpoint in &listen {
        endpoints::check_listener(endpoint, options.allow_open_listener, options.advice)?;
    }
    let mut connect = of_file("connect/endpoints");
    connect.extend(options.connect.iter().cloned());
    for endpoint in &connect {
        endpoints::check_form(endpoint)?;
    }
    named_files::check(&config, &listen)?;
    let mode = config.get_json("mode").ok();
    let mode: Option<String> = mode
        .and_then(|mode| serde_json::from_str(&mode).ok())
        .flatten();
    if mode.as_deref() == Some("client") {
        check_client(options, &listen, &connect)?;
    }
    let (key, wait) = WAIT_BEFORE_DROP;
    if config.get_json(key).ok() == plain.get_json(key).ok() {
        insert(&mut config, key, &wait.to_string())?;
    }
    for (key, value) in [
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("adminspace/enabled", "false"),
        ("listen/exit_on_failure", "true"),
    ] {
        insert(&mut config, key, value)?;
    }
    Ok(Wanted {
        config,
        mode,
        listen,
        connect,
        advice: options.advice,
    })
}

/// A client connects and does nothing else.
fn check_client(
    options: &ServeOptions,
    listen: &[String],
    connect: &[String],
) -> Result<(), BusError> {
    let reason = if let Some(listener) = listen.first() {
        format!(
            "mode is client, which listens nowhere, and {listener} is to be listened on; leave out one of the two, or say \
             mode router"
        )
    } else if connect.is_empty() {
        format!(
            "mode is client, and there is nobody to connect to; name a router or peer {}",
            options.advice.connect()
        )
    } else {
        return Ok(());
    };
    let file = source(options);
    Err(BusError::Config { file, reason })
}

/// The configuration as it was given.
fn read(options: &ServeOptions) -> Result<Config, BusError> {
    let read = match &options.config {
        None => return Ok(Config::default()),
        Some(ZenohConfig::File(file)) => {
            check_size(file).map_err(|reason| BusError::Config {
                file: source(options),
                reason,
            })?;
            Config::from_file(file)
        }
        Some(ZenohConfig::Text(text)) => Config::from_json5(text),
    };
    read.map_err(|error| BusError::Config {
        file: source(options),
        reason: match &options.config {
            Some(ZenohConfig::Text(text)) if may_hold_secrets(text) => hidden(&words(error)),
            _ => words(error),
        },
    })
}

/// Whether a text has keys with passwords or private keys beside them.
fn may_hold_secrets(text: &str) -> bool {
    ["password", "usrpwd", "private_key", "base64"]
        .iter()
        .any(|key| text.contains(key))
}

/// What may be told of what Zenoh says of a text with secrets, which it quotes: where it stopped.
fn hidden(words: &str) -> String {
    let is_apart = |c: char| !(c.is_ascii_digit() || c == ':');
    let place = words.split(is_apart).find_map(|part| {
        let (line, column) = part.split_once(':')?;
        let (line, column): (u32, u32) = (line.parse().ok()?, column.parse().ok()?);
        Some(format!(", near line {line}, column {column}"))
    });
    format!(
        "it is not one that Zenoh takes{}; Zenoh's words are left out, since they quote the text, which may hold a password: \
         `sandgate serve CASE --zenoh-config FILE` with the text in a file shows them",
        place.unwrap_or_default()
    )
}

/// Zenoh reads a file to its end, which devices and pipes need not have.
fn check_size(file: &Path) -> Result<(), String> {
    let remedy = "give a file with Zenoh's configuration";
    match std::fs::metadata(file) {
        Ok(found) if !found.is_file() => Err(format!(
            "found a folder, device or pipe, allowed a file of at most {LARGEST_FILE} bytes; {remedy}"
        )),
        Ok(found) if found.len() > LARGEST_FILE => Err(format!(
            "found {} bytes, allowed {LARGEST_FILE}; {remedy}",
            found.len()
        )),
        // What cannot be looked at cannot be read either, and Zenoh says why.
        _ => Ok(()),
    }
}

/// Where the configuration comes from.
fn source(options: &ServeOptions) -> String {
    match &options.config {
        Some(ZenohConfig::File(file)) => file.display().to_string(),
        Some(ZenohConfig::Text(_)) => "(JSON5 text)".to_owned(),
        None => "(none)".to_owned(),
    }
}

/// The options with what stands in the configuration: `metadata: {sandgate: {instance: "silo-7", allow_open_listener:
/// true}}`.
pub(super) fn named(options: &ServeOptions) -> Result<ServeOptions, BusError> {
    let mut options = options.clone();
    let bad = |reason: String| BusError::Config {
        file: "metadata.sandgate".to_owned(),
        reason,
    };
    let metadata = read(&options)?.get_json("metadata").unwrap_or_default();
    let metadata: Value = serde_json::from_str(&metadata).unwrap_or_default();
    let own = match metadata.get("sandgate") {
        None | Some(Value::Null) => None,
        Some(Value::Object(own)) => Some(own),
        Some(other) => {
            return Err(bad(format!(
                "found {other}, allowed an object such as {{instance: \"silo-7\", allow_open_listener: true}}"
            )));
        }
    };
    for (key, value) in own.into_iter().flatten() {
        match (key.as_str(), value) {
            ("instance", Value::String(name)) => options.instance.clone_from(name),
            ("allow_open_listener", Value::Bool(open)) => options.allow_open_listener |= *open,
            _ => {
                return Err(bad(format!(
                    "found {key}: {value}, allowed are instance, a text, and allow_open_listener, true or false"
                )));
            }
        }
    }
    Ok(options)
}

pub(super) fn as_json(endpoints: &[String]) -> String {
    serde_json::Value::from(endpoints).to_string()
}

pub(super) fn insert(config: &mut Config, key: &str, value: &str) -> Result<(), BusError> {
    config
        .insert_json5(key, value)
        .map_err(|error| BusError::Zenoh {
            doing: format!("configure {key} as {value}"),
            reason: words(error),
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_wrong_with_a_text_is_told_without_the_secrets_in_it() {
        let told = |text: &str| {
            let options = ServeOptions {
                config: ZenohConfig::read(text),
                ..ServeOptions::default()
            };
            read(&options).map(|_| ()).unwrap_err().to_string()
        };
        for text in [
            r#"{transport: {auth: {usrpwd: {user: "plc", password: "geheim}}}}"#,
            r#"{transport: {auth: {usrpwd: "plc:geheim"}}}"#,
            "// ours\n{transport: {auth: {usrpwd: {user: 'plc', password: geheim}}}}",
        ] {
            let told = told(text);
            assert!(
                !told.contains("geheim") && told.contains("left out"),
                "{told}"
            );
        }
        let open = told("{listen: 7}");
        assert!(open.contains('7') && !open.contains("left out"), "{open}");
    }
}
