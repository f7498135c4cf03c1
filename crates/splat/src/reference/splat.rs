//! High-resolution splatting, sample by sample, in double precision, as the method's pseudo-code has it:
//!
//! ```text
//! for each sheet, front to back
//!     clear the sheet buffer
//!     for each slice within the kernel's radius
//!         for each sample of the slice
//!             splat the sample's density with its footprint
//!     for each texel of the sheet buffer
//!         look up colour and opacity; correct the opacity for the slab's thickness along the ray; shade
//!     composite the sheet buffer into the picture (over)
//! ```
//!
//! Two forms. [`base_plane`] has the texels of the fast path (those of each sheet on the same rays) and takes the
//! gradient from difference footprints: the fast path must equal it to rounding. [`image`] is the original: one
//! buffer layout for all sheets, the gradient from three consecutive sheet buffers, and every sheet resampled on its
//! way to the picture as a texture on its polygon. Source: "High Resolution Image Splatting", IJACEN 2(7), 2014.

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_core::{Camera, Picture, RenderOptions, Result, TransferFunction, Volume};

use super::raycast::Sampler;
use crate::base_plane::{BasePlane, IndexRays, base_planes};
use crate::interval::Region;
use crate::kernel::{MAX_TAPS, fold, n_taps, taps};
use crate::slices::Slices;
use crate::tile::SheetSpacing;

/// A sheet buffer: one density per texel.
struct SheetBuffer {
    n_u: usize,
    density: Vec<f64>,
}

/// Where the texels of a sheet lie: index coordinate of texel 0 and change per texel, along u and v.
type Layout = [(f64, f64); 2];

/// Which footprint is splatted along one axis.
#[derive(Clone, Copy, PartialEq)]
enum Footprint {
    /// h(x − l)
    Value,
    /// [h(x + d − l) − h(x − d − l)] / 2d
    Difference(f64),
}

struct Splatter<'a> {
    slices: &'a Slices<'a>,
    size: [usize; 3],
    axes: [usize; 3],
}

impl Splatter<'_> {
    /// Weight of every sample of `axis` at a position: dense and slow, so that nothing can be misplaced.
    fn weights(&self, axis: usize, x: f64, footprint: Footprint) -> Vec<f64> {
        let n = self.size[axis];
        let last = (n - 1) as f64;
        let kernel = self.slices.kernel();
        let mut weights = vec![0.0; n];
        let mut add = |x: f64, factor: f64| {
            let (first, w): (i64, [f64; MAX_TAPS]) = taps(kernel, x.clamp(0.0, last));
            for (t, w) in w[..n_taps(kernel)].iter().enumerate() {
                weights[fold(kernel, first + t as i64, n)] += factor * w;
            }
        };
        match footprint {
            Footprint::Value => add(x, 1.0),
            Footprint::Difference(d) => {
                let x = x.clamp(0.0, last);
                add(x + d, 0.5 / d);
                add(x - d, -0.5 / d);
            }
        }
        weights
    }

    /// Clears a buffer and splats every sample that reaches the sheet at `w`.
    fn sheet(&self, layout: Layout, size: [usize; 2], w: f64, footprints: [Footprint; 3]) -> SheetBuffer {
        let [u, v, through] = self.axes;
        let table = |axis: usize, (origin, step): (f64, f64), n: usize, footprint: Footprint| -> Vec<Vec<f64>> {
            (0..n).map(|i| self.weights(axis, origin + step * i as f64, footprint)).collect()
        };
        let table_u = table(u, layout[0], size[0], footprints[0]);
        let table_v = table(v, layout[1], size[1], footprints[1]);
        let mut buffer = SheetBuffer { n_u: size[0], density: vec![0.0; size[0] * size[1]] };
        for (slice, slice_weight) in self.weights(through, w, footprints[2]).into_iter().enumerate() {
            if slice_weight == 0.0 {
                continue;
            }
            for sample_v in 0..self.size[v] {
                let rows: Vec<usize> = (0..size[1]).filter(|&j| table_v[j][sample_v] != 0.0).collect();
                if rows.is_empty() {
                    continue;
                }
                for sample_u in 0..self.size[u] {
                    let mut index = [0; 3];
                    (index[u], index[v], index[through]) = (sample_u, sample_v, slice);
                    let density = self.slices.at(index) * slice_weight;
                    for i in (0..size[0]).filter(|&i| table_u[i][sample_u] != 0.0) {
                        for &j in &rows {
                            buffer.density[j * size[0] + i] += density * table_u[i][sample_u] * table_v[j][sample_v];
                        }
                    }
                }
            }
        }
        buffer
    }
}

/// Associated RGBA of every texel of a base plane, before the warp; difference footprints for the gradient.
pub fn base_plane(
    volume: &Volume,
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    plane: &BasePlane,
) -> Result<Vec<[f64; 4]>> {
    options.validate()?;
    let region = Region::new(volume.grid(), options)?;
    let sampler = Sampler::new(volume, slices, tf, camera, options.shading.as_ref());
    let splatter = Splatter { slices, size: volume.grid().size(), axes: plane.family.axes };
    let spacing = SheetSpacing::new(volume.grid().size()[plane.family.axes[2]], options.sheets_per_slice);
    let mut image = vec![[0.0; 4]; plane.size[0] * plane.size[1]];
    for k in 0..=spacing.n_slabs {
        let w = spacing.w(if plane.family.ascending { k } else { spacing.n_slabs - k });
        let splat = |footprints| splatter.sheet(plane.sheet(w), plane.size, w, footprints);
        let (value, difference) = (Footprint::Value, gradient_offset(&sampler));
        let density = splat([value; 3]);
        let gradient = difference.map(|d| {
            let d = Footprint::Difference(d);
            [splat([d, value, value]), splat([value, d, value]), splat([value, value, d])]
        });
        for (t, pixel) in image.iter_mut().enumerate() {
            let ray = plane.ray((t % density.n_u) as f64, (t / density.n_u) as f64);
            let [lo, hi] = region.texel_interval(plane, &ray);
            let half = 0.5 * spacing.step;
            let extent = ((w + half).min(hi) - (w - half).max(lo)).max(0.0);
            let direction = from_uvw(plane.family.axes, [ray.slope[0], ray.slope[1], 1.0]);
            let world = volume.grid().world_from_index().matrix3 * direction;
            let to_eye = world.normalize() * if plane.family.ascending { -1.0 } else { 1.0 };
            let index_gradient = gradient
                .as_ref()
                .map_or(DVec3::ZERO, |g| from_uvw(plane.family.axes, std::array::from_fn(|c| g[c].density[t])));
            let thickness = extent * world.length() / sampler.opacity_unit();
            over(pixel, &sampler, density.density[t], thickness, index_gradient, to_eye);
        }
    }
    Ok(image)
}

/// The method's original form, for parallel rays: three sheet buffers, and every sheet warped as a texture.
///
/// Sheet buffers have `options.oversampling` texels per pixel. Perspective cameras, crop and clip planes are drawn as
/// well, each pixel composited from the sheets of its own ray.
pub fn image(volume: &Volume, tf: &TransferFunction, camera: &Camera, options: &RenderOptions) -> Result<Picture> {
    options.validate()?;
    let region = Region::new(volume.grid(), options)?;
    let size = [options.width_px, options.height_px];
    let rays = IndexRays::new(camera, volume.grid().index_from_world(), size[0], size[1]);
    let planes = base_planes(camera, &rays, size, options.oversampling, region.bounds)?;
    let slices = Slices::new(volume, options.kernel);
    let sampler = Sampler::new(volume, &slices, tf, camera, options.shading.as_ref());
    let mut image = vec![[0.0; 4]; size[0] * size[1]];
    for plane in &planes {
        draw_family(volume, &slices, &sampler, &region, &rays, plane, options, &mut image);
    }
    let rgba = image.iter().map(|p| p.map(|c| c as f32)).collect();
    let mut picture = Picture { width_px: size[0], height_px: size[1], rgba, depth: None, value: None };
    if let Some(background) = options.background {
        picture.over_background(background);
    }
    Ok(picture)
}

#[expect(clippy::too_many_arguments, reason = "one literal loop over what image() prepared")]
fn draw_family(
    volume: &Volume,
    slices: &Slices,
    sampler: &Sampler,
    region: &Region,
    rays: &IndexRays,
    plane: &BasePlane,
    options: &RenderOptions,
    image: &mut [[f64; 4]],
) {
    let family = plane.family;
    let splatter = Splatter { slices, size: volume.grid().size(), axes: family.axes };
    let spacing = SheetSpacing::new(volume.grid().size()[family.axes[2]], options.sheets_per_slice);
    // One layout for all sheets: the whole slice, as dense as the base plane is where it is densest.
    let last = family.uvw(volume.grid().last_index());
    let nearest = (0..=spacing.n_slabs).map(|k| plane.sheet(spacing.w(k))).fold([f64::INFINITY; 2], |s, sheet| {
        [s[0].min(sheet[0].1.abs().max(0.05)), s[1].min(sheet[1].1.abs().max(0.05))]
    });
    let size: [usize; 2] = std::array::from_fn(|c| (last[c] / nearest[c]).ceil() as usize + 1);
    let layout: Layout = std::array::from_fn(|c| (0.0, last[c] / (size[c] - 1) as f64));
    let order = |k: usize| if family.ascending { k } else { spacing.n_slabs - k };
    // All sheet buffers that shading can ask for: the pseudo-code runs one sheet ahead and keeps three.
    let splat = |k: usize| splatter.sheet(layout, size, spacing.w(order(k)), [Footprint::Value; 3]);
    let mut buffers: [Option<SheetBuffer>; 3] = [None, Some(splat(0)), None];
    for k in 0..=spacing.n_slabs {
        buffers[2] = (k < spacing.n_slabs).then(|| splat(k + 1));
        let w = spacing.w(order(k));
        let neighbours = if family.ascending { [&buffers[0], &buffers[2]] } else { [&buffers[2], &buffers[0]] };
        let Some(sheet) = &buffers[1] else { return };
        let shaded = ShadedSheet { sheet, neighbours, layout, size, spacing, axes: family.axes };
        let rows = parallel::map(options.height_px, |y| {
            let mut row = image[y * options.width_px..][..options.width_px].to_vec();
            for (x, pixel) in row.iter_mut().enumerate() {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                if crate::base_plane::Family::of(rays.direction(px, py)) == family {
                    let texel = plane.texel_from_pixel(rays, px, py);
                    let ray = plane.ray(texel.x, texel.y);
                    let [lo, hi] = region.texel_interval(plane, &ray);
                    let half = 0.5 * spacing.step;
                    let extent = ((w + half).min(hi) - (w - half).max(lo)).max(0.0);
                    let direction = from_uvw(family.axes, [ray.slope[0], ray.slope[1], 1.0]);
                    let world = volume.grid().world_from_index().matrix3 * direction;
                    let to_eye = world.normalize() * if family.ascending { -1.0 } else { 1.0 };
                    let thickness = extent * world.length() / sampler.opacity_unit();
                    let at = [ray.at_zero[0] + ray.slope[0] * w, ray.at_zero[1] + ray.slope[1] * w];
                    shaded.composite(pixel, sampler, at, thickness, to_eye);
                }
            }
            row
        });
        image.copy_from_slice(&rows.concat());
        buffers.rotate_left(1);
    }
}

/// A sheet buffer with its neighbours, classified and shaded where the texture is read.
struct ShadedSheet<'a> {
    sheet: &'a SheetBuffer,
    neighbours: [&'a Option<SheetBuffer>; 2],
    layout: Layout,
    size: [usize; 2],
    spacing: SheetSpacing,
    axes: [usize; 3],
}

impl ShadedSheet<'_> {
    /// Composites the bilinear mean of the four shaded texels around an index position.
    fn composite(&self, pixel: &mut [f64; 4], sampler: &Sampler, at: [f64; 2], thickness: f64, to_eye: DVec3) {
        if thickness <= 0.0 {
            return;
        }
        let position: [f64; 2] = std::array::from_fn(|c| {
            ((at[c] - self.layout[c].0) / self.layout[c].1).clamp(0.0, (self.size[c] - 1) as f64)
        });
        let first = position.map(|p| p.floor() as usize);
        let mut texture = [0.0; 4];
        for (dj, di) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let (i, j) = ((first[0] + di).min(self.size[0] - 1), (first[1] + dj).min(self.size[1] - 1));
            let weight = |c: usize, d: usize| {
                let t = position[c] - first[c] as f64;
                if d == 0 { 1.0 - t } else { t }
            };
            let mut texel = [0.0; 4];
            let density = self.sheet.density[j * self.size[0] + i];
            over(&mut texel, sampler, density, thickness, self.gradient(i, j), to_eye);
            for c in 0..4 {
                texture[c] += weight(0, di) * weight(1, dj) * texel[c];
            }
        }
        let through = 1.0 - pixel[3];
        (0..4).for_each(|c| pixel[c] += through * texture[c]);
    }

    /// x and y from neighbouring texels, z from the sheets before and after, all scaled to index steps.
    fn gradient(&self, i: usize, j: usize) -> DVec3 {
        let at = |buffer: &SheetBuffer, i: usize, j: usize| buffer.density[j * self.size[0] + i];
        let [iu, jv] = self.size;
        let (i0, i1) = (i.saturating_sub(1), (i + 1).min(iu - 1));
        let (j0, j1) = (j.saturating_sub(1), (j + 1).min(jv - 1));
        let along_u = (at(self.sheet, i1, j) - at(self.sheet, i0, j)) / ((i1 - i0) as f64 * self.layout[0].1);
        let along_v = (at(self.sheet, i, j1) - at(self.sheet, i, j0)) / ((j1 - j0) as f64 * self.layout[1].1);
        let [before, after] = self.neighbours;
        let n_steps = usize::from(before.is_some()) + usize::from(after.is_some());
        let value = |buffer: &Option<SheetBuffer>| at(buffer.as_ref().unwrap_or(self.sheet), i, j);
        let through = (value(after) - value(before)) / (n_steps.max(1) as f64 * self.spacing.step);
        from_uvw(self.axes, [along_u, along_v, through])
    }
}

/// Distance of differences, where gradients are wanted.
fn gradient_offset(sampler: &Sampler) -> Option<f64> {
    sampler.needs_gradient().then(|| sampler.gradient_offset())
}

fn from_uvw(axes: [usize; 3], uvw: [f64; 3]) -> DVec3 {
    let mut v = DVec3::ZERO;
    (0..3).for_each(|c| v[axes[c]] = uvw[c]);
    v
}

fn over(pixel: &mut [f64; 4], sampler: &Sampler, density: f64, thickness: f64, gradient: DVec3, to_eye: DVec3) {
    let depth = sampler.optical_depth(density, gradient);
    if depth <= 0.0 || thickness <= 0.0 {
        return;
    }
    let opacity = -(-depth * thickness).exp_m1();
    let rgb = sampler.shade(density, gradient, to_eye);
    let weight = (1.0 - pixel[3]) * opacity;
    (0..3).for_each(|c| pixel[c] += weight * rgb[c]);
    pixel[3] += weight;
}
