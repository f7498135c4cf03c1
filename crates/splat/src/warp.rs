//! The one final resampling: base planes -> picture.
//!
//! Each pixel is served by the family of its own ray. The base plane is read with the Catmull-Rom cubic (Keys 1981),
//! which keeps what the base plane resolves, clamped to the texels around the position so that edges do not ring, and
//! to the brightest colour that its opacity can have.
//! Where the base plane is denser than the pixels, a pixel is the mean of several such reads: a box filter, as many
//! rays per pixel would give. Where nothing was drawn, nothing is read.

use std::ops::Range;

use glam::{DVec2, Vec4};
use wavesplat_compute::parallel;
use wavesplat_compute::simd::{Kernel, LANES, Lanes, Level, Simd};

use crate::base_plane::{BasePlane, Family, IndexRays};

/// Rows of texels that share an entry of [`BasePicture::drawn`]; along u they are [`LANES`].
const CELL_V: usize = 8;

/// A finished base plane.
pub struct BasePicture {
    /// Its layout.
    pub plane: BasePlane,
    /// Rows of texels: associated RGBA; projections: density, length of the path, 0, coverage.
    pub texels: Vec<[f32; 4]>,
    /// w of opacity ½ of each texel, NaN where it is not reached; empty where no depth is wanted.
    pub w_half: Vec<f32>,
    /// Cells of texels that have been drawn in, or have a neighbour that was.
    drawn: Vec<bool>,
}

impl BasePicture {
    /// Nothing drawn.
    pub fn new(plane: BasePlane, with_depth: bool) -> Self {
        let [n_u, n_v] = plane.size;
        let cells = Self::cells(&plane);
        Self {
            plane,
            texels: vec![[0.0; 4]; n_u * n_v],
            w_half: vec![f32::NAN; if with_depth { n_u * n_v } else { 0 }],
            drawn: vec![false; cells[0] * cells[1]],
        }
    }

    fn cells(plane: &BasePlane) -> [usize; 2] {
        [plane.size[0].div_ceil(LANES), plane.size[1].div_ceil(CELL_V)]
    }

    /// Puts the texels of a chunk, with `w_half`, in their place; those beyond the base plane are left out, and so is
    /// a chunk of which nothing is seen.
    pub fn put(&mut self, i: usize, j: usize, chunk: &[[f32; 4]; LANES], w_half: Option<&[f32; LANES]>) {
        if chunk.iter().all(|rgba| rgba[3] == 0.0) {
            return;
        }
        let [n_u, _] = self.plane.size;
        let n = LANES.min(n_u - i);
        self.texels[j * n_u + i..][..n].copy_from_slice(&chunk[..n]);
        if let (Some(w_half), false) = (w_half, self.w_half.is_empty()) {
            self.w_half[j * n_u + i..][..n].copy_from_slice(&w_half[..n]);
        }
        // The filter reaches two texels further.
        let [n_cells_u, n_cells_v] = Self::cells(&self.plane);
        let (u, v) = (i / LANES, j / CELL_V);
        for v in v.saturating_sub(1)..(v + 2).min(n_cells_v) {
            self.drawn[v * n_cells_u + u.saturating_sub(1)..v * n_cells_u + (u + 2).min(n_cells_u)].fill(true);
        }
    }

    fn texel(&self, i: i64, j: i64) -> Option<usize> {
        let [n_u, n_v] = self.plane.size;
        let inside = i >= 0 && j >= 0 && (i as usize) < n_u && (j as usize) < n_v;
        inside.then(|| j as usize * n_u + i as usize)
    }

    /// Colour at a texel position; `None` where nothing is.
    #[inline(always)]
    fn sample<S: Simd>(&self, s: S, u: f64, v: f64) -> Option<Vec4> {
        let [n_u, n_v] = self.plane.size.map(|n| n as i64);
        // Truncation rounds down, since positions are kept above 0.
        let (i, j) = ((u + 2.0) as i64 - 2, (v + 2.0) as i64 - 2);
        if !(u >= -1.0 && v >= -1.0) || i >= n_u || j >= n_v {
            return None;
        }
        let (fu, fv) = ((u - i as f64) as f32, (v - j as f64) as f32);
        let cell = (j.max(0) as usize / CELL_V) * (n_u as usize).div_ceil(LANES) + i.max(0) as usize / LANES;
        if !self.drawn[cell] {
            return None;
        }
        if i < 1 || j < 1 || i + 2 >= n_u || j + 2 >= n_v {
            return Some(self.sample_near_border(i, j, fu, fv));
        }
        let start = (j - 1) as usize * n_u as usize + (i - 1) as usize;
        // Four texels of a row are sixteen numbers: first down the columns, then across.
        let n_row = n_u as usize * 4;
        let rows = self.texels.as_flattened().get(start * 4..start * 4 + 3 * n_row + LANES)?;
        let row = |r: usize| rows[r * n_row..].first_chunk::<LANES>();
        let (first, second, third, fourth) = (s.load(row(0)?), s.load(row(1)?), s.load(row(2)?), s.load(row(3)?));
        let [w0, w1, w2, w3] = catmull_rom(fv);
        let (w0, w1, w2, w3) = (s.splat(w0), s.splat(w1), s.splat(w2), s.splat(w3));
        let down = s.add(s.add_mul(s.mul(w0, first), w1, second), s.add_mul(s.mul(w2, third), w3, fourth));
        let [a, b, c, d] = quads(s, down);
        let wu = catmull_rom(fu);
        let sum = (wu[0] * a + wu[1] * b) + (wu[2] * c + wu[3] * d);
        let ([_, lo, lo_next, _], [_, hi, hi_next, _]) =
            (quads(s, s.min(second, third)), quads(s, s.max(second, third)));
        Some(sum.max(lo.min(lo_next)).min(hi.max(hi_next)))
    }

    /// Linear, with emptiness beyond the grid.
    fn sample_near_border(&self, i: i64, j: i64, fu: f32, fv: f32) -> Vec4 {
        let mut sum = Vec4::ZERO;
        for (dj, wv) in [(0, 1.0 - fv), (1, fv)] {
            for (di, wu) in [(0, 1.0 - fu), (1, fu)] {
                if let Some(texel) = self.texel(i + di, j + dj) {
                    sum += wu * wv * Vec4::from_array(self.texels[texel]);
                }
            }
        }
        sum
    }

    /// w of opacity ½ at a texel position: linear where the four texels around it lie on one surface.
    fn w_half(&self, position: DVec2) -> f32 {
        /// Slice distances within which neighbouring texels count as one surface.
        const ONE_SURFACE: f32 = 2.0;
        let floor = position.floor();
        let (i, j) = (floor.x as i64, floor.y as i64);
        let at = |i: i64, j: i64| self.texel(i, j).map_or(f32::NAN, |t| self.w_half[t]);
        let corners = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
        let lo = corners.iter().copied().fold(f32::INFINITY, f32::min);
        let hi = corners.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        if corners.iter().any(|w| w.is_nan()) || hi - lo > ONE_SURFACE {
            let nearest = position.round();
            return at(nearest.x as i64, nearest.y as i64);
        }
        let (tu, tv) = ((position.x - floor.x) as f32, (position.y - floor.y) as f32);
        let near = corners[0] + tu * (corners[1] - corners[0]);
        let far = corners[2] + tu * (corners[3] - corners[2]);
        near + tv * (far - near)
    }
}

/// Weights of the four texels around a position `t` of the way from the second to the third.
#[inline(always)]
fn catmull_rom(t: f32) -> [f32; 4] {
    let w0 = ((-0.5 * t + 1.0) * t - 0.5) * t;
    let w1 = (1.5 * t - 2.5) * t * t + 1.0;
    let w3 = (0.5 * t - 0.5) * t * t;
    [w0, w1, 1.0 - w0 - w1 - w3, w3]
}

/// Sixteen numbers as four fours.
#[inline(always)]
fn quads<S: Simd>(s: S, numbers: S::F) -> [Vec4; 4] {
    let mut out = Lanes::default();
    s.store(numbers, &mut out.0);
    std::array::from_fn(|k| Vec4::from_slice(&out.0[4 * k..]))
}

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
    parallel::for_each_chunk(&mut rgba, BAND * width_px, |band, pixels| {
        let first_row = band * BAND;
        level.dispatch(ReadBand { pictures, rays, first_row, width_px, offsets: &offsets, share, peak, pixels });
    });
    let parameters = with_depth.then(|| {
        let mut parameter = vec![f32::NAN; width_px * height_px];
        parallel::for_each_chunk(&mut parameter, width_px, |y, row| {
            for (x, parameter) in row.iter_mut().enumerate() {
                *parameter = ray_parameter(pictures, rays, x as f64 + 0.5, y as f64 + 0.5);
            }
        });
        parameter
    });
    Warped { rgba, ray_parameter: parameters }
}

/// Rows of pixels that are warped together, so many columns at a time: rows of pixels mostly lie aslant in the base
/// plane, and what one has read is near when the next one wants it.
const BAND: usize = 32;

/// Adds all reads of some rows of pixels.
struct ReadBand<'a> {
    pictures: &'a [BasePicture],
    rays: &'a IndexRays,
    first_row: usize,
    width_px: usize,
    /// Where a pixel is read, along x and along y.
    offsets: &'a [f64],
    /// Weight of a read.
    share: f32,
    /// Largest unassociated colour.
    peak: f32,
    pixels: &'a mut [[f32; 4]],
}

impl Kernel for ReadBand<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Self { pictures, rays, first_row, width_px, offsets, share, peak, pixels } = self;
        for x in (0..width_px).step_by(BAND) {
            let columns = x..(x + BAND).min(width_px);
            for (k, row) in pixels.chunks_exact_mut(width_px).enumerate() {
                for dy in offsets {
                    for dx in offsets {
                        let position = [*dx, (first_row + k) as f64 + dy];
                        let reads = Reads { pictures, rays, position, share, peak };
                        reads.add_to(s, row, columns.clone());
                    }
                }
            }
        }
    }
}

/// One read of every pixel of a row.
struct Reads<'a> {
    pictures: &'a [BasePicture],
    rays: &'a IndexRays,
    /// Picture position of the first pixel's read.
    position: [f64; 2],
    /// Weight of the read.
    share: f32,
    /// Largest unassociated colour.
    peak: f32,
}

impl Reads<'_> {
    /// Adds the reads of some columns.
    #[inline(always)]
    fn add_to<S: Simd>(&self, s: S, row: &mut [[f32; 4]], columns: Range<usize>) {
        let Self { pictures, rays, position: [x0, y], share, peak } = *self;
        let pixels = columns.clone().zip(&mut row[columns]);
        match pictures {
            // Parallel rays: positions are affine in the pixel.
            [only] if only.plane.eye_w().is_none() => {
                let first = only.plane.texel_from_pixel(rays, x0, y);
                let step = snapped(only.plane.texel_from_pixel(rays, x0 + 1.0, y) - first);
                let first = snapped(first);
                for (x, pixel) in pixels {
                    let (u, v) = (first.x + step.x * x as f64, first.y + step.y * x as f64);
                    if let Some(color) = only.sample(s, u, v) {
                        add(pixel, color, share, peak);
                    }
                }
            }
            _ => {
                for (x, pixel) in pixels {
                    let x = x as f64 + x0;
                    if let Some(picture) = serving(pictures, rays, x, y) {
                        let position = picture.plane.texel_from_pixel(rays, x, y);
                        if let Some(color) = picture.sample(s, position.x, position.y) {
                            add(pixel, color, share, peak);
                        }
                    }
                }
            }
        }
    }
}

/// A position on a texel, but for rounding, is on it, so that the texel is read to the bit: multiples of 2^−30 texels.
fn snapped(texels: DVec2) -> DVec2 {
    const PER_TEXEL: f64 = (1 << 30) as f64;
    (texels * PER_TEXEL).round() / PER_TEXEL
}

#[inline(always)]
fn add(pixel: &mut [f32; 4], color: Vec4, share: f32, peak: f32) {
    let brightest = Vec4::new(peak, peak, peak, 1.0) * color.w;
    *pixel = (Vec4::from_array(*pixel) + share * color.min(brightest)).to_array();
}

#[inline(always)]
fn serving<'a>(pictures: &'a [BasePicture], rays: &IndexRays, x: f64, y: f64) -> Option<&'a BasePicture> {
    match pictures {
        [] => None,
        [only] if only.plane.eye_w().is_none() => Some(only),
        _ => {
            let family = Family::of(rays.direction(x, y));
            pictures.iter().find(|p| p.plane.family == family)
        }
    }
}

/// `t` of `origin + t · direction` at opacity ½.
fn ray_parameter(pictures: &[BasePicture], rays: &IndexRays, x: f64, y: f64) -> f32 {
    let Some(picture) = serving(pictures, rays, x, y) else { return f32::NAN };
    let w = f64::from(picture.w_half(picture.plane.texel_from_pixel(rays, x, y)));
    let [_, _, origin_w] = picture.plane.family.uvw(rays.origin(x, y));
    let [_, _, direction_w] = picture.plane.family.uvw(rays.direction(x, y));
    ((w - origin_w) / direction_w) as f32
}
