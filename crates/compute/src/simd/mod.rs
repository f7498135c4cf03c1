//! SIMD: sixteen numbers at a time, by the widest vectors that this machine has.
//!
//! A kernel is written once, over the operations of [`Simd`], and compiled once per level: for AVX-512, AVX2 and SSE2
//! on x86-64, for NEON on 64-bit ARM, for `simd128` in WebAssembly that is compiled with it, and for plain arrays on
//! other processors. Plain arrays are no level where there are vectors, since they would be half of the program; tests
//! compare every operation of the others with theirs. Every level gives the same bits: lanes never mix, nothing is
//! fused, no operation is an approximation of the processor's own, and the order of operations is the source's. The
//! level is chosen once per picture and passed as a value.
//! Two operations are where a renderer's time goes and have a form of their own on each level: [`Simd::gather`], the
//! permutation that spreads samples over texels, and [`Math::look_up`], which reads one table entry per lane as two
//! neighbouring runs of four numbers and transposes them.
#![allow(unsafe_code, reason = "intrinsics, and functions that may only be called where the machine has them")]

/// Moves of quads where a register holds one: whole registers change places.
#[cfg(any(target_arch = "x86_64", target_arch = "aarch64", target_feature = "simd128"))]
macro_rules! per_register {
    () => {
        #[inline(always)]
        fn transpose_quads(self, [a, b, c, d]: [Self::F; 4]) -> [Self::F; 4] {
            [[a[0], b[0], c[0], d[0]], [a[1], b[1], c[1], d[1]], [a[2], b[2], c[2], d[2]], [a[3], b[3], c[3], d[3]]]
        }
        #[inline(always)]
        fn interleave_quads(self, a: Self::F, b: Self::F) -> [Self::F; 2] {
            [[a[0], b[0], a[1], b[1]], [a[2], b[2], a[3], b[3]]]
        }
        #[inline(always)]
        fn deinterleave_quads(self, a: Self::F, b: Self::F) -> [Self::F; 2] {
            [[a[0], a[2], b[0], b[2]], [a[1], a[3], b[1], b[3]]]
        }
        #[inline(always)]
        fn middle_quads(self, a: Self::F, b: Self::F) -> Self::F {
            [a[1], a[2], b[1], b[2]]
        }
    };
}

#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(target_arch = "aarch64")]
mod neon;
mod pair;
mod places;
mod plain;
#[cfg(target_feature = "simd128")]
mod simd128;
#[cfg(target_arch = "x86_64")]
mod x86;

#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};

use std::sync::OnceLock;

pub use pair::Pair;
pub use places::{FAR_ROOM, NEAR_ROOM, Nearness, Places};
pub use plain::Plain;

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

/// Bytes of a cache line, which processors fetch at a time.
#[cfg(target_arch = "x86_64")]
const LINE_BYTES: usize = 64;

/// Rows of numbers, for [`Simd::load_rows`].
#[derive(Clone, Copy, Debug)]
pub struct Rows<'a> {
    numbers: &'a [f32],
    stride: usize,
    /// Number of places from which four whole rows of sixteen can be read.
    n_places: usize,
}

impl<'a> Rows<'a> {
    /// Rows that lie `stride` numbers apart.
    pub fn new(numbers: &'a [f32], stride: usize) -> Self {
        let n = stride.saturating_mul(3).saturating_add(LANES);
        Self { numbers, stride, n_places: (numbers.len() + 1).saturating_sub(n) }
    }
}

/// Four numbers that are looked up together.
pub type Entry = [f32; 4];

/// Arithmetic on many numbers at a time. A value is proof that the machine has the instructions.
pub trait Math: Copy {
    /// Vector of f32.
    type F: Copy;
    /// Mask: one truth value per lane.
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
    /// Lanes where both masks are true.
    fn and(self, a: Self::M, b: Self::M) -> Self::M;
    /// Lanes where either mask is true.
    fn or(self, a: Self::M, b: Self::M) -> Self::M;
    /// a where true, b where not.
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F;

    /// The table at a position, linear between entries, number by number. Positions are clamped to `0..=len − 2`.
    fn look_up(self, table: &[Entry], position: Self::F) -> [Self::F; 4];
    /// 2^−n from `shifted = n + 1.5 · 2^23` ([`ROUND`]), `0 ≤ n ≤ 126`: n stands in its low bits, and becomes an
    /// exponent.
    fn exp2_neg(self, shifted: Self::F) -> Self::F;
    /// First guess of 1/√a for a > 0: half of its exponent, negated, and a linear guess of the rest.
    fn rsqrt_guess(self, a: Self::F) -> Self::F;

    /// a + b · c, rounded twice.
    #[inline(always)]
    fn add_mul(self, a: Self::F, b: Self::F, c: Self::F) -> Self::F {
        self.add(a, self.mul(b, c))
    }

    /// 1/√a to 1e-6 relative, for a > 0: a guess, a step of Newton's form with constants that make the most of the
    /// guess (Kadlec, *Improving the fast inverse square root*, 2010), and a plain Newton step.
    #[inline(always)]
    fn rsqrt(self, a: Self::F) -> Self::F {
        // The guess is off by 3.5 % at most, the tuned step leaves 7e-4, and a Newton step squares that, times 3/2.
        let y = self.rsqrt_guess(a);
        let y = self
            .mul(self.mul(y, self.splat(0.703_952_25)), self.sub(self.splat(2.389_244_6), self.mul(self.mul(a, y), y)));
        let half = self.mul(a, self.splat(0.5));
        self.mul(y, self.sub(self.splat(1.5), self.mul(self.mul(half, y), y)))
    }
}

/// The operations of a level, on sixteen numbers.
pub trait Simd: Math {
    /// [`Places`] in registers.
    type At: Copy;

    /// Whether the registers hold the numbers of a kernel for two vectors at a time ([`Pair`]).
    const HAS_ROOM_FOR_PAIRS: bool = true;

    /// Runs a part of a kernel as a function that is not inlined, with the instructions of the level. All else that a
    /// kernel calls is inlined, and the compiler takes minutes for functions of a hundred thousand instructions. The
    /// closure must be `#[inline(always)]`.
    fn outlined<T>(self, part: impl FnOnce() -> T) -> T;
    /// Loads from memory.
    fn load(self, from: &[f32; LANES]) -> Self::F;
    /// Stores to memory.
    fn store(self, x: Self::F, to: &mut [f32; LANES]);
    /// Loads sixteen neighbouring numbers of each of four consecutive rows. Panics where they are not all there.
    #[inline(always)]
    fn load_rows(self, rows: &Rows, first: usize) -> [Self::F; 4] {
        assert!(first < rows.n_places, "there are not four rows of sixteen");
        let Rows { numbers, stride, .. } = *rows;
        // SAFETY: `Rows::new` has counted the places from which on all of them are there.
        unsafe {
            let row = numbers.as_ptr().add(first);
            [
                self.load(&*row.cast()),
                self.load(&*row.add(stride).cast()),
                self.load(&*row.add(2 * stride).cast()),
                self.load(&*row.add(3 * stride).cast()),
            ]
        }
    }
    /// Mask as bits: lane `i` as bit `i`.
    fn bits(self, m: Self::M) -> u16;
    /// `row[index]` for each lane, indices taken modulo 16.
    fn take(self, row: &[f32; LANES], index: &Lanes<u32>) -> Self::F;
    /// Loads places; they must be [`Nearness::Near`] for [`Simd::gather`], or [`Nearness::Far`] for [`Simd::gather_far`].
    fn at(self, places: &Places) -> Self::At;
    /// `row[t + index]` for each of `N` taps t and each lane, where places are [`Nearness::Near`]; other places give other
    /// numbers of the row. Panics where the row has less than [`NEAR_ROOM`]` + N − 1` numbers.
    fn gather<const N: usize>(self, row: &[f32], at: Self::At) -> [Self::F; N];
    /// Like [`Simd::gather`], where places are [`Nearness::Far`]. Panics where the row has less than
    /// [`FAR_ROOM`]` + N − 1` numbers.
    fn gather_far<const N: usize>(self, row: &[f32], at: Self::At) -> [Self::F; N];
    /// Transposes quads (four neighbouring lanes) of four rows: quad q of row r becomes quad r of row q.
    fn transpose_quads(self, rows: [Self::F; 4]) -> [Self::F; 4];
    /// Interleaves quads: the first of a, the first of b, the second of a, and so on.
    fn interleave_quads(self, a: Self::F, b: Self::F) -> [Self::F; 2];
    /// Undoes [`Simd::interleave_quads`]: the first and third quads of both, then the second and fourth.
    fn deinterleave_quads(self, a: Self::F, b: Self::F) -> [Self::F; 2];
    /// The second and the third quad of both.
    fn middle_quads(self, a: Self::F, b: Self::F) -> Self::F;
    /// Transposes sixteen rows: rows become columns.
    fn transpose(self, rows: &mut [Lanes; LANES]);
}

/// One or two vectors of sixteen. Two take little more time than one: while one waits for its results, the other
/// computes.
pub trait Wide: Math {
    /// Operations on one vector.
    type One: Simd;
    /// Number of vectors: 1 or 2.
    const N: usize;
    /// Operations on one vector.
    fn one(self) -> Self::One;
    /// Joins vectors; the second is ignored where `N` is 1.
    fn join(self, a: <Self::One as Math>::F, b: <Self::One as Math>::F) -> Self::F;
    /// Splits into vectors; the second repeats the first where `N` is 1.
    fn part(self, x: Self::F) -> [<Self::One as Math>::F; 2];
    /// [`Simd::bits`] of each vector; the second repeats the first where `N` is 1.
    fn all_bits(self, m: Self::M) -> [u16; 2];

    /// Loads from two places in memory.
    #[inline(always)]
    fn load_from(self, from: &[Lanes], places: [usize; 2]) -> Self::F {
        let first = self.one().load(&from[places[0]].0);
        self.join(first, if Self::N == 2 { self.one().load(&from[places[1]].0) } else { first })
    }

    /// Stores to two places in memory.
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

/// Prefetches memory that is read soon. Does nothing on processors other than x86-64.
#[inline(always)]
pub fn prefetch<T>(soon: &[T]) {
    #[cfg(target_arch = "x86_64")]
    for byte in (0..size_of_val(soon)).step_by(LINE_BYTES) {
        // SAFETY: an address inside the slice; and nothing is read that a program could see.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(soon.as_ptr().cast::<i8>().add(byte)) }
    }
    #[cfg(not(target_arch = "x86_64"))]
    let _ = soon;
}

/// 1.5 · 2^23: numbers near it are 1 apart, so adding it rounds to an integer, which then stands in the low bits;
/// subtracting it again is exact.
pub const ROUND: f32 = 12_582_912.0;

/// Constant of the first guess of 1/√a: this less half the bits of a (Kadlec 2010).
const RSQRT_MAGIC: u32 = 0x5f1f_fff9;

/// A piece of work over the operations of a level.
pub trait VectorKernel {
    /// Result of the kernel.
    type Output;
    /// Runs the kernel. Must be `#[inline(always)]`, and so must all that it calls, else it is compiled for the
    /// baseline.
    fn run<S: Simd>(self, s: S) -> Self::Output;
}

/// Instruction set of kernels. A value is proof that the machine has it: they are only made by [`Level::all`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Level(Width);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Width {
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64", target_feature = "simd128")))]
    Plain,
    #[cfg(target_arch = "x86_64")]
    Sse2,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
    #[cfg(target_arch = "aarch64")]
    Neon,
    #[cfg(target_feature = "simd128")]
    Simd128,
}

/// The level that [`Level::best`] returns, once it is decided.
static CHOSEN: OnceLock<Level> = OnceLock::new();

impl Level {
    /// The level that every processor of this architecture has.
    #[cfg(target_arch = "x86_64")]
    const NARROWEST: Self = Self(Width::Sse2);
    #[cfg(target_arch = "aarch64")]
    const NARROWEST: Self = Self(Width::Neon);
    #[cfg(target_feature = "simd128")]
    const NARROWEST: Self = Self(Width::Simd128);
    #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64", target_feature = "simd128")))]
    const NARROWEST: Self = Self(Width::Plain);

    /// All levels that this machine has, the widest last.
    pub fn all() -> Vec<Self> {
        #[allow(unused_mut, reason = "other processors have but one")]
        let mut levels = vec![Self::NARROWEST];
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx2") {
                levels.push(Self(Width::Avx2));
            }
            if has_avx512() {
                levels.push(Self(Width::Avx512));
            }
        }
        levels
    }

    /// The widest level that this machine has, unless [`Level::choose`] has chosen another.
    pub fn best() -> Self {
        *CHOSEN.get_or_init(|| *Self::all().last().unwrap_or(&Self::NARROWEST))
    }

    /// Makes [`Level::best`] return the level of a name from now on. Call it before anything is drawn.
    ///
    /// # Errors
    ///
    /// A message with the names that there are, if this machine has no such level, or with the level in use, if that is
    /// another.
    pub fn choose(name: &str) -> Result<Self, String> {
        let levels = Self::all();
        let Some(level) = levels.iter().copied().find(|level| level.name() == name) else {
            let names: Vec<&str> = levels.iter().map(|level| level.name()).collect();
            return Err(format!("this machine has no vectors {name:?}; it has {}", names.join(", ")));
        };
        let chosen = *CHOSEN.get_or_init(|| level);
        if chosen == level { Ok(level) } else { Err(format!("vectors {:?} are in use already", chosen.name())) }
    }

    /// Name of the level, for reports.
    pub fn name(self) -> &'static str {
        match self.0 {
            #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64", target_feature = "simd128")))]
            Width::Plain => "plain",
            #[cfg(target_arch = "x86_64")]
            Width::Sse2 => "sse2",
            #[cfg(target_arch = "x86_64")]
            Width::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Width::Avx512 => "avx512",
            #[cfg(target_arch = "aarch64")]
            Width::Neon => "neon",
            #[cfg(target_feature = "simd128")]
            Width::Simd128 => "simd128",
        }
    }

    /// Runs a kernel with the vectors of the level.
    #[inline]
    pub fn dispatch<K: VectorKernel>(self, kernel: K) -> K::Output {
        match self.0 {
            #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64", target_feature = "simd128")))]
            Width::Plain => kernel.run(Plain),
            #[cfg(target_arch = "x86_64")]
            Width::Sse2 => kernel.run(x86::Sse2(())),
            // SAFETY: `self` exists, so `all` has found the instructions on this machine.
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
                avx512::run_avx512(
                    #[inline(always)]
                    || kernel.run(avx512::Avx512(())),
                )
            },
            #[cfg(target_arch = "aarch64")]
            Width::Neon => kernel.run(neon::Neon(())),
            #[cfg(target_feature = "simd128")]
            Width::Simd128 => kernel.run(simd128::Simd128(())),
        }
    }

    /// Runs plain loops, which the compiler turns into vectors of the level. The closure, and what it calls, must be
    /// `#[inline(always)]`.
    #[inline]
    pub fn run<T>(self, kernel: impl FnOnce() -> T) -> T {
        match self.0 {
            #[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64", target_feature = "simd128")))]
            Width::Plain => kernel(),
            #[cfg(target_arch = "x86_64")]
            Width::Sse2 => kernel(),
            // SAFETY: `self` exists, so `all` has found the instructions on this machine.
            #[cfg(target_arch = "x86_64")]
            Width::Avx2 => unsafe { x86::run_avx2(kernel) },
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            Width::Avx512 => unsafe { avx512::run_avx512(kernel) },
            #[cfg(target_arch = "aarch64")]
            Width::Neon => kernel(),
            #[cfg(target_feature = "simd128")]
            Width::Simd128 => kernel(),
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

#[cfg(test)]
mod tests;
