//! The publishing thread. A subscriber that does not take what it gets (stopped, asleep in its callback) holds it up once,
//! for as long as `session` says; from then on that subscriber misses what is published, until it takes something again,
//! and the others get all. Its connection stays open.
//!
//! Publications have queues of their own in Zenoh, below those of replies: a reply does not wait behind what its client does
//! not take, and gauges of a server do not wait behind particles.

use super::failed;
use super::replies::encoding;
use crate::bus::error::BusError;
use crate::bus::keys::Keys;
use crate::bus::publish::Publication;
use crate::bus::queue::Taker;
use crate::wire::keys as topics;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use zenoh::qos::{CongestionControl, Priority};
use zenoh::{Session, Wait as _};

/// The queue for particles, in which they are not in the way of gauges. Where the process ends with the session: Zenoh's last
/// message to each peer has the same queue, and is waited for without end where that is full (`closing`).
pub(super) const OWN_QUEUE: Priority = Priority::Background;

/// The queue of gauges. A process that goes on after the session has particles there, too: what Zenoh leaves behind when it
/// cannot close a connection is the one thread that sends, for all sessions to come.
pub(super) const QUEUE_OF_GAUGES: Priority = Priority::DataLow;

/// Publishers by key.
pub(super) struct Press {
    session: Session,
    publishers: HashMap<Arc<str>, zenoh::pubsub::Publisher<'static>>,
}

impl Press {
    pub(super) fn new(
        session: Session,
        keys: &Keys,
        wanted: Arc<AtomicBool>,
        queue_of_particles: Priority,
    ) -> Result<Self, BusError> {
        // Particles are large, and made only for somebody.
        let key: Arc<str> = topics::particles(keys.base()).into();
        let particles = session
            .declare_publisher(key.to_string())
            .congestion_control(CongestionControl::Drop)
            .priority(queue_of_particles)
            .wait()
            .map_err(failed("publish particles"))?;
        particles
            .matching_listener()
            .callback(move |status| wanted.store(status.matching(), Relaxed))
            .background()
            .wait()
            .map_err(failed("see who wants particles"))?;
        Ok(Self {
            session,
            publishers: HashMap::from([(key, particles)]),
        })
    }

    pub(super) fn run(mut self, batches: Taker) {
        for batch in batches {
            for publication in batch {
                self.put(&publication);
            }
        }
    }

    fn put(&mut self, publication: &Publication) {
        if !self.publishers.contains_key(&publication.key) {
            let declared = self
                .session
                .declare_publisher(publication.key.to_string())
                .congestion_control(CongestionControl::Drop)
                .priority(QUEUE_OF_GAUGES)
                .wait();
            // Fails only once the session is closed; then there is nobody to publish to.
            if let Ok(publisher) = declared {
                self.publishers.insert(publication.key.clone(), publisher);
            }
        }
        if let Some(publisher) = self.publishers.get(&publication.key) {
            let _ = publisher
                .put(publication.bytes.as_slice())
                .encoding(encoding(publication))
                .wait();
        }
    }
}
