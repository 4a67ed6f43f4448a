//! Where a box and another wall share no more than an edge, the two bodies touch in a line (in the plane: a point), and a fluid seeps
//! through between them. Of the two quarters of space beside them material has one; the other is filled, as it is behind the corner of a
//! polyline.

use crate::boundary::{ROWS, WallPoints};
use crate::math::{Vector, dot, norm, scale, sub};

use super::{Face, Solid, Standing};
use crate::scene::build::narrow;
use crate::scene::build::places::{Places, STANDS, TAKEN};
use crate::scene::{Dimension, Scene};

/// A point that fills.
pub(super) struct Fill<const D: usize> {
    pub(super) place: Vector<D>,
    pub(super) normal: Vector<D>,
    pub(super) group: u16,
}

/// What says where there is something to fill.
struct Site<const D: usize> {
    walls: Places<D>,
    /// Walls of these points.
    groups: Vec<u16>,
    /// Walls, shut gates and particles.
    taken: Places<D>,
    /// Particles, and where inflows let them in.
    material: Vec<Vector<D>>,
    gravity: Vector<D>,
    rings: bool,
    spacing: f64,
}

/// An edge of a box as it meets another wall: rows are counted out of `end` and into the box from `front`.
#[derive(Clone, Copy)]
struct Edge<'a, const D: usize> {
    solid: &'a Solid<D>,
    /// The face beyond which is filled.
    end: Face,
    /// The face that looks to the material.
    front: Face,
}

impl<const D: usize> Edge<'_, D> {
    /// The place so many steps beyond the end and before the front, at `base` along the edge.
    fn at(&self, base: &Vector<D>, beyond: f64, before: f64) -> Vector<D> {
        let mut x = *base;
        x[self.end.axis] = self.solid.out_of(self.end, beyond);
        x[self.front.axis] = self.solid.out_of(self.front, before);
        x
    }

    /// Points of the box's lattice along the edge.
    fn bases(&self) -> Vec<Vector<D>> {
        let solid = self.solid;
        let free = (0..D).filter(|k| ![self.end.axis, self.front.axis].contains(k));
        free.fold(vec![solid.lower], |bases, k| {
            let along = |n: usize| solid.lower[k] + (n as f64 + 0.5) * solid.step[k];
            let spread = bases.iter().flat_map(|base| {
                (0..solid.count[k]).map(move |n| {
                    let mut x = *base;
                    x[k] = along(n);
                    x
                })
            });
            spread.collect()
        })
    }
}

pub(super) fn fills<const D: usize>(
    scene: &Scene,
    points: &WallPoints<D>,
    solids: &[&Solid<D>],
    standing: &Standing<'_, D>,
) -> Vec<Fill<D>> {
    let site = Site::new(scene, points, standing);
    let mut fills = Vec::new();
    for solid in solids {
        for end in Face::all::<D>() {
            let fronts = Face::all::<D>().filter(|front| front.axis != end.axis);
            for front in fronts {
                site.fill_edge(&Edge { solid, end, front }, &mut fills);
            }
        }
    }
    if D == 3 {
        for solid in solids {
            site.fill_corners(solid, &mut fills);
        }
    }
    fills
}

impl<const D: usize> Site<D> {
    fn new(scene: &Scene, points: &WallPoints<D>, standing: &Standing<'_, D>) -> Self {
        let spacing = scene.numerics.spacing;
        let fixed = |i: &usize| !scene.walls[usize::from(points.group[*i])].rigid;
        let own: Vec<usize> = (0..points.len()).filter(fixed).collect();
        let walls: Vec<Vector<D>> = own.iter().map(|&i| points.position[i]).collect();
        let taken = [&walls[..], &standing.plates, standing.grains].concat();
        Self {
            walls: Places::new(&walls, spacing, &standing.sides),
            groups: own.iter().map(|&i| points.group[i]).collect(),
            taken: Places::new(&taken, spacing, &standing.sides),
            material: [standing.grains, &standing.slots].concat(),
            gravity: narrow(&scene.domain.gravity),
            rings: scene.dimension == Dimension::Axisymmetric,
            spacing,
        }
    }

    /// The other wall at a place on the edge, if the two touch there and nowhere else, and the quarter in front is the material's.
    fn meets(&self, edge: &Edge<'_, D>, base: &Vector<D>) -> Option<u16> {
        let stands = |x: &Vector<D>| self.walls.nearest(x, STANDS, |_| true);
        let other = stands(&edge.at(base, 0.5, 0.5))?;
        let (front, gap) = (edge.at(base, -0.5, 0.5), edge.at(base, 0.5, -0.5));
        let alone = stands(&front).is_none() && stands(&gap).is_none();
        (alone && self.is_in_front(&front, &gap)).then(|| self.groups[other])
    }

    /// Whether material comes to the one place before the other: the nearer one, of two as near the higher.
    fn is_in_front(&self, front: &Vector<D>, gap: &Vector<D>) -> bool {
        let nearest = |x: &Vector<D>| {
            let distances = self.material.iter().map(|y| norm(&sub(x, y)));
            distances.fold(f64::INFINITY, f64::min)
        };
        let (near, far) = (nearest(front), nearest(gap));
        if near.is_finite() && (far - near).abs() > 0.1 * self.spacing {
            return near < far;
        }
        dot(&self.gravity, &sub(gap, front)) > 0.0
    }

    fn fill_edge(&self, edge: &Edge<'_, D>, fills: &mut Vec<Fill<D>>) {
        let deep = ROWS.min(edge.solid.count[edge.front.axis]);
        for base in edge.bases() {
            let Some(other) = self.meets(edge, &base) else {
                continue;
            };
            for (i, j) in (0..ROWS).flat_map(|i| (0..deep).map(move |j| (i, j))) {
                let place = edge.at(&base, i as f64 + 0.5, -(j as f64 + 0.5));
                // Whose row is deeper here, as behind the corner of a polyline.
                let (normal, group) = if j >= i {
                    (edge.front.normal(), edge.solid.group)
                } else {
                    (scale(-1.0, &edge.end.normal()), other)
                };
                self.fill(
                    Fill {
                        place,
                        normal,
                        group,
                    },
                    fills,
                );
            }
        }
    }

    fn fill(&self, new: Fill<D>, fills: &mut Vec<Fill<D>>) {
        let beyond_axis = self.rings && new.place[0] <= 0.0;
        let room = TAKEN * self.spacing;
        let taken = self.taken.has(&new.place, TAKEN)
            || fills
                .iter()
                .any(|f| norm(&sub(&f.place, &new.place)) < room);
        if !beyond_axis && !taken {
            fills.push(new);
        }
    }

    /// Where filled edges meet in space, the eighth behind all of them.
    fn fill_corners(&self, solid: &Solid<D>, fills: &mut Vec<Fill<D>>) {
        let edges = fills.len();
        for front in Face::all::<D>() {
            let ends: Vec<Face> = Face::all::<D>().filter(|f| f.axis != front.axis).collect();
            for (n, &a) in ends.iter().enumerate() {
                for &b in ends[n + 1..].iter().filter(|b| b.axis != a.axis) {
                    self.fill_corner(solid, [a, b, front], edges, fills);
                }
            }
        }
    }

    fn fill_corner(
        &self,
        solid: &Solid<D>,
        [a, b, front]: [Face; 3],
        edges: usize,
        fills: &mut Vec<Fill<D>>,
    ) {
        let at = |beyond_a: f64, beyond_b: f64, before: f64| {
            let mut x = solid.lower;
            x[a.axis] = solid.out_of(a, beyond_a);
            x[b.axis] = solid.out_of(b, beyond_b);
            x[front.axis] = solid.out_of(front, before);
            x
        };
        let near = |x: Vector<D>| {
            let filled = fills[..edges].iter();
            filled
                .map(|f| (norm(&sub(&f.place, &x)), f))
                .find(|(r, _)| *r < STANDS * self.spacing)
        };
        let (Some(_), Some((_, beside))) = (near(at(0.5, -0.5, -0.5)), near(at(-0.5, 0.5, -0.5)))
        else {
            return;
        };
        let group = beside.group;
        let deep = ROWS.min(solid.count[front.axis]);
        for i in 0..ROWS {
            for (j, k) in (0..ROWS).flat_map(|j| (0..deep).map(move |k| (j, k))) {
                let row = |n: usize| n as f64 + 0.5;
                let normal = front.normal();
                let place = at(row(i), row(j), -row(k));
                self.fill(
                    Fill {
                        place,
                        normal,
                        group,
                    },
                    fills,
                );
            }
        }
    }
}
