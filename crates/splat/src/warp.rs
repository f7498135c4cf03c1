//! The one final resampling: base planes -> picture.
//!
//! Each pixel is served by the family of its own ray. The base plane is read with the Catmull-Rom cubic (Keys 1981),
//! which keeps what the base plane resolves, clamped to the texels around the position so that edges do not ring, and
//! to the brightest colour that its opacity can have.
//! Where the base plane is denser than the pixels, a pixel is the mean of several such reads: a box filter, as many
//! rays per pixel would give.

use glam::DVec2;

use crate::base_plane::{BasePlane, Family, IndexRays};
use crate::composite::Texel;
use crate::parallel;

/// A finished base plane.
pub struct BasePicture {
    /// Its layout.
    pub plane: BasePlane,
    /// Rows of texels.
    pub texels: Vec<Texel>,
}

impl BasePicture {
    fn texel(&self, i: i64, j: i64) -> Option<&Texel> {
        let [n_u, n_v] = self.plane.size;
        let inside = i >= 0 && j >= 0 && (i as usize) < n_u && (j as usize) < n_v;
        inside.then(|| &self.texels[j as usize * n_u + i as usize])
    }

    /// Colour at a texel position.
    fn sample(&self, position: DVec2) -> [f32; 4] {
        let floor = position.floor();
        let [i, j] = [floor.x as i64, floor.y as i64];
        let [n_u, n_v] = self.plane.size.map(|n| n as i64);
        if i < 1 || j < 1 || i + 2 >= n_u || j + 2 >= n_v {
            return self.sample_near_border(i, j, position - floor);
        }
        let (wu, wv) = (catmull_rom(position.x - floor.x), catmull_rom(position.y - floor.y));
        let start = (j - 1) as usize * n_u as usize + (i - 1) as usize;
        let mut sum = [0.0_f32; 4];
        let mut lo = [f32::INFINITY; 4];
        let mut hi = [f32::NEG_INFINITY; 4];
        for (r, wv) in wv.iter().enumerate() {
            let row = &self.texels[start + r * n_u as usize..][..4];
            let mut line = [0.0_f32; 4];
            for (texel, wu) in row.iter().zip(wu) {
                for c in 0..4 {
                    line[c] += wu * texel.rgba[c];
                }
            }
            for c in 0..4 {
                sum[c] += wv * line[c];
            }
            if r == 1 || r == 2 {
                for texel in &row[1..3] {
                    for c in 0..4 {
                        lo[c] = lo[c].min(texel.rgba[c]);
                        hi[c] = hi[c].max(texel.rgba[c]);
                    }
                }
            }
        }
        std::array::from_fn(|c| sum[c].max(lo[c]).min(hi[c]))
    }

    /// Linear, with emptiness beyond the grid.
    fn sample_near_border(&self, i: i64, j: i64, fraction: DVec2) -> [f32; 4] {
        let (fu, fv) = (fraction.x as f32, fraction.y as f32);
        let mut sum = [0.0_f32; 4];
        for (dj, wv) in [(0, 1.0 - fv), (1, fv)] {
            for (di, wu) in [(0, 1.0 - fu), (1, fu)] {
                if let Some(texel) = self.texel(i + di, j + dj) {
                    for c in 0..4 {
                        sum[c] += wu * wv * texel.rgba[c];
                    }
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
        let at = |i: i64, j: i64| self.texel(i, j).map_or(f32::NAN, |t| t.w_half);
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

fn catmull_rom(t: f64) -> [f32; 4] {
    let w = |x: f64| crate::kernel::weight(wavesplat_core::Kernel::CatmullRom, x) as f32;
    [w(t + 1.0), w(t), w(1.0 - t), w(2.0 - t)]
}

/// A pixel of the warped picture: colour, and (base plane, w) of opacity ½.
pub struct Warped {
    /// As [`Texel::rgba`].
    pub rgba: Vec<[f32; 4]>,
    /// Index-space position along the pixel's ray of opacity ½, as the ray's parameter; NaN where not reached.
    pub ray_parameter: Option<Vec<f32>>,
}

/// Draws the picture. `reads_per_axis`: reads per pixel along x and along y. `peak`: largest unassociated colour.
pub fn warp(
    pictures: &[BasePicture],
    rays: &IndexRays,
    [width_px, height_px]: [usize; 2],
    reads_per_axis: usize,
    peak: f32,
    with_depth: bool,
) -> Warped {
    let rows = parallel::map(height_px, |y| {
        let mut rgba = vec![[0.0_f32; 4]; width_px];
        let mut parameter = vec![f32::NAN; if with_depth { width_px } else { 0 }];
        let share = 1.0 / (reads_per_axis * reads_per_axis) as f32;
        let offsets: Vec<f64> = (0..reads_per_axis).map(|s| (s as f64 + 0.5) / reads_per_axis as f64).collect();
        for (x, pixel) in rgba.iter_mut().enumerate() {
            for dy in &offsets {
                for dx in &offsets {
                    let (px, py) = (x as f64 + dx, y as f64 + dy);
                    if let Some(picture) = serving(pictures, rays, px, py) {
                        let colour = picture.sample(picture.plane.texel_from_pixel(rays, px, py));
                        for c in 0..3 {
                            pixel[c] += share * colour[c].min(peak * colour[3]);
                        }
                        pixel[3] += share * colour[3];
                    }
                }
            }
            if with_depth {
                parameter[x] = ray_parameter(pictures, rays, x as f64 + 0.5, y as f64 + 0.5);
            }
        }
        (rgba, parameter)
    });
    let mut warped = Warped { rgba: Vec::with_capacity(width_px * height_px), ray_parameter: None };
    let mut parameters = Vec::new();
    for (rgba, parameter) in rows {
        warped.rgba.extend(rgba);
        parameters.extend(parameter);
    }
    warped.ray_parameter = with_depth.then_some(parameters);
    warped
}

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
