//! How one adapter hears what another does, without either knowing the other: `serve --log` plugs a recorder into the
//! bus through [`Observer`].

use super::Moment;
use super::foxglove::LogLevel;
use super::messages::{AppliedEvent, Command};
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

    /// Inputs were given slopes for the next step, one each, as in [`Component::set_input_derivatives`].
    fn on_slopes(&mut self, _: &Component, _: &[ValueReference], _: &[f64], _: &str) {}

    /// Inside the step that is running inputs were set, or it was told to end early.
    fn on_moment(&mut self, _: &Component, _: &Moment, _: &str) {}

    /// The step that was running did not come to its end.
    fn on_failed_step(&mut self) {}

    /// The state was saved, as this one would: `state` is its checksum.
    fn on_save(&mut self, _: &Component, _: &[u8; 32], _: &str) {}

    /// The component was brought back to a state with this checksum. Whoever does not know the state takes it for a
    /// jump.
    fn on_restore(&mut self, component: &Component, _: &[u8; 32], source: &str) {
        self.on_jump(component, AppliedEvent::Restore, source);
    }

    /// A step was done from `t` over `h` [s].
    fn on_step(&mut self, component: &Component, report: &StepReport, t: f64, h: f64, source: &str);

    /// A call came in: [`CommandKind::Request`](super::messages::CommandKind::Request).
    fn on_command(&mut self, command: &Command);

    /// A reply went out: [`CommandKind::Reply`](super::messages::CommandKind::Reply).
    fn on_reply(&mut self, reply: &Command);

    /// The component was reset or restored; its time may have gone back.
    fn on_jump(&mut self, component: &Component, event: AppliedEvent, source: &str);

    /// A line for people.
    fn on_log(&mut self, time: f64, level: LogLevel, name: &str, message: &str);

    /// Why it cannot keep what it hears any more, if so.
    fn trouble(&self) -> Option<String> {
        None
    }

    /// Whether nothing may go on because of that trouble.
    fn ends(&self) -> bool {
        false
    }
}

/// Two observers as one; the first one hears everything first.
pub struct Both<'a>(pub &'a mut dyn Observer, pub &'a mut dyn Observer);

impl Observer for Both<'_> {
    fn on_initialize(&mut self, c: &Component, start: f64, stop: Option<f64>, source: &str) {
        self.0.on_initialize(c, start, stop, source);
        self.1.on_initialize(c, start, stop, source);
    }
    fn on_input(
        &mut self,
        c: &Component,
        references: &[ValueReference],
        values: &[f64],
        source: &str,
    ) {
        self.0.on_input(c, references, values, source);
        self.1.on_input(c, references, values, source);
    }
    fn on_slopes(&mut self, c: &Component, inputs: &[ValueReference], slopes: &[f64], who: &str) {
        self.0.on_slopes(c, inputs, slopes, who);
        self.1.on_slopes(c, inputs, slopes, who);
    }
    fn on_moment(&mut self, c: &Component, moment: &Moment, source: &str) {
        self.0.on_moment(c, moment, source);
        self.1.on_moment(c, moment, source);
    }
    fn on_failed_step(&mut self) {
        self.0.on_failed_step();
        self.1.on_failed_step();
    }
    fn on_save(&mut self, c: &Component, state: &[u8; 32], source: &str) {
        self.0.on_save(c, state, source);
        self.1.on_save(c, state, source);
    }
    fn on_restore(&mut self, c: &Component, state: &[u8; 32], source: &str) {
        self.0.on_restore(c, state, source);
        self.1.on_restore(c, state, source);
    }
    fn on_step(&mut self, c: &Component, report: &StepReport, t: f64, h: f64, source: &str) {
        self.0.on_step(c, report, t, h, source);
        self.1.on_step(c, report, t, h, source);
    }
    fn on_command(&mut self, command: &Command) {
        self.0.on_command(command);
        self.1.on_command(command);
    }
    fn on_reply(&mut self, reply: &Command) {
        self.0.on_reply(reply);
        self.1.on_reply(reply);
    }
    fn on_jump(&mut self, c: &Component, event: AppliedEvent, source: &str) {
        self.0.on_jump(c, event, source);
        self.1.on_jump(c, event, source);
    }
    fn on_log(&mut self, time: f64, level: LogLevel, name: &str, message: &str) {
        self.0.on_log(time, level, name, message);
        self.1.on_log(time, level, name, message);
    }
    fn trouble(&self) -> Option<String> {
        self.0.trouble().or_else(|| self.1.trouble())
    }
    fn ends(&self) -> bool {
        self.0.ends() || self.1.ends()
    }
}

/// Hears nothing: for serving without a log.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {
    fn on_initialize(&mut self, _: &Component, _: f64, _: Option<f64>, _: &str) {}
    fn on_input(&mut self, _: &Component, _: &[ValueReference], _: &[f64], _: &str) {}
    fn on_step(&mut self, _: &Component, _: &StepReport, _: f64, _: f64, _: &str) {}
    fn on_command(&mut self, _: &Command) {}
    fn on_reply(&mut self, _: &Command) {}
    fn on_jump(&mut self, _: &Component, _: AppliedEvent, _: &str) {}
    fn on_log(&mut self, _: f64, _: LogLevel, _: &str, _: &str) {}
}
