//! What waits for the stepping thread: tasks for the component, and notes of what was dealt with elsewhere.

use super::reply::Reply;
use super::request::Request;
use super::set_point::SetPoint;
use crate::wire::convert::timestamp;
use crate::wire::messages::{Command, CommandKind};

/// Tasks that may wait for the stepping thread.
pub(super) const WAITING_TASKS: usize = 256;
/// How many of these may be set-points, so that a flood of them leaves room for requests.
pub(super) const WAITING_SET_POINTS: usize = 192;
/// Calls answered elsewhere that may wait to be written to the log.
pub(super) const WAITING_NOTES: usize = 1024;

/// Somebody who waits for a reply. Dropping it answers, too, with an error.
pub(super) trait Asked: Send {
    /// Hands the reply on to the thread that sends it.
    fn answer(self: Box<Self>, reply: Reply);
}

/// Something for the component.
pub(super) enum Task {
    /// A request, with its body as it came.
    Call {
        request: Box<Request>,
        body: String,
        asked: Box<dyn Asked>,
    },
    /// A set-point.
    SetPoint(SetPoint),
}

/// Something that was dealt with elsewhere and belongs in the log.
pub(super) enum Note {
    /// A call answered without the component.
    Call(Exchange),
    /// A set-point refused.
    Refused(String),
}

/// A call and its reply as text.
pub(super) struct Exchange {
    pub(super) verb: String,
    pub(super) req: String,
    pub(super) client: String,
    pub(super) body: String,
    pub(super) status: &'static str,
    pub(super) reply: String,
}

/// One half of a call for the log, at a simulated time [s]; takes its text.
pub(super) fn command(time: f64, exchange: &mut Exchange, kind: CommandKind) -> Command {
    let request = kind == CommandKind::Request;
    let body = if request {
        &mut exchange.body
    } else {
        &mut exchange.reply
    };
    Command {
        timestamp: Some(timestamp(time)),
        time,
        kind: kind as i32,
        interface: "rpc".into(),
        verb: exchange.verb.clone(),
        request: exchange.req.clone(),
        client: exchange.client.clone(),
        body: std::mem::take(body),
        status: if request {
            String::new()
        } else {
            exchange.status.into()
        },
    }
}
