//! Probe rays: values and gradients along rays through the finest level and a coarser one.
//!
//! The rays are oblique to the axes and spread evenly over the volume. Between sheets values are linear, as in the
//! renderer. They are independent of transfer functions and computed once per level.

use wavesplat_compute::parallel;
use wavesplat_core::{Decoder, LevelGrid};

use crate::sample_box::{GRADIENT_OFFSET, SampleBox};

/// Rays per bundle. A bundle is spread over the whole volume where that is decoded, else over a part `SIDE` samples
/// wide.
const RAYS_PER_BUNDLE: usize = 16;
const SIDE: usize = 16;

/// Largest number of bundles along each axis; fewer where all rays together would pass more than this number of
/// samples.
const MAX_BUNDLES: usize = 256;
const MAX_PROBED_SAMPLES: usize = 1 << 19;

/// Largest number of samples of a volume that is decoded as a whole.
const MAX_DECODED_SAMPLES: usize = 1 << 24;

/// Sheets per slice: of the finest level, of a coarser level, and of a coarser level with a steep function.
const SHEETS_PER_SLICE: [usize; 3] = [2, 2, 1];

/// Positions per sample of the finest grid for each of [`SHEETS_PER_SLICE`]: with fewer, steep functions would miss
/// thin features; and the gradient at the first visible position of a ray is taken for the surface's.
const POSITIONS_PER_SAMPLE: [usize; 3] = [4, 4, 2];

/// Direction of the rays, along their axis and across it: half way between rays along the axis and diagonal ones.
const DIRECTION: [f64; 3] = [1.0, 0.5, 0.3];

/// Number of steps of `|n·v|`; one more step stands for points without a gradient.
pub(crate) const N_COSINES: usize = 31;

/// A ray, oblique to its main axis.
pub(crate) struct ProbeRay {
    pub axis: usize,
    /// Entries along the ray, for each of [`SHEETS_PER_SLICE`].
    pub entries: [Vec<ProbeEntry>; 3],
}

/// Bin of a value, times `N_COSINES + 1`, plus step of `|n·v|`.
type ProbeEntry = u16;

/// Probe rays through a volume and a coarser level of it.
pub(crate) struct ProbeRays(pub Vec<ProbeRay>);

impl ProbeRays {
    /// Probes the finest level and a coarser one that lies on `grid`. `spacing`: distance of the finest samples along
    /// each axis, in any unit. `bin`: bin of a value, below 2048. Decodes the volume as a whole only within
    /// `budget_bytes`, and no more than 64 MB of the finest samples.
    pub fn new(
        [fine, coarse]: [&dyn Decoder; 2],
        grid: &LevelGrid,
        spacing: [f64; 3],
        budget_bytes: usize,
        bin: impl Fn(f32) -> usize + Sync,
    ) -> Self {
        let size = fine.size();
        let n_samples = size.iter().product::<usize>();
        let fits = n_samples <= MAX_DECODED_SAMPLES && 2 * n_samples * size_of::<f32>() <= budget_bytes;
        let whole = fits.then(|| [fine, coarse].map(|decoder| SampleBox::new(decoder, [0; 3], decoder.size())));
        let n_per_axis = MAX_BUNDLES.min(MAX_PROBED_SAMPLES / (RAYS_PER_BUNDLE * size.iter().sum::<usize>())).max(1);
        let bundles = parallel::map(3 * n_per_axis, |i| {
            let (axis, bundle) = (i % 3, i / 3);
            let last = size.map(|n| (n - 1) as f64);
            // The volume is cut into parts of equal width, so that its middle counts no more than its faces.
            let n_across = last.map(|last| if fits { 1.0 } else { (last / SIDE as f64).ceil().max(1.0) });
            let width = [0, 1, 2].map(|a| last[a] / n_across[a]);
            let first = low_discrepancy(axis, bundle, n_across);
            let first = [0, 1, 2].map(|a| if a == axis { 0.0 } else { first[a].floor() * width[a] });
            let end = [0, 1, 2].map(|a| if a == axis { last[a] } else { first[a] + width[a] });
            let mut decoded = None;
            let [fine, coarse] = whole.as_ref().unwrap_or_else(|| {
                let [low_first, low_end] = [first, end].map(|at| grid.level_from_finest(at));
                decoded.insert([
                    SampleBox::around(fine, axis, first, end),
                    SampleBox::around(coarse, axis, low_first, low_end),
                ])
            });
            let ray = |k: usize| {
                let within = low_discrepancy(axis, bundle * RAYS_PER_BUNDLE + k, width);
                let start = [0, 1, 2].map(|a| if a == axis { 0.0 } else { first[a] + within[a] });
                let path = ProbePath::new(axis, start, [first, end], spacing, k);
                let finest = LevelGrid::finest(size);
                let of = |which: usize| {
                    let (samples, grid) = if which == 0 { (fine, &finest) } else { (coarse, grid) };
                    RaySheets::new(samples, grid, &path, spacing, SHEETS_PER_SLICE[which] as f64).along(
                        size[axis],
                        POSITIONS_PER_SAMPLE[which],
                        &bin,
                    )
                };
                let mut entries = [of(0), of(1), of(2)];
                // Half of the rays run the other way.
                if k % 2 == 1 {
                    for entries in &mut entries {
                        entries.reverse();
                    }
                }
                ProbeRay { axis, entries }
            };
            (0..RAYS_PER_BUNDLE).map(ray).collect::<Vec<_>>()
        });
        Self(bundles.into_iter().flatten().collect())
    }
}

/// Length of a ray's steps from position to position, by axis of the ray, for index `which` of [`SHEETS_PER_SLICE`].
/// `lengths`: sample spacing along each axis.
pub(crate) fn step_lengths(which: usize, lengths: [f64; 3]) -> [f64; 3] {
    let longer = DIRECTION.iter().map(|d| d * d).sum::<f64>().sqrt() / DIRECTION[0];
    lengths.map(|length| length * longer / POSITIONS_PER_SAMPLE[which] as f64)
}

/// Low-discrepancy point of a box for every `k`, at 0 along an axis: the sequence R2 (M. Roberts 2018, "The
/// unreasonable effectiveness of quasirandom sequences").
fn low_discrepancy(axis: usize, k: usize, size: [f64; 3]) -> [f64; 3] {
    let mut at = [0.0; 3];
    for (a, step) in [(1, 0.754_877_666_246_693), (2, 0.569_840_290_998_053)] {
        let a = (axis + a) % 3;
        at[a] = (0.5 + step * k as f64).fract() * size[a];
    }
    at
}

/// The path of a ray, in index positions of the finest grid. It is reflected at the sides of its box.
struct ProbePath {
    axis: usize,
    start: [f64; 3],
    /// Change of position per sample along the axis.
    slope: [f64; 3],
    bounds: [[f64; 3]; 2],
    /// Unit vector of the ray at the start, in the units of the spacing.
    direction: [f64; 3],
}

impl ProbePath {
    /// Path from `start`. `spacing`: distance of the finest samples along each axis; `k`: its bits 1 to 3 choose the
    /// direction across.
    fn new(axis: usize, start: [f64; 3], bounds: [[f64; 3]; 2], spacing: [f64; 3], k: usize) -> Self {
        let mut direction = [0.0; 3];
        direction[axis] = DIRECTION[0];
        // Steeper along one of the other two axes, to either side.
        let across = if k & 2 == 0 { [1, 2] } else { [2, 1] };
        direction[(axis + across[0]) % 3] = DIRECTION[1] * if k & 4 == 0 { 1.0 } else { -1.0 };
        direction[(axis + across[1]) % 3] = DIRECTION[2] * if k & 8 == 0 { 1.0 } else { -1.0 };
        let slope = [0, 1, 2].map(|a| direction[a] / DIRECTION[0] * spacing[axis] / spacing[a]);
        let length = DIRECTION.iter().map(|d| d * d).sum::<f64>().sqrt();
        Self { axis, start, slope, bounds, direction: direction.map(|d| d / length) }
    }

    /// Position at `x` along the axis of the ray, and per axis the sign of the direction relative to the start: −1
    /// after a reflection.
    fn at(&self, x: f64) -> [[f64; 3]; 2] {
        let (mut position, mut signs) = (self.start, [1.0; 3]);
        for a in 0..3 {
            let [lo, hi] = [self.bounds[0][a], self.bounds[1][a]];
            if a == self.axis {
                position[a] = x;
            } else if hi > lo {
                let distance = (self.start[a] + self.slope[a] * x - lo).rem_euclid(2.0 * (hi - lo));
                let is_back = distance > hi - lo;
                position[a] = if is_back { 2.0 * hi - lo - distance } else { lo + distance };
                signs[a] = if is_back { -1.0 } else { 1.0 };
            }
        }
        [position, signs]
    }
}

/// Values and gradients along a ray, in sheets across its axis.
struct RaySheets {
    /// Sheets per sample of the finest grid along the axis, and position of the first sheet.
    per_sample: f64,
    origin: f64,
    /// Per sheet: value, and its slopes along the three axes, mirrored with the ray.
    values: Vec<[f32; 4]>,
    /// Unit vector of the ray.
    direction: [f64; 3],
}

impl RaySheets {
    /// Samples a path on a level that lies on `grid`, with `per_slice` sheets per slice. `spacing`: distance of the
    /// finest samples.
    fn new(samples: &SampleBox, grid: &LevelGrid, path: &ProbePath, spacing: [f64; 3], per_slice: f64) -> Self {
        let axis = path.axis;
        let n = ((samples.size[axis] - 1) as f64 * per_slice) as usize + 1;
        let sheet = |k: usize| {
            let mut x = grid.origin[axis] + grid.spacing[axis] * k as f64 / per_slice;
            x = x.clamp(path.bounds[0][axis], path.bounds[1][axis]);
            let [position, signs] = path.at(x);
            let position = grid.level_from_finest(position);
            let (value, ends) = samples.with_neighbours(position);
            let mut numbers = [value; 4];
            for a in 0..3 {
                let last = (samples.size[a] - 1) as f64;
                let distance = (position[a] + GRADIENT_OFFSET).min(last) - (position[a] - GRADIENT_OFFSET).max(0.0);
                let distance = distance * grid.spacing[a] * spacing[a];
                let change = f64::from(ends[a][1] - ends[a][0]);
                numbers[a + 1] = if distance > 0.0 { (signs[a] * change / distance) as f32 } else { 0.0 };
            }
            numbers
        };
        Self {
            per_sample: per_slice / grid.spacing[axis],
            origin: grid.origin[axis],
            values: (0..n).map(sheet).collect(),
            direction: path.direction,
        }
    }

    /// Entries of a ray that is `n` samples of the finest grid long, at `n_per_sample` positions per sample.
    fn along(&self, n: usize, n_per_sample: usize, bin: impl Fn(f32) -> usize) -> Vec<ProbeEntry> {
        let last = (self.values.len() - 1) as f64;
        let direction = self.direction.map(|d| d as f32);
        let entry = |i: usize| {
            let x = ((i as f64 / n_per_sample as f64 - self.origin) * self.per_sample).clamp(0.0, last);
            let below = x as usize;
            let (from, to) = (self.values[below], self.values[(below + 1).min(self.values.len() - 1)]);
            let t = (x - below as f64) as f32;
            let [value, slopes @ ..] = [0, 1, 2, 3].map(|c| from[c] + (to[c] - from[c]) * t);
            let slope = slopes.iter().map(|slope| slope * slope).sum::<f32>().sqrt();
            let along: f32 = slopes.iter().zip(direction).map(|(slope, d)| slope * d).sum();
            let step = if slope > 0.0 {
                ((along.abs() / slope * N_COSINES as f32) as usize).min(N_COSINES - 1)
            } else {
                N_COSINES
            };
            (bin(value) * (N_COSINES + 1) + step) as ProbeEntry
        };
        (0..=(n - 1) * n_per_sample).map(entry).collect()
    }
}
