//! Fills a table from the messages of a log in their order.

use super::{Column, Table};
use crate::component::{Causality, Component, Start, ValueKind, VariableTable};
use crate::record::read::Body;
use crate::record::standing::Standing;
use crate::scene::{InputTarget, Scene};
use crate::wire::messages::{Applied, AppliedEvent, Gauge, StepStats};
use std::collections::HashMap;

/// A table in the making.
pub(super) struct Builder<'a> {
    standing: &'a Standing,
    scene: Scene,
    table: Table,
    /// Columns of a variable: one, or one each element.
    places: HashMap<String, Vec<usize>>,
    /// Columns of the inflows' rates, in the order of the scene.
    rates: Vec<usize>,
    now: Now,
    /// Time of the last line of figures [s].
    time: f64,
    /// Whether a step was done whose figures come next.
    stepped: bool,
    /// Lines of figures and SAVEs so far.
    lines: usize,
    saves: usize,
    /// As it was when states were saved to which the log comes back, and how often it still does, by checksum.
    saved: HashMap<Vec<u8>, (Now, usize)>,
    span: (f64, f64),
}

impl<'a> Builder<'a> {
    pub(super) fn new(scene: Scene, span: (f64, f64), standing: &'a Standing) -> Self {
        let variables = VariableTable::of(&scene);
        let mut places: HashMap<String, Vec<usize>> = HashMap::new();
        let (mut columns, mut row, mut ranges) = (Vec::new(), Vec::new(), Vec::new());
        let scalars = variables
            .rows()
            .iter()
            .filter(|v| matches!(v.causality, Causality::Input | Causality::Output))
            .filter(|v| v.shape.is_empty());
        for variable in scalars {
            let own = match variable.element_of {
                None => Some(variable),
                Some((array, _)) => variables.by_reference(array),
            };
            if let Some(own) = own {
                let list = places.entry(own.name.clone()).or_default();
                list.push(columns.len());
            }
            let start = match &variable.start {
                Start::Exact(values) => values.first().copied(),
                Start::Empty | Start::Calculated => None,
            };
            row.push(start.unwrap_or(f64::NAN));
            ranges.push(variable.range);
            columns.push(Column {
                name: variable.name.clone(),
                unit: variable.unit.to_owned(),
                description: variable.description.clone(),
                is_input: variable.causality == Causality::Input,
                is_flag: variable.kind == ValueKind::Boolean
                    || variable.name.ends_with(".validity"),
                values: Vec::new(),
            });
        }
        let rate = |i| variables.by_reference(variables.input(InputTarget::InflowRate(i)));
        let rates =
            (0..scene.inflows.len()).filter_map(|i| places.get(&rate(i)?.name)?.first().copied());
        Self {
            standing,
            rates: rates.collect(),
            table: Table {
                columns,
                ..Table::default()
            },
            places,
            lines: 0,
            saves: 0,
            saved: HashMap::new(),
            now: Now {
                slopes: vec![0.0; row.len()],
                row,
                ranges,
                parameters: scene.adjustables.iter().map(|a| a.start).collect(),
            },
            scene,
            time: 0.0,
            stepped: false,
            span,
        }
    }

    pub(super) fn finish(self) -> Table {
        self.table
    }

    /// Inputs are those of a saved state. One that does not fit leaves them as nobody knows them.
    pub(super) fn begin_at(&mut self, state: &[u8]) {
        let component = Component::new(&self.scene).and_then(|mut component| {
            component.restore(state)?;
            Ok(component)
        });
        let slopes = component.as_ref().map(Component::input_slopes);
        if let Ok(component) = &component {
            for (name, value) in component.changed_parameters() {
                self.set_parameter(name, value);
            }
            self.settle();
        }
        for (place, column) in self.table.columns.iter().enumerate() {
            if !column.is_input {
                continue;
            }
            self.now.row[place] = f64::NAN;
            if let (Ok(component), Ok(slopes)) = (&component, &slopes)
                && let Some(variable) = component.variables().by_name(&column.name)
            {
                let mut own = [f64::NAN];
                // Refused only for arrays, which a column is not.
                if component.get(&[variable.reference], &mut own).is_ok() {
                    self.now.row[place] = own[0];
                }
                let slope = slopes.iter().find(|(r, _)| *r == variable.reference);
                self.now.slopes[place] = slope.map_or(0.0, |(_, slope)| *slope);
            }
        }
    }

    pub(super) fn add(&mut self, body: Body) {
        match body {
            Body::Applied(applied) => self.inputs(&applied),
            Body::Gauge(gauge) => self.gauge(&gauge),
            // Comes after all outputs of its point.
            Body::Stats(stats) => self.row(&stats),
            _ => {}
        }
    }

    fn row(&mut self, stats: &StepStats) {
        if std::mem::take(&mut self.stepped) {
            self.ramp(stats.time - self.time);
        }
        self.time = stats.time;
        let stands = self.standing.row(self.lines);
        self.lines += 1;
        if !(stands && is_in(self.span, stats.time)) {
            return;
        }
        self.table.time.push(stats.time);
        self.table.step.push(stats.step);
        for (column, value) in self.table.columns.iter_mut().zip(&self.now.row) {
            column.values.push(*value);
        }
    }

    fn inputs(&mut self, applied: &Applied) {
        for input in &applied.inputs {
            if let [value] = input.values[..] {
                self.set_parameter(&input.name, value);
            }
            if input.slope {
                self.slope(&input.name, &input.values);
            } else {
                self.put(&input.name, &input.values);
            }
        }
        for input in applied.moments.iter().flat_map(|moment| &moment.inputs) {
            // Set inside a step, it is held to its end.
            self.slope(&input.name, &vec![0.0; input.values.len()]);
            self.put(&input.name, &input.values);
        }
        match applied.event() {
            AppliedEvent::Step => self.stepped = true,
            AppliedEvent::Initialize => self.settle(),
            AppliedEvent::Save => self.save(&applied.state),
            AppliedEvent::Restore => self.restore(&applied.state),
            _ => {}
        }
    }

    fn set_parameter(&mut self, name: &str, value: f64) {
        let mut all = self.scene.adjustables.iter();
        if let Some(place) = all.position(|parameter| parameter.name == name) {
            self.now.parameters[place] = value;
        }
    }

    /// Fixed parameters take effect: what inflows let in follows from their material's density.
    fn settle(&mut self) {
        if self.rates.is_empty() {
            return;
        }
        // The component refused what breaks a rule.
        let Ok(scene) = self.scene.adjusted(&self.now.parameters) else {
            return;
        };
        for (&place, inflow) in self.rates.iter().zip(&scene.inflows) {
            let value = &mut self.now.row[place];
            if *value > inflow.max_rate {
                *value = inflow.max_rate;
            }
            self.now.ranges[place] = Some((0.0, inflow.max_rate));
        }
    }

    fn save(&mut self, state: &[u8]) {
        let returns = self.standing.returns(self.saves);
        self.saves += 1;
        if returns > 0 {
            self.saved
                .insert(state.to_vec(), (self.now.clone(), returns));
        }
    }

    /// Outputs of the state come again; its inputs do not.
    fn restore(&mut self, state: &[u8]) {
        let Some((then, returns)) = self.saved.get_mut(state) else {
            return;
        };
        self.now.clone_from(then);
        *returns -= 1;
        if *returns == 0 {
            self.saved.remove(state);
        }
    }

    /// Inputs that had a slope hold what they reached in so many seconds, as the component has it, bit for bit.
    fn ramp(&mut self, elapsed: f64) {
        let Now {
            row,
            slopes,
            ranges,
            ..
        } = &mut self.now;
        for ((value, slope), range) in row.iter_mut().zip(slopes).zip(ranges) {
            if *slope == 0.0 {
                continue;
            }
            *value += *slope * elapsed;
            if let Some((least, most)) = range {
                *value = value.clamp(*least, *most);
            }
            *slope = 0.0;
        }
    }

    fn gauge(&mut self, gauge: &Gauge) {
        self.put(&gauge.name, &gauge.values);
        if let Some((device, _)) = gauge.name.rsplit_once('.') {
            self.put(&format!("{device}.validity"), &[f64::from(gauge.validity)]);
        }
    }

    fn slope(&mut self, name: &str, slopes: &[f64]) {
        let places = self.places.get(name).map_or(&[][..], Vec::as_slice);
        for (&place, &slope) in places.iter().zip(slopes) {
            self.now.slopes[place] = slope;
        }
    }

    fn put(&mut self, name: &str, values: &[f64]) {
        let places = self.places.get(name).map_or(&[][..], Vec::as_slice);
        for (&place, &value) in places.iter().zip(values) {
            self.now.row[place] = value;
        }
    }
}

/// What the columns are now.
#[derive(Clone)]
struct Now {
    /// The row being filled.
    row: Vec<f64>,
    /// Of each column, per second; only inputs have one, for the step that comes.
    slopes: Vec<f64>,
    /// Of each column.
    ranges: Vec<Option<(f64, f64)>>,
    /// Values of the scene's adjustables.
    parameters: Vec<f64>,
}

/// Whether a time is in a span [s]: as the whole nanoseconds that times of logs are, since a point at 0.3 s may be a bit later.
fn is_in((from, until): (f64, f64), time: f64) -> bool {
    let nanoseconds = |t: f64| (t * 1e9).round();
    (nanoseconds(from)..=nanoseconds(until)).contains(&nanoseconds(time))
}
