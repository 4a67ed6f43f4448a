//! Where bodies and inflows may not start: in walls and behind them; bodies not in closed gates and drains either.

use super::Lift;
use super::faces::Face;
use super::geometry::{Region, cross, edges};
use super::walls::Solid;
use crate::math::{dot, sub};
use crate::scene::raw::Place;

impl Lift<'_> {
    /// Bodies start outside walls, closed gates and drains.
    pub(super) fn check_bodies_against_devices(&mut self) {
        let eps = self.eps();
        let spacing = self.spacing.unwrap_or(0.0);
        let mut hits = Vec::new();
        for (place, region) in &self.filled {
            let plates = self.plates.iter().map(|d| {
                let remedy = "move the body: material belongs on the left of a gate's way from `from` to `to`";
                (d, "starts inside the plate of", remedy)
            });
            let drains = self
                .drains
                .iter()
                .map(|d| (d, "starts inside", "move the body"));
            for ((other, device), how, remedy) in plates.chain(drains) {
                if region.overlaps(device, eps) {
                    hits.push((place, format!("{how} {}", other.key), remedy));
                }
            }
            for (other, places) in &self.space_plates {
                if places.iter().any(|&x| region.holds(x, eps)) {
                    let found = format!("starts inside the plate of {}", other.key);
                    let remedy = "reverse the gate's span, or move the body: material belongs on the side of span x (to - from)";
                    hits.push((place, found, remedy));
                }
            }
            for (other, solid) in &self.solids {
                if let Some(hit) = solid.meets(region, spacing, eps) {
                    hits.push((place, format!("{} {}", hit.how(), other.key), hit.remedy()));
                }
            }
        }
        for (place, found, remedy) in hits {
            self.problems.report(
                place,
                found,
                "bodies clear of walls, gates and outflows; touching is fine",
                remedy,
            );
        }
    }

    /// Inflows let material in outside walls.
    pub(super) fn check_inflow_against_walls(&mut self, place: &Place, face: &Face) {
        let (spacing, eps) = (self.spacing.unwrap_or(0.0), self.eps());
        let hits = self.solids.iter().filter_map(|(other, solid)| {
            let hit = solid.meets_face(face, spacing, eps)?;
            Some((format!("{} {}", hit.how(), other.key), hit))
        });
        let hits: Vec<_> = hits.collect();
        for (found, hit) in hits {
            self.problems.report(
                place,
                found,
                "inflows whose face and first row are clear of walls; touching is fine",
                hit.remedy().replace("body", "inflow"),
            );
        }
    }
}

/// How something meets a wall where it must not.
#[derive(Clone, Copy)]
pub(super) enum Hit {
    /// It reaches into a box.
    Overlaps,
    /// It reaches behind a plane.
    Behind,
    /// A segment runs through it.
    Crosses,
    /// It lies in the first row of a chain's particles.
    OnTheRight,
}

impl Hit {
    fn how(self) -> &'static str {
        match self {
            Hit::Overlaps => "overlaps",
            Hit::Behind => "reaches behind",
            Hit::Crosses => "crosses",
            Hit::OnTheRight => "lies behind (to the right of)",
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Hit::Overlaps | Hit::Crosses => "move the body or the wall",
            Hit::Behind => "turn the plane's normal towards the material, or move the body",
            Hit::OnTheRight => {
                "reverse the order of the wall's points, or move the body to the wall's left"
            }
        }
    }
}

impl Solid {
    /// How a body meets this wall where it must not; `None` if it keeps clear.
    fn meets(&self, region: &Region, spacing: f64, eps: f64) -> Option<Hit> {
        match self {
            Solid::Block(block) => block.overlaps(region, eps).then_some(Hit::Overlaps),
            Solid::Plane { point, normal } => {
                let (lower, upper) = region.bounds();
                let behind = |corner: usize| {
                    let pick = |a: usize| {
                        if corner >> a & 1 == 0 {
                            lower[a]
                        } else {
                            upper[a]
                        }
                    };
                    dot(&sub(&[pick(0), pick(1), pick(2)], point), normal) < -eps
                };
                (0..8).any(behind).then_some(Hit::Behind)
            }
            Solid::Polyline(segments) => segments.iter().find_map(|&(a, b)| {
                let Region::Polygon(points) = region else {
                    return None;
                };
                if edges(points).any(|e| cross(e, (a, b), eps)) {
                    return Some(Hit::Crosses);
                }
                probes_behind(a, b, spacing)
                    .any(|p| region.holds(p, eps))
                    .then_some(Hit::OnTheRight)
            }),
        }
    }

    /// As [`Solid::meets`], of the room that an inflow's rows appear in.
    fn meets_face(&self, face: &Face, spacing: f64, eps: f64) -> Option<Hit> {
        match (self, face.outline()) {
            (Solid::Plane { point, normal }, _) => face
                .corners()
                .chain(face.row())
                .any(|x| dot(&sub(&x, point), normal) < -eps)
                .then_some(Hit::Behind),
            (_, Some(outline)) => self.meets(&outline, spacing, eps),
            (Solid::Block(block), None) => face
                .row()
                .any(|x| block.holds(x, eps))
                .then_some(Hit::Overlaps),
            (Solid::Polyline(_), None) => None,
        }
    }
}

/// Points half a spacing to the right of a segment: the wall's first row of particles.
fn probes_behind(a: [f64; 2], b: [f64; 2], spacing: f64) -> impl Iterator<Item = [f64; 3]> {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let size = dx.hypot(dy);
    let count = (size / spacing).clamp(1.0, 100.0).round();
    let (nx, ny) = (dy / size * spacing / 2.0, -dx / size * spacing / 2.0);
    (0..count as usize).map(move |i| {
        let t = (i as f64 + 0.5) / count;
        [a[0] + t * dx + nx, a[1] + t * dy + ny, 0.0]
    })
}
