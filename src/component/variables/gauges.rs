//! Rows of gauges: one function for each kind, its validity behind all of them.

use super::ValueKind;
use super::rows::{Row, Source};
use crate::math::Vector;
use crate::scene::{Gauge, GaugeKind, PressureQuantity, Scene};
use crate::units::shown;

/// Rows of the gauge at this place of the scene's list.
pub(super) fn rows(scene: &Scene, place: usize, gauge: &Gauge) -> Vec<Row> {
    let this = Gauged {
        scene,
        place,
        gauge,
    };
    let mut rows = match &gauge.kind {
        GaugeKind::Depth { length, up, .. } => vec![this.depth("depth of material", *length, up)],
        GaugeKind::Profile {
            count, length, up, ..
        } => this.profile(*count, *length, up),
        GaugeKind::Discharge { .. } => this.discharge(),
        GaugeKind::Force { about, .. } => this.force(*about),
        GaugeKind::Pressure { quantity, .. } => vec![this.pressure(*quantity)],
        GaugeKind::Velocity { .. } => this.velocity(),
        GaugeKind::InterfaceStress { .. } => vec![this.shear_stress()],
        GaugeKind::Mass { .. } => vec![this.reading("mass", "kg", 0, "mass in the box")],
        GaugeKind::Front { .. } => this.front(),
    };
    rows.push(this.validity());
    rows
}

/// A gauge of a scene and its place in the list.
struct Gauged<'s> {
    scene: &'s Scene,
    place: usize,
    gauge: &'s Gauge,
}

impl Gauged<'_> {
    /// An output that is what the gauge reads, from value `first` of its reading on.
    fn reading(&self, suffix: &str, unit: &'static str, first: usize, text: &str) -> Row {
        let name = &self.gauge.name;
        let seen = self.gauge.material.map(|m| &self.scene.materials[m].name);
        let of = seen.map_or(String::new(), |name| format!(" (of {name} alone)"));
        let source = Source::Reading {
            gauge: self.place,
            first,
        };
        Row::output(
            format!("gauge.{name}.{suffix}"),
            unit,
            source,
            format!("{text}{of} at gauge {name}"),
        )
    }

    /// Depth along a line of this length.
    fn depth(&self, text: &str, length: f64, up: &Vector<3>) -> Row {
        // A foot may be moved, and its line with it, but not out of the domain.
        let domain = &self.scene.domain;
        let extent = |a: usize| (domain.upper[a] - domain.lower[a]) * up[a].abs();
        let across = (0..self.scene.dimension.axes()).map(extent).sum();
        self.reading("depth", "m", 0, text)
            .display(length_display(self.scene))
            .within(0.0, length.max(across))
    }

    /// Depths as one array, and each of them for FMI 2.
    fn profile(&self, count: usize, length: f64, up: &Vector<3>) -> Vec<Row> {
        let depths = || self.depth("depths of material", length, up);
        let name = &self.gauge.name;
        let mut rows = vec![depths()];
        rows[0].variable.shape = vec![count];
        rows.extend((0..count).map(|k| {
            let mut row = depths();
            row.variable.name += &format!("[{}]", k + 1);
            row.variable.description =
                format!("depth of material at foot {} of gauge {name}", k + 1);
            row.variable.element_of = Some((0, k));
            row.source = Source::Reading {
                gauge: self.place,
                first: k,
            };
            row
        }));
        rows
    }

    fn discharge(&self) -> Vec<Row> {
        let [rate, mass] = match self.scene.dimension.axes() {
            3 => [
                "mass that crossed along (to - from) x span in the last step, per second,",
                "net mass that crossed along (to - from) x span since the start",
            ],
            _ => [
                "mass that crossed from left to right in the last step, per second,",
                "net mass that crossed from left to right since the start",
            ],
        };
        vec![
            self.reading("discharge", "kg/s", 0, rate),
            self.reading("mass", "kg", 1, mass),
        ]
    }

    fn force(&self, about: Option<Vector<3>>) -> Vec<Row> {
        let mut rows = self.along_axes("force", "N", |axis| {
            format!("force of the material along {axis}, mean over the last step,")
        });
        let Some(about) = about else {
            return rows;
        };
        let axes = self.scene.dimension.axes();
        let point = about[..axes].iter().map(|c| shown(*c));
        let point = point.collect::<Vec<_>>().join(", ");
        if axes == 2 {
            let text = format!(
                "moment of that force about [{point}] m, anticlockwise, mean over the last step,"
            );
            rows.push(self.reading("moment", "N.m", axes, &text));
            return rows;
        }
        rows.extend(["x", "y", "z"].into_iter().enumerate().map(|(k, axis)| {
            let text = format!(
                "moment of that force about [{point}] m round {axis}, mean over the last step,"
            );
            self.reading(&format!("moment_{axis}"), "N.m", axes + k, &text)
        }));
        rows
    }

    fn velocity(&self) -> Vec<Row> {
        self.along_axes("velocity", "m/s", |axis| {
            format!("velocity of the material along {axis}")
        })
    }

    /// One row each axis of the scene.
    fn along_axes(
        &self,
        name: &str,
        unit: &'static str,
        text: impl Fn(&str) -> String,
    ) -> Vec<Row> {
        let axes = ["x", "y", "z"].into_iter();
        axes.take(self.scene.dimension.axes())
            .enumerate()
            .map(|(k, axis)| self.reading(&format!("{name}_{axis}"), unit, k, &text(axis)))
            .collect()
    }

    fn pressure(&self, quantity: PressureQuantity) -> Row {
        let text = match quantity {
            PressureQuantity::Total => "pressure of the material",
            PressureQuantity::Pore => "pressure of fluids and in pores",
            PressureQuantity::Effective => "pressure of grain on grain",
        };
        self.reading("pressure", "Pa", 0, text)
    }

    fn shear_stress(&self) -> Row {
        self.reading("shear_stress", "Pa", 0, "shear stress at the highest point")
            .within(0.0, f64::INFINITY)
    }

    fn front(&self) -> Vec<Row> {
        let front =
            "outermost distance with a depth of its least_depth, one particle spacing by default,";
        let quantile = "distance that 99.5 % of the mass ahead stays behind";
        let length = length_display(self.scene);
        vec![
            self.reading("front", "m", 0, front).display(length),
            self.reading("front_quantile", "m", 1, quantile)
                .display(length),
        ]
    }

    fn validity(&self) -> Row {
        let name = &self.gauge.name;
        let text =
            format!("whether gauge {name} reads anything: 0 valid, 1 empty, 2 outside, 3 blocked");
        let source = Source::Validity(self.place);
        Row::output(format!("gauge.{name}.validity"), "", source, text)
            .kind(ValueKind::Integer)
            .within(0.0, 3.0)
    }
}

/// Millimetres for scenes smaller than a metre.
pub(super) fn length_display(scene: &Scene) -> Option<(&'static str, f64)> {
    let extent = (0..scene.dimension.axes())
        .map(|a| scene.domain.upper[a] - scene.domain.lower[a])
        .fold(0.0, f64::max);
    (extent <= 1.0).then_some(("mm", 1000.0))
}
