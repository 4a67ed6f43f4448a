//! Sums over the wall points of one face, as one particle sees them (docs/theory.md, E14, W7).
//!
//! Symbols as in `wall_row`.

use crate::math::{Tensor, Vector, add_outer, dot, scale};

use super::bend::Bend;

/// Sums over the points of one face, those of one wall with one normal, as one particle sees them.
pub(super) struct FaceSums<const D: usize> {
    pub(super) group: u16,
    /// Unit normal towards the material; 0 where neither slip nor (W4) asks for it.
    pub(super) normal: Vector<D>,
    pub(super) free_slip: bool,
    /// Where it is a bend with free slip.
    pub(super) bend: Option<Bend<D>>,
    /// v_w of the last point.
    pub(super) velocity: Vector<D>,
    /// -sum x (x) g.
    pub(super) around: Tensor<D>,
    /// sum g.
    pub(super) s: Vector<D>,
    /// What of it is there because rings and their walls are not of one length; 0 in the plane, in space and without slip.
    pub(super) by_length: Vector<D>,
    /// sum v_w (x) g.
    pub(super) carried: Tensor<D>,
    /// sum v_w.g of points that come forward with a stream (W13).
    pub(super) pushed: f64,
    /// sum c (P g)(P g)^T, c = 2 (D + 2)/(|g| r).
    pub(super) pair: Tensor<D>,
    /// sum c (P g)(P g)^T v_w.
    pub(super) dragged: Vector<D>,
    /// sum |F| V (n.x)^2 without slip, of what (W4) and (W14) are for; else 0.
    pub(super) lean: f64,
    /// sum |F| V x x^T of fluids and of grains with full pores, of x along the face of dry grains that bear a fluid (W7, W10); else 0.
    pub(super) moment: Tensor<D>,
    /// sum |F| V x (x.v_w) of the same; else 0.
    pub(super) moment_drive: Vector<D>,
}

impl<const D: usize> FaceSums<D> {
    pub(super) fn new(
        group: u16,
        normal: Vector<D>,
        free_slip: bool,
        bend: Option<Bend<D>>,
    ) -> Self {
        Self {
            group,
            normal,
            free_slip,
            bend,
            velocity: [0.0; D],
            around: [[0.0; D]; D],
            s: [0.0; D],
            by_length: [0.0; D],
            carried: [[0.0; D]; D],
            pushed: 0.0,
            pair: [[0.0; D]; D],
            dragged: [0.0; D],
            lean: 0.0,
            moment: [[0.0; D]; D],
            moment_drive: [0.0; D],
        }
    }

    /// Whether a point with this normal, in this bend, is one more of it.
    #[inline(always)]
    pub(super) fn has(&self, group: u16, normal: &Vector<D>, bend: Option<&Bend<D>>) -> bool {
        let same_bend = match (&self.bend, bend) {
            (None, None) => true,
            (Some(a), Some(b)) => a.is(b),
            _ => false,
        };
        self.group == group && self.normal == *normal && same_bend
    }

    /// n of P.
    #[inline(always)]
    pub(super) fn across(&self) -> &Vector<D> {
        self.bend.as_ref().map_or(&self.normal, |b| &b.normal)
    }

    /// P a.
    #[inline(always)]
    pub(super) fn seen(&self, a: &Vector<D>) -> Vector<D> {
        if self.free_slip {
            let n = self.across();
            scale(dot(n, a), n)
        } else {
            *a
        }
    }

    /// Adds what the lengths of rings make of a point: this part of g.
    #[inline(always)]
    pub(super) fn add_length(&mut self, part: f64, g: &Vector<D>) {
        for k in 0..D {
            self.by_length[k] += part * g[k];
        }
    }

    /// Adds |F| V x x^T of `weight` = |F| V.
    #[inline(always)]
    pub(super) fn add_moment(&mut self, weight: f64, x: &Vector<D>, vw: &Vector<D>) {
        add_outer(&mut self.moment, weight, x, x);
        let drive = weight * dot(x, vw);
        for k in 0..D {
            self.moment_drive[k] += drive * x[k];
        }
    }

    /// Adds a point; `c` is 2 (D + 2)/(|g| r).
    #[inline(always)]
    pub(super) fn add(&mut self, g: &Vector<D>, c: f64, vw: &Vector<D>) {
        for k in 0..D {
            self.s[k] += g[k];
        }
        let pg = self.seen(g);
        add_outer(&mut self.pair, c, &pg, &pg);
        // Most walls stand still.
        if *vw != [0.0; D] {
            add_outer(&mut self.carried, 1.0, vw, g);
            let drive = c * dot(&pg, vw);
            for k in 0..D {
                self.dragged[k] += drive * pg[k];
            }
        }
    }
}
