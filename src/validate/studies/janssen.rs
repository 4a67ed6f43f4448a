//! `janssen`: vertical stress in a silo whose walls carry a part of the weight.

use super::choices::{self, Choice, change};
use crate::validate::chart::{Chart, Curve, Look};
use crate::validate::report::number;
use crate::validate::statistics::mean;
use crate::validate::template::{Template, points, rectangle};
use crate::validate::{
    Effort, Figure, Member, Metric, Recording, Report, Results, Rule, Study, Table,
};

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

/// What a run measured.
struct Measured {
    /// Weight over area, rho g [Pa/m].
    weight: f64,
    /// Shear over normal force of the walls.
    mobilised: f64,
    /// Integral of sigma_xx over that of sigma_zz.
    k: f64,
    /// Force on the floor over its width [Pa].
    floor: f64,
    /// Depth of the floor [m].
    depth: f64,
    /// Depth [m] and sigma_zz there [Pa], at the lower end of each piece.
    stress: Vec<(f64, f64)>,
    /// Depth of the middle [m] and sigma_xx over sigma_zz of each piece.
    local: Vec<(f64, f64)>,
}

impl Measured {
    /// Janssen's sigma_zz at a depth [Pa].
    fn janssen(&self, depth: f64) -> f64 {
        let length = WIDTH / (2.0 * self.k * FRICTION);
        self.weight * length * (1.0 - (-depth / length).exp())
    }

    /// Largest |sigma_zz - Janssen's| over Janssen's.
    fn worst(&self) -> f64 {
        let off = |(z, s): &(f64, f64)| (s / self.janssen(*z) - 1.0).abs();
        self.stress.iter().map(off).fold(0.0, f64::max)
    }
}

fn measure(recording: &Recording) -> Option<Measured> {
    let end = *recording.time.last()?;
    let late = |variable: &str| {
        let curve = recording.curve(variable);
        let values = curve.iter().filter(|p| p.0 > end - 1.0).map(|p| p.1);
        mean(&values.collect::<Vec<f64>>())
    };
    let bottom = -SPEED * (end - 0.5);
    let top = FOOT + late("gauge.depth.depth")?;
    let depth = top - bottom;
    let weight = recording.last("mass.present")? * GRAVITY / (WIDTH * depth);
    let mut normal = Vec::new();
    let mut shear = 0.0;
    for k in 0..PIECES {
        let force = |side: &str, axis: &str| late(&format!("gauge.{side}_{k}.force_{axis}"));
        normal.push(force("right", "x")? - force("left", "x")?);
        shear -= force("right", "y")? + force("left", "y")?;
    }
    let mobilised = shear / normal.iter().sum::<f64>();
    let (mut carried, mut above) = (0.0, 0.0);
    let (mut horizontal, mut vertical) = (0.0, 0.0);
    let (mut stress, mut local) = (Vec::new(), Vec::new());
    for k in (0..PIECES).rev() {
        let (low, high) = (foot(k).max(bottom), foot(k + 1).min(top));
        if high <= low {
            continue;
        }
        carried += mobilised * normal[k];
        let z = top - low;
        let below = weight * z - carried / WIDTH;
        let between = 0.5 * (above + below);
        horizontal += 0.5 * normal[k];
        vertical += between * (high - low);
        stress.push((z, below));
        // Where sand touches a part of a piece only, the piece's force is no stress.
        if high - low > 0.9 * PIECE {
            let middle = top - 0.5 * (low + high);
            local.push((middle, 0.5 * normal[k] / (high - low) / between));
        }
        above = below;
    }
    Some(Measured {
        weight,
        mobilised,
        k: horizontal / vertical,
        floor: -late("gauge.floor.force_y")? / WIDTH,
        depth,
        stress,
        local,
    })
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces of a silo that obeys Janssen's law with K = 0.5.
    #[test]
    fn the_law_is_found_in_a_silo_that_obeys_it() {
        let (weight, k, end) = (1.5e4, 0.5, 5.0);
        let length = WIDTH / (2.0 * k * FRICTION);
        let (bottom, top) = (-SPEED * (end - 0.5), 0.4955);
        // Integral of sigma_zz from the surface to a depth.
        let integral = |z: f64| weight * length * (z - length * (1.0 - (-z / length).exp()));
        let mut recording = Recording::empty("key".to_owned());
        recording.time = vec![0.0, end];
        let mut keep = |name: String, value: f64| {
            recording.series.insert(name, vec![vec![0.0], vec![value]]);
        };
        let depth = top - bottom;
        keep("gauge.depth.depth".to_owned(), top - FOOT);
        keep("mass.present".to_owned(), weight * WIDTH * depth / GRAVITY);
        for piece in 0..PIECES {
            let (low, high) = (foot(piece).max(bottom), foot(piece + 1).min(top));
            let force = if high > low {
                k * (integral(top - low) - integral(top - high))
            } else {
                0.0
            };
            for (side, sign) in [("left", -1.0), ("right", 1.0)] {
                keep(format!("gauge.{side}_{piece}.force_x"), sign * force);
                keep(format!("gauge.{side}_{piece}.force_y"), -FRICTION * force);
            }
        }
        let floor = weight * length * (1.0 - (-depth / length).exp());
        keep("gauge.floor.force_y".to_owned(), -floor * WIDTH);
        let found = measure(&recording).unwrap();
        assert!((found.mobilised / FRICTION - 1.0).abs() < 1e-9);
        // The mean over a piece stands for its integral.
        assert!((found.k / k - 1.0).abs() < 0.01, "{}", found.k);
        assert!(found.worst() < 0.01, "{}", found.worst());
        assert!((found.floor / found.janssen(found.depth) - 1.0).abs() < 0.01);
        assert!(
            found
                .local
                .iter()
                .all(|(_, local)| (local / k - 1.0).abs() < 0.04)
        );
    }
}
