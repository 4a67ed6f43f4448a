//! How one adapter hears what another does, without either knowing the other: `serve --log` plugs a recorder into the
//! bus through [`Observer`].

use super::foxglove::LogLevel;
use super::messages::Command;
use crate::component::{Component, StepReport, ValueReference};

/// Hears all traffic of a component, in the order in which it happens. Calls must return quickly; a failed write is
/// latched by the observer and must not disturb the component.
pub trait Observer: Send {
    /// The component was initialised: `start` [s], and `stop` [s] if one was set.
    fn on_initialize(&mut self, component: &Component, start: f64, stop: Option<f64>, source: &str);

    /// Variables were set (after the component accepted them): flat values as in [`Component::set`].
    fn on_input(
        &mut self,
        component: &Component,
        references: &[ValueReference],
        values: &[f64],
        source: &str,
    );

    /// A step was done from `t` over `h` [s].
    fn on_step(&mut self, component: &Component, report: &StepReport, t: f64, h: f64, source: &str);

    /// A call came in: [`CommandKind::Request`](super::messages::CommandKind::Request).
    fn on_command(&mut self, command: &Command);

    /// A reply went out: [`CommandKind::Reply`](super::messages::CommandKind::Reply).
    fn on_reply(&mut self, reply: &Command);

    /// The component was reset or restored; its time may have gone back.
    fn on_jump(
        &mut self,
        component: &Component,
        event: super::messages::AppliedEvent,
        source: &str,
    );

    /// A line for people.
    fn on_log(&mut self, time: f64, level: LogLevel, name: &str, message: &str);
}
