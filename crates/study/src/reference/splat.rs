//! High-resolution splatting by its pseudo-code, in double precision, and without any part of it (ablation study):
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
//! The sums are the pseudo-code's, in another order: slices are weighted first, since a weight is the same for a whole
//! slice, and texels gather the samples that reach them, so that rows of texels can be made in parallel. Texels that
//! are outside of what is drawn or behind what is opaque are left out, and gradients where nothing can be seen.
//!
//! Two forms. [`base_plane`] has the texels of the fast path (of each sheet on the same rays) and takes the
//! gradient from difference footprints, or from the texels and sheet buffers beside each, with any [`Ablation`]:
//! without one the fast path must equal it to rounding. [`picture`] warps it as the fast path does. [`super::original`]
//! has the method as it was published. Source: "High Resolution Image Splatting", IJACEN 2(7), 2014.

use glam::{DMat3, DVec3};
use wavesplat_compute::parallel;
use wavesplat_compute::simd::{LANES, Level};
use wavesplat_core::{
    Camera, Composite, Error, Gradient, Kernel, Picture, RenderOptions, Result, TransferFunction, Volume,
};
use wavesplat_splat::kernel::smoothed;
use wavesplat_splat::kernel::weights::{mirror_index, n_taps, taps};
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::picture::edges::{Edges, Scaling};
use wavesplat_splat::picture::supersampling::reads_per_axis;
use wavesplat_splat::picture::warp::warp;
use wavesplat_splat::render::plan::brightest;
use wavesplat_splat::render::progress::{Progress, ProgressCallback};
use wavesplat_splat::sheet::spacing::SheetSpacing;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::view::base_plane::{BasePlane, base_planes};
use wavesplat_splat::view::family::IndexRays;
use wavesplat_splat::view::region::Region;
use wavesplat_splat::view::silhouette::Silhouette;

use super::ablation::{Ablation, FootprintTable};
use super::sampled_footprint::{NoisyTaps, nearest_sample, sheet_number, table_taps};
use super::sampler::Sampler;

/// A sheet buffer: one density per texel, row by row.
pub(super) type SheetBuffer = Vec<f64>;

/// Positions of the texels of a sheet: index coordinate of texel 0 and change per texel, along u and v.
pub(super) type Layout = [(f64, f64); 2];

/// Footprint that is splatted along one axis.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum LiteralFootprint {
    /// The kernel, h(x − l).
    Value,
    /// A difference of the kernel, [h(x + b − l) − h(x + a − l)] / (b − a).
    Difference([f64; 2]),
    /// The cubic B-spline of a standard deviation, normalised.
    Smooth(f64),
    /// The derivative of that B-spline.
    SmoothSlope(f64),
}

use LiteralFootprint::{Difference, Smooth, SmoothSlope, Value};

/// The texels of a sheet buffer.
#[derive(Clone, Copy)]
pub(super) struct BufferTexels<'a> {
    pub(super) layout: Layout,
    pub(super) size: [usize; 2],
    /// Number that distinguishes the noise of this sheet from the noise of others.
    pub(super) sheet: i64,
    /// Mask of the texels that are wanted; `None` for all.
    pub(super) wanted: Option<&'a [bool]>,
}

pub(super) struct Splatter<'a> {
    pub(super) slices: &'a Slices<'a>,
    pub(super) size: [usize; 3],
    pub(super) axes: [usize; 3],
    pub(super) ablation: Ablation,
    pub(super) progress: &'a Progress<'a>,
}

impl Splatter<'_> {
    /// The samples along `axis` that reach a position, and their weights.
    fn weights(&self, axis: usize, x: f64, footprint: LiteralFootprint) -> Vec<(usize, f64)> {
        let n = self.size[axis];
        let last = (n - 1) as f64;
        let x = x.clamp(0.0, last);
        let at = |x: f64, factor: f64| {
            let (first, weights) = self.taps(axis, x.clamp(0.0, last));
            let kernel = self.slices.kernel();
            let along = (first..).zip(weights).take(n_taps(kernel));
            along.map(move |(sample, weight)| (mirror_index(kernel, sample, n), factor * weight))
        };
        let smooth = |deviation: f64, which: usize| {
            let kernel = self.slices.kernel();
            let (first, weights) = smoothed::taps(kernel, x, deviation);
            (first..).zip(weights[which]).map(|(sample, weight)| (mirror_index(kernel, sample, n), weight)).collect()
        };
        match footprint {
            Smooth(deviation) => smooth(deviation, 0),
            SmoothSlope(deviation) => smooth(deviation, 1),
            Value => at(x, 1.0).collect(),
            Difference([a, b]) => at(x + b, 1.0 / (b - a)).chain(at(x + a, -1.0 / (b - a))).collect(),
        }
    }

    /// The first sample that reaches a position, and the weights from there.
    fn taps(&self, axis: usize, x: f64) -> (i64, [f64; 4]) {
        let kernel = self.slices.kernel();
        let is_across = axis == self.axes[2];
        match self.ablation.footprint {
            _ if is_across && !self.ablation.kernel_slicing => nearest_sample(kernel, x),
            FootprintTable::Nearest { per_sample } if !is_across => table_taps(kernel, x, per_sample),
            _ => taps(kernel, x),
        }
    }

    /// The slices that reach the sheet at `w`, weighted and added: rows of samples along u. Missing samples have the
    /// values that they were filled with.
    pub(super) fn sliced(&self, w: f64, footprint: LiteralFootprint) -> Vec<f64> {
        let [u, v, through] = self.axes;
        let slices = self.weights(through, w, footprint);
        let row = |sample_v: usize| {
            let density = |sample_u: usize| {
                let of_slice = |&(slice, weight): &(usize, f64)| {
                    let mut index = [0; 3];
                    (index[u], index[v], index[through]) = (sample_u, sample_v, slice);
                    weight * self.slices.at(index)
                };
                slices.iter().filter(|(_, weight)| *weight != 0.0).map(of_slice).sum::<f64>()
            };
            (0..self.size[u]).map(density).collect::<Vec<_>>()
        };
        parallel::map(self.size[v], row).concat()
    }

    /// Clears a buffer and splats the samples of the [`Splatter::sliced`] slices. Texels that are not wanted stay 0.
    pub(super) fn splat(
        &self,
        samples: &[f64],
        texels: BufferTexels,
        footprints: [LiteralFootprint; 2],
    ) -> SheetBuffer {
        let [u, v, _] = self.axes;
        let n_samples_u = self.size[u];
        let at = |c: usize, i: usize| texels.layout[c].0 + texels.layout[c].1 * i as f64;
        let along_u: Vec<_> = (0..texels.size[0]).map(|i| self.weights(u, at(0, i), footprints[0])).collect();
        let mut buffer = vec![0.0; texels.size[0] * texels.size[1]];
        parallel::for_each_chunk(&mut buffer, texels.size[0], |j, row| {
            if self.progress.ask() {
                return;
            }
            let wanted = texels.wanted.map(|wanted| &wanted[j * row.len()..][..row.len()]);
            let along_v = self.weights(v, at(1, j), footprints[1]);
            for (i, texel) in row.iter_mut().enumerate().filter(|(i, _)| wanted.is_none_or(|wanted| wanted[*i])) {
                if let FootprintTable::NearestNoise { per_sample } = self.ablation.footprint {
                    *texel = self.noisy(samples, [at(0, i), at(1, j)], per_sample, texels.sheet);
                    continue;
                }
                for (sample_v, weight_v) in &along_v {
                    for (sample_u, weight_u) in &along_u[i] {
                        let weight = weight_v * weight_u;
                        if weight != 0.0 {
                            *texel += weight * samples[sample_v * n_samples_u + sample_u];
                        }
                    }
                }
            }
        });
        buffer
    }

    fn smoothed_gradient(&self, texels: BufferTexels, w: f64, deviation: f64) -> [SheetBuffer; 3] {
        let smooth = self.sliced(w, Smooth(deviation));
        std::array::from_fn(|c| {
            let mut footprints = [Smooth(deviation); 2];
            if c == 2 {
                return self.splat(&self.sliced(w, SmoothSlope(deviation)), texels, footprints);
            }
            footprints[c] = SmoothSlope(deviation);
            self.splat(&smooth, texels, footprints)
        })
    }

    /// The density of a texel by a table with noise on the samples.
    fn noisy(&self, samples: &[f64], at: [f64; 2], per_sample: u32, sheet: i64) -> f64 {
        let kernel = self.slices.kernel();
        let size = [self.size[self.axes[0]], self.size[self.axes[1]]];
        let at = [0, 1].map(|c| at[c].clamp(0.0, (size[c] - 1) as f64));
        let noisy = NoisyTaps::new(kernel, at, per_sample, sheet);
        let mut density = 0.0;
        for (v, row) in (noisy.first[1]..).zip(&noisy.weights) {
            for (u, weight) in (noisy.first[0]..).zip(row).filter(|(_, weight)| **weight != 0.0) {
                density +=
                    weight * samples[mirror_index(kernel, v, size[1]) * size[0] + mirror_index(kernel, u, size[0])];
            }
        }
        density
    }

    /// Derivatives along u, v, w at every texel of the sheet at `w`, per index step. `samples`: the slices there;
    /// `step`: slice distances between sheets.
    fn gradient(
        &self,
        samples: &[f64],
        texels: BufferTexels,
        w: f64,
        gradient: Gradient,
        step: f64,
    ) -> [SheetBuffer; 3] {
        let offset = match gradient {
            Gradient::Difference(offset) => offset,
            Gradient::Smoothed(deviation) => return self.smoothed_gradient(texels, w, deviation),
        };
        let scheme = self.ablation.gradient;
        let is_noisy = matches!(self.ablation.footprint, FootprintTable::NearestNoise { .. });
        std::array::from_fn(|c| {
            let [a, b] = scheme.ends(offset, if c < 2 { texels.layout[c].1 } else { step });
            if c == 2 && (is_noisy || !scheme.uses_texel_steps()) {
                let difference = self.sliced(w, Difference([a, b]));
                return self.splat(&difference, texels, [Value; 2]);
            }
            if !scheme.uses_texel_steps() && !is_noisy {
                let mut footprints = [Value; 2];
                footprints[c] = Difference([a, b]);
                return self.splat(samples, texels, footprints);
            }
            // The buffer moved along an axis: the same sheet some texels on, or another sheet.
            let moved = |by: f64| {
                if c == 2 {
                    return self.splat(&self.sliced(w + by, Value), texels, [Value; 2]);
                }
                let mut moved = texels;
                moved.layout[c].0 += by;
                self.splat(samples, moved, [Value; 2])
            };
            moved(b).iter().zip(moved(a)).map(|(after, before)| (after - before) / (b - a)).collect()
        })
    }
}

pub(super) fn sheet_spacing(volume: &Volume, plane: &BasePlane, options: &RenderOptions) -> SheetSpacing {
    SheetSpacing::new(volume.grid().size()[plane.family.axes[2]], options.sheets_per_slice)
}

/// World length of a ray that a slab one slice distance thick stands for. `along`: change of the ray per slice.
pub(super) fn slice_length(world_from_index: DMat3, axes: [usize; 3], along: DVec3, ablation: &Ablation) -> f64 {
    if ablation.view_angle_correction {
        return (world_from_index * along).length();
    }
    // The height of the cell over its face.
    let face = world_from_index.col(axes[0]).cross(world_from_index.col(axes[1]));
    world_from_index.determinant().abs() / face.length()
}

/// The ray of a texel.
struct TexelPath {
    /// Interval of w that is drawn.
    drawn: [f64; 2],
    /// Length that a slab one slice distance thick stands for, in `opacity_unit`s.
    slice_thickness: f64,
    to_eye: DVec3,
}

/// Associated RGBA of every texel of a base plane, before the warp.
pub fn base_plane(
    volume: &Volume,
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    ablation: &Ablation,
    plane: &BasePlane,
) -> Result<Vec<[f64; 4]>> {
    validate_with(options, ablation)?;
    let region = Region::new(volume.grid(), options)?;
    let sampler = Sampler::new(volume, slices, tf, camera, options.shading.as_ref());
    let literal = LiteralSplatting { volume, slices, sampler, region, ablation, options };
    literal.draw(plane, &Progress::new(&(), literal.spacing(plane).n_slabs + 1))
}

/// The picture of the base planes, warped as the fast path does; `composite` of the options is not used.
pub fn picture(
    volume: &Volume,
    kernel: Kernel,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    ablation: &Ablation,
    monitor: &dyn ProgressCallback,
) -> Result<Picture> {
    validate_with(options, ablation)?;
    let region = Region::new(volume.grid(), options)?;
    let size = [options.width_px, options.height_px];
    let rays = IndexRays::new(camera, volume.grid().index_from_world(), size[0], size[1]);
    let planes = base_planes(camera, &rays, size, options.oversampling, region.bounds)?;
    let silhouette = Silhouette::new(std::iter::once(&region));
    parallel::with_threads(options.n_threads, || {
        let slices = Slices::new(volume, kernel);
        let sampler = Sampler::new(volume, &slices, tf, camera, options.shading.as_ref());
        let literal = LiteralSplatting { volume, slices: &slices, sampler, region, ablation, options };
        let progress = Progress::new(monitor, planes.iter().map(|plane| literal.spacing(plane).n_slabs + 1).sum());
        let mut drawn = Vec::new();
        for plane in planes {
            let texels = literal.draw(&plane, &progress)?;
            drawn.push(base_picture(plane, &texels));
        }
        let peak = options.shading.as_ref().map_or(1.0, brightest);
        let reads = reads_per_axis(Composite::Over, options.oversampling);
        let edges = Edges { silhouette: &silhouette, scaling: Scaling::Opacity, is_projection: false };
        let rgba = warp(Level::best(), &drawn, &rays, size, reads, peak, false, Some(edges)).rgba;
        let mut picture = Picture { width_px: size[0], height_px: size[1], rgba, depth: None, value: None };
        picture.finish(options.shading.as_ref(), options.background);
        Ok(picture)
    })
}

/// A base plane in the form that the warp reads.
fn base_picture(plane: BasePlane, texels: &[[f64; 4]]) -> BasePicture {
    let n_u = plane.size[0];
    let mut picture = BasePicture::new(plane, false);
    for (j, row) in texels.chunks(n_u).enumerate() {
        for (k, texels) in row.chunks(LANES).enumerate() {
            let chunk = std::array::from_fn(|lane| texels.get(lane).copied().unwrap_or_default().map(|c| c as f32));
            picture.put(k * LANES, j, &chunk, None);
        }
    }
    picture
}

/// Inputs that all base planes of a picture share.
struct LiteralSplatting<'a> {
    volume: &'a Volume<'a>,
    slices: &'a Slices<'a>,
    sampler: Sampler<'a>,
    region: Region,
    ablation: &'a Ablation,
    options: &'a RenderOptions,
}

impl LiteralSplatting<'_> {
    fn spacing(&self, plane: &BasePlane) -> SheetSpacing {
        sheet_spacing(self.volume, plane, self.options)
    }

    fn path(&self, plane: &BasePlane, t: usize) -> TexelPath {
        let ray = plane.ray((t % plane.size[0]) as f64, (t / plane.size[0]) as f64);
        let axes = plane.family.axes;
        let direction = from_uvw(axes, [ray.slope[0], ray.slope[1], 1.0]);
        let world_from_index = self.volume.grid().world_from_index().matrix3;
        let away = if plane.family.ascending { 1.0 } else { -1.0 };
        TexelPath {
            drawn: self.region.drawn_interval(plane, &ray),
            slice_thickness: slice_length(world_from_index, axes, direction, self.ablation)
                / self.sampler.opacity_unit(),
            to_eye: (world_from_index * direction).normalize() * -away,
        }
    }

    /// Draws a base plane: associated RGBA of every texel.
    fn draw(&self, plane: &BasePlane, progress: &Progress) -> Result<Vec<[f64; 4]>> {
        let Self { volume, slices, sampler, ablation, .. } = self;
        let axes = plane.family.axes;
        let splatter = Splatter { slices, size: volume.grid().size(), axes, ablation: **ablation, progress };
        let spacing = self.spacing(plane);
        let n_texels = plane.size[0] * plane.size[1];
        let paths: Vec<TexelPath> = parallel::map(plane.size[1], |j| {
            if progress.ask() {
                return Vec::new();
            }
            (0..plane.size[0]).map(|i| self.path(plane, j * plane.size[0] + i)).collect::<Vec<_>>()
        })
        .into_iter()
        .flatten()
        .collect();
        if progress.is_stopped() {
            return Err(Error::Cancelled);
        }
        let mut image = vec![[0.0; 4]; n_texels];
        for k in 0..=spacing.n_slabs {
            let w = spacing.w(if plane.family.ascending { k } else { spacing.n_slabs - k });
            // Length of the ray that the sheet stands for, in slice distances.
            let extent = |path: &TexelPath| {
                let [lo, hi] = path.drawn;
                (w + 0.5 * spacing.step).min(hi) - (w - 0.5 * spacing.step).max(lo)
            };
            let is_drawn: Vec<bool> =
                paths.iter().zip(&image).map(|(path, pixel)| extent(path) > 0.0 && pixel[3] < 1.0).collect();
            if is_drawn.contains(&true) {
                let samples = splatter.sliced(w, Value);
                let sheet = sheet_number(w);
                let texels = BufferTexels { layout: plane.sheet(w), size: plane.size, sheet, wanted: Some(&is_drawn) };
                let density = splatter.splat(&samples, texels, [Value; 2]);
                let is_seen: Vec<bool> =
                    is_drawn.iter().zip(&density).map(|(drawn, d)| *drawn && sampler.may_be_seen(*d)).collect();
                let texels = BufferTexels { wanted: Some(&is_seen), ..texels };
                let gradient =
                    wanted_gradient(sampler).map(|how| splatter.gradient(&samples, texels, w, how, spacing.step));
                parallel::for_each_chunk(&mut image, plane.size[0], |j, row| {
                    if progress.ask() {
                        return;
                    }
                    for (t, pixel) in (j * plane.size[0]..).zip(row).filter(|(t, _)| is_seen[*t]) {
                        let path = &paths[t];
                        let gradient =
                            gradient.as_ref().map_or(DVec3::ZERO, |g| from_uvw(axes, std::array::from_fn(|c| g[c][t])));
                        let [u, v] = [(0, t % plane.size[0]), (1, t / plane.size[0])].map(|(c, i)| {
                            let (first, step) = texels.layout[c];
                            first + step * i as f64
                        });
                        let known = sampler.known(from_uvw(axes, [u, v, w]));
                        let thickness = extent(path) * path.slice_thickness * known;
                        over(pixel, sampler, density[t], thickness, gradient, path.to_eye);
                    }
                });
            }
            progress.tile_done();
            if progress.is_stopped() {
                return Err(Error::Cancelled);
            }
        }
        Ok(image)
    }
}

/// Estimator of gradients; `None` where none are wanted.
fn wanted_gradient(sampler: &Sampler) -> Option<Gradient> {
    sampler.needs_gradient().then(|| sampler.gradient_spec())
}

/// Checks options. Shortcuts change how differences are taken, so that gradients must be differences.
fn validate_with(options: &RenderOptions, ablation: &Ablation) -> Result<()> {
    options.validate()?;
    ablation.validate()?;
    let gradient = options.shading.as_ref().map(|shading| shading.gradient);
    if let Some(Gradient::Smoothed(deviation)) = gradient
        && *ablation != Ablation::NONE
    {
        let mend = "shortcuts are studied with differences; pass 0, or Shading.headlight()";
        return Err(Error::out_of_range("gradient_smoothing (voxels) with shortcuts", deviation, "0", mend));
    }
    Ok(())
}

pub(super) fn from_uvw(axes: [usize; 3], uvw: [f64; 3]) -> DVec3 {
    let mut v = DVec3::ZERO;
    (0..3).for_each(|c| v[axes[c]] = uvw[c]);
    v
}

pub(super) fn over(
    pixel: &mut [f64; 4],
    sampler: &Sampler,
    density: f64,
    thickness: f64,
    gradient: DVec3,
    to_eye: DVec3,
) {
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
