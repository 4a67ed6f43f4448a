//! Faces with Coulomb friction as particles see them: gathered while walls are swept (`wall_row`), rubbed on in the viscous
//! solve (`wall_friction`).

use crate::math::{Vector, dot, scale, sub};

/// A face with friction, as one particle sees it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact<const D: usize> {
    /// The particle.
    pub(super) i: u32,
    /// Group of the wall or gate.
    pub(super) group: u16,
    /// Unit normal towards the material.
    pub(super) normal: Vector<D>,
    /// Area a [m^2].
    pub(super) area: f64,
    /// Sum of a v_w over the face's points [m^3/s].
    pub(super) drive: Vector<D>,
}

impl<const D: usize> Contact<D> {
    /// Adds a face that particle i sees to the contacts of its row, which begin at `first`: area [m^2], and sum of area v_w
    /// over its points [m^3/s].
    pub(super) fn gather(
        contacts: &mut Vec<Self>,
        first: usize,
        (i, group): (usize, u16),
        normal: &Vector<D>,
        area: f64,
        drive: &Vector<D>,
    ) {
        let same = |c: &&mut Self| c.group == group && same_normal(&c.normal, normal);
        if let Some(contact) = contacts[first..].iter_mut().find(same) {
            contact.area += area;
            for k in 0..D {
                contact.drive[k] += drive[k];
            }
        } else {
            contacts.push(Self {
                i: i as u32,
                group,
                normal: *normal,
                area,
                drive: *drive,
            });
        }
    }

    /// P a.
    #[inline]
    pub(super) fn along(&self, a: &Vector<D>) -> Vector<D> {
        sub(a, &scale(dot(a, &self.normal), &self.normal))
    }
}

/// Whether two faces go on from each other.
pub(super) fn same_normal<const D: usize>(a: &Vector<D>, b: &Vector<D>) -> bool {
    dot(a, b) > 1.0 - 1e-9
}
