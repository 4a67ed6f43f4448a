//! `janssen`: vertical stress in a silo whose walls carry a part of the weight.

mod measured;

use self::measured::{Measured, measure};
use super::choices::{self, Choice, change};
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::report::number;
use crate::validate::template::{Template, points, rectangle};
use crate::validate::{Effort, Figure, Member, Metric, Report, Results, Rule, Study, Table};

/// The study.
pub(super) const STUDY: Study = Study {
    name: "janssen",
    title: "Janssen: stress in a silo with wall friction",
    about: "Sand in a planar silo, 0.1 m wide and filled to 0.5 m, walls with mu_w = 0.4, the floor (without friction) lowered \
at 1 mm/s, so that all of it slides down the walls; means over the last second. sigma_zz(z) = rho g lambda (1 - exp(-z/lambda)), \
lambda = L/(2 K mu_w) (Janssen 1895), in the plane.\n\n\
Measured are the normal force of each 50 mm of wall, shear and normal force of the whole walls, force on the floor, mass and \
height of the fill. Mobilised friction is shear over normal force of the walls; as no part of them can have more than mu_w, all \
has it where that is mu_w. sigma_zz at a depth is the weight above less the shear force above (mobilised friction times normal \
force) over L; at the floor it is the floor's force. K is the integral of the walls' sigma_xx over that of sigma_zz over the \
depth: of the run, none of it is set.",
    members,
    analyse,
};

const GRAVITY: f64 = 9.81;
const TEMPLATE: &str = include_str!("../../../cases/validation/janssen.toml");
const WIDTH: f64 = 0.1;
const HEIGHT: f64 = 0.5;
const FRICTION: f64 = 0.4;
/// Pieces of each wall, their length, and the foot of the lowest: where the depth gauge stands, below the floor [m].
const PIECES: usize = 12;
const PIECE: f64 = 0.05;
const FOOT: f64 = -0.05;
/// Speed of the floor [m/s].
const SPEED: f64 = 1e-3;

/// Name of a member, its material, its yield, and what it is.
const MEMBERS: [(&str, &str, &str, &str); 3] = [
    ("sand", "sand_04", "exact", "sand, exact yield"),
    ("glass", "glass_beads", "exact", "glass beads, exact yield"),
    ("sand_capped", "sand_04", "capped", "sand, capped yield"),
];

/// The members at which the scheme's choices are changed: those whose floor bears more than Janssen's law says.
const CHECKED: [usize; 2] = [0, 1];

fn check(name: &str, choice: Choice) -> String {
    format!("check_{name}_{}", choice.name())
}

fn scene(material: &str, form: &str, spacing: f64, effort: Effort) -> Result<Template, String> {
    let mut template = Template::new(TEMPLATE)?
        .with("numerics.spacing", spacing)
        .with("numerics.yield", form)
        .with("materials.sand.preset", material)
        .with("bodies.sand.box", rectangle([0.0, 0.0], [WIDTH, HEIGHT]))
        .with("run.until", effort.pick(5.0, 2.0));
    for k in 0..PIECES {
        let (low, high) = (foot(k), foot(k + 1));
        let left = points(&[[0.0, high], [0.0, low]]);
        let right = points(&[[WIDTH, low], [WIDTH, high]]);
        for (side, line) in [("left", left), ("right", right)] {
            let wall = format!("walls.{side}_{k}");
            let gauge = format!("gauges.{side}_{k}");
            template = template
                .with(&format!("{wall}.polyline"), line)
                .with(&format!("{wall}.slip"), "friction")
                .with(&format!("{wall}.wall_friction"), FRICTION)
                .with(&format!("{gauge}.kind"), "force")
                .with(&format!("{gauge}.on"), format!("wall.{side}_{k}"));
        }
    }
    Ok(template)
}

/// Variables that are kept.
fn series() -> Vec<String> {
    let forces = (0..PIECES).flat_map(|k| {
        ["left", "right"]
            .into_iter()
            .flat_map(move |side| ["x", "y"].map(|axis| format!("gauge.{side}_{k}.force_{axis}")))
    });
    let single = ["mass.present", "gauge.depth.depth", "gauge.floor.force_y"];
    single
        .map(str::to_owned)
        .into_iter()
        .chain(forces)
        .collect()
}

/// Height of the lower end of a piece of wall [m].
fn foot(piece: usize) -> f64 {
    FOOT + PIECE * piece as f64
}

fn members(effort: Effort) -> Result<Vec<Member>, String> {
    let kept = series();
    let kept: Vec<&str> = kept.iter().map(String::as_str).collect();
    let member = |name: &str, scene: Template| {
        scene
            .text()
            .map(|text| Member::new(name.to_owned(), text, &kept, Vec::new()))
    };
    let spacing = effort.pick(6.25e-3, 12.5e-3);
    let mut members = Vec::new();
    for (name, material, form, _) in MEMBERS {
        members.push(member(name, scene(material, form, spacing, effort)?)?);
    }
    for (name, material, form, _) in CHECKED.map(|k| MEMBERS[k]) {
        for choice in Choice::ALL {
            let scene = scene(material, form, spacing / choice.refinement(), effort)?;
            let changed = choice.change(scene, (GRAVITY * HEIGHT).sqrt());
            members.push(member(&check(name, choice), changed)?);
        }
    }
    Ok(members)
}

/// What the floor bears over Janssen's law.
fn floor(measured: &Measured) -> f64 {
    measured.floor / measured.janssen(measured.depth)
}

/// Shares by which each choice changes that.
fn changes(results: &Results, name: &str) -> [Option<f64>; 4] {
    let found = |name: &str| Some(floor(&measure(results.finished(name)?)?));
    let base = found(name);
    Choice::ALL.map(|choice| change(base, found(&check(name, choice))))
}

fn analyse(results: &Results) -> Result<Report, String> {
    let mut report = Report::default();
    let mut measured = Vec::new();
    for (name, _, _, what) in MEMBERS {
        let found = results.finished(name).and_then(measure);
        let value = |f: &dyn Fn(&Measured) -> f64| found.as_ref().map(f);
        let changes = changes(results, name);
        report.metrics.extend([
            Metric::new(
                format!("{what}: mobilised wall friction"),
                value(&|m| m.mobilised),
                Rule::NearShare(FRICTION, 0.01),
                "mu_w: all of it slides",
            ),
            Metric::new(
                format!("{what}: force on the floor over Janssen's"),
                value(&floor),
                Rule::Near(1.0, 0.1),
                "10 % is what the law is trusted with",
            )
            .changed_by(changes),
            Metric::new(
                format!("{what}: sigma_zz over depth, largest error over Janssen's there"),
                value(&|m| m.worst()),
                Rule::AtMost(0.1),
                "the same",
            ),
            Metric::new(
                format!("{what}: K"),
                value(&|m| m.k),
                Rule::Report(None),
                "sigma_xx at the walls over sigma_zz, mean over the depth",
            ),
        ]);
        measured.push((what, found));
    }
    let checked = CHECKED.map(|k| (MEMBERS[k].3.to_owned(), changes(results, MEMBERS[k].0)));
    report.tables.push(choices::table(
        "Share by which each choice of the scheme changes the force on the floor over Janssen's"
            .to_owned(),
        &checked,
    ));
    report.tables.push(table(&measured));
    report.figures.push(figure(&measured)?);
    report.notes.push(
        "Janssen's law takes K for constant. A plug that slides does not deform, and with the exact yield it keeps whatever \
stress friction allows: here what it got when the floor began to move and the weight went over to the walls. With \
tau_xz = mu_w sigma_xx at the wall, |tau| <= mu_s p at the wall allows K from 0.28 to 1.80 for this sand and from 0.64 to 0.90 \
for these glass beads, with sigma_zz at the wall; the table has its mean over the section. With a capped yield a plug's shear stress relaxes, K becomes 1, and Janssen's law holds."
            .to_owned(),
    );
    Ok(report)
}

fn table(measured: &[(&str, Option<Measured>)]) -> Table {
    let mut head = vec!["depth [m]".to_owned()];
    let present: Vec<_> = measured
        .iter()
        .filter_map(|(w, m)| Some((w, m.as_ref()?)))
        .collect();
    head.extend(present.iter().map(|(what, _)| format!("K, {what}")));
    let count = present
        .iter()
        .map(|(_, m)| m.local.len())
        .min()
        .unwrap_or(0);
    let rows = (0..count).map(|n| {
        let depth = present.first().map_or(0.0, |(_, m)| m.local[n].0);
        let mut row = vec![number(depth)];
        row.extend(present.iter().map(|(_, m)| number(m.local[n].1)));
        row
    });
    Table {
        title: "K of each 50 mm of wall".to_owned(),
        head,
        rows: rows.collect(),
    }
}

fn figure(measured: &[(&str, Option<Measured>)]) -> Result<Figure, String> {
    let mut curves = Vec::new();
    for (colour, (what, found)) in measured.iter().enumerate() {
        let Some(m) = found else { continue };
        let computed = m.stress.iter().map(|(z, s)| (*z, s / 1e3));
        curves.push(Curve::new(*what, computed.collect(), Look::Dots, colour));
        let law = (0..=50).map(|k| f64::from(k) / 50.0 * m.depth);
        let law = law.map(|z| (z, m.janssen(z) / 1e3));
        curves.push(Curve::new(
            format!("Janssen, K = {:.2}", m.k),
            law.collect(),
            Look::Thin,
            colour,
        ));
    }
    let chart = Chart {
        x: "depth [m]".to_owned(),
        y: "sigma_zz [kPa]".to_owned(),
        curves,
    };
    Ok(Figure {
        name: "stress".to_owned(),
        caption: "Vertical stress over depth.".to_owned(),
        svg: chart.svg()?,
    })
}
