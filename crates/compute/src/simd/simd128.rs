//! `simd128` of WebAssembly: four registers of four numbers. A module has these vectors or has not, when it is
//! compiled (`-C target-feature=+simd128`); there is nothing to detect.
//!
//! `f32x4.pmin` and `pmax` are comparisons with selections, as on x86-64, with their operands exchanged; minimum and
//! maximum of WebAssembly itself would let NaN win. The relaxed operations are not used: they may fuse.
#![allow(clippy::wildcard_imports, reason = "dozens of intrinsics, all by their own prefix")]

use std::arch::wasm32::*;

use super::{Entry, FAR_ROOM, LANES, Lanes, Math, NEAR_ROOM, Places, ROUND, RSQRT_MAGIC, Simd};

/// Level of `simd128`.
#[derive(Clone, Copy, Debug)]
pub struct Simd128(pub(super) ());

/// 2^23: a whole number from 0 to 2^23 − 1 that is added to it stands in its low bits.
const WHOLE: f32 = 8_388_608.0;

/// Applies intrinsics to each register, spelled out as on x86-64.
macro_rules! map {
    ($i:ident => $body:expr) => {
        map!(@ $i $body, 0 1 2 3)
    };
    (@ $i:ident $body:expr, $($k:literal)*) => {
        [$({ let $i: usize = $k; $body }),*]
    };
}

/// Transposes four rows of four: pairs, then halves.
macro_rules! transposed {
    ($a:expr, $b:expr, $c:expr, $d:expr) => {{
        let (a, b, c, d) = ($a, $b, $c, $d);
        let (ab, cd) = (i32x4_shuffle::<0, 4, 1, 5>(a, b), i32x4_shuffle::<0, 4, 1, 5>(c, d));
        let (ab_high, cd_high) = (i32x4_shuffle::<2, 6, 3, 7>(a, b), i32x4_shuffle::<2, 6, 3, 7>(c, d));
        [
            i64x2_shuffle::<0, 2>(ab, cd),
            i64x2_shuffle::<1, 3>(ab, cd),
            i64x2_shuffle::<0, 2>(ab_high, cd_high),
            i64x2_shuffle::<1, 3>(ab_high, cd_high),
        ]
    }};
}

/// Four numbers of the four times `N` from `from` on. `bytes` are their places in bytes. A place outside a register gives
/// 0 there, and so the registers are joined by *or*. SAFETY: all `4 N` numbers must be there.
#[inline(always)]
unsafe fn permute<const N: usize>(from: *const f32, bytes: v128) -> v128 {
    let mut taken = f32x4_splat(0.0);
    for k in 0..N {
        let (register, places) =
            // SAFETY: as above.
            (unsafe { v128_load(from.add(4 * k).cast()) }, i8x16_sub(bytes, i8x16_splat(16 * k as i8)));
        let part = i8x16_swizzle(register, places);
        taken = if k == 0 { part } else { v128_or(taken, part) };
    }
    taken
}

/// Places of numbers below 16, four of them, in bytes: number k is bytes 4k to 4k + 3.
#[inline(always)]
fn bytes_of(numbers: v128) -> v128 {
    i32x4_add(i32x4_mul(numbers, i32x4_splat(0x0404_0404)), i32x4_splat(0x0302_0100))
}

impl Math for Simd128 {
    type F = [v128; 4];
    type M = [v128; 4];

    #[inline(always)]
    fn splat(self, x: f32) -> Self::F {
        [f32x4_splat(x); 4]
    }
    #[inline(always)]
    fn add(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => f32x4_add(a[i], b[i]))
    }
    #[inline(always)]
    fn sub(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => f32x4_sub(a[i], b[i]))
    }
    #[inline(always)]
    fn mul(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => f32x4_mul(a[i], b[i]))
    }
    #[inline(always)]
    fn div(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => f32x4_div(a[i], b[i]))
    }
    #[inline(always)]
    fn min(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => f32x4_pmin(b[i], a[i]))
    }
    #[inline(always)]
    fn max(self, a: Self::F, b: Self::F) -> Self::F {
        map!(i => f32x4_pmax(b[i], a[i]))
    }
    #[inline(always)]
    fn abs(self, a: Self::F) -> Self::F {
        map!(i => f32x4_abs(a[i]))
    }
    #[inline(always)]
    fn lt(self, a: Self::F, b: Self::F) -> Self::M {
        map!(i => f32x4_lt(a[i], b[i]))
    }
    #[inline(always)]
    fn le(self, a: Self::F, b: Self::F) -> Self::M {
        map!(i => f32x4_le(a[i], b[i]))
    }
    #[inline(always)]
    fn and(self, a: Self::M, b: Self::M) -> Self::M {
        map!(i => v128_and(a[i], b[i]))
    }
    #[inline(always)]
    fn or(self, a: Self::M, b: Self::M) -> Self::M {
        map!(i => v128_or(a[i], b[i]))
    }
    #[inline(always)]
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F {
        map!(i => v128_bitselect(a[i], b[i], m[i]))
    }
    #[inline(always)]
    fn exp2_neg(self, shifted: Self::F) -> Self::F {
        map!(i => {
            let n = i32x4_sub(shifted[i], i32x4_splat(ROUND.to_bits() as i32));
            i32x4_sub(i32x4_splat(127 << 23), i32x4_shl(n, 23))
        })
    }
    #[inline(always)]
    fn rsqrt_guess(self, a: Self::F) -> Self::F {
        map!(i => i32x4_sub(i32x4_splat(RSQRT_MAGIC as i32), u32x4_shr(a[i], 1)))
    }
    #[inline(always)]
    fn look_up(self, table: &[Entry], position: Self::F) -> [Self::F; 4] {
        assert!((2..=WHOLE as usize).contains(&table.len()));
        let held = self.min(self.max(position, self.splat(0.0)), self.splat((table.len() - 2) as f32));
        let parts: [[v128; 4]; 4] = map!(i => {
            // Processors convert to whole numbers in several steps, since WebAssembly says what becomes of those that
            // are too large; rounding down is one.
            let whole = f32x4_floor(held[i]);
            let t = f32x4_sub(held[i], whole);
            let cells = v128_xor(f32x4_add(whole, f32x4_splat(WHOLE)), f32x4_splat(WHOLE));
            macro_rules! entry {
                ($k:literal) => {{
                    // SAFETY: `held` keeps the cell and the one after it inside the table.
                    let [a, b] = unsafe {
                        let from = table.as_ptr().add(i32x4_extract_lane::<$k>(cells) as usize);
                        [v128_load(from.cast()), v128_load(from.add(1).cast())]
                    };
                    f32x4_add(a, f32x4_mul(f32x4_sub(b, a), i32x4_shuffle::<$k, $k, $k, $k>(t, t)))
                }};
            }
            transposed!(entry!(0), entry!(1), entry!(2), entry!(3))
        });
        let [a, b, c, d] = parts;
        [[a[0], b[0], c[0], d[0]], [a[1], b[1], c[1], d[1]], [a[2], b[2], c[2], d[2]], [a[3], b[3], c[3], d[3]]]
    }
}

/// Places of two times eight lanes: where each eight begin, and the places of their numbers from there, in bytes.
#[derive(Clone, Copy)]
pub struct BytePlaces {
    starts: [usize; 2],
    bytes: [v128; 4],
}

impl Simd for Simd128 {
    type At = BytePlaces;

    /// The processors below have sixteen registers, as for SSE2.
    const HAS_ROOM_FOR_PAIRS: bool = false;

    #[inline(never)]
    fn outlined<T>(self, part: impl FnOnce() -> T) -> T {
        part()
    }
    #[inline(always)]
    fn load(self, from: &[f32; LANES]) -> Self::F {
        // SAFETY: sixteen numbers are there.
        map!(i => unsafe { v128_load(from.as_ptr().add(4 * i).cast()) })
    }
    #[inline(always)]
    fn store(self, x: Self::F, to: &mut [f32; LANES]) {
        let to = to.as_mut_ptr();
        // SAFETY: sixteen numbers are there.
        let _: [(); 4] = map!(i => unsafe { v128_store(to.add(4 * i).cast(), x[i]) });
    }
    #[inline(always)]
    fn bits(self, m: Self::M) -> u16 {
        let parts: [u16; 4] = map!(i => u16::from(i32x4_bitmask(m[i])) << (4 * i));
        parts.into_iter().fold(0, |all, part| all | part)
    }
    #[inline(always)]
    fn take(self, row: &[f32; LANES], index: &Lanes<u32>) -> Self::F {
        map!(i => {
            // SAFETY: sixteen numbers are there, and sixteen indices.
            unsafe {
                let index = v128_and(v128_load(index.0.as_ptr().add(4 * i).cast()), u32x4_splat(LANES as u32 - 1));
                permute::<4>(row.as_ptr(), bytes_of(index))
            }
        })
    }
    #[inline(always)]
    fn at(self, places: &Places) -> BytePlaces {
        let starts = places.starts;
        let bytes = map!(i => {
            // SAFETY: sixteen indices are there.
            let index = unsafe { v128_load(places.index.0.as_ptr().add(4 * i).cast()) };
            bytes_of(v128_and(u32x4_sub(index, u32x4_splat(starts[i / 2])), u32x4_splat(LANES as u32 - 1)))
        });
        BytePlaces { starts: starts.map(|start| start as usize), bytes }
    }
    #[inline(always)]
    fn gather<const N: usize>(self, row: &[f32], at: BytePlaces) -> [Self::F; N] {
        assert!(NEAR_ROOM + N <= row.len() + 1, "the row ends before all that may be read");
        let mut out = [self.splat(0.0); N];
        for t in 0..N {
            // SAFETY: eight numbers from below 16 + N on: less than the room.
            out[t] = map!(i => unsafe { permute::<2>(row.as_ptr().add(t + at.starts[i / 2] % LANES), at.bytes[i]) });
        }
        out
    }
    #[inline(always)]
    fn gather_far<const N: usize>(self, row: &[f32], at: BytePlaces) -> [Self::F; N] {
        assert!(FAR_ROOM + N <= row.len() + 1, "the row ends before all that may be read");
        let mut out = [self.splat(0.0); N];
        for t in 0..N {
            // SAFETY: sixteen numbers from below 32 + N on: less than the room.
            out[t] =
                map!(i => unsafe { permute::<4>(row.as_ptr().add(t + at.starts[i / 2] % (2 * LANES)), at.bytes[i]) });
        }
        out
    }
    per_register!();
    #[inline(always)]
    fn transpose(self, rows: &mut [Lanes; LANES]) {
        let from = *rows;
        for r in (0..LANES).step_by(4) {
            for c in (0..LANES).step_by(4) {
                // SAFETY: four numbers from a multiple of four on, below sixteen, are there.
                let block = map!(k => unsafe { v128_load(from[r + k].0.as_ptr().add(c).cast()) });
                let turned = transposed!(block[0], block[1], block[2], block[3]);
                // SAFETY: as above.
                let _: [(); 4] = map!(k => unsafe { v128_store(rows[c + k].0.as_mut_ptr().add(r).cast(), turned[k]) });
            }
        }
    }
}
