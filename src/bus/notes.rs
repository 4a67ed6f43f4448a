//! What belongs in the log: calls and set-points as messages, and notes of what was dealt with beside the stepping thread.

use super::refusal::Refusal;
use super::set_point::SetPoint;
use crate::wire::Observer;
use crate::wire::convert::timestamp;
use crate::wire::foxglove::LogLevel;
use crate::wire::messages::{Command, CommandKind};
use std::sync::mpsc::Receiver;

/// Calls answered elsewhere that may wait to be written to the log.
pub(super) const WAITING_NOTES: usize = 1024;

/// Something that was dealt with elsewhere and belongs in the log.
pub(super) enum Note {
    /// A call answered without the component.
    Call(Exchange),
    /// A set-point refused.
    Refused(SetPoint, Refusal),
    /// A set-point that gave way to a newer one of its variable.
    Superseded(SetPoint),
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

/// Notes that wait for who owns the component.
#[derive(Debug)]
pub(super) struct Notes(pub(super) Receiver<Note>);

impl Notes {
    /// Tells all that wait, at a simulated time [s].
    pub(super) fn tell(&self, time: f64, observer: &mut dyn Observer) {
        while let Ok(note) = self.0.try_recv() {
            match note {
                Note::Refused(point, refusal) => tell_refused(time, &point, &refusal, observer),
                Note::Superseded(point) => tell_superseded(time, &point, observer),
                Note::Call(mut exchange) => {
                    observer.on_command(&command(time, &mut exchange, CommandKind::Request));
                    observer.on_reply(&command(time, &mut exchange, CommandKind::Reply));
                }
            }
        }
    }
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

/// A set-point that was taken, told before any step uses it: the component may not live to the next one.
pub(super) fn tell_taken(time: f64, point: &SetPoint, observer: &mut dyn Observer) {
    observer.on_command(&wish(time, point, "ok"));
}

/// A set-point that no step will use, because a newer one of its variable came before it could be taken. No line for people:
/// it is as meant.
pub(super) fn tell_superseded(time: f64, point: &SetPoint, observer: &mut dyn Observer) {
    observer.on_command(&wish(time, point, "superseded"));
}

/// A set-point that was refused: who sent what, and a line with the reason.
pub(super) fn tell_refused(
    time: f64,
    point: &SetPoint,
    refusal: &Refusal,
    observer: &mut dyn Observer,
) {
    observer.on_command(&wish(time, point, refusal.code.as_str()));
    let text = format!("set-point refused: {refusal}");
    observer.on_log(time, LogLevel::Warning, "bus", &text);
}

/// At the end: calls that were answered, and set-points that were refused or superseded, and that are not in the log, because too many waited for it.
pub(super) fn tell_unlogged(time: f64, count: u64, observer: &mut dyn Observer) {
    if count > 0 {
        let text =
            format!("{count} calls and set-points are not in this log: too many came at once");
        observer.on_log(time, LogLevel::Warning, "bus", &text);
    }
}

/// A set-point has no reply, so that its one message says what became of it.
fn wish(time: f64, point: &SetPoint, status: &str) -> Command {
    Command {
        timestamp: Some(timestamp(time)),
        time,
        kind: CommandKind::Request as i32,
        interface: "in".into(),
        verb: point.variable.clone(),
        request: String::new(),
        client: point.client.clone(),
        body: point.body.clone(),
        status: status.to_owned(),
    }
}
