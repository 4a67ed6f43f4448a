//! What errors advise, in the words of who can follow it: somebody at a command line, or the author of a configuration.

/// Who reads errors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Advice {
    /// Who typed a command.
    #[default]
    CommandLine,
    /// Who wrote Zenoh's configuration for an importer or a C program.
    Configuration,
}

impl Advice {
    /// How a listener that other machines can reach is allowed.
    pub(super) fn open_listener(self) -> &'static str {
        match self {
            Self::CommandLine => "say --allow-open-listener",
            Self::Configuration => "add metadata: {sandgate: {allow_open_listener: true}}",
        }
    }

    /// How another name is given.
    pub(super) fn instance(self) -> &'static str {
        match self {
            Self::CommandLine => "with --instance",
            Self::Configuration => "by metadata: {sandgate: {instance: \"NAME\"}}",
        }
    }

    /// How another listener is given.
    pub(super) fn listen(self) -> &'static str {
        match self {
            Self::CommandLine => "with --listen",
            Self::Configuration => "by listen: {endpoints: [\"tcp/127.0.0.1:PORT\"]}",
        }
    }

    /// How somebody to connect to is named.
    pub(super) fn connect(self) -> &'static str {
        match self {
            Self::CommandLine => "by --connect or connect.endpoints",
            Self::Configuration => "by connect: {endpoints: [\"tcp/HOST:PORT\"]}",
        }
    }
}
