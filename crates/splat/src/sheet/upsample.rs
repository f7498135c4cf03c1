//! Upsampling of sample rows along u: the first of the two short passes that make a sheet.

use std::ops::Range;

use crate::kernel::footprint_table::{Footprint, Group, Span, bits};
use crate::sheet::buffer::Sheet;
use crate::sheet::tile_layout::{Block, BlockMask};
use wavesplat_compute::simd::{LANES, Simd, VectorKernel};

impl Sheet {
    /// Upsamples the rows of a block. `N_VECTORS`: vectors that hold the samples of a tap for a chunk, 1 or 2; 0 if
    /// more.
    #[inline(always)]
    fn upsample<S: Simd, const N_VECTORS: usize, const GRADIENT: bool>(&mut self, s: S, block: Block) {
        let strip = block.strip;
        let of_value = self.u.value.group(strip);
        let mut rows = reached_by(&self.v.value, block.rows());
        if GRADIENT && self.is_smoothed() {
            let (of_difference, of_smooth) = (self.u.difference.group(strip), self.u.smooth.group(strip));
            for r in reached_by(&self.v.smooth, block.rows()) {
                let place = strip * self.n_v + r;
                if !self.has_gradient_u[place] {
                    self.has_gradient_u[place] = true;
                    let samples = r * self.stride..(r + 1) * self.stride;
                    let smooth = &self.smooth[samples.clone()];
                    let along = upsample::<S, N_VECTORS>(s, smooth, &of_difference);
                    let across = upsample::<S, N_VECTORS>(s, smooth, &of_smooth);
                    let through = upsample::<S, N_VECTORS>(s, &self.through[samples], &of_smooth);
                    s.store(along, &mut self.along_u[place].0);
                    s.store(across, &mut self.smooth_u[place].0);
                    s.store(through, &mut self.through_u[place].0);
                }
            }
            return;
        }
        if GRADIENT {
            let of_difference = self.u.difference.group(strip);
            for r in rows {
                let place = strip * self.n_v + r;
                if !self.has_gradient_u[place] {
                    self.has_gradient_u[place] = true;
                    let samples = r * self.stride..(r + 1) * self.stride;
                    let along = upsample::<S, N_VECTORS>(s, &self.density[samples.clone()], &of_difference);
                    let through = upsample::<S, N_VECTORS>(s, &self.through[samples], &of_value);
                    s.store(along, &mut self.along_u[place].0);
                    s.store(through, &mut self.through_u[place].0);
                }
            }
            // The derivative along v reaches further than the density did.
            rows = reached_by(&self.v.difference, block.rows());
        }
        for r in rows {
            let place = strip * self.n_v + r;
            if !self.has_density_u[place] {
                self.has_density_u[place] = true;
                let samples = r * self.stride..(r + 1) * self.stride;
                let density = upsample::<S, N_VECTORS>(s, &self.density[samples], &of_value);
                s.store(density, &mut self.density_u[place].0);
            }
        }
    }
}

/// Kernel that upsamples the sample rows of blocks along u where that is not done yet: for densities or gradients.
pub struct Upsample<'a, const GRADIENT: bool> {
    pub sheet: &'a mut Sheet,
    pub blocks: BlockMask,
}

impl<const GRADIENT: bool> VectorKernel for Upsample<'_, GRADIENT> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Self { sheet, blocks } = self;
        for block in bits(blocks).map(Block::new) {
            let footprints = &sheet.u;
            let span = footprints.value.group(block.strip).span;
            let meets_same_regions = !GRADIENT || footprints.difference.group(block.strip).span == span;
            // One loop per span, so that no tap branches on it.
            match span {
                Span::One if meets_same_regions => sheet.upsample::<S, 1, GRADIENT>(s, block),
                Span::Two if meets_same_regions => sheet.upsample::<S, 2, GRADIENT>(s, block),
                _ => sheet.upsample::<S, 0, GRADIENT>(s, block),
            }
        }
    }
}

/// Upsamples a row of samples to a chunk of texels.
#[inline(always)]
pub(super) fn upsample<S: Simd, const N_VECTORS: usize>(s: S, samples: &[f32], group: &Group) -> S::F {
    let mut sum = s.splat(0.0);
    for (t, weights) in group.weights.iter().enumerate() {
        let samples = &samples[group.base + t..];
        let taken = match N_VECTORS {
            1 => take_near(s, samples, group),
            2 => take_near_or_far(s, samples, group),
            _ => take_one_by_one(s, samples, group),
        };
        sum = s.add_mul(sum, s.load(&weights.0), taken);
    }
    sum
}

/// Gathers `samples[index]` where all are in one vector. Rows are padded, so that two whole vectors can be read
/// anywhere.
#[inline(always)]
fn take_near<S: Simd>(s: S, samples: &[f32], group: &Group) -> S::F {
    s.take(samples.first_chunk().unwrap_or(&[0.0; LANES]), group.index)
}

/// Gathers `samples[index]` where all are in two vectors.
#[inline(always)]
fn take_near_or_far<S: Simd>(s: S, samples: &[f32], group: &Group) -> S::F {
    let (near, far) = samples.split_at(LANES.min(samples.len()));
    // `take` reads indices modulo the lanes, so that the same ones serve both vectors.
    let is_far = s.lt(s.splat(0.0), s.load(&group.far.0));
    s.select(is_far, take_near(s, far, group), take_near(s, near, group))
}

/// Gathers `samples[index]` wherever they are.
#[inline(always)]
fn take_one_by_one<S: Simd>(s: S, samples: &[f32], group: &Group) -> S::F {
    let mut out = [0.0; LANES];
    for i in 0..LANES {
        out[i] = samples[group.index.0[i] as usize];
    }
    s.load(&out)
}

/// Sample rows that the footprints of the texel rows reach.
#[inline(always)]
pub(super) fn reached_by(footprint: &Footprint, rows: Range<usize>) -> Range<usize> {
    // Positions rise or fall with the row, so that the first and the last row reach furthest.
    let (a, b) = (footprint.first(rows.start), footprint.first(rows.end - 1));
    a.min(b)..a.max(b) + footprint.n_taps
}
