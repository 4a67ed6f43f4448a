//! Parameters for the component's host: where it logs and whether it publishes. They stand in the one table, so that FMI and
//! C have them, but the component itself does nothing with them: no bit depends on them, and states do not carry them.

use super::access::bad;
use super::lifecycle::{self, Call};
use super::variables::ValueKind;
use super::variables::host::{LOG_PATH, LOG_REQUIRED, ZENOH_CONFIG};
use super::{Component, Error, ValueReference};
use crate::scene::Scene;

/// What the host of a component is asked to do beside stepping it. Fixed once the component is initialised; a reset
/// goes back to the start values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HostSettings {
    /// `log.path`: file of the MCAP log, "" for none.
    pub log_path: String,
    /// `log.required`: whether a log that cannot be written is an error of the step; otherwise it is told once.
    pub log_required: bool,
    /// `zenoh.config`: Zenoh's configuration, a path or JSON5; blank for no Zenoh.
    pub zenoh_config: String,
}

impl HostSettings {
    /// Those at the start.
    pub(super) fn of(scene: &Scene) -> Self {
        Self {
            log_path: String::new(),
            log_required: scene.log.required,
            zenoh_config: String::new(),
        }
    }

    /// Whether a log is asked for: a blank path is none.
    #[must_use]
    pub fn logs(&self) -> bool {
        !self.log_path.trim().is_empty()
    }

    /// Whether Zenoh is asked for: a blank configuration is none.
    #[must_use]
    pub fn publishes(&self) -> bool {
        !self.zenoh_config.trim().is_empty()
    }
}

impl Component {
    /// What its host is asked to do.
    #[must_use]
    pub fn host_settings(&self) -> &HostSettings {
        &self.host
    }

    /// Sets texts, all or none. Allowed until initialisation ends.
    ///
    /// # Errors
    /// [`Error::BadArgument`]: unknown reference, a variable that is no text, another number of texts;
    /// [`Error::NotAllowedNow`]. Nothing is changed then.
    pub fn set_texts(
        &mut self,
        references: &[ValueReference],
        texts: &[&str],
    ) -> Result<(), Error> {
        const CALL: &str = "set";
        self.check_texts(CALL, references, texts.len())?;
        for reference in references {
            lifecycle::check(Call::SetFixed, self.mode())
                .map_err(|error| error.about(self.name_of(*reference)))?;
        }
        for (reference, text) in references.iter().zip(texts) {
            match self.name_of(*reference) {
                LOG_PATH => self.host.log_path = (*text).to_owned(),
                ZENOH_CONFIG => self.host.zenoh_config = (*text).to_owned(),
                _ => {}
            }
        }
        Ok(())
    }

    /// Reads texts.
    ///
    /// # Errors
    /// [`Error::BadArgument`]: unknown reference, a variable that is no text.
    pub fn texts(&self, references: &[ValueReference]) -> Result<Vec<&str>, Error> {
        self.check_texts("get", references, references.len())?;
        let text = |reference: &ValueReference| match self.name_of(*reference) {
            LOG_PATH => self.host.log_path.as_str(),
            ZENOH_CONFIG => self.host.zenoh_config.as_str(),
            _ => "",
        };
        Ok(references.iter().map(text).collect())
    }

    /// Takes a number that is for the host; others are not looked at.
    pub(super) fn set_for_host(&mut self, reference: ValueReference, value: f64) {
        if self.name_of(reference) == LOG_REQUIRED {
            self.host.log_required = value != 0.0;
        }
    }

    /// The number of a row for the host.
    pub(super) fn number_for_host(&self, reference: ValueReference) -> f64 {
        match self.name_of(reference) {
            LOG_REQUIRED => f64::from(self.host.log_required),
            _ => 0.0,
        }
    }

    fn name_of(&self, reference: ValueReference) -> &str {
        let row = self.table.by_reference(reference);
        row.map_or("", |row| row.name.as_str())
    }

    fn check_texts(
        &self,
        call: &'static str,
        references: &[ValueReference],
        found: usize,
    ) -> Result<(), Error> {
        for row in self.rows(call, references)? {
            if row.kind != ValueKind::Text {
                return Err(bad(call, &row.name, "a number", "variables that are texts"));
            }
        }
        if references.len() == found {
            return Ok(());
        }
        Err(bad(
            call,
            "number of texts",
            &found.to_string(),
            &format!("{}, one each reference", references.len()),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn silo() -> Component {
        let text = include_str!("../../tests/scenes/small_silo.toml");
        let scene = crate::scene::parse("small_silo.toml", text).unwrap();
        Component::new(&scene).unwrap()
    }

    #[test]
    fn the_checksum_of_a_state_is_that_of_all_its_other_bytes() {
        use sha2::{Digest, Sha256};

        let state = silo().save().unwrap();
        let sum = super::super::saved_checksum(&state).unwrap();
        let others = [&state[..52], &state[84..]].concat();
        assert_eq!(sum, <[u8; 32]>::from(Sha256::digest(others)));
        assert_eq!(super::super::saved_checksum(&state[..83]), None);
    }

    #[test]
    fn the_hosts_parameters_change_no_state_and_are_fixed_after_the_start() {
        let (mut silo, plain) = (silo(), silo());
        let reference = |name: &str| plain.variables().by_name(name).unwrap().reference;
        let [path, zenoh, required] = ["log.path", "zenoh.config", "log.required"].map(reference);
        assert_eq!(silo.texts(&[path, zenoh]).unwrap(), ["", ""]);
        silo.set_texts(&[path, zenoh], &["a.mcap", "{}"]).unwrap();
        silo.set(&[required], &[0.0]).unwrap();
        assert_eq!(silo.texts(&[zenoh, path]).unwrap(), ["{}", "a.mcap"]);
        assert!(!silo.host_settings().log_required);
        assert_eq!(silo.save().unwrap(), plain.save().unwrap());
        // A state does not bring other settings along.
        silo.restore(&plain.save().unwrap()).unwrap();
        assert_eq!(silo.host_settings().log_path, "a.mcap");

        for refused in [
            silo.set_texts(&[path, required], &["b", "c"]),
            silo.set_texts(&[path, 9999], &["b", "c"]),
            silo.set_texts(&[path], &["b", "c"]),
            silo.set(&[path], &[1.0]),
            silo.get(&[path], &mut [0.0]),
        ] {
            let message = refused.unwrap_err().to_string();
            assert!(
                message.contains("found") && message.contains("allowed"),
                "{message}"
            );
        }
        assert_eq!(silo.texts(&[path]).unwrap(), ["a.mcap"]);
        silo.initialize(0.0, None).unwrap();
        let late = silo.set_texts(&[path], &["b.mcap"]).unwrap_err();
        assert!(matches!(late, Error::NotAllowedNow { .. }));
        silo.reset().unwrap();
        assert_eq!(silo.host_settings(), plain.host_settings());
    }
}
