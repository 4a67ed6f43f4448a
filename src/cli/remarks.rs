//! What is legal in a scene and seldom meant, in words for people: `sandgate info` and `sandgate run` tell it.

mod devices;
mod slips;

use crate::boundary::ROWS;
use crate::scene::{Dimension, Scene, Wall, WallGeometry};

/// Share of a body's mass that its particles may miss or add without a word [1].
const MASS_TOLERANCE: f64 = 0.01;

/// Remarks on a scene, none for most.
pub(super) fn remarks(scene: &Scene) -> Vec<String> {
    let all = gates(scene).into_iter().chain(gaps(scene));
    let all = all.chain(overlaps(scene)).chain(beyond(scene));
    let all = all.chain(meetings(scene)).chain(open_corners(scene));
    let all = all.chain(bodies(scene));
    let all = all.chain(thin_walls(scene));
    all.chain(slips::slips(scene)).collect()
}

/// Boxes thinner than a gate may be: what is wet on both sides is felt through them, or finds too little wall.
fn thin_walls(scene: &Scene) -> Vec<String> {
    let domain = &scene.domain;
    let axes = match scene.dimension {
        Dimension::Three => 3,
        Dimension::Two | Dimension::Axisymmetric => 2,
    };
    let least = ROWS as f64 * scene.numerics.spacing;
    let told = scene.walls.iter().filter_map(|wall| {
        let WallGeometry::Box { lower, upper } = &wall.geometry else {
            return None;
        };
        // Along a period that it fills a box has no sides.
        let has_sides = |k: &usize| {
            let period = domain.upper[*k] - domain.lower[*k];
            !domain.periodic[*k] || upper[*k] - lower[*k] < period * (1.0 - 1e-9)
        };
        let sides = (0..axes).filter(has_sides).map(|k| upper[k] - lower[k]);
        let thickness = sides.fold(f64::INFINITY, f64::min);
        (thickness < least * (1.0 - 1e-9)).then(|| {
            format!(
                "note: wall {}: its box is {} thick, less than four spacings, {}: a force gauge on it may read too little,\n  \
                 by a sixth under water and two fifths under sand at one spacing, and material on one side may feel what is on the other.\n  \
                 Thicken the box, or refine numerics.spacing.",
                wall.name,
                length(thickness),
                length(least),
            )
        })
    });
    told.collect()
}

/// Bodies whose particles weigh more or less than their shape.
fn bodies(scene: &Scene) -> Vec<String> {
    let masses = scene.body_masses().into_iter();
    masses
        .filter_map(|mass| {
            let off = mass.particles / mass.shape - 1.0;
            (off.abs() > MASS_TOLERANCE).then(|| {
                format!(
                    "note: body {}: its particles weigh {:.6} kg, its shape {:.6} kg: {:+.1} %, as cells of the lattice do not end at\n  \
                     its rim. A finer spacing comes closer; boxes are exact.",
                    scene.bodies[mass.body].name,
                    mass.particles,
                    mass.shape,
                    100.0 * off,
                )
            })
        })
        .collect()
}

/// Gates whose opening begins behind a wall.
fn gates(scene: &Scene) -> Vec<String> {
    let gates = scene.gates.iter();
    gates
        .filter_map(|gate| {
            let part = scene.opening_behind_wall(gate)?;
            let wall = &scene.walls[part.wall].name;
            Some(format!(
                "note: gate {}: {} of its opening, next to `from`, lie behind wall {wall}: openings up to {} uncover nothing\n  \
                 before that wall. Put `from` on the wall's surface, unless it is meant.",
                gate.name,
                length(part.length),
                rounded(part.share, 4),
            ))
        })
        .collect()
}

/// Gates that leave a slot open beside a wall when they are shut.
fn gaps(scene: &Scene) -> Vec<String> {
    let gaps = scene.gates.iter().flat_map(|gate| {
        let gaps = scene.gaps_of(gate).into_iter();
        gaps.map(|gap| {
            format!(
                "note: gate {}: between {} and wall {} {} stay open while it is shut. Put that edge on the wall's surface, unless a slot is\n  \
                 meant.",
                gate.name,
                gap.edge,
                scene.walls[gap.wall].name,
                length(gap.width),
            )
        })
    });
    gaps.collect()
}

/// Gates of which each bears a part where they share room.
fn overlaps(scene: &Scene) -> Vec<String> {
    let pairs = scene.overlapping_gates().into_iter();
    pairs
        .map(|(a, b)| {
            let (a, b) = (&scene.gates[a].name, &scene.gates[b].name);
            format!(
                "note: gates {a} and {b}: their shut plates share room, where each bears a part of what presses on them: forces on one are\n  \
                 no meaningful numbers. Put one beside or behind the other."
            )
        })
        .collect()
}

/// Gates that open into a body.
fn beyond(scene: &Scene) -> Vec<String> {
    let told = scene.gates.iter().filter_map(|gate| {
        let body = scene.body_beyond(gate)?;
        Some(format!(
            "note: gate {}: body {} goes on beyond `to`. What of the plate has opened past `to` is no longer there: it takes no room\n  \
             in that body and nothing presses on it, only the plate's end pushes. Let `to` reach a wall or above the material.",
            gate.name, scene.bodies[body].name,
        ))
    });
    told.collect()
}

/// Walls that move into others.
fn meetings(scene: &Scene) -> Vec<String> {
    let meetings = scene.meetings().into_iter();
    meetings
        .map(|meeting| {
            let wall = &scene.walls[meeting.wall];
            let (at, what) = match &wall.drive {
                None => (format!("t = {} s", to_three_digits(meeting.time)), ""),
                Some(drive) => {
                    let way = to_three_digits(meeting.time * drive.full);
                    let unit = if drive.turns { "rad" } else { "m" };
                    (format!("{way} {unit} from where it is drawn"), ", or shorten its way")
                }
            };
            format!(
                "note: wall {} is a spacing deep in wall {} at {at}: walls do not stop each other, and what comes between them is squeezed. Move one\n  \
                 of them{what}, unless it is meant.",
                wall.name, scene.walls[meeting.with].name,
            )
        })
        .collect()
}

/// Walls that move as a whole from where another wall ends: the corner between them opens, and has no points behind it.
fn open_corners(scene: &Scene) -> Vec<String> {
    let ends = |wall: &Wall| match &wall.geometry {
        WallGeometry::Polyline {
            points,
            closed: false,
        } => vec![points[0], points[points.len() - 1]],
        _ => Vec::new(),
    };
    let near = 0.5 * scene.numerics.spacing;
    let meet = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < near;
    let count = scene.walls.len();
    let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
    let told = pairs.filter_map(|(a, b)| {
        let (a, b) = (&scene.walls[a], &scene.walls[b]);
        let others = ends(b);
        let is_corner = ends(a).iter().any(|a| others.iter().any(|b| meet(a, b)));
        (!a.moves_with(b) && is_corner).then(|| {
            format!(
                "note: walls {} and {} end where the other begins, and one of them moves: nothing is behind that corner, and what is in it may get\n  \
                 out. Let one go on past the other by four spacings or more, as a cylinder past its piston or a floor past a hinge.",
                a.name, b.name
            )
        })
    });
    told.collect()
}

fn length(metres: f64) -> String {
    format!("{} m", rounded(metres, 6))
}

/// Of what may be small.
fn to_three_digits(value: f64) -> f64 {
    rounded(
        value,
        2 - value.abs().max(1e-300).log10().floor().min(2.0) as i32,
    )
}

/// A number with so many decimals at most.
fn rounded(value: f64, decimals: i32) -> f64 {
    let unit = 10f64.powi(decimals);
    (value * unit).round() / unit
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sluice of the small scene, with its end that opens first at this height.
    fn sluice(from: &str) -> Scene {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/scenes/devices.toml");
        let text = std::fs::read_to_string(path).unwrap();
        let (before, after) = text.split_once("[gates.sluice]").unwrap();
        let (_, after) = after.split_once("from = ").unwrap();
        let (_, after) = after.split_once('\n').unwrap();
        let text = format!("{before}[gates.sluice]\nfrom = {from}\n{after}");
        crate::scene::parse("sluice", &text).unwrap_or_else(|e| panic!("{e}"))
    }

    /// A scene with this body, 10 mm fine.
    fn with_body(dimension: &str, body: &str) -> Scene {
        let corner = |x: f64| match dimension {
            "3" => format!("[{x}, {x}, {x}]"),
            "2" => format!("[{x}, {x}]"),
            _ => format!("[{}, {x}]", x.max(0.0)),
        };
        let text = format!(
            "name = \"b\"\ndimension = {dimension}\n[domain]\nlower = {}\nupper = {}\n[numerics]\nspacing = 0.01\n\
             [materials.water]\nlaw = \"fluid\"\npreset = \"water\"\n\
             [bodies.b]\nmaterial = \"water\"\n{body}\n[run]\nstep = 0.01\nuntil = 0.1\n",
            corner(-0.2),
            corner(0.6),
        );
        crate::scene::parse("b", &text).unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn bodies_that_weigh_another_than_their_shape_are_told_with_both_masses() {
        for (dimension, body, shape) in [
            (
                "2",
                "circle = { centre = [0.2, 0.2], radius = 0.05 }",
                "7.8",
            ),
            (
                "\"axisymmetric\"",
                "polygon = [[0, 0], [0.1, 0], [0, 0.1]]",
                "1.047",
            ),
        ] {
            let told = remarks(&with_body(dimension, body));
            let [note] = &told[..] else {
                panic!("{body}: {told:?}");
            };
            let part = format!("its shape {shape}");
            assert!(note.contains("body b") && note.contains(&part), "{note}");
        }
        for (dimension, body) in [
            ("2", "box = { lower = [0, 0], upper = [0.203, 0.107] }"),
            ("2", "circle = { centre = [0.2, 0.2], radius = 0.3 }"),
            (
                "\"axisymmetric\"",
                "box = { lower = [0, 0], upper = [0.104, 0.203] }",
            ),
            (
                "3",
                "box = { lower = [0, 0, 0], upper = [0.1, 0.104, 0.1] }\nlevel = 0.07",
            ),
        ] {
            let told = remarks(&with_body(dimension, body));
            assert_eq!(told, Vec::<String>::new(), "{body}");
        }
    }

    #[test]
    fn boxes_thinner_than_four_spacings_are_told() {
        let with = |domain: &str, walls: &str| {
            let text = format!(
                "name = \"b\"\n[domain]\nlower = [0, -0.2]\nupper = [0.6, 0.6]\n{domain}\n[numerics]\nspacing = 0.01\n\
                 [materials.water]\nlaw = \"fluid\"\npreset = \"water\"\n\
                 [bodies.b]\nmaterial = \"water\"\nbox = {{ lower = [0, 0], upper = [0.1, 0.1] }}\n{walls}\n\
                 [run]\nstep = 0.01\nuntil = 0.1\n",
            );
            remarks(&crate::scene::parse("b", &text).unwrap_or_else(|e| panic!("{e}")))
        };
        let part = |thick: f64| {
            let right = 0.2 + thick;
            format!("[walls.part]\nbox = {{ lower = [0.2, 0], upper = [{right}, 0.3] }}")
        };
        let told = with("", &part(0.03));
        let [note] = &told[..] else {
            panic!("{told:?}");
        };
        for said in [
            "wall part",
            "0.03 m thick",
            "four spacings, 0.04 m",
            "force gauge",
        ] {
            assert!(note.contains(said), "no {said:?} in {note}");
        }
        // A floor across the period is as thick as it is deep.
        let floor = "[walls.floor]\nbox = { lower = [0, -0.04], upper = [0.6, 0] }";
        for told in [with("", &part(0.04)), with("periodic = [\"x\"]", floor)] {
            assert_eq!(told, Vec::<String>::new());
        }
    }

    #[test]
    fn a_gate_that_leaves_a_slot_above_the_bed_is_told() {
        let told = remarks(&sluice("[0.15, 0.02]"));
        // It is narrow, too.
        let [note, _] = &told[..] else {
            panic!("{told:?}");
        };
        let part = "gate sluice: between from and wall bed 0.02 m stay open";
        assert!(note.contains(part), "{note}");
    }

    #[test]
    fn corners_that_open_are_told() {
        let told = |side: &str| {
            let text = format!(
                "name = \"b\"\n[domain]\nlower = [-0.2, -0.2]\nupper = [1, 1]\n[numerics]\nspacing = 0.01\n\
                 [materials.water]\nlaw = \"fluid\"\npreset = \"water\"\n\
                 [bodies.b]\nmaterial = \"water\"\nbox = {{ lower = [0, 0], upper = [0.1, 0.1] }}\n\
                 [walls.left]\npolyline = [[0, 0.3], {side}]\n[walls.right]\npolyline = [[0.1, -0.1], [0.1, 0.3]]\n\
                 [walls.floor]\npolyline = [[0, 0], [0.1, 0]]\nmotion = \"rigid\"\nvelocity = [0, 0.01]\n\
                 [run]\nstep = 0.01\nuntil = 1\n"
            );
            remarks(&crate::scene::parse("b", &text).unwrap_or_else(|e| panic!("{e}")))
        };
        let [note] = &told("[0, 0]")[..] else {
            panic!("{:?}", told("[0, 0]"));
        };
        assert!(
            note.contains("walls left and floor end where the other begins"),
            "{note}"
        );
        assert_eq!(told("[0, -0.1]"), Vec::<String>::new());
    }

    #[test]
    fn what_gets_into_the_way_of_something_else_is_told() {
        let with = |more: &str| {
            let text = format!(
                "name = \"b\"\n[domain]\nlower = [0, -0.2]\nupper = [1, 1]\n[numerics]\nspacing = 0.01\n\
                 [materials.water]\nlaw = \"fluid\"\npreset = \"water\"\n\
                 [bodies.b]\nmaterial = \"water\"\nbox = {{ lower = [0, 0.1], upper = [0.3, 0.2] }}\n\
                 [walls.tank]\npolyline = [[0, 0.6], [0, 0], [0.5, 0], [0.5, 0.6]]\n{more}\n\
                 [run]\nstep = 0.01\nuntil = 1\n",
            );
            remarks(&crate::scene::parse("b", &text).unwrap_or_else(|e| panic!("{e}")))
        };
        for (more, said) in [
            (
                "[gates.a]\nfrom = [0.4, 0]\nto = [0.4, 0.2]\n[gates.c]\nfrom = [0.42, 0]\nto = [0.42, 0.3]",
                "gates a and c: their shut plates share room",
            ),
            (
                "[gates.a]\nfrom = [0.2, 0]\nto = [0.2, 0.1]",
                "gate a: body b goes on beyond `to`",
            ),
            (
                "[walls.bar]\nbox = { lower = [0.36, 0.3], upper = [0.42, 0.4] }\nmotion = \"rigid\"\nvelocity = [1, 0]",
                "wall bar is a spacing deep in wall tank at t = 0.0",
            ),
        ] {
            let told = with(more);
            let [note] = &told[..] else {
                panic!("{more}: {told:?}");
            };
            assert!(note.contains(said), "{note}");
        }
        assert_eq!(
            [123.4, 0.1234, 1.234e-4].map(to_three_digits),
            [123.0, 0.123, 1.23e-4]
        );
    }

    #[test]
    fn a_gate_that_opens_below_the_bed_is_told_and_one_that_stands_on_it_is_not() {
        assert_eq!(remarks(&sluice("[0.15, 0]")), Vec::<String>::new());
        let told = remarks(&sluice("[0.15, -0.02]"));
        let [note] = &told[..] else {
            panic!("{told:?}");
        };
        for part in [
            "gate sluice: 0.02 m of its opening",
            "behind wall bed",
            "up to 0.3333",
        ] {
            assert!(note.contains(part), "no {part:?} in {note}");
        }
    }
}
