//! Saved states that the importer keeps a pointer to (`fmi2FMUstate`, `fmi3FMUState`).

use std::ptr;

use crate::fault::Fault;
use crate::instance::Experiment;

/// What a state pointer points to.
#[derive(Clone, Debug, Default)]
pub(crate) struct SavedState {
    /// As `Component::save` gives them.
    pub(crate) bytes: Vec<u8>,
    /// FMI 2: what setupExperiment said, for an instance that was told no times; `None` for a state that came as bytes.
    pub(crate) experiment: Option<Experiment>,
}

impl SavedState {
    /// The bytes, for a caller that has room for `size`.
    pub(crate) fn sized(&self, size: usize) -> Result<&[u8], Fault> {
        if size == self.bytes.len() {
            return Ok(&self.bytes);
        }
        Err(Fault::border(format!(
            "found room for {size} bytes, the state has {}",
            self.bytes.len()
        )))
    }
}

/// A state pointer passed by value.
#[repr(transparent)]
pub(crate) struct StateHandle(*const SavedState);

impl StateHandle {
    /// The state.
    pub(crate) fn get(&self) -> Result<&SavedState, Fault> {
        // SAFETY: the importer promises NULL or a pointer that a StateSlot gave it and that it has not freed.
        unsafe { self.0.as_ref() }
            .ok_or_else(|| Fault::border("state: found NULL, expected a state that was got before"))
    }
}

/// A pointer to the importer's state pointer.
#[repr(transparent)]
pub(crate) struct StateSlot(*mut *mut SavedState);

impl StateSlot {
    /// Puts a state in. A slot that holds one already is used again, as the standards ask.
    pub(crate) fn put(&mut self, state: SavedState) -> Result<(), Fault> {
        let slot = self.slot()?;
        // SAFETY: the importer promises NULL or a pointer that this function gave it and that it has not freed.
        match unsafe { slot.as_mut() } {
            Some(old) => *old = state,
            None => *slot = Box::into_raw(Box::new(state)),
        }
        Ok(())
    }

    /// Frees the state and leaves NULL. NULL, or a slot with NULL inside, is fine.
    pub(crate) fn free(&mut self) {
        if let Ok(slot) = self.slot()
            && !slot.is_null()
        {
            // SAFETY: not NULL, so `put` made it with Box::into_raw, and it is replaced by NULL: freed only once.
            drop(unsafe { Box::from_raw(*slot) });
            *slot = ptr::null_mut();
        }
    }

    fn slot(&mut self) -> Result<&mut *mut SavedState, Fault> {
        // SAFETY: the importer promises NULL or a place for a pointer, for the time of the call.
        unsafe { self.0.as_mut() }
            .ok_or_else(|| Fault::border("state: found NULL, expected a place for a state pointer"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slot_is_used_again_and_freed_once() {
        let mut place: *mut SavedState = ptr::null_mut();
        let mut slot = StateSlot(&raw mut place);
        let state = |byte| SavedState {
            bytes: vec![byte],
            experiment: None,
        };
        slot.put(state(1)).expect("a place");
        let first = place;
        slot.put(state(2)).expect("a place");
        assert_eq!(first, place);
        assert_eq!(StateHandle(place).get().expect("a state").bytes, [2]);
        slot.free();
        assert!(place.is_null());
        slot.free();
        assert!(StateHandle(place).get().is_err());
        assert!(StateSlot(ptr::null_mut()).put(state(1)).is_err());
        StateSlot(ptr::null_mut()).free();
    }
}
