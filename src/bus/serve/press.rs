//! The publishing thread: it may be held up by a subscriber that stands still; nothing else is then.

use super::failed;
use super::replies::encoding;
use crate::bus::error::BusError;
use crate::bus::keys::Keys;
use crate::bus::publish::Publication;
use crate::wire::keys as topics;
use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::Receiver;
use zenoh::qos::CongestionControl;
use zenoh::{Session, Wait as _};

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
    ) -> Result<Self, BusError> {
        // Particles are large and soon old: they are dropped rather than waited for, and made only for somebody.
        let key: Arc<str> = topics::particles(keys.base()).into();
        let particles = session
            .declare_publisher(key.to_string())
            .congestion_control(CongestionControl::Drop)
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

    pub(super) fn run(mut self, batches: &Receiver<Vec<Publication>>) {
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
                .congestion_control(CongestionControl::Block)
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
