//! The method as it was published: one buffer layout for all sheets, the gradient from three consecutive sheet buffers,
//! and every sheet resampled on its way to the picture as a texture on its polygon. Shares the splatting with
//! [`super::splat`]. Source: "High Resolution Image Splatting", IJACEN 2(7), 2014.

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_core::{Camera, Error, Kernel, Picture, RenderOptions, Result, TransferFunction, Volume};
use wavesplat_splat::render::progress::{Progress, ProgressCallback};
use wavesplat_splat::sheet::spacing::SheetSpacing;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::view::base_plane::{BasePlane, base_planes};
use wavesplat_splat::view::family::{Family, IndexRays};
use wavesplat_splat::view::region::Region;

use super::ablation::Ablation;
use super::sampler::Sampler;
use super::splat::LiteralFootprint::Value;
use super::splat::{BufferTexels, Layout, SheetBuffer, Splatter, from_uvw, over, sheet_spacing, slice_length};

/// A picture by the method's original form, for parallel rays: three sheet buffers, and every sheet warped as a
/// texture.
///
/// Sheet buffers have `options.oversampling` texels per pixel. Perspective cameras, crop and clip planes are drawn as
/// well, each pixel composited from the sheets of its own ray.
pub fn image(
    volume: &Volume,
    kernel: Kernel,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    monitor: &dyn ProgressCallback,
) -> Result<Picture> {
    options.validate()?;
    let region = Region::new(volume.grid(), options)?;
    let size = [options.width_px, options.height_px];
    let rays = IndexRays::new(camera, volume.grid().index_from_world(), size[0], size[1]);
    let planes = base_planes(camera, &rays, size, options.oversampling, region.bounds)?;
    parallel::with_threads(options.n_threads, || {
        let slices = Slices::new(volume, kernel);
        let sampler = Sampler::new(volume, &slices, tf, camera, options.shading.as_ref());
        let mut image = vec![[0.0; 4]; size[0] * size[1]];
        let n_sheets = |plane: &BasePlane| sheet_spacing(volume, plane, options).n_slabs + 1;
        let progress = Progress::new(monitor, planes.iter().map(n_sheets).sum());
        for plane in &planes {
            draw_family(volume, &slices, &sampler, &region, &rays, plane, options, &progress, &mut image);
            if progress.is_stopped() {
                return Err(Error::Cancelled);
            }
        }
        let rgba = image.iter().map(|p| p.map(|c| c as f32)).collect();
        let mut picture = Picture { width_px: size[0], height_px: size[1], rgba, depth: None, value: None };
        picture.finish(options.shading.as_ref(), options.background);
        Ok(picture)
    })
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
    progress: &Progress,
    image: &mut [[f64; 4]],
) {
    let family = plane.family;
    let splatter =
        Splatter { slices, size: volume.grid().size(), axes: family.axes, ablation: Ablation::NONE, progress };
    let spacing = sheet_spacing(volume, plane, options);
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
        splatter.splat(&splatter.sliced(w, Value), BufferTexels { layout, size, sheet: 0, wanted: None }, [Value; 2])
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
            if progress.ask() {
                return row;
            }
            for (x, pixel) in row.iter_mut().enumerate() {
                let (px, py) = (x as f64 + 0.5, y as f64 + 0.5);
                if Family::of(rays.direction(px, py)) == family {
                    let texel = plane.texel_from_pixel(rays, px, py);
                    let ray = plane.ray(texel.x, texel.y);
                    let [lo, hi] = region.texel_interval(plane, &ray);
                    let half = 0.5 * spacing.step;
                    let extent = ((w + half).min(hi) - (w - half).max(lo)).max(0.0);
                    let direction = from_uvw(family.axes, [ray.slope[0], ray.slope[1], 1.0]);
                    let world_from_index = volume.grid().world_from_index().matrix3;
                    let to_eye = (world_from_index * direction).normalize() * if family.ascending { -1.0 } else { 1.0 };
                    let length = slice_length(world_from_index, family.axes, direction, &Ablation::NONE);
                    let at = [ray.at_zero[0] + ray.slope[0] * w, ray.at_zero[1] + ray.slope[1] * w];
                    let known = sampler.known(from_uvw(family.axes, [at[0], at[1], w]));
                    let thickness = extent * length * known / sampler.opacity_unit();
                    shaded.composite(pixel, sampler, at, thickness, to_eye);
                }
            }
            row
        });
        image.copy_from_slice(&rows.concat());
        buffers.rotate_left(1);
        progress.tile_done();
        if progress.is_stopped() {
            return;
        }
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
            let density = self.sheet[j * self.size[0] + i];
            over(&mut texel, sampler, density, thickness, self.gradient(i, j), to_eye);
            for c in 0..4 {
                texture[c] += weight(0, di) * weight(1, dj) * texel[c];
            }
        }
        let through = 1.0 - pixel[3];
        (0..4).for_each(|c| pixel[c] += through * texture[c]);
    }

    /// Gradient at a texel: x and y from neighbouring texels, z from the sheets before and after, all per index step.
    fn gradient(&self, i: usize, j: usize) -> DVec3 {
        let at = |buffer: &[f64], i: usize, j: usize| buffer[j * self.size[0] + i];
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
