//! Sparse subband: its retained coefficients in blocks of 8 x 8 x 8.
//!
//! A non-empty block has a significance map, one bit per coefficient and one word per slice, and its coefficients in
//! the order of the bits; an empty block is a single entry. So the memory is proportional to the number of kept
//! coefficients, and a slice of a band finds its coefficients by look-up.

use std::ops::Range;

use crate::transform::plan::TransformPlan;

/// Coefficients along each side of a block.
pub const BLOCK: usize = 8;

/// Entry of a block without coefficients.
pub const EMPTY: u32 = u32::MAX;

/// A subband of a transform.
#[derive(Clone, Debug)]
pub struct Subband {
    /// Level; the low-pass box of the coarsest level counts as one level more than the last details.
    pub level: usize,
    /// Number of the band, as in [`TransformPlan::subband`].
    pub number: usize,
    /// Ranges among the coefficients, along x, y, z.
    pub ranges: [Range<usize>; 3],
}

/// Retained coefficients of a subband.
#[derive(Clone, Debug)]
pub struct RetainedBand {
    pub subband: Subband,
    /// Position in `kept` of each block, `[z][y][x]`, or [`EMPTY`].
    pub blocks: Vec<u32>,
    pub kept: Vec<RetainedBlock>,
    pub values: Vec<f32>,
}

/// Retained coefficients of a block.
#[derive(Clone, Debug)]
pub struct RetainedBlock {
    /// Significance map: a word per slice, with a bit per coefficient, x first.
    pub masks: [u64; BLOCK],
    /// Index of the block's first value in [`RetainedBand::values`].
    pub start: usize,
}

/// Non-empty subbands: 1 to 7 of each level, the finest first, then the low-pass box of the last level.
pub fn subbands(plan: &TransformPlan) -> Vec<Subband> {
    let details = |level| (1..8).map(move |number| Subband { level, number, ranges: plan.subband(level, number) });
    let coarsest = plan.n_levels();
    let low = Subband { level: coarsest, number: 0, ranges: plan.low_size(coarsest).map(|n| 0..n) };
    let all = (0..coarsest).flat_map(details).chain([low]);
    all.filter(|subband| subband.ranges.iter().all(|range| !range.is_empty())).collect()
}

/// Ranges of the blocks along an axis.
fn block_ranges(range: &Range<usize>) -> impl Iterator<Item = Range<usize>> + Clone {
    let Range { start, end } = *range;
    (start..end).step_by(BLOCK).map(move |first| first..(first + BLOCK).min(end))
}

/// Ranges of the blocks of a band, `[z][y][x]`.
pub fn blocks_of([xs, ys, zs]: &[Range<usize>; 3]) -> impl Iterator<Item = [Range<usize>; 3]> {
    let (xs, ys) = (block_ranges(xs), block_ranges(ys));
    block_ranges(zs).flat_map(move |z| {
        let xs = xs.clone();
        ys.clone().flat_map(move |y| {
            let z = z.clone();
            xs.clone().map(move |x| [x, y.clone(), z.clone()])
        })
    })
}

impl RetainedBand {
    /// Keeps all coefficients of a subband that are not 0. The size is the volume's.
    pub fn new(subband: Subband, coefficients: &[f32], [nx, ny, _]: [usize; 3]) -> Self {
        let mut band = Self { subband, blocks: Vec::new(), kept: Vec::new(), values: Vec::new() };
        for [xs, ys, zs] in blocks_of(&band.subband.ranges) {
            let mut block = RetainedBlock { masks: [0; BLOCK], start: band.values.len() };
            for (k, z) in zs.enumerate() {
                for (j, y) in ys.clone().enumerate() {
                    let row = &coefficients[(z * ny + y) * nx..][xs.clone()];
                    for (i, c) in row.iter().enumerate().filter(|(_, c)| **c != 0.0) {
                        block.masks[k] |= 1 << (j * BLOCK + i);
                        band.values.push(*c);
                    }
                }
            }
            let is_empty = band.values.len() == block.start;
            band.blocks.push(if is_empty { EMPTY } else { band.kept.len() as u32 });
            if !is_empty {
                band.kept.push(block);
            }
        }
        band.values.shrink_to_fit();
        band.kept.shrink_to_fit();
        band
    }

    /// Calls `found` with position and value of every kept coefficient in `ranges`. The ranges count from the subband's
    /// first coefficient, positions from the first of the ranges.
    #[inline(always)]
    pub fn for_each(&self, ranges: &[Range<usize>; 3], mut found: impl FnMut([usize; 3], f32)) {
        let n_blocks = [0, 1, 2].map(|a| self.subband.ranges[a].len().div_ceil(BLOCK));
        let blocks = [0, 1, 2].map(|a| ranges[a].start / BLOCK..ranges[a].end.div_ceil(BLOCK));
        // Part of a block in the ranges along an axis, counted from the block's first coefficient.
        let inside = |a: usize, block: usize| {
            let first = block * BLOCK;
            ranges[a].start.saturating_sub(first)..(ranges[a].end - first).min(BLOCK)
        };
        for bz in blocks[2].clone() {
            for by in blocks[1].clone() {
                for bx in blocks[0].clone() {
                    let block_idx = (bz * n_blocks[1] + by) * n_blocks[0] + bx;
                    let Some(block) = self.kept.get(self.blocks[block_idx] as usize) else { continue };
                    let [xs, ys] = [inside(0, bx), inside(1, by)];
                    // Masks of the wanted columns and rows: bit `x + 8 y` is coefficient (x, y) of a slice, and the
                    // product repeats the byte of one row in all eight.
                    let columns = (0xff << xs.start & 0xff >> (BLOCK - xs.end)) * 0x0101_0101_0101_0101_u64;
                    let rows = u64::MAX << (BLOCK * ys.start) & u64::MAX >> (BLOCK * (BLOCK - ys.end));
                    let zs = inside(2, bz);
                    let before: u32 = block.masks[..zs.start].iter().map(|mask| mask.count_ones()).sum();
                    let mut start = block.start + before as usize;
                    for z in zs {
                        let mask = block.masks[z];
                        let mut wanted = mask & columns & rows;
                        while wanted != 0 {
                            let bit = wanted.trailing_zeros() as usize;
                            wanted &= wanted - 1;
                            // Values are in the order of the bits, so the number of lower bits is the index in the
                            // slice.
                            let rank = (mask & ((1 << bit) - 1)).count_ones() as usize;
                            let (x, y) = (bx * BLOCK + bit % BLOCK, by * BLOCK + bit / BLOCK);
                            let at = [x - ranges[0].start, y - ranges[1].start, bz * BLOCK + z - ranges[2].start];
                            found(at, self.values[start + rank]);
                        }
                        start += mask.count_ones() as usize;
                    }
                }
            }
        }
    }

    /// Bytes held.
    pub fn n_bytes(&self) -> usize {
        size_of::<Self>()
            + self.blocks.len() * size_of::<u32>()
            + self.kept.len() * size_of::<RetainedBlock>()
            + self.values.len() * size_of::<f32>()
    }

    /// Writes the coefficients, times `weight`, into the array of all coefficients. The size is the volume's.
    pub fn unpack(&self, weight: f32, coefficients: &mut [f32], [nx, ny, _]: [usize; 3]) {
        for ([xs, ys, zs], kept_idx) in blocks_of(&self.subband.ranges).zip(&self.blocks) {
            let Some(block) = self.kept.get(*kept_idx as usize) else { continue };
            let mut values = self.values[block.start..].iter();
            for (z, mut mask) in zs.zip(block.masks) {
                while mask != 0 {
                    let bit = mask.trailing_zeros() as usize;
                    mask &= mask - 1;
                    if let Some(value) = values.next() {
                        let (x, y) = (xs.start + bit % BLOCK, ys.start + bit / BLOCK);
                        coefficients[(z * ny + y) * nx + x] = weight * value;
                    }
                }
            }
        }
    }
}
