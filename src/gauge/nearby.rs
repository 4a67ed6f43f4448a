//! Shepard sums at many places close to each other: who may be seen from them is found once.

use super::view::mirror;
use super::{View, component};
use crate::state::CellGrid;

/// Material and solid around one place.
pub(super) struct Nearby<'a, const D: usize> {
    view: &'a View<'a, D>,
    material: Crowd,
    solid: Crowd,
}

/// Points of a grid near a place, and near its image across the axis of rings.
#[derive(Default)]
struct Crowd {
    here: Vec<u32>,
    across: Vec<u32>,
}

impl<'a, const D: usize> Nearby<'a, D> {
    /// Nobody yet.
    pub(super) fn new(view: &'a View<'a, D>) -> Self {
        Self {
            view,
            material: Crowd::default(),
            solid: Crowd::default(),
        }
    }

    /// Takes in all that places within `reach` [m] of `centre` see; says whether there is material.
    pub(super) fn gather(&mut self, centre: &[f64; D], reach: f64) -> bool {
        let radius = self.view.kernel.support() + reach;
        self.material
            .gather(self.view, self.view.cells, centre, radius);
        if self.material.is_empty() {
            return false;
        }
        self.solid
            .gather(self.view, self.view.solid, centre, radius);
        true
    }

    /// Shepard sum of the material, sum_j V_j W(|x - x_j|) [1].
    pub(super) fn material_sum(&self, at: &[f64; D]) -> f64 {
        let view = self.view;
        let mut sum = 0.0;
        self.material.for_each(view, view.cells, at, |j, _, r| {
            sum += view.volume(j) * view.kernel.w(r);
        });
        sum
    }

    /// Shepard sums of solid behind and before the plane through `foot` with normal `up`, at `at` [1].
    pub(super) fn solid_sums(&self, at: &[f64; D], foot: &[f64; D], up: &[f64; D]) -> (f64, f64) {
        let view = self.view;
        let volume = view.spacing.powi(D as i32);
        let (mut behind, mut before) = (0.0, 0.0);
        self.solid.for_each(view, view.solid, at, |_, x, r| {
            let weight = volume * view.kernel.w(r);
            if component(&x, foot, up) < 0.0 {
                behind += weight;
            } else {
                before += weight;
            }
        });
        (behind, before)
    }
}

impl Crowd {
    fn gather<const D: usize>(
        &mut self,
        view: &View<D>,
        grid: &CellGrid<D>,
        centre: &[f64; D],
        radius: f64,
    ) {
        grid.gather(centre, radius, &mut self.here);
        self.across.clear();
        if view.has_images(centre, radius) {
            grid.gather(&mirror(*centre), radius, &mut self.across);
        }
    }

    fn is_empty(&self) -> bool {
        self.here.is_empty() && self.across.is_empty()
    }

    /// As [`View::for_each_near`].
    fn for_each<const D: usize>(
        &self,
        view: &View<D>,
        grid: &CellGrid<D>,
        at: &[f64; D],
        mut visit: impl FnMut(usize, [f64; D], f64),
    ) {
        let support = view.kernel.support();
        grid.for_each_of(&self.here, at, support, &mut visit);
        if view.has_images(at, support) {
            grid.for_each_of(&self.across, &mirror(*at), support, |j, x, r| {
                visit(j, mirror(x), r);
            });
        }
    }
}
