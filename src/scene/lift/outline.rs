//! Outlines in the plane, of bodies and walls: how many points they have, and that neighbours are apart.

use super::{Lift, TOUCH};
use crate::scene::raw::{At, Coordinates, Length, List, Place};
use crate::units::shown_bound;

/// Most corners of an outline: pairs of edges are compared.
const MOST_CORNERS: usize = 1000;

impl Lift<'_> {
    /// Corners of an outline in the plane; `in_space` is what there is instead in space.
    pub(super) fn outline(
        &mut self,
        at: &At<List<Coordinates<Length>>>,
        least: usize,
        in_space: &str,
    ) -> Option<Vec<[f64; 2]>> {
        let corners = &at.value.0;
        if !self.planar() {
            self.problems.report(
                &at.place,
                "a planar outline in a scene with dimension = 3",
                "outlines only where dimension = 2",
                format!("use {in_space}, or set dimension = 2"),
            );
            return None;
        }
        if corners.len() < least || corners.len() > MOST_CORNERS {
            self.problems.report(
                &at.place,
                format!("{} points", corners.len()),
                format!("{least} to {MOST_CORNERS} points"),
                "write it as [[x, y], [x, y], ...]",
            );
            return None;
        }
        let mut points = Vec::new();
        for corner in corners {
            let [x, y, _] = self.vector(corner)?;
            points.push([x, y]);
        }
        Some(points)
    }

    /// Whether a point is told apart from the one before it; `remedy` is what to do where the two are the same.
    pub(super) fn check_apart(
        &mut self,
        place: &Place,
        before: [f64; 2],
        point: [f64; 2],
        remedy: &str,
    ) -> Option<()> {
        let (gap, least) = (
            (point[0] - before[0]).hypot(point[1] - before[1]),
            self.eps(),
        );
        if gap > least {
            return Some(());
        }
        match self.spacing {
            Some(spacing) if gap > 0.0 => self.problems.report(
                place,
                format!("a point {} m from the one before it", shown_bound(gap)),
                format!(
                    "more than {} m from point to point, {TOUCH} of numerics.spacing, {} m",
                    shown_bound(least),
                    shown_bound(spacing)
                ),
                "refine numerics.spacing, or delete one of the two",
            ),
            _ => self.problems.report(
                place,
                "the same point as the one before it",
                "points apart from each other",
                remedy,
            ),
        }
        None
    }
}
