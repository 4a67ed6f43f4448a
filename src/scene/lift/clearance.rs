//! Where bodies and inflows may not start: in walls and behind them; bodies not in closed gates and drains either.

use super::faces::Face;
use super::geometry::{Region, cross, edges};
use super::thinness::{Segment, crossing, most_spacing};
use super::walls::Solid;
use super::{Filled, Lift};
use crate::math::{dot, sub};
use crate::scene::raw::Place;
use crate::units::shown_bound;

impl Lift<'_> {
    /// Bodies start outside walls, closed gates and drains.
    pub(super) fn check_bodies_against_devices(&mut self) {
        let eps = self.eps();
        let spacing = self.spacing.unwrap_or(0.0);
        let chains = self.chains();
        let (mut hits, mut thin) = (Vec::new(), Vec::new());
        for Filled { place, region, .. } in &self.filled {
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
                match solid.meets(region, &chains, spacing, eps) {
                    Some(Hit::TooThin(most)) => thin.push((place, other.key.clone(), most)),
                    Some(hit) => {
                        hits.push((place, format!("{} {}", hit.how(), other.key), hit.remedy()));
                    }
                    None => {}
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
        for (place, wall, most) in thin {
            self.problems.report(
                place,
                format!(
                    "half a spacing of {} m behind a face of {wall} is its other side, and this body there",
                    shown_bound(spacing)
                ),
                format!("a spacing of at most {} m beside a wall as thin", shown_bound(round_down(most))),
                Hit::TooThin(most).remedy(),
            );
        }
    }

    /// Inflows let material in outside walls.
    pub(super) fn check_inflow_against_walls(&mut self, place: &Place, face: &Face) {
        let (spacing, eps) = (self.spacing.unwrap_or(0.0), self.eps());
        let chains = self.chains();
        let hits = self.solids.iter().filter_map(|(other, solid)| {
            let hit = solid.meets_face(face, &chains, spacing, eps)?;
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

    /// The sides of all chains: what is behind one may be before another one's.
    fn chains(&self) -> Vec<Segment> {
        let sides = self.solids.iter().flat_map(|(_, solid)| match solid {
            Solid::Polyline(segments) => segments.as_slice(),
            _ => &[],
        });
        sides.copied().collect()
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
    /// The first row behind one side of a chain lies before another: the wall is too thin there for spacings above this [m].
    TooThin(f64),
}

impl Hit {
    fn how(self) -> &'static str {
        match self {
            Hit::Overlaps => "overlaps",
            Hit::Behind => "reaches behind",
            Hit::Crosses => "crosses",
            Hit::OnTheRight => "lies behind (to the right of)",
            Hit::TooThin(_) => "lies before the back of",
        }
    }

    fn remedy(self) -> &'static str {
        match self {
            Hit::Overlaps | Hit::Crosses => "move the body or the wall",
            Hit::Behind => "turn the plane's normal towards the material, or move the body",
            Hit::OnTheRight => {
                "reverse the order of the wall's points, or move the body to the wall's left"
            }
            Hit::TooThin(_) => {
                "refine numerics.spacing (or solver.quality, solver.resolution_scale), or thicken the wall there"
            }
        }
    }
}

impl Solid {
    /// How a body meets this wall where it must not; `None` if it keeps clear.
    fn meets(&self, region: &Region, chains: &[Segment], spacing: f64, eps: f64) -> Option<Hit> {
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
            Solid::Polyline(segments) => {
                let hits = segments
                    .iter()
                    .flat_map(|&segment| meets_segment(chains, segment, region, spacing, eps));
                // Where the body is in the wall, its thin parts are no matter.
                let worst = |hit: &Hit| match hit {
                    Hit::TooThin(most) => *most,
                    _ => f64::NEG_INFINITY,
                };
                hits.min_by(|a, b| worst(a).total_cmp(&worst(b)))
            }
        }
    }

    /// As [`Solid::meets`], of the room that an inflow's rows appear in.
    fn meets_face(&self, face: &Face, chains: &[Segment], spacing: f64, eps: f64) -> Option<Hit> {
        match (self, face.outline()) {
            (Solid::Plane { point, normal }, _) => face
                .corners()
                .chain(face.row())
                .any(|x| dot(&sub(&x, point), normal) < -eps)
                .then_some(Hit::Behind),
            (_, Some(outline)) => self.meets(&outline, chains, spacing, eps),
            (Solid::Block(block), None) => face
                .row()
                .any(|x| block.holds(x, eps))
                .then_some(Hit::Overlaps),
            (Solid::Polyline(_), None) => None,
        }
    }
}

/// Three digits of a length above 0, none of them too large.
fn round_down(length: f64) -> f64 {
    let unit = 10.0_f64.powi(length.log10().floor() as i32 - 2);
    (length / unit).floor() * unit
}

/// How a body meets one side of a chain where it must not.
fn meets_segment(
    chains: &[Segment],
    own: Segment,
    region: &Region,
    spacing: f64,
    eps: f64,
) -> Vec<Hit> {
    let Region::Polygon(points) = region else {
        return Vec::new();
    };
    if edges(points).any(|e| cross(e, own, eps)) {
        return vec![Hit::Crosses];
    }
    let others = || chains.iter().filter(|other| **other != own);
    let mut probes = probes_behind(own.0, own.1, spacing);
    let is_behind = |way: Segment| {
        let held = region.holds([way.1[0], way.1[1], 0.0], eps);
        held && !others().any(|other| crossing(way, *other))
    };
    if probes.any(is_behind) {
        return vec![Hit::OnTheRight];
    }
    let most = others().filter_map(|other| most_spacing(own, *other, region, spacing, eps));
    most.map(Hit::TooThin).collect()
}

/// Points on a segment, each with the one half a spacing to the right of it: the wall's first row of particles.
fn probes_behind(
    a: [f64; 2],
    b: [f64; 2],
    spacing: f64,
) -> impl Iterator<Item = ([f64; 2], [f64; 2])> {
    let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
    let size = dx.hypot(dy);
    let count = (size / spacing).clamp(1.0, 100.0).round();
    let (nx, ny) = (dy / size * spacing / 2.0, -dx / size * spacing / 2.0);
    (0..count as usize).map(move |i| {
        let t = (i as f64 + 0.5) / count;
        let foot = [a[0] + t * dx, a[1] + t * dy];
        (foot, [foot[0] + nx, foot[1] + ny])
    })
}
