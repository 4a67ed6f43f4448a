//! What of a gate's opening lies behind a wall. No rule: a plate may be sealed into the wall that it stands on.

use super::{Gate, Point, Scene, WallGeometry};

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
