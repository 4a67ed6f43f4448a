//! Whether particles are inside walls, and how far outside outlines.

use crate::component::ParticleView;

/// Share of a particle's neighbourhood that may be wall. In front of a flat wall it is 0.14 at half a spacing, where
/// particles rest, and 0.5 at the surface; 0.9 lies half a spacing behind the surface, on the first row of the wall's points.
pub(super) const MOST_WALL: f64 = 0.9;

/// Least distance to a point of a wall that a particle inside it can have, over the spacing: that of the middle of a cell of
/// the lattice. One that is squeezed between two walls is further from both.
const CELL: f64 = 0.72;

/// Distance of two points.
pub(super) fn length(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Largest share of any particle's neighbourhood that is wall or gate, by a Wendland C2 kernel as wide as a spacing, and
/// where that is: N of (W5). `walls` are points with the share of a full one that each is, so that the end of a plate that
/// has slid behind a wall's end is not counted twice; `axes` is 2 or 3. What is further from every point of a wall than the
/// middle of a cell of them counts as on the surface at most.
pub(super) fn deepest(
    view: &ParticleView,
    walls: &[([f64; 3], f64)],
    spacing: f64,
    axes: usize,
) -> (f64, [f32; 3]) {
    let scale = match axes {
        2 => 7.0 / (4.0 * std::f64::consts::PI),
        _ => 21.0 / (16.0 * std::f64::consts::PI),
    };
    let mut most = (0.0, [0.0; 3]);
    for position in &view.position {
        let at = position.map(f64::from);
        let (mut share, mut nearest) = (0.0, f64::INFINITY);
        for (wall, part) in walls {
            let square: f64 = (0..3).map(|k| (at[k] - wall[k]).powi(2)).sum();
            let q = square.sqrt() / spacing;
            nearest = nearest.min(q);
            if q < 2.0 {
                share += part * scale * (1.0 - 0.5 * q).powi(4) * (1.0 + 2.0 * q);
            }
        }
        if nearest > CELL {
            share = f64::min(share, 0.5);
        }
        if share > most.0 {
            most = (share, *position);
        }
    }
    most
}

/// A particle that is more than half a spacing outside a convex outline (anticlockwise), and by how many spacings.
pub(super) fn outside(
    view: &ParticleView,
    outline: &[[f64; 2]],
    spacing: f64,
) -> Option<([f32; 3], f64)> {
    for position in &view.position {
        for (i, a) in outline.iter().enumerate() {
            let b = outline[(i + 1) % outline.len()];
            let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
            let (x, y) = (f64::from(position[0]) - a[0], f64::from(position[1]) - a[1]);
            // Distance to the right of the side.
            let beyond = (dy * x - dx * y) / dx.hypot(dy) / spacing;
            if beyond > 0.5 {
                return Some((*position, beyond));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn in_front_of_a_wall_and_behind_its_surface() {
        let rows = (0..4).flat_map(|row| {
            (-8..=8).map(move |i| [0.1 * f64::from(i), -0.05 - 0.1 * f64::from(row), 0.0])
        });
        let mut walls: Vec<([f64; 3], f64)> = rows.map(|x| (x, 1.0)).collect();
        let share = |y: f32| {
            let view = ParticleView {
                position: vec![[0.3, 9.0, 0.0], [0.0, y, 0.0]],
                ..ParticleView::default()
            };
            deepest(&view, &walls, 0.1, 2)
        };
        assert!((share(0.05).0 - 0.14).abs() < 0.01);
        assert!((share(0.0).0 - 0.5).abs() < 0.02);
        assert!(share(-0.05).0 < MOST_WALL + 0.005 && share(-0.075).0 > MOST_WALL);
        assert_eq!(share(-0.1).1, [0.0, -0.1, 0.0]);
        // A full row beside another one's end, where only a hundredth of it is left, is one row.
        let before = share(-0.02).0;
        walls.push(([0.0, -0.05, 0.0], 0.01));
        let view = ParticleView {
            position: vec![[0.0, -0.02, 0.0]],
            ..ParticleView::default()
        };
        assert!((deepest(&view, &walls, 0.1, 2).0 - before).abs() < 0.01);
    }

    #[test]
    fn outlines_have_an_outside() {
        let view = ParticleView {
            position: vec![[0.0, 0.0, 0.0], [0.5, 0.25, 0.0]],
            ..ParticleView::default()
        };
        let square = [[-0.1, -0.1], [0.4, -0.1], [0.4, 0.4], [-0.1, 0.4]];
        let (place, depth) = outside(&view, &square, 0.1).unwrap();
        assert_eq!(place, [0.5, 0.25, 0.0]);
        assert!((depth - 1.0).abs() < 1e-6);
        assert!(outside(&view, &square, 0.3).is_none());
        assert!(outside(&view, &[], 0.1).is_none());
    }
}
