//! Replies already given, so that a request which is sent again is not carried out again.

use super::request::Request;
use std::collections::VecDeque;

/// How many replies are remembered, over all clients.
pub const REMEMBERED: usize = 256;

/// What is known of a request.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Earlier<'a, R> {
    /// Not seen (or too long ago).
    New,
    /// Answered with this.
    Answered(&'a R),
    /// The identifier was used for something else.
    Other,
}

/// The last [`REMEMBERED`] replies.
#[derive(Debug)]
pub(super) struct Answered<R> {
    entries: VecDeque<Entry<R>>,
}

#[derive(Debug)]
struct Entry<R> {
    client: String,
    req: String,
    verb: &'static str,
    fingerprint: [u8; 32],
    reply: R,
}

impl<R> Default for Answered<R> {
    fn default() -> Self {
        Self {
            entries: VecDeque::new(),
        }
    }
}

impl<R> Answered<R> {
    /// Looks a request up by client and identifier.
    pub(super) fn look_up(&self, request: &Request) -> Earlier<'_, R> {
        let same = |entry: &&Entry<R>| entry.client == request.client && entry.req == request.req;
        match self.entries.iter().find(same) {
            None => Earlier::New,
            Some(entry)
                if entry.verb == request.verb.name()
                    && entry.fingerprint == request.fingerprint =>
            {
                Earlier::Answered(&entry.reply)
            }
            Some(_) => Earlier::Other,
        }
    }

    /// Remembers a reply; forgets the oldest one when there are too many.
    pub(super) fn keep(&mut self, request: &Request, reply: R) {
        if self.entries.len() == REMEMBERED {
            self.entries.pop_front();
        }
        self.entries.push_back(Entry {
            client: request.client.clone(),
            req: request.req.clone(),
            verb: request.verb.name(),
            fingerprint: request.fingerprint,
            reply,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::super::verb::Verb;
    use super::*;

    fn request(body: &str) -> Request {
        Request::parse(Verb::Step, body.as_bytes()).unwrap()
    }

    #[test]
    fn only_the_same_body_of_the_same_client_is_a_repetition() {
        let mut answered = Answered::default();
        answered.keep(&request(r#"{"req":"1","client":"a","dt_ns":5}"#), 7);
        let look = |body| match answered.look_up(&request(body)) {
            Earlier::New => 'n',
            Earlier::Answered(7) => 'a',
            Earlier::Answered(_) => '?',
            Earlier::Other => 'o',
        };
        assert_eq!(look(r#"{ "dt_ns":5, "client":"a", "req":"1" }"#), 'a');
        assert_eq!(look(r#"{"req":"1","client":"a","dt_ns":6}"#), 'o');
        assert_eq!(look(r#"{"req":"1","client":"b","dt_ns":5}"#), 'n');
        assert_eq!(look(r#"{"req":"2","client":"a","dt_ns":5}"#), 'n');
        let pause = Request::parse(Verb::Pause, br#"{"req":"1","client":"a"}"#).unwrap();
        assert_eq!(answered.look_up(&pause), Earlier::Other);
    }

    #[test]
    fn the_oldest_is_forgotten_first() {
        let mut answered = Answered::default();
        let nth = |n: usize| request(&format!(r#"{{"req":"{n}"}}"#));
        for n in 0..=REMEMBERED {
            answered.keep(&nth(n), n);
        }
        assert_eq!(answered.look_up(&nth(0)), Earlier::New);
        assert_eq!(answered.look_up(&nth(1)), Earlier::Answered(&1));
        assert_eq!(
            answered.look_up(&nth(REMEMBERED)),
            Earlier::Answered(&REMEMBERED)
        );
    }
}
