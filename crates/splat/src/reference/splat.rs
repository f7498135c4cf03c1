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
//! gradient from difference footprints, or from the texels and sheet buffers beside each, in any [`Variant`]: the fast
//! path must equal it to rounding. [`image`] is the original: one buffer layout for all sheets, the gradient from three
//! consecutive sheet buffers in all variants, and every sheet resampled on its way to the picture as a texture on its
//! polygon. Source: "High Resolution Image Splatting", IJACEN 2(7), 2014.

use glam::{DMat3, DVec3};
use wavesplat_compute::parallel;
use wavesplat_core::{
    Camera, FootprintTable, Kernel, Picture, RenderOptions, Result, TransferFunction, Variant, Volume,
};

use super::raycast::Sampler;
use crate::kernel::footprint::whole_steps;
use crate::kernel::noise::{LEAST_SUM, displacement, sheet_number};
use crate::kernel::prefilter;
use crate::kernel::weights::{fold, n_taps, taps, weight};
use crate::sheet::spacing::SheetSpacing;
use crate::source::slices::Slices;
use crate::view::base_plane::{BasePlane, base_planes};
use crate::view::family::IndexRays;
use crate::view::region::Region;

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
    /// [h(x + b − l) − h(x + a − l)] / (b − a)
    Difference { a: f64, b: f64 },
}

struct Splatter<'a> {
    slices: &'a Slices<'a>,
    size: [usize; 3],
    axes: [usize; 3],
    variant: Variant,
}

impl Splatter<'_> {
    /// Weight of every sample of `axis` at a position: dense and slow, so that nothing can be misplaced.
    fn weights(&self, axis: usize, x: f64, footprint: Footprint) -> Vec<f64> {
        let n = self.size[axis];
        let last = (n - 1) as f64;
        let mut weights = vec![0.0; n];
        let mut add = |x: f64, factor: f64| {
            for (sample, weight) in self.reach(axis, x.clamp(0.0, last)) {
                weights[fold(self.slices.kernel(), sample, n)] += factor * weight;
            }
        };
        match footprint {
            Footprint::Value => add(x, 1.0),
            Footprint::Difference { a, b } => {
                let x = x.clamp(0.0, last);
                add(x + b, 1.0 / (b - a));
                add(x + a, -1.0 / (b - a));
            }
        }
        weights
    }

    /// The samples that reach a position and their weights.
    fn reach(&self, axis: usize, x: f64) -> Vec<(i64, f64)> {
        let kernel = self.slices.kernel();
        let nearest = (x + 0.5).floor();
        let at = if axis == self.axes[2] && !self.variant.kernel_slicing {
            if prefilter::pole(kernel).is_none() {
                return vec![(nearest as i64, 1.0)];
            }
            // Spline coefficients are not the samples; these weights make them the samples of the slice.
            nearest
        } else {
            x
        };
        let (first, weights) = taps(kernel, at);
        let exact = (0..n_taps(kernel)).map(|t| (first + t as i64, weights[t]));
        match self.variant.footprint {
            FootprintTable::Nearest { per_sample } if axis != self.axes[2] => {
                let entries = exact.map(|(sample, _)| (sample, entry(kernel, x - sample as f64, per_sample)));
                normalised(entries.collect())
            }
            _ => exact.collect(),
        }
    }

    /// Clears a buffer and splats every sample that reaches the sheet at `w`, with the noise of sheet `sheet`.
    fn sheet(&self, layout: Layout, size: [usize; 2], w: f64, sheet: i64, footprints: [Footprint; 3]) -> SheetBuffer {
        if let FootprintTable::NearestNoise { per_sample } = self.variant.footprint {
            return self.noisy_sheet(layout, size, w, sheet, per_sample, footprints[2]);
        }
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

    /// The same with every sample displaced by up to half an entry of the footprint table.
    fn noisy_sheet(
        &self,
        layout: Layout,
        size: [usize; 2],
        w: f64,
        sheet: i64,
        per_sample: u32,
        through: Footprint,
    ) -> SheetBuffer {
        let kernel = self.slices.kernel();
        let [u, v, axis_w] = self.axes;
        let slices = self.weights(axis_w, w, through);
        let density = |sample_u: i64, sample_v: i64| {
            let mut index = [0; 3];
            index[u] = fold(kernel, sample_u, self.size[u]);
            index[v] = fold(kernel, sample_v, self.size[v]);
            let of_slice = |(slice, weight): (usize, &f64)| {
                index[axis_w] = slice;
                if *weight == 0.0 { 0.0 } else { weight * self.slices.at(index) }
            };
            slices.iter().enumerate().map(of_slice).sum::<f64>()
        };
        let texel = |i: usize, j: usize| {
            let at = [(u, layout[0], i), (v, layout[1], j)]
                .map(|(axis, (origin, step), i)| (origin + step * i as f64).clamp(0.0, (self.size[axis] - 1) as f64));
            let [near_u, near_v] = at.map(|x| taps(kernel, x).0);
            let splats = |amount: f64| {
                let mut splats = Vec::new();
                for sample_v in near_v..near_v + n_taps(kernel) as i64 {
                    for sample_u in near_u..near_u + n_taps(kernel) as i64 {
                        let noise = displacement(sheet, [sample_u, sample_v]);
                        let weights =
                            [(at[0], sample_u, noise[0]), (at[1], sample_v, noise[1])].map(|(x, sample, noise)| {
                                let displaced = sample as f64 + amount * noise / f64::from(per_sample);
                                entry(kernel, x - displaced, per_sample)
                            });
                        splats.push(((sample_u, sample_v), weights[0] * weights[1]));
                    }
                }
                splats
            };
            let mut splats_here = splats(1.0);
            if splats_here.iter().map(|(_, weight)| weight).sum::<f64>() < LEAST_SUM {
                splats_here = splats(0.0);
            }
            let weighted = normalised(splats_here).into_iter();
            weighted.map(|((sample_u, sample_v), weight)| weight * density(sample_u, sample_v)).sum()
        };
        let all = (0..size[0] * size[1]).map(|t| texel(t % size[0], t / size[0])).collect();
        SheetBuffer { n_u: size[0], density: all }
    }

    /// Derivatives along u, v, w at every texel of the sheet at `w`, from differences over `offset`, per index step.
    fn gradient(
        &self,
        layout: Layout,
        size: [usize; 2],
        w: f64,
        offset: f64,
        spacing: SheetSpacing,
    ) -> [SheetBuffer; 3] {
        let scheme = self.variant.gradient;
        let sheet = sheet_number(w);
        std::array::from_fn(|c| {
            let texel = if c < 2 { layout[c].1 } else { spacing.step };
            let b = if scheme.is_of_sheets() { whole_steps(offset, texel) } else { offset };
            let a = if scheme.is_forward() { 0.0 } else { -b };
            let is_noisy = matches!(self.variant.footprint, FootprintTable::NearestNoise { .. });
            if c == 2 && is_noisy {
                return self.sheet(
                    layout,
                    size,
                    w,
                    sheet,
                    [Footprint::Value, Footprint::Value, Footprint::Difference { a, b }],
                );
            }
            if !scheme.is_of_sheets() && !is_noisy {
                let mut footprints = [Footprint::Value; 3];
                footprints[c] = Footprint::Difference { a, b };
                return self.sheet(layout, size, w, sheet, footprints);
            }
            // The buffer as its texels lie when moved along an axis: the same one some texels on, or another sheet's.
            let moved = |by: f64| {
                let (mut layout, mut w) = (layout, w);
                *if c < 2 { &mut layout[c].0 } else { &mut w } += by;
                self.sheet(layout, size, w, sheet, [Footprint::Value; 3])
            };
            let (mut after, before) = (moved(b), moved(a));
            after
                .density
                .iter_mut()
                .zip(&before.density)
                .for_each(|(after, before)| *after = (*after - before) / (b - a));
            after
        })
    }
}

/// Weight at the entry nearest to a distance from a sample.
fn entry(kernel: Kernel, distance: f64, per_sample: u32) -> f64 {
    let per_sample = f64::from(per_sample);
    weight(kernel, (distance * per_sample + 0.5).floor() / per_sample)
}

/// Weights scaled to sum 1.
fn normalised<T>(weights: Vec<(T, f64)>) -> Vec<(T, f64)> {
    let sum: f64 = weights.iter().map(|(_, weight)| weight).sum();
    weights.into_iter().map(|(sample, weight)| (sample, weight / sum)).collect()
}

/// World length that a slab one slice distance thick stands for, where rays go `along` per slice.
fn slice_length(world_from_index: DMat3, axes: [usize; 3], along: DVec3, variant: &Variant) -> f64 {
    if variant.view_angle_correction {
        return (world_from_index * along).length();
    }
    // The height of the cell over its face.
    let face = world_from_index.col(axes[0]).cross(world_from_index.col(axes[1]));
    world_from_index.determinant().abs() / face.length()
}

/// Associated RGBA of every texel of a base plane, before the warp, in the options' variant.
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
    let splatter = Splatter { slices, size: volume.grid().size(), axes: plane.family.axes, variant: options.variant };
    let spacing = SheetSpacing::new(volume.grid().size()[plane.family.axes[2]], options.sheets_per_slice);
    let mut image = vec![[0.0; 4]; plane.size[0] * plane.size[1]];
    for k in 0..=spacing.n_slabs {
        let w = spacing.w(if plane.family.ascending { k } else { spacing.n_slabs - k });
        let layout = plane.sheet(w);
        let density = splatter.sheet(layout, plane.size, w, sheet_number(w), [Footprint::Value; 3]);
        let gradient =
            gradient_offset(&sampler).map(|offset| splatter.gradient(layout, plane.size, w, offset, spacing));
        for (t, pixel) in image.iter_mut().enumerate() {
            let ray = plane.ray((t % density.n_u) as f64, (t / density.n_u) as f64);
            let [lo, hi] = region.texel_interval(plane, &ray);
            let half = 0.5 * spacing.step;
            let extent = ((w + half).min(hi) - (w - half).max(lo)).max(0.0);
            let direction = from_uvw(plane.family.axes, [ray.slope[0], ray.slope[1], 1.0]);
            let world_from_index = volume.grid().world_from_index().matrix3;
            let to_eye = (world_from_index * direction).normalize() * if plane.family.ascending { -1.0 } else { 1.0 };
            let index_gradient = gradient
                .as_ref()
                .map_or(DVec3::ZERO, |g| from_uvw(plane.family.axes, std::array::from_fn(|c| g[c].density[t])));
            let length = slice_length(world_from_index, plane.family.axes, direction, &options.variant);
            let thickness = extent * length / sampler.opacity_unit();
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
    let splatter = Splatter { slices, size: volume.grid().size(), axes: family.axes, variant: options.variant };
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
    let splat = |k: usize| {
        let w = spacing.w(order(k));
        splatter.sheet(layout, size, w, sheet_number(w), [Footprint::Value; 3])
    };
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
                if crate::view::family::Family::of(rays.direction(px, py)) == family {
                    let texel = plane.texel_from_pixel(rays, px, py);
                    let ray = plane.ray(texel.x, texel.y);
                    let [lo, hi] = region.texel_interval(plane, &ray);
                    let half = 0.5 * spacing.step;
                    let extent = ((w + half).min(hi) - (w - half).max(lo)).max(0.0);
                    let direction = from_uvw(family.axes, [ray.slope[0], ray.slope[1], 1.0]);
                    let world_from_index = volume.grid().world_from_index().matrix3;
                    let to_eye = (world_from_index * direction).normalize() * if family.ascending { -1.0 } else { 1.0 };
                    let length = slice_length(world_from_index, family.axes, direction, &options.variant);
                    let thickness = extent * length / sampler.opacity_unit();
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
