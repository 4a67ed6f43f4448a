//! What of a scene gets into the way of something else: gates of each other, walls that move of walls that stand, bodies of plates
//! that go up. No rules: all of it can be computed, and is seldom meant.

use super::{Dimension, Gate, Point, Scene, WallGeometry, narrow, plate, rigid_motion, solid};
use crate::gauge::Solid;
use crate::math::{Vector, add, apply, cross, dot, norm, scale, sub};

/// A wall that moves gets into one that stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meeting {
    /// Index into [`Scene::walls`] of the one that moves.
    pub wall: usize,
    /// The one that stands.
    pub with: usize,
    /// When it is a spacing deep in it [s]; of one that is steered, the time that the way there takes at full speed, negative if that is backwards.
    pub time: f64,
}

/// Places of walls that move times pieces of walls that stand, over all poses that are looked at: some tenths of a second. Longer ways are
/// looked at in longer steps.
const MOST_TESTS: f64 = 1e7;

impl Scene {
    /// Pairs of gates whose shut plates share room, more than half a spacing across: indices into [`Scene::gates`].
    #[must_use]
    pub fn overlapping_gates(&self) -> Vec<(usize, usize)> {
        let count = self.gates.len();
        let pairs = (0..count).flat_map(|a| (a + 1..count).map(move |b| (a, b)));
        pairs
            .filter(|&(a, b)| {
                let (a, b) = (&self.gates[a], &self.gates[b]);
                match self.dimension {
                    Dimension::Three => self.share_room::<3>(a, b),
                    Dimension::Two | Dimension::Axisymmetric => self.share_room::<2>(a, b),
                }
            })
            .collect()
    }

    fn share_room<const D: usize>(&self, a: &Gate, b: &Gate) -> bool {
        let block = |gate: &Gate| match plate::<D>(gate, 0.0) {
            Solid::Block { corner, edges } => Some((corner, edges)),
            _ => None,
        };
        let (Some(a), Some(b)) = (block(a), block(b)) else {
            return false;
        };
        blocks_overlap(&a, &b, 0.5 * self.numerics.spacing)
    }

    /// A body that begins where a gate's plate would be when it is open, a spacing beyond `to` and half way behind the face.
    #[must_use]
    pub fn body_beyond(&self, gate: &Gate) -> Option<usize> {
        match self.dimension {
            Dimension::Three => self.body_at_plate::<3>(gate),
            Dimension::Two | Dimension::Axisymmetric => self.body_at_plate::<2>(gate),
        }
    }

    fn body_at_plate<const D: usize>(&self, gate: &Gate) -> Option<usize> {
        let Solid::Block { corner, edges } = plate::<D>(gate, 0.0) else {
            return None;
        };
        let way = edges[0];
        let past = scale(1.0 + self.numerics.spacing / norm(&way), &way);
        // The plate's own way first, then its other edges by half.
        let middle = edges[1..]
            .iter()
            .fold(corner, |x, edge| add(&x, &scale(0.5, edge)));
        let place = self.in_period(add(&middle, &past));
        let wide: Point = std::array::from_fn(|k| place.get(k).copied().unwrap_or(0.0));
        self.bodies.iter().position(|body| {
            let up = self.up();
            let is_filled = body.level.is_none_or(|level| dot(&wide, &up) < level);
            is_filled && body.shape.contains(&wide)
        })
    }

    /// Walls that move as a whole and come to be a spacing deep in one that stands, until the run's end or between their end stops, each
    /// with the first.
    #[must_use]
    pub fn meetings(&self) -> Vec<Meeting> {
        match self.dimension {
            Dimension::Three => self.meetings_in::<3>(),
            Dimension::Two | Dimension::Axisymmetric => self.meetings_in::<2>(),
        }
    }

    fn meetings_in<const D: usize>(&self) -> Vec<Meeting> {
        let dp = self.numerics.spacing;
        let standing = self.walls.iter().enumerate().filter(|(_, w)| !w.rigid);
        let standing: Vec<(usize, Solid<D>)> = standing
            .map(|(n, wall)| (n, solid(&wall.geometry, dp)))
            .collect();
        let moving = self.walls.iter().enumerate().filter(|(_, w)| w.rigid);
        let movers = moving.clone().count();
        let first = moving.filter_map(|(n, wall)| {
            let motion = rigid_motion::<D>(&wall.velocity, wall.rotation.as_ref());
            let places = rim::<D>(&wall.geometry, dp);
            let arms = places.iter().map(|x| norm(&sub(x, &motion.centre)));
            let speed = norm(&motion.velocity) + motion.rate.abs() * arms.fold(0.0, f64::max);
            // What only turns is back after a turn.
            let only_turns = motion.velocity == [0.0; D] && motion.rate != 0.0;
            let turn = std::f64::consts::TAU / motion.rate.abs();
            // Ways from where it is drawn; backwards they take negative times.
            let ends = match &wall.drive {
                // Nobody knows how far one without end stops will go.
                Some(drive) if drive.stops.1.is_infinite() => return None,
                Some(drive) => vec![drive.stops.1 / drive.full, drive.stops.0 / drive.full],
                None => vec![self.run.until],
            };
            let end_of = |way: f64| match only_turns {
                true => way.clamp(-turn, turn),
                false => way,
            };
            let places_at = |time: f64| -> Vec<Vector<D>> {
                let (turn, centre) = (motion.rotation_at(time), motion.centre_at(time));
                let arms = places.iter().map(|x| sub(x, &motion.centre));
                arms.map(|arm| self.in_period(add(&centre, &apply(&turn, &arm))))
                    .collect()
            };
            let meets = |places: &[Vector<D>], with: &Solid<D>| {
                places.iter().any(|x| with.holds_deep(x, dp))
            };
            let start = places_at(0.0);
            let apart: Vec<&(usize, Solid<D>)> =
                standing.iter().filter(|(_, s)| !meets(&start, s)).collect();
            if apart.is_empty() {
                return None;
            }
            let pieces: usize = apart.iter().map(|(_, s)| pieces(s)).sum();
            let most = MOST_TESTS / (movers * places.len() * pieces).max(1) as f64;
            ends.into_iter().map(end_of).find_map(|until| {
                let poses = (until.abs() * speed / (0.5 * dp)).ceil().min(most.ceil());
                (1..=poses as u64).find_map(|pose| {
                    let time = until * pose as f64 / poses;
                    let places = places_at(time);
                    let with = apart.iter().find(|(_, s)| meets(&places, s))?.0;
                    Some(Meeting {
                        wall: n,
                        with,
                        time,
                    })
                })
            })
        });
        first.collect()
    }

    /// The place in the domain that a place beyond periodic sides is.
    fn in_period<const D: usize>(&self, mut x: Vector<D>) -> Vector<D> {
        let domain = &self.domain;
        for (k, x) in x
            .iter_mut()
            .enumerate()
            .filter(|(k, _)| domain.periodic[*k])
        {
            let lower = domain.lower[k];
            *x = lower + (*x - lower).rem_euclid(domain.upper[k] - lower);
        }
        x
    }
}

/// Segments of a chain; 1 of all else.
fn pieces<const D: usize>(solid: &Solid<D>) -> usize {
    match solid {
        Solid::Chain { points, .. } => points.len(),
        Solid::Behind { .. } | Solid::Block { .. } => 1,
    }
}

/// Whether two boxes in any pose, given by a corner and the edges from there, share more than `slack` across every way that parts boxes.
fn blocks_overlap<const D: usize>(
    a: &(Vector<D>, [Vector<D>; D]),
    b: &(Vector<D>, [Vector<D>; D]),
    slack: f64,
) -> bool {
    let mut ways: Vec<Vector<D>> = a.1.iter().chain(&b.1).copied().collect();
    if D == 3 {
        let three = |v: &Vector<D>| std::array::from_fn(|k| v[k]);
        let crossed =
            a.1.iter()
                .flat_map(|p| b.1.iter().map(move |q| cross(&three(p), &three(q))));
        ways.extend(crossed.map(|c| std::array::from_fn(|k| c[k])));
    }
    let span = |(corner, edges): &(Vector<D>, [Vector<D>; D]), way: &Vector<D>| {
        let start = dot(corner, way);
        let parts = edges.map(|edge| dot(&edge, way));
        let below: f64 = parts.iter().map(|p| p.min(0.0)).sum();
        let above: f64 = parts.iter().map(|p| p.max(0.0)).sum();
        (start + below, start + above)
    };
    let longest = a.1.iter().chain(&b.1).map(norm).fold(0.0, f64::max);
    ways.iter().all(|way| {
        let size = norm(way);
        // Of edges that are parallel.
        if size <= 1e-9 * longest {
            return true;
        }
        let way = scale(1.0 / size, way);
        let ((from, to), (other_from, other_to)) = (span(a, &way), span(b, &way));
        to.min(other_to) - from.max(other_from) > slack
    })
}

/// Places along the edges of a wall at time 0, at most two spacings apart; none of a plane, which does not move.
fn rim<const D: usize>(geometry: &WallGeometry, spacing: f64) -> Vec<Vector<D>> {
    let edges: Vec<(Vector<D>, Vector<D>)> = match geometry {
        WallGeometry::Plane { .. } => Vec::new(),
        WallGeometry::Polyline { points, closed } => {
            let wide = |x: &[f64; 2]| narrow(&[x[0], x[1], 0.0]);
            let ends = points.iter().zip(points.iter().skip(1));
            let last = points.last().zip(points.first()).filter(|_| *closed);
            ends.chain(last).map(|(a, b)| (wide(a), wide(b))).collect()
        }
        WallGeometry::Box { lower, upper } => {
            let (lower, upper) = (narrow::<D>(lower), narrow::<D>(upper));
            let corner = |n: usize| -> Vector<D> {
                std::array::from_fn(|k| if n >> k & 1 == 1 { upper[k] } else { lower[k] })
            };
            let from = |n: usize| (0..D).filter(move |k| n >> k & 1 == 0);
            let all = (0..1 << D).flat_map(|n| from(n).map(move |k| (n, n | 1 << k)));
            all.map(|(n, m)| (corner(n), corner(m))).collect()
        }
    };
    let places = edges.iter().flat_map(|(a, b)| {
        let way = sub(b, a);
        let count = (norm(&way) / (2.0 * spacing)).ceil().max(1.0);
        (0..=count as u64).map(move |n| add(a, &scale(n as f64 / count, &way)))
    });
    places.collect()
}

#[cfg(test)]
mod tests {
    use crate::scene::{Meeting, Scene, parse};

    fn tank(body: &str, more: &str) -> Scene {
        let text = format!(
            "name = \"tank\"\n[domain]\nlower = [0, -0.2]\nupper = [1, 1]\n[numerics]\nspacing = 0.01\n\
             [materials.water]\nlaw = \"fluid\"\npreset = \"water\"\n\
             [bodies.water]\nmaterial = \"water\"\nbox = {{ {body} }}\n\
             [walls.tank]\npolyline = [[0, 0.6], [0, 0], [0.5, 0], [0.5, 0.6]]\n{more}\n[run]\nstep = 0.01\nuntil = 2\n"
        );
        parse("tank", &text).unwrap_or_else(|e| panic!("{e}"))
    }

    const ASIDE: &str = "lower = [0.7, 0], upper = [0.8, 0.1]";

    #[test]
    fn gates_that_share_room_are_found() {
        let gates = |b: &str| {
            let scene = tank(
                ASIDE,
                &format!("[gates.a]\nfrom = [0.3, 0]\nto = [0.3, 0.2]\n[gates.b]\n{b}"),
            );
            scene.overlapping_gates()
        };
        for (b, overlap) in [
            ("from = [0.3, 0.1]\nto = [0.3, 0.4]", true),
            ("from = [0.3, 0.2]\nto = [0.3, 0.4]", false),
            // Its body, four spacings to the right.
            ("from = [0.32, 0.1]\nto = [0.32, 0.4]", true),
            ("from = [0.34, 0.1]\nto = [0.34, 0.4]", false),
            // Across, and askew beside it.
            ("from = [0.4, 0.1]\nto = [0.2, 0.1]", true),
            ("from = [0.36, 0]\nto = [0.46, 0.1]", false),
        ] {
            let found = gates(b);
            assert_eq!(found.len(), usize::from(overlap), "{b}: {found:?}");
        }
    }

    #[test]
    fn a_body_where_an_opened_plate_would_be_is_found() {
        let beyond = |gate: &str| {
            let scene = tank(
                "lower = [0, 0.1], upper = [0.3, 0.2]",
                &format!("[gates.g]\n{gate}"),
            );
            scene.body_beyond(&scene.gates[0])
        };
        assert_eq!(beyond("from = [0.2, 0]\nto = [0.2, 0.1]"), Some(0));
        // It goes down into the floor, and off to the side.
        assert_eq!(beyond("from = [0.2, 0.1]\nto = [0.2, 0]"), None);
        assert_eq!(beyond("from = [0.4, 0.1]\nto = [0.5, 0.1]"), None);
    }

    #[test]
    fn a_wall_that_drives_into_one_that_stands_is_found_with_the_time() {
        let meet = |wall: &str| {
            let scene = tank(ASIDE, &format!("[walls.bar]\nmotion = \"rigid\"\n{wall}"));
            scene.meetings()
        };
        let bar = "box = { lower = [0.3, 0.3], upper = [0.36, 0.4] }";
        let found = meet(&format!("{bar}\nvelocity = [0.5, 0]"));
        let [
            Meeting {
                wall: 1,
                with: 0,
                time,
            },
        ] = found[..]
        else {
            panic!("{found:?}");
        };
        // 0.15 m to the side's face and a spacing into it.
        assert!((time - 0.3).abs() < 0.011, "{time}");
        let steered = meet(&format!(
            "{bar}\nvelocity = [0.05, 0]\ninput = \"speed\"\nstroke = 0.2"
        ));
        assert!((steered[0].time - 3.0).abs() < 0.11, "{steered:?}");
        let back = meet(&format!(
            "{bar}\nvelocity = [-0.05, 0]\ninput = \"speed\"\nstroke = 0.1\nstroke_back = 0.2"
        ));
        assert!((back[0].time + 3.0).abs() < 0.11, "{back:?}");
        for free in [
            // Up between two ledges, flush with both, and down onto the tank's rims.
            format!("{bar}\nvelocity = [0, 0.2]\n[walls.a]\npolyline = [[0.3, 0.5], [0.1, 0.5]]\n[walls.b]\npolyline = [[0.48, 0.5], [0.36, 0.5]]"),
            "box = { lower = [0, 0.8], upper = [0.5, 0.85] }\nvelocity = [0, -0.1]".to_owned(),
            format!("{bar}\nvelocity = [0, 0.5]"),
            // Not within the run, not before the end stop.
            format!("{bar}\nvelocity = [0.06, 0]"),
            format!("{bar}\nvelocity = [0.5, 0]\ninput = \"position\"\nstroke = 0.13"),
            // A piston between the sides, and a paddle.
            "box = { lower = [0, 0.5], upper = [0.5, 0.55] }\nvelocity = [0, -0.2]".to_owned(),
            "box = { lower = [0.2, 0.3], upper = [0.3, 0.32] }\nangular_velocity = 3\ncentre = [0.25, 0.31]".to_owned(),
        ] {
            assert_eq!(meet(&free), [], "{free}");
        }
    }
}
