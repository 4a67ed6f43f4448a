//! The faces that one particle sees, one after the other, and what they come to for its row (docs/theory.md, E14, W4, W7).
//!
//! Symbols as in `wall_row`.

use crate::math::{Tensor, Vector, add_outer, apply, dot, norm, scale, skew, trace};

use super::Solver;
use super::bend::{Bend, Turning};
use super::face_sums::FaceSums;
use super::flat_face::FlatFace;
use super::pair::WallRow;
use super::wall_contact::Contact;

/// Sums over the faces that particle i sees, while its wall points are swept.
pub(super) struct WallFaces<'s, const D: usize> {
    solver: &'s Solver<D>,
    i: usize,
    row: WallRow<D>,
    flat: FlatFace<D>,
    turning: Turning<D>,
    /// The face that points are being added to: those before it are in the rest.
    last: Option<FaceSums<D>>,
    /// Those with friction, and where they begin.
    contacts: &'s mut Vec<Contact<D>>,
    first_contact: usize,
}

impl<'s, const D: usize> WallFaces<'s, D> {
    #[inline(always)]
    pub(super) fn new(
        solver: &'s Solver<D>,
        (i, row): (usize, usize),
        contacts: &'s mut Vec<Contact<D>>,
    ) -> Self {
        let first_contact = contacts.len();
        Self {
            solver,
            i,
            row: WallRow::new(row as u32),
            flat: FlatFace::NONE,
            turning: Turning::NONE,
            last: None,
            contacts,
            first_contact,
        }
    }

    /// The face of the point before.
    #[inline(always)]
    pub(super) fn last(&self) -> Option<&FaceSums<D>> {
        self.last.as_ref()
    }

    /// The face that points of this wall, normal and bend belong to: the last one, or a next one.
    #[inline(always)]
    pub(super) fn of_points(
        &mut self,
        group: u16,
        normal: &Vector<D>,
        bend: Option<Bend<D>>,
    ) -> &mut FaceSums<D> {
        if let Some(done) = self.last.take_if(|f| !f.has(group, normal, bend.as_ref())) {
            self.add_turn(&done);
            self.add_face(&done);
        }
        let free_slip = self.solver.walls.groups[group as usize].free_slip;
        self.last
            .get_or_insert_with(|| FaceSums::new(group, *normal, free_slip, bend))
    }

    /// What all faces come to, `None` if there is none; `moment`: M of the particle, complete.
    #[inline(always)]
    pub(super) fn finish(mut self, moment: &Tensor<D>) -> Option<WallRow<D>> {
        let last = self.last.take()?;
        self.add_turn(&last);
        if !self.solver.geometry.is_axisymmetric() {
            self.turning.complete(moment, &mut self.row);
        }
        self.add_face(&last);
        let spacing = self.solver.numerics.spacing;
        self.flat.smooth(&mut self.row, spacing);
        Some(self.row)
    }

    /// Adds the sums of a face to those of the row.
    #[inline(always)]
    fn add_face(&mut self, face: &FaceSums<D>) {
        let (solver, w) = (self.solver, &mut self.row);
        let n = face.across();
        for a in 0..D {
            w.s[a] += face.s[a];
            w.cv[a] += face.dragged[a];
            w.moment_drive[a] += face.moment_drive[a];
            for b in 0..D {
                w.moment[a][b] += face.moment[a][b];
                w.c[a][b] += face.pair[a][b];
                let p = if face.free_slip {
                    n[a] * n[b]
                } else {
                    f64::from(u8::from(a == b))
                };
                for c in 0..D {
                    w.k[a][b][c] += p * face.s[c];
                    w.q[a][c] += p * face.carried[b][c];
                }
            }
        }
        let moves = solver.wall_moves(face.group);
        if moves {
            w.drive += trace(&face.carried);
        } else {
            w.drive += face.pushed;
        }
        let n = &face.normal;
        if face.lean > 0.0 {
            w.sticking += norm(&face.s);
            for a in 0..D {
                w.lean[a][a] += face.lean;
            }
            add_outer(&mut w.lean, -face.lean, n, n);
        }
        self.flat.add(face, moves);
        if !face.free_slip || solver.walls.groups[face.group as usize].friction == 0.0 {
            return;
        }
        let to_area = -2.0 * solver.volume[self.i] * solver.width;
        let area = to_area * dot(&face.s, n);
        let drive = scale(to_area, &apply(&face.carried, n));
        let whose = (self.i, face.group);
        Contact::gather(self.contacts, self.first_contact, whose, n, area, &drive);
    }

    /// Adds what turns with a face to the row: the rotation that a bend makes of sliding, and the wall's own.
    #[inline(always)]
    fn add_turn(&mut self, face: &FaceSums<D>) {
        let spin = &self.solver.walls.groups[face.group as usize].spin;
        if let Some(bend) = &face.bend {
            self.row.add_bend(&bend.rate, &face.around, &face.velocity);
        }
        self.turning
            .add(face.bend.as_ref(), spin, &face.around, &face.velocity);
        if *spin != [0.0; 3] {
            self.row.add_spin(&skew(spin), &face.around);
        }
    }
}
