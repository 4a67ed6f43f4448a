//! Whose a push is where walls lie flush (docs/theory.md, "Forces on walls").
//!
//! Pressure p pushes each point of a flat face along the face, too, which adds up to nothing over all that a particle sees. Where
//! the face goes on as another wall, a gate in its pier, each has its own part: C p at the seam, C = 2 sum |F| V x^2 of x along the
//! face, 0.6 dp. What pushes along the face is shared by how much of it each wall makes.
//!
//! Of fluids only half of it. Their walls bear weight along themselves, too (W7), C/2 for each Pa that the pressure changes by along the face;
//! corners leave C p/2 to each wall (`solver/corners.rs`), which that takes back, and so must seams.
//!
//! Symbols: n unit normal of the face towards the material, g a point's part of the sum that a particle's stress is multiplied with,
//! dp spacing.

use crate::math::{Vector, add, dot, norm, scale, sub};

use super::corners::Push;

/// How far rows of one face may lie apart, over the spacing [1].
const UNEVEN: f64 = 0.25;
/// |sum g along the face|/|sum g across it| to which walls close up [1]: less where no seam gapes, from twice as much on nothing is shared.
const CLOSED: f64 = 0.05;
/// Part of what fluids push along a face that is shared [1].
pub(super) const OF_FLUIDS: f64 = 0.5;

/// A face of several walls as one particle sees it.
struct Flush<const D: usize> {
    normal: Vector<D>,
    /// The largest n.to of its points [m].
    row: f64,
    /// sum -n.g over its points.
    across: f64,
    /// How much of what pushes along it is shared [1].
    share: f64,
}

impl<const D: usize> Flush<D> {
    fn has(&self, push: &Push<D>, spacing: f64) -> bool {
        dot(&self.normal, &push.to) <= self.row + UNEVEN * spacing
    }
}

/// Shares what pushes along a face that several walls make. `push` is what a sum g does to the particle [N s], `part` how
/// much of it is shared. What one particle pushes stays the same in sum.
pub(super) fn share_at_seams<const D: usize>(
    pushes: &mut [Push<D>],
    push: impl Fn(&Vector<D>) -> Vector<D>,
    part: f64,
    spacing: f64,
) {
    let mut normals: Vec<Vector<D>> = Vec::new();
    for push in pushes.iter() {
        if !normals.contains(&push.normal) {
            normals.push(push.normal);
        }
    }
    let faces = normals
        .iter()
        .filter_map(|n| flush_face(n, pushes, spacing));
    let Some(face) = faces.max_by(|a, b| a.share.total_cmp(&b.share)) else {
        return;
    };
    let along = |g: &Vector<D>| sub(g, &scale(dot(&face.normal, g), &face.normal));
    let mut own: Vec<&mut Push<D>> = pushes.iter_mut().filter(|p| face.has(p, spacing)).collect();
    let sum = own
        .iter()
        .fold([0.0; D], |sum, p| add(&sum, &along(&p.reach)));
    for point in &mut own {
        let own = -dot(&face.normal, &point.reach) / face.across;
        let change = sub(&scale(own, &sum), &along(&point.reach));
        point.impulse = add(&point.impulse, &scale(part * face.share, &push(&change)));
    }
}

/// The face with normal n, if points of several walls make it and it closes up.
fn flush_face<const D: usize>(n: &Vector<D>, pushes: &[Push<D>], spacing: f64) -> Option<Flush<D>> {
    let row_of = |group| {
        let own = pushes.iter().filter(|p| p.group == group);
        own.fold(f64::NEG_INFINITY, |row, p| row.max(dot(n, &p.to)))
    };
    let own = pushes.iter().filter(|p| p.normal == *n);
    let row = own.fold(f64::NEG_INFINITY, |row, p| row.max(dot(n, &p.to)));
    let mut face = Flush {
        normal: *n,
        row,
        across: 0.0,
        share: 0.0,
    };
    let mut sum = [0.0; D];
    let mut groups = Vec::new();
    for push in pushes.iter().filter(|p| face.has(p, spacing)) {
        sum = add(&sum, &push.reach);
        if !groups.contains(&push.group) {
            groups.push(push.group);
        }
    }
    let flush = groups
        .iter()
        .filter(|g| (row_of(**g) - row).abs() <= UNEVEN * spacing);
    face.across = -dot(n, &sum);
    if flush.count() < 2 || face.across <= 0.0 {
        return None;
    }
    let gap = norm(&add(&sum, &scale(face.across, n))) / face.across;
    face.share = (2.0 - gap / CLOSED).clamp(0.0, 1.0);
    (face.share > 0.0).then_some(face)
}
