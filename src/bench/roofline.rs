//! How fast one core can go through pairs: a kernel that does nothing else, and the same sums as one would write them
//! first, over neighbour lists and by a search of cells.
//!
//! The kernel is the fastest of those that were tried when the solver was laid out: four particles that lie together are
//! the four lanes, their common neighbours come one by one, each from one record of a cache line, nothing is stored for a
//! pair. One pass makes, by explicit SPH of weakly compressible matter with a stress tensor,
//!
//!   G_i = sum_j (v_j - v_i) (x) g,   D_i = sum_j (rho_j - rho_i) f,   a_i = sum_j [s_i + s_j - P_ij] g
//!
//! with g = f x_ij, f = (1 - r/2h)^3 inside the support 2h (Wendland C2 but for a factor), s = sigma/rho^2, and Monaghan's
//! viscosity P_ij = min(v.x, 0)/((r^2 + 0.01 h^2)(rho_i + rho_j)): 44 operations a pair, one root and one division. The
//! solver's own pair sweep also finds the neighbours and stores what its viscous solve reads again.

mod cells;

use crate::math::{Arch, Four, LANES, Lanes, Quad, in_lanes};
use crate::state::CellGrid;

use cells::Cells;

/// 0.01 in the viscosity's denominator [1].
const SOFTENING: f64 = 0.01;

/// What a neighbour is known by: x, y, v_x, v_y, rho, s_xx, s_xy, s_yy; one cache line.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(64))]
struct Body([f64; 8]);

/// Sums of one particle: G_xx, G_xy, G_yx, G_yy, D, a_x, a_y.
pub type Sums = [f64; 7];

/// Particles in the plane with their neighbours, for all forms of the kernel.
#[derive(Debug)]
pub struct Roofline {
    arch: Arch,
    h: f64,
    bodies: Vec<Body>,
    /// Neighbours within the support of any of four particles: those of particles 4 c to 4 c + 3 end at `ends[c]`.
    near: Vec<u32>,
    ends: Vec<usize>,
    /// Neighbours of each particle out to 1.15 supports, as lists with a skin have them.
    listed: Vec<u32>,
    listed_ends: Vec<usize>,
    cells: Cells,
    sums: Vec<[Quad; 7]>,
    plain: Vec<Sums>,
}

impl Roofline {
    /// Over particles at `x` [m] with velocities `v` [m/s], spacing dp [m] and smoothing length h [m]; density and stress
    /// are made up of the position. Particles left over from groups of four are left out.
    #[must_use]
    pub fn new(x: &[[f64; 2]], v: &[[f64; 2]], dp: f64, h: f64) -> Self {
        let bodies = in_strips(x, v, 2.0 * dp);
        let support = 2.0 * h;
        let places: Vec<[f64; 2]> = bodies.iter().map(|b| [b.0[0], b.0[1]]).collect();
        let grid = CellGrid::build(&places, support, &[None; 2]);
        let (mut near, mut ends) = (Vec::new(), Vec::new());
        for group in bodies.as_chunks::<LANES>().0 {
            let mut any = Vec::new();
            for body in group {
                grid.for_each_within(&[body.0[0], body.0[1]], support, |j, _, _| {
                    any.push(j as u32);
                });
            }
            any.sort_unstable();
            any.dedup();
            near.append(&mut any);
            ends.push(near.len());
        }
        let (mut listed, mut listed_ends) = (Vec::new(), Vec::new());
        for (i, x) in places.iter().enumerate() {
            let first = listed.len();
            grid.for_each_within(x, 1.15 * support, |j, _, _| {
                if j != i {
                    listed.push(j as u32);
                }
            });
            listed[first..].sort_unstable();
            listed_ends.push(listed.len());
        }
        Self {
            arch: Arch::detect(),
            h,
            sums: vec![[Quad::default(); 7]; bodies.len() / LANES],
            plain: vec![[0.0; 7]; bodies.len()],
            cells: Cells::new(&bodies, support),
            bodies,
            near,
            ends,
            listed,
            listed_ends,
        }
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.bodies.len()
    }

    /// Pairs within the support, each counted from both sides.
    #[must_use]
    pub fn pairs(&self) -> usize {
        let mut count = 0;
        let support2 = 4.0 * self.h * self.h;
        for (i, a) in self.bodies.iter().enumerate() {
            let start = if i == 0 { 0 } else { self.listed_ends[i - 1] };
            for &j in &self.listed[start..self.listed_ends[i]] {
                let b = &self.bodies[j as usize];
                let (dx, dy) = (a.0[0] - b.0[0], a.0[1] - b.0[1]);
                count += usize::from(dx * dx + dy * dy < support2);
            }
        }
        count
    }

    /// Share of the lanes' work that falls inside the support [1].
    #[must_use]
    pub fn filled(&self) -> f64 {
        self.pairs() as f64 / (LANES * self.near.len()).max(1) as f64
    }

    /// The kernel in lanes, over all particles.
    pub fn run(&mut self) {
        let mut sums = std::mem::take(&mut self.sums);
        in_lanes!(self.arch, |lanes| self.all_groups(lanes, &mut sums));
        self.sums = sums;
    }

    #[inline(always)]
    fn all_groups<L: Lanes>(&self, lanes: L, sums: &mut [[Quad; 7]]) {
        let mut start = 0;
        for (c, out) in sums.iter_mut().enumerate() {
            let end = self.ends[c];
            *out = self.group(lanes, LANES * c, &self.near[start..end]);
            start = end;
        }
    }

    /// Particles `first` to `first` + 3 against their neighbours.
    #[inline(always)]
    fn group<L: Lanes>(&self, lanes: L, first: usize, near: &[u32]) -> [Quad; 7] {
        let own = |k: usize| Four::gather(lanes, |m| self.bodies[first + m].0[k]);
        let (x, y, vx, vy) = (own(0), own(1), own(2), own(3));
        let (rho, xx, xy, yy) = (own(4), own(5), own(6), own(7));
        let splat = |a: f64| Four::splat(lanes, a);
        let (zero, one) = (splat(0.0), splat(1.0));
        let inverse = splat(0.5 / self.h);
        let soft = splat(SOFTENING * self.h * self.h);
        let (mut gxx, mut gxy, mut gyx, mut gyy) = (zero, zero, zero, zero);
        let (mut diffusion, mut ax, mut ay) = (zero, zero, zero);
        for &j in near {
            let b = &self.bodies[j as usize].0;
            let (dx, dy) = (x - splat(b[0]), y - splat(b[1]));
            let (dvx, dvy) = (vx - splat(b[2]), vy - splat(b[3]));
            let r2 = dx * dx + dy * dy;
            let t = (one - r2.sqrt() * inverse).max(zero);
            let f = t * t * t;
            let (gx, gy) = (f * dx, f * dy);
            gxx -= dvx * gx;
            gxy -= dvx * gy;
            gyx -= dvy * gx;
            gyy -= dvy * gy;
            let rho_j = splat(b[4]);
            diffusion += (rho_j - rho) * f;
            let along = (dvx * dx + dvy * dy).min(zero);
            let push = along.over((r2 + soft) * (rho + rho_j));
            let sxy = xy + splat(b[6]);
            ax += (xx + splat(b[5]) - push) * gx + sxy * gy;
            ay += sxy * gx + (yy + splat(b[7]) - push) * gy;
        }
        [gxx, gxy, gyx, gyy, diffusion, ax, ay].map(Four::store)
    }

    /// The same sums by a plain scalar loop over each particle's listed neighbours.
    pub fn run_plain(&mut self) {
        let mut plain = std::mem::take(&mut self.plain);
        let mut start = 0;
        for (i, out) in plain.iter_mut().enumerate() {
            let end = self.listed_ends[i];
            *out = self.plain_row(i, &self.listed[start..end]);
            start = end;
        }
        self.plain = plain;
    }

    fn plain_row(&self, i: usize, listed: &[u32]) -> Sums {
        let mut s = [0.0; 7];
        for &j in listed {
            add_pair(self.h, &self.bodies[i], &self.bodies[j as usize], &mut s);
        }
        s
    }

    /// The same sums by a plain scalar search of the nine cells around each particle, without lists: how codes that keep no
    /// lists go through pairs.
    pub fn run_cells(&mut self) {
        self.cells.run(self.h);
    }

    /// Largest difference between the forms over the largest sum, for the worst of the seven sums [1].
    #[must_use]
    pub fn disagreement(&mut self) -> f64 {
        self.run();
        self.run_plain();
        self.run_cells();
        let celled = self.cells.in_strips();
        let mut worst = 0.0f64;
        for k in 0..7 {
            let (mut apart, mut largest) = (0.0f64, f64::MIN_POSITIVE);
            for (c, sums) in self.sums.iter().enumerate() {
                for m in 0..LANES {
                    let i = LANES * c + m;
                    let b = self.plain[i][k];
                    for a in [sums[k].0[m], celled[i][k]] {
                        if !(a - b).is_finite() {
                            return f64::INFINITY;
                        }
                        apart = apart.max((a - b).abs());
                    }
                    largest = largest.max(b.abs());
                }
            }
            worst = worst.max(apart / largest);
        }
        worst
    }
}

/// Adds a pair to the sums of its first particle; nothing outside the support, and nothing of a particle with itself.
#[inline(always)]
fn add_pair(h: f64, a: &Body, b: &Body, s: &mut Sums) {
    let [x, y, vx, vy, rho, xx, xy, yy] = a.0;
    let b = &b.0;
    let (dx, dy) = (x - b[0], y - b[1]);
    let r2 = dx * dx + dy * dy;
    if r2 < 4.0 * h * h {
        let t = 1.0 - r2.sqrt() * (0.5 / h);
        let f = t * t * t;
        let (gx, gy) = (f * dx, f * dy);
        let (dvx, dvy) = (vx - b[2], vy - b[3]);
        s[0] -= dvx * gx;
        s[1] -= dvx * gy;
        s[2] -= dvy * gx;
        s[3] -= dvy * gy;
        s[4] += (b[4] - rho) * f;
        let along = (dvx * dx + dvy * dy).min(0.0);
        let push = along / ((r2 + SOFTENING * h * h) * (rho + b[4]));
        s[5] += (xx + b[5] - push) * gx + (xy + b[6]) * gy;
        s[6] += (xy + b[6]) * gx + (yy + b[7] - push) * gy;
    }
}

/// Sorted by strips of this height [m] and along them, so that four in a row lie together.
fn in_strips(x: &[[f64; 2]], v: &[[f64; 2]], height: f64) -> Vec<Body> {
    let strip = |i: &usize| (x[*i][1] / height).floor();
    let mut order: Vec<usize> = (0..x.len()).collect();
    order.sort_by(|a, b| {
        let rows = strip(a).total_cmp(&strip(b));
        rows.then(x[*a][0].total_cmp(&x[*b][0]))
    });
    order.truncate(x.len() / LANES * LANES);
    let body = |i: usize| {
        let ([a, b], [c, d]) = (x[i], v[i]);
        let (p, q) = ((3.0 * a + b).sin(), (a - 5.0 * b).cos());
        Body([a, b, c, d, 1.0 + 0.1 * p, 2.0 + q, 0.5 * p, 2.0 - q])
    };
    order.into_iter().map(body).collect()
}

/// Lower and upper corner.
fn bounds(group: &[Body]) -> ([f64; 2], [f64; 2]) {
    let end = |k: usize, f: fn(f64, f64) -> f64, from: f64| {
        group.iter().fold(from, |a: f64, b| f(a, b.0[k]))
    };
    (
        [0, 1].map(|k| end(k, f64::min, f64::INFINITY)),
        [0, 1].map(|k| end(k, f64::max, f64::NEG_INFINITY)),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 15 x 15 places without pattern, spacing 1.
    fn places() -> (Vec<[f64; 2]>, Vec<[f64; 2]>) {
        let part = |n: usize, a: f64| (n as f64 * a).fract() - 0.5;
        let x = |n: usize| {
            let (i, j) = ((n % 15) as f64, (n / 15) as f64);
            [i + 0.4 * part(n, 0.754_877), j + 0.4 * part(n, 0.569_84)]
        };
        let v = |n: usize| [part(n, 0.618_034), part(n, 0.414_21)];
        ((0..225).map(x).collect(), (0..225).map(v).collect())
    }

    #[test]
    fn the_kernel_makes_the_sums_of_the_plain_loop() {
        let (x, v) = places();
        let mut roofline = Roofline::new(&x, &v, 1.0, 1.6);
        assert_eq!(roofline.particles(), 224);
        assert!(roofline.disagreement() < 1e-12);
        roofline.sums[5][2].0[1] += 1.0;
        roofline.run();
        assert!(roofline.disagreement() < 1e-12, "sums must be made anew");
        assert!((0.3..1.0).contains(&roofline.filled()));
    }

    #[test]
    fn the_plain_loop_makes_the_sums_over_all_pairs() {
        let (x, v) = places();
        let mut roofline = Roofline::new(&x, &v, 1.0, 1.6);
        roofline.run_plain();
        let mut pairs = 0;
        for (i, a) in roofline.bodies.iter().enumerate() {
            let (mut divergence, mut push) = (0.0, [0.0; 2]);
            for (j, b) in roofline.bodies.iter().enumerate() {
                let d: [f64; 2] = [0, 1].map(|k| a.0[k] - b.0[k]);
                let r = d[0].hypot(d[1]);
                if i == j || r >= 3.2 {
                    continue;
                }
                pairs += 1;
                let w: [f64; 2] = d.map(|d| d * (1.0 - r / 3.2).powi(3));
                let u: [f64; 2] = [0, 1].map(|k| a.0[2 + k] - b.0[2 + k]);
                divergence -= u[0] * w[0] + u[1] * w[1];
                let closing = (u[0] * d[0] + u[1] * d[1]).min(0.0);
                let damping = closing / ((r * r + 0.01 * 1.6 * 1.6) * (a.0[4] + b.0[4]));
                for k in 0..2 {
                    let sigma = |m: usize| a.0[5 + k + m] + b.0[5 + k + m];
                    push[k] += sigma(0) * w[0] + sigma(1) * w[1] - damping * w[k];
                }
            }
            let s = &roofline.plain[i];
            assert!((s[0] + s[3] - divergence).abs() < 1e-12);
            assert!((s[5] - push[0]).abs() < 1e-12 && (s[6] - push[1]).abs() < 1e-12);
        }
        assert_eq!(pairs, roofline.pairs());
    }
}
