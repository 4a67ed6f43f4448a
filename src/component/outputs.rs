//! Output values, computed once per communication step: reading them later is a copy.

use super::engine::{Devices, Engine};
use super::variables::{Source, VariableTable};
use super::{MassLedger, Statistics};
use crate::gauge::Reading;

/// What output values are computed from.
pub(super) struct Moment<'a> {
    devices: &'a Devices,
    readings: Vec<Reading>,
    ledger: MassLedger,
    statistics: Statistics,
    /// Mass of inflows and outflows, and places of walls, when the step began.
    before: &'a FlowMass,
    /// Length of the last step [s], 0 before the first.
    step: f64,
}

/// What devices have come to: mass that went through each since the start [kg], and where walls are.
#[derive(Clone, Debug, Default)]
pub(super) struct FlowMass {
    inflows: Vec<f64>,
    outflows: Vec<f64>,
    /// Where steered walls are [m or rad].
    positions: Vec<f64>,
}

impl FlowMass {
    /// As it is now.
    pub(super) fn now(devices: &Devices) -> Self {
        Self {
            inflows: devices.inflows.iter().map(|i| i.mass).collect(),
            outflows: devices.outflow_mass.clone(),
            positions: devices.drives.iter().map(|d| d.position).collect(),
        }
    }
}

/// Flat values of all rows that are not elements of another, in order of the table; inputs and time stay 0.
///
/// # Errors
/// Name and value of the first output that is not finite.
pub(super) fn sample(
    table: &VariableTable,
    engine: &dyn Engine,
    before: &FlowMass,
    step: f64,
) -> Result<Vec<f64>, String> {
    let moment = Moment {
        devices: engine.devices(),
        readings: engine.sample(step),
        ledger: engine.ledger(),
        statistics: engine.statistics(),
        before,
        step,
    };
    let mut values = Vec::new();
    for (row, source) in table.with_sources() {
        if row.element_of.is_some() {
            continue;
        }
        for k in 0..row.len() {
            // -0 (a force on a dry wall, say) becomes 0.
            let value = moment.value(*source, k) + 0.0;
            if !value.is_finite() {
                return Err(format!(
                    "output {} is {value}; allowed: finite numbers",
                    row.name
                ));
            }
            values.push(value);
        }
    }
    Ok(values)
}

/// The account of material that output values hold.
pub(super) fn ledger(table: &VariableTable, outputs: &[f64]) -> MassLedger {
    let mut ledger = MassLedger::default();
    for (row, source) in table.with_sources() {
        let place = match source {
            Source::MassInitial => &mut ledger.initial,
            Source::MassInflow => &mut ledger.inflow,
            Source::MassOutflow => &mut ledger.outflow,
            Source::MassPresent => &mut ledger.present,
            _ => continue,
        };
        *place = outputs[table.offset(row)];
    }
    ledger
}

impl Moment<'_> {
    /// The k-th value of a row; 0 for rows that are not outputs.
    fn value(&self, source: Source, k: usize) -> f64 {
        let flag = |yes: bool| if yes { 1.0 } else { 0.0 };
        match source {
            Source::Time
            | Source::Threads
            | Source::SaturateInputs
            | Source::Adjustable(_)
            | Source::GateOpening(_)
            | Source::InflowRate(_)
            | Source::WallDrive(_) => 0.0,
            Source::GateActualOpening(i) => self.devices.gates[i].opening,
            Source::GateBlocked(i) => flag(self.devices.gates[i].blocked),
            Source::InflowActualRate(i) => {
                self.over_step(self.devices.inflows[i].mass - self.before.inflows[i])
            }
            Source::InflowMass(i) => self.devices.inflows[i].mass,
            Source::InflowBlocked(i) => flag(self.devices.inflows[i].blocked),
            Source::OutflowMass(i) => self.devices.outflow_mass[i],
            Source::OutflowRate(i) => {
                self.over_step(self.devices.outflow_mass[i] - self.before.outflows[i])
            }
            Source::WallActualSpeed(i) => {
                let drive = &self.devices.drives[i];
                // It stands as soon as it is there, however far it went in the step.
                if drive.is_told_place {
                    self.over_step(drive.position - self.before.positions[i])
                } else {
                    drive.speed
                }
            }
            Source::WallActualPosition(i) => self.devices.drives[i].position,
            Source::Reading { gauge, first } => self.readings[gauge].values[first + k],
            Source::Validity(gauge) => f64::from(self.readings[gauge].validity.code()),
            Source::MassInitial => self.ledger.initial,
            Source::MassInflow => self.ledger.inflow,
            Source::MassOutflow => self.ledger.outflow,
            Source::MassPresent => self.ledger.present,
            Source::MassError => self.ledger.error(),
            // Exact up to 2^53.
            Source::Steps => self.statistics.steps as f64,
            Source::Iterations => self.statistics.iterations as f64,
            Source::StepSize => self.statistics.step_size,
            Source::Particles => self.statistics.particles as f64,
            Source::KineticEnergy => self.statistics.kinetic_energy,
            Source::ShareDilute => self.statistics.share_dilute,
            Source::ShareIllPosed => self.statistics.share_ill_posed,
            Source::CreepRate => self.statistics.creep_rate,
            Source::ShareFast => self.statistics.share_fast,
            Source::ShareSqueezed => self.statistics.share_squeezed,
        }
    }

    /// Change in a second of what changed by so much in the step.
    fn over_step(&self, change: f64) -> f64 {
        if self.step > 0.0 {
            change / self.step
        } else {
            0.0
        }
    }
}
