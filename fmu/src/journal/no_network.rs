//! Instead of `network` where the library is built without the feature `bus`: there is no session, and a configuration of
//! one is refused when it is set.

use std::collections::BTreeSet;

use sandgate::component::Component;
use sandgate::fmi::library::WITHOUT_ZENOH;
use sandgate::wire::Observer;

/// Closes a session.
pub(super) type Parting = Box<dyn FnOnce() -> Result<(), String>>;

/// A session that cannot be.
pub(super) enum Network {}

impl Network {
    /// Why there is none.
    pub(super) const REFUSAL: Option<&'static str> = Some(WITHOUT_ZENOH);

    pub(super) fn open(_: &Component, _: &str, _: &str) -> Result<Self, String> {
        Err(Self::REFUSAL.unwrap_or_default().to_owned())
    }

    pub(super) fn is_lost(&self) -> bool {
        match *self {}
    }

    pub(super) fn abandon(self) {
        match self {}
    }

    pub(super) fn announcement(&self) -> String {
        match *self {}
    }

    pub(super) fn observer(&mut self) -> &mut dyn Observer {
        match *self {}
    }

    pub(super) fn apply(&mut self, _: &mut Component, _: &BTreeSet<u32>, _: &mut dyn Observer) {
        match *self {}
    }

    pub(super) fn tell_step(&self, _: &str) {
        match *self {}
    }

    pub(super) fn tell_trouble(&self, _: Option<String>) {
        match *self {}
    }

    pub(super) fn tell_notes(&mut self, _: &mut dyn Observer) {
        match *self {}
    }

    pub(super) fn leave(self, _: &mut dyn Observer) -> Parting {
        match self {}
    }
}
