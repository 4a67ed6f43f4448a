//! A component built beside one that may have to stay as it is, or that is not to be trusted any more.

use super::{Component, Error};

impl Component {
    /// Another one of the same scene, as this one would be after [`Component::reset`]: for changes that come whole or
    /// not at all. Threads, settings of the host and notes are in no saved state, so that a reset cannot be undone.
    ///
    /// # Errors
    /// [`Error::Setup`].
    pub fn anew(&self) -> Result<Self, Error> {
        let mut fresh = Self::new(&self.base)?;
        fresh.set_threads(self.own_threads);
        Ok(fresh)
    }

    /// As [`Component::restore`], into an engine built for it: a defect may have left the one that is there half changed.
    ///
    /// # Errors
    /// [`Error::Setup`], [`Error::Snapshot`]; the component stays as it was.
    pub fn restore_anew(&mut self, bytes: &[u8]) -> Result<(), Error> {
        let mut fresh = self.anew()?;
        fresh.restore(bytes)?;
        fresh.life.stop = self.life.stop;
        fresh.use_threads(self.threads);
        fresh.host = self.host.clone();
        *self = fresh;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_restored_anew_goes_on_with_the_same_bits_and_its_own_settings() {
        let text = include_str!("../../tests/scenes/small_silo.toml");
        let scene = crate::scene::parse("small_silo.toml", text).unwrap();
        let mut component = Component::new(&scene).unwrap();
        let threads = component.variables().by_name("solver.threads").unwrap();
        let threads = [threads.reference];
        component.set(&threads, &[2.0]).unwrap();
        component.initialize(0.0, Some(1.0)).unwrap();
        component.do_step(0.0, 0.005).unwrap();
        let state = component.save().unwrap();
        component.do_step(0.005, 0.005).unwrap();
        let hash = component.state_hash();

        assert!(component.restore_anew(&state[1..]).is_err());
        assert_eq!(component.state_hash(), hash);
        component.restore_anew(&state).unwrap();
        let mut now = [0.0];
        component.get(&threads, &mut now).unwrap();
        assert_eq!((now[0], component.stop_time()), (2.0, Some(1.0)));
        component.do_step(0.005, 0.005).unwrap();
        assert_eq!(component.state_hash(), hash);
    }
}
