//! The session: an explicit configuration, loopback unless told otherwise, scouting and admin space off.

use super::{ServeOptions, failed};
use crate::bus::endpoints::{self, DEFAULT_LISTEN};
use crate::bus::error::BusError;
use crate::bus::keys::Keys;
use std::time::Duration;
use zenoh::{Config, Session, Wait as _};

/// How often a free port is looked for, should somebody else take the one that was found.
const PORT_ATTEMPTS: usize = 8;

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
    let mut config = match &options.config_file {
        None => plain.clone(),
        Some(file) => Config::from_file(file).map_err(|error| BusError::Config {
            file: file.display().to_string(),
            reason: error.to_string(),
        })?,
    };
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
    if options.connect.is_empty() && options.config_file.is_none() {
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
