//! Plain arrays: the level of processors without vectors here, and the reference for all other levels.

use super::{Entry, FAR_ROOM, LANES, Lanes, Math, NEAR_ROOM, Places, ROUND, RSQRT_MAGIC, Simd};

/// Sixteen numbers as an array.
#[derive(Clone, Copy, Debug)]
pub struct Plain;

type Sixteen = [f32; LANES];

#[inline(always)]
fn each(a: Sixteen, b: Sixteen, operation: impl Fn(f32, f32) -> f32) -> Sixteen {
    let mut out = [0.0; LANES];
    for i in 0..LANES {
        out[i] = operation(a[i], b[i]);
    }
    out
}

#[inline(always)]
fn truths(a: Sixteen, b: Sixteen, test: impl Fn(f32, f32) -> bool) -> u16 {
    let mut out = 0;
    for i in 0..LANES {
        out |= u16::from(test(a[i], b[i])) << i;
    }
    out
}

/// `row[t + index]`, indices taken modulo `n`, which is a power of two.
#[inline(always)]
pub(super) fn gather<const N: usize>(row: &[f32], index: &Lanes<u32>, n: usize, room: usize) -> [Sixteen; N] {
    assert!(room + N <= row.len() + 1, "the row ends before all that may be read");
    let mut out = [[0.0; LANES]; N];
    for t in 0..N {
        for i in 0..LANES {
            out[t][i] = row[t + index.0[i] as usize % n];
        }
    }
    out
}

impl Math for Plain {
    type F = Sixteen;
    type M = u16;

    #[inline(always)]
    fn splat(self, x: f32) -> Sixteen {
        [x; LANES]
    }
    #[inline(always)]
    fn add(self, a: Sixteen, b: Sixteen) -> Sixteen {
        each(a, b, |a, b| a + b)
    }
    #[inline(always)]
    fn sub(self, a: Sixteen, b: Sixteen) -> Sixteen {
        each(a, b, |a, b| a - b)
    }
    #[inline(always)]
    fn mul(self, a: Sixteen, b: Sixteen) -> Sixteen {
        each(a, b, |a, b| a * b)
    }
    #[inline(always)]
    fn div(self, a: Sixteen, b: Sixteen) -> Sixteen {
        each(a, b, |a, b| a / b)
    }
    #[inline(always)]
    fn min(self, a: Sixteen, b: Sixteen) -> Sixteen {
        each(a, b, |a, b| if a < b { a } else { b })
    }
    #[inline(always)]
    fn max(self, a: Sixteen, b: Sixteen) -> Sixteen {
        each(a, b, |a, b| if a > b { a } else { b })
    }
    #[inline(always)]
    fn abs(self, a: Sixteen) -> Sixteen {
        each(a, a, |a, _| a.abs())
    }
    #[inline(always)]
    fn lt(self, a: Sixteen, b: Sixteen) -> u16 {
        truths(a, b, |a, b| a < b)
    }
    #[inline(always)]
    fn le(self, a: Sixteen, b: Sixteen) -> u16 {
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
    fn select(self, m: u16, a: Sixteen, b: Sixteen) -> Sixteen {
        let mut out = b;
        for i in 0..LANES {
            out[i] = if m >> i & 1 == 1 { a[i] } else { b[i] };
        }
        out
    }
    #[inline(always)]
    fn look_up(self, table: &[Entry], position: Sixteen) -> [Sixteen; 4] {
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
    fn exp2_neg(self, shifted: Sixteen) -> Sixteen {
        // Numbers around 1.5 · 2^23 are 1 apart, so n is the distance of the bits from the bits of ROUND; subtracted
        // from the exponent of 1, it divides by 2^n.
        let bits = |x: f32| (127 << 23_u32) - (x.to_bits().wrapping_sub(ROUND.to_bits()) << 23);
        each(shifted, shifted, |x, _| f32::from_bits(bits(x)))
    }
    #[inline(always)]
    fn rsqrt_guess(self, a: Sixteen) -> Sixteen {
        each(a, a, |a, _| f32::from_bits(RSQRT_MAGIC.wrapping_sub(a.to_bits() >> 1)))
    }
}

impl Simd for Plain {
    type At = Lanes<u32>;

    #[inline(never)]
    fn outlined<T>(self, part: impl FnOnce() -> T) -> T {
        part()
    }
    #[inline(always)]
    fn load(self, from: &Sixteen) -> Sixteen {
        *from
    }
    #[inline(always)]
    fn store(self, x: Sixteen, to: &mut Sixteen) {
        *to = x;
    }
    #[inline(always)]
    fn bits(self, m: u16) -> u16 {
        m
    }
    #[inline(always)]
    fn take(self, row: &Sixteen, index: &Lanes<u32>) -> Sixteen {
        let mut out = [0.0; LANES];
        for i in 0..LANES {
            out[i] = row[index.0[i] as usize % LANES];
        }
        out
    }
    #[inline(always)]
    fn at(self, places: &Places) -> Lanes<u32> {
        places.index
    }
    #[inline(always)]
    fn gather<const N: usize>(self, row: &[f32], at: Lanes<u32>) -> [Sixteen; N] {
        gather(row, &at, LANES, NEAR_ROOM)
    }
    #[inline(always)]
    fn gather_far<const N: usize>(self, row: &[f32], at: Lanes<u32>) -> [Sixteen; N] {
        gather(row, &at, 2 * LANES, FAR_ROOM)
    }
    #[inline(always)]
    fn transpose_quads(self, rows: [Sixteen; 4]) -> [Sixteen; 4] {
        let mut columns = rows;
        for (r, row) in rows.iter().enumerate() {
            for (q, quad) in row.chunks_exact(4).enumerate() {
                columns[q][4 * r..][..4].copy_from_slice(quad);
            }
        }
        columns
    }
    #[inline(always)]
    fn interleave_quads(self, a: Sixteen, b: Sixteen) -> [Sixteen; 2] {
        let mut by_turns = [a, b];
        for (k, quad) in by_turns.as_flattened_mut().chunks_exact_mut(4).enumerate() {
            quad.copy_from_slice(&[a, b][k % 2][4 * (k / 2)..][..4]);
        }
        by_turns
    }
    #[inline(always)]
    fn deinterleave_quads(self, a: Sixteen, b: Sixteen) -> [Sixteen; 2] {
        let both = [a, b];
        let mut parts = both;
        for (k, quad) in both.as_flattened().chunks_exact(4).enumerate() {
            parts[k % 2][4 * (k / 2)..][..4].copy_from_slice(quad);
        }
        parts
    }
    #[inline(always)]
    fn middle_quads(self, a: Sixteen, b: Sixteen) -> Sixteen {
        let mut middles = a;
        middles[..LANES / 2].copy_from_slice(&a[LANES / 4..3 * LANES / 4]);
        middles[LANES / 2..].copy_from_slice(&b[LANES / 4..3 * LANES / 4]);
        middles
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
