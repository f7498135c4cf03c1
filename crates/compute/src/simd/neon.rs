//! NEON, which every 64-bit ARM has: four registers of four numbers.
//!
//! NEON's own minimum, maximum and reciprocal square root differ from the other levels' (NaN wins, the estimate
//! has bits of its own), so comparisons with selections, and the guess that all levels share, replace them. A product
//! and a sum stay two instructions: nothing here asks for the fused one, and the compiler fuses nothing by itself.
#![allow(clippy::wildcard_imports, reason = "dozens of intrinsics, all by their own prefix")]

use std::arch::aarch64::*;

use super::{Entry, FAR_ROOM, LANES, Lanes, Math, NEAR_ROOM, Places, ROUND, RSQRT_MAGIC, Simd};

/// NEON level.
#[derive(Clone, Copy, Debug)]
pub struct Neon(pub(super) ());

/// Applies intrinsics to each register, spelled out as on x86-64. SAFETY of all uses: every 64-bit ARM that Rust has a
/// standard library for has NEON; loads and stores stay inside the arrays that they are given.
macro_rules! map {
    ($i:ident => $body:expr) => {
        map!(@ $i $body, 0 1 2 3)
    };
    (@ $i:ident $body:expr, $($k:literal)*) => {
        // SAFETY: see the macro.
        unsafe { [$({ let $i: usize = $k; $body }),*] }
    };
}

/// Transposes four rows of four: pairs, then halves.
macro_rules! transposed {
    ($a:expr, $b:expr, $c:expr, $d:expr) => {{
        let (a, b, c, d) = ($a, $b, $c, $d);
        let even = [vreinterpretq_f64_f32(vtrn1q_f32(a, b)), vreinterpretq_f64_f32(vtrn1q_f32(c, d))];
        let odd = [vreinterpretq_f64_f32(vtrn2q_f32(a, b)), vreinterpretq_f64_f32(vtrn2q_f32(c, d))];
        [
            vreinterpretq_f32_f64(vtrn1q_f64(even[0], even[1])),
            vreinterpretq_f32_f64(vtrn1q_f64(odd[0], odd[1])),
            vreinterpretq_f32_f64(vtrn2q_f64(even[0], even[1])),
            vreinterpretq_f32_f64(vtrn2q_f64(odd[0], odd[1])),
        ]
    }};
}

/// Sixteen numbers of a row by their indices, modulo sixteen. SAFETY: sixteen numbers must be there.
#[inline(always)]
unsafe fn permute(row: *const f32, index: [uint32x4_t; 4]) -> [float32x4_t; 4] {
    // The row as a table of 64 bytes: number k is bytes 4k to 4k + 3.
    let [a, b, c, d] = map!(i => vld1q_u8(row.add(4 * i).cast()));
    let bytes = uint8x16x4_t(a, b, c, d);
    map!(i => {
        let number = vandq_u32(index[i], vdupq_n_u32(LANES as u32 - 1));
        let places = vmlaq_u32(vdupq_n_u32(0x0302_0100), number, vdupq_n_u32(0x0404_0404));
        vreinterpretq_f32_u8(vqtbl4q_u8(bytes, vreinterpretq_u8_u32(places)))
    })
}

impl Math for Neon {
    type F = [float32x4_t; 4];
    type M = [uint32x4_t; 4];

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        map!(_i => vdupq_n_f32(x))
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => vaddq_f32(a[i], b[i]))
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => vsubq_f32(a[i], b[i]))
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => vmulq_f32(a[i], b[i]))
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => vdivq_f32(a[i], b[i]))
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => vbslq_f32(vcltq_f32(a[i], b[i]), a[i], b[i]))
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => vbslq_f32(vcgtq_f32(a[i], b[i]), a[i], b[i]))
    }
    #[inline(always)]
    fn abs(self, a: Self::F) -> Self::F {
        map!(i => vabsq_f32(a[i]))
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        map!(i => vcltq_f32(a[i], b[i]))
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> Self::M {
        map!(i => vcleq_f32(a[i], b[i]))
    }
    #[inline(always)]
    fn and(self, a: Self::M, b: Self::M) -> Self::M {
        map!(i => vandq_u32(a[i], b[i]))
    }
    #[inline(always)]
    fn or(self, a: Self::M, b: Self::M) -> Self::M {
        map!(i => vorrq_u32(a[i], b[i]))
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        map!(i => vbslq_f32(m[i], a[i], b[i]))
    }
    #[inline(always)]
    fn exp2_neg(self, shifted: Self::F) -> Self::F {
        map!(i => {
            let n = vsubq_u32(vreinterpretq_u32_f32(shifted[i]), vdupq_n_u32(ROUND.to_bits()));
            vreinterpretq_f32_u32(vsubq_u32(vdupq_n_u32(127 << 23), vshlq_n_u32::<23>(n)))
        })
    }
    #[inline(always)]
    fn rsqrt_guess(self, a: Self::F) -> Self::F {
        map!(i => {
            let half = vshrq_n_u32::<1>(vreinterpretq_u32_f32(a[i]));
            vreinterpretq_f32_u32(vsubq_u32(vdupq_n_u32(RSQRT_MAGIC), half))
        })
    }
    #[inline(always)]
    fn look_up(self, table: &[Entry], position: Self::F) -> [Self::F; 4] {
        assert!(table.len() >= 2);
        let held = self.min(self.max(position, self.splat(0.0)), self.splat((table.len() - 2) as f32));
        let parts: [[float32x4_t; 4]; 4] = map!(i => {
            let cells = vcvtq_s32_f32(held[i]);
            let t = vsubq_f32(held[i], vcvtq_f32_s32(cells));
            macro_rules! entry {
                ($k:literal) => {{
                    // `held` keeps the cell and the one after it inside the table.
                    let from = table.as_ptr().add(vgetq_lane_s32::<$k>(cells) as usize).cast::<f32>();
                    let (a, b) = (vld1q_f32(from), vld1q_f32(from.add(4)));
                    vaddq_f32(a, vmulq_laneq_f32::<$k>(vsubq_f32(b, a), t))
                }};
            }
            transposed!(entry!(0), entry!(1), entry!(2), entry!(3))
        });
        let [a, b, c, d] = parts;
        [[a[0], b[0], c[0], d[0]], [a[1], b[1], c[1], d[1]], [a[2], b[2], c[2], d[2]], [a[3], b[3], c[3], d[3]]]
    }
}

impl Simd for Neon {
    type At = [uint32x4_t; 4];

    #[inline(never)]
    fn outlined<T>(self, part: impl FnOnce() -> T) -> T {
        part()
    }
    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> Self::F {
        map!(i => vld1q_f32(from.as_ptr().add(4 * i)))
    }
    #[inline(always)]
    fn store(self, x: Self::F, to: &mut [f32; LANES]) {
        let to = to.as_mut_ptr();
        let _: [(); 4] = map!(i => vst1q_f32(to.add(4 * i), x[i]));
    }
    #[inline(always)]
    fn bits(self, m: Self::M) -> u16 {
        const WEIGHTS: [[u32; 4]; 4] =
            [[1, 2, 4, 8], [16, 32, 64, 128], [256, 512, 1024, 2048], [4096, 8192, 16384, 32768]];
        // Each true lane leaves a power of two of its own, so that the sum of all is the mask.
        let weighted = map!(i => vandq_u32(m[i], vld1q_u32(WEIGHTS[i].as_ptr())));
        // SAFETY: see `map`.
        let sum =
            unsafe { vaddvq_u32(vorrq_u32(vorrq_u32(weighted[0], weighted[1]), vorrq_u32(weighted[2], weighted[3]))) };
        sum as u16
    }
    #[inline(always)]
    fn take(self, row: &[f32; LANES], index: &Lanes<u32>) -> Self::F {
        let index = map!(i => vld1q_u32(index.0.as_ptr().add(4 * i)));
        // SAFETY: sixteen numbers are there.
        unsafe { permute(row.as_ptr(), index) }
    }
    #[inline(always)]
    fn at(self, places: &Places) -> [uint32x4_t; 4] {
        map!(i => vld1q_u32(places.index.0.as_ptr().add(4 * i)))
    }
    #[inline(always)]
    fn gather<const N: usize>(self, row: &[f32], at: [uint32x4_t; 4]) -> [Self::F; N] {
        assert!(NEAR_ROOM + N <= row.len() + 1, "the row ends before all that may be read");
        let mut out = [self.splat(0.0); N];
        for t in 0..N {
            // SAFETY: sixteen numbers from t on are there.
            out[t] = unsafe { permute(row.as_ptr().add(t), at) };
        }
        out
    }
    #[inline(always)]
    fn gather_far<const N: usize>(self, row: &[f32], at: [uint32x4_t; 4]) -> [Self::F; N] {
        assert!(FAR_ROOM + N <= row.len() + 1, "the row ends before all that may be read");
        let is_far = map!(i => vtstq_u32(at[i], vdupq_n_u32(LANES as u32)));
        let mut out = [self.splat(0.0); N];
        for t in 0..N {
            // SAFETY: thirty-two numbers from t on are there.
            let [near, far] = unsafe { [permute(row.as_ptr().add(t), at), permute(row.as_ptr().add(t + LANES), at)] };
            out[t] = self.select(is_far, far, near);
        }
        out
    }
    per_register!();
    #[inline(always)]
    fn transpose(self, rows: &mut [Lanes; LANES]) {
        let from = *rows;
        for r in (0..LANES).step_by(4) {
            for c in (0..LANES).step_by(4) {
                let block = map!(k => vld1q_f32(from[r + k].0.as_ptr().add(c)));
                // SAFETY: see `map`.
                let turned = unsafe { transposed!(block[0], block[1], block[2], block[3]) };
                let _: [(); 4] = map!(k => vst1q_f32(rows[c + k].0.as_mut_ptr().add(r), turned[k]));
            }
        }
    }
}
