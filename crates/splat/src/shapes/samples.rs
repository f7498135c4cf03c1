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
    let [low, high] = [mask & 0xFF, mask >> 8].map(usize::from);
    let n = mask.count_ones() as f32;
    [0, 1].map(|axis| (SUMS[0][low][axis] + SUMS[1][high][axis]) / n)
}

/// Sums of the offsets of the places in a set: of the first eight, and of the last eight. They are exact: offsets are
/// whole numbers of 1/32.
static SUMS: [[[f32; 2]; 256]; 2] = sums();

const fn sums() -> [[[f32; 2]; 256]; 2] {
    let mut sums = [[[0.0; 2]; 256]; 2];
    let (mut half, mut set) = (0, 0);
    while half < 2 {
        while set < 256 {
            let mut bit = 0;
            while bit < 8 {
                if set >> bit & 1 == 1 {
                    sums[half][set][0] += OFFSETS[0][8 * half + bit];
                    sums[half][set][1] += OFFSETS[1][8 * half + bit];
                }
                bit += 1;
            }
            set += 1;
        }
        (half, set) = (half + 1, 0);
    }
    sums
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
        for mask in [1 << 3, 0x8001, 0x0FF0, 0xBEEF, Mask::MAX] {
            let of = OFFSETS.map(|axis| (0..N).filter(|k| mask >> k & 1 == 1).map(|k| axis[k]).sum::<f32>());
            assert_eq!(mean_offset(mask), of.map(|sum| sum / mask.count_ones() as f32));
        }
    }
}
