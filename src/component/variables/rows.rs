//! The list: which variables each kind of device brings, with units, ranges and words. Those of devices and gauges stand in `devices` and `gauges`.
//!
//! To add a variable: one row here, its [`Source`], and the value in `component::outputs`. References count from
//! 0 in the order of this list: time, parameters, inputs, devices, gauges, totals.

use super::{Causality, Start, ValueKind, Variability, Variable, VariableTable, devices, gauges};
use crate::component::Component;
use crate::scene::{Adjustable, Scene};

/// Where a row's value comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::component) enum Source {
    Time,
    Threads,
    SaturateInputs,
    /// A number of the scene, by place in `Scene::adjustables`.
    Adjustable(usize),
    /// Inputs, by index of the device.
    GateOpening(usize),
    InflowRate(usize),
    WallDrive(usize),
    /// Devices, by index.
    GateActualOpening(usize),
    GateBlocked(usize),
    InflowActualRate(usize),
    InflowMass(usize),
    InflowBlocked(usize),
    OutflowMass(usize),
    OutflowRate(usize),
    WallActualSpeed(usize),
    WallActualPosition(usize),
    /// Values of a gauge's reading from the given one on, as many as the row has.
    Reading {
        gauge: usize,
        first: usize,
    },
    Validity(usize),
    MassInitial,
    MassInflow,
    MassOutflow,
    MassPresent,
    MassError,
    Steps,
    Iterations,
    StepSize,
    Particles,
    KineticEnergy,
    ShareDilute,
    ShareIllPosed,
    CreepRate,
    ShareFast,
    ShareSqueezed,
}

/// A row before it has its number.
pub(super) struct Row {
    pub(super) variable: Variable,
    pub(super) source: Source,
}

impl Row {
    /// A real output.
    pub(super) fn output(
        name: impl Into<String>,
        unit: &'static str,
        source: Source,
        text: impl Into<String>,
    ) -> Self {
        let variable = Variable {
            reference: 0,
            name: name.into(),
            description: text.into(),
            causality: Causality::Output,
            variability: Variability::Continuous,
            kind: ValueKind::Real,
            unit,
            display_unit: None,
            shape: Vec::new(),
            start: Start::Calculated,
            range: None,
            element_of: None,
        };
        Self { variable, source }
    }

    /// A real input with its start value and its range.
    pub(super) fn input(
        name: String,
        unit: &'static str,
        source: Source,
        start: f64,
        (least, most): (f64, f64),
        text: String,
    ) -> Self {
        let mut row = Self::output(name, unit, source, text);
        row.variable.causality = Causality::Input;
        row.variable.start = Start::Exact(vec![start]);
        row.within(least, most)
    }

    /// Of this kind, and so changing by jumps.
    pub(super) fn kind(mut self, kind: ValueKind) -> Self {
        self.variable.kind = kind;
        self.variable.variability = Variability::Discrete;
        self
    }

    /// With the unit people like to see.
    pub(super) fn display(mut self, unit: Option<(&'static str, f64)>) -> Self {
        self.variable.display_unit = unit;
        self
    }

    /// With its smallest and largest value.
    pub(super) fn within(mut self, least: f64, most: f64) -> Self {
        self.variable.range = Some((least, most));
        self
    }
}

/// The table of a scene.
pub(super) fn list(scene: &Scene) -> VariableTable {
    let mut table = VariableTable::default();
    let mut add = |row: Row| {
        let mut variable = row.variable;
        variable.reference = table.rows.len() as u32;
        table.rows.push(variable);
        table.sources.push(row.source);
    };
    general().for_each(&mut add);
    for (i, number) in scene.adjustables.iter().enumerate() {
        add(parameter_row(i, number));
    }
    for (i, gate) in scene.gates.iter().enumerate() {
        devices::gate(i, gate).for_each(&mut add);
    }
    for (i, inflow) in scene.inflows.iter().enumerate() {
        devices::inflow(i, inflow).for_each(&mut add);
    }
    for (i, outflow) in scene.outflows.iter().enumerate() {
        devices::outflow(i, outflow).for_each(&mut add);
    }
    for (i, (wall, drive)) in scene.drives().enumerate() {
        devices::drive(i, wall, drive, gauges::length_display(scene))
            .into_iter()
            .for_each(&mut add);
    }
    for (i, gauge) in scene.gauges.iter().enumerate() {
        gauges::rows(scene, i, gauge).into_iter().for_each(&mut add);
    }
    totals().for_each(&mut add);
    number_elements(&mut table);
    table
}

fn general() -> impl Iterator<Item = Row> {
    let mut time = Row::output("time", "s", Source::Time, "simulated time");
    time.variable.causality = Causality::Independent;
    let mut threads = Row::output(
        "solver.threads",
        "",
        Source::Threads,
        "threads of the solver, 0 for all cores; results do not depend on it",
    )
    .within(0.0, f64::from(Component::MOST_THREADS));
    threads.variable.kind = ValueKind::Integer;
    threads.variable.causality = Causality::Parameter;
    threads.variable.variability = Variability::Tunable;
    threads.variable.start = Start::Exact(vec![1.0]);
    let mut saturate = Row::output(
        "saturate_inputs",
        "",
        Source::SaturateInputs,
        "whether inputs out of their range are clamped to it and reported; otherwise they are refused",
    )
    .kind(ValueKind::Boolean)
    .within(0.0, 1.0);
    saturate.variable.causality = Causality::Parameter;
    saturate.variable.variability = Variability::Tunable;
    saturate.variable.start = Start::Exact(vec![0.0]);
    [time, threads, saturate].into_iter()
}

/// A number of the scene, fixed once the component is initialised.
fn parameter_row(i: usize, number: &Adjustable) -> Row {
    let (least, most) = number.range;
    let source = Source::Adjustable(i);
    let mut row = Row::output(&number.name, number.unit, source, &number.description)
        .display(number.display_unit)
        .within(least, most);
    row.variable.causality = Causality::Parameter;
    row.variable.variability = Variability::Fixed;
    row.variable.start = Start::Exact(vec![number.start]);
    row
}

pub(super) const PERCENT: Option<(&str, f64)> = Some(("%", 100.0));

fn totals() -> impl Iterator<Item = Row> {
    let count = |name, source, text| Row::output(name, "", source, text).kind(ValueKind::Integer);
    [
        Row::output("mass.initial", "kg", Source::MassInitial, "mass at the start"),
        Row::output("mass.inflow", "kg", Source::MassInflow, "mass that came in since the start"),
        Row::output("mass.outflow", "kg", Source::MassOutflow, "mass that left since the start"),
        Row::output("mass.present", "kg", Source::MassPresent, "mass present, summed over particles"),
        Row::output("mass.error", "kg", Source::MassError, "initial + inflow - outflow - present: exactly 0"),
        count("solver.steps", Source::Steps, "internal steps since the start"),
        count("solver.iterations", Source::Iterations, "iterations of viscous solves since the start"),
        Row::output("solver.step_size", "s", Source::StepSize, "last internal step").display(Some(("ms", 1000.0))),
        count("solver.particles", Source::Particles, "particles present"),
        Row::output("energy.kinetic", "J", Source::KineticEnergy, "kinetic energy of the material"),
        Row::output(
            "validity.share_dilute",
            "1",
            Source::ShareDilute,
            "share of the mass with an inertial number above 0.3: outside the dense regime that the model is for",
        )
        .display(PERCENT),
        Row::output(
            "validity.share_ill_posed",
            "1",
            Source::ShareIllPosed,
            "share of the mass that yields where its friction law is ill-posed: short waves grow there, the finer the faster",
        )
        .display(PERCENT),
        Row::output(
            "validity.creep_rate",
            "1/s",
            Source::CreepRate,
            "root mean square, by mass, of the shear rate of material below its static strength: 0 if all that should rest does",
        ),
        Row::output(
            "validity.share_fast",
            "1",
            Source::ShareFast,
            "share of the mass under pressure that moves faster than a fifth of the sound speed: give numerics.expected_speed if much does",
        )
        .display(PERCENT),
        Row::output(
            "validity.share_squeezed",
            "1",
            Source::ShareSqueezed,
            "share of the mass under pressure that gives way by more than a twentieth, where its grains or its water would not: moving walls leave it too little room, or the sound speed is too low",
        )
        .display(PERCENT),
    ]
    .into_iter()
}

/// Elements follow their array: now that rows have numbers, point each at its array and give values their place.
fn number_elements(table: &mut VariableTable) {
    let (mut array, mut end) = (0, 0);
    for row in &mut table.rows {
        match &mut row.element_of {
            Some((of, k)) => {
                *of = array;
                table.offsets.push(table.offsets[array as usize] + *k);
            }
            None => {
                array = row.reference;
                table.offsets.push(end);
                end += row.len();
            }
        }
    }
}
