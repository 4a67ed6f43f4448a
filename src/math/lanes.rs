//! Four numbers in step: the hot loops' arithmetic, on AVX2 where the machine has it and on plain arrays elsewhere.
//!
//! Both give the same bits: the same operations in the same order, none of them fused. The choice is made once, when a
//! solver is made ([`Arch::detect`]); [`in_lanes!`] compiles a sweep for both.
//!
//! Explicit lanes because compilers find few of them in loops that gather from neighbours: left to itself the stress
//! sweep of a column takes 1.6 times, the force sweep twice as long.

use std::ops::{Add, AddAssign, Mul, Sub, SubAssign};

/// Numbers to a group.
pub const LANES: usize = 4;

/// Four numbers, aligned for one load.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct Quad(pub [f64; LANES]);

/// The operations on groups of four; a token of the instructions they use.
pub trait Lanes: Copy {
    /// A group in registers.
    type Group: Copy;
    /// The same number four times.
    fn splat(self, a: f64) -> Self::Group;
    /// From memory.
    fn load(self, a: &Quad) -> Self::Group;
    /// To memory.
    fn store(self, a: Self::Group) -> Quad;
    /// a + b.
    fn add(self, a: Self::Group, b: Self::Group) -> Self::Group;
    /// a - b.
    fn sub(self, a: Self::Group, b: Self::Group) -> Self::Group;
    /// a b.
    fn mul(self, a: Self::Group, b: Self::Group) -> Self::Group;
    /// a/b.
    fn div(self, a: Self::Group, b: Self::Group) -> Self::Group;
    /// Square root.
    fn sqrt(self, a: Self::Group) -> Self::Group;
    /// a where a > b, else b.
    fn max(self, a: Self::Group, b: Self::Group) -> Self::Group;
    /// a where a < b, else b.
    fn min(self, a: Self::Group, b: Self::Group) -> Self::Group;
    /// x where a > b, else 0.
    fn where_greater(self, a: Self::Group, b: Self::Group, x: Self::Group) -> Self::Group;
    /// The first components of four rows, the second ones, ...
    fn transpose(self, rows: [&Quad; LANES]) -> [Self::Group; LANES];
}

/// A group with the operators of arithmetic.
#[derive(Clone, Copy, Debug)]
pub struct Four<L: Lanes> {
    lanes: L,
    group: L::Group,
}

impl<L: Lanes> Four<L> {
    /// The same number four times.
    #[inline(always)]
    pub fn splat(lanes: L, a: f64) -> Self {
        Self {
            lanes,
            group: lanes.splat(a),
        }
    }

    /// From memory.
    #[inline(always)]
    pub fn load(lanes: L, a: &Quad) -> Self {
        Self {
            lanes,
            group: lanes.load(a),
        }
    }

    /// From four places.
    #[inline(always)]
    pub fn gather(lanes: L, at: impl Fn(usize) -> f64) -> Self {
        Self::load(lanes, &Quad([at(0), at(1), at(2), at(3)]))
    }

    /// Component k of four rows, for each k.
    #[inline(always)]
    pub fn transpose(lanes: L, rows: [&Quad; LANES]) -> [Self; LANES] {
        lanes.transpose(rows).map(|group| Self { lanes, group })
    }

    /// To memory.
    #[inline(always)]
    pub fn store(self) -> Quad {
        self.lanes.store(self.group)
    }

    /// (a0 + a2) + (a1 + a3).
    #[inline(always)]
    pub fn sum(self) -> f64 {
        let a = self.store().0;
        (a[0] + a[2]) + (a[1] + a[3])
    }

    /// The largest of the four.
    #[inline(always)]
    pub fn largest(self) -> f64 {
        let a = self.store().0;
        a[0].max(a[2]).max(a[1].max(a[3]))
    }

    /// self/b.
    #[inline(always)]
    pub fn over(self, b: Self) -> Self {
        self.with(self.lanes.div(self.group, b.group))
    }

    /// Square root.
    #[inline(always)]
    pub fn sqrt(self) -> Self {
        self.with(self.lanes.sqrt(self.group))
    }

    /// self where it is larger than b, else b.
    #[inline(always)]
    pub fn max(self, b: Self) -> Self {
        self.with(self.lanes.max(self.group, b.group))
    }

    /// self where it is smaller than b, else b.
    #[inline(always)]
    pub fn min(self, b: Self) -> Self {
        self.with(self.lanes.min(self.group, b.group))
    }

    /// x where self > b, else 0.
    #[inline(always)]
    pub fn where_greater(self, b: Self, x: Self) -> Self {
        self.with(self.lanes.where_greater(self.group, b.group, x.group))
    }

    #[inline(always)]
    fn with(self, group: L::Group) -> Self {
        Self {
            lanes: self.lanes,
            group,
        }
    }
}

impl<L: Lanes> Add for Four<L> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        self.with(self.lanes.add(self.group, b.group))
    }
}

impl<L: Lanes> Sub for Four<L> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        self.with(self.lanes.sub(self.group, b.group))
    }
}

impl<L: Lanes> Mul for Four<L> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        self.with(self.lanes.mul(self.group, b.group))
    }
}

impl<L: Lanes> AddAssign for Four<L> {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

impl<L: Lanes> SubAssign for Four<L> {
    #[inline(always)]
    fn sub_assign(&mut self, b: Self) {
        *self = *self - b;
    }
}

/// Plain arrays: any machine.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

impl Lanes for Portable {
    type Group = Quad;
    #[inline(always)]
    fn splat(self, a: f64) -> Quad {
        Quad([a; LANES])
    }
    #[inline(always)]
    fn load(self, a: &Quad) -> Quad {
        *a
    }
    #[inline(always)]
    fn store(self, a: Quad) -> Quad {
        a
    }
    #[inline(always)]
    fn add(self, a: Quad, b: Quad) -> Quad {
        Quad(std::array::from_fn(|k| a.0[k] + b.0[k]))
    }
    #[inline(always)]
    fn sub(self, a: Quad, b: Quad) -> Quad {
        Quad(std::array::from_fn(|k| a.0[k] - b.0[k]))
    }
    #[inline(always)]
    fn mul(self, a: Quad, b: Quad) -> Quad {
        Quad(std::array::from_fn(|k| a.0[k] * b.0[k]))
    }
    #[inline(always)]
    fn div(self, a: Quad, b: Quad) -> Quad {
        Quad(std::array::from_fn(|k| a.0[k] / b.0[k]))
    }
    #[inline(always)]
    fn sqrt(self, a: Quad) -> Quad {
        Quad(a.0.map(f64::sqrt))
    }
    #[inline(always)]
    fn max(self, a: Quad, b: Quad) -> Quad {
        // As AVX does it, so that bits agree on NaN and on zeros too.
        let larger = |k: usize| if a.0[k] > b.0[k] { a.0[k] } else { b.0[k] };
        Quad(std::array::from_fn(larger))
    }
    #[inline(always)]
    fn min(self, a: Quad, b: Quad) -> Quad {
        let smaller = |k: usize| if a.0[k] < b.0[k] { a.0[k] } else { b.0[k] };
        Quad(std::array::from_fn(smaller))
    }
    #[inline(always)]
    fn where_greater(self, a: Quad, b: Quad, x: Quad) -> Quad {
        let kept = |k: usize| if a.0[k] > b.0[k] { x.0[k] } else { 0.0 };
        Quad(std::array::from_fn(kept))
    }
    #[inline(always)]
    fn transpose(self, rows: [&Quad; LANES]) -> [Quad; LANES] {
        std::array::from_fn(|k| Quad(rows.map(|row| row.0[k])))
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{LANES, Lanes, Quad};
    use pulp::{cast, f64x4, x86::V3};
    use std::arch::x86_64::__m256d;

    /// A closure that becomes part of its caller. Called once by value, a closure hides behind a function of its own that
    /// no instructions are chosen for.
    pub struct Inlined<F>(pub F);

    impl<R, F: FnMut() -> R> pulp::NullaryFnOnce for Inlined<F> {
        type Output = R;
        #[inline(always)]
        fn call(mut self) -> R {
            (self.0)()
        }
    }

    impl Lanes for V3 {
        type Group = f64x4;
        #[inline(always)]
        fn splat(self, a: f64) -> f64x4 {
            self.splat_f64x4(a)
        }
        #[inline(always)]
        fn load(self, a: &Quad) -> f64x4 {
            cast(a.0)
        }
        #[inline(always)]
        fn store(self, a: f64x4) -> Quad {
            Quad(cast(a))
        }
        #[inline(always)]
        fn add(self, a: f64x4, b: f64x4) -> f64x4 {
            self.add_f64x4(a, b)
        }
        #[inline(always)]
        fn sub(self, a: f64x4, b: f64x4) -> f64x4 {
            self.sub_f64x4(a, b)
        }
        #[inline(always)]
        fn mul(self, a: f64x4, b: f64x4) -> f64x4 {
            self.mul_f64x4(a, b)
        }
        #[inline(always)]
        fn div(self, a: f64x4, b: f64x4) -> f64x4 {
            self.div_f64x4(a, b)
        }
        #[inline(always)]
        fn sqrt(self, a: f64x4) -> f64x4 {
            self.sqrt_f64x4(a)
        }
        #[inline(always)]
        fn max(self, a: f64x4, b: f64x4) -> f64x4 {
            cast(self.avx._mm256_max_pd(cast(a), cast(b)))
        }
        #[inline(always)]
        fn min(self, a: f64x4, b: f64x4) -> f64x4 {
            cast(self.avx._mm256_min_pd(cast(a), cast(b)))
        }
        #[inline(always)]
        fn where_greater(self, a: f64x4, b: f64x4, x: f64x4) -> f64x4 {
            self.select_f64x4(self.cmp_gt_f64x4(a, b), x, self.splat_f64x4(0.0))
        }
        #[inline(always)]
        fn transpose(self, rows: [&Quad; LANES]) -> [f64x4; LANES] {
            let avx = self.avx;
            let [a, b, c, d]: [__m256d; LANES] = rows.map(|row| cast(row.0));
            let (low, high) = (avx._mm256_unpacklo_pd(a, b), avx._mm256_unpackhi_pd(a, b));
            let (low2, high2) = (avx._mm256_unpacklo_pd(c, d), avx._mm256_unpackhi_pd(c, d));
            [
                cast(avx._mm256_permute2f128_pd::<0x20>(low, low2)),
                cast(avx._mm256_permute2f128_pd::<0x20>(high, high2)),
                cast(avx._mm256_permute2f128_pd::<0x31>(low, low2)),
                cast(avx._mm256_permute2f128_pd::<0x31>(high, high2)),
            ]
        }
    }
}

#[cfg(target_arch = "x86_64")]
pub use avx2::Inlined;

/// The instructions a solver uses.
#[derive(Clone, Copy, Debug)]
pub enum Arch {
    /// Plain arrays.
    Portable,
    /// AVX2.
    #[cfg(target_arch = "x86_64")]
    Avx2(pulp::x86::V3),
}

impl Arch {
    /// The best that this machine has.
    #[must_use]
    pub fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(token) = pulp::x86::V3::try_new() {
            return Self::Avx2(token);
        }
        Self::Portable
    }
}

/// `in_lanes!(arch, |lanes| body)`: body with the token of an architecture, compiled for it. What it calls with the
/// token must be `#[inline(always)]`.
macro_rules! in_lanes {
    ($arch:expr, |$lanes:ident| $body:expr) => {
        match $arch {
            $crate::math::Arch::Portable => {
                let $lanes = $crate::math::Portable;
                $body
            }
            #[cfg(target_arch = "x86_64")]
            $crate::math::Arch::Avx2(token) => token.vectorize($crate::math::Inlined(
                #[inline(always)]
                || {
                    let $lanes = token;
                    $body
                },
            )),
        }
    };
}
pub(crate) use in_lanes;

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation on awkward numbers.
    #[inline(always)]
    fn all<L: Lanes>(lanes: L) -> Vec<[u64; LANES]> {
        let rows = [
            Quad([1.0, -0.0, 1e-300, 3.0]),
            Quad([0.1, 0.0, -7.5, f64::NAN]),
            Quad([f64::INFINITY, 2.0, 1e300, -1.0]),
            Quad([0.3, -0.7, 5e-324, 9.0]),
        ];
        let [a, b, c, d] = std::array::from_fn(|k| Four::load(lanes, &rows[k]));
        let mut results = vec![
            a + b,
            a - b,
            a * c,
            a.over(d),
            d.sqrt(),
            a.max(b),
            b.max(a),
            a.min(b),
            b.min(a),
            a.where_greater(b, c),
            Four::splat(lanes, d.sum()),
            Four::splat(lanes, a.largest()),
        ];
        results.extend(Four::transpose(lanes, rows.each_ref()));
        // Not a number has no sign worth comparing.
        results
            .into_iter()
            .map(|r| {
                r.store()
                    .0
                    .map(|x| if x.is_nan() { 1 } else { x.to_bits() })
            })
            .collect()
    }

    #[test]
    fn both_architectures_give_the_same_bits() {
        let portable = all(Portable);
        let here = in_lanes!(Arch::detect(), |lanes| all(lanes));
        assert_eq!(portable, here);
        assert_eq!(
            portable[12],
            [1.0, 0.1, f64::INFINITY, 0.3].map(f64::to_bits)
        );
    }
}
