//! How a gate stands to the walls: what of its opening lies behind one, and what it leaves open while it is shut. No rules: a plate
//! may be sealed into the wall that it stands on, and a slot may be meant.

use super::{Gate, Point, Scene, WallGeometry};
use crate::math::{dot, norm, scale, sub};

/// The part of a gate's opening next to `from` that lies behind a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BehindWall {
    /// Index into [`Scene::walls`].
    pub wall: usize,
    /// Its length [m].
    pub length: f64,
    /// Its share of the opening [1].
    pub share: f64,
}

/// A way past an edge of a gate that stays open while it is shut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Which edge of the gate's face, as the scene file calls it.
    pub edge: &'static str,
    /// Index into [`Scene::walls`].
    pub wall: usize,
    /// Its width [m].
    pub width: f64,
}

/// Widths of gaps that are told [spacing]: a narrower one lets nothing through, a wider one is seen in any picture of the scene.
const GAPS: (f64, f64) = (0.5, 4.0);

impl Scene {
    /// The longest part of a gate's opening next to `from`, more than a spacing, that lies behind a wall: what the gate
    /// uncovers there passes nothing before that wall. In space the middle of the face is looked at; walls that move as a
    /// whole are left out.
    #[must_use]
    pub fn opening_behind_wall(&self, gate: &Gate) -> Option<BehindWall> {
        let start: Point = std::array::from_fn(|k| gate.from[k] + 0.5 * gate.span[k]);
        let edge: Point = std::array::from_fn(|k| gate.to[k] - gate.from[k]);
        let size = edge.iter().map(|c| c * c).sum::<f64>().sqrt();
        let fixed = self.walls.iter().enumerate().filter(|(_, w)| !w.rigid);
        let parts = fixed.filter_map(|(wall, w)| {
            let share = leaves(&w.geometry, &start, &edge)?;
            let length = share * size;
            (length > self.numerics.spacing).then_some(BehindWall {
                wall,
                length,
                share,
            })
        });
        parts.max_by(|a, b| a.length.total_cmp(&b.length))
    }

    /// Gaps of half to four spacings between the edges of a shut gate and the walls that it points to. Looked at from the middle of
    /// each edge; walls that move as a whole are left out.
    #[must_use]
    pub fn gaps_of(&self, gate: &Gate) -> Vec<Gap> {
        let middle = |along: f64, across: f64| -> Point {
            std::array::from_fn(|k| {
                gate.from[k] + along * (gate.to[k] - gate.from[k]) + across * gate.span[k]
            })
        };
        let edges = [
            ("from", middle(0.0, 0.5), middle(1.0, 0.5)),
            ("to", middle(1.0, 0.5), middle(0.0, 0.5)),
            ("the end of span", middle(0.5, 1.0), middle(0.5, 0.0)),
            ("the start of span", middle(0.5, 0.0), middle(0.5, 1.0)),
        ];
        let gaps = edges.into_iter().filter_map(|(edge, end, other)| {
            let (wall, width) = self.gap_beyond(&end, &other)?;
            Some(Gap { edge, wall, width })
        });
        gaps.collect()
    }

    /// The wall that a way out of a gate's edge, away from the opposite one, comes to first, and the width of the gap before it [m].
    fn gap_beyond(&self, end: &Point, other: &Point) -> Option<(usize, f64)> {
        let out: Point = std::array::from_fn(|k| end[k] - other[k]);
        let size = out.iter().map(|c| c * c).sum::<f64>().sqrt();
        if size == 0.0 {
            return None;
        }
        let (least, most) = (
            GAPS.0 * self.numerics.spacing,
            GAPS.1 * self.numerics.spacing,
        );
        let way = out.map(|c| c / size * most);
        let back = way.map(|c| -c);
        let far: Point = std::array::from_fn(|k| end[k] + way[k]);
        let mut nearest: Option<(usize, f64)> = None;
        let fixed = self.walls.iter().enumerate().filter(|(_, w)| !w.rigid);
        for (n, wall) in fixed {
            // What is behind a wall or at its face (one that goes on where the gate ends) has no gap to it. The way comes to a wall
            // where the way back leaves it.
            if leaves(&wall.geometry, end, &back).is_some() || away(&wall.geometry, end) <= least {
                return None;
            }
            if let Some(share) = leaves(&wall.geometry, &far, &back) {
                let width = (1.0 - share) * most;
                if nearest.is_none_or(|(_, least)| width < least) {
                    nearest = Some((n, width));
                }
            }
        }
        nearest.filter(|(_, width)| *width > least)
    }
}

/// Share of the way from `start` along `edge` at which it comes out of a wall that it begins in or behind; 1 if it never does
/// so. `None` if it begins elsewhere.
fn leaves(wall: &WallGeometry, start: &Point, edge: &Point) -> Option<f64> {
    match wall {
        WallGeometry::Box { lower, upper } => {
            // An axis without extent is that of a planar box.
            let axes = || (0..3).filter(|&k| upper[k] > lower[k]);
            if !axes().all(|k| start[k] > lower[k] && start[k] < upper[k]) {
                return None;
            }
            let exits = axes().filter(|&k| edge[k] != 0.0).map(|k| {
                let side = if edge[k] > 0.0 { upper[k] } else { lower[k] };
                (side - start[k]) / edge[k]
            });
            Some(exits.fold(1.0, f64::min))
        }
        WallGeometry::Plane { point, normal } => {
            let before: f64 = (0..3).map(|k| (start[k] - point[k]) * normal[k]).sum();
            let rise: f64 = (0..3).map(|k| edge[k] * normal[k]).sum();
            (before < 0.0).then(|| if -before < rise { -before / rise } else { 1.0 })
        }
        WallGeometry::Polyline { points, closed } => {
            let ends = points.iter().zip(points.iter().skip(1));
            let last = points.last().zip(points.first()).filter(|_| *closed);
            let first = ends
                .chain(last)
                .filter_map(|(a, b)| meets(start, edge, a, b))
                .min_by(|p, q| p.0.total_cmp(&q.0))?;
            first.1.then_some(first.0)
        }
    }
}

/// How far a place is from a wall's surface [m]; of boxes and planes 0 within.
fn away(wall: &WallGeometry, at: &Point) -> f64 {
    match wall {
        WallGeometry::Box { lower, upper } => {
            let axes = (0..3).filter(|&k| upper[k] > lower[k]);
            let beside = axes.map(|k| at[k] - at[k].clamp(lower[k], upper[k]));
            beside.map(|d| d * d).sum::<f64>().sqrt()
        }
        WallGeometry::Plane { point, normal } => {
            let before: f64 = (0..3).map(|k| (at[k] - point[k]) * normal[k]).sum();
            before.max(0.0)
        }
        WallGeometry::Polyline { points, closed } => {
            let ends = points.iter().zip(points.iter().skip(1));
            let last = points.last().zip(points.first()).filter(|_| *closed);
            ends.chain(last)
                .map(|(a, b)| {
                    let (way, to) = (sub(b, a), sub(&[at[0], at[1]], a));
                    let foot = (dot(&to, &way) / dot(&way, &way)).clamp(0.0, 1.0);
                    norm(&sub(&to, &scale(foot, &way)))
                })
                .fold(f64::INFINITY, f64::min)
        }
    }
}

/// Share of the way at which it crosses a segment with material on its left, and whether it comes to that side.
fn meets(start: &Point, edge: &Point, a: &[f64; 2], b: &[f64; 2]) -> Option<(f64, bool)> {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let (x, y) = (start[0] - a[0], start[1] - a[1]);
    let rate = dx * edge[1] - dy * edge[0];
    let way = (dy * x - dx * y) / rate;
    let along = (edge[1] * x - edge[0] * y) / rate;
    // Not a number where they are parallel.
    ((0.0..=1.0).contains(&way) && (0.0..=1.0).contains(&along)).then_some((way, rate > 0.0))
}

#[cfg(test)]
mod tests {
    use crate::scene::parse;

    /// A bed at y = 0 and a gate from a height on upwards, or downwards to it.
    fn tank(dimension: u8, wall: &str, gate: &str) -> crate::scene::Scene {
        let third = |value: &str| {
            if dimension == 3 {
                format!(", {value}")
            } else {
                String::new()
            }
        };
        let text = format!(
            "name = \"tank\"\ndimension = {dimension}\n[domain]\nlower = [0, -1{low}]\nupper = [2, 1{high}]\n\
             gravity = [0, -9.81{low}]\n\
             [numerics]\nspacing = 0.02\n[materials.water]\nlaw = \"fluid\"\npreset = \"water\"\n\
             [bodies.water]\nmaterial = \"water\"\nbox = {{ lower = [0, 0{low}], upper = [1, 0.3{high}] }}\n\
             [walls.bed]\n{wall}\n[gates.g]\n{gate}\n[run]\nstep = 0.01\nuntil = 1\n",
            low = third("0"),
            high = third("0.2"),
        );
        parse("tank", &text).unwrap_or_else(|e| panic!("{e}"))
    }

    fn behind(dimension: u8, wall: &str, gate: &str) -> Option<(f64, f64)> {
        let scene = tank(dimension, wall, gate);
        let part = scene.opening_behind_wall(&scene.gates[0])?;
        Some((part.length, part.share))
    }

    const BED: &str = "polyline = [[0, 0.5], [0, 0], [2, 0]]";

    #[test]
    fn an_opening_that_begins_below_the_bed_is_found_for_each_kind_of_wall() {
        let gate = "from = [1, -0.1]\nto = [1, 0.4]";
        for wall in [
            BED,
            "plane = { point = [0, 0], normal = [0, 1] }",
            "box = { lower = [0, -0.5], upper = [2, 0] }",
        ] {
            let (length, share) = behind(2, wall, gate).unwrap();
            assert!((length - 0.1).abs() < 1e-12, "{wall}: {length}");
            assert!((share - 0.2).abs() < 1e-12, "{wall}: {share}");
        }
        let gate = "from = [1.1, -0.1, 0]\nto = [1.1, 0.4, 0]\nspan = [0, 0, 0.2]";
        let gate = format!("{gate}\nthickness = 0.08");
        let plane = "plane = { point = [0, 0, 0], normal = [0, 1, 0] }";
        assert!((behind(3, plane, &gate).unwrap().0 - 0.1).abs() < 1e-12);
    }

    #[test]
    fn an_opening_that_lies_behind_a_plane_as_a_whole_is_found() {
        let plane = "plane = { point = [0, 0], normal = [0, 1] }";
        let (length, share) = behind(2, plane, "from = [1, -0.5]\nto = [1, -0.1]").unwrap();
        assert!(
            (length - 0.4).abs() < 1e-12 && share == 1.0,
            "{length} {share}"
        );
    }

    fn gaps(dimension: u8, wall: &str, gate: &str) -> Vec<(&'static str, f64)> {
        let scene = tank(dimension, wall, gate);
        let gaps = scene.gaps_of(&scene.gates[0]);
        gaps.iter().map(|gap| (gap.edge, gap.width)).collect()
    }

    #[test]
    fn gaps_beside_a_shut_gate_are_found_for_each_kind_of_wall() {
        for wall in [
            BED,
            "plane = { point = [0, 0], normal = [0, 1] }",
            "box = { lower = [0, -0.5], upper = [2, 0] }",
        ] {
            for (gate, edge) in [
                ("from = [1.5, 0.03]\nto = [1.5, 0.4]", "from"),
                ("from = [1.5, 0.4]\nto = [1.5, 0.03]", "to"),
            ] {
                let found = gaps(2, wall, gate);
                let [(name, width)] = found[..] else {
                    panic!("{wall}: {found:?}");
                };
                assert!(
                    name == edge && (width - 0.03).abs() < 1e-12,
                    "{wall}: {name} {width}"
                );
            }
            for gate in [
                "from = [1.5, 0]\nto = [1.5, 0.4]",
                "from = [1.5, 0.009]\nto = [1.5, 0.4]",
                "from = [1.5, 0.1]\nto = [1.5, 0.4]",
                "from = [1.5, -0.03]\nto = [1.5, 0.4]",
            ] {
                assert_eq!(gaps(2, wall, gate), [], "{wall}: {gate}");
            }
        }
        // A shelf that goes on where the gate ends, and the wall that it starts from.
        for wall in [
            "polyline = [[1.2, 0.5], [1.2, 0], [1.23, 0]]",
            "box = { lower = [1.1, -0.1], upper = [1.23, 0] }\n[walls.side]\nbox = { lower = [1.1, 0], upper = [1.2, 0.5] }",
        ] {
            assert_eq!(
                gaps(2, wall, "from = [1.23, 0]\nto = [1.7, 0]"),
                [],
                "{wall}"
            );
            assert_eq!(
                gaps(2, wall, "from = [1.7, 0]\nto = [1.23, 0]"),
                [],
                "{wall}"
            );
            let beside = gaps(2, wall, "from = [1.26, 0.1]\nto = [1.7, 0.1]");
            assert!(
                matches!(beside[..], [("from", width)] if (width - 0.06).abs() < 1e-12),
                "{wall}: {beside:?}"
            );
        }
        let side = "plane = { point = [0, 0, 0.2], normal = [0, 0, -1] }";
        let gate = "from = [1.5, 0, 0]\nto = [1.5, 0.4, 0]\nspan = [0, 0, 0.16]\nthickness = 0.08";
        let found = gaps(3, side, gate);
        assert!(
            matches!(found[..], [("the end of span", width)] if (width - 0.04).abs() < 1e-12),
            "{found:?}"
        );
    }

    #[test]
    fn gates_that_stand_on_the_bed_or_are_sealed_by_a_spacing_or_retract_into_a_wall_are_not() {
        for gate in [
            "from = [1.5, 0]\nto = [1.5, 0.4]",
            "from = [1.5, -0.02]\nto = [1.5, 0.4]",
            "from = [1.5, 0.4]\nto = [1.5, -0.1]",
            "from = [1.5, 0.1]\nto = [1.5, 0.4]",
        ] {
            assert_eq!(behind(2, BED, gate), None, "{gate}");
        }
    }
}
