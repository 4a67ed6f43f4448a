//! Pressure gauges: which pressure there is in what they see.

use super::Lift;
use crate::scene::raw::{QuantityWord, RawMaterial, RawPressure};
use crate::scene::types::PressureQuantity;

impl Lift<'_> {
    /// Which pressure; that of pores only where a material that is seen has some or is a fluid, that of grains only where
    /// there are some.
    pub(super) fn quantity(&mut self, raw: &RawPressure) -> Option<PressureQuantity> {
        let at = raw.quantity.as_ref()?;
        let (found, allowed, remedy) = match at.value {
            QuantityWord::Total => return Some(PressureQuantity::Total),
            QuantityWord::Effective if self.some_seen_is(raw, has_grains) => {
                return Some(PressureQuantity::Effective);
            }
            QuantityWord::Pore if self.some_seen_is(raw, is_wet) => {
                return Some(PressureQuantity::Pore);
            }
            QuantityWord::Effective => match &raw.material {
                None => (
                    "\"effective\" where all materials are fluids: no grain presses on grain"
                        .to_owned(),
                    "\"total\" or \"pore\"",
                    "choose another quantity",
                ),
                Some(name) => (
                    format!(
                        "\"effective\" of {}, which is a fluid: no grain presses on grain",
                        name.value.0
                    ),
                    "\"total\" or \"pore\", or a material with friction",
                    "choose another quantity or material, or leave material out",
                ),
            },
            QuantityWord::Pore => match &raw.material {
                None => (
                    "\"pore\" where no material is a fluid or saturated".to_owned(),
                    "\"total\" or \"effective\", or a material with pore_fluid",
                    "choose another quantity, or add pore_fluid to a material",
                ),
                Some(name) => (
                    format!(
                        "\"pore\" of {}, which is neither a fluid nor saturated",
                        name.value.0
                    ),
                    "\"total\" or \"effective\", or a material with pore_fluid",
                    "choose another quantity or material, or add pore_fluid",
                ),
            },
        };
        self.problems.report(&at.place, found, allowed, remedy);
        None
    }

    /// Whether a material that the gauge sees is such; a material that could not be read, or is unknown, may be anything:
    /// that has been reported.
    fn some_seen_is(&self, gauge: &RawPressure, such: fn(&RawMaterial) -> bool) -> bool {
        let Some(materials) = &self.raw.materials else {
            return true;
        };
        if gauge.material.is_none() && gauge.given.contains(&"material") {
            return true;
        }
        let name = gauge.material.as_ref().map(|name| &name.value.0);
        let entries = materials.value.0.iter();
        let mut seen = entries
            .filter(|entry| name.is_none_or(|name| *name == entry.name))
            .peekable();
        seen.peek().is_none() || seen.any(|entry| entry.value.as_ref().is_none_or(such))
    }
}

/// Whether a fluid fills it or its pores.
fn is_wet(raw: &RawMaterial) -> bool {
    match raw {
        RawMaterial::Fluid(_) => true,
        // A pore fluid that could not be read is one.
        RawMaterial::MuI(raw) => raw.given.contains(&"pore_fluid"),
        RawMaterial::BarkerGray(raw) => raw.given.contains(&"pore_fluid"),
        RawMaterial::ConstantFriction(raw) => raw.given.contains(&"pore_fluid"),
    }
}

/// Whether grain presses on grain.
fn has_grains(raw: &RawMaterial) -> bool {
    !matches!(raw, RawMaterial::Fluid(_))
}
