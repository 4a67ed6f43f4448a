//! The session, and its end within a time that can be counted on.
//!
//! Zenoh's own `close` has no such time: to each peer it sends a last message through the queue of the lowest priority. Where
//! that is full, because a subscriber takes nothing, it waits for room with the queue locked, and once that peer's connection
//! is given up its sending thread waits for this lock. Neither ends, and the deadline that Zenoh sets itself is not
//! looked at meanwhile. So a session is closed on a thread of its own, which is left behind if need be.

use super::{failed, spawn};
use crate::bus::error::BusError;
use std::ops::Deref;
use std::sync::mpsc::sync_channel;
use std::time::Duration;
use zenoh::{Session, Wait as _};

/// How long closing may take: the 2.5 s for which Zenoh tries to send one subscriber what waits for it, and a little more.
const PATIENCE: Duration = Duration::from_secs(3);

/// An open session. Dropped it is closed like by [`close`](Self::close), with nobody to hear of it.
pub(super) struct OpenSession(Option<Session>);

impl OpenSession {
    pub(super) fn new(session: Session) -> Self {
        Self(Some(session))
    }

    /// # Errors
    /// [`BusError::LeftOpen`] if it takes too long; the rest of it is done by a thread that may last as long as the process.
    /// [`BusError::Zenoh`]; [`BusError::Thread`].
    pub(super) fn close(mut self) -> Result<(), BusError> {
        self.0.take().map_or(Ok(()), close)
    }
}

fn close(session: Session) -> Result<(), BusError> {
    let (done, closed) = sync_channel(1);
    let thread = spawn("sandgate-close", move || {
        let closed = session.close().wait();
        drop(session);
        // Who gave up does not hear it.
        let _ = done.send(closed);
    })?;
    let closed = closed
        .recv_timeout(PATIENCE)
        .map_err(|_| BusError::LeftOpen {
            seconds: PATIENCE.as_secs(),
        })?;
    // It has nothing left to do.
    let _ = thread.join();
    closed.map_err(failed("close the session"))
}

impl Deref for OpenSession {
    type Target = Session;

    fn deref(&self) -> &Session {
        // Only `close` and `drop` take it, and nobody has it afterwards.
        match &self.0 {
            Some(session) => session,
            None => unreachable!("a session that was closed is not used"),
        }
    }
}

impl Drop for OpenSession {
    fn drop(&mut self) {
        if let Some(session) = self.0.take() {
            let _ = close(session);
        }
    }
}

/// A session that is used no more and waits to be closed, so that what must not wait for it comes first.
#[must_use = "closes the session when it is dropped, and nobody hears whether that could be done"]
pub struct Leaving(pub(super) OpenSession);

impl Leaving {
    /// Closes it, within 3 s.
    ///
    /// # Errors
    /// [`BusError::LeftOpen`], [`BusError::Zenoh`], [`BusError::Thread`]: all that was published and answered before has been
    /// handed to Zenoh all the same, and what is left open ends with the process.
    pub fn close(self) -> Result<(), BusError> {
        self.0.close()
    }
}
