//! The one final resampling: base planes -> picture.
//!
//! Each pixel is served by the family of its own ray. Where the base plane is denser than the pixels, a pixel is the mean
//! of several reads: a box filter, as many rays per pixel would give.

use std::ops::Range;

use glam::DVec2;
use wavesplat_compute::parallel;
use wavesplat_compute::simd::{Kernel, LANES, Level, Simd};

use crate::base_picture::BasePicture;
use crate::base_plane::BasePlane;
use crate::family::{Family, IndexRays};
use crate::resample::{Drawn, FAR, Quads, Resampler};

/// A pixel of the warped picture: colour, and (base plane, w) of opacity ½.
pub struct Warped {
    /// As [`BasePicture::texels`].
    pub rgba: Vec<[f32; 4]>,
    /// Index-space position along the pixel's ray of opacity ½, as the ray's parameter; NaN where not reached.
    pub ray_parameter: Option<Vec<f32>>,
}

/// Draws the picture. `reads_per_axis`: reads per pixel along x and along y. `peak`: largest unassociated colour.
pub fn warp(
    level: Level,
    pictures: &[BasePicture],
    rays: &IndexRays,
    [width_px, height_px]: [usize; 2],
    reads_per_axis: usize,
    peak: f32,
    with_depth: bool,
) -> Warped {
    let mut rgba = vec![[0.0_f32; 4]; width_px * height_px];
    let share = 1.0 / (reads_per_axis * reads_per_axis) as f32;
    let offsets: Vec<f64> = (0..reads_per_axis).map(|s| (s as f64 + 0.5) / reads_per_axis as f64).collect();
    let resamplers: Vec<_> = pictures.iter().map(Resampler::new).collect();
    let reads = Reads { resamplers: &resamplers, rays, share, peak };
    parallel::for_each_chunk(&mut rgba, BAND * width_px, |band, pixels| {
        let first_row = band * BAND;
        level.dispatch(DrawBand { reads: &reads, offsets: &offsets, first_row, width_px, pixels });
    });
    let parameters = with_depth.then(|| {
        let mut parameter = vec![f32::NAN; width_px * height_px];
        parallel::for_each_chunk(&mut parameter, width_px, |y, row| {
            for (x, parameter) in row.iter_mut().enumerate() {
                *parameter = ray_parameter(&resamplers, rays, x as f64 + 0.5, y as f64 + 0.5);
            }
        });
        parameter
    });
    Warped { rgba, ray_parameter: parameters }
}

/// Rows of pixels that are drawn together, so many columns at a time: rows of pixels mostly lie aslant in the base
/// plane, and what one has read is near when the next one wants it.
const BAND: usize = 32;

/// Draws some rows of pixels.
struct DrawBand<'a> {
    reads: &'a Reads<'a>,
    /// Where a pixel is read, along x and along y.
    offsets: &'a [f64],
    first_row: usize,
    width_px: usize,
    pixels: &'a mut [[f32; 4]],
}

/// What is read.
struct Reads<'a> {
    resamplers: &'a [Resampler<'a>],
    rays: &'a IndexRays,
    /// Weight of a read.
    share: f32,
    /// Largest unassociated colour.
    peak: f32,
}

impl Kernel for DrawBand<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Self { reads, offsets, first_row, width_px, pixels } = self;
        // Parallel rays: positions are affine in the pixel.
        let parallel = match reads.resamplers {
            [only] if only.picture.plane.eye_w().is_none() => {
                Some((only, Affine::new(&only.picture.plane, reads.rays)))
            }
            _ => None,
        };
        for x in (0..width_px).step_by(BAND) {
            let columns = x..(x + BAND).min(width_px);
            let drawn = parallel.as_ref().map(|(only, affine)| {
                affine.drawn(only, columns.clone(), first_row..first_row + pixels.len() / width_px)
            });
            if drawn.is_some_and(Drawn::is_empty) {
                continue;
            }
            let look = !drawn.is_some_and(Drawn::is_full);
            for (k, row) in pixels.chunks_exact_mut(width_px).enumerate() {
                for x in columns.clone().step_by(LANES) {
                    let n = LANES.min(columns.end - x);
                    let at = |[dx, dy]: [f64; 2]| [x as f64 + dx, (first_row + k) as f64 + dy];
                    let seen = match &parallel {
                        Some((only, affine)) => reads.parallel(s, only, affine, offsets, at, look),
                        None => reads.perspective(s, offsets, n, at),
                    };
                    // The picture is only written to, and only where something is seen.
                    if let Some(seen) = seen {
                        put(s, &seen, &mut row[x..x + n]);
                    }
                }
            }
        }
    }
}

/// Writes as many of sixteen pixels as there is room for.
#[inline(always)]
fn put<S: Simd>(s: S, quads: &Quads<S>, pixels: &mut [[f32; 4]]) {
    let mut some = [[0.0; 4]; LANES];
    let all = pixels.first_chunk_mut().unwrap_or(&mut some);
    for (k, quad) in all.as_flattened_mut().as_chunks_mut().0.iter_mut().enumerate() {
        s.store(quads[k], quad);
    }
    if pixels.len() < LANES {
        pixels.copy_from_slice(&some[..pixels.len()]);
    }
}

impl Reads<'_> {
    /// The mean of the reads of sixteen pixels of a row; `None` where nothing can be seen. `at`: picture position of the
    /// first of them, by where a pixel is read. `look`: whether to look for that, where something may not be there.
    #[inline(always)]
    fn parallel<S: Simd>(
        &self,
        s: S,
        resampler: &Resampler<'_>,
        affine: &Affine,
        offsets: &[f64],
        at: impl Fn([f64; 2]) -> [f64; 2],
        look: bool,
    ) -> Option<Quads<S>> {
        let steps = [s.splat(affine.per_x.x as f32), s.splat(affine.per_x.y as f32)];
        let number = s.load(&NUMBERS);
        let mut sum = None;
        for dy in offsets {
            for dx in offsets {
                let [x, y] = at([*dx, *dy]);
                let at = affine.texel(x, y);
                let base = base_of(at);
                let begin = [s.splat((at.x - f64::from(base[0])) as f32), s.splat((at.y - f64::from(base[1])) as f32)];
                let positions = [s.add_mul(begin[0], steps[0], number), s.add_mul(begin[1], steps[1], number)];
                let read = resampler.read(s, base, positions, look.then_some(0..LANES), self.peak);
                if offsets.len() == 1 {
                    return read;
                }
                sum = self.sum(s, sum, read);
            }
        }
        sum
    }

    /// The same for rays from an eye; `n`: how many pixels there are.
    #[inline(always)]
    fn perspective<S: Simd>(
        &self,
        s: S,
        offsets: &[f64],
        n: usize,
        at: impl Fn([f64; 2]) -> [f64; 2],
    ) -> Option<Quads<S>> {
        let (resamplers, rays) = (self.resamplers, self.rays);
        let mut sum = None;
        for dy in offsets {
            for dx in offsets {
                let [x, y] = at([*dx, *dy]);
                // Runs of pixels of one base plane.
                let mut first = 0;
                while first < n {
                    let at = [x + first as f64, y];
                    let (family, n_of_it) = rays.families_along_x(at, n - first);
                    let lanes = first..first + n_of_it;
                    first = lanes.end;
                    let Some(resampler) = resamplers.iter().find(|r| r.picture.plane.family == family) else {
                        continue;
                    };
                    let texels = resampler.picture.plane.texels_from_pixels(rays, at);
                    let base = base_of(DVec2::new(texels[0][0], texels[1][0]));
                    // Those of other base planes see nothing of this one.
                    let mut positions = [[FAR; LANES]; 2];
                    for axis in 0..2 {
                        for (k, lane) in lanes.clone().enumerate() {
                            positions[axis][lane] = (texels[axis][k] - f64::from(base[axis])) as f32;
                        }
                    }
                    let positions = [s.load(&positions[0]), s.load(&positions[1])];
                    sum = self.sum(s, sum, resampler.read(s, base, positions, Some(lanes), self.peak));
                }
            }
        }
        sum
    }

    /// A sum of reads with one more.
    #[inline(always)]
    fn sum<S: Simd>(&self, s: S, sum: Option<Quads<S>>, read: Option<Quads<S>>) -> Option<Quads<S>> {
        let Some(mut quads) = read else { return sum };
        let share = s.splat(self.share);
        for k in 0..quads.len() {
            quads[k] = match &sum {
                Some(sum) => s.add_mul(sum[k], share, quads[k]),
                None => s.mul(share, quads[k]),
            };
        }
        Some(quads)
    }
}

/// Texel positions of parallel rays.
struct Affine {
    /// Of the first pixel's middle.
    origin: DVec2,
    per_x: DVec2,
    per_y: DVec2,
}

impl Affine {
    fn new(plane: &BasePlane, rays: &IndexRays) -> Self {
        let at = |x: f64, y: f64| plane.texel_from_pixel(rays, x, y);
        let origin = at(0.5, 0.5);
        let (per_x, per_y) = (snapped(at(1.5, 0.5) - origin), snapped(at(0.5, 1.5) - origin));
        Self { origin: snapped(origin), per_x, per_y }
    }

    /// What can be seen in some columns and rows of pixels.
    fn drawn(&self, resampler: &Resampler<'_>, columns: Range<usize>, rows: Range<usize>) -> Drawn {
        let [(x, last_x), (y, last_y)] = [columns, rows].map(|range| (range.start as f64, range.end as f64));
        let corners = [(x, y), (last_x, y), (x, last_y), (last_x, last_y)].map(|(x, y)| self.texel(x, y));
        let [first, others @ ..] = corners;
        let (lo, hi) = others.into_iter().fold((first, first), |(lo, hi), at| (lo.min(at), hi.max(at)));
        resampler.drawn_between(lo, hi)
    }

    #[inline(always)]
    fn texel(&self, x: f64, y: f64) -> DVec2 {
        self.origin + self.per_x * (x - 0.5) + self.per_y * (y - 0.5)
    }
}

/// The number of each lane.
const NUMBERS: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// The texel before a position, or one that is as far away as it gets.
fn base_of(at: DVec2) -> [i32; 2] {
    let limit = f64::from(FAR);
    [at.x, at.y].map(|x| x.floor().clamp(-limit, limit) as i32)
}

/// A position on a texel, but for rounding, is on it, so that the texel is read to the bit: multiples of 2^−30 texels.
fn snapped(texels: DVec2) -> DVec2 {
    const PER_TEXEL: f64 = (1 << 30) as f64;
    (texels * PER_TEXEL).round() / PER_TEXEL
}

/// `t` of `origin + t · direction` at opacity ½.
fn ray_parameter(resamplers: &[Resampler<'_>], rays: &IndexRays, x: f64, y: f64) -> f32 {
    let family = Family::of(rays.direction(x, y));
    let serving = resamplers.iter().find(|r| r.picture.plane.family == family);
    let Some(Resampler { picture, .. }) = serving else { return f32::NAN };
    let w = f64::from(picture.w_half(picture.plane.texel_from_pixel(rays, x, y)));
    let [_, _, origin_w] = picture.plane.family.uvw(rays.origin(x, y));
    let [_, _, direction_w] = picture.plane.family.uvw(rays.direction(x, y));
    ((w - origin_w) / direction_w) as f32
}
