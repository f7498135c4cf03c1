//! Slice source: densities in f32, samples or spline coefficients, of any window of any slices.
//!
//! Narrow samples stay in their own type and are converted in the innermost loop. Two cases need a float copy: the
//! B-spline kernels (their coefficients are not the samples), and float data with NaN or infinity. There the holes are
//! filled from their neighbours, and a mask records where they are ([`crate::source::nonfinite`]).
//!
//! A volume that is decoded becomes such a float copy if that fits its memory budget. Otherwise
//! ([`crate::source::block_cache`]) a box of it is loaded first, and then read in the same way.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::DVec3;
use wavesplat_compute::extent;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Decoder, Grid, Kernel, Sample, Samples, Volume, with_samples};

use crate::kernel::prefilter;
use crate::kernel::slice_taps::SliceTap;
use crate::kernel::weights::{mirror_index, n_taps};
use crate::source::block_cache::{Blocks, DensityBox, all_densities, bytes_of_all};
use crate::source::min_max_bricks::{Bricks, DensityRows, FloatRows, MAX_BYTES, widen};
use crate::source::nonfinite::{self, MISSING, fill_holes};
use crate::source::point_sampling::{PointSums, PointTaps};
use crate::source::strided::StridedSamples;
use crate::source::window::{SliceRectangle, Transpose, Window};

/// Densities of a volume, ready for one kernel.
#[derive(Clone)]
pub struct Slices<'a> {
    pub(super) source: SampleSource<'a>,
    grid: Grid,
    pub(super) prepared: Arc<Prepared>,
}

#[derive(Clone)]
pub(super) enum SampleSource<'a> {
    Samples(Samples<'a>),
    /// A volume without samples in memory; its block cache, if its densities are not all prepared.
    Decoded(Option<Arc<Blocks>>),
    /// A volume whose boxes are read elsewhere: frames are planned with it, and drawn from the boxes. Samples for light,
    /// and offset and scale of their densities.
    Surveyed(Arc<StridedSamples>, (f64, f64)),
}

/// Samples of a box of a volume, `[z][y][x]`.
#[derive(Clone, Copy)]
pub struct VolumeBox<'a> {
    /// Index of its first sample.
    pub lo: [usize; 3],
    /// Samples along x, y, z.
    pub size: [usize; 3],
    /// The samples, in the volume's own type.
    pub samples: Samples<'a>,
}

/// Box of the samples that the densities, or spline coefficients, of the box `reached` are computed from.
///
/// It adds the margin that the fill of non-finite samples and the prefilter need around `reached` for the same values
/// as in the whole volume.
pub fn needed_samples(reached: &[Range<usize>; 3], grid: &Grid, kernel: Kernel) -> [Range<usize>; 3] {
    let size = grid.size();
    [0, 1, 2].map(|a| {
        let mut needed = reached[a].clone();
        if prefilter::pole(kernel).is_some() {
            needed = prefilter::needed(&needed, size[a]);
        }
        if grid.statistics().n_nonfinite > 0 {
            needed = needed.start.saturating_sub(nonfinite::REACH)..(needed.end + nonfinite::REACH).min(size[a]);
        }
        needed
    })
}

/// Data computed once from the samples for a kernel; worth keeping between pictures.
pub struct Prepared {
    kernel: Kernel,
    size: [usize; 3],
    /// Box of the volume that is in memory, mostly all of it: its first sample, and its size along x, y, z.
    lo: [usize; 3],
    held: [usize; 3],
    /// Densities or spline coefficients, where the samples are not used as they are.
    pub(super) densities: Option<Vec<f32>>,
    pub(super) mask: Option<Vec<bool>>,
    range: [f32; 2],
    /// Bounds of the densities; `None` for a box of a volume, which is drawn with the bounds of the whole.
    bricks: Option<Bricks>,
    /// Unique number: the key of caches of data that is derived from it.
    id: u64,
    /// Block cache of a volume without samples; `None` where there are densities.
    blocks: Option<Arc<Blocks>>,
}

/// Divisor of the memory for decoded blocks: the bounds of bricks may take this part of it in addition.
const BOUNDS_SHARE: usize = 8;

impl Prepared {
    /// Prepares a volume: coefficients where the kernel needs them, filled holes, and the bounds of every brick.
    pub fn new(volume: &Volume, kernel: Kernel) -> Self {
        let grid = volume.grid();
        let (size, map) = (grid.size(), grid.density_from_sample());
        let range = grid.density_range();
        let n_nonfinite = grid.statistics().n_nonfinite;
        let pole = prefilter::pole(kernel);
        let level = Level::best();
        if pole.is_none() && n_nonfinite == 0 {
            let samples = *volume.samples();
            let bricks = Bricks::new(&NativeRows { samples, map, level }, size, kernel, range, MAX_BYTES);
            return Self::of_parts(kernel, size, range, bricks);
        }
        let mut densities = densities(volume.samples(), map);
        let mask = (n_nonfinite > 0).then(|| densities.iter().map(|d| !d.is_finite()).collect());
        if mask.is_some() {
            fill_holes(&mut densities, size, range[0]);
        }
        Self { mask, ..Self::of_densities(densities, size, kernel, range, MAX_BYTES) }
    }

    /// Prepares a box of a volume, from which a piece of a picture is drawn. `range` bounds the densities of the whole.
    fn of_box(samples: &VolumeBox, grid: &Grid, kernel: Kernel, range: [f32; 2]) -> Self {
        static N_BOXES: AtomicU64 = AtomicU64::new(u64::MAX / 2);
        let VolumeBox { lo, size: held, samples } = *samples;
        let pole = prefilter::pole(kernel);
        let mut prepared = Self {
            kernel,
            size: grid.size(),
            lo,
            held,
            densities: None,
            mask: None,
            range,
            bricks: None,
            id: N_BOXES.fetch_add(1, Ordering::Relaxed),
            blocks: None,
        };
        let has_holes = grid.statistics().n_nonfinite > 0;
        if pole.is_none() && !has_holes {
            return prepared;
        }
        let mut densities = densities(&samples, grid.density_from_sample());
        if has_holes {
            prepared.mask = Some(densities.iter().map(|d| !d.is_finite()).collect());
            fill_holes(&mut densities, held, grid.density_range()[0]);
        }
        if let Some(z) = pole {
            prefilter::prefilter_box(&mut densities, lo, held, z);
        }
        Self { densities: Some(densities), ..prepared }
    }

    /// Prepares densities that are all finite. Their bounds are to take at most `bounds_bytes`.
    fn of_densities(
        mut densities: Vec<f32>,
        size: [usize; 3],
        kernel: Kernel,
        mut range: [f32; 2],
        bounds_bytes: usize,
    ) -> Self {
        if let Some(z) = prefilter::pole(kernel) {
            prefilter::prefilter_volume(&mut densities, size, z);
            // Spline coefficients leave the range of the samples.
            range = extent::of(&densities);
        }
        let rows = FloatRows { densities: &densities, level: Level::best() };
        let bricks = Bricks::new(&rows, size, kernel, range, bounds_bytes);
        Self { densities: Some(densities), ..Self::of_parts(kernel, size, range, bricks) }
    }

    /// Data of samples that are used as they are.
    fn of_parts(kernel: Kernel, size: [usize; 3], range: [f32; 2], bricks: Bricks) -> Self {
        static N_MADE: AtomicU64 = AtomicU64::new(0);
        let id = N_MADE.fetch_add(1, Ordering::Relaxed);
        Self {
            kernel,
            size,
            lo: [0; 3],
            held: size,
            densities: None,
            mask: None,
            range,
            bricks: Some(bricks),
            id,
            blocks: None,
        }
    }

    /// Prepares a volume that is decoded as it is drawn; its grid holds the range of its samples. Everything is decoded
    /// once for the bounds of the bricks. At most about `budget_bytes` of densities are kept: all of them, if they fit.
    fn of_decoder(decoder: Arc<dyn Decoder>, grid: &Grid, kernel: Kernel, budget_bytes: usize) -> Self {
        let (size, range, bounds_bytes) = (grid.size(), grid.density_range(), budget_bytes / BOUNDS_SHARE);
        if bytes_of_all(size) <= budget_bytes {
            let densities = all_densities(&*decoder, grid);
            return Self::of_densities(densities, size, kernel, range, bounds_bytes);
        }
        let blocks = Arc::new(Blocks::new(decoder, grid, kernel, budget_bytes));
        let range = prefilter::pole(kernel).is_none().then_some(range);
        let bricks = Bricks::of_blocks(Level::best(), &blocks, kernel, range, bounds_bytes);
        let range = bricks.range();
        Self { blocks: Some(blocks), ..Self::of_parts(kernel, size, range, bricks) }
    }
}

impl<'a> Slices<'a> {
    /// Prepares a volume for a kernel.
    pub fn new(volume: &Volume<'a>, kernel: Kernel) -> Self {
        Self::with_prepared(volume, Arc::new(Prepared::new(volume, kernel)))
    }

    /// Uses data that was prepared before from the same samples.
    pub fn with_prepared(volume: &Volume<'a>, prepared: Arc<Prepared>) -> Self {
        Self { source: SampleSource::Samples(*volume.samples()), grid: volume.grid().clone(), prepared }
    }

    /// Prepares a volume that is decoded as it is drawn; its grid holds the range of its samples. Everything is decoded
    /// once for the bounds of the bricks. At most about `budget_bytes` of densities are kept: all of them, if they fit.
    pub fn of_decoder(decoder: Arc<dyn Decoder>, grid: &Grid, kernel: Kernel, budget_bytes: usize) -> Self {
        let prepared = Arc::new(Prepared::of_decoder(decoder, grid, kernel, budget_bytes));
        Self { source: SampleSource::Decoded(prepared.blocks.clone()), grid: grid.clone(), prepared }
    }

    /// Slices of densities that are all finite, `[z][y][x]` of `grid`, whose statistics bound them.
    pub fn of_densities(densities: Vec<f32>, grid: &Grid, kernel: Kernel) -> Self {
        let prepared = Prepared::of_densities(densities, grid.size(), kernel, grid.density_range(), MAX_BYTES);
        Self { source: SampleSource::Decoded(None), grid: grid.clone(), prepared: Arc::new(prepared) }
    }

    /// Slices of a volume whose boxes are read elsewhere ([`crate::source::survey`]): for plans, not to be drawn from.
    /// `range` bounds the densities, or spline coefficients; `strided`: the samples that light needs ([`light_steps`]).
    /// `density_from_value`: offset and scale of their densities, `(value - offset) * scale`.
    ///
    /// [`light_steps`]: crate::source::strided::light_steps
    pub(super) fn of_survey(
        grid: &Grid,
        kernel: Kernel,
        range: [f32; 2],
        bricks: Bricks,
        strided: StridedSamples,
        density_from_value: (f64, f64),
    ) -> Self {
        let prepared = Arc::new(Prepared::of_parts(kernel, grid.size(), range, bricks));
        Self { source: SampleSource::Surveyed(Arc::new(strided), density_from_value), grid: grid.clone(), prepared }
    }

    /// Whether the samples are read elsewhere, box by box.
    pub fn is_surveyed(&self) -> bool {
        matches!(self.source, SampleSource::Surveyed(..))
    }

    /// Density at an index position, linear between the samples that a survey kept for light; `None` of other slices.
    pub fn strided_density(&self, index: DVec3) -> Option<f32> {
        let SampleSource::Surveyed(strided, (offset, scale)) = &self.source else { return None };
        Some(((strided.linear(index) - offset) * scale) as f32)
    }

    /// Writes densities, or coefficients, of every n-th sample of the slice `z`, row by row; `z` is a multiple of the
    /// step too.
    pub fn strided_slice(&self, z: usize, step: [usize; 3], out: &mut Vec<f32>) {
        out.clear();
        let [nx, ny, _] = self.grid.size();
        if let SampleSource::Surveyed(strided, (offset, scale)) = &self.source {
            debug_assert_eq!(strided.step, step, "as the survey was made");
            let density = |value: &f32| ((f64::from(*value) - offset) * scale) as f32;
            return (0..ny).step_by(step[1]).for_each(|y| out.extend(strided.row(y, z).iter().map(density)));
        }
        let mut slice = vec![0.0; nx * ny];
        let window = Window { u: [0, nx as i64 - 1], v: [0, ny as i64 - 1] };
        self.combine(Level::best(), [0, 1, 2], &[(z, 1.0)], None, window, &mut slice, nx);
        (0..ny).step_by(step[1]).for_each(|y| out.extend(slice[y * nx..][..nx].iter().step_by(step[0])));
    }

    /// Appends a row of densities, or coefficients, of a prepared box to `out`.
    pub(super) fn push_prepared_row(&self, xs: Range<usize>, y: usize, z: usize, out: &mut Vec<f32>) {
        let from = self.linear_index([xs.start, y, z]);
        match &self.prepared.densities {
            Some(densities) => out.extend_from_slice(&densities[from..][..xs.len()]),
            None => out.extend(xs.map(|x| self.at([x, y, z]) as f32)),
        }
    }

    /// Prepares a box of a volume that lies on `grid` for a kernel. `range` bounds the densities, or spline
    /// coefficients, of the whole volume: its [`Slices::range`].
    pub fn of_box(samples: &VolumeBox<'a>, grid: &Grid, kernel: Kernel, range: [f32; 2]) -> Self {
        let prepared = Arc::new(Prepared::of_box(samples, grid, kernel, range));
        Self { source: SampleSource::Samples(samples.samples), grid: grid.clone(), prepared }
    }

    /// Grid of the whole volume.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// Kernel that the densities are for.
    pub fn kernel(&self) -> Kernel {
        self.prepared.kernel
    }

    /// Smallest and largest density, or spline coefficient, of the whole volume.
    pub fn range(&self) -> [f32; 2] {
        self.prepared.range
    }

    /// Bounds of the densities, brick by brick; `None` for a box of a volume.
    pub fn bricks(&self) -> Option<&Bricks> {
        self.prepared.bricks.as_ref()
    }

    /// Unique number of the prepared data: the key of caches of data that is derived from it.
    pub fn id(&self) -> u64 {
        self.prepared.id
    }

    /// Whether any sample is drawn as empty.
    pub fn has_mask(&self) -> bool {
        self.prepared.mask.is_some()
    }

    fn linear_index(&self, index: [usize; 3]) -> usize {
        let (lo, size) = (self.prepared.lo, self.prepared.held);
        index[0] - lo[0] + size[0] * (index[1] - lo[1] + size[1] * (index[2] - lo[2]))
    }

    /// Density (or coefficient) at an index position, in f64; slow, for the reference.
    pub fn at(&self, index: [usize; 3]) -> f64 {
        let i = self.linear_index(index);
        match (&self.prepared.densities, &self.source) {
            (Some(densities), _) => f64::from(densities[i]),
            (None, SampleSource::Samples(samples)) => {
                let (offset, scale) = self.grid.density_from_sample();
                (samples.get(i) - offset) * scale
            }
            (None, SampleSource::Surveyed(..)) => f64::NAN,
            (None, SampleSource::Decoded(blocks)) => {
                let mut part = DensityBox::default();
                blocks.as_ref().map_or(f64::NAN, |blocks| {
                    blocks.load(index, index.map(|i| i + 1), &mut part);
                    f64::from(part.densities[0])
                })
            }
        }
    }

    /// Whether the sample at an index position is drawn as empty.
    pub fn is_hole(&self, index: [usize; 3]) -> bool {
        self.prepared.mask.as_ref().is_some_and(|m| m[self.linear_index(index)])
    }

    /// Writes `out[i] = Σ weight · sample`, in sample units, at each point; NaN where missing samples make up half of
    /// the linear kernel's weight, or more.
    ///
    /// For a volume that is decoded, the box around all points is loaded.
    pub fn sums(&self, points: &[PointTaps], out: &mut [f64]) {
        let kernel = self.prepared.kernel;
        let (offset, scale) = self.grid.density_from_sample();
        let whole = PointSums { n_taps: n_taps(kernel), lo: self.prepared.lo, size: self.prepared.held };
        let sample = |d: f32| f64::from(d) / scale + offset;
        match (&self.prepared.densities, &self.source) {
            (Some(coefficients), _) if prefilter::pole(kernel).is_some() => {
                whole.write(coefficients, points, out, sample);
            }
            // Samples in their own type; missing ones take the value that they were filled with.
            (filled, SampleSource::Samples(samples)) => match (filled, &self.prepared.mask) {
                (Some(filled), Some(mask)) => {
                    let at = |i: usize, own: f64| if mask[i] { sample(filled[i]) } else { own };
                    with_samples!(*samples, s => whole.write_at(points, out, |i| at(i, s[i].to_f64())));
                }
                _ => with_samples!(*samples, s => whole.write(s, points, out, Sample::to_f64)),
            },
            (Some(densities), _) => whole.write(densities, points, out, sample),
            (None, SampleSource::Surveyed(..)) => out.fill(f64::NAN),
            (None, SampleSource::Decoded(blocks)) => {
                let (Some(blocks), Some((lo, hi))) = (blocks, whole.reached(points)) else { return };
                let mut part = DensityBox::default();
                blocks.load(lo, hi, &mut part);
                let part_sums = PointSums { lo: part.lo, size: part.size, ..whole };
                part_sums.write(&part.densities, points, out, sample);
            }
        }
        if let Some(mask) = &self.prepared.mask {
            for (point, out) in points.iter().zip(out) {
                let mut missing = 0.0;
                whole.for_each_cell_tap(point, |i, weight| missing += if mask[i] { weight } else { 0.0 });
                *out = if missing >= f64::from(MISSING) { f64::NAN } else { *out };
            }
        }
    }

    /// Writes `out[v · stride + u] = Σ weight · density` over the slices of `taps`; `axes` are the index axes called u,
    /// v, w. `soon`: a slice of which the same window is needed next, to be prefetched.
    #[expect(clippy::too_many_arguments, reason = "what is read, what comes next, and where it goes")]
    pub fn combine(
        &self,
        level: Level,
        axes: [usize; 3],
        taps: &[SliceTap],
        soon: Option<usize>,
        window: Window,
        out: &mut [f32],
        stride: usize,
    ) {
        let region = self.region(axes, window, stride);
        let (first, n) = (self.prepared.lo[axes[2]], self.prepared.held[axes[2]]);
        let soon = soon.filter(|slice| (first..first + n).contains(slice));
        if let Some(grid) = &self.prepared.densities {
            return level.run(
                #[inline(always)]
                || region.combine(grid, taps, soon, out, |d| d),
            );
        }
        let samples = match &self.source {
            SampleSource::Samples(samples) => *samples,
            SampleSource::Decoded(_) | SampleSource::Surveyed(..) => {
                let slices = taps.iter().fold([usize::MAX, 0], |[lo, hi], tap| [lo.min(tap.0), hi.max(tap.0)]);
                let mut part = DensityBox::default();
                self.load(axes, window, slices, &mut part);
                return self.combine_part(level, axes, &part, taps, window, out, stride);
            }
        };
        let (offset, scale) = self.grid.density_from_sample();
        if is_identity((offset, scale)) {
            with_samples!(samples, s => level.run(#[inline(always)] || region.combine(s, taps, soon, out, Sample::to_f32)));
        } else {
            with_samples!(samples, s => level.run(#[inline(always)] || region.combine(s, taps, soon, out, |s| ((s.to_f64() - offset) * scale) as f32)));
        }
    }

    /// Whether boxes must be loaded, from decoded blocks, before they are read.
    pub fn must_load(&self) -> bool {
        matches!(self.source, SampleSource::Decoded(Some(_)))
    }

    /// Loads the box that a window reaches in the slices from the first to the last of `slices`, if boxes must be
    /// loaded.
    pub fn load(&self, axes: [usize; 3], window: Window, slices: [usize; 2], part: &mut DensityBox) {
        let SampleSource::Decoded(Some(blocks)) = &self.source else { return };
        let size = self.prepared.size;
        let reached = |[lo, hi]: [i64; 2], n: usize| {
            let folded = (lo..=hi).map(|i| mirror_index(self.prepared.kernel, i, n));
            folded.fold([usize::MAX, 0], |[lo, hi], i| [lo.min(i), hi.max(i)])
        };
        let ends = [reached(window.u, size[axes[0]]), reached(window.v, size[axes[1]]), slices];
        let (mut lo, mut hi) = ([0; 3], [0; 3]);
        for (axis, [first, last]) in axes.into_iter().zip(ends) {
            (lo[axis], hi[axis]) = (first, (last + 1).min(size[axis]));
        }
        blocks.load(lo, hi, part);
    }

    /// Combines slices like [`Slices::combine`], from a box that was loaded.
    #[expect(clippy::too_many_arguments, reason = "the box, and what `combine` takes")]
    pub fn combine_part(
        &self,
        level: Level,
        axes: [usize; 3],
        part: &DensityBox,
        taps: &[SliceTap],
        window: Window,
        out: &mut [f32],
        stride: usize,
    ) {
        let region = self.region(axes, window, stride).inside(axes, part.lo, part.size);
        level.run(
            #[inline(always)]
            || region.combine(&part.densities, taps, None, out, |d| d),
        );
    }

    fn region(&self, axes: [usize; 3], window: Window, stride: usize) -> SliceRectangle {
        let Prepared { kernel, size, lo, held, .. } = *self.prepared;
        SliceRectangle::new(kernel, size, axes, window, stride).inside(axes, lo, held)
    }

    /// Writes `out[slice · plane + v · stride + u] = density` for the sixteen slices from `first` on, which lie across
    /// x; u and v are y and z. Slices beyond the last one are not written. `stride` is a multiple of sixteen.
    ///
    /// `part`: the loaded box that holds the window, if boxes must be loaded.
    #[expect(clippy::too_many_arguments, reason = "the box, and which part of it goes where")]
    pub fn write_transposed(
        &self,
        level: Level,
        axes: [usize; 3],
        first: usize,
        window: Window,
        part: &DensityBox,
        out: &mut [f32],
        stride: usize,
    ) {
        let region = self.region(axes, window, stride);
        if let Some(grid) = &self.prepared.densities {
            return level.dispatch(Transpose { region, grid, first, out, density: |d: f32| d });
        }
        let SampleSource::Samples(samples) = self.source else {
            let region = region.inside(axes, part.lo, part.size);
            return level.dispatch(Transpose { region, grid: &part.densities, first, out, density: |d: f32| d });
        };
        let (offset, scale) = self.grid.density_from_sample();
        if is_identity((offset, scale)) {
            with_samples!(samples, grid => {
                level.dispatch(Transpose { region, grid, first, out, density: Sample::to_f32 });
            });
        } else {
            with_samples!(samples, grid => {
                let density = |s| (Sample::to_f64(s) - offset) * scale;
                level.dispatch(Transpose { region, grid, first, out, density: |s| density(s) as f32 });
            });
        }
    }

    /// Combines the mask like [`Slices::combine`]: writes the weight of the missing samples.
    pub fn combine_mask(
        &self,
        level: Level,
        axes: [usize; 3],
        taps: &[SliceTap],
        window: Window,
        out: &mut [f32],
        stride: usize,
    ) {
        if let Some(mask) = &self.prepared.mask {
            let region = self.region(axes, window, stride);
            level.run(
                #[inline(always)]
                || region.combine(mask, taps, None, out, |hole| if hole { 1.0 } else { 0.0 }),
            );
        }
    }
}

/// Whether samples are densities as they are: offset 0 and scale 1.
pub(super) fn is_identity(density_from_sample: (f64, f64)) -> bool {
    density_from_sample == (0.0, 1.0)
}

/// Rows of the samples, for the bounds of bricks.
struct NativeRows<'a> {
    samples: Samples<'a>,
    map: (f64, f64),
    level: Level,
}

impl DensityRows for NativeRows<'_> {
    fn widen(&self, start: usize, lo: &mut [f32], hi: &mut [f32]) {
        let (offset, scale) = self.map;
        if is_identity(self.map) {
            with_samples!(self.samples, s => self.level.run(#[inline(always)] || widen(&s[start..], lo, hi, Sample::to_f32)));
        } else {
            with_samples!(self.samples, s => self.level.run(#[inline(always)] || widen(&s[start..], lo, hi, |s| ((s.to_f64() - offset) * scale) as f32)));
        }
    }
}

fn densities(samples: &Samples, (offset, scale): (f64, f64)) -> Vec<f32> {
    with_samples!(samples, s => s.iter().map(|s| ((s.to_f64() - offset) * scale) as f32).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DAffine3;

    #[test]
    fn any_axis_and_any_type_give_the_same_window() {
        let size = [5, 4, 3];
        let values: Vec<u8> = (0..60).map(|i| (i * 7 % 60) as u8).collect();
        let wide: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
        let narrow = Volume::new("narrow", Samples::U8(&values), size, DAffine3::IDENTITY).unwrap();
        let float = Volume::new("float", Samples::F64(&wide), size, DAffine3::IDENTITY).unwrap();
        let (offset, scale) = float.grid().density_from_sample();
        let (narrow, float) = (Slices::new(&narrow, Kernel::Linear), Slices::new(&float, Kernel::Linear));
        for axes in [[0, 1, 2], [0, 2, 1], [1, 2, 0]] {
            let window = Window { u: [-2, size[axes[0]] as i64 + 1], v: [-1, size[axes[1]] as i64] };
            let taps = [(0, 0.25), (2, 0.75)];
            let n = window.n_u() * window.n_v();
            let (mut a, mut b) = (vec![9.0; n], vec![9.0; n]);
            narrow.combine(Level::best(), axes, &taps, None, window, &mut a, window.n_u());
            float.combine(Level::best(), axes, &taps, None, window, &mut b, window.n_u());
            for (i, (a, b)) in a.iter().zip(&b).enumerate() {
                let (u, v) = (window.u[0] + (i % window.n_u()) as i64, window.v[0] + (i / window.n_u()) as i64);
                let mut index = [0; 3];
                index[axes[0]] = u.clamp(0, size[axes[0]] as i64 - 1) as usize;
                index[axes[1]] = v.clamp(0, size[axes[1]] as i64 - 1) as usize;
                let want: f64 = taps
                    .iter()
                    .map(|&(w, weight)| {
                        index[axes[2]] = w;
                        f64::from(weight) * narrow.at(index)
                    })
                    .sum();
                assert!((f64::from(*a) - want).abs() < 1e-5, "{axes:?} {u} {v}");
                assert!((f64::from(*b) / scale + offset - want).abs() < 1e-4, "{axes:?} {u} {v}");
            }
        }
    }
}
