//! The callbacks. They run on Zenoh's threads: they check, hand on to bounded queues, and never wait.

use super::replies::{Job, Waiting, busy, ended};
use super::{WAITING_REPLIES, failed};
use crate::bus::error::BusError;
use crate::bus::fields::{cut, text_in};
use crate::bus::keys::Keys;
use crate::bus::notes::{Exchange, Note};
use crate::bus::protocol::Fields;
use crate::bus::refusal::{Code, Refusal};
use crate::bus::reply::Reply;
use crate::bus::request::{LONGEST_TOLD, Request};
use crate::bus::set_point::SetPoint;
use crate::bus::status::{Shared, lock};
use crate::bus::tasks::{Giver, NoRoom, Task, WAITING_BYTES, WAITING_ODD_POINTS, WAITING_REQUESTS};
use crate::bus::verb::Verb;
use std::collections::HashMap;
use std::sync::atomic::Ordering::Relaxed;
use std::sync::mpsc::{SyncSender, TrySendError};
use std::sync::{Arc, Mutex};
use zenoh::liveliness::LivelinessToken;
use zenoh::pubsub::Subscriber;
use zenoh::query::{Query, Queryable};
use zenoh::sample::{Sample, SampleKind};
use zenoh::{Session, Wait as _};

/// What lets others in; dropped first when the server ends.
pub(super) struct Entrances {
    _alive: LivelinessToken,
    _requests: Queryable<()>,
    _inputs: Subscriber<()>,
    _outputs: Queryable<()>,
}

impl Entrances {
    pub(super) fn open(session: &Session, desk: Desk) -> Result<Self, BusError> {
        let desk = Arc::new(desk);
        let (at_requests, at_inputs, at_outputs) = (desk.clone(), desk.clone(), desk.clone());
        let requests = session
            .declare_queryable(desk.keys.every_request())
            .callback(move |query| at_requests.on_request(query))
            .wait()
            .map_err(failed("answer requests"))?;
        let inputs = session
            .declare_subscriber(desk.keys.every_input())
            .callback(move |sample| at_inputs.on_input(&sample))
            .wait()
            .map_err(failed("listen to set-points"))?;
        let outputs = session
            .declare_queryable(desk.keys.every_output())
            .callback(move |query| at_outputs.on_output(query))
            .wait()
            .map_err(failed("answer for last values"))?;
        // Last, so that who sees the token can ask.
        let alive = session
            .liveliness()
            .declare_token(desk.keys.alive())
            .wait()
            .map_err(failed("declare the liveliness token"))?;
        Ok(Self {
            _alive: alive,
            _requests: requests,
            _inputs: inputs,
            _outputs: outputs,
        })
    }
}

/// What the callbacks need.
pub(super) struct Desk {
    pub(super) keys: Keys,
    pub(super) shared: Arc<Shared>,
    pub(super) tasks: Giver,
    pub(super) notes: SyncSender<Note>,
    pub(super) jobs: SyncSender<Job>,
    /// Where somebody else owns time: what is answered without the component.
    pub(super) aside: Option<Arc<Aside>>,
}

/// What is known of a component that somebody else steps.
pub(super) struct Aside {
    /// Answer to `describe`.
    pub(super) description: Fields,
    /// Values by name as of the last communication point.
    pub(super) values: Mutex<Fields>,
    /// Elements of arrays by name: the array's name, and which one. Their values stand in the array's.
    pub(super) elements: HashMap<String, (String, usize)>,
}

impl Aside {
    /// The answer to anything but `status`.
    fn answer(&self, request: &Request) -> Result<Fields, Refusal> {
        match request.verb {
            Verb::Describe => Ok(self.description.clone()),
            Verb::Get => self.get(request.outputs.as_deref()),
            // Wherever the client believes the component to be.
            verb => Err(Refusal::new(
                Code::NotOwner,
                format!(
                    "{}: somebody else steps this component; allowed are describe, status, get, and set-points on in/VARIABLE",
                    verb.name()
                ),
            )),
        }
    }

    fn get(&self, names: Option<&[String]>) -> Result<Fields, Refusal> {
        let values = lock(&self.values);
        let Some(names) = names else {
            return Ok(Fields::from_iter([(
                "outputs".to_owned(),
                values.clone().into(),
            )]));
        };
        let element = |name: &String| {
            let (array, at) = self.elements.get(name)?;
            values.get(array)?.get(at)
        };
        let found = names
            .iter()
            .map(|name| match values.get(name).or_else(|| element(name)) {
                Some(value) => Ok((name.clone(), value.clone())),
                None => {
                    let known: Vec<&str> = values.keys().map(String::as_str).collect();
                    let known = known.join(", ");
                    let message = format!("unknown variable {name:?}; there are {known}");
                    Err(Refusal::new(Code::UnknownVariable, message))
                }
            });
        let found: Result<Fields, Refusal> = found.collect();
        Ok(Fields::from_iter([("outputs".to_owned(), found?.into())]))
    }
}

impl Desk {
    fn on_request(&self, query: Query) {
        let key = query.key_expr().as_str().to_owned();
        let bytes = query.payload().map(|p| p.to_bytes()).unwrap_or_default();
        let read = self.keys.verb_of(&key).and_then(|name| {
            no_parameters(&query)?;
            Request::parse(Verb::from_name(name)?, &bytes)
        });
        let shown = match read {
            Ok(_) => &bytes[..],
            Err(_) => &bytes[..bytes.len().min(LONGEST_TOLD)],
        };
        let body = String::from_utf8_lossy(shown).into_owned();
        let exact = !key.contains(['*', '$']);
        let verb = key.split_once("/@rpc/").map_or("", |(_, verb)| verb);
        let verb = cut(verb);
        let mut waiting = Waiting {
            query: Some(query.clone()),
            key: exact.then_some(key),
            req: String::new(),
            shared: self.shared.clone(),
            jobs: self.jobs.clone(),
        };
        match read {
            Ok(request) => {
                waiting.req.clone_from(&request.req);
                match self.known_here(&request) {
                    Some(reply) => {
                        let names = [verb, request.req, request.client, body];
                        self.answer_here(waiting, reply, names);
                    }
                    None => self.hand_in(request, waiting, body),
                }
            }
            Err(refusal) => {
                waiting.req = Request::req_of(&bytes);
                let reply = Reply::refusal(&waiting.req, &refusal, &self.shared.status());
                let (req, client) = (cut(&waiting.req), cut(&text_in(&bytes, "client")));
                self.answer_here(waiting, reply, [verb, req, client, body]);
            }
        }
    }

    /// The reply to what needs no component: `status`, and everything where somebody else owns time.
    fn known_here(&self, request: &Request) -> Option<Reply> {
        if request.verb == Verb::Status {
            let status = self.shared.status();
            let mut fields = status.figures();
            fields.extend(self.shared.live());
            return Some(Reply::success(&request.req, &status, fields));
        }
        let aside = self.aside.as_ref()?;
        let status = self.shared.status();
        Some(match aside.answer(request) {
            Ok(fields) => Reply::success(&request.req, &status, fields),
            Err(refusal) => Reply::refusal(&request.req, &refusal, &status),
        })
    }

    /// Gives the component a request, or refuses it where there is no room or no server any more.
    fn hand_in(&self, request: Request, waiting: Waiting, body: String) {
        let task = Task::Call {
            request: Box::new(request),
            body,
            asked: Box::new(waiting),
        };
        let Err((why, task)) = self.tasks.call(task) else {
            return;
        };
        let refusal = match why {
            NoRoom::Full => busy(WAITING_REQUESTS, "requests"),
            NoRoom::Heavy => busy(WAITING_BYTES >> 20, "MiB of requests"),
            NoRoom::Ended => ended(),
        };
        if let Task::Call {
            request,
            body,
            asked,
        } = task
        {
            let reply = Reply::refusal(&request.req, &refusal, &self.shared.status());
            let verb = request.verb.name().to_owned();
            self.note(&reply, [verb, request.req, request.client, body]);
            asked.answer(reply);
        }
    }

    /// Answers without the component.
    fn answer_here(&self, waiting: Waiting, reply: Reply, names: [String; 4]) {
        self.note(&reply, names);
        waiting.hand_on(reply);
    }

    fn note(&self, reply: &Reply, [verb, req, client, body]: [String; 4]) {
        let exchange = Exchange {
            verb,
            req,
            client,
            body: shortened(body),
            status: reply.status(),
            reply: reply.body.clone(),
        };
        self.keep(Note::Call(exchange));
    }

    fn on_input(&self, sample: &Sample) {
        let key = sample.key_expr().as_str();
        let bytes = sample.payload().to_bytes();
        let read = self.keys.variable_of(key).and_then(|variable| {
            if sample.kind() == SampleKind::Delete {
                let message = format!("{variable}: found a delete, allowed a value");
                return Err(Refusal::new(Code::BadRequest, message));
            }
            SetPoint::parse(variable, &bytes)
        });
        let handed_on = read.and_then(|point| {
            let given = self.tasks.point(point, self.shared.saturates());
            given.map_err(|why| match why {
                NoRoom::Ended => ended(),
                NoRoom::Full | NoRoom::Heavy => {
                    let what = "set-points that will hardly be taken";
                    let message = format!("{key}: {WAITING_ODD_POINTS} {what} wait already");
                    Refusal::new(Code::Busy, message)
                }
            })
        });
        match handed_on {
            Ok(None) => {}
            Ok(Some(older)) => {
                let told = SetPoint::told(&older.variable, older.body.as_bytes());
                self.keep(Note::Superseded(told));
            }
            Err(refusal) => {
                self.shared.refused_set_points.fetch_add(1, Relaxed);
                let variable = key.split_once("/in/").map_or("", |(_, variable)| variable);
                self.keep(Note::Refused(SetPoint::told(variable, &bytes), refusal));
            }
        }
    }

    /// For the log; counted if too many wait for it.
    fn keep(&self, note: Note) {
        if self.notes.try_send(note).is_err() {
            self.shared.unlogged_calls.fetch_add(1, Relaxed);
        }
    }

    fn on_output(&self, query: Query) {
        let waiting = Waiting {
            query: Some(query),
            key: None,
            req: String::new(),
            shared: self.shared.clone(),
            jobs: self.jobs.clone(),
        };
        // If the queue is gone, the job is dropped here, which answers.
        if let Err(TrySendError::Full(Job::LastValues(waiting))) =
            self.jobs.try_send(Job::LastValues(waiting))
        {
            waiting.refuse(&busy(WAITING_REPLIES, "replies"));
        }
    }
}

/// As much of a body as is kept of what was answered without the component: notes wait by number, whatever their length.
fn shortened(mut body: String) -> String {
    if body.len() > LONGEST_TOLD {
        let whole = |end: &usize| body.is_char_boundary(*end);
        body.truncate((0..=LONGEST_TOLD).rev().find(whole).unwrap_or(0));
        body.shrink_to_fit();
    }
    body
}

/// Parameters after `?` would be silently ignored; those of Zenoh itself begin with an underscore.
fn no_parameters(query: &Query) -> Result<(), Refusal> {
    match query
        .parameters()
        .iter()
        .find(|(name, _)| !name.starts_with('_'))
    {
        None => Ok(()),
        Some((name, _)) => Err(Refusal::new(
            Code::BadRequest,
            format!("found parameter {name:?} after ?; a request is a JSON object in the payload"),
        )),
    }
}
