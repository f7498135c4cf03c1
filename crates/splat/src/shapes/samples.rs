//! Places within a texel at which shapes are looked for, and masks of them.
//!
//! The places are Hammersley's points: all have different x and different y, so that an edge along u or v, too, has
//! [`N`] steps from texel to texel.

/// Number of places in a texel.
pub const N: usize = 16;

/// Set of places, as bits.
pub type Mask = u16;

/// Offsets of the places from the middle of the texel, along u and along v.
pub const OFFSETS: [[f32; N]; 2] = offsets();

const fn offsets() -> [[f32; N]; 2] {
    let mut offsets = [[0.0; N]; 2];
    let mut k = 0;
    while k < N {
        // The number with its four bits in reverse order.
        let reversed = (k & 1) << 3 | (k & 2) << 1 | (k & 4) >> 1 | (k & 8) >> 3;
        offsets[0][k] = (k as f32 + 0.5) / N as f32 - 0.5;
        offsets[1][k] = (reversed as f32 + 0.5) / N as f32 - 0.5;
        k += 1;
    }
    offsets
}

/// The places at which a condition holds.
#[inline(always)]
pub fn mask_of(holds: [bool; N]) -> Mask {
    let mut mask = 0;
    for (k, holds) in holds.into_iter().enumerate() {
        mask |= Mask::from(holds) << k;
    }
    mask
}

/// Mean offset of the places of a mask that is not empty.
#[inline(always)]
pub fn mean_offset(mask: Mask) -> [f32; 2] {
    if mask == Mask::MAX {
        return [0.0; 2];
    }
    let mut sum = [0.0; 2];
    for k in 0..N {
        if mask >> k & 1 == 1 {
            sum = [sum[0] + OFFSETS[0][k], sum[1] + OFFSETS[1][k]];
        }
    }
    sum.map(|sum| sum / mask.count_ones() as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_differ_along_both_axes_and_have_the_middle_as_mean() {
        for axis in OFFSETS {
            let mut sorted = axis;
            sorted.sort_by(f32::total_cmp);
            for (k, place) in sorted.into_iter().enumerate() {
                assert!((place - ((k as f32 + 0.5) / 16.0 - 0.5)).abs() < 1e-7);
            }
            assert!(axis.iter().sum::<f32>().abs() < 1e-6);
        }
        assert!(mean_offset(1 << 3) == [OFFSETS[0][3], OFFSETS[1][3]]);
    }
}
