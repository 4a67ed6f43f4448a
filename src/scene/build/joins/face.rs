//! Which way a point of a box looks: a face that another wall covers is nobody's, and what is nearest to it belongs to the next one. A
//! block that stands on a floor would else bear downwards what the water beside it pushes on its foot. So is an end that the box's own
//! image across a period covers. Where a box reaches into another wall, the face that it shows beside that wall goes on inside.

use crate::boundary::WallPoints;
use crate::math::{Vector, add, dot, norm, scale, sub};

use super::{Face, Solid};
use crate::scene::Scene;
use crate::scene::build::places::{Places, STANDS};

/// How squarely a wall looks against a face that it hides, at least: cosine of the angle between the two [1].
const SQUARELY: f64 = 0.71;

/// Distance within which a wall looks at a point that lies in it, over the spacing [1]: round the edge where it meets another one.
const BESIDE: f64 = 1.5;

/// Gives each point of the boxes the normal of the nearest face that nothing covers there; of the nearest one where all that it is seen
/// from are covered.
pub(super) fn face_openly<const D: usize>(
    scene: &Scene,
    points: &mut WallPoints<D>,
    solids: &[Solid<D>],
    sides: &[Option<(f64, f64)>; D],
) {
    let places = Places::new(&points.position, scene.numerics.spacing, sides);
    let rigid = |solid: &&Solid<D>| scene.walls[usize::from(solid.group)].rigid;
    // Boxes that move last: they may reach into one that stays, and ask which way it looks.
    let (moving, fixed): (Vec<_>, Vec<_>) = solids.iter().partition(rigid);
    for solid in fixed.into_iter().chain(moving) {
        let amid = Amid {
            scene,
            points,
            places: &places,
            solid,
        };
        let own = (0..points.len()).filter(|&n| points.group[n] == solid.group);
        let open = own.filter_map(|n| Some((n, amid.open_normal(&points.position[n])?)));
        let found: Vec<_> = open.collect();
        for (n, normal) in found {
            points.normal[n] = normal;
        }
    }
}

/// A box amid the points of all walls.
struct Amid<'a, const D: usize> {
    scene: &'a Scene,
    points: &'a WallPoints<D>,
    places: &'a Places<D>,
    solid: &'a Solid<D>,
}

impl<const D: usize> Amid<'_, D> {
    /// Normal of the nearest open face that sees a place in the box; `None` outside, or where none does.
    fn open_normal(&self, x: &Vector<D>) -> Option<Vector<D>> {
        let solid = self.solid;
        let inside = (0..D).all(|k| x[k] > solid.lower[k] && x[k] < solid.upper[k]);
        let depth = |f: &Face| f.side * (solid.out_of(*f, 0.0) - x[f.axis]);
        // Particles stand half a spacing before a face and see no further than the kernel does. A floor that goes on under a wall would
        // else look, in the corner of the two, towards its own far end.
        let numerics = &self.scene.numerics;
        let deepest = (2.0 * numerics.smoothing_ratio - 0.5) * numerics.spacing;
        let mut faces: Vec<Face> = Face::all::<D>().filter(|f| depth(f) < deepest).collect();
        faces.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
        let around = self.around(x);
        let open = faces.iter().find(|face| !self.is_covered(x, face, &around));
        let open = open.or_else(|| faces.iter().find(|face| !self.is_shut(x, face)));
        open.filter(|_| inside).map(|face| face.normal())
    }

    /// Whether what covers a face looks against it. A wall that stands on it does not: the face goes on under that.
    fn is_shut(&self, x: &Vector<D>, face: &Face) -> bool {
        let beyond = self.beyond(x, face);
        let against = |n: usize| dot(&self.points.normal[n], &face.normal()) < -SQUARELY;
        let shuts = |n: usize| self.hides(n) && against(n) || self.is_image(n, &beyond);
        self.places.nearest(&beyond, STANDS, shuts).is_some()
    }

    /// Whether what stands at a place is a point of this box across a period.
    fn is_image(&self, n: usize, place: &Vector<D>) -> bool {
        let direct = norm(&sub(place, &self.points.position[n]));
        self.points.group[n] == self.solid.group && direct > STANDS * self.scene.numerics.spacing
    }

    /// Half a spacing before a face, across from a place.
    fn beyond(&self, x: &Vector<D>, face: &Face) -> Vector<D> {
        let mut foot = *x;
        foot[face.axis] = self.solid.out_of(*face, 0.0);
        add(
            &foot,
            &scale(0.5 * self.scene.numerics.spacing, &face.normal()),
        )
    }

    /// Points of other walls around a place that lies in one, not only beside it.
    fn around(&self, x: &Vector<D>) -> Vec<usize> {
        let spacing = self.scene.numerics.spacing;
        let step = self.solid.step.iter().fold(spacing, |a, b| a.min(*b));
        // What only touches is half a step and half a spacing away.
        let in_it = STANDS * 0.5 * (1.0 + step / spacing);
        if self.places.nearest(x, in_it, |n| self.hides(n)).is_none() {
            return Vec::new();
        }
        self.places.within(x, BESIDE, |n| self.hides(n))
    }

    /// Whether a face is covered before a place in the box that these points lie around.
    fn is_covered(&self, x: &Vector<D>, face: &Face, around: &[usize]) -> bool {
        let beyond = self.beyond(x, face);
        let against = |n: usize| dot(&self.points.normal[n], &face.normal()) < -SQUARELY;
        // The wall that the box reaches into goes on before faces that it looks past, too.
        let other = |n: usize| self.hides(n) && (around.is_empty() || against(n));
        let covers = |n: usize| other(n) || self.is_image(n, &beyond);
        around.iter().any(|&n| against(n)) || self.places.nearest(&beyond, STANDS, covers).is_some()
    }

    /// Whether a point is of another wall that may hide this box: what moves may leave a box that stays, and seldom what it slides on.
    fn hides(&self, n: usize) -> bool {
        let rigid = |group: u16| self.scene.walls[usize::from(group)].rigid;
        let group = self.points.group[n];
        group != self.solid.group && (rigid(self.solid.group) || !rigid(group))
    }
}
