//! States of an instance: taken, gone back to, checked.

use super::{Experiment, Instance};
use crate::asked::Asked;
use crate::fault::Fault;
use crate::guard::SavedState;

impl Instance {
    /// Everything, as bytes.
    pub(crate) fn save(&mut self) -> Result<SavedState, Fault> {
        self.save_if(|_| Ok(()))
    }

    /// As `save`, if the caller has room for so many bytes: a state that nobody gets is in no log.
    pub(crate) fn save_if(
        &mut self,
        fits: impl FnOnce(usize) -> Result<(), Fault>,
    ) -> Result<SavedState, Fault> {
        self.journal.asks(&self.component, &Asked::Nothing);
        let bytes = self.component.save()?;
        fits(bytes.len())?;
        self.journal.saved(&self.component, &bytes);
        Ok(SavedState {
            bytes,
            experiment: Some(self.experiment),
        })
    }

    /// Goes to a saved state; a refused one changes nothing, nor does one behind a required log that has failed.
    pub(crate) fn restore(
        &mut self,
        bytes: &[u8],
        experiment: Option<Experiment>,
    ) -> Result<(), Fault> {
        self.journal.asks(&self.component, &Asked::Nothing);
        self.journal.goes_on()?;
        if self.broken.is_some() {
            self.component.restore_anew(bytes)?;
            self.broken = None;
        } else {
            self.component.restore(bytes)?;
        }
        if let Some(experiment) = experiment {
            self.experiment = experiment;
        }
        self.event(|| format!("state of t = {} s restored", self.component.time()));
        self.journal.restored(&self.component, bytes)
    }

    /// Bytes as a state, if this instance could go to it: a bad blob is refused here, not when it is set.
    pub(crate) fn deserialize(&self, bytes: &[u8]) -> Result<SavedState, Fault> {
        self.component.check_saved(bytes)?;
        Ok(SavedState {
            bytes: bytes.to_vec(),
            experiment: None,
        })
    }
}
