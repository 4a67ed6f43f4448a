//! Why a server could not be opened or had to end.

use super::endpoints::BadEndpoint;
use crate::component;
use crate::wire::keys::BadInstance;

/// Errors of serving.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BusError {
    /// The instance's name.
    #[error(transparent)]
    Instance(#[from] BadInstance),
    /// An endpoint.
    #[error(transparent)]
    Endpoint(#[from] BadEndpoint),
    /// Zenoh's configuration file.
    #[error("Zenoh configuration {file}: {reason}")]
    Config {
        /// The file.
        file: String,
        /// What is wrong with it.
        reason: String,
    },
    /// Something that Zenoh would not do.
    #[error("{doing}: {reason}")]
    Zenoh {
        /// What was tried.
        doing: String,
        /// Zenoh's words.
        reason: String,
    },
    /// The name is taken.
    #[error(
        "an instance {instance:?} is already served there; choose another name with --instance, or end the other one"
    )]
    Taken {
        /// The name.
        instance: String,
    },
    /// A thread could not be started.
    #[error("cannot start a thread: {0}")]
    Thread(String),
    /// The component could not be brought to its first communication point.
    #[error(transparent)]
    Component(#[from] component::Error),
}
