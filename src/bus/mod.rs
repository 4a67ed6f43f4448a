//! Zenoh: a served component is stepped, set, read and watched by clients on the network.
//!
//! Data flow: query → [`Request`] (typed) → bounded queue → [`Protocol`] on the one [`Component`] → reply; and
//! component → publications → bounded queue → subscribers. `keys`, `request`, `protocol`, `stepping` and `publish` know
//! no network and are tested without one; `serve` is the only folder that names Zenoh. Off unless asked for
//! (`sandgate serve`); what goes where stands in docs/zenoh.md.
//!
//! It does not hold any physics, rule of the lifecycle or list of variables: these are the component's. It does not
//! write logs: whoever serves may listen through [`Observer`](crate::wire::Observer).
//!
//! [`Component`]: crate::component::Component

mod advice;
mod answered;
mod endpoints;
mod error;
mod fields;
mod json;
mod keys;
mod notes;
mod protocol;
mod publish;
mod queue;
mod reach;
mod refusal;
mod reply;
mod request;
mod serve;
mod set_point;
mod status;
mod stepping;
mod tasks;
mod values;
mod verb;
mod watch;

pub use advice::Advice;
pub use answered::REMEMBERED;
pub use endpoints::{BadEndpoint, DEFAULT_LISTEN};
pub use error::BusError;
pub use fields::Given;
pub use keys::Keys;
pub use protocol::Protocol;
pub use reach::Reach;
pub use refusal::{Code, Refusal};
pub use reply::Reply;
pub use request::Request;
pub use serve::{Beside, Leaving, Outlet, ServeOptions, Server, ZenohConfig};
pub use set_point::SetPoint;
pub use status::Status;
pub use verb::Verb;
pub use watch::{Lost, WhenLost};
