//! Variables of gates, inflows, outflows and steered walls.

use super::ValueKind;
use super::rows::{PERCENT, Row, Source};
use crate::boundary::Steers;
use crate::scene::{Gate, Inflow, Outflow, Wall, WallDrive};

const DEGREES: Option<(&str, f64)> = Some(("deg", 180.0 / std::f64::consts::PI));
/// A minute.
const TURNS: Option<(&str, f64)> = Some(("rpm", 30.0 / std::f64::consts::PI));

pub(super) fn gate(i: usize, gate: &Gate) -> impl Iterator<Item = Row> {
    let name = &gate.name;
    [
        Row::input(
            format!("gate.{name}.opening"),
            "1",
            Source::GateOpening(i),
            gate.start,
            (0.0, 1.0),
            format!("opening wanted of gate {name}: 0 shut, 1 open; the plate follows at its largest speed"),
        )
        .display(PERCENT),
        Row::output(
            format!("gate.{name}.actual_opening"),
            "1",
            Source::GateActualOpening(i),
            format!("opening that gate {name} has"),
        )
        .display(PERCENT)
        .within(0.0, 1.0),
        Row::output(
            format!("gate.{name}.blocked"),
            "",
            Source::GateBlocked(i),
            format!("whether material kept gate {name} from following its input in the last step"),
        )
        .kind(ValueKind::Boolean),
    ]
    .into_iter()
}

pub(super) fn inflow(i: usize, inflow: &Inflow) -> impl Iterator<Item = Row> {
    let name = &inflow.name;
    [
        Row::input(
            format!("inflow.{name}.rate"),
            "kg/s",
            Source::InflowRate(i),
            inflow.rate,
            (0.0, inflow.max_rate),
            format!("mass wanted from inflow {name} per second; what comes, row by row, is inflow.{name}.mass"),
        ),
        Row::output(
            format!("inflow.{name}.actual_rate"),
            "kg/s",
            Source::InflowActualRate(i),
            format!("mass that inflow {name} let in during the last step, per second"),
        ),
        Row::output(
            format!("inflow.{name}.mass"),
            "kg",
            Source::InflowMass(i),
            format!("mass that inflow {name} let in since the start: behind the sum of its rate by up to a row (two where a fluid comes through a wall), and by what was lost while blocked"),
        ),
        Row::output(
            format!("inflow.{name}.blocked"),
            "",
            Source::InflowBlocked(i),
            format!(
                "whether inflow {name} could not let in what was wanted in the last step, for material before it or a stream faster than its steps"
            ),
        )
        .kind(ValueKind::Boolean),
    ]
    .into_iter()
}

pub(super) fn outflow(i: usize, outflow: &Outflow) -> impl Iterator<Item = Row> {
    let name = &outflow.name;
    [
        Row::output(
            format!("outflow.{name}.mass"),
            "kg",
            Source::OutflowMass(i),
            format!("mass that left through outflow {name} since the start"),
        ),
        Row::output(
            format!("outflow.{name}.rate"),
            "kg/s",
            Source::OutflowRate(i),
            format!("mass that left through outflow {name} during the last step, per second"),
        ),
    ]
    .into_iter()
}

pub(super) fn drive(
    i: usize,
    wall: &Wall,
    drive: &WallDrive,
    lengths: Option<(&'static str, f64)>,
) -> Vec<Row> {
    let name = &wall.name;
    let (speed, way, sense) = match drive.turns {
        false => (("m/s", None), ("m", lengths), "along its velocity"),
        true => (
            ("rad/s", TURNS),
            ("rad", DEGREES),
            "in the sense of its angular_velocity",
        ),
    };
    let (place, (unit, display), text) = match drive.steers {
        Steers::Rate => (
            "speed",
            speed,
            format!("speed wanted of wall {name} {sense}, negative: backwards"),
        ),
        Steers::Way => (
            drive.input(),
            way,
            format!(
                "how far wall {name} is to be {sense} from where it is drawn; it goes there at its full speed, with a slope steadily"
            ),
        ),
    };
    let mut rows = vec![
        Row::input(
            format!("wall.{name}.{place}"),
            unit,
            Source::WallDrive(i),
            drive.start_value(),
            drive.range(),
            text,
        )
        .display(display),
        Row::output(
            format!("wall.{name}.actual_speed"),
            speed.0,
            Source::WallActualSpeed(i),
            match drive.steers {
                Steers::Rate => format!("speed that wall {name} has {sense}"),
                Steers::Way => format!("mean speed of wall {name} {sense} over the last step"),
            },
        )
        .display(speed.1),
    ];
    if wall.rigid {
        let place = if drive.turns { "angle" } else { "position" };
        let row = Row::output(
            format!("wall.{name}.actual_{place}"),
            way.0,
            Source::WallActualPosition(i),
            format!("how far wall {name} is {sense} from where it is drawn"),
        );
        rows.push(row.display(way.1));
    }
    rows
}
