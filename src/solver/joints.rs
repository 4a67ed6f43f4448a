//! Whose the friction on a face is where walls go straight on from each other (docs/theory.md, "Forces on walls").
//!
//! Points on a joint are pushed for both walls ([`WallPoints::bearers`](crate::boundary::WallPoints::bearers)). Friction acts on faces, by their areas: of
//! what a particle rubs the other wall gets half of the part that the joint's points have in the face.

use crate::math::{CHUNK, dot};
use crate::state::State;

use super::Solver;
use super::wall_contact::{Contact, same_normal};

impl<const D: usize> Solver<D> {
    /// The groups that bear the friction of a contact, and how much of it each [1].
    pub(super) fn friction_bearers(
        &self,
        state: &State<D>,
        contact: &Contact<D>,
    ) -> impl Iterator<Item = (u16, f64)> + use<D> {
        let partner = self.friction_partner(state, contact);
        let own = partner.map_or(1.0, |(_, share)| 1.0 - share);
        std::iter::once((contact.group, own)).chain(partner)
    }

    /// The wall that bears a part of a contact's friction for what its points on a joint make of it, and that part.
    fn friction_partner(&self, state: &State<D>, contact: &Contact<D>) -> Option<(u16, f64)> {
        if self.walls.partner.is_empty() {
            return None;
        }
        let i = contact.i as usize;
        let xi = &state.grains.position[i];
        let (mut all, mut parted, mut other) = (0.0, 0.0, None);
        for &w in self.lists.blocks[i / CHUNK].wall_row(i % CHUNK) {
            let point = w as usize;
            let (x, r) = self.wall_offset(xi, w);
            let reached = 0.0 < r && r < self.kernel.support();
            if self.walls.group[point] != contact.group
                || !reached
                || !same_normal(&self.wall_normal(xi, w, state), &contact.normal)
            {
                continue;
            }
            let volume = self.wall_volume(i, w, self.walls.weight[point]);
            let area = -volume * self.kernel.f(r) * dot(&x, &contact.normal);
            all += area;
            if let Some(partner) = self.walls.partner(point) {
                parted += area;
                other = Some(partner);
            }
        }
        let share = (0.5 * parted / all).clamp(0.0, 0.5);
        other.filter(|_| all > 0.0).map(|other| (other, share))
    }
}
