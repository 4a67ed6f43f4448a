//! Replies: every query gets exactly one answer, sent by a thread of its own.

use crate::bus::publish::{LastValues, Publication};
use crate::bus::refusal::{Code, Refusal};
use crate::bus::reply::Reply;
use crate::bus::status::{Shared, lock};
use crate::bus::tasks::Asked;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender, TrySendError};
use zenoh::Wait as _;
use zenoh::bytes::Encoding;
use zenoh::key_expr::KeyExpr;
use zenoh::query::Query;

/// What is said to those who wait when the server ends.
pub(super) fn ended() -> Refusal {
    Refusal::new(Code::State, "the server ended before this was carried out")
}

/// What is said to those for whom a queue has no room.
pub(super) fn busy(waiting: usize, what: &str) -> Refusal {
    let message = format!("{waiting} {what} wait already; nothing happened; send it again later");
    Refusal::new(Code::Busy, message)
}

/// Something for the thread that sends replies.
pub(super) enum Job {
    Reply(Waiting, Reply),
    LastValues(Waiting),
}

/// A query that waits for its one answer. Dropped without one (a thread panicked, the server ended), it answers so.
pub(super) struct Waiting {
    pub(super) query: Option<Query>,
    /// The exact key, at which replies can be given; expressions only get errors.
    pub(super) key: Option<String>,
    pub(super) req: String,
    pub(super) shared: Arc<Shared>,
    pub(super) jobs: SyncSender<Job>,
}

impl Waiting {
    /// To the replying thread; if that is too far behind or gone, from here.
    pub(super) fn hand_on(self, reply: Reply) {
        let jobs = self.jobs.clone();
        match jobs.try_send(Job::Reply(self, reply)) {
            Ok(()) => {}
            Err(TrySendError::Full(job) | TrySendError::Disconnected(job)) => {
                if let Job::Reply(waiting, reply) = job {
                    waiting.send(&reply);
                }
            }
        }
    }

    /// From here, whatever the replying thread does.
    pub(super) fn refuse(self, refusal: &Refusal) {
        let reply = Reply::refusal(&self.req, refusal, &self.shared.status());
        self.send(&reply);
    }

    /// Over the network.
    fn send(mut self, reply: &Reply) {
        if let Some(query) = self.query.take() {
            send_reply(&query, self.key.as_deref(), &reply.body);
        }
    }
}

impl Asked for Waiting {
    fn answer(self: Box<Self>, reply: Reply) {
        self.hand_on(reply);
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        if let Some(query) = self.query.take() {
            let refusal = if std::thread::panicking() {
                Refusal::new(Code::Internal, "a defect of this program; report it")
            } else {
                ended()
            };
            let reply = Reply::refusal(&self.req, &refusal, &self.shared.status());
            send_reply(&query, self.key.as_deref(), &reply.body);
        }
    }
}

/// An answer that cannot be delivered is nobody's: the client has gone.
fn send_reply(query: &Query, key: Option<&str>, body: &str) {
    let json = Encoding::APPLICATION_JSON;
    let _ = match key {
        Some(key) => query.reply(key, body).encoding(json).wait(),
        None => query.reply_err(body).encoding(json).wait(),
    };
}

pub(super) fn send_replies(jobs: &Receiver<Job>, last: &LastValues) {
    for job in jobs {
        match job {
            Job::Reply(waiting, reply) => waiting.send(&reply),
            Job::LastValues(waiting) => send_last_values(waiting, last),
        }
    }
}

fn send_last_values(mut waiting: Waiting, last: &LastValues) {
    let Some(query) = waiting.query.take() else {
        return;
    };
    let found = find_last_values(&query, last);
    for publication in &found {
        // As in `send_reply`.
        let _ = query
            .reply(&*publication.key, publication.bytes.as_slice())
            .encoding(encoding(publication))
            .wait();
    }
    if found.is_empty() {
        let refusal = Refusal::new(Code::BadRequest, nothing_at(query.key_expr()));
        let reply = Reply::refusal("", &refusal, &waiting.shared.status());
        send_reply(&query, None, &reply.body);
    }
}

/// The last publications at the keys that a query names.
pub(super) fn find_last_values(query: &Query, last: &LastValues) -> Vec<Publication> {
    let matches = |key: &str| KeyExpr::new(key).is_ok_and(|k| k.intersects(query.key_expr()));
    lock(last)
        .values()
        .filter(|publication| matches(&publication.key))
        .cloned()
        .collect()
}

/// What is said of a key at which there is no last value.
pub(super) fn nothing_at(key: &str) -> String {
    match key.ends_with(".validity") || key.ends_with(']') {
        true => format!(
            "nothing is published at {key}: a gauge's validity and the elements of an array stand in the message of their \
             output, such as out/gauge/NAME.depth"
        ),
        false => format!("nothing was published at {key} yet"),
    }
}

pub(super) fn encoding(publication: &Publication) -> Encoding {
    Encoding::APPLICATION_PROTOBUF.with_schema(publication.schema.as_ref())
}
