//! The importer's logger: which categories are on, and text made ready for it.

use std::ffi::{CStr, CString};

use sandgate::fmi::LOG_CATEGORIES;

use crate::fault::{Fault, Status};
use crate::guard::{Callbacks2, Environment, Logger3, PlainLogger};

/// Place in [`LOG_CATEGORIES`].
#[derive(Clone, Copy)]
pub(crate) enum Category {
    /// Refused and failed calls.
    Error = 0,
    /// What was taken, but not as it was asked for.
    Warning = 1,
    /// What happens.
    Event = 2,
}

/// Whom to tell.
#[derive(Clone)]
pub(crate) enum Sink {
    /// Nobody: the text of the last error can still be asked for through the plain C interface.
    Nobody,
    /// The plain C interface, once it was given a logger.
    Plain(PlainLogger, Environment),
    /// FMI 2 with the instance's name.
    Fmi2(Callbacks2, CString),
    /// FMI 3.
    Fmi3(Logger3, Environment),
}

/// The logger of one instance.
#[derive(Clone)]
pub(crate) struct Log {
    sink: Sink,
    on: [bool; LOG_CATEGORIES.len()],
}

impl Log {
    /// All categories, or none.
    pub(crate) fn new(sink: Sink, on: bool) -> Self {
        Self {
            sink,
            on: [on; LOG_CATEGORIES.len()],
        }
    }

    /// Switches categories; no names mean all of them, as does `logAll`, the last one. In FMI 2 (2.0.5, section 2.1.5) those that are not named
    /// go off, and all do where `on` is false; FMI 3 leaves them as they are. Unknown names are refused and nothing changes.
    pub(crate) fn switch(&mut self, on: bool, names: &[&str]) -> Result<(), Fault> {
        let mut wanted = match self.sink {
            Sink::Fmi2(..) => [false; LOG_CATEGORIES.len()],
            _ => self.on,
        };
        if names.is_empty() {
            wanted = [on; LOG_CATEGORIES.len()];
        }
        for name in names {
            let known = LOG_CATEGORIES.iter().position(|(known, _)| known == name);
            let Some(place) = known else {
                let all: Vec<_> = LOG_CATEGORIES.iter().map(|(name, _)| *name).collect();
                return Err(Fault::border(format!(
                    "log category: found {name}, allowed {}",
                    all.join(", ")
                )));
            };
            if place + 1 == LOG_CATEGORIES.len() {
                wanted = [on; LOG_CATEGORIES.len()];
            }
            wanted[place] = on;
        }
        self.on = wanted;
        Ok(())
    }

    /// Whether a message of this category would be passed on.
    pub(crate) fn wants(&self, category: Category) -> bool {
        self.on[category as usize] && !matches!(self.sink, Sink::Nobody)
    }

    /// Passes a message on, if its category is on.
    pub(crate) fn say(&self, category: Category, status: Status, message: &str) {
        if !self.wants(category) {
            return;
        }
        let name = text(LOG_CATEGORIES[category as usize].0);
        match &self.sink {
            Sink::Nobody => {}
            Sink::Plain(logger, user) => logger.call(*user, &name, &text(message)),
            // FMI takes `#` for the mark of a value reference, FMI 2 the message for a format as well: without further arguments,
            // only these have to be doubled.
            Sink::Fmi2(callbacks, instance) => callbacks.logger.call(
                callbacks.environment,
                instance,
                status,
                &name,
                &text(&message.replace('#', "##").replace('%', "%%")),
            ),
            Sink::Fmi3(logger, environment) => {
                let message = text(&message.replace('#', "##"));
                logger.call(*environment, status, &name, &message);
            }
        }
    }
}

/// Text for C; a zero byte inside becomes a visible sign.
pub(crate) fn text(text: &str) -> CString {
    CString::new(text.replace('\0', "\u{2400}"))
        .unwrap_or_else(|_| CStr::to_owned(c"(text with a zero byte)"))
}
