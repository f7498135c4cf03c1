//! A volume as the wavelet coefficients that matter: those of large amplitude, and no others.
//!
//! Each subband is cut into blocks of 8 x 8 x 8. A block that keeps something has one bit per coefficient, a word per
//! slice, and its kept coefficients in the order of the bits; a block that keeps nothing is an empty entry. So the memory
//! is proportional to what is kept, and which coefficients a slice of a band has is a look-up.
//!
//! What is dropped: coefficients whose amplitude ([`Norm`]) is below a threshold. With [`Norm::L2`] that leaves, for an
//! orthogonal family, the least mean square error of all choices of as many; the others come near.

use std::ops::Range;
use std::sync::OnceLock;

use wavesplat_compute::{extent, parallel};

use crate::family::Family;
use crate::norm::{Norm, for_each_row, for_each_row_of_slice};
use crate::plan::{Plan, max_levels};
use crate::transform::{analyse, synthesise};

/// Sides of a block.
const BLOCK: usize = 8;

/// A block without coefficients.
const EMPTY: u32 = u32::MAX;

/// Steps of the search for a threshold: from 17 in the logarithm to a thousandth.
const N_HALVINGS: usize = 14;

/// Bits of half a number.
const HALF: u32 = 16;

/// Parts that all slices are looked through in, which may run at once.
const N_PARTS: usize = 16;

/// Which coefficients stay. Zeros are never stored.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Keep {
    /// Those whose amplitude is at least this, in the units of the samples; 0: all.
    Amplitude(f64),
    /// The largest amplitudes, this share of all coefficients, `0..=1`; equal ones stay together.
    Fraction(f64),
    /// As few as give the samples back with this PSNR, dB; its peak is the range of the samples.
    Psnr(f64),
}

/// A volume as retained wavelet coefficients.
#[derive(Clone, Debug)]
pub struct WaveletVolume {
    plan: Plan,
    threshold: f64,
    /// Subbands 1 to 7 of each level, the finest first, then the low box of the last level.
    bands: Vec<Band>,
    /// Smallest and largest sample, once they are known.
    range: OnceLock<[f32; 2]>,
}

/// A wavelet volume as plain arrays, to be stored: bands one after the other, the finest first, as [`WaveletVolume`] has
/// them.
#[derive(Clone, Debug, PartialEq)]
pub struct Parts {
    /// The family.
    pub family: Family,
    /// Samples along x, y, z.
    pub size: [usize; 3],
    /// Levels of details.
    pub n_levels: usize,
    /// The amplitude below which coefficients were dropped.
    pub threshold: f64,
    /// For each block of 8 x 8 x 8 coefficients whether it keeps any, 0 or 1.
    pub has_block: Vec<u8>,
    /// For each block that does eight words, one per slice: a bit per coefficient, x first.
    pub masks: Vec<u64>,
    /// The coefficients, in the order of the bits.
    pub values: Vec<f32>,
    /// Smallest and largest sample that they stand for, where that is known: else everything is decoded to find it.
    pub range: Option<[f32; 2]>,
}

/// Retained coefficients of a subband.
#[derive(Clone, Debug)]
struct Band {
    /// Its number, as in [`Plan::subband`].
    number: usize,
    /// Where it lies among the coefficients, along x, y, z.
    ranges: [Range<usize>; 3],
    /// Its level; the low box has that of the coarsest and one more.
    level: usize,
    /// Place in `kept` of each block, `[z][y][x]`, or [`EMPTY`].
    blocks: Vec<u32>,
    kept: Vec<Block>,
    values: Vec<f32>,
}

/// Coefficients of a block that are kept.
#[derive(Clone, Debug)]
struct Block {
    /// A bit per coefficient, x first; a word per slice.
    masks: [u64; BLOCK],
    /// Place of its first value.
    start: usize,
}

impl WaveletVolume {
    /// Analyses samples `[z][y][x]`, in place, and keeps what is asked for. `n_levels`: as many as there are where
    /// `None`. Takes no more memory than the samples and what is kept, but for [`Keep::Psnr`], which takes three times the
    /// samples.
    ///
    /// # Panics
    /// Where the samples are not as many as `size` (x, y, z) says, or none.
    pub fn new(
        family: Family,
        size: [usize; 3],
        samples: Vec<f32>,
        n_levels: Option<usize>,
        norm: Norm,
        keep: Keep,
    ) -> Self {
        let plan = Plan::new(family, size, n_levels);
        let wanted = if let Keep::Psnr(_) = keep { samples.clone() } else { Vec::new() };
        let mut coefficients = samples;
        analyse(&plan, &mut coefficients);
        let threshold = match keep {
            Keep::Amplitude(threshold) => threshold,
            Keep::Fraction(fraction) => threshold_of_fraction(&plan, norm, &coefficients, fraction),
            Keep::Psnr(psnr_db) => threshold_of_psnr(&plan, norm, &coefficients, &wanted, psnr_db),
        };
        drop(wanted);
        drop_below(&plan, norm, threshold, &mut coefficients);
        let places = places(&plan);
        let bands = parallel::map(places.len(), |b| Band::new(places[b].clone(), &coefficients, size));
        Self { plan, threshold, bands, range: OnceLock::new() }
    }

    /// The transform.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// The amplitude below which coefficients were dropped.
    pub fn threshold(&self) -> f64 {
        self.threshold
    }

    /// Smallest and largest sample that the coefficients stand for, found by `find` once.
    pub(crate) fn range(&self, find: impl FnOnce() -> [f32; 2]) -> [f32; 2] {
        *self.range.get_or_init(find)
    }

    /// Coefficients that are there.
    pub fn n_kept(&self) -> usize {
        self.bands.iter().map(|band| band.values.len()).sum()
    }

    /// Bytes held.
    pub fn n_bytes(&self) -> usize {
        let band = |band: &Band| {
            size_of::<Band>()
                + band.blocks.len() * size_of::<u32>()
                + band.kept.len() * size_of::<Block>()
                + band.values.len() * size_of::<f32>()
        };
        self.bands.iter().map(band).sum()
    }

    /// Coefficients that are kept of each level's details, the finest first, and of the last low box.
    pub fn n_kept_by_level(&self) -> Vec<usize> {
        let mut n = vec![0; self.plan.n_levels() + 1];
        for band in &self.bands {
            n[band.level] += band.values.len();
        }
        n
    }

    /// As plain arrays.
    pub fn to_parts(&self) -> Parts {
        let all = || self.bands.iter();
        Parts {
            family: self.plan.family(),
            size: self.plan.size(),
            n_levels: self.plan.n_levels(),
            threshold: self.threshold,
            has_block: all().flat_map(|band| &band.blocks).map(|place| u8::from(*place != EMPTY)).collect(),
            masks: all().flat_map(|band| &band.kept).flat_map(|block| block.masks).collect(),
            values: all().flat_map(|band| &band.values).copied().collect(),
            range: self.range.get().copied(),
        }
    }

    /// From plain arrays; says what does not fit together.
    pub fn from_parts(parts: Parts) -> Result<Self, &'static str> {
        let Parts { family, size, n_levels, threshold, has_block, masks, values, range } = parts;
        let n_samples = size.iter().try_fold(1_usize, |n, &m| n.checked_mul(m));
        let Some(n_samples) = n_samples.filter(|n| *n > 0) else { return Err("the size is not that of a volume") };
        // Before anything of that size is made: what is said of the size may be wrong.
        if n_samples.div_ceil(BLOCK * BLOCK * BLOCK) > has_block.len() {
            return Err("there are too few blocks");
        }
        if n_levels > max_levels(family, size) {
            return Err("there are more levels than the size has");
        }
        if !values.iter().all(|value| value.is_finite()) {
            return Err("a coefficient is not a finite number");
        }
        if range.is_some_and(|[lo, hi]| !(lo.is_finite() && lo <= hi && hi.is_finite())) {
            return Err("the smallest and the largest sample are no range");
        }
        let plan = Plan::new(family, size, Some(n_levels));
        let mut has_block = has_block.into_iter();
        let (masks, rest) = masks.as_chunks::<BLOCK>();
        let mut masks = masks.iter();
        let mut values = values.as_slice();
        let mut bands = Vec::new();
        for (level, number, ranges) in places(&plan) {
            let mut band = Band { number, ranges, level, blocks: Vec::new(), kept: Vec::new(), values: Vec::new() };
            let mut n_values = 0;
            for [xs, ys, zs] in blocks_of(&band.ranges) {
                if has_block.next().ok_or("there are too few blocks")? == 0 {
                    band.blocks.push(EMPTY);
                    continue;
                }
                let masks = *masks.next().ok_or("there are too few words of bits")?;
                let is_inside = |bit: usize| bit % BLOCK < xs.len() && bit / BLOCK < ys.len();
                let inside = (0..64).filter(|bit| is_inside(*bit)).fold(0, |all, bit| all | 1_u64 << bit);
                if masks.iter().enumerate().any(|(k, mask)| mask & !if k < zs.len() { inside } else { 0 } != 0) {
                    return Err("a bit lies outside its band");
                }
                band.blocks.push(band.kept.len() as u32);
                band.kept.push(Block { masks, start: n_values });
                n_values += masks.iter().map(|mask| mask.count_ones() as usize).sum::<usize>();
            }
            let (own, others) = values.split_at_checked(n_values).ok_or("there are too few coefficients")?;
            band.values = own.to_vec();
            values = others;
            bands.push(band);
        }
        if has_block.next().is_some() || masks.next().is_some() || !rest.is_empty() || !values.is_empty() {
            return Err("something is left over");
        }
        Ok(Self { plan, threshold, bands, range: range.map_or_else(OnceLock::new, OnceLock::from) })
    }

    /// All coefficients in the layout of the plan, zeros where nothing is kept. `weights`: a factor for each level's
    /// details, the finest first, and for the last low box; those beyond the slice are 1.
    pub fn coefficients(&self, weights: &[f32]) -> Vec<f32> {
        let mut coefficients = vec![0.0; self.plan.n_samples()];
        for band in &self.bands {
            let weight = weights.get(band.level).copied().unwrap_or(1.0);
            if weight != 0.0 {
                band.unpack(weight, &mut coefficients, self.plan.size());
            }
        }
        coefficients
    }

    /// Calls `found` with place and value of every kept detail of a subband of a level that lies in `ranges`. Both count
    /// from the first coefficient there: `ranges` from the band's, the place from that of `ranges`.
    #[inline(always)]
    pub(crate) fn for_each_kept(
        &self,
        level: usize,
        band: usize,
        ranges: &[Range<usize>; 3],
        found: impl FnMut([usize; 3], f32),
    ) {
        if let Some(band) = self.bands.iter().find(|b| b.level == level && b.number == band)
            && ranges.iter().all(|range| !range.is_empty())
        {
            band.for_each(ranges, found);
        }
    }

    /// Writes the last low box, times `weight`, `[z][y][x]`, at its own size.
    pub(crate) fn unpack_low(&self, weight: f32, low: &mut [f32]) {
        let coarsest = self.plan.n_levels();
        let [nx, ny, nz] = self.plan.low_size(coarsest);
        self.for_each_kept(coarsest, 0, &[0..nx, 0..ny, 0..nz], |[x, y, z], value| {
            low[(z * ny + y) * nx + x] = weight * value;
        });
    }

    /// The samples, `[z][y][x]`, that the coefficients stand for, weighted as in [`WaveletVolume::coefficients`].
    pub fn to_samples(&self, weights: &[f32]) -> Vec<f32> {
        let mut samples = self.coefficients(weights);
        synthesise(&self.plan, &mut samples);
        samples
    }
}

/// Level, number and place of a band.
type Place = (usize, usize, [Range<usize>; 3]);

/// All bands that are not empty.
fn places(plan: &Plan) -> Vec<Place> {
    let bands = |level| (1..8).map(move |band| (level, band, plan.subband(level, band)));
    let coarsest = plan.n_levels();
    let low = plan.low_size(coarsest).map(|n| 0..n);
    let all = (0..coarsest).flat_map(bands).chain([(coarsest, 0, low)]);
    all.filter(|(_, _, ranges)| ranges.iter().all(|range| !range.is_empty())).collect()
}

/// The first and the following positions of the blocks of a range.
fn cut(range: &Range<usize>) -> impl Iterator<Item = Range<usize>> + Clone {
    let Range { start, end } = *range;
    (start..end).step_by(BLOCK).map(move |first| first..(first + BLOCK).min(end))
}

/// The blocks of a band, `[z][y][x]`.
fn blocks_of([xs, ys, zs]: &[Range<usize>; 3]) -> impl Iterator<Item = [Range<usize>; 3]> {
    let (xs, ys) = (cut(xs), cut(ys));
    cut(zs).flat_map(move |z| {
        let xs = xs.clone();
        ys.clone().flat_map(move |y| {
            let z = z.clone();
            xs.clone().map(move |x| [x, y.clone(), z.clone()])
        })
    })
}

impl Band {
    fn new((level, number, ranges): Place, coefficients: &[f32], [nx, ny, _]: [usize; 3]) -> Self {
        let mut band = Self { number, ranges, level, blocks: Vec::new(), kept: Vec::new(), values: Vec::new() };
        for [xs, ys, zs] in blocks_of(&band.ranges) {
            let mut block = Block { masks: [0; BLOCK], start: band.values.len() };
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

    /// Calls `found` with place, counted from the first of `ranges`, and value of every coefficient there. `ranges` count
    /// from the band's first coefficient.
    #[inline(always)]
    fn for_each(&self, ranges: &[Range<usize>; 3], mut found: impl FnMut([usize; 3], f32)) {
        let n_blocks = [0, 1, 2].map(|a| self.ranges[a].len().div_ceil(BLOCK));
        let blocks = [0, 1, 2].map(|a| ranges[a].start / BLOCK..ranges[a].end.div_ceil(BLOCK));
        // The part of a block along an axis, in its own coordinates.
        let inside = |a: usize, block: usize| {
            let first = block * BLOCK;
            ranges[a].start.saturating_sub(first)..(ranges[a].end - first).min(BLOCK)
        };
        for bz in blocks[2].clone() {
            for by in blocks[1].clone() {
                for bx in blocks[0].clone() {
                    let place = (bz * n_blocks[1] + by) * n_blocks[0] + bx;
                    let Some(block) = self.kept.get(self.blocks[place] as usize) else { continue };
                    let [xs, ys] = [inside(0, bx), inside(1, by)];
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

    /// Writes the coefficients, times `weight`, to their places.
    fn unpack(&self, weight: f32, coefficients: &mut [f32], [nx, ny, _]: [usize; 3]) {
        for ([xs, ys, zs], place) in blocks_of(&self.ranges).zip(&self.blocks) {
            let Some(block) = self.kept.get(*place as usize) else { continue };
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

/// Zeros in place of coefficients whose amplitude is below a threshold.
fn drop_below(plan: &Plan, norm: Norm, threshold: f64, coefficients: &mut [f32]) {
    for_each_row(plan, norm, coefficients, |row, norms| {
        for (c, norm) in row.iter_mut().zip(norms.iter()) {
            if f64::from(amplitude(*c, norm)) < threshold {
                *c = 0.0;
            }
        }
    });
}

fn amplitude(coefficient: f32, norm: f64) -> f32 {
    (coefficient * norm as f32).abs()
}

/// What `add` gathers of the amplitudes, for each of some parts of the coefficients.
fn over_amplitudes<T: Send>(
    plan: &Plan,
    norm: Norm,
    coefficients: &[f32],
    zero: impl Fn() -> T + Sync + Send,
    add: impl Fn(&mut T, f32) + Sync + Send,
) -> Vec<T> {
    let [nx, ny, nz] = plan.size();
    // As many parts as pay.
    let n_parts = nz.min(N_PARTS);
    parallel::map(n_parts, |part| {
        let mut sum = zero();
        for z in part * nz / n_parts..(part + 1) * nz / n_parts {
            let slice = &coefficients[z * nx * ny..][..nx * ny];
            for_each_row_of_slice(plan, norm, z, |first, norms| {
                slice[first..].iter().zip(norms.iter()).for_each(|(c, norm)| add(&mut sum, amplitude(*c, norm)));
            });
        }
        sum
    })
}

/// The amplitude that this share of the coefficients reaches. Amplitudes stand in the order of their bits: counting gives
/// the upper half of them, and counting those with that half gives the lower.
fn threshold_of_fraction(plan: &Plan, norm: Norm, coefficients: &[f32], fraction: f64) -> f64 {
    let n_kept = (fraction * coefficients.len() as f64).round() as usize;
    if n_kept == 0 {
        return f64::INFINITY;
    }
    let mut left = n_kept.min(coefficients.len());
    let mut bits = 0;
    for shift in [HALF, 0] {
        let counts = over_amplitudes(
            plan,
            norm,
            coefficients,
            || vec![0_usize; 1 << HALF],
            |counts, amplitude| {
                let own = amplitude.to_bits();
                if shift == HALF || own >> HALF == bits >> HALF {
                    counts[(own >> shift) as usize & ((1 << HALF) - 1)] += 1;
                }
            },
        );
        for half in (0..1 << HALF).rev() {
            let n: usize = counts.iter().map(|counts| counts[half]).sum();
            if n >= left {
                bits |= (half as u32) << shift;
                break;
            }
            left -= n;
        }
    }
    f64::from(f32::from_bits(bits))
}

/// The largest amplitude, to a thousandth, that may be dropped for a PSNR.
fn threshold_of_psnr(plan: &Plan, norm: Norm, coefficients: &[f32], samples: &[f32], psnr_db: f64) -> f64 {
    let [lo, hi] = extent::of(samples);
    let wanted = f64::from(hi - lo).powi(2) * 10.0_f64.powf(-psnr_db / 10.0);
    let mut kept = coefficients.to_vec();
    let mut reaches = |threshold: f64| {
        kept.copy_from_slice(coefficients);
        drop_below(plan, norm, threshold, &mut kept);
        synthesise(plan, &mut kept);
        let square: f64 = kept.iter().zip(samples).map(|(a, b)| f64::from(a - b).powi(2)).sum();
        square <= wanted * samples.len() as f64
    };
    let largest = over_amplitudes(plan, norm, coefficients, || 0.0_f32, |all, a| *all = all.max(a));
    let largest = largest.into_iter().fold(0.0_f32, f32::max);
    // In the logarithm, since amplitudes span many orders.
    let (mut below, mut above) = (1e-7_f64.ln(), 2.0_f64.ln());
    let threshold = |t: f64| f64::from(largest) * t.exp();
    if !reaches(threshold(below)) {
        return 0.0;
    }
    for _ in 0..N_HALVINGS {
        let middle = 0.5 * (below + above);
        if reaches(threshold(middle)) {
            below = middle;
        } else {
            above = middle;
        }
    }
    threshold(below)
}
