//! What waits for the stepping thread: tasks for the component.

use super::reply::Reply;
use super::request::Request;
use super::set_point::SetPoint;

/// Tasks that may wait for the stepping thread.
pub(super) const WAITING_TASKS: usize = 256;
/// How many of these may be set-points, so that a flood of them leaves room for requests.
pub(super) const WAITING_SET_POINTS: usize = 192;

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
