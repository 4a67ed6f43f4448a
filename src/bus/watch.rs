//! Whether the one who drives a component is still there, and what happens when it is not.

use std::time::{Duration, Instant};

/// What a component does when its orchestrator has fallen silent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhenLost {
    /// Waits where it is, with its inputs as they are.
    Hold,
    /// Steps by itself at real time, with its inputs as they are, until somebody sends `pause`.
    Continue,
    /// Ends the component and the server.
    Terminate,
}

/// After how long an orchestrator counts as lost, and what then.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lost {
    /// Silence since the last request that changed something.
    pub after: Duration,
    /// What then.
    pub then: WhenLost,
}

/// Watches for requests. Begins with the first one: a component that nobody has driven yet has lost nobody.
#[derive(Clone, Copy, Debug)]
pub(super) struct Watch {
    lost: Option<Lost>,
    heard: Option<Instant>,
}

impl Watch {
    pub(super) fn new(lost: Option<Lost>) -> Self {
        Self { lost, heard: None }
    }

    /// A request that changes something was carried out.
    pub(super) fn hear(&mut self) {
        self.heard = Some(Instant::now());
    }

    /// Counts silence anew from now on, if somebody was there before.
    pub(super) fn excuse(&mut self) {
        if self.heard.is_some() {
            self.hear();
        }
    }

    /// Whether the silence has lasted too long.
    pub(super) fn is_due(&self) -> bool {
        let silent = self.heard.map(|heard| heard.elapsed());
        matches!((self.lost, silent), (Some(lost), Some(silent)) if silent >= lost.after)
    }

    /// What to do now: once for each silence.
    pub(super) fn due(&mut self) -> Option<Lost> {
        if !self.is_due() {
            return None;
        }
        self.heard = None;
        self.lost
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_silence_is_told_once_and_only_after_somebody_spoke() {
        let lost = Lost {
            after: Duration::ZERO,
            then: WhenLost::Hold,
        };
        let mut watch = Watch::new(Some(lost));
        assert_eq!(watch.due(), None);
        watch.hear();
        assert_eq!(watch.due(), Some(lost));
        assert_eq!(watch.due(), None);
        watch.hear();
        assert_eq!(watch.due(), Some(lost));

        let mut long = Watch::new(Some(Lost {
            after: Duration::from_secs(3600),
            ..lost
        }));
        long.hear();
        assert_eq!(long.due(), None);
        let mut never = Watch::new(None);
        never.hear();
        assert_eq!(never.due(), None);
    }
}
