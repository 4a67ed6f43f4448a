//! Which way a point of a box looks: a face that another wall covers is nobody's, and what is nearest to it belongs to the next one. A
//! block that stands on a floor would else bear downwards what the water beside it pushes on its foot.

use crate::boundary::WallPoints;
use crate::math::{Vector, add, scale};

use super::{Face, Solid};
use crate::scene::Scene;
use crate::scene::build::places::{Places, STANDS};

/// Gives each point of the boxes the normal of the nearest face that nothing covers there; of the nearest one where all are covered.
pub(super) fn face_openly<const D: usize>(
    scene: &Scene,
    points: &mut WallPoints<D>,
    solids: &[Solid<D>],
    sides: &[Option<(f64, f64)>; D],
) {
    let spacing = scene.numerics.spacing;
    let fixed = |group: u16| !scene.walls[usize::from(group)].rigid;
    let places = Places::new(&points.position, spacing, sides);
    for solid in solids {
        let group = &points.group;
        let covered = |x: &Vector<D>, face: Face| {
            let mut foot = *x;
            foot[face.axis] = solid.out_of(face, 0.0);
            let beyond = add(&foot, &scale(0.5 * spacing, &face.normal()));
            // What moves may leave a box that stays, and seldom what it slides on.
            let covers = |other: u16| fixed(other) || !fixed(solid.group);
            let other = |n: usize| group[n] != solid.group && covers(group[n]);
            places.nearest(&beyond, STANDS, other).is_some()
        };
        let mut found = Vec::new();
        for n in (0..points.len()).filter(|&n| group[n] == solid.group) {
            let x = &points.position[n];
            let inside = (0..D).all(|k| x[k] > solid.lower[k] && x[k] < solid.upper[k]);
            let mut faces: Vec<Face> = Face::all::<D>().collect();
            let depth = |f: &Face| f.side * (solid.out_of(*f, 0.0) - x[f.axis]);
            faces.sort_by(|a, b| depth(a).total_cmp(&depth(b)));
            let open = faces.iter().find(|face| !covered(x, **face));
            if let Some(face) = open.filter(|_| inside) {
                found.push((n, face.normal()));
            }
        }
        for (n, normal) in found {
            points.normal[n] = normal;
        }
    }
}
