//! What adapters that call by reference must do alike: behaviours as plain functions over a small driver trait.
//!
//! The suite runs for `Component` itself (tests/it/contract.rs) and through the exported functions of the library
//! (fmu/src/contract.rs takes these files by `#[path]`); the bus has tests of its own. An adapter brings a [`Driver`]
//! and calls [`check_all`]. Adapters must not differ in a single bit: states and values are compared as such.

mod parameters;
mod refusals;
mod sameness;

use sandgate::component::{Causality, ValueReference, Variable, VariableTable};
use sandgate::scene::Scene;

/// Why a call did nothing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Refusal {
    /// The adapter's message.
    Message(String),
    #[allow(dead_code, reason = "some adapters can make every call")]
    /// The adapter has no way to make such a call (a wrong length, say, where values carry their references).
    Inexpressible,
}

/// What a call gave.
pub(crate) type Outcome<T> = Result<T, Refusal>;

/// One instance behind an adapter. Numbers are those of the variables table.
pub(crate) trait Driver {
    /// As `Component::enter_initialization`.
    fn enter_initialization(&mut self, start: f64, stop: Option<f64>) -> Outcome<()>;
    /// As `Component::exit_initialization`.
    fn exit_initialization(&mut self) -> Outcome<()>;
    /// As `Component::set`.
    fn set(&mut self, references: &[ValueReference], values: &[f64]) -> Outcome<()>;
    /// As `Component::get`, with `count` values wanted.
    fn get(&mut self, references: &[ValueReference], count: usize) -> Outcome<Vec<f64>>;
    /// As `Component::do_step`.
    fn do_step(&mut self, t: f64, h: f64) -> Outcome<()>;
    /// As `Component::save`.
    fn save(&mut self) -> Outcome<Vec<u8>>;
    /// As `Component::restore`.
    fn restore(&mut self, bytes: &[u8]) -> Outcome<()>;
    /// As `Component::reset`.
    fn reset(&mut self) -> Outcome<()>;
    /// As `Component::terminate`.
    fn terminate(&mut self) -> Outcome<()>;
}

/// Makes instances of a scene.
pub(crate) type Factory<'a> = &'a dyn Fn(&Scene) -> Box<dyn Driver>;

/// Runs the whole suite.
pub(crate) fn check_all(make: Factory, scene: &Scene) {
    let stage = Stage::new(make, scene);
    refusals::refused_calls_leave_no_trace(&stage);
    refusals::far_from_zero_steps_are_as_long_as_told(&stage);
    refusals::bad_states_are_refused(&stage);
    refusals::sets_apply_all_or_nothing(&stage);
    sameness::restored_instances_go_on_with_the_same_bits(&stage);
    sameness::threads_do_not_change_a_bit(&stage);
    sameness::reading_in_any_order_gives_the_same_bits(&stage);
    sameness::instances_do_not_know_each_other(&stage);
    sameness::reset_is_as_new(&stage);
    sameness::steps_end_where_they_are_told_to(&stage);
    parameters::parameters_count_whenever_they_are_set(&stage);
    parameters::values_that_do_not_go_together_wait_for_each_other(&stage);
    parameters::inputs_are_clamped_only_as_far_as_allowed(&stage);
    sameness::mass_is_exact_at_every_step(&stage);
}

/// A scene, its table and how to make instances.
pub(crate) struct Stage<'a> {
    make: Factory<'a>,
    scene: Scene,
    table: VariableTable,
}

impl<'a> Stage<'a> {
    fn new(make: Factory<'a>, scene: &Scene) -> Self {
        assert!(
            !scene.gates.is_empty(),
            "the suite needs a scene with a gate"
        );
        Self {
            make,
            scene: scene.clone(),
            table: VariableTable::of(scene),
        }
    }

    /// A new instance.
    fn instance(&self) -> Box<dyn Driver> {
        (self.make)(&self.scene)
    }

    /// A new instance between steps, at time 0, with the gate told to open.
    fn stepping(&self) -> Box<dyn Driver> {
        let mut driver = self.instance();
        driver.enter_initialization(0.0, Some(10.0)).unwrap();
        driver.exit_initialization().unwrap();
        driver.set(&[self.gate()], &[1.0]).unwrap();
        driver
    }

    /// Handle of the first gate's opening.
    fn gate(&self) -> ValueReference {
        self.reference(&format!("gate.{}.opening", self.scene.gates[0].name))
    }

    fn reference(&self, name: &str) -> ValueReference {
        self.table
            .by_name(name)
            .unwrap_or_else(|| panic!("no variable {name}"))
            .reference
    }

    /// A scalar output.
    fn output(&self) -> ValueReference {
        let is_output = |v: &&sandgate::component::Variable| {
            v.causality == Causality::Output && v.shape.is_empty()
        };
        self.table
            .rows()
            .iter()
            .find(is_output)
            .expect("every scene has outputs")
            .reference
    }

    /// Communication step [s].
    fn step(&self) -> f64 {
        self.scene.run.step
    }

    /// Every row but the number of threads and what is for the component's host.
    fn results(&self) -> impl Iterator<Item = &Variable> {
        let rows = self.table.rows().iter();
        rows.filter(|v| v.name != "solver.threads" && !self.table.is_for_host(v))
    }

    /// Every value of these rows, as bits.
    fn everything(&self, driver: &mut dyn Driver) -> Vec<u64> {
        let rows = self.results();
        rows.flat_map(|v| driver.get(&[v.reference], v.len()).unwrap())
            .map(f64::to_bits)
            .collect()
    }

    /// One value.
    fn value(&self, driver: &mut dyn Driver, name: &str) -> f64 {
        driver.get(&[self.reference(name)], 1).unwrap()[0]
    }
}
