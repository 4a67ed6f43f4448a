//! Shear stress at the top of a material: what flows over a bed drags on it with.
//!
//! By Newton's third law the force between the particles of two sides is the same for both, whatever either holds within itself; over
//! the area that the same sums give, an even stress is read as it is.
//!
//! Symbols: F_i, a_i what passes between particle i and those beyond the interface (per length across of rings), n normal, d place from
//! the point, d_t its part along the interface; sums over one side with w = W(|d_t|), where |n . d| and |d_t| are within the support.
//! t = |(I - n n^T) sum w F_i| / |sum w a_i|,   n along sum w a_i

use super::view::mirror;
use super::{DepthLine, Reading, View, along};
use crate::math::{Geometry, add, dot, norm, normalized, scale, sub};
use crate::state::CellGrid;

/// Share of what a flat interface has of sum w |a| below which there is none [1].
const SCANT: f64 = 0.1;

/// int W(|x|) over a plane through the kernel's centre times its support: 1.486 in the plane, 1.5 in space [1].
const FLAT: f64 = 1.5;

/// Particles on both sides of where a material ends. All slices have one entry a particle.
#[derive(Clone, Copy, Debug)]
pub struct Edge<'a, const D: usize> {
    /// Viscous force on the material from beyond it, as far as this particle has to do with it [N].
    pub force: &'a [[f64; D]],
    /// Its part of the interface, out of the material [m^2].
    pub area: &'a [[f64; D]],
    /// Shear rate [1/s].
    pub shear: &'a [f64],
    /// Whether it is of the material.
    pub is_inside: &'a [bool],
    /// The grid over the particles.
    pub cells: &'a CellGrid<D>,
}

/// Sums over the particles of one side.
#[derive(Clone, Copy)]
struct Side<const D: usize> {
    force: [f64; D],
    area: [f64; D],
    /// sum w |a| and of it times the shear rate.
    size: f64,
    shear: f64,
}

/// One value: shear stress [Pa] at the highest point of a material on a line, that which passes between it and what is beyond; 0 where
/// nothing is. `material` shows the material alone.
///
/// Outside, blocked and empty as a depth gauge of that material.
#[must_use]
pub fn interface_stress<const D: usize>(
    line: &DepthLine<D>,
    material: &View<D>,
    edge: &Edge<D>,
) -> Reading {
    match line.depth(material) {
        Ok(depth) => {
            let at = along(&line.foot, &line.up, depth);
            Reading::valid(vec![edge.traction(material, &at)])
        }
        Err(why) => Reading::none(1, why),
    }
}

impl<const D: usize> Edge<'_, D> {
    /// t [Pa].
    fn traction(&self, view: &View<D>, at: &[f64; D]) -> f64 {
        let Some(normal) = self.normal(view, at) else {
            return 0.0;
        };
        let none = Side {
            force: [0.0; D],
            area: [0.0; D],
            size: 0.0,
            shear: 0.0,
        };
        let (mut inside, mut beyond) = (none, none);
        let support = view.kernel.support();
        // The cylinder's corner is farthest.
        let reach = std::f64::consts::SQRT_2 * support;
        self.for_each_within(view, at, reach, |i, x, force, area| {
            let d = sub(x, at);
            let beside = norm(&crate::math::along(&normal, &d));
            if dot(&d, &normal).abs() < support && beside < support {
                let side = if self.is_inside[i] {
                    &mut inside
                } else {
                    &mut beyond
                };
                side.add(view.kernel.w(beside), force, area, self.shear[i]);
            }
        });
        // What moves as a block holds stresses that cancel over it and not at one place; what shears does not.
        let side = if inside.shear * beyond.size >= beyond.shear * inside.size {
            inside
        } else {
            beyond
        };
        let size = norm(&side.area);
        match normalized(&side.area) {
            Some(n) if size * support >= SCANT * FLAT => {
                norm(&crate::math::along(&n, &side.force)) / size
            }
            _ => 0.0,
        }
    }

    /// Direction out of the material of the interface around a place; none far from it.
    fn normal(&self, view: &View<D>, at: &[f64; D]) -> Option<[f64; D]> {
        let mut sum = [0.0; D];
        self.for_each_within(view, at, view.kernel.support(), |_, x, _, area| {
            let w = view.kernel.w(norm(&sub(x, at)));
            sum = add(&sum, &scale(w, area));
        });
        normalized(&sum)
    }

    /// Calls `visit` with index, place, force and area of particles within `radius` [m], forces and areas over the length across the
    /// section; then of the images of rings across the axis.
    fn for_each_within(
        &self,
        view: &View<D>,
        at: &[f64; D],
        radius: f64,
        mut visit: impl FnMut(usize, &[f64; D], &[f64; D], &[f64; D]),
    ) {
        let least = Geometry::LEAST_RADIUS * view.spacing;
        let over = |x: &[f64; D]| 1.0 / view.geometry.length_across(x, least);
        self.cells.for_each_within(at, radius, |i, x, _| {
            let over = over(&x);
            visit(
                i,
                &x,
                &scale(over, &self.force[i]),
                &scale(over, &self.area[i]),
            );
        });
        if view.has_images(at, radius) {
            self.cells.for_each_within(&mirror(*at), radius, |i, x, _| {
                let over = over(&x);
                let image = |v: &[f64; D]| scale(over, &mirror(*v));
                visit(i, &mirror(x), &image(&self.force[i]), &image(&self.area[i]));
            });
        }
    }
}

impl<const D: usize> Side<D> {
    fn add(&mut self, w: f64, force: &[f64; D], area: &[f64; D], shear: f64) {
        let size = w * norm(area);
        self.force = add(&self.force, &scale(w, force));
        self.area = add(&self.area, &scale(w, area));
        self.size += size;
        self.shear += size * shear;
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::bed::Bed;
    use super::*;

    /// What a gauge on a vertical line reads where the rows about the top of a bed, tilted by `angle`, pass the traction `of`
    /// (shear, normal) between them; row 0 is below the top, row 1 beyond it and twice as quick.
    fn read(angle: f64, of: impl Fn(usize, usize) -> (f64, f64)) -> f64 {
        let bed = Bed::<2>::new(1.6, 8, 0.0);
        let (t, n) = ([angle.cos(), angle.sin()], [-angle.sin(), angle.cos()]);
        bed.look(|view| {
            let at = [0.2, bed.height()];
            let (mut x, mut force, mut area, mut is_inside) = (vec![], vec![], vec![], vec![]);
            for k in 0..40 {
                for row in 0..2 {
                    let along_it = (k as f64 - 19.5) * view.spacing;
                    let across = (row as f64 - 0.5) * view.spacing;
                    let (shear, normal) = of(row, k);
                    x.push(add(&at, &add(&scale(along_it, &t), &scale(across, &n))));
                    let whole = view.spacing * view.geometry.width();
                    force.push(scale(whole, &add(&scale(shear, &t), &scale(normal, &n))));
                    area.push(scale(whole, &n));
                    is_inside.push(row == 0);
                }
            }
            let shear: Vec<f64> = (0..x.len()).map(|i| (i % 2 + 1) as f64).collect();
            let edge = Edge {
                force: &force,
                area: &area,
                shear: &shear,
                is_inside: &is_inside,
                cells: &CellGrid::build(&x, view.kernel.support(), &[None; 2]),
            };
            let line = DepthLine {
                foot: [0.2, 0.0],
                up: [0.0, 1.0],
                length: 1.0,
            };
            let reading = interface_stress(&line, view, &edge);
            assert_eq!(reading.validity, crate::gauge::Validity::Valid);
            reading.values[0]
        })
    }

    #[test]
    fn an_even_traction_is_read_along_the_interface_whichever_way_it_lies() {
        for angle in [0.0, 0.3, -0.6] {
            let got = read(angle, |_, _| (250.0, -900.0));
            assert!((got - 250.0).abs() < 1e-9 * 250.0, "{got} at {angle}");
        }
    }

    #[test]
    fn the_side_that_shears_tells() {
        let got = read(0.0, |row, k| {
            if row == 1 {
                (250.0, 0.0)
            } else {
                (40.0 * k as f64, 0.0)
            }
        });
        assert!((got - 250.0).abs() < 1e-9 * 250.0, "{got}");
    }

    #[test]
    fn where_nothing_lies_above_it_is_0() {
        let bed = Bed::<2>::new(1.6, 8, 0.0);
        let reading = bed.look(|view| {
            let edge = Edge {
                force: &[],
                area: &[],
                shear: &[],
                is_inside: &[],
                cells: &CellGrid::build(&[], view.kernel.support(), &[None; 2]),
            };
            let line = DepthLine {
                foot: [0.2, 0.0],
                up: [0.0, 1.0],
                length: 1.0,
            };
            interface_stress(&line, view, &edge)
        });
        assert_eq!(reading, Reading::valid(vec![0.0]));
    }
}
