//! The stepping thread: owns the component, takes tasks from a bounded queue in the order in which they came, and
//! steps by itself while running freely.
//!
//! Does not know Zenoh: who asked is behind [`Asked`].

mod pace;

use super::notes::{Exchange, command, tell_refused, tell_taken, tell_unlogged};
use super::protocol::Protocol;
use super::refusal::Refusal;
use super::reply::Reply;
use super::request::Request;
use super::set_point::SetPoint;
use super::status::{Busy, Shared};
use super::tasks::{Asked, Taker, Task, WAITING_REQUESTS};
use super::watch::{Lost, Watch, WhenLost};
use crate::component::Component;
use crate::wire::Observer;
use crate::wire::foxglove::LogLevel;
use crate::wire::messages::CommandKind;
use pace::Pace;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

/// How often the stepping thread looks whether it shall stop when nobody asks anything.
const LOOK_UP: Duration = Duration::from_millis(50);

/// How long a server stays to be asked why, once its log broke off that must be whole: as long as Zenoh's lease, after which
/// who stands still counts as gone.
const FAREWELL: Duration = Duration::from_secs(10);

/// The component and its queues.
pub(super) struct Stepper<'a> {
    pub(super) component: Component,
    pub(super) protocol: Protocol,
    pub(super) shared: &'a Shared,
    pub(super) tasks: Taker,
    pub(super) watch: Watch,
    /// When it ends, once nothing may go on.
    pub(super) ends: Option<Instant>,
}

impl Stepper<'_> {
    /// Works until told to stop, until `terminate`, until nobody can ask any more, or until a while after `observer` could not
    /// go on.
    pub(super) fn run(&mut self, observer: &mut dyn Observer, stop: &AtomicBool) {
        let mut pace: Option<Pace> = None;
        // Turns since the orchestrator's silence lasted too long.
        let mut overdue = 0;
        // What is carried out before the step that is due.
        let mut ahead = None;
        while !stop.load(Relaxed) && self.ends.is_none_or(|end| Instant::now() < end) {
            self.protocol.tell_notes(&self.component, observer);
            self.tell_trouble(observer);
            pace = self.keep_pace(pace);
            overdue = match pace.is_none() && self.watch.is_due() {
                true => overdue + 1,
                false => 0,
            };
            // What waits in the queue may be the request that was missed. Set-points that keep coming are not.
            if overdue > WAITING_REQUESTS && self.is_lost(observer) {
                break;
            }
            let until_step = pace.as_ref().map(|p| p.wait(self.component.time()));
            // What waits when a step falls due is carried out before it, as it may be what ends free running. What comes
            // later puts it off no further: clients that keep asking would stop the component.
            ahead = match until_step {
                Some(Duration::ZERO) => match ahead.or_else(|| self.tasks.waiting()) {
                    None => break,
                    Some(0) => {
                        self.free_step(observer);
                        ahead = None;
                        continue;
                    }
                    Some(tasks) => Some(tasks - 1),
                },
                _ => None,
            };
            let wait = match overdue {
                0 => until_step.unwrap_or(LOOK_UP).min(LOOK_UP),
                _ => Duration::ZERO,
            };
            match self.tasks.take(wait) {
                Ok(task) => {
                    if self.carry_out(task, observer) {
                        break;
                    }
                }
                Err(RecvTimeoutError::Disconnected) => break,
                Err(RecvTimeoutError::Timeout) => {
                    if overdue > 0 && self.is_lost(observer) {
                        break;
                    }
                }
            }
        }
    }

    /// The pace of free running from here on, if the component steps by itself.
    fn keep_pace(&mut self, before: Option<Pace>) -> Option<Pace> {
        let Some(factor) = self.protocol.free_running() else {
            if before.is_some() {
                // While the component stepped by itself nobody had to speak.
                self.watch.excuse();
            }
            return None;
        };
        let epoch = self.protocol.epoch();
        let kept = before.filter(|pace| pace.factor == factor && pace.epoch == epoch);
        Some(kept.unwrap_or_else(|| Pace::new(self.component.time(), factor, epoch)))
    }

    /// Nobody gets in any more. Who still waits is told why nothing comes of it, and the log is told all of it; gives the
    /// component back.
    pub(super) fn close(self, why: &Refusal, observer: &mut dyn Observer) -> Component {
        let time = self.component.time();
        for task in self.tasks.take_all() {
            match task {
                Task::SetPoint(point) => tell_refused(time, &point, why, observer),
                Task::Call {
                    request,
                    body,
                    asked,
                } => {
                    let status = self.protocol.status(&self.component);
                    let reply = Reply::refusal(&request.req, why, &status);
                    let mut exchange = exchange(&request, body);
                    (exchange.status, exchange.reply) = (reply.status(), reply.body.clone());
                    asked.answer(reply);
                    observer.on_command(&command(time, &mut exchange, CommandKind::Request));
                    observer.on_reply(&command(time, &mut exchange, CommandKind::Reply));
                }
            }
        }
        self.protocol.tell_notes(&self.component, observer);
        tell_unlogged(time, self.shared.unlogged_calls.load(Relaxed), observer);
        self.component
    }

    /// Whether the server ends after it.
    fn carry_out(&mut self, task: Task, observer: &mut dyn Observer) -> bool {
        match task {
            Task::SetPoint(point) => {
                self.set_point(&point, observer);
                false
            }
            Task::Call {
                request,
                body,
                asked,
            } => self.answer(&request, body, asked, observer),
        }
    }

    /// Takes a set-point, or says why not.
    fn set_point(&mut self, point: &SetPoint, observer: &mut dyn Observer) {
        let done = self
            .protocol
            .set_point(&mut self.component, point, observer);
        let time = self.component.time();
        match done {
            Ok(()) => tell_taken(time, point, observer),
            Err(refusal) => {
                self.shared.refused_set_points.fetch_add(1, Relaxed);
                tell_refused(time, point, &refusal, observer);
            }
        }
        // All else of the status is what it was, and takes a walk over all particles.
        self.shared.set_saturates(self.component.saturates_inputs());
    }

    /// Carries out a request and answers who asked. Whether the server ends after it.
    fn answer(
        &mut self,
        request: &Request,
        body: String,
        asked: Box<dyn Asked>,
        observer: &mut dyn Observer,
    ) -> bool {
        self.shared.set_busy(Some(Busy {
            verb: request.verb.name(),
            client: request.client.clone(),
            req: request.req.clone(),
        }));
        let mut exchange = exchange(request, body);
        observer.on_command(&command(
            self.component.time(),
            &mut exchange,
            CommandKind::Request,
        ));
        let reply = self.protocol.handle(&mut self.component, request, observer);
        exchange.status = reply.status();
        exchange.reply.clone_from(&reply.body);
        let ends = reply.ends;
        if request.verb.drives() && reply.error.is_none() {
            self.watch.hear();
            self.shared.orchestrator_lost.store(false, Relaxed);
        }
        // The status is there before the reply, so that who has the reply reads a status that knows of it.
        self.publish_status();
        self.shared.set_busy(None);
        asked.answer(reply);
        observer.on_reply(&command(
            self.component.time(),
            &mut exchange,
            CommandKind::Reply,
        ));
        ends
    }

    /// Whether the server ends because the orchestrator has been silent for too long.
    fn is_lost(&mut self, observer: &mut dyn Observer) -> bool {
        let lost = self.watch.due();
        lost.is_some_and(|lost| self.lose(lost, observer))
    }

    /// The orchestrator is silent: tells so and does what was wished. Whether the server ends.
    fn lose(&mut self, lost: Lost, observer: &mut dyn Observer) -> bool {
        let what = match lost.then {
            WhenLost::Hold => "the component waits as it is",
            WhenLost::Continue => {
                "the component steps by itself at real time until somebody sends pause"
            }
            WhenLost::Terminate => "the component is terminated",
        };
        let silence = lost.after.as_secs_f64();
        let text = format!("orchestrator lost: no request for {silence} s; {what}");
        self.shared.orchestrator_lost.store(true, Relaxed);
        self.warn(&text, observer);
        match lost.then {
            WhenLost::Hold => {}
            WhenLost::Continue => self.protocol.run_freely(1.0),
            WhenLost::Terminate => {
                // Refused only if it has ended or failed already; the server ends in any case.
                let _ = self.component.terminate();
            }
        }
        self.publish_status();
        lost.then == WhenLost::Terminate
    }

    fn free_step(&mut self, observer: &mut dyn Observer) {
        self.shared.set_busy(Some(Busy {
            verb: "run",
            client: String::new(),
            req: String::new(),
        }));
        if let Err(refusal) = self.protocol.free_step(&mut self.component, observer) {
            self.warn(&format!("free running ended: {refusal}"), observer);
        }
        self.publish_status();
        self.shared.set_busy(None);
    }

    fn warn(&self, text: &str, observer: &mut dyn Observer) {
        observer.on_log(self.component.time(), LogLevel::Warning, "bus", text);
    }

    /// `status` has why the log ended, and `out/log` has it once. If nothing may go on without it, so does each refusal from
    /// now on.
    fn tell_trouble(&mut self, observer: &mut dyn Observer) {
        if self.shared.has_log_failure() {
            return;
        }
        if let Some(why) = observer.trouble() {
            self.shared.set_log_failure(Some(why.clone()));
            observer.on_log(self.component.time(), LogLevel::Error, "bus", &why);
            if observer.ends() {
                self.ends = Some(Instant::now() + FAREWELL);
                self.protocol.end(why);
                self.publish_status();
            }
        }
    }

    fn publish_status(&self) {
        self.shared.update(self.protocol.status(&self.component));
    }
}

/// A request as the log has it, before its reply.
fn exchange(request: &Request, body: String) -> Exchange {
    Exchange {
        verb: request.verb.name().to_owned(),
        req: request.req.clone(),
        client: request.client.clone(),
        body,
        status: "",
        reply: String::new(),
    }
}

#[cfg(test)]
mod tests;
