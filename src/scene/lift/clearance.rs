//! Where bodies may not start: in walls and behind them, in closed gates, in drains.

use super::geometry::{Region, cross, edges};
use super::walls::Solid;
use super::{Lift, dot, minus};

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
            for (other, solid) in &self.solids {
                if let Some((how, remedy)) = solid.meets(region, spacing, eps) {
                    hits.push((place, format!("{how} {}", other.key), remedy));
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
}

impl Solid {
    /// How a body meets this wall where it must not, and what to do; `None` if it keeps clear.
    pub(super) fn meets(
        &self,
        region: &Region,
        spacing: f64,
        eps: f64,
    ) -> Option<(&'static str, &'static str)> {
        match self {
            Solid::Block(block) => block
                .overlaps(region, eps)
                .then_some(("overlaps", "move the body or the wall")),
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
                    dot(minus([pick(0), pick(1), pick(2)], *point), *normal) < -eps
                };
                (0..8).any(behind).then_some((
                    "reaches behind",
                    "turn the plane's normal towards the material, or move the body",
                ))
            }
            Solid::Polyline(segments) => segments.iter().find_map(|&(a, b)| {
                let Region::Polygon(points) = region else {
                    return None;
                };
                if edges(points)
                    .any(|e| cross(e, (a, b), eps))
                {
                    return Some(("crosses", "move the body or the wall"));
                }
                probes_behind(a, b, spacing)
                    .any(|p| region.holds(p, eps))
                    .then_some((
                        "lies behind (to the right of)",
                        "reverse the order of the wall's points, or move the body to the wall's left",
                    ))
            }),
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
