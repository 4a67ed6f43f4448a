//! Which endpoints a server may listen on: loopback unless somebody says in so many words that it shall be open.
//! Pure text; does not know Zenoh.

use super::advice::Advice;
use serde_json::Value;
use std::net::{IpAddr, SocketAddr, TcpListener};

/// Where a server listens unless it is told otherwise: this machine only, a free port.
pub const DEFAULT_LISTEN: &str = "tcp/127.0.0.1:0";

/// Transports of this build.
const PROTOCOLS: &[&str] = if cfg!(feature = "tls") {
    &["tcp", "tls"]
} else {
    &["tcp"]
};

/// An endpoint that will not be listened on.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadEndpoint {
    /// Not of the form that this build can open.
    #[error("endpoint {found:?}: allowed is {}/HOST:PORT, PORT from 0 to 65535 (this build has no other transport){}", PROTOCOLS.join("/HOST:PORT or "), missing(found))]
    Form {
        /// The endpoint.
        found: String,
    },
    /// Reachable from other machines.
    #[error(
        "endpoint {found:?} can be reached from other machines, and everybody who reaches it can move gates and read \
         states; listen on tcp/127.0.0.1:PORT, or {} if the network is your own",
        advice.open_listener()
    )]
    Open {
        /// The endpoint.
        found: String,
        /// Who reads it.
        advice: Advice,
    },
    /// Cannot be bound.
    #[error("cannot listen on {found}: {reason}")]
    Taken {
        /// The endpoint.
        found: String,
        /// The system's words.
        reason: String,
    },
    /// No free port.
    #[error("no free port on {host}: {reason}")]
    NoPort {
        /// The host.
        host: String,
        /// The system's words.
        reason: String,
    },
}

/// What would bring the transport that an endpoint asks for.
fn missing(endpoint: &str) -> &'static str {
    if endpoint.starts_with("tls/") && !PROTOCOLS.contains(&"tls") {
        "; tls comes with a program built by cargo build --release --features tls"
    } else {
        ""
    }
}

/// Checks whom to join. Zenoh looks for ever for what has no port.
///
/// # Errors
/// [`BadEndpoint::Form`].
pub(super) fn check_form(endpoint: &str) -> Result<(), BadEndpoint> {
    split(endpoint).map(|_| ())
}

/// Checks a listener.
///
/// # Errors
/// [`BadEndpoint::Form`]; [`BadEndpoint::Open`] for hosts other than loopback unless `open` is allowed.
pub(super) fn check_listener(
    endpoint: &str,
    open: bool,
    advice: Advice,
) -> Result<(), BadEndpoint> {
    let (_, host, _) = split(endpoint)?;
    if open || is_loopback(host) {
        Ok(())
    } else {
        Err(BadEndpoint::Open {
            found: endpoint.to_owned(),
            advice,
        })
    }
}

/// The endpoint with its port 0 replaced by one that is free now. (Zenoh tells the port it chose only through an
/// interface it calls unstable.) Somebody else may take the port in between: opening then fails and is tried again.
///
/// # Errors
/// [`BadEndpoint::Form`], [`BadEndpoint::NoPort`].
pub(super) fn with_real_port(endpoint: &str) -> Result<String, BadEndpoint> {
    let (protocol, host, port) = split(endpoint)?;
    if port != 0 {
        return Ok(endpoint.to_owned());
    }
    let plain_host = host.trim_start_matches('[').trim_end_matches(']');
    let free = TcpListener::bind((plain_host, 0))
        .and_then(|listener| listener.local_addr())
        .map_err(|error| BadEndpoint::NoPort {
            host: host.to_owned(),
            reason: error.to_string(),
        })?;
    let tail = endpoint.find(['?', '#']).map_or("", |at| &endpoint[at..]);
    Ok(format!(
        "{protocol}/{host}:{}{tail}",
        SocketAddr::port(&free)
    ))
}

/// Whether a listener's port can be had now.
///
/// # Errors
/// [`BadEndpoint::Form`], [`BadEndpoint::Taken`].
pub(super) fn check_port(endpoint: &str) -> Result<(), BadEndpoint> {
    let (_, host, port) = split(endpoint)?;
    let plain_host = host.trim_start_matches('[').trim_end_matches(']');
    let bound = TcpListener::bind((plain_host, port));
    bound.map(drop).map_err(|error| BadEndpoint::Taken {
        found: endpoint.to_owned(),
        reason: error.to_string(),
    })
}

/// Every endpoint in a value of Zenoh's configuration: a list, or lists by mode.
#[must_use]
pub(super) fn listed(value: &Value) -> Vec<String> {
    match value {
        Value::String(endpoint) => vec![endpoint.clone()],
        Value::Array(items) => items.iter().flat_map(listed).collect(),
        Value::Object(map) => map.values().flat_map(listed).collect(),
        _ => Vec::new(),
    }
}

/// Protocol, host and port of `tcp/HOST:PORT`, without what follows ? or #.
fn split(endpoint: &str) -> Result<(&str, &str, u16), BadEndpoint> {
    let address = endpoint
        .split_once('/')
        .filter(|(protocol, _)| PROTOCOLS.contains(protocol))
        .map(|(protocol, rest)| {
            let end = rest.find(['?', '#']).unwrap_or(rest.len());
            (protocol, &rest[..end])
        });
    address
        .and_then(|(protocol, address)| Some((protocol, address.rsplit_once(':')?)))
        .filter(|(_, (host, _))| !host.is_empty())
        .and_then(|(protocol, (host, port))| Some((protocol, host, port.parse().ok()?)))
        .ok_or_else(|| BadEndpoint::Form {
            found: endpoint.to_owned(),
        })
}

fn is_loopback(host: &str) -> bool {
    let plain = host.trim_start_matches('[').trim_end_matches(']');
    plain == "localhost" || plain.parse().is_ok_and(|ip: IpAddr| ip.is_loopback())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn only_loopback_is_listened_on_unless_somebody_says_so() {
        for own in [
            DEFAULT_LISTEN,
            "tcp/127.9.8.7:7447",
            "tcp/[::1]:0",
            "tcp/localhost:1",
        ] {
            assert_eq!(
                check_listener(own, false, Advice::CommandLine),
                Ok(()),
                "{own}"
            );
        }
        for open in [
            "tcp/0.0.0.0:7447",
            "tcp/[::]:0",
            "tcp/192.168.1.5:7447#iface=lo",
            "tcp/example.org:1",
            "tcp/127.0.0.1.example.org:1",
        ] {
            for (advice, words) in [
                (Advice::CommandLine, "say --allow-open-listener"),
                (
                    Advice::Configuration,
                    "{sandgate: {allow_open_listener: true}}",
                ),
            ] {
                let refusal = check_listener(open, false, advice).unwrap_err().to_string();
                assert!(refusal.contains(words), "{refusal}");
                assert_eq!(check_listener(open, true, advice), Ok(()), "{open}");
            }
        }
    }

    #[test]
    fn other_forms_are_refused_with_the_one_that_is_allowed() {
        for bad in [
            "",
            "127.0.0.1:0",
            "udp/127.0.0.1:0",
            "tcp/127.0.0.1",
            "tcp/:1",
            "tcp/h:70000",
        ] {
            for refused in [
                check_listener(bad, true, Advice::CommandLine),
                check_form(bad),
            ] {
                let refusal = refused.unwrap_err().to_string();
                assert!(refusal.contains("allowed is tcp/HOST:PORT"), "{refusal}");
            }
        }
    }

    #[test]
    #[cfg(not(feature = "tls"))]
    fn a_build_without_tls_says_how_to_get_it() {
        let refusal = check_form("tls/example.org:7447").unwrap_err().to_string();
        assert!(refusal.ends_with("--features tls"), "{refusal}");
        assert_eq!(check_form("tcp/example.org:7447"), Ok(()));
    }

    #[test]
    fn port_zero_becomes_a_port_that_can_be_bound() {
        let real = with_real_port("tcp/127.0.0.1:0#so_sndbuf=65000").unwrap();
        let (_, host, port) = split(&real).unwrap();
        assert!(real.ends_with("#so_sndbuf=65000") && port != 0, "{real}");
        let listener = TcpListener::bind((host, port)).unwrap();
        let taken = check_port(&real).unwrap_err().to_string();
        assert!(taken.starts_with(&format!("cannot listen on {real}: ")));
        drop(listener);
        assert_eq!(check_port(&real), Ok(()));
        assert_eq!(
            with_real_port("tcp/127.0.0.1:9").unwrap(),
            "tcp/127.0.0.1:9"
        );
    }

    #[test]
    fn endpoints_are_found_in_every_form_of_a_configuration() {
        let by_mode =
            json!({"router": ["tcp/a:1"], "peer": ["tcp/b:2", {"locators": ["tcp/c:3"]}]});
        assert_eq!(listed(&by_mode), ["tcp/a:1", "tcp/b:2", "tcp/c:3"]);
        assert_eq!(listed(&json!(["tcp/a:1"])), ["tcp/a:1"]);
    }
}
