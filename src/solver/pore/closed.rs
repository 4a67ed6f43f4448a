//! Beds that neither air nor a fluid reaches: the seepage equation fixes their pores' pressure but for a constant. The least of it is made that
//! half a spacing under a surface, as under air.

use crate::math::CHUNK;
use crate::solver::Solver;
use crate::state::State;

impl<const D: usize> Solver<D> {
    /// Gives each closed bed the pore pressure that is least where it should be; `open` are the rows that air or a fluid joins.
    pub(super) fn pin_closed(&self, state: &State<D>, open: &[bool], pore: &mut [f64]) {
        let porous = (0..open.len()).filter(|&i| self.is_porous(state, i));
        let mut reached = vec![true; open.len()];
        let mut beds = Vec::new();
        for i in porous {
            reached[i] = open[i];
            if open[i] {
                beds.push(i);
            }
        }
        self.add_joined(&mut beds, &mut reached);
        for first in 0..open.len() {
            if reached[first] {
                continue;
            }
            reached[first] = true;
            let mut bed = vec![first];
            self.add_joined(&mut bed, &mut reached);
            let least = bed
                .iter()
                .copied()
                .reduce(|a, b| if pore[b] < pore[a] { b } else { a });
            let least = least.unwrap_or(first);
            let density = self.materials[state.grains.phase[least] as usize]
                .grains
                .pore_density;
            let surplus = pore[least] - 0.5 * self.numerics.spacing * density * self.gravity_norm;
            for i in bed {
                pore[i] -= surplus;
            }
        }
    }

    /// Adds to a list of particles all that are joined to them and not yet reached.
    fn add_joined(&self, list: &mut Vec<usize>, reached: &mut [bool]) {
        let mut next = 0;
        while next < list.len() {
            let i = list[next];
            next += 1;
            self.lists.blocks[i / CHUNK].for_each_pair(i % CHUNK, |j, _, _| {
                let j = j as usize;
                if !reached[j] {
                    reached[j] = true;
                    list.push(j);
                }
            });
        }
    }
}
