//! Publishes bytes that somebody else made, at their keys: what a replay of a log needs.
//!
//! Answers no request and takes no set-point; those who come late get the last value of each key.

use super::closing::OpenSession;
use super::replies::{encoding, find_last_values, nothing_at};
use super::{ServeOptions, failed, session, spawn, unsent};
use crate::bus::error::BusError;
use crate::bus::keys::Keys;
use crate::bus::publish::{LastValues, Publication};
use crate::bus::reach::Reach;
use crate::bus::status::lock;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::Duration;
use zenoh::Wait as _;
use zenoh::pubsub::Publisher;
use zenoh::qos::CongestionControl;
use zenoh::query::{Query, Queryable};

/// Queries for last values that may wait; more are answered with an error.
const WAITING_QUERIES: usize = 256;
/// How often is looked whether somebody listens.
const LOOK_EVERY: Duration = Duration::from_millis(20);

/// An open session that publishes.
pub struct Outlet {
    session: OpenSession,
    reach: Reach,
    keys: Keys,
    publishers: HashMap<Arc<str>, Publisher<'static>>,
    last: Arc<LastValues>,
    queryable: Option<Queryable<()>>,
    replying: Option<JoinHandle<()>>,
}

impl Outlet {
    /// Opens a session for the instance of `options`.
    ///
    /// # Errors
    /// As [`Server::open`](super::Server::open); [`BusError::Taken`] if a live component has that name and `force` is not
    /// set.
    pub fn open(options: &ServeOptions, force: bool) -> Result<Self, BusError> {
        let keys = Keys::new(&options.instance)?;
        let (session, reach) = session::open(options, (!force).then_some(&keys))?;
        let last = Arc::new(LastValues::default());
        let (queue, queries): (SyncSender<Query>, Receiver<Query>) = sync_channel(WAITING_QUERIES);
        let queryable = session
            .declare_queryable(keys.every_output())
            .callback(move |query| {
                if let Err(refused) = queue.try_send(query) {
                    let (std::sync::mpsc::TrySendError::Full(query)
                    | std::sync::mpsc::TrySendError::Disconnected(query)) = refused;
                    // Who asks too much is told so; if that fails, nobody is there.
                    let _ = query.reply_err("busy: ask again later").wait();
                }
            })
            .wait()
            .map_err(failed("answer for last values"))?;
        let known = last.clone();
        let replying = spawn("sandgate-reply", move || {
            for query in &queries {
                answer(&query, &known);
            }
        })?;
        Ok(Self {
            session,
            reach,
            keys,
            publishers: HashMap::new(),
            last,
            queryable: Some(queryable),
            replying: Some(replying),
        })
    }

    /// Where clients find it.
    #[must_use]
    pub fn reach(&self) -> &Reach {
        &self.reach
    }

    /// Waits until somebody subscribes to an output, or until `stop`.
    ///
    /// # Errors
    /// [`BusError::Zenoh`].
    pub fn wait_for_subscriber(&self, stop: &AtomicBool) -> Result<(), BusError> {
        let publisher = self
            .session
            .declare_publisher(self.keys.every_output())
            .wait()
            .map_err(failed("see who listens"))?;
        while !stop.load(Relaxed) {
            let status = publisher.matching_status().wait();
            if status.map_err(failed("see who listens"))?.matching() {
                break;
            }
            std::thread::sleep(LOOK_EVERY);
        }
        Ok(())
    }

    /// Publishes `bytes` of the protobuf message `schema` at `key`. Nothing is dropped on the way, particles neither: a
    /// subscriber that stands still holds it up for as long as Zenoh waits before it closes the connection, and
    /// [`wait_until_taken`](Self::wait_until_taken) waits for one that is slow.
    ///
    /// # Errors
    /// [`BusError::Zenoh`]: the session is closed.
    pub fn publish(&mut self, key: &str, schema: &str, bytes: Vec<u8>) -> Result<(), BusError> {
        let publication = Publication {
            key: key.into(),
            schema: schema.to_owned().into(),
            bytes: Arc::new(bytes),
        };
        if !self.publishers.contains_key(key) {
            let publisher = self
                .session
                .declare_publisher(key.to_owned())
                .congestion_control(CongestionControl::Block)
                .wait()
                .map_err(failed("publish"))?;
            self.publishers.insert(publication.key.clone(), publisher);
        }
        lock(&self.last).insert(publication.key.clone(), publication.clone());
        if let Some(publisher) = self.publishers.get(key) {
            publisher
                .put(publication.bytes.as_slice())
                .encoding(encoding(&publication))
                .wait()
                .map_err(failed("publish"))?;
        }
        Ok(())
    }

    /// Waits until subscribers took all that was published, until they take nothing for 5 s, or until `stop`. Gives the
    /// bytes that the system still holds for them: these, and what waits behind them, are lost with [`close`](Self::close).
    #[must_use]
    pub fn wait_until_taken(&self, stop: &AtomicBool) -> u64 {
        unsent::wait_until_taken(stop)
    }

    /// Ends the session, within 3 s.
    ///
    /// # Errors
    /// [`BusError::LeftOpen`], [`BusError::Zenoh`], [`BusError::Thread`]: all was published, and what is left open ends with
    /// the process.
    pub fn close(mut self) -> Result<(), BusError> {
        // Its callback holds the queue's only sender: without it the thread ends.
        drop(self.queryable.take());
        if let Some(replying) = self.replying.take() {
            // A panic there was reported by the thread itself.
            let _ = replying.join();
        }
        self.publishers.clear();
        self.session.close()
    }
}

fn answer(query: &Query, last: &LastValues) {
    let found = find_last_values(query, last);
    for publication in &found {
        // An answer that cannot be delivered is nobody's: the client has gone.
        let _ = query
            .reply(&*publication.key, publication.bytes.as_slice())
            .encoding(encoding(publication))
            .wait();
    }
    if found.is_empty() {
        let _ = query.reply_err(nothing_at(query.key_expr())).wait();
    }
}
