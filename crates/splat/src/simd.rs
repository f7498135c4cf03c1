//! Sixteen numbers at a time, by the widest vectors that this machine has.
//!
//! A kernel is written once, over the operations of [`Simd`], and compiled once per level: AVX-512, AVX2, SSE2, and
//! plain arrays for other processors. Every level gives the same bits: lanes never mix, nothing is fused, no operation
//! is an approximation of the processor's own, and the order of operations is the source's. The level is chosen once
//! per picture and passed as a value. This is the only module with `unsafe`.
//!
//! Two operations are where a renderer's time goes and have a form of their own on each level: [`Simd::take`], the
//! permutation that spreads samples over texels, and [`Math::look_up`], which reads one table entry per lane as two
//! neighbouring runs of four numbers and transposes them.
#![allow(unsafe_code, reason = "intrinsics, and functions that may only be called where the machine has them")]

/// Numbers that a kernel works on at once, on every level.
pub const LANES: usize = 16;

/// Sixteen numbers in memory, aligned to a cache line.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Lanes<T = f32>(pub [T; LANES]);

impl<T: Copy> Lanes<T> {
    /// The same number in every lane.
    pub const fn splat(value: T) -> Self {
        Self([value; LANES])
    }
}

impl<T: Copy + Default> Default for Lanes<T> {
    fn default() -> Self {
        Self::splat(T::default())
    }
}

/// Four numbers that are looked up together.
pub type Entry = [f32; 4];

/// Arithmetic on many numbers at a time. A value is proof that the machine has the instructions.
pub trait Math: Copy {
    /// Many f32.
    type F: Copy;
    /// As many truths.
    type M: Copy;

    /// The same number in every lane.
    fn splat(self, x: f32) -> Self::F;
    /// a + b
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    /// a − b
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    /// a · b
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// a / b
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// The smaller; b if one is NaN.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// The larger; b if one is NaN.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// |a|
    fn abs(self, a: Self::F) -> Self::F;

    /// a < b
    fn lt(self, a: Self::F, b: Self::F) -> Self::M;
    /// a ≤ b
    fn le(self, a: Self::F, b: Self::F) -> Self::M;
    /// Both.
    fn and(self, a: Self::M, b: Self::M) -> Self::M;
    /// Either.
    fn or(self, a: Self::M, b: Self::M) -> Self::M;
    /// a where true, b where not.
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F;

    /// The table at a position, linear between entries, number by number. Positions are held inside the table.
    fn look_up(self, table: &[Entry], position: Self::F) -> [Self::F; 4];
    /// 2^−n where `n + 1.5 · 2^23` is given, `0 ≤ n ≤ 126`.
    fn exp2_neg(self, shifted: Self::F) -> Self::F;
    /// A number near 1/√a for a > 0: half of its exponent, and a linear guess of the rest.
    fn rsqrt_guess(self, a: Self::F) -> Self::F;

    /// a + b · c, rounded twice.
    #[inline(always)]
    fn add_mul(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        self.add(a, self.mul(b, c))
    }

    /// 1/√a to 1e-6 relative, for a > 0: a guess, a step of Newton's form with constants that make the most of the
    /// guess (Kadlec, *Improving the fast inverse square root*, 2010), and one of Newton's iteration.
    #[inline(always)]
    fn rsqrt(self, a: Self::F) -> Self::F {
        let y = self.rsqrt_guess(a);
        let y = self
            .mul(self.mul(y, self.splat(0.703_952_25)), self.sub(self.splat(2.389_244_6), self.mul(self.mul(a, y), y)));
        let half = self.mul(a, self.splat(0.5));
        self.mul(y, self.sub(self.splat(1.5), self.mul(self.mul(half, y), y)))
    }
}

/// The operations of a level, on sixteen numbers.
pub trait Simd: Math {
    /// From memory.
    fn load(self, from: &[f32; LANES]) -> Self::F;
    /// To memory.
    fn store(self, x: Self::F, to: &mut [f32; LANES]);
    /// Lane `i` as bit `i`.
    fn bits(self, m: Self::M) -> u16;
    /// `row[index]` for each lane, indices taken modulo 16.
    fn take(self, row: &[f32; LANES], index: &Lanes<u32>) -> Self::F;
    /// Rows become columns.
    fn transpose(self, rows: &mut [Lanes; LANES]);
}

/// One or two sixteens. Two take little more time than one: while one waits for its results, the other computes.
pub trait Wide: Math {
    /// The operations on one.
    type One: Simd;
    /// How many.
    const N: usize;
    /// The operations on one.
    fn one(self) -> Self::One;
    /// Puts them together; the second is left out where there is one.
    fn join(self, a: <Self::One as Math>::F, b: <Self::One as Math>::F) -> Self::F;
    /// Takes them apart; the second is the first where there is one.
    fn part(self, x: Self::F) -> [<Self::One as Math>::F; 2];
    /// As [`Simd::bits`].
    fn all_bits(self, m: Self::M) -> [u16; 2];

    /// From two places in memory.
    #[inline(always)]
    fn load_from(self, from: &[Lanes], places: [usize; 2]) -> Self::F {
        let first = self.one().load(&from[places[0]].0);
        self.join(first, if Self::N == 2 { self.one().load(&from[places[1]].0) } else { first })
    }

    /// To two places in memory.
    #[inline(always)]
    fn store_to(self, x: Self::F, to: &mut [Lanes], places: [usize; 2]) {
        let [first, second] = self.part(x);
        self.one().store(first, &mut to[places[0]].0);
        if Self::N == 2 {
            self.one().store(second, &mut to[places[1]].0);
        }
    }
}

impl<S: Simd> Wide for S {
    type One = S;
    const N: usize = 1;

    #[inline(always)]
    fn one(self) -> S {
        self
    }
    #[inline(always)]
    fn join(self, a: S::F, _: S::F) -> S::F {
        a
    }
    #[inline(always)]
    fn part(self, x: S::F) -> [S::F; 2] {
        [x, x]
    }
    #[inline(always)]
    fn all_bits(self, m: S::M) -> [u16; 2] {
        [self.bits(m); 2]
    }
}

/// Two sixteens.
#[derive(Clone, Copy, Debug)]
pub struct Pair<S>(pub S);

macro_rules! twice {
    ($($name:ident)*) => {$(
        #[inline(always)]
        fn $name(self, a: Self::F, b: Self::F) -> Self::F {
            (self.0.$name(a.0, b.0), self.0.$name(a.1, b.1))
        }
    )*};
}

impl<S: Simd> Math for Pair<S> {
    type F = (S::F, S::F);
    type M = (S::M, S::M);

    twice!(add sub mul div min max);

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        (self.0.splat(x), self.0.splat(x))
    }
    #[inline(always)]
    fn abs(self, a: Self::F) -> Self::F {
        (self.0.abs(a.0), self.0.abs(a.1))
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        (self.0.lt(a.0, b.0), self.0.lt(a.1, b.1))
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> Self::M {
        (self.0.le(a.0, b.0), self.0.le(a.1, b.1))
    }
    #[inline(always)]
    fn and(self, a: Self::M, b: Self::M) -> Self::M {
        (self.0.and(a.0, b.0), self.0.and(a.1, b.1))
    }
    #[inline(always)]
    fn or(self, a: Self::M, b: Self::M) -> Self::M {
        (self.0.or(a.0, b.0), self.0.or(a.1, b.1))
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        (self.0.select(m.0, a.0, b.0), self.0.select(m.1, a.1, b.1))
    }
    #[inline(always)]
    fn look_up(self, table: &[Entry], position: Self::F) -> [Self::F; 4] {
        let [a, b] = [self.0.look_up(table, position.0), self.0.look_up(table, position.1)];
        [(a[0], b[0]), (a[1], b[1]), (a[2], b[2]), (a[3], b[3])]
    }
    #[inline(always)]
    fn exp2_neg(self, shifted: Self::F) -> Self::F {
        (self.0.exp2_neg(shifted.0), self.0.exp2_neg(shifted.1))
    }
    #[inline(always)]
    fn rsqrt_guess(self, a: Self::F) -> Self::F {
        (self.0.rsqrt_guess(a.0), self.0.rsqrt_guess(a.1))
    }
}

impl<S: Simd> Wide for Pair<S> {
    type One = S;
    const N: usize = 2;

    #[inline(always)]
    fn one(self) -> S {
        self.0
    }
    #[inline(always)]
    fn join(self, a: S::F, b: S::F) -> Self::F {
        (a, b)
    }
    #[inline(always)]
    fn part(self, x: Self::F) -> [S::F; 2] {
        [x.0, x.1]
    }
    #[inline(always)]
    fn all_bits(self, m: Self::M) -> [u16; 2] {
        [self.0.bits(m.0), self.0.bits(m.1)]
    }
}

/// 1.5 · 2^23: adding and taking it away rounds to an integer, which then stands in the low bits.
pub const ROUND: f32 = 12_582_912.0;

/// First guess of 1/√a: this less half the bits of a (Kadlec 2010).
const RSQRT_MAGIC: u32 = 0x5f1f_fff9;

/// A piece of work over the operations of a level.
pub trait Kernel {
    /// What it returns.
    type Output;
    /// Must be `#[inline(always)]`, and so must all that it calls, else it is compiled for the baseline.
    fn run<S: Simd>(self, s: S) -> Self::Output;
}

/// What the compiler may use. A value is proof that the machine has it: they are only made by [`Level::all`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level(Width);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Width {
    Plain,
    #[cfg(target_arch = "x86_64")]
    Sse2,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// All levels that this machine has, the widest last.
    pub fn all() -> Vec<Self> {
        #[allow(unused_mut, reason = "only x86-64 has more than one")]
        let mut levels = vec![Self(Width::Plain)];
        #[cfg(target_arch = "x86_64")]
        {
            levels.push(Self(Width::Sse2));
            if is_x86_feature_detected!("avx2") {
                levels.push(Self(Width::Avx2));
            }
            if has_avx512() {
                levels.push(Self(Width::Avx512));
            }
        }
        levels
    }

    /// The widest level that this machine has; `WAVESPLAT_SIMD` = `plain`, `sse2`, `avx2` or `avx512` asks for less.
    pub fn best() -> Self {
        let wanted = std::env::var("WAVESPLAT_SIMD").unwrap_or_default();
        let levels = Self::all();
        let named = levels.iter().find(|level| level.name() == wanted);
        *named.or(levels.last()).unwrap_or(&Self(Width::Plain))
    }

    /// For reports.
    pub fn name(self) -> &'static str {
        match self.0 {
            Width::Plain => "plain",
            #[cfg(target_arch = "x86_64")]
            Width::Sse2 => "sse2",
            #[cfg(target_arch = "x86_64")]
            Width::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Width::Avx512 => "avx512",
        }
    }

    /// Runs a kernel with the vectors of the level.
    #[inline]
    pub fn dispatch<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Width::Plain => kernel.run(Plain),
            // SAFETY: `self` exists, so `all` has found the instructions on this machine.
            #[cfg(target_arch = "x86_64")]
            Width::Sse2 => kernel.run(x86::Sse2(())),
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Width::Avx2 => unsafe {
                x86::run_avx2(
                    #[inline(always)]
                    || kernel.run(x86::Avx2(())),
                )
            },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Width::Avx512 => unsafe {
                x86::run_avx512(
                    #[inline(always)]
                    || kernel.run(x86::Avx512(())),
                )
            },
        }
    }

    /// Runs plain loops, which the compiler turns into vectors of the level. The closure, and what it calls, must be
    /// `#[inline(always)]`.
    #[inline]
    pub fn run<T>(self, kernel: impl FnOnce() -> T) -> T {
        match self.0 {
            Width::Plain => kernel(),
            #[cfg(target_arch = "x86_64")]
            Width::Sse2 => kernel(),
            // SAFETY: `self` exists, so `all` has found the instructions on this machine.
            #[cfg(target_arch = "x86_64")]
            Width::Avx2 => unsafe { x86::run_avx2(kernel) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Width::Avx512 => unsafe { x86::run_avx512(kernel) },
        }
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512bw")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl")
}

/// Arrays: what the others are held to, and what processors without a level of their own use.
#[derive(Clone, Copy, Debug)]
pub struct Plain;

type Array = [f32; LANES];

#[inline(always)]
fn each(a: Array, b: Array, operation: impl Fn(f32, f32) -> f32) -> Array {
    let mut out = [0.0; LANES];
    for i in 0..LANES {
        out[i] = operation(a[i], b[i]);
    }
    out
}

#[inline(always)]
fn truths(a: Array, b: Array, test: impl Fn(f32, f32) -> bool) -> u16 {
    let mut out = 0;
    for i in 0..LANES {
        out |= u16::from(test(a[i], b[i])) << i;
    }
    out
}

impl Math for Plain {
    type F = Array;
    type M = u16;

    #[inline(always)]
    fn splat(self, x: f32) -> Array {
        [x; LANES]
    }
    #[inline(always)]
    fn add(self, a: Array, b: Array) -> Array {
        each(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, a: Array, b: Array) -> Array {
        each(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, a: Array, b: Array) -> Array {
        each(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, a: Array, b: Array) -> Array {
        each(a, b, |a, b| a / b)
    }
    #[inline(always)]
    fn min(self, a: Array, b: Array) -> Array {
        each(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, a: Array, b: Array) -> Array {
        each(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn abs(self, a: Array) -> Array {
        each(a, a, |a, _| a.abs())
    }
    #[inline(always)]
    fn lt(self, a: Array, b: Array) -> u16 {
        truths(a, b, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, a: Array, b: Array) -> u16 {
        truths(a, b, |a, b| a <= b)
    }
    #[inline(always)]
    fn and(self, a: u16, b: u16) -> u16 {
        a & b
    }
    #[inline(always)]
    fn or(self, a: u16, b: u16) -> u16 {
        a | b
    }
    #[inline(always)]
    fn select(self, m: u16, a: Array, b: Array) -> Array {
        let mut out = b;
        for i in 0..LANES {
            out[i] = if m >> i & 1 == 1 { a[i] } else { b[i] };
        }
        out
    }
    #[inline(always)]
    fn look_up(self, table: &[Entry], position: Array) -> [Array; 4] {
        let last = (table.len() - 2) as f32;
        let mut out = [[0.0; LANES]; 4];
        for i in 0..LANES {
            let position = if position[i] > 0.0 { position[i] } else { 0.0 };
            let position = if position < last { position } else { last };
            let cell = position as usize;
            let t = position - cell as f32;
            for c in 0..4 {
                out[c][i] = table[cell][c] + (table[cell + 1][c] - table[cell][c]) * t;
            }
        }
        out
    }
    #[inline(always)]
    fn exp2_neg(self, shifted: Array) -> Array {
        let bits = |x: f32| (127 << 23_u32) - (x.to_bits().wrapping_sub(ROUND.to_bits()) << 23);
        each(shifted, shifted, |x, _| f32::from_bits(bits(x)))
    }
    #[inline(always)]
    fn rsqrt_guess(self, a: Array) -> Array {
        each(a, a, |a, _| f32::from_bits(RSQRT_MAGIC.wrapping_sub(a.to_bits() >> 1)))
    }
}

impl Simd for Plain {
    #[inline(always)]
    fn load(self, from: &Array) -> Array {
        *from
    }
    #[inline(always)]
    fn store(self, x: Array, to: &mut Array) {
        *to = x;
    }
    #[inline(always)]
    fn bits(self, m: u16) -> u16 {
        m
    }
    #[inline(always)]
    fn take(self, row: &Array, index: &Lanes<u32>) -> Array {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = row[index.0[i] as usize % LANES];
        }
        out
    }
    #[inline(always)]
    fn transpose(self, rows: &mut [Lanes; LANES]) {
        for r in 0..LANES {
            for c in 0..r {
                let above = rows[c].0[r];
                rows[c].0[r] = rows[r].0[c];
                rows[r].0[c] = above;
            }
        }
    }
}

#[cfg(target_arch = "x86_64")]
#[allow(clippy::wildcard_imports, reason = "a hundred intrinsics, all by their own prefix")]
mod x86 {
    use std::arch::x86_64::*;

    use super::{Entry, LANES, Lanes, Math, ROUND, RSQRT_MAGIC, Simd};

    /// SSE2, which every x86-64 has.
    #[derive(Clone, Copy, Debug)]
    pub struct Sse2(pub(super) ());
    /// AVX2.
    #[derive(Clone, Copy, Debug)]
    pub struct Avx2(pub(super) ());
    /// AVX-512 F, BW, DQ and VL.
    #[derive(Clone, Copy, Debug)]
    pub struct Avx512(pub(super) ());

    #[target_feature(enable = "avx2")]
    pub(super) fn run_avx2<T>(kernel: impl FnOnce() -> T) -> T {
        kernel()
    }

    #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2")]
    pub(super) fn run_avx512<T>(kernel: impl FnOnce() -> T) -> T {
        kernel()
    }

    /// Applies intrinsics to each register. Spelled out, since closures between an intrinsic and the function that has
    /// its instructions keep it from being inlined. SAFETY of all uses: the level's value proves that the machine has
    /// it; loads and stores stay inside the arrays that they are given.
    macro_rules! map {
        (2, $i:ident => $body:expr) => {
            map!(@ $i $body, 0 1)
        };
        (4, $i:ident => $body:expr) => {
            map!(@ $i $body, 0 1 2 3)
        };
        (@ $i:ident $body:expr, $($k:literal)*) => {
            // SAFETY: see the macro.
            unsafe { [$({ let $i: usize = $k; $body }),*] }
        };
    }

    /// The operations that SSE2 and AVX2 write alike: `$n` registers of `$w` numbers.
    macro_rules! registers {
        ($n:tt, $register:ty,
         $splat:ident $add:ident $sub:ident $mul:ident $div:ident $min:ident $max:ident
         $and:ident $or:ident $cast:ident $cast_back:ident $sub32:ident $shl32:ident $shr32:ident
         $splat32:ident, $lt:path, $le:path, $select:ident) => {
            type F = [$register; $n];
            type M = [$register; $n];

            #[inline(always)]
            fn splat(self, x: f32) -> Self::F {
                map!($n, _i => $splat(x))
            }
            #[inline(always)]
            fn add(self, a: Self::F, b: Self::F) -> Self::F {
                map!($n, i => $add(a[i], b[i]))
            }
            #[inline(always)]
            fn sub(self, a: Self::F, b: Self::F) -> Self::F {
                map!($n, i => $sub(a[i], b[i]))
            }
            #[inline(always)]
            fn mul(self, a: Self::F, b: Self::F) -> Self::F {
                map!($n, i => $mul(a[i], b[i]))
            }
            #[inline(always)]
            fn div(self, a: Self::F, b: Self::F) -> Self::F {
                map!($n, i => $div(a[i], b[i]))
            }
            #[inline(always)]
            fn min(self, a: Self::F, b: Self::F) -> Self::F {
                map!($n, i => $min(a[i], b[i]))
            }
            #[inline(always)]
            fn max(self, a: Self::F, b: Self::F) -> Self::F {
                map!($n, i => $max(a[i], b[i]))
            }
            #[inline(always)]
            fn abs(self, a: Self::F) -> Self::F {
                map!($n, i => $and(a[i], $splat(f32::from_bits(0x7fff_ffff))))
            }
            #[inline(always)]
            fn lt(self, a: Self::F, b: Self::F) -> Self::M {
                map!($n, i => $lt(a[i], b[i]))
            }
            #[inline(always)]
            fn le(self, a: Self::F, b: Self::F) -> Self::M {
                map!($n, i => $le(a[i], b[i]))
            }
            #[inline(always)]
            fn and(self, a: Self::M, b: Self::M) -> Self::M {
                map!($n, i => $and(a[i], b[i]))
            }
            #[inline(always)]
            fn or(self, a: Self::M, b: Self::M) -> Self::M {
                map!($n, i => $or(a[i], b[i]))
            }
            #[inline(always)]
            fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
                map!($n, i => $select!(m[i], a[i], b[i]))
            }
            #[inline(always)]
            fn exp2_neg(self, shifted: Self::F) -> Self::F {
                map!($n, i => {
                    let n = $sub32($cast(shifted[i]), $splat32(ROUND.to_bits() as i32));
                    $cast_back($sub32($splat32(127 << 23), $shl32::<23>(n)))
                })
            }
            #[inline(always)]
            fn rsqrt_guess(self, a: Self::F) -> Self::F {
                map!($n, i => $cast_back($sub32($splat32(RSQRT_MAGIC as i32), $shr32::<1>($cast(a[i])))))
            }
        };
    }

    /// Memory, alike as well.
    macro_rules! memory {
        ($n:tt, $w:literal, $load:ident $store:ident $bits:ident) => {
            #[inline(always)]
            fn load(self, from: &[f32; LANES]) -> Self::F {
                map!($n, i => $load(from.as_ptr().add($w * i)))
            }
            #[inline(always)]
            fn store(self, x: Self::F, to: &mut [f32; LANES]) {
                let to = to.as_mut_ptr();
                let _: [(); $n] = map!($n, i => $store(to.add($w * i), x[i]));
            }
            #[inline(always)]
            fn bits(self, m: Self::M) -> u16 {
                let parts: [u16; $n] = map!($n, i => ($bits(m[i]) as u16) << ($w * i));
                parts.into_iter().fold(0, |all, part| all | part)
            }
        };
    }

    macro_rules! select_sse2 {
        ($m:expr, $a:expr, $b:expr) => {
            _mm_or_ps(_mm_and_ps($m, $a), _mm_andnot_ps($m, $b))
        };
    }
    macro_rules! select_avx2 {
        ($m:expr, $a:expr, $b:expr) => {
            _mm256_blendv_ps($b, $a, $m)
        };
    }

    impl Math for Sse2 {
        registers!(4, __m128,
            _mm_set1_ps _mm_add_ps _mm_sub_ps _mm_mul_ps _mm_div_ps _mm_min_ps _mm_max_ps
            _mm_and_ps _mm_or_ps _mm_castps_si128 _mm_castsi128_ps _mm_sub_epi32 _mm_slli_epi32
            _mm_srli_epi32 _mm_set1_epi32,
            _mm_cmplt_ps, _mm_cmple_ps, select_sse2);

        #[inline(always)]
        fn look_up(self, table: &[Entry], position: Self::F) -> [Self::F; 4] {
            assert!(table.len() >= 2);
            let held = self.min(self.max(position, self.splat(0.0)), self.splat((table.len() - 2) as f32));
            let parts: [[__m128; 4]; 4] = map!(4, i => {
                let cells = _mm_cvttps_epi32(held[i]);
                let t = _mm_sub_ps(held[i], _mm_cvtepi32_ps(cells));
                let mut cell = [0_i32; 4];
                _mm_storeu_si128(cell.as_mut_ptr().cast(), cells);
                macro_rules! entry {
                    ($k:literal, $t:literal) => {{
                        // `held` keeps the cell and the one after it inside the table.
                        let from = table.as_ptr().add(cell[$k] as usize).cast::<f32>();
                        let (a, b) = (_mm_loadu_ps(from), _mm_loadu_ps(from.add(4)));
                        _mm_add_ps(a, _mm_mul_ps(_mm_sub_ps(b, a), _mm_shuffle_ps::<$t>(t, t)))
                    }};
                }
                let (a, b, c, d) = (entry!(0, 0x00), entry!(1, 0x55), entry!(2, 0xaa), entry!(3, 0xff));
                let (ab, cd) = (_mm_unpacklo_ps(a, b), _mm_unpacklo_ps(c, d));
                let (ab_high, cd_high) = (_mm_unpackhi_ps(a, b), _mm_unpackhi_ps(c, d));
                [
                    _mm_movelh_ps(ab, cd),
                    _mm_movehl_ps(cd, ab),
                    _mm_movelh_ps(ab_high, cd_high),
                    _mm_movehl_ps(cd_high, ab_high),
                ]
            });
            let [a, b, c, d] = parts;
            [[a[0], b[0], c[0], d[0]], [a[1], b[1], c[1], d[1]], [a[2], b[2], c[2], d[2]], [a[3], b[3], c[3], d[3]]]
        }
    }

    impl Simd for Sse2 {
        memory!(4, 4, _mm_loadu_ps _mm_storeu_ps _mm_movemask_ps);
        #[inline(always)]
        fn take(self, row: &[f32; LANES], index: &Lanes<u32>) -> Self::F {
            let mut out = [0.0; LANES];
            for i in 0..LANES {
                out[i] = row[index.0[i] as usize % LANES];
            }
            self.load(&out)
        }
        #[inline(always)]
        fn transpose(self, rows: &mut [Lanes; LANES]) {
            super::Plain.transpose(rows);
        }
    }

    impl Math for Avx2 {
        registers!(2, __m256,
            _mm256_set1_ps _mm256_add_ps _mm256_sub_ps _mm256_mul_ps _mm256_div_ps
            _mm256_min_ps _mm256_max_ps _mm256_and_ps _mm256_or_ps _mm256_castps_si256
            _mm256_castsi256_ps _mm256_sub_epi32 _mm256_slli_epi32 _mm256_srli_epi32 _mm256_set1_epi32,
            _mm256_cmp_ps::<_CMP_LT_OQ>, _mm256_cmp_ps::<_CMP_LE_OQ>, select_avx2);

        #[inline(always)]
        fn look_up(self, table: &[Entry], position: Self::F) -> [Self::F; 4] {
            assert!(table.len() >= 2);
            let held = self.min(self.max(position, self.splat(0.0)), self.splat((table.len() - 2) as f32));
            let parts: [[__m256; 4]; 2] = map!(2, i => {
                let cells = _mm256_cvttps_epi32(held[i]);
                let t = _mm256_sub_ps(held[i], _mm256_cvtepi32_ps(cells));
                let mut cell = [0_i32; 8];
                _mm256_storeu_si256(cell.as_mut_ptr().cast(), cells);
                // An entry and the one after it, one load. `held` keeps both inside the table.
                macro_rules! pair {
                    ($k:expr) => {
                        _mm256_loadu_ps(table.as_ptr().add(cell[$k] as usize).cast::<f32>())
                    };
                }
                macro_rules! entry {
                    ($k:literal, $t:literal) => {{
                        let (near, far) = (pair!($k), pair!($k + 4));
                        let a = _mm256_permute2f128_ps::<0x20>(near, far);
                        let b = _mm256_permute2f128_ps::<0x31>(near, far);
                        _mm256_add_ps(a, _mm256_mul_ps(_mm256_sub_ps(b, a), _mm256_permute_ps::<$t>(t)))
                    }};
                }
                let (a, b, c, d) = (entry!(0, 0x00), entry!(1, 0x55), entry!(2, 0xaa), entry!(3, 0xff));
                let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
                let (ab_high, cd_high) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
                [
                    _mm256_shuffle_ps::<0x44>(ab, cd),
                    _mm256_shuffle_ps::<0xee>(ab, cd),
                    _mm256_shuffle_ps::<0x44>(ab_high, cd_high),
                    _mm256_shuffle_ps::<0xee>(ab_high, cd_high),
                ]
            });
            let [a, b] = parts;
            [[a[0], b[0]], [a[1], b[1]], [a[2], b[2]], [a[3], b[3]]]
        }
    }

    impl Simd for Avx2 {
        memory!(2, 8, _mm256_loadu_ps _mm256_storeu_ps _mm256_movemask_ps);
        #[inline(always)]
        fn take(self, row: &[f32; LANES], index: &Lanes<u32>) -> Self::F {
            map!(2, i => {
                let index = _mm256_loadu_si256(index.0.as_ptr().add(8 * i).cast());
                let low = _mm256_permutevar8x32_ps(_mm256_loadu_ps(row.as_ptr()), index);
                let high = _mm256_permutevar8x32_ps(_mm256_loadu_ps(row.as_ptr().add(8)), index);
                // Bit 3 of the index, moved to the sign, chooses the half.
                _mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32::<28>(index)))
            })
        }
        #[inline(always)]
        fn transpose(self, rows: &mut [Lanes; LANES]) {
            let from = *rows;
            // Four blocks of eight by eight: pairs, fours, halves.
            for block in 0..4 {
                let (r, c) = (block / 2 * 8, block % 2 * 8);
                // SAFETY: eight numbers of each of eight rows are there.
                unsafe {
                    let mut x = [_mm256_setzero_ps(); 8];
                    for k in 0..8 {
                        x[k] = _mm256_loadu_ps(from[r + k].0.as_ptr().add(c));
                    }
                    let mut y = x;
                    for k in 0..4 {
                        y[2 * k] = _mm256_unpacklo_ps(x[2 * k], x[2 * k + 1]);
                        y[2 * k + 1] = _mm256_unpackhi_ps(x[2 * k], x[2 * k + 1]);
                    }
                    for k in 0..2 {
                        x[4 * k] = _mm256_shuffle_ps::<0x44>(y[4 * k], y[4 * k + 2]);
                        x[4 * k + 1] = _mm256_shuffle_ps::<0xee>(y[4 * k], y[4 * k + 2]);
                        x[4 * k + 2] = _mm256_shuffle_ps::<0x44>(y[4 * k + 1], y[4 * k + 3]);
                        x[4 * k + 3] = _mm256_shuffle_ps::<0xee>(y[4 * k + 1], y[4 * k + 3]);
                    }
                    for k in 0..4 {
                        let (low, high) = (
                            _mm256_permute2f128_ps::<0x20>(x[k], x[k + 4]),
                            _mm256_permute2f128_ps::<0x31>(x[k], x[k + 4]),
                        );
                        _mm256_storeu_ps(rows[c + k].0.as_mut_ptr().add(r), low);
                        _mm256_storeu_ps(rows[c + k + 4].0.as_mut_ptr().add(r), high);
                    }
                }
            }
        }
    }

    impl Math for Avx512 {
        type F = __m512;
        type M = __mmask16;

        #[inline(always)]
        fn splat(self, x: f32) -> __m512 {
            // SAFETY: `self` proves that the machine has AVX-512; so do all the others below.
            unsafe { _mm512_set1_ps(x) }
        }
        #[inline(always)]
        fn add(self, a: __m512, b: __m512) -> __m512 {
            // SAFETY: see `splat`.
            unsafe { _mm512_add_ps(a, b) }
        }
        #[inline(always)]
        fn sub(self, a: __m512, b: __m512) -> __m512 {
            // SAFETY: see `splat`.
            unsafe { _mm512_sub_ps(a, b) }
        }
        #[inline(always)]
        fn mul(self, a: __m512, b: __m512) -> __m512 {
            // SAFETY: see `splat`.
            unsafe { _mm512_mul_ps(a, b) }
        }
        #[inline(always)]
        fn div(self, a: __m512, b: __m512) -> __m512 {
            // SAFETY: see `splat`.
            unsafe { _mm512_div_ps(a, b) }
        }
        #[inline(always)]
        fn min(self, a: __m512, b: __m512) -> __m512 {
            // SAFETY: see `splat`.
            unsafe { _mm512_min_ps(a, b) }
        }
        #[inline(always)]
        fn max(self, a: __m512, b: __m512) -> __m512 {
            // SAFETY: see `splat`.
            unsafe { _mm512_max_ps(a, b) }
        }
        #[inline(always)]
        fn abs(self, a: __m512) -> __m512 {
            // SAFETY: see `splat`.
            unsafe { _mm512_abs_ps(a) }
        }
        #[inline(always)]
        fn lt(self, a: __m512, b: __m512) -> __mmask16 {
            // SAFETY: see `splat`.
            unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b) }
        }
        #[inline(always)]
        fn le(self, a: __m512, b: __m512) -> __mmask16 {
            // SAFETY: see `splat`.
            unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b) }
        }
        #[inline(always)]
        fn and(self, a: __mmask16, b: __mmask16) -> __mmask16 {
            a & b
        }
        #[inline(always)]
        fn or(self, a: __mmask16, b: __mmask16) -> __mmask16 {
            a | b
        }
        #[inline(always)]
        fn select(self, m: __mmask16, a: __m512, b: __m512) -> __m512 {
            // SAFETY: see `splat`.
            unsafe { _mm512_mask_blend_ps(m, b, a) }
        }
        #[inline(always)]
        fn exp2_neg(self, shifted: __m512) -> __m512 {
            // SAFETY: see `splat`.
            unsafe {
                let n = _mm512_sub_epi32(_mm512_castps_si512(shifted), _mm512_set1_epi32(ROUND.to_bits() as i32));
                _mm512_castsi512_ps(_mm512_sub_epi32(_mm512_set1_epi32(127 << 23), _mm512_slli_epi32::<23>(n)))
            }
        }
        #[inline(always)]
        fn rsqrt_guess(self, a: __m512) -> __m512 {
            // SAFETY: see `splat`.
            unsafe {
                let half = _mm512_srli_epi32::<1>(_mm512_castps_si512(a));
                _mm512_castsi512_ps(_mm512_sub_epi32(_mm512_set1_epi32(RSQRT_MAGIC as i32), half))
            }
        }
        #[inline(always)]
        fn look_up(self, table: &[Entry], position: __m512) -> [__m512; 4] {
            assert!(table.len() >= 2);
            let held = self.min(self.max(position, self.splat(0.0)), self.splat((table.len() - 2) as f32));
            // SAFETY: `held` keeps the cell and the one after it inside the table.
            unsafe {
                let cells = _mm512_cvttps_epi32(held);
                let t = _mm512_sub_ps(held, _mm512_cvtepi32_ps(cells));
                let mut cell = Lanes([0_i32; LANES]);
                _mm512_store_si512(cell.0.as_mut_ptr().cast(), cells);
                macro_rules! pair {
                    ($k:expr) => {
                        _mm256_loadu_ps(table.as_ptr().add(cell.0[$k] as usize).cast::<f32>())
                    };
                }
                // Two pairs of neighbouring entries: lanes k and k + 4.
                macro_rules! pairs {
                    ($k:expr) => {
                        _mm512_insertf32x8::<1>(_mm512_castps256_ps512(pair!($k)), pair!($k + 4))
                    };
                }
                macro_rules! entry {
                    ($k:literal, $t:literal) => {{
                        let (near, far) = (pairs!($k), pairs!($k + 8));
                        let a = _mm512_shuffle_f32x4::<0x88>(near, far);
                        let b = _mm512_shuffle_f32x4::<0xdd>(near, far);
                        _mm512_add_ps(a, _mm512_mul_ps(_mm512_sub_ps(b, a), _mm512_permute_ps::<$t>(t)))
                    }};
                }
                let (a, b, c, d) = (entry!(0, 0x00), entry!(1, 0x55), entry!(2, 0xaa), entry!(3, 0xff));
                let (ab, cd) = (_mm512_unpacklo_ps(a, b), _mm512_unpacklo_ps(c, d));
                let (ab_high, cd_high) = (_mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d));
                [
                    _mm512_shuffle_ps::<0x44>(ab, cd),
                    _mm512_shuffle_ps::<0xee>(ab, cd),
                    _mm512_shuffle_ps::<0x44>(ab_high, cd_high),
                    _mm512_shuffle_ps::<0xee>(ab_high, cd_high),
                ]
            }
        }
    }

    impl Simd for Avx512 {
        #[inline(always)]
        fn load(self, from: &[f32; LANES]) -> __m512 {
            // SAFETY: sixteen numbers are there.
            unsafe { _mm512_loadu_ps(from.as_ptr()) }
        }
        #[inline(always)]
        fn store(self, x: __m512, to: &mut [f32; LANES]) {
            // SAFETY: sixteen numbers are there.
            unsafe { _mm512_storeu_ps(to.as_mut_ptr(), x) }
        }
        #[inline(always)]
        fn bits(self, m: __mmask16) -> u16 {
            m
        }
        #[inline(always)]
        fn take(self, row: &[f32; LANES], index: &Lanes<u32>) -> __m512 {
            // SAFETY: sixteen numbers are there; the permutation uses the low four bits of each index.
            unsafe {
                let index = _mm512_loadu_si512(index.0.as_ptr().cast());
                _mm512_permutexvar_ps(index, _mm512_loadu_ps(row.as_ptr()))
            }
        }
        #[inline(always)]
        fn transpose(self, rows: &mut [Lanes; LANES]) {
            // SAFETY: sixteen numbers of each row are there.
            unsafe {
                let mut x = [_mm512_setzero_ps(); LANES];
                for k in 0..LANES {
                    x[k] = _mm512_load_ps(rows[k].0.as_ptr());
                }
                // Pairs and fours within quarters, then quarters.
                let mut y = x;
                for k in 0..8 {
                    y[2 * k] = _mm512_unpacklo_ps(x[2 * k], x[2 * k + 1]);
                    y[2 * k + 1] = _mm512_unpackhi_ps(x[2 * k], x[2 * k + 1]);
                }
                for k in 0..4 {
                    x[4 * k] = _mm512_shuffle_ps::<0x44>(y[4 * k], y[4 * k + 2]);
                    x[4 * k + 1] = _mm512_shuffle_ps::<0xee>(y[4 * k], y[4 * k + 2]);
                    x[4 * k + 2] = _mm512_shuffle_ps::<0x44>(y[4 * k + 1], y[4 * k + 3]);
                    x[4 * k + 3] = _mm512_shuffle_ps::<0xee>(y[4 * k + 1], y[4 * k + 3]);
                }
                for k in 0..4 {
                    y[k] = _mm512_shuffle_f32x4::<0x88>(x[k], x[k + 4]);
                    y[k + 4] = _mm512_shuffle_f32x4::<0xdd>(x[k], x[k + 4]);
                    y[k + 8] = _mm512_shuffle_f32x4::<0x88>(x[k + 8], x[k + 12]);
                    y[k + 12] = _mm512_shuffle_f32x4::<0xdd>(x[k + 8], x[k + 12]);
                }
                for k in 0..4 {
                    _mm512_store_ps(rows[k].0.as_mut_ptr(), _mm512_shuffle_f32x4::<0x88>(y[k], y[k + 8]));
                    _mm512_store_ps(rows[k + 8].0.as_mut_ptr(), _mm512_shuffle_f32x4::<0xdd>(y[k], y[k + 8]));
                    _mm512_store_ps(rows[k + 4].0.as_mut_ptr(), _mm512_shuffle_f32x4::<0x88>(y[k + 4], y[k + 12]));
                    _mm512_store_ps(rows[k + 12].0.as_mut_ptr(), _mm512_shuffle_f32x4::<0xdd>(y[k + 4], y[k + 12]));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every operation, on numbers with both signs, large and small.
    struct Everything<'a> {
        a: &'a Lanes,
        b: &'a Lanes,
        index: &'a Lanes<u32>,
        table: &'a [Entry],
    }

    impl Kernel for Everything<'_> {
        type Output = Vec<u32>;

        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> Vec<u32> {
            let (a, b) = (s.load(&self.a.0), s.load(&self.b.0));
            let [lt, le] = [s.lt(a, b), s.le(b, a)];
            let mut numbers = vec![
                s.splat(0.25),
                s.add(a, b),
                s.sub(a, b),
                s.mul(a, b),
                s.div(a, b),
                s.min(a, b),
                s.max(a, b),
                s.abs(a),
                s.select(lt, a, b),
                s.select(s.or(lt, le), a, b),
                s.select(s.and(lt, le), a, b),
                s.take(&self.a.0, self.index),
                s.exp2_neg(s.add(s.min(s.abs(a), s.splat(100.0)), s.splat(ROUND))),
                s.rsqrt(s.abs(b)),
                s.add_mul(a, a, b),
            ];
            numbers.extend(s.look_up(self.table, a));
            let mut rows: [Lanes; LANES] = std::array::from_fn(|r| Lanes(std::array::from_fn(|c| (16 * r + c) as f32)));
            s.transpose(&mut rows);
            assert!((0..LANES).all(|r| (0..LANES).all(|c| rows[c].0[r] == (16 * r + c) as f32)));
            let mut bits = vec![u32::from(s.bits(lt)), u32::from(s.bits(le))];
            for number in numbers {
                let mut out = [0.0; LANES];
                s.store(number, &mut out);
                bits.extend(out.map(f32::to_bits));
            }
            bits
        }
    }

    #[test]
    fn every_level_gives_the_same_bits() {
        let number = |i: usize| (i as f32 * 12.9898).sin() * 10.0_f32.powi(i as i32 % 5 - 1);
        let table: Vec<Entry> = (0..40).map(|i| std::array::from_fn(|c| number(4 * i + c))).collect();
        for round in 0..200 {
            let a = Lanes(std::array::from_fn(|i| number(round * 31 + i)));
            let b = Lanes(std::array::from_fn(|i| if i == 3 { a.0[3] } else { number(round * 17 + 500 + i) }));
            let index = Lanes(std::array::from_fn(|i| ((round + 7 * i) % LANES) as u32));
            let everything = || Everything { a: &a, b: &b, index: &index, table: &table };
            let plain = everything().run(Plain);
            for level in Level::all() {
                assert!(level.dispatch(everything()) == plain, "{level:?}");
            }
        }
    }

    #[test]
    fn reciprocal_square_roots_are_precise() {
        let kernel = |a: f32| Plain.rsqrt([a; LANES])[0];
        for i in 0..4000 {
            let a = 1e-12_f32 * 1.02_f32.powi(i % 3000);
            let want = 1.0 / f64::from(a).sqrt();
            assert!((f64::from(kernel(a)) - want).abs() < 1e-6 * want, "{a}");
        }
    }

    #[test]
    fn look_up_is_linear_and_stays_inside() {
        let table: Vec<Entry> = (0..10).map(|i| [i as f32, -(i as f32), 0.5, 2.0 * i as f32]).collect();
        let positions = [-5.0, 0.0, 0.25, 3.5, 7.75, 8.0, 9.0, 1e9, f32::NAN, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0];
        let [x, negative, constant, double] = Plain.look_up(&table, positions);
        for i in 0..LANES {
            let want = if positions[i] > 0.0 { positions[i].min(8.0) } else { 0.0 };
            assert_eq!([x[i], negative[i], constant[i], double[i]], [want, -want, 0.5, 2.0 * want]);
        }
    }
}
