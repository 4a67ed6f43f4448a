//! `silo_cohesion`: discharge of a cohesive silo against a published table of friction and cohesion.

use super::{BULK_DENSITY, GRAVITY, SERIES, TEMPLATE, speed};
use crate::validate::csv;
use crate::validate::report::number;
use crate::validate::statistics::interpolate;
use crate::validate::studies::choices::{self, Choice, change};
use crate::validate::template::{Template, point, points, rectangle};
use crate::validate::{Effort, Member, Metric, Recording, Report, Results, Rule, Study, Table};

/// The study.
pub(in crate::validate::studies) const STUDY: Study = Study {
    name: "silo_cohesion",
    title: "Discharge of a silo against friction and cohesion",
    about: "A planar flat-bottomed silo with an opening of W = 0.1 m, 10 W wide and filled to 4.5 W, at 16 particles across the \
opening: mu_s 0.1, 0.3 and 0.5, mu_2 = mu_s + 0.28, I0 0.4 with the bulk density, d = W/30, cohesion Co rho g W with Co from 0 to \
0.3. Q is the area that leaves per time over sqrt(g) W^1.5 at 4 sqrt(W/g) after the opening, the mean of half a unit before and after.\n\n\
Beside it a table of the Basilisk wiki (volume of fluid, incompressible, the same silo at the same time, 12.8 cells an opening: \
limited by its grid). Where its Q is above 0.8 ours must be within 10 %; below, flow is about to stop and Q falls steeply \
with Co: there it must be within a tenth of the Q without cohesion.",
    members,
    analyse,
};

const TABLE: &str = include_str!("../../../../cases/reference/silo_cohesion.csv");
/// Opening W [m].
const OPENING: f64 = 0.1;
/// Half the width of the silo, and its fill, over W.
const SIZE: [f64; 2] = [5.0, 4.5];
/// When Q is taken, and over how long before and after [sqrt(W/g)].
const TIME: [f64; 2] = [4.0, 0.5];

/// What limits the comparison.
const NOTE: &str = "The published program takes the shear rate of a cell from its neighbours on both sides, over two cells. A layer \
of yielding material that is one cell wide then carries twice its cohesion and friction, one of two cells one and a half times. That \
its Q falls with Co about twice as fast as ours fits this; without cohesion the rate in mu(I) may keep such layers wider. There, too, \
material at no pressure has no cohesion, so strength under tension is no difference between the two.";

/// A row of the table: mu_s, Co, Q.
type Entry = [f64; 3];

fn entries() -> Result<Vec<Entry>, String> {
    csv::columns(TABLE, ["mu_s", "Co", "Q"])
}

/// Entries (mu_s, Co) at which the scheme's choices are changed too: those that leave the table.
const CHECKED: [[f64; 2]; 4] = [[0.3, 0.2], [0.3, 0.3], [0.5, 0.1], [0.5, 0.2]];

fn name([friction, cohesion, _]: &Entry) -> String {
    format!("mu{friction:.1}_co{cohesion:.1}")
}

fn check(entry: &Entry, choice: Choice) -> String {
    format!("check_{}_{}", name(entry), choice.name())
}

/// sqrt(W/g) [s].
fn scale() -> f64 {
    (OPENING / GRAVITY).sqrt()
}

/// A silo with so many particles across its opening.
fn scene(entry: &Entry, across: f64) -> Result<Template, String> {
    let [friction, cohesion, _] = *entry;
    let w = OPENING;
    let spacing = w / across;
    let lip = 5.0 * spacing;
    let [side, fill] = SIZE.map(|size| size * w);
    let (edge, bottom, top) = (0.5 * w, -3.0 * w, fill + 0.5 * w);
    let left = [
        [-side, top],
        [-side, 0.0],
        [-edge, 0.0],
        [-edge - 0.8 * lip, -lip],
    ];
    let right = left.map(|[x, y]| [-x, y]);
    let right = [right[3], right[2], right[1], right[0]];
    Ok(Template::new(TEMPLATE)?
        .with("domain.lower", point(-1.2 * side, bottom))
        .with("domain.upper", point(1.2 * side, top + w))
        .with("numerics.spacing", spacing)
        .with("numerics.expected_speed", speed(w))
        .with("materials.grains.static_friction_angle", friction.atan())
        .with(
            "materials.grains.dynamic_friction_angle",
            (friction + 0.28).atan(),
        )
        .with(
            "materials.grains.inertial_number_scale",
            0.40 / 0.6_f64.sqrt(),
        )
        .with("materials.grains.grain_diameter", w / 30.0)
        .with("materials.grains.grain_density", BULK_DENSITY / 0.6)
        .with(
            "materials.grains.cohesion",
            cohesion * BULK_DENSITY * GRAVITY * w,
        )
        .with("bodies.fill.box", rectangle([-side, 0.0], [side, fill]))
        .with("walls.left.polyline", points(&left))
        .with("walls.right.polyline", points(&right))
        .with("outflows.drain.lower", point(-1.2 * side, bottom))
        .with("outflows.drain.upper", point(1.2 * side, -2.0 * w))
        .with("gauges.discharge.from", point(-edge, 0.0))
        .with("gauges.discharge.to", point(edge, 0.0))
        .with("run.step", scale() / 20.0)
        .with("run.until", (TIME[0] + TIME[1]) * scale()))
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let across = effort.pick(16.0, 6.0);
    let member = |name: String, scene: Template| {
        scene
            .text()
            .map(|text| Member::new(name, text, &SERIES, Vec::new()))
    };
    let mut members = Vec::new();
    for entry in &entries()? {
        members.push(member(name(entry), scene(entry, across)?)?);
        if CHECKED.contains(&[entry[0], entry[1]]) {
            for choice in Choice::ALL {
                let scene = scene(entry, choice.refinement() * across)?;
                let changed = choice.change(scene, speed(OPENING));
                members.push(member(check(entry, choice), changed)?);
            }
        }
    }
    Ok(members)
}

/// Relative change of Q by each choice.
fn changes(results: &Results, entry: &Entry) -> [Option<f64>; 4] {
    let found = |name: &str| results.finished(name).and_then(flow);
    let base = found(&name(entry));
    Choice::ALL.map(|choice| change(base, found(&check(entry, choice))))
}

/// Q over sqrt(g) W^1.5.
fn flow(recording: &Recording) -> Option<f64> {
    let gone = recording.curve("gauge.discharge.mass");
    let [from, to] =
        [TIME[0] - TIME[1], TIME[0] + TIME[1]].map(|t| interpolate(&gone, t * scale()));
    let rate = (to? - from?) / (2.0 * TIME[1] * scale());
    Some(rate / BULK_DENSITY / (GRAVITY.sqrt() * OPENING.powf(1.5)))
}

fn analyse(results: &Results) -> Result<Report, String> {
    let entries = entries()?;
    let mut report = Report::default();
    let mut rows = Vec::new();
    let mut checked = Vec::new();
    for entry in &entries {
        let [friction, cohesion, known] = *entry;
        let found = results.finished(&name(entry)).and_then(flow);
        let free = entries.iter().find(|e| e[0] == friction && e[1] == 0.0);
        let free = free.map_or(known, |e| e[2]);
        let (rule, why) = if known > 0.8 {
            (
                Rule::NearShare(known, 0.10),
                "what is asked of entries that flow freely; the table's grid has 12.8 cells an opening",
            )
        } else {
            (
                Rule::Near(known, 0.1 * free),
                "about to stop: a tenth of the flow without cohesion",
            )
        };
        let what = format!("mu_s = {friction:.1}, Co = {cohesion:.1}: Q");
        let mut metric = Metric::new(&what, found, rule, why);
        if CHECKED.contains(&[friction, cohesion]) {
            let changes = changes(results, entry);
            metric = metric.changed_by(changes);
            checked.push((what, changes));
        }
        report.metrics.push(metric);
        rows.push(vec![
            number(friction),
            number(cohesion),
            found.map_or("-".to_owned(), number),
            number(known),
        ]);
    }
    report.tables.push(Table {
        title: "Q / (sqrt(g) W^1.5) beside the published table".to_owned(),
        head: ["mu_s", "Co", "computed", "published, grid-limited"]
            .map(str::to_owned)
            .to_vec(),
        rows,
    });
    let title = "Share by which each choice of the scheme changes Q".to_owned();
    report.tables.push(choices::table(title, &checked));
    report.notes.push(NOTE.to_owned());
    Ok(report)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A silo whose Q grows with time, 0.3 t: 1.2 at t = 4.
    #[test]
    fn the_flow_of_a_known_discharge_is_found() {
        let unit = BULK_DENSITY * GRAVITY.sqrt() * OPENING.powf(1.5);
        let mut recording = Recording::empty("key".to_owned());
        assert_eq!(flow(&recording), None);
        recording.time = (0..=90).map(|k| f64::from(k) * 0.05 * scale()).collect();
        let gone = recording.time.iter();
        let gone = gone.map(|t| vec![0.15 * t * t / scale() * unit]).collect();
        recording
            .series
            .insert("gauge.discharge.mass".to_owned(), gone);
        assert!((flow(&recording).unwrap() - 1.2).abs() < 1e-9);
    }
}
