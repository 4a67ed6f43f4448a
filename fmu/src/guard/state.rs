//! Saved states that the importer keeps a pointer to (`fmi2FMUstate`, `fmi3FMUState`).

use std::collections::BTreeSet;
use std::ptr;
use std::sync::{Mutex, MutexGuard, PoisonError};

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

/// Addresses of all states that were got and not freed. Importers free twice, or use what they have freed; that is an error and not
/// the end of their process.
static LIVE: Mutex<BTreeSet<usize>> = Mutex::new(BTreeSet::new());

fn live() -> MutexGuard<'static, BTreeSet<usize>> {
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

fn is_live(state: *const SavedState) -> bool {
    live().contains(&state.addr())
}

/// A state pointer passed by value.
#[repr(transparent)]
pub(crate) struct StateHandle(*const SavedState);

impl StateHandle {
    /// The state.
    pub(crate) fn get(&self) -> Result<&SavedState, Fault> {
        let found = if self.0.is_null() {
            "NULL"
        } else if is_live(self.0) {
            // SAFETY: a StateSlot gave it out, and it has not been freed.
            return Ok(unsafe { &*self.0 });
        } else {
            "a pointer to none, or to one that was freed"
        };
        Err(Fault::border(format!(
            "state: found {found}, expected a state that was got before"
        )))
    }
}

/// A pointer to the importer's state pointer.
#[repr(transparent)]
pub(crate) struct StateSlot(*mut *mut SavedState);

impl StateSlot {
    /// Puts a state in. A slot that holds one already is used again, as the standards ask.
    pub(crate) fn put(&mut self, state: SavedState) -> Result<(), Fault> {
        let slot = self.slot()?;
        if is_live(*slot) {
            // SAFETY: this function gave it out, and it has not been freed.
            unsafe { **slot = state };
        } else {
            *slot = Box::into_raw(Box::new(state));
            live().insert(slot.addr());
        }
        Ok(())
    }

    /// Frees the state and leaves NULL. NULL, or a slot with NULL inside, is fine.
    pub(crate) fn free(&mut self) -> Result<(), Fault> {
        let Ok(slot) = self.slot() else {
            return Ok(());
        };
        let state = std::mem::replace(slot, ptr::null_mut());
        if state.is_null() {
            return Ok(());
        }
        if !live().remove(&state.addr()) {
            return Err(Fault::border(
                "state: found a pointer to none, or to one that was freed before",
            ));
        }
        // SAFETY: `put` made it with Box::into_raw, and it is live no more: freed only once.
        drop(unsafe { Box::from_raw(state) });
        Ok(())
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
        let copy = place;
        slot.free().expect("it is live");
        assert!(place.is_null());
        slot.free().expect("NULL is fine");
        assert!(StateHandle(place).get().is_err());
        // What the importer kept of it.
        let said = StateHandle(copy).get().expect_err("freed").to_string();
        assert!(said.contains("freed"), "{said}");
        let mut kept = copy;
        let twice = StateSlot(&raw mut kept).free().expect_err("freed");
        assert!(twice.to_string().contains("freed before"), "{twice}");
        kept = copy;
        StateSlot(&raw mut kept).put(state(3)).expect("a new one");
        assert_eq!(StateHandle(kept).get().expect("a state").bytes, [3]);
        StateSlot(&raw mut kept).free().expect("it is live");
        assert!(StateSlot(ptr::null_mut()).put(state(1)).is_err());
        StateSlot(ptr::null_mut()).free().expect("NULL is fine");
    }
}
