//! The server: a Zenoh session, its callbacks and its threads. The only folder that names `zenoh`.
//!
//! Callbacks only check and hand on to bounded queues. One thread (the caller's) steps the component, one sends
//! replies, one publishes; a subscriber that stands still holds up publications for a moment, never a step or a reply. Every
//! query is answered exactly once, also when a thread panics or the server ends ([`Waiting`]).

mod beside;
mod closing;
mod desk;
mod named_files;
mod outlet;
mod press;
mod replies;
mod session;
mod unsent;
mod wanted;

pub use self::beside::Beside;
pub use self::closing::Leaving;
pub use self::outlet::Outlet;

use self::closing::OpenSession;
use self::desk::{Desk, Entrances};
use self::press::{OWN_QUEUE, Press};
use self::replies::{ended, send_replies};
use super::advice::Advice;
use super::error::{BusError, words};
use super::keys::Keys;
use super::notes::{Notes, WAITING_NOTES};
use super::protocol::Protocol;
use super::publish::{LastValues, Publisher};
use super::queue::queue;
use super::reach::Reach;
use super::status::Shared;
use super::stepping::Stepper;
use super::tasks::{Taker, tasks};
use super::values::Settable;
use super::watch::{Lost, Watch};
use crate::component::Component;
use crate::wire::{Both, Observer};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::sync_channel;
use std::thread::JoinHandle;

/// Replies that may wait to be sent.
const WAITING_REPLIES: usize = 1024;
/// How to serve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ServeOptions {
    /// Name of the instance, 1 to 64 of `a-z 0-9 _ -`.
    pub instance: String,
    /// Endpoints to listen on (`tcp/HOST:PORT`, port 0 for a free one); empty: those of the configuration file; if it has
    /// none, [`DEFAULT_LISTEN`](crate::bus::DEFAULT_LISTEN), or none where it connects to somebody.
    pub listen: Vec<String>,
    /// Endpoints to connect to, besides those of the configuration file.
    pub connect: Vec<String>,
    /// Zenoh's configuration. Scouting and the admin space stay off whatever it says.
    pub config: Option<ZenohConfig>,
    /// Whether other machines may reach a listener.
    pub allow_open_listener: bool,
    /// Simulated over wall time to step by itself (infinite: as fast as possible); none to wait for `step`.
    pub realtime_factor: Option<f64>,
    /// When the one who steps it counts as lost; none: never.
    pub lost: Option<Lost>,
    /// Who reads errors.
    pub advice: Advice,
}

impl ServeOptions {
    /// With the name, and the leave to listen for other machines, that stand in the configuration (`metadata: {sandgate:
    /// {instance: "silo-7", allow_open_listener: true}}`), if they do.
    ///
    /// # Errors
    /// [`BusError::Config`].
    pub fn with_metadata(&self) -> Result<Self, BusError> {
        wanted::named(self)
    }
}

/// Zenoh's own configuration.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ZenohConfig {
    /// In a file (JSON5).
    File(PathBuf),
    /// JSON5 itself.
    Text(String),
}

impl ZenohConfig {
    /// What a parameter says: JSON5 if it has a brace, else the path of a file; none if it is blank.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        match text.trim().is_empty() {
            true => None,
            false if text.contains('{') => Some(Self::Text(text.to_owned())),
            false => Some(Self::File(PathBuf::from(text))),
        }
    }
}

/// An open server.
pub struct Server {
    session: OpenSession,
    reach: Reach,
    component: Component,
    protocol: Protocol,
    publisher: Publisher,
    shared: Arc<Shared>,
    tasks: Taker,
    watch: Watch,
    entrances: Entrances,
    threads: Vec<JoinHandle<()>>,
}

impl Server {
    /// Opens the session, brings the component to its first communication point if it was only built, and lets others
    /// in: their requests wait until [`Server::run`].
    ///
    /// # Errors
    /// [`BusError`]: name, endpoints, configuration file, ports in use, name taken, threads.
    pub fn open(
        mut component: Component,
        options: &ServeOptions,
        observer: &mut dyn Observer,
    ) -> Result<Self, BusError> {
        let keys = Keys::new(&options.instance)?;
        let (session, reach) = session::open(options, Some(&keys))?;
        let (batches, publications) = queue();
        let (jobs, replies) = sync_channel(WAITING_REPLIES);
        let (task_queue, tasks) = tasks(Settable::of(component.variables()));
        let (note_queue, notes) = sync_channel(WAITING_NOTES);
        let protocol = Protocol::new(keys.base(), options.realtime_factor);
        let mut protocol = protocol.with_notes(Notes(notes));
        let last = Arc::new(LastValues::default());
        let particles_wanted = Arc::new(AtomicBool::new(false));
        let shared = Arc::new(Shared::new(protocol.status(&component)));
        let mut publisher = Publisher::new(
            keys.base(),
            &component,
            batches,
            last.clone(),
            particles_wanted.clone(),
            shared.clone(),
        );
        let press = Press::new(session.clone(), &keys, particles_wanted, OWN_QUEUE)?;
        let threads = vec![
            spawn("sandgate-publish", move || press.run(publications))?,
            spawn("sandgate-reply", move || send_replies(&replies, &last))?,
        ];
        protocol.begin(&mut component, &mut Both(observer, &mut publisher), "serve")?;
        shared.update(protocol.status(&component));
        let desk = Desk {
            keys,
            shared: shared.clone(),
            tasks: task_queue,
            notes: note_queue,
            jobs,
            aside: None,
        };
        Ok(Self {
            entrances: Entrances::open(&session, desk)?,
            session,
            reach,
            component,
            protocol,
            publisher,
            shared,
            tasks,
            watch: Watch::new(options.lost),
            threads,
        })
    }

    /// Where clients find it.
    #[must_use]
    pub fn reach(&self) -> &Reach {
        &self.reach
    }

    /// Serves on the calling thread until `stop` is set, until a client sends `terminate`, or until a while after `observer`,
    /// who hears all traffic, could not go on. Gives the component back (its mode says whether it was terminated), and the
    /// session, which is to be closed when nothing more important is left to do.
    pub fn run(mut self, observer: &mut dyn Observer, stop: &AtomicBool) -> (Component, Leaving) {
        let mut stepper = Stepper {
            component: self.component,
            protocol: self.protocol,
            shared: &self.shared,
            tasks: self.tasks,
            watch: self.watch,
            ends: None,
        };
        stepper.run(&mut Both(observer, &mut self.publisher), stop);
        // Nobody gets in any more; who still waits is answered; then the queues of the two threads have no senders left,
        // and they end when they are empty.
        drop(self.entrances);
        let component = stepper.close(&ended(), &mut Both(observer, &mut self.publisher));
        drop(self.publisher);
        for thread in self.threads {
            // A panic there was reported by the thread itself, and who waited was answered.
            let _ = thread.join();
        }
        (component, Leaving(self.session))
    }
}

fn failed<E: std::fmt::Display>(doing: &'static str) -> impl FnOnce(E) -> BusError {
    move |error| BusError::Zenoh {
        doing: doing.to_owned(),
        reason: words(error),
    }
}

fn spawn(name: &str, body: impl FnOnce() + Send + 'static) -> Result<JoinHandle<()>, BusError> {
    std::thread::Builder::new()
        .name(name.to_owned())
        .spawn(body)
        .map_err(|error| BusError::Thread(error.to_string()))
}
