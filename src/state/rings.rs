//! What only rings do: two become one, and one goes on beyond the axis.

use crate::math::Vector;

use super::Grains;

impl<const D: usize> Grains<D> {
    /// Puts the mass of particle j, which is `away` [m] from i, into i, with its momentum and volume; all else is the mean by mass. j is
    /// left to be removed.
    pub fn join(&mut self, i: usize, j: usize, away: &Vector<D>) {
        let [own, other] = [self.mass[i], self.mass[j]];
        let whole = own + other;
        let volume = own / self.density[i] + other / self.density[j];
        let share = other / whole;
        let mix = |a: &mut f64, b: f64| *a += share * (b - *a);
        let scalars = [
            &mut self.swept_density,
            &mut self.relaxed_shear,
            &mut self.pore_pressure,
            &mut self.relaxed_pore_pressure,
        ];
        // Fields of an option that is off are empty.
        for field in scalars.into_iter().filter(|f| !f.is_empty()) {
            let b = field[j];
            mix(&mut field[i], b);
        }
        let vectors = [
            &mut self.velocity,
            &mut self.viscous_acceleration,
            &mut self.viscous_change,
            &mut self.wall_traction,
            &mut self.wall_slip,
        ];
        for field in vectors.into_iter().filter(|f| !f.is_empty()) {
            let b = field[j];
            (0..D).for_each(|k| mix(&mut field[i][k], b[k]));
        }
        for field in [&mut self.stress, &mut self.plastic_rate] {
            if field.is_empty() {
                continue;
            }
            let b = field[j];
            (0..D * D).for_each(|k| mix(&mut field[i][k / D][k % D], b[k / D][k % D]));
        }
        for (x, away) in self.position[i].iter_mut().zip(away) {
            *x += share * away;
        }
        (self.mass[i], self.density[i]) = (whole, whole / volume);
        self.drained[j] = true;
    }

    /// Turns ring i into the same ring seen from the other side of the axis: r changes its sign.
    pub fn mirror(&mut self, i: usize) {
        let vectors = [
            &mut self.position,
            &mut self.velocity,
            &mut self.viscous_acceleration,
            &mut self.viscous_change,
            &mut self.wall_traction,
            &mut self.wall_slip,
        ];
        for vectors in vectors {
            // Fields of an option that is off are empty.
            if let Some(v) = vectors.get_mut(i) {
                v[0] *= -1.0;
            }
        }
        for tensors in [&mut self.stress, &mut self.plastic_rate] {
            if let Some(t) = tensors.get_mut(i) {
                (t[0][1], t[1][0]) = (-t[0][1], -t[1][0]);
            }
        }
    }
}
