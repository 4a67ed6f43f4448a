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
    /// Bit k: whether 0 < a_k < b_k.
    fn between(self, a: Self::Group, b: Self::Group) -> usize;
    /// Those of `items` whose bit is set, in their order; what follows them is any of the items.
    fn pack(self, kept: usize, items: &[u32; LANES]) -> [u32; LANES];
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

    /// Those of four items whose number here is above 0 and below b, in their order, at the front; and how many.
    #[inline(always)]
    pub fn pack_between(self, b: Self, items: &[u32; LANES]) -> ([u32; LANES], usize) {
        let kept = self.lanes.between(self.group, b.group);
        (self.lanes.pack(kept, items), kept.count_ones() as usize)
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

/// Subsets of four.
const SETS: usize = 1 << LANES;

/// For each subset, by its bits, which of the four are in it, in their order.
const PACKED: [[u8; LANES]; SETS] = {
    let mut table = [[0; LANES]; SETS];
    let mut set = 0;
    while set < SETS {
        let (mut k, mut count) = (0, 0);
        while k < LANES {
            if (set >> k) & 1 == 1 {
                table[set][count] = k as u8;
                count += 1;
            }
            k += 1;
        }
        set += 1;
    }
    table
};

/// The same by bytes of four-byte items.
#[cfg(target_arch = "x86_64")]
const PACKED_BYTES: [[u8; 4 * LANES]; SETS] = {
    let mut table = [[0; 4 * LANES]; SETS];
    let mut set = 0;
    while set < SETS {
        let mut byte = 0;
        while byte < 4 * LANES {
            table[set][byte] = 4 * PACKED[set][byte / 4] + (byte % 4) as u8;
            byte += 1;
        }
        set += 1;
    }
    table
};

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
    fn between(self, a: Quad, b: Quad) -> usize {
        let bit = |k: usize| usize::from(a.0[k] > 0.0 && a.0[k] < b.0[k]) << k;
        (0..LANES).map(bit).sum()
    }
    #[inline(always)]
    fn pack(self, kept: usize, items: &[u32; LANES]) -> [u32; LANES] {
        PACKED[kept % SETS].map(|k| items[usize::from(k) % LANES])
    }
    #[inline(always)]
    fn transpose(self, rows: [&Quad; LANES]) -> [Quad; LANES] {
        std::array::from_fn(|k| Quad(rows.map(|row| row.0[k])))
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use super::{LANES, Lanes, PACKED_BYTES, Quad, SETS};
    use pulp::{cast, f64x4, x86::V3};
    use std::arch::x86_64::{__m256d, _CMP_GT_OQ, _CMP_LT_OQ};

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
        fn between(self, a: f64x4, b: f64x4) -> usize {
            let avx = self.avx;
            let above = avx._mm256_cmp_pd::<_CMP_GT_OQ>(cast(a), avx._mm256_setzero_pd());
            let below = avx._mm256_cmp_pd::<_CMP_LT_OQ>(cast(a), cast(b));
            avx._mm256_movemask_pd(avx._mm256_and_pd(above, below)) as usize
        }
        #[inline(always)]
        fn pack(self, kept: usize, items: &[u32; LANES]) -> [u32; LANES] {
            let bytes = cast(PACKED_BYTES[kept % SETS]);
            cast(self.ssse3._mm_shuffle_epi8(cast(*items), bytes))
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
        for (x, limit) in [(a, c), (b, d), (d, a), (c, d)] {
            let (items, count) = x.pack_between(limit, &[5, 6, 7, 8]);
            let item = |k: usize| if k < count { f64::from(items[k]) } else { 0.0 };
            results.push(Four::gather(lanes, item));
        }
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
        // 0 < [1, -0, 1e-300, 3] < [inf, 2, 1e300, -1].
        assert_eq!(portable[16], [5.0, 7.0, 0.0, 0.0].map(f64::to_bits));
    }
}
