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
use wavesplat_compute::simd::{Kernel, LANES, Lanes, Level, ROUND, Simd};

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

    /// Adds what is at up to sixteen texel positions to as many pixels, `share` of it, and no colour brighter than `peak`.
    /// `base`: whole texels, which the positions count from.
    #[inline(always)]
    fn add_to<S: Simd>(
        &self,
        s: S,
        base: [i32; 2],
        positions: [S::F; 2],
        pixels: &mut [[f32; 4]],
        share: f32,
        peak: f32,
    ) {
        let [n_u, n_v] = self.plane.size.map(|n| n as i32);
        let (mut place, mut within) = ([[0_i32; LANES]; 2], [s.splat(0.0); 2]);
        for axis in 0..2 {
            // What is not a number is far away, too.
            let x = s.max(s.min(positions[axis], s.splat(FAR)), s.splat(-FAR));
            // A whole position may count as the end of the texel before, which reads the same.
            let shifted = s.add(s.sub(x, s.splat(0.5)), s.splat(ROUND));
            within[axis] = s.sub(x, s.sub(shifted, s.splat(ROUND)));
            // The whole number stands in the last bits.
            let mut texels = [0.0_f32; LANES];
            s.store(shifted, &mut texels);
            let first = base[axis].wrapping_sub(ROUND.to_bits() as i32);
            for k in 0..LANES {
                place[axis][k] = first.wrapping_add(texels[k].to_bits() as i32);
            }
        }
        let mut weights = [[[0.0; LANES]; 4]; 2];
        for axis in 0..2 {
            let [w0, w1, w2, w3] = catmull_rom(s, within[axis]);
            s.store(w0, &mut weights[axis][0]);
            s.store(w1, &mut weights[axis][1]);
            s.store(w2, &mut weights[axis][2]);
            s.store(w3, &mut weights[axis][3]);
        }
        let [weights_u, weights_v] = &weights;
        let within = within.map(|within| {
            let mut t = [0.0; LANES];
            s.store(within, &mut t);
            t
        });
        let n_cells_u = (n_u as usize).div_ceil(LANES);
        let n_row = n_u as usize * 4;
        let texels = self.texels.as_flattened();
        for (k, pixel) in pixels.iter_mut().enumerate().take(LANES) {
            let (i, j) = (place[0][k], place[1][k]);
            if i < -1 || j < -1 || i >= n_u || j >= n_v {
                continue;
            }
            if !self.drawn[(j.max(0) as usize / CELL_V) * n_cells_u + i.max(0) as usize / LANES] {
                continue;
            }
            if i < 1 || j < 1 || i + 2 >= n_u || j + 2 >= n_v {
                let color = self.sample_near_border(i.into(), j.into(), within[0][k], within[1][k]);
                add(pixel, color, share, peak);
                continue;
            }
            // Four texels of a row are sixteen numbers: first down the columns, then across.
            let start = ((j - 1) as usize * n_u as usize + (i - 1) as usize) * 4;
            let row = |r: usize| texels.get(start + r * n_row..).and_then(|row| row.first_chunk::<LANES>());
            let (Some(first), Some(second), Some(third), Some(fourth)) = (row(0), row(1), row(2), row(3)) else {
                continue;
            };
            let (first, second, third, fourth) = (s.load(first), s.load(second), s.load(third), s.load(fourth));
            let (w0, w1) = (s.splat(weights_v[0][k]), s.splat(weights_v[1][k]));
            let (w2, w3) = (s.splat(weights_v[2][k]), s.splat(weights_v[3][k]));
            let down = s.add(s.add_mul(s.mul(w0, first), w1, second), s.add_mul(s.mul(w2, third), w3, fourth));
            let [mut columns, mut least, mut most] = [Lanes::default(); 3];
            s.store(down, &mut columns.0);
            s.store(s.min(second, third), &mut least.0);
            s.store(s.max(second, third), &mut most.0);
            let [a, b, c, d] = [quad::<0>(&columns), quad::<4>(&columns), quad::<8>(&columns), quad::<12>(&columns)];
            let sum = (weights_u[0][k] * a + weights_u[1][k] * b) + (weights_u[2][k] * c + weights_u[3][k] * d);
            let least = quad::<4>(&least).min(quad::<8>(&least));
            let most = quad::<4>(&most).max(quad::<8>(&most));
            add(pixel, sum.max(least).min(most), share, peak);
        }
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

/// Weights of the four texels around positions `t` of the way from the second to the third.
#[inline(always)]
fn catmull_rom<S: Simd>(s: S, t: S::F) -> [S::F; 4] {
    let (one, half) = (s.splat(1.0), s.splat(0.5));
    let w0 = s.mul(s.sub(s.mul(s.sub(one, s.mul(half, t)), t), half), t);
    let w1 = s.add(s.mul(s.mul(s.sub(s.mul(s.splat(1.5), t), s.splat(2.5)), t), t), one);
    let w3 = s.mul(s.mul(s.sub(s.mul(half, t), half), t), t);
    [w0, w1, s.sub(s.sub(s.sub(one, w0), w1), w3), w3]
}

/// Four numbers of sixteen, from one on.
#[inline(always)]
fn quad<const FIRST: usize>(numbers: &Lanes) -> Vec4 {
    let n = &numbers.0;
    Vec4::new(n[FIRST], n[FIRST + 1], n[FIRST + 2], n[FIRST + 3])
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
    fn run<S: Simd>(mut self, s: S) {
        // Parallel rays: positions are affine in the pixel.
        let parallel = match self.pictures {
            [only] if only.plane.eye_w().is_none() => Some((only, Affine::new(&only.plane, self.rays))),
            _ => None,
        };
        for x in (0..self.width_px).step_by(BAND) {
            let columns = x..(x + BAND).min(self.width_px);
            for k in 0..self.pixels.len() / self.width_px {
                for dy in self.offsets {
                    for dx in self.offsets {
                        let at = [*dx, (self.first_row + k) as f64 + dy];
                        match &parallel {
                            Some((only, affine)) => self.read_parallel(s, only, affine, at, k, columns.clone()),
                            None => self.read(s, at, k, columns.clone()),
                        }
                    }
                }
            }
        }
    }
}

impl ReadBand<'_> {
    /// A row's pixels in some columns.
    #[inline(always)]
    fn pixels(&mut self, row: usize, columns: Range<usize>) -> &mut [[f32; 4]] {
        &mut self.pixels[row * self.width_px..][columns]
    }

    /// Adds a read of every pixel of some columns of a row. `at`: picture position of that of the row's first pixel.
    #[inline(always)]
    fn read_parallel<S: Simd>(
        &mut self,
        s: S,
        picture: &BasePicture,
        affine: &Affine,
        [x0, y]: [f64; 2],
        row: usize,
        columns: Range<usize>,
    ) {
        let (share, peak) = (self.share, self.peak);
        let steps = [s.splat(affine.per_x.x as f32), s.splat(affine.per_x.y as f32)];
        let number = s.load(&NUMBERS);
        let first = columns.start;
        for (group, pixels) in self.pixels(row, columns).chunks_mut(LANES).enumerate() {
            let at = affine.texel((first + group * LANES) as f64 + x0, y);
            let base = base_of(at);
            let begin = [s.splat((at.x - f64::from(base[0])) as f32), s.splat((at.y - f64::from(base[1])) as f32)];
            let positions = [s.add_mul(begin[0], steps[0], number), s.add_mul(begin[1], steps[1], number)];
            picture.add_to(s, base, positions, pixels, share, peak);
        }
    }

    /// The same for any rays.
    #[inline(always)]
    fn read<S: Simd>(&mut self, s: S, [x0, y]: [f64; 2], row: usize, columns: Range<usize>) {
        let (pictures, rays, share, peak) = (self.pictures, self.rays, self.share, self.peak);
        // Runs of pixels of one base plane.
        let mut x = columns.start;
        while x < columns.end {
            let serving = |x: usize| serving(pictures, rays, x as f64 + x0, y);
            let Some(picture) = serving(x) else {
                x += 1;
                continue;
            };
            let end = columns.end.min(x + LANES);
            let same = |x: &usize| serving(*x).is_some_and(|other| std::ptr::eq(other, picture));
            let n = 1 + (x + 1..end).take_while(same).count();
            let at = |k: usize| picture.plane.texel_from_pixel(rays, (x + k) as f64 + x0, y);
            let base = base_of(at(0));
            let mut positions = [[0.0; LANES]; 2];
            for k in 0..n {
                let at = at(k);
                positions[0][k] = (at.x - f64::from(base[0])) as f32;
                positions[1][k] = (at.y - f64::from(base[1])) as f32;
            }
            let positions = [s.load(&positions[0]), s.load(&positions[1])];
            picture.add_to(s, base, positions, self.pixels(row, x..x + n), share, peak);
            x += n;
        }
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

    #[inline(always)]
    fn texel(&self, x: f64, y: f64) -> DVec2 {
        self.origin + self.per_x * (x - 0.5) + self.per_y * (y - 0.5)
    }
}

/// The number of each lane.
const NUMBERS: [f32; LANES] = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 14.0, 15.0];

/// Positions further from their base, texels, are outside every base plane that is near it.
const FAR: f32 = 1e6;

/// The texel before a position, or one that is as far away as it gets.
fn base_of(at: DVec2) -> [i32; 2] {
    let limit = f64::from(1 << 24);
    [at.x, at.y].map(|x| x.floor().clamp(-limit, limit) as i32)
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
