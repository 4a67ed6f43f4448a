//! Fixed parameters: numbers of the scene that may be set until initialisation ends.
//!
//! Setting them only notes the values, so that several calls may change what belongs together (both friction angles,
//! say). The engine is built anew when it is next needed: when initialisation ends, or when an adapter wants outputs
//! before that and calls [`Component::settle`].

use super::access::{RANGE_SLACK, saturated};
use super::engine::{self, Engine};
use super::outputs::{self, FlowMass};
use super::{Component, Error, Life};
use crate::scene::{Scene, SceneErrors};
use crate::units::{shown, shown_bound};

impl Component {
    /// Whether fixed parameters were set for which the engine has not been built yet.
    #[must_use]
    pub fn is_unsettled(&self) -> bool {
        !same_bits(&self.life.parameters, &self.built)
    }

    /// Fixed parameters of the scene that are not what its text says, with their values in SI units.
    pub fn changed_parameters(&self) -> impl Iterator<Item = (&str, f64)> {
        self.changed(&self.life.parameters)
    }

    fn changed<'c>(&'c self, parameters: &'c [f64]) -> impl Iterator<Item = (&'c str, f64)> {
        let all = self.base.adjustables.iter().zip(parameters);
        let changed = all.filter(|(a, value)| a.start.to_bits() != value.to_bits());
        changed.map(|(a, value)| (a.name.as_str(), *value))
    }

    /// Builds the engine anew if fixed parameters were set since it was built, and samples the outputs of the start.
    ///
    /// # Errors
    /// [`Error::BadArgument`] names the rule of scenes that the parameters break together, [`Error::Setup`] if the
    /// scene cannot be built; nothing is changed then.
    pub fn settle(&mut self) -> Result<(), Error> {
        if !self.is_unsettled() {
            let within = self.rates_within(&self.scene)?;
            self.hold_rates(within);
            return Ok(());
        }
        let (scene, engine) = self.build_for(&self.life.parameters)?;
        let within = self.rates_within(&scene)?;
        let before = FlowMass::now(engine.devices());
        let outputs =
            outputs::sample(&self.table, engine.as_ref(), &before, 0.0).map_err(Error::Setup)?;
        self.hold_rates(within);
        self.life.before.clone_from(&outputs);
        self.life.outputs = outputs;
        self.built.clone_from(&self.life.parameters);
        (self.scene, self.engine) = (scene, engine);
        Ok(())
    }

    /// Rates of inflows that this scene of other parameters lets in, and a note for each that `saturate_inputs` let be clamped.
    fn rates_within(&self, scene: &Scene) -> Result<(Vec<f64>, Vec<String>), Error> {
        let mut notes = Vec::new();
        let held = self.life.inputs.inflow_rate.iter().zip(&scene.inflows);
        let rates = held.map(|(ramp, inflow)| {
            let (rate, most) = (ramp.value, inflow.max_rate);
            let what = format!("inflow.{}.rate", inflow.name);
            if rate > most * (1.0 + RANGE_SLACK) && !self.life.saturate_inputs {
                return Err(Error::BadArgument {
                    call: "fixed parameters",
                    what,
                    found: format!("{} kg/s", shown(rate)),
                    allowed: format!(
                        "0 to {} kg/s, density x face x velocity with these parameters",
                        shown_bound(most)
                    ),
                    remedy: "set a lower rate as well".to_owned(),
                });
            }
            if rate > most * (1.0 + RANGE_SLACK) {
                notes.push(saturated(&what, rate, most));
            }
            Ok(rate.min(most))
        });
        Ok((rates.collect::<Result<_, _>>()?, notes))
    }

    fn hold_rates(&mut self, (rates, mut notes): (Vec<f64>, Vec<String>)) {
        for (ramp, rate) in self.life.inputs.inflow_rate.iter_mut().zip(rates) {
            ramp.value = rate;
        }
        self.notes.append(&mut notes);
    }

    /// Scene and engine for these parameters, at the start.
    fn build_for(&self, parameters: &[f64]) -> Result<(Scene, Box<dyn Engine>), Error> {
        let scene = self
            .base
            .adjusted(parameters)
            .map_err(|e| broken_rule(&e, self.changed(parameters)))?;
        let mut engine = engine::build(&scene)?;
        engine.set_threads(self.threads);
        Ok((scene, engine))
    }

    /// Goes to a saved state. `engine` is empty if its parameters waited for their engine.
    pub(super) fn take_over(&mut self, life: Life, engine: &[u8]) -> Result<(), Error> {
        if engine.is_empty() {
            // The engine of the start; `settle` builds the one that is wanted, also where that is the start's: outputs
            // may be those of other parameters.
            let start: Vec<f64> = self.base.adjustables.iter().map(|a| a.start).collect();
            (self.scene, self.engine) = self.build_for(&start)?;
            self.built.clear();
        } else if same_bits(&life.parameters, &self.built) {
            self.engine.restore(engine).map_err(Error::Snapshot)?;
        } else {
            let (scene, mut fresh) = self.build_for(&life.parameters)?;
            fresh.restore(engine).map_err(Error::Snapshot)?;
            self.built.clone_from(&life.parameters);
            (self.scene, self.engine) = (scene, fresh);
        }
        self.life = Life {
            stop: self.life.stop,
            ..life
        };
        self.notes.clear();
        self.kept = None;
        self.step_failed = false;
        Ok(())
    }
}

/// Changed parameters that are told beside a rule that they break.
const MOST_TOLD: usize = 8;

/// The rules that the parameters break together: the first in full, where the others are, and what was `changed`, since who
/// holds an instance cannot mend its scene.
fn broken_rule<'c>(errors: &SceneErrors, changed: impl Iterator<Item = (&'c str, f64)>) -> Error {
    let [first, others @ ..] = errors.problems() else {
        return Error::Setup(errors.to_string());
    };
    let mut remedy = first.remedy.clone();
    if !others.is_empty() {
        let keys: Vec<_> = others.iter().map(|e| e.key.as_str()).collect();
        remedy += &format!("; and {} more, at {}", others.len(), keys.join(", "));
    }
    let mut changed = changed.map(|(name, value)| format!("{name} = {}", shown(value)));
    let told: Vec<String> = changed.by_ref().take(MOST_TOLD).collect();
    if !told.is_empty() {
        let more = match changed.count() {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        remedy += &format!(
            "; these have other values than in the scene: {}{more}",
            told.join(", ")
        );
    }
    Error::BadArgument {
        call: "fixed parameters",
        what: first.key.clone(),
        found: first.found.clone(),
        allowed: first.allowed.clone(),
        remedy,
    }
}

pub(super) fn same_bits(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn broken_rules_say_what_to_do_and_where_the_others_are() {
        // Several rules of one scene.
        let text = include_str!("../../tests/scenes/bad/many_problems.toml");
        let errors = crate::scene::parse("many_problems.toml", text).unwrap_err();
        let [first, others @ ..] = errors.problems() else {
            panic!("{errors}")
        };
        let changed = [("solver.resolution_scale", 0.1)].into_iter();
        let told = broken_rule(&errors, changed).to_string();
        assert!(
            told.ends_with("scene: solver.resolution_scale = 0.1"),
            "{told}"
        );
        for part in [&first.key, &first.found, &first.allowed, &first.remedy] {
            assert!(told.contains(part.as_str()), "{told}");
        }
        assert!(
            told.contains(&format!("; and {} more, at ", others.len())),
            "{told}"
        );
        assert!(others.iter().all(|e| told.contains(&e.key)), "{told}");
    }
}
