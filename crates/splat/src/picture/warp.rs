//! The warp of shear-warp, the one final resampling: base planes -> picture.
//!
//! Each pixel is served by the family of its own ray. Where the base plane is denser than the pixels, a pixel is the
//! mean of several reads, like several rays per pixel: supersampling with a box filter.

use std::ops::Range;

use glam::DVec2;
use wavesplat_compute::simd::{LANES, Level, Simd, VectorKernel};
use wavesplat_compute::{filled, parallel};

use crate::picture::base_picture::BasePicture;
use crate::picture::edges::{EdgePass, Edges};
use crate::picture::resample::{FAR, Quads, Resampler};
use crate::view::base_plane::BasePlane;
use crate::view::family::{Family, IndexRays};

/// The warped picture: colours, and the depth of opacity ½ where it is wanted.
pub struct Warped {
    /// Pixels in the layout of [`BasePicture::texels`].
    pub rgba: Vec<[f32; 4]>,
    /// Ray parameter, along each pixel's ray in index space, of opacity ½; NaN where not reached.
    pub ray_parameter: Option<Vec<f32>>,
}

/// Draws the picture. `peak`: largest unassociated colour. `edges`: the walls that cut the picture, if texels go on
/// beyond them.
#[expect(clippy::too_many_arguments, reason = "base planes, pixels, and how these are read")]
pub fn warp(
    level: Level,
    pictures: &[BasePicture],
    rays: &IndexRays,
    [width_px, height_px]: [usize; 2],
    reads_per_axis: usize,
    peak: f32,
    with_depth: bool,
    edges: Option<Edges>,
) -> Warped {
    let resamplers: Vec<_> = pictures.iter().map(Resampler::new).collect();
    let pass = edges.and_then(|edges| EdgePass::new(edges, &resamplers, rays, peak, level));
    let warping = Warping { resamplers: &resamplers, rays, reads_per_axis, peak, edges: pass };
    let rgba = filled::in_chunks(width_px * height_px, BAND * width_px, |band, pixels| {
        warping.draw_band(level, band * BAND, pixels, width_px);
    });
    let parameters = with_depth.then(|| {
        let mut parameter = vec![f32::NAN; width_px * height_px];
        parallel::for_each_chunk(&mut parameter, width_px, |y, row| {
            for (x, parameter) in row.iter_mut().enumerate() {
                *parameter = ray_parameter(&resamplers, rays, edges, x as f64 + 0.5, y as f64 + 0.5);
            }
        });
        parameter
    });
    Warped { rgba, ray_parameter: parameters }
}

/// Side of the blocks of pixels that are drawn together: rows of pixels are mostly oblique in the base plane, and
/// texels that one row has read are still in the cache when the next one reads them.
const BAND: usize = 32;

/// Input of the warp.
struct Warping<'a> {
    resamplers: &'a [Resampler<'a>],
    rays: &'a IndexRays,
    /// Reads of a pixel along x and along y; the pixel is their mean.
    reads_per_axis: usize,
    /// Largest unassociated colour.
    peak: f32,
    /// Draws pixels that walls pass through.
    edges: Option<EdgePass<'a>>,
}

impl<'a> Warping<'a> {
    /// Draws some rows of pixels.
    fn draw_band(&self, level: Level, first_row: usize, pixels: &mut [[f32; 4]], width_px: usize) {
        // Parallel rays: positions are affine in the pixel.
        let parallel = match self.resamplers {
            [only] if only.picture.plane.eye_w().is_none() => Some((only, Affine::new(&only.picture.plane, self.rays))),
            _ => None,
        };
        for x in (0..width_px).step_by(BAND) {
            let columns = x..(x + BAND).min(width_px);
            let rectangle = Rectangle { columns: columns.clone(), first_row, pixels, width_px };
            let is_drawn = if let Some((only, affine)) = &parallel {
                self.draw_one(level, rectangle, only, affine)
            } else if let Some(family) = self.rays.family_of_all(&rectangle.corners()) {
                self.resampler(family).is_some_and(|resampler| {
                    let slopes = Slopes { plane: &resampler.picture.plane, rays: self.rays };
                    self.draw_one(level, rectangle, resampler, &slopes)
                })
            } else {
                level.dispatch(Draw { warping: self, source: Mixed { warping: self }, rectangle });
                true
            };
            if let Some(edges) = self.edges.as_ref().filter(|_| is_drawn) {
                let size = [columns.len(), pixels.len() / width_px];
                edges.draw([x, first_row], size, &mut pixels[x..], width_px);
            }
        }
    }

    /// Draws pixels that one base plane serves; returns whether any texel that they read has been drawn.
    fn draw_one<M: Map>(&self, level: Level, rectangle: Rectangle<'_>, resampler: &Resampler<'_>, map: &M) -> bool {
        let [first, others @ ..] = rectangle.corners().map(|[x, y]| map.texel(x, y));
        let (lo, hi) = others.into_iter().fold((first, first), |(lo, hi), at| (lo.min(at), hi.max(at)));
        let drawn = resampler.drawn_between(lo, hi);
        if !drawn.is_empty() {
            let source = OnePlane { resampler, map, look: !drawn.is_full() };
            level.dispatch(Draw { warping: self, source, rectangle });
        }
        !drawn.is_empty()
    }

    /// The reader of a family's base plane; `None` where the family has none.
    fn resampler(&self, family: Family) -> Option<&'a Resampler<'a>> {
        self.resamplers.iter().find(|r| r.picture.plane.family == family)
    }
}

/// A rectangle of pixels, in some rows of the picture.
struct Rectangle<'a> {
    /// Columns of the rectangle.
    columns: Range<usize>,
    /// Row of the picture at which `pixels` begins.
    first_row: usize,
    /// Whole rows of pixels.
    pixels: &'a mut [[f32; 4]],
    /// Pixels per row.
    width_px: usize,
}

impl Rectangle<'_> {
    /// Corners of the rectangle, as pixel positions.
    fn corners(&self) -> [[f64; 2]; 4] {
        let n_rows = self.pixels.len() / self.width_px;
        let [x, last_x] = [self.columns.start, self.columns.end].map(|edge| edge as f64);
        let [y, last_y] = [self.first_row, self.first_row + n_rows].map(|edge| edge as f64);
        [[x, y], [last_x, y], [x, last_y], [last_x, last_y]]
    }
}

/// Vector kernel that draws a rectangle.
struct Draw<'a, R> {
    warping: &'a Warping<'a>,
    source: R,
    rectangle: Rectangle<'a>,
}

impl<R: PixelSource> VectorKernel for Draw<'_, R> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Self { warping, source, rectangle } = self;
        draw_means(
            s,
            warping.reads_per_axis,
            rectangle,
            #[inline(always)]
            |at, n| source.read(s, at, n, warping.peak),
        );
    }
}

/// Draws pixels as means of `per_axis` by `per_axis` reads.
#[inline(always)]
fn draw_means<S: Simd>(
    s: S,
    per_axis: usize,
    rectangle: Rectangle<'_>,
    read: impl Fn([f64; 2], usize) -> Option<Quads<S>>,
) {
    let Rectangle { columns, first_row, pixels, width_px } = rectangle;
    for (k, row) in pixels.chunks_exact_mut(width_px).enumerate() {
        for x in columns.clone().step_by(LANES) {
            let n = LANES.min(columns.end - x);
            // The picture is only written to, and only where something is seen.
            if let Some(seen) = mean(s, per_axis, &read, [x, first_row + k], n) {
                put(s, &seen, &mut row[x..x + n]);
            }
        }
    }
}

/// The mean of the reads of sixteen pixels of a row; `None` where nothing can be seen. `n`: the pixels that are wanted.
#[inline(always)]
fn mean<S: Simd>(
    s: S,
    per_axis: usize,
    read: &impl Fn([f64; 2], usize) -> Option<Quads<S>>,
    [x, y]: [usize; 2],
    n: usize,
) -> Option<Quads<S>> {
    let share = s.splat(1.0 / (per_axis * per_axis) as f32);
    let within = |pixel: usize, k: usize| pixel as f64 + (k as f64 + 0.5) / per_axis as f64;
    let mut sum = None;
    for k in 0..per_axis * per_axis {
        let read = read([within(x, k % per_axis), within(y, k / per_axis)], n);
        if per_axis == 1 {
            return read;
        }
        sum = add(s, sum, share, read);
    }
    sum
}

/// Writes the first of sixteen pixels, up to the length of `pixels`.
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

/// A sum of reads plus one more read times `share`.
#[inline(always)]
fn add<S: Simd>(s: S, sum: Option<Quads<S>>, share: S::F, read: Option<Quads<S>>) -> Option<Quads<S>> {
    let Some(mut quads) = read else { return sum };
    for k in 0..quads.len() {
        quads[k] = match &sum {
            Some(sum) => s.add_mul(sum[k], share, quads[k]),
            None => s.mul(share, quads[k]),
        };
    }
    Some(quads)
}

/// Source of the pixels of a row.
trait PixelSource {
    /// Sixteen pixels of a row, the first of them at a picture position; `None` where nothing can be seen. `n`: the
    /// pixels that are wanted.
    fn read<S: Simd>(&self, s: S, at: [f64; 2], n: usize, peak: f32) -> Option<Quads<S>>;
}

/// Source of pixels that one base plane serves.
struct OnePlane<'a, M> {
    resampler: &'a Resampler<'a>,
    map: &'a M,
    /// Whether parts of the base plane may be empty, so that reads check for it.
    look: bool,
}

impl<M: Map> PixelSource for OnePlane<'_, M> {
    #[inline(always)]
    fn read<S: Simd>(&self, s: S, at: [f64; 2], n: usize, peak: f32) -> Option<Quads<S>> {
        let (base, positions) = self.map.positions(s, at);
        self.resampler.read(s, base, positions, 0..n, self.look, peak)
    }
}

/// Source of pixels that are served by the base planes of their own rays.
struct Mixed<'a> {
    warping: &'a Warping<'a>,
}

impl PixelSource for Mixed<'_> {
    #[inline(always)]
    fn read<S: Simd>(&self, s: S, [x, y]: [f64; 2], n: usize, peak: f32) -> Option<Quads<S>> {
        let warping = self.warping;
        let mut sum = None;
        // Runs of pixels of one base plane.
        let mut first = 0;
        while first < n {
            let (family, n_of_it) = warping.rays.families_along_x([x + first as f64, y], n - first);
            let lanes = first..first + n_of_it;
            first = lanes.end;
            let Some(resampler) = warping.resampler(family) else { continue };
            let texels = resampler.picture.plane.texels_from_pixels(warping.rays, [x, y]);
            let base = base_of(DVec2::new(texels[0][lanes.start], texels[1][lanes.start]));
            // Lanes of other base planes get positions far outside this one, and read nothing.
            let mut positions = [[FAR; LANES]; 2];
            for axis in 0..2 {
                for lane in lanes.clone() {
                    positions[axis][lane] = (texels[axis][lane] - f64::from(base[axis])) as f32;
                }
            }
            let positions = [s.load(&positions[0]), s.load(&positions[1])];
            sum = add(s, sum, s.splat(1.0), resampler.read(s, base, positions, lanes, true, peak));
        }
        sum
    }
}

/// Map from pixel positions to texel positions.
trait Map {
    /// Texel position of one pixel position.
    fn texel(&self, x: f64, y: f64) -> DVec2;
    /// Texel positions of sixteen pixel positions of a row, relative to a base of whole texels.
    fn positions<S: Simd>(&self, s: S, at: [f64; 2]) -> ([i32; 2], [S::F; 2]);
}

/// The map of parallel rays, which is affine.
struct Affine {
    /// Texel position of the first pixel's middle.
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
}

impl Map for Affine {
    #[inline(always)]
    fn texel(&self, x: f64, y: f64) -> DVec2 {
        self.origin + self.per_x * (x - 0.5) + self.per_y * (y - 0.5)
    }

    #[inline(always)]
    fn positions<S: Simd>(&self, s: S, [x, y]: [f64; 2]) -> ([i32; 2], [S::F; 2]) {
        let at = self.texel(x, y);
        let base = base_of(at);
        let begin = [s.splat((at.x - f64::from(base[0])) as f32), s.splat((at.y - f64::from(base[1])) as f32)];
        let steps = [s.splat(self.per_x.x as f32), s.splat(self.per_x.y as f32)];
        let number = s.load(&NUMBERS);
        (base, [s.add_mul(begin[0], steps[0], number), s.add_mul(begin[1], steps[1], number)])
    }
}

/// The map of rays from an eye, which is projective.
struct Slopes<'a> {
    plane: &'a BasePlane,
    rays: &'a IndexRays,
}

impl Map for Slopes<'_> {
    fn texel(&self, x: f64, y: f64) -> DVec2 {
        self.plane.texel_from_pixel(self.rays, x, y)
    }

    #[inline(always)]
    fn positions<S: Simd>(&self, s: S, at: [f64; 2]) -> ([i32; 2], [S::F; 2]) {
        let texels = self.plane.texels_from_pixels(self.rays, at);
        let base = base_of(DVec2::new(texels[0][0], texels[1][0]));
        let mut positions = [[0.0; LANES]; 2];
        for axis in 0..2 {
            for k in 0..LANES {
                positions[axis][k] = (texels[axis][k] - f64::from(base[axis])) as f32;
            }
        }
        (base, [s.load(&positions[0]), s.load(&positions[1])])
    }
}

/// The number of each lane.
const NUMBERS: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// The texel before a position, clamped to ±[`FAR`].
fn base_of(at: DVec2) -> [i32; 2] {
    let limit = f64::from(FAR);
    [at.x, at.y].map(|x| x.floor().clamp(-limit, limit) as i32)
}

/// Rounds to multiples of 2^−30 texels: a position on a texel, but for rounding, is then on it, and reads it to the
/// bit.
fn snapped(texels: DVec2) -> DVec2 {
    const PER_TEXEL: f64 = (1 << 30) as f64;
    (texels * PER_TEXEL).round() / PER_TEXEL
}

/// Ray parameter `t` of `origin + t · direction` at opacity ½; NaN where it is not reached.
fn ray_parameter(resamplers: &[Resampler<'_>], rays: &IndexRays, edges: Option<Edges>, x: f64, y: f64) -> f32 {
    let family = Family::of(rays.direction(x, y));
    let serving = resamplers.iter().find(|r| r.picture.plane.family == family);
    let Some(Resampler { picture, .. }) = serving else { return f32::NAN };
    let w = f64::from(picture.w_half(picture.plane.texel_from_pixel(rays, x, y)));
    let is_parallel = picture.plane.eye_w().is_none();
    if w.is_nan() || edges.is_some_and(|edges| !edges.silhouette.is_met(rays, is_parallel, [x, y])) {
        return f32::NAN;
    }
    let [_, _, origin_w] = picture.plane.family.uvw(rays.origin(x, y));
    let [_, _, direction_w] = picture.plane.family.uvw(rays.direction(x, y));
    ((w - origin_w) / direction_w) as f32
}
