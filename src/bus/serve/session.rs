//! The session: an explicit configuration, loopback unless told otherwise, scouting and admin space off.

use super::{ServeOptions, ZenohConfig, failed};
use crate::bus::endpoints::{self, DEFAULT_LISTEN};
use crate::bus::error::BusError;
use crate::bus::keys::Keys;
use serde_json::Value;
use std::time::Duration;
use zenoh::{Config, Session, Wait as _};

/// How often a free port is looked for, should somebody else take the one that was found.
const PORT_ATTEMPTS: usize = 8;

/// How long a publication waits for a subscriber that does not take it before that subscriber misses it [us], unless the
/// configuration says otherwise. Zenoh's own 1 ms loses bursts; who publishes cannot wait for long, because others wait with
/// him. Bursts are held by the sockets and by our queue.
const WAIT_BEFORE_DROP: (&str, i64) = (
    "transport/link/tx/queue/congestion_control/drop/wait_before_drop",
    50_000,
);

/// Opens a session by an explicit configuration: loopback unless told otherwise, scouting and admin space off.
pub(super) fn open(options: &ServeOptions) -> Result<(Session, Vec<String>), BusError> {
    let (mut config, wanted) = configure(options)?;
    let mut attempt = 1;
    loop {
        let listeners: Vec<String> = wanted
            .iter()
            .map(|endpoint| endpoints::with_real_port(endpoint))
            .collect::<Result<_, _>>()?;
        insert(&mut config, "listen/endpoints", &as_json(&listeners))?;
        match zenoh::open(config.clone()).wait() {
            Ok(session) => return Ok((session, listeners)),
            // Somebody took the free port in the meantime.
            Err(_) if listeners != wanted && attempt < PORT_ATTEMPTS => attempt += 1,
            Err(error) => {
                return Err(BusError::Zenoh {
                    doing: format!(
                        "listen on {} (port in use? choose another with --listen)",
                        listeners.join(", ")
                    ),
                    reason: error.to_string(),
                });
            }
        }
    }
}

/// The configuration but its listeners, and these, checked.
fn configure(options: &ServeOptions) -> Result<(Config, Vec<String>), BusError> {
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
    if listen.is_empty() {
        listen = vec![DEFAULT_LISTEN.to_owned()];
    }
    for endpoint in &listen {
        endpoints::check_listener(endpoint, options.allow_open_listener)?;
    }
    let mut connect = of_file("connect/endpoints");
    connect.extend(options.connect.iter().cloned());
    let (key, wait) = WAIT_BEFORE_DROP;
    if config.get_json(key).ok() == plain.get_json(key).ok() {
        insert(&mut config, key, &wait.to_string())?;
    }
    insert(&mut config, "connect/endpoints", &as_json(&connect))?;
    for (key, value) in [
        ("scouting/multicast/enabled", "false"),
        ("scouting/gossip/enabled", "false"),
        ("adminspace/enabled", "false"),
        ("listen/exit_on_failure", "true"),
    ] {
        insert(&mut config, key, value)?;
    }
    Ok((config, listen))
}

/// The configuration as it was given.
fn read(options: &ServeOptions) -> Result<Config, BusError> {
    let (read, from) = match &options.config {
        None => return Ok(Config::default()),
        Some(ZenohConfig::File(file)) => (Config::from_file(file), file.display().to_string()),
        Some(ZenohConfig::Text(text)) => (Config::from_json5(text), "(JSON5 text)".to_owned()),
    };
    read.map_err(|error| BusError::Config {
        file: from,
        reason: error.to_string(),
    })
}

/// As [`open`], for who has no command line: `metadata: {sandgate: {instance: "silo-7", allow_open_listener: true}}` of
/// the configuration counts as much as the options. Gives the instance's name, too.
pub(super) fn open_named(
    options: &ServeOptions,
) -> Result<(Session, Vec<String>, String), BusError> {
    let mut options = options.clone();
    let bad = |reason: String| BusError::Config {
        file: "metadata.sandgate".to_owned(),
        reason,
    };
    let metadata = read(&options)?.get_json("metadata").unwrap_or_default();
    let metadata: Value = serde_json::from_str(&metadata).unwrap_or_default();
    let own = metadata.get("sandgate").and_then(Value::as_object);
    for (key, value) in own.into_iter().flatten() {
        match (key.as_str(), value) {
            ("instance", Value::String(name)) => options.instance.clone_from(name),
            ("allow_open_listener", Value::Bool(open)) => options.allow_open_listener = *open,
            _ => {
                return Err(bad(format!(
                    "found {key}: {value}, allowed are instance, a text, and allow_open_listener, true or false"
                )));
            }
        }
    }
    let (session, listeners) = open(&options)?;
    Ok((session, listeners, options.instance))
}

fn as_json(endpoints: &[String]) -> String {
    serde_json::Value::from(endpoints).to_string()
}

fn insert(config: &mut Config, key: &str, value: &str) -> Result<(), BusError> {
    config
        .insert_json5(key, value)
        .map_err(|error| BusError::Zenoh {
            doing: format!("configure {key} as {value}"),
            reason: error.to_string(),
        })
}

/// Two instances of one name would both answer; only possible where there is somebody to connect to.
pub(super) fn refuse_twin(
    session: &Session,
    keys: &Keys,
    options: &ServeOptions,
) -> Result<(), BusError> {
    if options.connect.is_empty() && options.config.is_none() {
        return Ok(());
    }
    let twins = session
        .liveliness()
        .get(keys.alive())
        .timeout(Duration::from_millis(500))
        .wait()
        .map_err(failed("ask whether the name is taken"))?;
    if twins.iter().any(|reply| reply.result().is_ok()) {
        return Err(BusError::Taken {
            instance: options.instance.clone(),
        });
    }
    Ok(())
}
