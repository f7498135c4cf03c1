//! Levels of x86-64 whose vectors take several registers: SSE2 and AVX2.
#![allow(clippy::wildcard_imports, reason = "a hundred intrinsics, all by their own prefix")]

use std::arch::x86_64::*;

use super::{Entry, FAR_ROOM, LANES, Lanes, Math, NEAR_ROOM, Places, ROUND, RSQRT_MAGIC, Simd, plain};

/// SSE2 level, which every x86-64 has.
#[derive(Clone, Copy, Debug)]
pub struct Sse2(pub(super) ());
/// AVX2 level.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(pub(super) ());
#[target_feature(enable = "avx2")]
pub(super) fn run_avx2<T>(kernel: impl FnOnce() -> T) -> T {
    kernel()
}

#[target_feature(enable = "avx2")]
#[inline(never)]
fn outlined_avx2<T>(part: impl FnOnce() -> T) -> T {
    part()
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

/// Arithmetic, which SSE2 and AVX2 write alike, on `$n` registers.
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

/// Loads, stores and mask bits, which SSE2 and AVX2 write alike, on `$n` registers of `$w` numbers.
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

    /// Not inlined: every x86-64 has the instructions, and inlined into kernels they would be most of their code.
    #[inline(never)]
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
    type At = Lanes<u32>;

    /// A vector of sixteen numbers takes four of the sixteen registers, which leaves no room for pairs.
    const HAS_ROOM_FOR_PAIRS: bool = false;

    #[inline(never)]
    fn outlined<T>(self, part: impl FnOnce() -> T) -> T {
        part()
    }
    memory!(4, 4, _mm_loadu_ps _mm_storeu_ps _mm_movemask_ps);
    #[inline(never)]
    fn take(self, row: &[f32; LANES], index: &Lanes<u32>) -> Self::F {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = row[index.0[i] as usize % LANES];
        }
        self.load(&out)
    }
    #[inline(always)]
    fn at(self, places: &Places) -> Lanes<u32> {
        places.index
    }
    #[inline(never)]
    fn gather<const N: usize>(self, row: &[f32], at: Lanes<u32>) -> [Self::F; N] {
        let taken = plain::gather::<N>(row, &at, LANES, NEAR_ROOM);
        let mut out = [self.splat(0.0); N];
        for t in 0..N {
            out[t] = self.load(&taken[t]);
        }
        out
    }
    #[inline(never)]
    fn gather_far<const N: usize>(self, row: &[f32], at: Lanes<u32>) -> [Self::F; N] {
        let taken = plain::gather::<N>(row, &at, 2 * LANES, FAR_ROOM);
        let mut out = [self.splat(0.0); N];
        for t in 0..N {
            out[t] = self.load(&taken[t]);
        }
        out
    }
    per_register!();
    #[inline(never)]
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

/// Places of two times eight lanes: where each eight begin, and their indices from there.
#[derive(Clone, Copy)]
pub struct Halves {
    starts: [usize; 2],
    index: [__m256i; 2],
}

impl Simd for Avx2 {
    type At = Halves;

    #[inline(always)]
    fn outlined<T>(self, part: impl FnOnce() -> T) -> T {
        // SAFETY: `self` proves that the machine has the instructions.
        unsafe { outlined_avx2(part) }
    }
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
    fn at(self, places: &Places) -> Halves {
        let starts = places.starts;
        let index = map!(2, i => {
            let index = _mm256_loadu_si256(places.index.0.as_ptr().add(8 * i).cast());
            _mm256_sub_epi32(index, _mm256_set1_epi32(starts[i] as i32))
        });
        Halves { starts: starts.map(|start| start as usize), index }
    }
    #[inline(always)]
    fn gather<const N: usize>(self, row: &[f32], at: Halves) -> [Self::F; N] {
        assert!(NEAR_ROOM + N <= row.len() + 1, "the row ends before all that may be read");
        let mut out = [self.splat(0.0); N];
        for t in 0..N {
            // Eight numbers from below 16 + N on: less than the room.
            out[t] = map!(2, i => {
                let from = row.as_ptr().add(t + at.starts[i] % LANES);
                _mm256_permutevar8x32_ps(_mm256_loadu_ps(from), at.index[i])
            });
        }
        out
    }
    #[inline(always)]
    fn gather_far<const N: usize>(self, row: &[f32], at: Halves) -> [Self::F; N] {
        assert!(FAR_ROOM + N <= row.len() + 1, "the row ends before all that may be read");
        let mut out = [self.splat(0.0); N];
        for t in 0..N {
            // Sixteen numbers from below 32 + N on: less than the room.
            out[t] = map!(2, i => {
                let from = row.as_ptr().add(t + at.starts[i] % (2 * LANES));
                let low = _mm256_permutevar8x32_ps(_mm256_loadu_ps(from), at.index[i]);
                let high = _mm256_permutevar8x32_ps(_mm256_loadu_ps(from.add(8)), at.index[i]);
                // Bit 3 of the index, moved to the sign, chooses the eight.
                _mm256_blendv_ps(low, high, _mm256_castsi256_ps(_mm256_slli_epi32::<28>(at.index[i])))
            });
        }
        out
    }
    #[inline(always)]
    fn transpose_quads(self, [a, b, c, d]: [Self::F; 4]) -> [Self::F; 4] {
        let [low, high]: [[Self::F; 2]; 2] = map!(2, i => {
            // Quads of register i of each row.
            [
                [_mm256_permute2f128_ps::<0x20>(a[i], b[i]), _mm256_permute2f128_ps::<0x20>(c[i], d[i])],
                [_mm256_permute2f128_ps::<0x31>(a[i], b[i]), _mm256_permute2f128_ps::<0x31>(c[i], d[i])],
            ]
        });
        [low[0], low[1], high[0], high[1]]
    }
    #[inline(always)]
    fn interleave_quads(self, a: Self::F, b: Self::F) -> [Self::F; 2] {
        map!(2, i => [_mm256_permute2f128_ps::<0x20>(a[i], b[i]), _mm256_permute2f128_ps::<0x31>(a[i], b[i])])
    }
    #[inline(always)]
    fn deinterleave_quads(self, a: Self::F, b: Self::F) -> [Self::F; 2] {
        let firsts = map!(2, i => _mm256_permute2f128_ps::<0x20>([a, b][i][0], [a, b][i][1]));
        let seconds = map!(2, i => _mm256_permute2f128_ps::<0x31>([a, b][i][0], [a, b][i][1]));
        [firsts, seconds]
    }
    #[inline(always)]
    fn middle_quads(self, a: Self::F, b: Self::F) -> Self::F {
        map!(2, i => _mm256_permute2f128_ps::<0x21>([a, b][i][0], [a, b][i][1]))
    }
    #[inline(always)]
    fn transpose(self, rows: &mut [Lanes; LANES]) {
        let from = *rows;
        // Four blocks of eight by eight, each by pairs, fours, halves.
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
