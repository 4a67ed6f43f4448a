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

    /// Goes to a saved state; a refused one changes nothing. A required log that begins there and cannot be written is a
    /// refusal, too.
    pub(crate) fn restore(
        &mut self,
        bytes: &[u8],
        experiment: Option<Experiment>,
    ) -> Result<(), Fault> {
        self.journal.asks(&self.component, &Asked::Nothing);
        self.journal.goes_on()?;
        let sound = self.broken.is_none();
        let may_refuse = sound && self.journal.may_refuse(&self.component);
        let before = match may_refuse {
            true => Some(self.component.save()?),
            false => None,
        };
        match sound {
            true => self.component.restore(bytes)?,
            false => self.component.restore_anew(bytes)?,
        }
        let begun = match self.journal.begin_late(&self.component) {
            Ok(begun) => begun,
            Err(fault) => {
                // What broke down waits for another state, as it did.
                if let Some(before) = before {
                    self.component.restore(&before)?;
                }
                return Err(fault);
            }
        };
        self.broken = None;
        if let Some(experiment) = experiment.filter(|_| !self.told_times) {
            self.experiment = experiment;
        }
        self.event(|| format!("state of t = {} s restored", self.component.time()));
        let told = self.journal.restored(&self.component, bytes);
        self.journal.adopt(begun);
        told
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
