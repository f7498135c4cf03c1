//! Survey of a volume that is not in memory, made by one pass over its samples, box by box, in any order.
//!
//! It holds their range, how many are not finite, bounds of bricks, and every n-th sample.
//!
//! With it, a frame is planned before a sample is read. Bounds and strided samples are sample values for the kernels
//! that use samples as they are; for volumes with holes, and for the B-spline kernels, they are of filled samples and
//! of coefficients, which a second pass computes once the range is known.

use std::ops::Range;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Grid, Kernel, Sample, Samples, Statistics, with_samples};

use crate::source::min_max_bricks::{Bricks, DensityRows, FloatRows, Reach, n_bricks, widen};
use crate::source::slices::{Slices, VolumeBox};
use crate::source::strided::StridedSamples;

/// Sides of a brick to choose from, in cells, from small to large.
const SIDES: [usize; 5] = [4, 8, 16, 32, 64];

/// Survey of the boxes of a volume that were added so far.
pub struct Survey {
    size: [usize; 3],
    kernel: Kernel,
    side: usize,
    statistics: Statistics,
    /// Least and largest value of every brick, `[z][y][x]`; infinite where no sample is finite.
    bounds: Vec<[f32; 2]>,
    strided: Vec<StridedSamples>,
}

impl Survey {
    /// Empty survey of a volume of `size` samples, for a kernel. Bricks are the smallest whose bounds fit in
    /// `bounds_bytes`, or the largest. `steps`: of strided samples, along x, y, z.
    pub fn new(size: [usize; 3], kernel: Kernel, bounds_bytes: usize, steps: &[[usize; 3]]) -> Self {
        let takes = |side: usize| n_bricks(side, size).iter().product::<usize>() * size_of::<[f32; 2]>();
        let side = SIDES.into_iter().find(|side| takes(*side) <= bounds_bytes).unwrap_or(SIDES[SIDES.len() - 1]);
        Self {
            size,
            kernel,
            side,
            statistics: Statistics { min: f64::INFINITY, max: f64::NEG_INFINITY, n_nonfinite: 0 },
            bounds: vec![[f32::INFINITY, f32::NEG_INFINITY]; n_bricks(side, size).iter().product()],
            strided: steps.iter().map(|step| StridedSamples::new(size, *step)).collect(),
        }
    }

    /// Survey from stored parts; `None` where their sizes do not fit together.
    pub fn from_parts(
        size: [usize; 3],
        kernel: Kernel,
        side: usize,
        statistics: Statistics,
        bounds: Vec<[f32; 2]>,
        strided: Vec<StridedSamples>,
    ) -> Option<Self> {
        let fits = SIDES.contains(&side)
            && bounds.len() == n_bricks(side, size).iter().product::<usize>()
            && strided.iter().all(|own| own.values.len() == own.size.iter().product::<usize>());
        fits.then_some(Self { size, kernel, side, statistics, bounds, strided })
    }

    /// Range of all boxes so far, and number of samples that are not finite.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Side of a brick in cells, and least and largest value of every brick, `[z][y][x]`.
    pub fn bounds(&self) -> (usize, &[[f32; 2]]) {
        (self.side, &self.bounds)
    }

    /// Drops the bounds, which take most of the memory; bricks that were made from them stay.
    pub fn forget_bounds(&mut self) {
        self.bounds = Vec::new();
    }

    /// Strided samples, one set per step.
    pub fn strided(&self) -> &[StridedSamples] {
        &self.strided
    }

    /// Adds the samples of a box; boxes must not overlap.
    pub fn add(&mut self, part: &VolumeBox) {
        let own = Statistics::of(&part.samples);
        let all = &mut self.statistics;
        *all = Statistics {
            min: all.min.min(own.min),
            max: all.max.max(own.max),
            n_nonfinite: all.n_nonfinite + own.n_nonfinite,
        };
        self.widen_bounds(&SampleRows(part.samples, Level::best()), part.lo, part.size);
        with_samples!(part.samples, s => {
            self.strided.iter_mut().for_each(|own| own.take(|i| s[i].to_f32(), part.lo, part.size));
        });
    }

    /// Adds densities, or coefficients, of the part `inner` of a box, which also holds the samples that they need
    /// around it. From then on, the survey has statistics of densities instead of
    /// samples.
    pub fn add_prepared(&mut self, slices: &Slices, inner: &[Range<usize>; 3]) {
        let (lo, n) = (inner.each_ref().map(|r| r.start), inner.each_ref().map(Range::len));
        let mut densities = Vec::with_capacity(n.iter().product());
        for z in inner[2].clone() {
            for y in inner[1].clone() {
                slices.push_prepared_row(inner[0].clone(), y, z, &mut densities);
            }
        }
        let range = wavesplat_compute::extent::of(&densities).map(f64::from);
        self.statistics.min = self.statistics.min.min(range[0]);
        self.statistics.max = self.statistics.max.max(range[1]);
        self.widen_bounds(&FloatRows { densities: &densities, level: Level::best() }, lo, n);
        self.strided.iter_mut().for_each(|own| own.take(|i| densities[i], lo, n));
    }

    fn widen_bounds(&mut self, rows: &impl DensityRows, lo: [usize; 3], n: [usize; 3]) {
        let reach = Reach::new(self.side, self.size, self.kernel);
        let n_bricks = reach.n();
        let touched = [0, 1, 2].map(|a| reach.bricks(a, lo[a]..lo[a] + n[a]));
        let layer = n_bricks[0] * n_bricks[1];
        let bounds = &mut self.bounds[layer * touched[2].start..layer * touched[2].end];
        parallel::for_each_chunk(bounds, layer, |k, layer| {
            let bz = touched[2].start + k;
            let own = reach.bounds_within(rows, lo, n, [touched[0].clone(), touched[1].clone(), bz..bz + 1]);
            for (by, own) in touched[1].clone().zip(own.chunks_exact(touched[0].len().max(1))) {
                let row = &mut layer[by * n_bricks[0]..][touched[0].clone()];
                // Extremes depend neither on the order nor on how often a sample is seen: boxes may come in any order,
                // and overlap.
                row.iter_mut().zip(own).for_each(|(all, own)| *all = [all[0].min(own[0]), all[1].max(own[1])]);
            }
        });
    }

    /// Bricks of the survey, with bounds as densities. `density` converts a value; the identity for a survey of
    /// densities.
    pub fn bricks(&self, density: impl Fn(f32) -> f32 + Sync, range: [f32; 2]) -> Bricks {
        Bricks::of_bounds(self.side, self.size, self.kernel, range, &self.bounds, density)
    }

    /// Slices that a frame is planned with. `grid`: with the statistics of this survey. `prepared`: the survey of
    /// densities, where the kernel or holes need one. `light`: number of the set of strided samples that is for light.
    pub fn slices(&self, grid: &Grid, prepared: Option<&Self>, light: usize) -> Slices<'static> {
        let (offset, scale) = grid.density_from_sample();
        let to_density = move |s: f32| ((f64::from(s) - offset) * scale) as f32;
        let Some(of_densities) = prepared else {
            let range = grid.density_range();
            let strided = self.strided.get(light).cloned().unwrap_or_default();
            let bricks = self.bricks(to_density, range);
            return Slices::of_survey(grid, self.kernel, range, bricks, strided, (offset, scale));
        };
        let Statistics { min, max, .. } = of_densities.statistics;
        let range = [min as f32, max as f32];
        let strided = of_densities.strided.first().cloned().unwrap_or_default();
        Slices::of_survey(grid, self.kernel, range, of_densities.bricks(|d| d, range), strided, (0.0, 1.0))
    }
}

/// Rows of samples for the bounds of bricks; samples that are not finite are left out.
struct SampleRows<'a>(Samples<'a>, Level);

impl DensityRows for SampleRows<'_> {
    fn widen(&self, start: usize, lo: &mut [f32], hi: &mut [f32]) {
        /// NaN for values that are not finite: it compares neither less nor more than any bound.
        #[inline(always)]
        fn finite(value: f32) -> f32 {
            if value.is_finite() { value } else { f32::NAN }
        }
        match self.0 {
            Samples::F32(s) => self.1.run(
                #[inline(always)]
                || widen(&s[start..], lo, hi, finite),
            ),
            Samples::F64(s) => self.1.run(
                #[inline(always)]
                || widen(&s[start..], lo, hi, |s| finite(s.to_f32())),
            ),
            samples => {
                with_samples!(samples, s => self.1.run(#[inline(always)] || widen(&s[start..], lo, hi, Sample::to_f32)));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DAffine3;
    use wavesplat_core::Volume;

    fn numbers(size: [usize; 3]) -> Vec<f32> {
        (0..size.iter().product::<usize>()).map(|i| ((i * 7919 % 1009) as f32).sqrt()).collect()
    }

    fn copied(all: &[f32], [nx, ny, _]: [usize; 3], part: &[Range<usize>; 3]) -> Vec<f32> {
        let row = |y: usize, z: usize| all[(z * ny + y) * nx..][part[0].clone()].to_vec();
        part[2].clone().flat_map(|z| part[1].clone().flat_map(move |y| row(y, z))).collect()
    }

    /// Boxes that cover the volume, cut off the borders of bricks.
    fn cuts(size: [usize; 3]) -> Vec<[Range<usize>; 3]> {
        let of = |a: usize, k: usize| if k == 0 { 0..size[a] / 3 } else { size[a] / 3..size[a] };
        (0..8).rev().map(|k| [of(0, k & 1), of(1, k >> 1 & 1), of(2, k >> 2)]).collect()
    }

    #[test]
    fn a_survey_of_boxes_is_that_of_the_volume() {
        let size = [35, 22, 41];
        let samples = numbers(size);
        let volume = Volume::new("survey", Samples::F32(&samples), size, DAffine3::IDENTITY).unwrap();
        for (name, kernel) in Kernel::NAMES {
            let whole = Slices::new(&volume, kernel);
            let mut survey = Survey::new(size, kernel, 1 << 16, &[[4, 3, 2]]);
            for part in cuts(size) {
                let own = copied(&samples, size, &part);
                let lo = part.each_ref().map(|r| r.start);
                survey.add(&VolumeBox { lo, size: part.each_ref().map(Range::len), samples: Samples::F32(&own) });
            }
            assert_eq!(survey.statistics(), volume.grid().statistics());
            let needs_more = crate::kernel::prefilter::pole(kernel).is_some();
            let mut prepared = Survey::new(size, kernel, 1 << 16, &[[4, 3, 2]]);
            for part in cuts(size).into_iter().filter(|_| needs_more) {
                let held = crate::source::slices::needed_samples(&part, volume.grid(), kernel);
                let own = copied(&samples, size, &held);
                let lo = held.each_ref().map(|r| r.start);
                let of = VolumeBox { lo, size: held.each_ref().map(Range::len), samples: Samples::F32(&own) };
                prepared.add_prepared(&Slices::of_box(&of, volume.grid(), kernel, [0.0; 2]), &part);
            }
            let own = survey.slices(volume.grid(), needs_more.then_some(&prepared), 0);
            assert_eq!(own.range(), whole.range(), "{name}");
            let test = |[lo, hi]: [f32; 2]| lo < 9.0 && hi > 8.0;
            let passed = |slices: &Slices| {
                let bricks = slices.bricks().unwrap();
                bricks.occupied([0, 1, 2], &bricks.visible_ranges(test))
            };
            // 4 x 4 x 4 cells here, 2 x 2 x 2 there: whatever is occupied there must be so here.
            let (own, whole) = (passed(&own), passed(&whole));
            let ([nx, ny, nz], ..) = whole.arrays();
            for k in 0..nx * ny * nz {
                let at = [k % nx, k / nx % ny, k / (nx * ny)];
                let is_occupied = |grid: &crate::source::occupancy::OccupancyGrid, p: [usize; 3]| {
                    grid.any([p[0]; 2], [p[1]; 2], [p[2]; 2])
                };
                assert!(!is_occupied(&whole, at) || is_occupied(&own, at.map(|i| i / 2)), "{name} {at:?}");
            }
        }
    }

    #[test]
    fn samples_that_are_not_finite_have_no_bounds() {
        let samples = [1.0, f32::NAN, f32::INFINITY, 2.0, 3.0, 4.0, f32::NEG_INFINITY, 5.0];
        let mut survey = Survey::new([2; 3], Kernel::Linear, 1 << 10, &[]);
        survey.add(&VolumeBox { lo: [0; 3], size: [2; 3], samples: Samples::F32(&samples) });
        assert_eq!(survey.statistics(), Statistics { min: 1.0, max: 5.0, n_nonfinite: 3 });
        assert_eq!(survey.bounds().1, [[1.0, 5.0]]);
    }
}
