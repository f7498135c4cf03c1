//! From combined slices to the texels of blocks, in two short passes: sample rows are upsampled along u, then blended
//! along v.
//!
//! Tiles are small, so loops are kept lean: the number of taps is a constant in each of them, weights and places stay
//! in registers, and a row is checked once.

use std::ops::Range;

use crate::kernel::footprint_table::{Footprint, Group, bits};
use crate::sheet::buffer::Sheet;
use crate::sheet::tile_layout::{BLOCK_V, Block, BlockMask, Chunk};
use wavesplat_compute::simd::{LANES, Lanes, Nearness, Simd, VectorKernel, Wide};

/// Kernel that makes the densities of all texels of blocks, and the least and largest of each of their columns.
pub(super) struct MakeDensities<'a> {
    pub sheet: &'a mut Sheet,
    pub blocks: BlockMask,
}

impl VectorKernel for MakeDensities<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Self { sheet, blocks } = self;
        for block in bits(blocks).map(Block::new) {
            let rows = reached_by(&sheet.v.value, block.rows());
            sheet.upsample_densities(s, block.strip, rows);
            let rows = &sheet.density_u[block.strip * sheet.n_v..];
            let texels = block_of(&mut sheet.texels, block);
            let [least, most] = blend_block(s, rows, &sheet.v.value, block.row, texels);
            let extremes = &mut sheet.extremes[block.place()];
            s.store(least, &mut extremes[0].0);
            s.store(most, &mut extremes[1].0);
        }
    }
}

/// Kernel that upsamples the sample rows of a block along u for gradients.
pub(super) struct UpsampleGradients<'a> {
    pub sheet: &'a mut Sheet,
    pub block: Block,
}

impl VectorKernel for UpsampleGradients<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Self { sheet, block } = self;
        let strip = block.strip;
        let (of_value, of_difference) = (sheet.u.value.group(strip), sheet.u.difference.group(strip));
        let first = strip * sheet.n_v;
        let n_v = sheet.n_v;
        let slices = |samples| SliceRows { samples, stride: sheet.stride };
        let rows = if sheet.is_smoothed() { &sheet.v.smooth } else { &sheet.v.value };
        let rows = sheet.gradient_rows[strip].missing(reached_by(rows, block.rows()));
        if sheet.is_smoothed() {
            let of_smooth = sheet.u.smooth.group(strip);
            for rows in rows {
                let out = [&mut sheet.along_u[first..][..n_v], &mut sheet.smooth_u[first..][..n_v]];
                upsample_twice(s, slices(&sheet.smooth), rows.clone(), [&of_difference, &of_smooth], out);
                upsample(s, slices(&sheet.through), rows, &of_smooth, &mut sheet.through_u[first..][..n_v]);
            }
            return;
        }
        for rows in rows {
            upsample(s, slices(&sheet.density), rows.clone(), &of_difference, &mut sheet.along_u[first..][..n_v]);
            upsample(s, slices(&sheet.through), rows, &of_value, &mut sheet.through_u[first..][..n_v]);
        }
        // The derivative along v reaches further than the density did.
        let rows = reached_by(&sheet.v.difference, block.rows());
        sheet.upsample_densities(s, strip, rows);
    }
}

impl Sheet {
    /// Upsamples the rows of a strip that are not upsampled yet.
    #[inline(always)]
    fn upsample_densities<S: Simd>(&mut self, s: S, strip: usize, rows: Range<usize>) {
        let out = &mut self.density_u[strip * self.n_v..][..self.n_v];
        let slices = SliceRows { samples: &self.density, stride: self.stride };
        for rows in self.density_rows[strip].missing(rows) {
            upsample(s, slices, rows, &self.u.value.group(strip), out);
        }
    }
}

/// Sample rows of a strip that are upsampled.
#[derive(Clone, Debug, Default)]
pub(super) struct DoneRows(Range<usize>);

impl DoneRows {
    /// Rows of a range that are not done yet, in up to two ranges; they count as done from now on. Where the range does
    /// not touch those that are done, these are forgotten: making a few rows again is cheaper than a list.
    #[inline(always)]
    pub(super) fn missing(&mut self, rows: Range<usize>) -> [Range<usize>; 2] {
        let done = &mut self.0;
        if rows.end < done.start || done.end < rows.start || done.start == done.end {
            *done = rows.clone();
            return [rows, 0..0];
        }
        let missing = [rows.start..done.start.max(rows.start), done.end.min(rows.end)..rows.end];
        *done = done.start.min(rows.start)..done.end.max(rows.end);
        missing
    }

    /// Forgets all rows.
    pub(super) fn clear(&mut self) {
        self.0 = 0..0;
    }
}

/// Rows of combined slices.
#[derive(Clone, Copy)]
pub(super) struct SliceRows<'a> {
    pub samples: &'a [f32],
    /// Numbers from a row to the next.
    pub stride: usize,
}

/// Upsamples rows of samples to a strip: `out[row] = Σ weight · sample`.
#[inline(always)]
pub(super) fn upsample<S: Simd>(s: S, from: SliceRows, rows: Range<usize>, group: &Group, out: &mut [Lanes]) {
    // The usual numbers of taps, unrolled.
    match (group.places.nearness(), group.weights.len()) {
        (Nearness::Near, 2) => upsample_near::<S, 2>(s, from, rows, group, out),
        (Nearness::Near, 4) => upsample_near::<S, 4>(s, from, rows, group, out),
        (Nearness::Near, 6) => upsample_near::<S, 6>(s, from, rows, group, out),
        _ => upsample_anywhere(s, from, rows, group, out),
    }
}

/// [`upsample`] where places are near, by `N` taps.
#[inline(always)]
fn upsample_near<S: Simd, const N: usize>(s: S, from: SliceRows, rows: Range<usize>, group: &Group, out: &mut [Lanes]) {
    let (weights, at) = (weights::<S, N>(s, group), s.at(group.places));
    let mut start = rows.start * from.stride + group.base;
    for out in &mut out[rows] {
        let samples = s.gather::<N>(&from.samples[start..], at);
        s.store(weighted(s, &weights, &samples), &mut out.0);
        start += from.stride;
    }
}

/// Upsamples rows of samples by two groups at the same places.
#[inline(always)]
fn upsample_twice<S: Simd>(s: S, from: SliceRows, rows: Range<usize>, groups: [&Group; 2], out: [&mut [Lanes]; 2]) {
    let [a, b] = out;
    if groups[0].places.nearness() == Nearness::Near && groups[0].weights.len() == 6 {
        let [of_a, of_b] = [weights::<S, 6>(s, groups[0]), weights::<S, 6>(s, groups[1])];
        let at = s.at(groups[0].places);
        let mut start = rows.start * from.stride + groups[0].base;
        for (a, b) in a[rows.clone()].iter_mut().zip(&mut b[rows]) {
            let samples = s.gather::<6>(&from.samples[start..], at);
            s.store(weighted(s, &of_a, &samples), &mut a.0);
            s.store(weighted(s, &of_b, &samples), &mut b.0);
            start += from.stride;
        }
        return;
    }
    upsample(s, from, rows.clone(), groups[0], a);
    upsample(s, from, rows, groups[1], b);
}

#[inline(always)]
fn weights<S: Simd, const N: usize>(s: S, group: &Group) -> [S::F; N] {
    let mut weights = [s.splat(0.0); N];
    for t in 0..N {
        weights[t] = s.load(&group.weights[t].0);
    }
    weights
}

/// Σ weight · sample, from the first tap on.
#[inline(always)]
fn weighted<S: Simd, const N: usize>(s: S, weights: &[S::F; N], samples: &[S::F; N]) -> S::F {
    let mut sum = s.mul(weights[0], samples[0]);
    for t in 1..N {
        sum = s.add_mul(sum, weights[t], samples[t]);
    }
    sum
}

/// [`upsample`] for any number of taps and any places.
#[inline(always)]
fn upsample_anywhere<S: Simd>(s: S, from: SliceRows, rows: Range<usize>, group: &Group, out: &mut [Lanes]) {
    let at = s.at(group.places);
    for row in rows {
        let samples = &from.samples[row * from.stride + group.base..];
        let mut sum = s.splat(0.0);
        for (t, weights) in group.weights.iter().enumerate() {
            let [taken] = match group.places.nearness() {
                Nearness::Near => s.gather::<1>(&samples[t..], at),
                Nearness::Far => s.gather_far::<1>(&samples[t..], at),
                Nearness::Any => {
                    let mut taken = [0.0; LANES];
                    for i in 0..LANES {
                        taken[i] = samples[t + group.places.index().0[i] as usize];
                    }
                    [s.load(&taken)]
                }
            };
            sum = s.add_mul(sum, s.load(&weights.0), taken);
        }
        s.store(sum, &mut out[row].0);
    }
}

/// Blends upsampled rows to the texels of a block whose first row is `row`; returns the least and the largest
/// of each column.
#[inline(always)]
pub(super) fn blend_block<S: Simd>(
    s: S,
    rows: &[Lanes],
    footprint: &Footprint,
    row: usize,
    texels: &mut [Lanes; BLOCK_V],
) -> [S::F; 2] {
    let group = footprint.group(row / LANES);
    match group.weights.len() {
        2 => blend_block_taps::<S, 2>(s, rows, &group, row % LANES, texels),
        4 => blend_block_taps::<S, 4>(s, rows, &group, row % LANES, texels),
        6 => blend_block_taps::<S, 6>(s, rows, &group, row % LANES, texels),
        _ => extremes_of(
            s,
            texels,
            #[inline(always)]
            |k| blend_row(s, rows, &group, row % LANES + k),
        ),
    }
}

/// [`blend_block`] by `N` taps.
#[inline(always)]
fn blend_block_taps<S: Simd, const N: usize>(
    s: S,
    rows: &[Lanes],
    group: &Group,
    lane: usize,
    texels: &mut [Lanes; BLOCK_V],
) -> [S::F; 2] {
    extremes_of(
        s,
        texels,
        #[inline(always)]
        |k| {
            let [texel] = blend_taps::<S, 1, N>(s, [rows], group, lane + k);
            texel
        },
    )
}

/// Writes the texels of a block, row by row; returns the least and the largest of each column.
#[inline(always)]
fn extremes_of<S: Simd>(s: S, texels: &mut [Lanes; BLOCK_V], texel: impl Fn(usize) -> S::F) -> [S::F; 2] {
    let (mut least, mut most) = (s.splat(f32::INFINITY), s.splat(f32::NEG_INFINITY));
    for k in 0..BLOCK_V {
        let texel = texel(k);
        s.store(texel, &mut texels[k].0);
        (least, most) = (s.min(texel, least), s.max(texel, most));
    }
    [least, most]
}

/// Blends `M` times the upsampled rows that reach one chunk or two of a block, all by one footprint.
#[inline(always)]
pub(super) fn blend<W: Wide, const M: usize>(
    w: W,
    rows: [&[Lanes]; M],
    footprint: &Footprint,
    chunks: [Chunk; 2],
) -> [W::F; M] {
    // The rows of a block are in one group.
    let group = footprint.group(chunks[0].row / LANES);
    // The usual numbers of taps, unrolled.
    match group.weights.len() {
        2 => blend_chunks::<W, M, 2>(w, rows, &group, chunks),
        4 => blend_chunks::<W, M, 4>(w, rows, &group, chunks),
        6 => blend_chunks::<W, M, 6>(w, rows, &group, chunks),
        _ => {
            let mut joined = [w.splat(0.0); M];
            for m in 0..M {
                let [first, second] = chunks.map(|chunk| chunk.row % LANES);
                joined[m] =
                    w.join(blend_row(w.one(), rows[m], &group, first), blend_row(w.one(), rows[m], &group, second));
            }
            joined
        }
    }
}

/// [`blend`] by `N` taps.
#[inline(always)]
fn blend_chunks<W: Wide, const M: usize, const N: usize>(
    w: W,
    rows: [&[Lanes]; M],
    group: &Group,
    chunks: [Chunk; 2],
) -> [W::F; M] {
    let first = blend_taps::<W::One, M, N>(w.one(), rows, group, chunks[0].row % LANES);
    let second =
        if W::N == 2 { blend_taps::<W::One, M, N>(w.one(), rows, group, chunks[1].row % LANES) } else { first };
    let mut joined = [w.splat(0.0); M];
    for m in 0..M {
        joined[m] = w.join(first[m], second[m]);
    }
    joined
}

/// Rows from the first on that reaches the row of texels at a lane of a group.
#[inline(always)]
fn rows_of<'a>(rows: &'a [Lanes], group: &Group, lane: usize) -> &'a [Lanes] {
    &rows[group.base + group.places.index().0[lane] as usize..]
}

/// Blends the upsampled rows that reach the row of texels at a lane of a group, by any number of taps.
#[inline(always)]
fn blend_row<S: Simd>(s: S, rows: &[Lanes], group: &Group, lane: usize) -> S::F {
    let mut sum = s.splat(0.0);
    for (samples, weights) in rows_of(rows, group, lane).iter().zip(group.weights) {
        sum = s.add_mul(sum, s.splat(weights.0[lane]), s.load(&samples.0));
    }
    sum
}

/// Blends `M` times the upsampled rows that reach the row of texels at a lane of a group, by `N` taps.
#[inline(always)]
fn blend_taps<S: Simd, const M: usize, const N: usize>(
    s: S,
    rows: [&[Lanes]; M],
    group: &Group,
    lane: usize,
) -> [S::F; M] {
    // From zero on, so that no texel is −0.
    let mut sums = [s.splat(0.0); M];
    let Some(weights) = group.weights.first_chunk::<N>() else { return sums };
    for m in 0..M {
        if let Some(rows) = rows_of(rows[m], group, lane).first_chunk::<N>() {
            for t in 0..N {
                sums[m] = s.add_mul(sums[m], s.splat(weights[t].0[lane]), s.load(&rows[t].0));
            }
        }
    }
    sums
}

/// The chunks of a block, among the chunks of a tile.
#[inline(always)]
pub(super) fn block_of(chunks: &mut [Lanes], block: Block) -> &mut [Lanes; BLOCK_V] {
    let (blocks, _) = chunks.as_chunks_mut::<BLOCK_V>();
    &mut blocks[block.place()]
}

/// Sample rows that the footprints of the texel rows reach.
#[inline(always)]
pub(super) fn reached_by(footprint: &Footprint, rows: Range<usize>) -> Range<usize> {
    // Positions rise or fall with the row, so that the first and the last row reach furthest.
    let (a, b) = (footprint.first(rows.start), footprint.first(rows.end - 1));
    a.min(b)..a.max(b) + footprint.n_taps
}

#[cfg(test)]
mod tests {
    use wavesplat_compute::simd::{Level, Places};

    use super::*;

    #[test]
    fn every_wanted_row_is_done_once_while_ranges_touch() {
        let mut done = DoneRows::default();
        let mut missing = |rows: Range<usize>| -> Vec<usize> { done.missing(rows).into_iter().flatten().collect() };
        assert_eq!(missing(4..8), [4, 5, 6, 7]);
        assert_eq!(missing(5..7), []);
        assert_eq!(missing(6..10), [8, 9]);
        assert_eq!(missing(2..12), [2, 3, 10, 11]);
        assert_eq!(missing(12..13), [12]);
        // Beyond a gap, what was done before is forgotten.
        assert_eq!(missing(20..22), [20, 21]);
        assert_eq!(missing(2..4), [2, 3]);
        assert_eq!(missing(3..3), []);
    }

    /// Upsamples by lean loops where `lean`, else one number at a time.
    struct Rows<'a> {
        group: Group<'a>,
        samples: &'a [f32],
        lean: bool,
    }

    impl VectorKernel for Rows<'_> {
        type Output = [[Lanes; 3]; 2];

        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> Self::Output {
            let Self { group, samples, lean } = self;
            let from = SliceRows { samples, stride: 80 };
            let mut out = [[Lanes::default(); 3]; 2];
            if lean {
                let [a, b] = &mut out;
                upsample(s, from, 0..3, &group, a);
                upsample_twice(s, from, 0..3, [&group, &group], [&mut [Lanes::default(); 3], b]);
                return out;
            }
            for (r, lanes) in out[0].iter_mut().enumerate() {
                for i in 0..LANES {
                    let first = r * 80 + group.base + group.places.index().0[i] as usize;
                    let terms = group.weights.iter().zip(&samples[first..]).map(|(weights, x)| weights.0[i] * x);
                    lanes.0[i] = terms.reduce(|sum, term| sum + term).unwrap_or_default();
                }
            }
            out[1] = out[0];
            out
        }
    }

    #[test]
    fn lean_loops_give_what_loops_over_numbers_give() {
        let samples: Vec<f32> = (0..240).map(|i| (i as f32 * 0.7).sin() + 2.0).collect();
        let weights: Vec<Lanes> =
            (0..6).map(|t| Lanes(std::array::from_fn(|i| 0.1 + ((t * 16 + i) as f32).cos()))).collect();
        for step in [-3.0_f32, -1.4, -0.6, 0.0, 0.4, 0.99, 1.3, 2.0, 3.0] {
            let lowest = (15.0 * step).min(0.0);
            let places = Places::new(Lanes(std::array::from_fn(|i| (step * i as f32 - lowest) as u32)));
            for n_taps in 1..=6 {
                let group = Group { base: 2, places: &places, weights: &weights[..n_taps] };
                for level in Level::all() {
                    let [lean, plain] =
                        [true, false].map(|lean| level.dispatch(Rows { group, samples: &samples, lean }));
                    assert_eq!(lean, plain, "{level:?}, {n_taps} taps, step {step}");
                }
            }
        }
    }
}
