//! What the coordinates of a scene stand for, and what that does to strain and stress.
//!
//! A particle of a planar scene is a rod of the scene's width, one of an axisymmetric scene a ring of length 2 pi r
//! about the axis r = 0 (x is r, y is the axis' direction), one in space itself. Rings have a third strain component,
//! the hoop strain rate v_r/r. Its stress needs no storage: deviators have no trace, so tt = -(rr + zz).

use super::{Tensor, shear_rate, strain_deviator, trace};

/// What D coordinates stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Geometry {
    /// Plane strain in x and y.
    Planar {
        /// Out-of-plane width [m].
        width: f64,
    },
    /// x is the radius r >= 0, y the height along the axis; masses and forces are for the whole ring.
    Axisymmetric,
    /// x, y and z.
    Space,
}

impl Geometry {
    /// Least radius over the spacing dp: a ring nearer to the axis has the length and hoop strain of one there [1].
    pub const LEAST_RADIUS: f64 = 0.25;

    /// Whether particles are rings.
    #[inline(always)]
    #[must_use]
    pub fn is_axisymmetric(self) -> bool {
        matches!(self, Geometry::Axisymmetric)
    }

    /// Width of planar scenes [m], by which volumes over densities are areas of the section; 1 where volumes are kept
    /// as they are [m^3].
    #[must_use]
    pub fn width(self) -> f64 {
        match self {
            Geometry::Planar { width } => width,
            Geometry::Axisymmetric | Geometry::Space => 1.0,
        }
    }

    /// Length across the section at x [m]: the width, 2 pi r of a ring (that of radius `least` nearer to the axis),
    /// or 1 in space.
    #[inline(always)]
    #[must_use]
    pub fn length_across<const D: usize>(self, x: &[f64; D], least: f64) -> f64 {
        match self {
            Geometry::Axisymmetric => std::f64::consts::TAU * x[0].max(least),
            other => other.width(),
        }
    }

    /// Deviator of the strain rate: sym(g) - tr/D I; for rings over three components, tr with the hoop strain rate
    /// `hoop` = v_r/r [1/s] and D = 3. Other geometries ignore `hoop`.
    #[inline(always)]
    #[must_use]
    pub fn strain_deviator<const D: usize>(self, g: &Tensor<D>, hoop: f64) -> Tensor<D> {
        if !self.is_axisymmetric() {
            return strain_deviator(g);
        }
        let mean = (trace(g) + hoop) / 3.0;
        std::array::from_fn(|r| {
            std::array::from_fn(|c| {
                let s = 0.5 * (g[r][c] + g[c][r]);
                if r == c { s - mean } else { s }
            })
        })
    }

    /// sqrt(2 t:t) of a deviator t, a ring's hoop component included: gamma of a strain rate.
    #[inline(always)]
    #[must_use]
    pub fn shear_rate<const D: usize>(self, t: &Tensor<D>) -> f64 {
        if !self.is_axisymmetric() {
            return shear_rate(t);
        }
        let mut s = trace(t) * trace(t);
        for row in t {
            s += super::dot(row, row);
        }
        (2.0 * s).sqrt()
    }

    /// Size sqrt(t:t/2) of a deviator t, a ring's hoop component included: |tau| = mu p at yield.
    #[inline(always)]
    #[must_use]
    pub fn size<const D: usize>(self, t: &Tensor<D>) -> f64 {
        0.5 * self.shear_rate(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_is_strained_as_the_same_motion_in_space() {
        // v = (0.3 r, -0.8 z + 0.5 r) seen on the x axis of space: d v_y/dy is the hoop strain rate.
        let ring = [[0.3, 0.0], [0.5, -0.8]];
        let space = [[0.3, 0.0, 0.0], [0.0, 0.3, 0.0], [0.5, 0.0, -0.8]];
        let e = Geometry::Axisymmetric.strain_deviator(&ring, 0.3);
        let full = Geometry::Space.strain_deviator(&space, 0.0);
        for (a, b) in [(0, 0), (0, 2), (2, 2)] {
            assert!((e[a / 2][b / 2] - full[a][b]).abs() < 1e-15);
        }
        let gamma = Geometry::Axisymmetric.shear_rate(&e);
        assert!((gamma - Geometry::Space.shear_rate(&full)).abs() < 1e-15);
        assert!((Geometry::Axisymmetric.size(&e) - 0.5 * gamma).abs() < 1e-15);
    }

    #[test]
    fn the_plane_keeps_its_bits() {
        let g = [[0.1, 0.7], [-0.3, 0.45]];
        let planar = Geometry::Planar { width: 0.2 };
        let e = planar.strain_deviator(&g, 9.0);
        assert_eq!(e, strain_deviator(&g));
        assert_eq!(planar.shear_rate(&e).to_bits(), shear_rate(&e).to_bits());
    }
}
