//! FMI 3's intermediate updates: the importer is called from inside a step, and reaches the component meanwhile.

use sandgate::component::{Intermediate, VariableTable, Wish};
use sandgate::units::shown;

use crate::access::Values;
use crate::fault::{Fault, Status};
use crate::guard::{Door, Environment, IntermediateUpdate3, Pause};
use crate::journal::{Journal, Moment};
use crate::log::{Category, Log};

/// FMI 3: what the importer wants to know and do during steps.
#[derive(Clone, Copy)]
pub(crate) struct Updates {
    pub(crate) callback: IntermediateUpdate3,
    pub(crate) environment: Environment,
    /// Whether it wants to set inputs.
    pub(crate) sets_inputs: bool,
    /// Whether a step may end early if it asks.
    pub(crate) early_return_allowed: bool,
}

impl Updates {
    /// Calls the importer after an internal step. `warned` is whether it has been told in this step that a time it gave is
    /// not in it: as a rule it gives the same again after the next internal step, of which there may be hundreds.
    pub(crate) fn tell(
        self,
        moment: &mut Intermediate<'_>,
        log: &Log,
        journal: &mut Journal,
        door: &Door<'_>,
        warned: &mut bool,
    ) -> Wish {
        let pause = Pause {
            time: moment.time(),
            set_requested: self.sets_inputs,
            can_return_early: self.early_return_allowed,
        };
        let mut guest = Guest {
            moment,
            log,
            may_set: self.sets_inputs,
            inputs: Vec::new(),
            is_hurt: false,
        };
        let wanted = door.open(&mut guest, || self.callback.call(self.environment, pause));
        let inputs = guest.inputs;
        let wish = match wanted {
            Some(time) if self.early_return_allowed => {
                let note = outside(time, moment).filter(|_| !*warned);
                if let Some(note) = note {
                    *warned = true;
                    log.say(Category::Warning, Status::Warning, &note);
                    journal.warning(moment.component(), &note);
                }
                Wish::EndAt(time)
            }
            _ => Wish::GoOn,
        };
        let told = Moment {
            time: pause.time,
            inputs,
            wish,
        };
        journal.moment(moment.component(), &told);
        wish
    }
}

/// What to say of a time for an early return that is not in the step.
fn outside(time: f64, moment: &Intermediate<'_>) -> Option<String> {
    let (start, end) = moment.step();
    if (start..=end).contains(&time) {
        return None;
    }
    let ends = if time > end { end } else { moment.time() };
    let [time, start, end, ends] = [time, start, end, ends].map(shown);
    Some(format!(
        "fmi3DoStep: earlyReturnTime: found {time} s, allowed {start} s to {end} s, the step; it ends at {ends} s"
    ))
}

/// What the importer reaches while it is called from inside a step.
pub(crate) struct Guest<'m, 'c> {
    moment: &'m mut Intermediate<'c>,
    log: &'m Log,
    /// What the importer was told: intermediateVariableSetRequested.
    may_set: bool,
    /// Inputs that were set.
    inputs: Vec<(Vec<u32>, Vec<f64>)>,
    /// Whether an access broke down.
    pub(crate) is_hurt: bool,
}

impl Guest<'_, '_> {
    /// Passes the message of a refused access on.
    pub(crate) fn report(&self, call: &str, fault: &Fault) {
        self.log
            .say(Category::Error, Status::Error, &format!("{call}: {fault}"));
    }
}

impl Values for Guest<'_, '_> {
    fn table(&self) -> &VariableTable {
        self.moment.component().variables()
    }

    fn get(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Fault> {
        Ok(self.moment.get(references, values)?)
    }

    fn set(&mut self, references: &[u32], values: &[f64]) -> Result<(), Fault> {
        if !self.may_set {
            return Err(Fault::border(
                "intermediateVariableSetRequested is false: no input is among requiredIntermediateVariables; name one when \
                 instantiating, or set inputs between steps",
            ));
        }
        self.moment.set(references, values)?;
        self.inputs.push((references.to_vec(), values.to_vec()));
        Ok(())
    }

    fn slopes(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), Fault> {
        Ok(self.moment.output_derivatives(references, values)?)
    }
}
