//! The session: opened in the role in which others find it, and asked whether its name is taken.

use super::closing::OpenSession;
use super::wanted::{self, Wanted, as_json, insert};
use super::{ServeOptions, failed};
use crate::bus::advice::Advice;
use crate::bus::endpoints::{self, BadEndpoint, DEFAULT_LISTEN};
use crate::bus::error::{BusError, words};
use crate::bus::keys::Keys;
use crate::bus::reach::Reach;
use serde_json::Value;
use std::sync::atomic::AtomicU32;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;
use zenoh::{Config, Session, Wait as _};

/// How often a free port is looked for, should somebody else take the one that was found.
const PORT_ATTEMPTS: usize = 8;

/// Opens a session by an explicit configuration: loopback unless told otherwise, scouting and admin space off.
///
/// As what it joins others, unless the configuration says `mode`: Zenoh hands nothing on between two peers that do not know
/// each other by gossip, which is off, so that a peer's tokens and replies end at its router. A client is found by everybody
/// there, whatever they and the one it joined are; but it has one connection and no listener, and there must be somebody as
/// it opens. Where that is not enough, it is a router among routers, and a peer among peers: of two routers a peer shows its
/// clients one.
///
/// Two instances of one name would both answer, so `alone` is refused where its name is served already. That is asked as a
/// client, too.
pub(super) fn open(
    options: &ServeOptions,
    alone: Option<&Keys>,
) -> Result<(OpenSession, Reach), BusError> {
    let wanted = wanted::configure(options)?;
    refuse_fork()?;
    let may_be_client = match wanted.mode.as_deref() {
        None => wanted.listen.is_empty() && wanted.connect.len() == 1,
        Some(mode) => mode == "client",
    };
    let mut unanswered = None;
    if may_be_client {
        match wanted.client_of(&wanted.connect) {
            Ok(session) => {
                alone.map_or(Ok(()), |keys| refuse_twin(&session, keys, wanted.advice))?;
                let through = wanted.connect;
                return Ok((
                    session,
                    Reach {
                        through,
                        ..Reach::default()
                    },
                ));
            }
            Err(error) if wanted.mode.is_some() => return Err(error),
            // Nobody is there yet: a router goes on looking.
            Err(BusError::Zenoh { reason, .. }) => unanswered = Some(reason),
            Err(other) => return Err(other),
        }
    }
    let among_peers = !may_be_client && wanted.look_around(alone)?;
    let mode = if among_peers || wanted.connect.is_empty() {
        "peer"
    } else {
        "router"
    };
    wanted.listening(mode, unanswered)
}

impl Wanted {
    fn client_of(&self, connect: &[String]) -> Result<OpenSession, BusError> {
        let mut config = self.config.clone();
        insert(&mut config, "mode", "\"client\"")?;
        insert(&mut config, "listen/endpoints", "[]")?;
        insert(&mut config, "connect/endpoints", &as_json(connect))?;
        let opened = zenoh::open(config).wait().map(OpenSession::new);
        opened.map_err(|error| BusError::Zenoh {
            doing: format!("connect to {}", connect.join(", ")),
            reason: words(error),
        })
    }

    /// Whether those who answer are peers, all of them. Who does not answer knows no instance.
    fn look_around(&self, alone: Option<&Keys>) -> Result<bool, BusError> {
        let (mut peers, mut routers) = (false, false);
        for endpoint in &self.connect {
            let Ok(session) = self.client_of(std::slice::from_ref(endpoint)) else {
                continue;
            };
            let is_router = session.info().routers_zid().wait().next().is_some();
            (peers, routers) = (peers || !is_router, routers || is_router);
            let answer = alone.map_or(Ok(()), |keys| refuse_twin(&session, keys, self.advice));
            // It has served; what is left of it ends with the process at the latest.
            let _ = session.close();
            answer?;
        }
        Ok(peers && !routers)
    }

    /// As a peer or router that others may connect to, and that looks for whom it shall connect to until they are there.
    fn listening(
        self,
        mode: &str,
        unanswered: Option<String>,
    ) -> Result<(OpenSession, Reach), BusError> {
        let mode = self.mode.as_deref().unwrap_or(mode);
        let mut config = self.config;
        insert(&mut config, "mode", &Value::from(mode).to_string())?;
        insert(&mut config, "connect/endpoints", &as_json(&self.connect))?;
        let mut listen = self.listen;
        if listen.is_empty() && self.connect.is_empty() {
            listen.push(DEFAULT_LISTEN.to_owned());
        }
        let (session, listeners) = with_real_ports(config, &listen, self.advice)?;
        let reach = Reach {
            listeners,
            through: self.connect,
            unanswered,
        };
        Ok((session, reach))
    }
}

/// The session, and its listeners with real ports.
fn with_real_ports(
    mut config: Config,
    wanted: &[String],
    advice: Advice,
) -> Result<(OpenSession, Vec<String>), BusError> {
    let mut attempt = 1;
    loop {
        let listeners: Vec<String> = wanted
            .iter()
            .map(|endpoint| endpoints::with_real_port(endpoint))
            .collect::<Result<_, _>>()?;
        insert(&mut config, "listen/endpoints", &as_json(&listeners))?;
        match zenoh::open(config.clone()).wait() {
            Ok(session) => return Ok((OpenSession::new(session), listeners)),
            Err(error) => {
                // Zenoh does not say which step of opening failed.
                let bound = listeners.iter().try_for_each(|l| endpoints::check_port(l));
                match bound {
                    // Somebody took the free port in the meantime.
                    Err(_) if listeners != wanted && attempt < PORT_ATTEMPTS => attempt += 1,
                    bound => return Err(not_opened(bound.err(), words(error), advice)),
                }
            }
        }
    }
}

/// Why there is no session; a listener that cannot be bound gets the advice to choose another.
fn not_opened(unbound: Option<BadEndpoint>, reason: String, advice: Advice) -> BusError {
    let doing = match unbound {
        Some(unbound) => format!(
            "{unbound} (port in use? choose another {})",
            advice.listen()
        ),
        None => "cannot open the session".to_owned(),
    };
    BusError::Zenoh { doing, reason }
}

/// Zenoh keeps threads for all sessions of a process, and takes them for its own in one that was forked.
fn refuse_fork() -> Result<(), BusError> {
    static OPENED_BY: AtomicU32 = AtomicU32::new(0);
    let process = std::process::id();
    match OPENED_BY.compare_exchange(0, process, Relaxed, Relaxed) {
        Err(other) if other != process => Err(BusError::Forked),
        _ => Ok(()),
    }
}

fn refuse_twin(session: &Session, keys: &Keys, advice: Advice) -> Result<(), BusError> {
    let twins = session
        .liveliness()
        .get(keys.alive())
        .timeout(Duration::from_millis(500))
        .wait()
        .map_err(failed("ask whether the name is taken"))?;
    if twins.iter().any(|reply| reply.result().is_ok()) {
        return Err(BusError::Taken {
            instance: keys.instance().to_owned(),
            advice,
        });
    }
    Ok(())
}
