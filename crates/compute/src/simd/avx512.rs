//! The AVX-512 level of x86-64: one register holds a vector.
#![allow(clippy::wildcard_imports, reason = "dozens of intrinsics, all by their own prefix")]

use std::arch::x86_64::*;

use super::{Entry, FAR_ROOM, LANES, Lanes, Math, NEAR_ROOM, Places, ROUND, RSQRT_MAGIC, Simd};

/// AVX-512 level: F, BW, DQ and VL.
#[derive(Clone, Copy, Debug)]
pub struct Avx512(pub(super) ());

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2")]
pub(super) fn run_avx512<T>(kernel: impl FnOnce() -> T) -> T {
    kernel()
}

#[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl,avx2")]
#[inline(never)]
fn outlined_avx512<T>(part: impl FnOnce() -> T) -> T {
    part()
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
    type At = __m512i;

    #[inline(always)]
    fn outlined<T>(self, part: impl FnOnce() -> T) -> T {
        // SAFETY: `self` proves that the machine has the instructions.
        unsafe { outlined_avx512(part) }
    }
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
    fn at(self, places: &Places) -> __m512i {
        // SAFETY: sixteen numbers are there.
        unsafe { _mm512_loadu_si512(places.index.0.as_ptr().cast()) }
    }
    #[inline(always)]
    fn gather<const N: usize>(self, row: &[f32], at: __m512i) -> [__m512; N] {
        assert!(NEAR_ROOM + N <= row.len() + 1, "the row ends before all that may be read");
        let mut out = [self.splat(0.0); N];
        for t in 0..N {
            // SAFETY: sixteen numbers from t on are there; the permutation uses the low four bits of each index.
            out[t] = unsafe { _mm512_permutexvar_ps(at, _mm512_loadu_ps(row.as_ptr().add(t))) };
        }
        out
    }
    #[inline(always)]
    fn gather_far<const N: usize>(self, row: &[f32], at: __m512i) -> [__m512; N] {
        assert!(FAR_ROOM + N <= row.len() + 1, "the row ends before all that may be read");
        let mut out = [self.splat(0.0); N];
        for t in 0..N {
            // SAFETY: thirty-two numbers from t on are there; the permutation uses the low five bits of each index.
            out[t] = unsafe {
                let from = row.as_ptr().add(t);
                _mm512_permutex2var_ps(_mm512_loadu_ps(from), at, _mm512_loadu_ps(from.add(LANES)))
            };
        }
        out
    }
    #[inline(always)]
    fn transpose_quads(self, [a, b, c, d]: [__m512; 4]) -> [__m512; 4] {
        // SAFETY: see `splat`.
        unsafe {
            let (ab, cd) = (_mm512_shuffle_f32x4::<0x44>(a, b), _mm512_shuffle_f32x4::<0x44>(c, d));
            let (ab_high, cd_high) = (_mm512_shuffle_f32x4::<0xee>(a, b), _mm512_shuffle_f32x4::<0xee>(c, d));
            [
                _mm512_shuffle_f32x4::<0x88>(ab, cd),
                _mm512_shuffle_f32x4::<0xdd>(ab, cd),
                _mm512_shuffle_f32x4::<0x88>(ab_high, cd_high),
                _mm512_shuffle_f32x4::<0xdd>(ab_high, cd_high),
            ]
        }
    }
    #[inline(always)]
    fn interleave_quads(self, a: __m512, b: __m512) -> [__m512; 2] {
        // SAFETY: see `splat`. Numbers are taken by pairs: 0 to 7 are in a, 8 to 15 in b.
        unsafe {
            let (a, b) = (_mm512_castps_pd(a), _mm512_castps_pd(b));
            let low = _mm512_permutex2var_pd(a, _mm512_setr_epi64(0, 1, 8, 9, 2, 3, 10, 11), b);
            let high = _mm512_permutex2var_pd(a, _mm512_setr_epi64(4, 5, 12, 13, 6, 7, 14, 15), b);
            [_mm512_castpd_ps(low), _mm512_castpd_ps(high)]
        }
    }
    #[inline(always)]
    fn deinterleave_quads(self, a: __m512, b: __m512) -> [__m512; 2] {
        // SAFETY: see `splat`.
        unsafe { [_mm512_shuffle_f32x4::<0x88>(a, b), _mm512_shuffle_f32x4::<0xdd>(a, b)] }
    }
    #[inline(always)]
    fn middle_quads(self, a: __m512, b: __m512) -> __m512 {
        // SAFETY: see `splat`.
        unsafe { _mm512_shuffle_f32x4::<0x99>(a, b) }
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
