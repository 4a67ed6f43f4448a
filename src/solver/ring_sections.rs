//! Rings keep their section near dp^2 (docs/theory.md, "Axisymmetric scenes", R6, R7): nothing of this in other scenes.
//!
//! A ring keeps its mass, so that its section grows as 1/r on its way to the axis: what has come in from three times its radius stands
//! 1.7 spacings apart, with next to no neighbours within the kernel's support, and outlets jammed on it. A ring of more than
//! [`GROWN`] dp^2 is halved,
//!
//!   m -> m/2, m/2,   x -> x - s e, x + s e,   s = [`APART`] sqrt(A),                                                  (R6)
//!
//! e the direction in which the two stand furthest from the nearest neighbour or wall point. What goes out again would crowd there: two
//! of one material below [`SHRUNK`] dp^2 each, less than a spacing apart, are joined where their mass has its centre, with their
//! momentum and their volume (R7). Mass is exact, halves and sums of multiples of powers of two; momentum and the centre of mass are
//! kept to rounding, in halving kinetic energy too.

use crate::math::{CHUNK, Geometry, Vector, dot};
use crate::state::{Grains, State};

use super::{Scheme, Solver};

/// Section above which a ring is halved, over dp^2 [1]: wholes and halves are about as far from 1 in ratio.
const GROWN: f64 = 1.5;

/// Section below which a ring is joined to another, over dp^2 [1]: fronts that spread keep what is finer than the scene's spacing up to
/// there.
const SHRUNK: f64 = 0.25;

/// Distance of each half from where the whole was, over the side of a square of its section [1]: that of two cells of a lattice.
const APART: f64 = 0.35;

/// Directions that are tried, over half a turn.
const DIRECTIONS: usize = 12;

/// What was moved other than by its velocity (joined, halved, let rise) from where to where, for whoever counts what crosses a section.
#[derive(Debug, Default)]
pub(super) struct Moved<const D: usize> {
    /// Places before [m].
    pub(super) before: Vec<Vector<D>>,
    /// Mass, material and place after.
    pub(super) after: Grains<D>,
}

impl<const D: usize> Moved<D> {
    pub(super) fn note(&mut self, (phase, mass): (u8, f64), from: Vector<D>, to: Vector<D>) {
        self.before.push(from);
        self.after.push(0, phase, to, [0.0; D], mass, 1.0);
    }
}

impl<const D: usize> Solver<D> {
    /// Joins and halves rings, in lists that hold; returns whether there were any to. Lists must be made anew then.
    pub(super) fn resize_rings(&mut self, state: &mut State<D>) -> bool {
        let numerics = &self.numerics;
        let wanted = numerics.resize_rings && numerics.scheme == Scheme::Implicit;
        if !wanted || !self.geometry.is_axisymmetric() {
            return false;
        }
        let cell = self.numerics.spacing.powi(2);
        // Lists may be made twice in a step.
        let mut moved = std::mem::take(&mut self.moved);
        let known = moved.before.len();
        let sections: Vec<f64> = (0..state.grains.len())
            .map(|i| self.section(state, i) / cell)
            .collect();
        self.join_rings(&mut state.grains, &sections, &mut moved);
        self.halve_rings(state, &sections, &mut moved);
        self.moved = moved;
        self.moved.before.len() > known
    }

    /// Section A = m/(rho w) of ring i, with the density that it has at rest where it has parted: room that a jet opens is no growth [m^2].
    fn section(&self, state: &State<D>, i: usize) -> f64 {
        let (grains, least) = (
            &state.grains,
            Geometry::LEAST_RADIUS * self.numerics.spacing,
        );
        let length = self.geometry.length_across(&grains.position[i], least);
        let at_rest = self.materials[usize::from(grains.phase[i])].rest_density();
        grains.mass[i] / (grains.density[i].max(at_rest) * length)
    }

    /// (R7): each with the nearest that may; what has gone into another is left to be removed.
    fn join_rings(&self, grains: &mut Grains<D>, sections: &[f64], moved: &mut Moved<D>) {
        for i in (0..sections.len()).filter(|&i| sections[i] < SHRUNK) {
            if grains.drained[i] {
                continue;
            }
            let here = grains.position[i];
            let mut nearest = (self.numerics.spacing.powi(2), None);
            for &j in self.lists.blocks[i / CHUNK].row(i % CHUNK) {
                let j = j as usize;
                let d = self.periodic.difference(&grains.position[j], &here);
                let r2 = dot(&d, &d);
                let may = sections[j] < SHRUNK && grains.phase[j] == grains.phase[i];
                if j != i && may && !grains.drained[j] && r2 < nearest.0 {
                    nearest = (r2, Some((j, d)));
                }
            }
            let Some((j, d)) = nearest.1 else {
                continue;
            };
            let kinds = [i, j].map(|k| (grains.phase[k], grains.mass[k]));
            let there = grains.position[j];
            grains.join(i, j, &d);
            moved.note(kinds[0], here, grains.position[i]);
            moved.note(kinds[1], there, grains.position[i]);
        }
    }

    /// (R6).
    fn halve_rings(&self, state: &mut State<D>, sections: &[f64], moved: &mut Moved<D>) {
        let cell = self.numerics.spacing.powi(2);
        // Places of second halves, in the order of the first.
        let mut twins: Vec<(u32, Vector<D>)> = Vec::new();
        let grains = &mut state.grains;
        for i in (0..sections.len()).filter(|&i| sections[i] > GROWN) {
            let block = &self.lists.blocks[i / CHUNK];
            let mut near: Vec<Vector<D>> = Vec::new();
            for &j in block.row(i % CHUNK).iter().filter(|&&j| j as usize != i) {
                near.push(grains.position[j as usize]);
                if let Ok(place) = twins.binary_search_by_key(&j, |t| t.0) {
                    near.push(twins[place].1);
                }
            }
            let walls = block.wall_row(i % CHUNK).iter();
            near.extend(walls.map(|&w| self.walls.position[w as usize]));
            let whole = grains.position[i];
            if let Some([first, second]) = self.apart(&whole, sections[i] * cell, &near) {
                let half = (grains.phase[i], 0.5 * grains.mass[i]);
                grains.position[i] = first;
                moved.note(half, whole, first);
                moved.note(half, whole, second);
                twins.push((i as u32, second));
            }
        }
        for (i, second) in twins {
            grains.halve(i as usize, state.next_id, second);
            state.next_id += 1;
        }
    }

    /// Where the halves of a ring at x with this section [m^2] stand furthest from what is near; `None` where they would cross the axis
    /// whichever way.
    fn apart(&self, x: &Vector<D>, section: f64, near: &[Vector<D>]) -> Option<[Vector<D>; 2]> {
        let away = APART * section.sqrt();
        let least = Geometry::LEAST_RADIUS * self.numerics.spacing;
        let mut best = (f64::NEG_INFINITY, None);
        for n in 0..DIRECTIONS {
            let (up, out) = (std::f64::consts::PI * n as f64 / DIRECTIONS as f64).sin_cos();
            let half = |s: f64| std::array::from_fn(|k| x[k] + s * if k == 0 { out } else { up });
            let halves: [Vector<D>; 2] = [half(-away), half(away)];
            if halves.iter().any(|h| h[0] < least) {
                continue;
            }
            let room = halves.iter().flat_map(|h| {
                near.iter().map(|p| {
                    let d = self.periodic.difference(h, p);
                    dot(&d, &d)
                })
            });
            let room = room.fold(f64::INFINITY, f64::min);
            if room > best.0 {
                best = (room, Some(halves));
            }
        }
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;
    use crate::solver::sample::{self, SPACING};
    use crate::solver::{SolverError, StepInputs};

    /// Mass, momentum, first moment of mass, volume and kinetic energy.
    fn sums(grains: &Grains<2>) -> [f64; 7] {
        let mut s = [0.0; 7];
        for i in 0..grains.len() {
            let (m, x, v) = (grains.mass[i], grains.position[i], grains.velocity[i]);
            let energy = 0.5 * m * dot(&v, &v);
            let parts = [
                m,
                m * v[0],
                m * v[1],
                m * x[0],
                m * x[1],
                m / grains.density[i],
                energy,
            ];
            (0..7).for_each(|k| s[k] += parts[k]);
        }
        s
    }

    /// Rings of a disordered block, stretched by `stretch` and made `factor` times as heavy with `wanted` numbers, after lists were made.
    fn resized(
        (stretch, factor): (f64, f64),
        wanted: impl Fn(usize) -> bool,
    ) -> ([[f64; 7]; 2], Solver<2>, State<2>) {
        let (plan, mut state) =
            sample::disordered::<2>(Material::sand_04(), Geometry::Axisymmetric, 14, 0.2);
        state.next_id = 196;
        for x in state.grains.position.iter_mut() {
            *x = x.map(|c| stretch * c);
        }
        for (i, m) in state.grains.mass.iter_mut().enumerate() {
            *m *= if wanted(i) { factor } else { 1.0 };
            // A grid of masses, as scenes have.
            *m = (*m * 2f64.powi(30)).round() / 2f64.powi(30);
        }
        let before = sums(&state.grains);
        let mut solver = Solver::new(plan, 1);
        solver.renew_lists(&mut state);
        let after = sums(&state.grains);
        assert_eq!(before[0].to_bits(), after[0].to_bits(), "mass");
        for k in 1..6 {
            assert!(
                (after[k] - before[k]).abs() < 1e-13 * before[0],
                "{k}: {before:?} {after:?}"
            );
        }
        let drift = (0..solver.moved.before.len()).fold([0.0; 2], |d, n| {
            let m = solver.moved.after.mass[n];
            let way = |k: usize| solver.moved.after.position[n][k] - solver.moved.before[n][k];
            [d[0] + m * way(0), d[1] + m * way(1)]
        });
        assert!(
            drift.iter().all(|d| d.abs() < 1e-14 * before[0]),
            "{drift:?}"
        );
        ([before, after], solver, state)
    }

    #[test]
    fn coarse_rings_are_halved_where_there_is_room() {
        let ([before, after], solver, state) = resized((1.3, 1.3f64.powi(3)), |_| true);
        let more = state.grains.len() - 196;
        println!("{more} of 196 halved");
        assert_eq!(more, 196);
        assert!((after[6] / before[6] - 1.0).abs() < 1e-14, "kinetic energy");
        assert_eq!(solver.moved.before.len(), 2 * more);
        let mut ids = state.grains.id.clone();
        ids.sort_unstable();
        assert!(ids.windows(2).all(|w| w[0] < w[1]), "each has its number");
        let place = &state.grains.position;
        let least = (0..place.len())
            .flat_map(|i| (0..i).map(move |j| (i, j)))
            .map(|(i, j)| {
                let d = [place[i][0] - place[j][0], place[i][1] - place[j][1]];
                dot(&d, &d).sqrt() / SPACING
            });
        let least = least.fold(f64::INFINITY, f64::min);
        println!("nearest two {least:.3} dp apart");
        assert!(least > 0.4, "{least}");
    }

    #[test]
    fn fine_rings_are_joined_to_the_nearest() {
        let ([before, after], _, state) = resized((1.0, 0.2), |i| (i / 7) % 2 == 0);
        println!(
            "{} rings left of 196, energy {:.4}",
            state.grains.len(),
            after[6] / before[6]
        );
        assert!(state.grains.len() < 196 - 35 && !state.grains.drained.contains(&true));
        assert!(after[6] < before[6], "what met inelastically");
    }

    #[test]
    fn rings_as_the_scene_has_them_stay() {
        let (_, solver, state) = resized((1.0, 1.0), |_| false);
        assert!(state.grains.len() == 196 && solver.moved.before.is_empty());
    }

    /// Pressures and the like were as long as before the step, and whoever asked after the failure met the end of them.
    #[test]
    fn a_step_that_fails_after_rings_were_halved_can_be_looked_at() {
        let (mut plan, mut state) =
            sample::disordered::<2>(Material::sand_04(), Geometry::Axisymmetric, 14, 0.2);
        plan.upper = [0.3; 2];
        state.next_id = 196;
        let mut solver = Solver::new(plan, 1);
        solver.start(&mut state);
        let grains = &mut state.grains;
        for (x, m) in grains.position.iter_mut().zip(&mut grains.mass) {
            *x = x.map(|c| 1.3 * c);
            *m *= 1.3f64.powi(3);
        }
        grains.density[100] = f64::INFINITY;
        let inputs = StepInputs {
            openings: &[],
            rates: &[],
            drives: &[],
        };
        let failed = solver.step(&mut state, 1.0, &inputs, &mut |_, _| {});
        let quantity = match failed {
            Err(SolverError::NotFinite { quantity, .. }) => quantity,
            other => panic!("{other:?}"),
        };
        assert_eq!(quantity, "density");
        assert!(state.grains.len() > 196);
        assert_eq!(solver.pressure().len(), state.grains.len());
        assert!(solver.validity(&state).share_fast.is_finite());
    }

    #[test]
    fn what_has_parted_is_not_halved() {
        let (plan, mut state) =
            sample::disordered::<2>(Material::sand_04(), Geometry::Axisymmetric, 14, 0.2);
        state.grains.density.iter_mut().for_each(|rho| *rho *= 0.5);
        let mut solver = Solver::new(plan, 1);
        solver.renew_lists(&mut state);
        assert!(state.grains.len() == 196 && solver.moved.before.is_empty());
    }
}
