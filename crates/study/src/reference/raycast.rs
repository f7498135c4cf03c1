//! The converged picture: an image-order ray caster in double precision.
//!
//! Steps along each ray, evaluates the kernel at every step (8 samples for trilinear), classifies, shades and
//! composites, with the exact curves of the transfer function. Model: emission and absorption, where a node of opacity
//! 1 is opaque to rays that stay at its value, and has no length for those that pass it; central differences
//! `[V(x + d) − V(x − d)] / 2d` along the index axes for the gradient, which with the linear kernel and d = 1 is the
//! trilinearly interpolated central difference of the usual ray caster. Shapes cut rays where they lie: the matter
//! before one and behind it is stepped through apart.

use std::cell::Cell;

use glam::{DAffine3, DMat3, DVec3};
use wavesplat_compute::parallel;
use wavesplat_core::{Camera, Crop, Error, Kernel, Picture, RenderOptions, Result, Shading, TransferFunction, Volume};
use wavesplat_splat::optics::labels::Labels;
use wavesplat_splat::optics::shade::vanishing_gradient_squared;
use wavesplat_splat::ray::cut_faces::{DEPTH, NEAR, REACH};
use wavesplat_splat::render::progress::{Progress, ProgressCallback};
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::view::common_grid::CommonGrid;
use wavesplat_splat::view::family::IndexRays;
use wavesplat_splat::view::region::{HalfSpace, Region};
use wavesplat_splat::view::scattered::scattered_position;

use super::active_blocks::ActiveBlocks;
use super::color_field::{CastColor, CastField};
use super::medium::Medium;
use super::mixture::Mixture;
use super::sampler::Sampler;
use super::shapes::CastShapes;

/// Sampling of the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RaycastOptions {
    /// Reconstruction kernel.
    pub kernel: Kernel,
    /// Distance of samples along the ray, in units of the smallest spacing.
    pub step: f64,
    /// Rays per pixel, a square number: through the middles of the cells of a square grid, or, where a wall of the
    /// region passes through the pixel, and in pictures with shapes, through the positions at which the renderer counts
    /// shares ([`wavesplat_splat::view::scattered`]).
    pub rays_per_pixel: usize,
}

/// Transmittance below which rays stop.
const TRANSPARENT: f64 = 1e-7;

/// Pixels that a thread draws at a time: few, so that a cancelled picture does not wait long for the last ones.
const N_PIXELS: usize = 8;

/// A volume as the ray caster draws it, beside others or alone.
#[derive(Clone, Copy)]
pub struct CastLayer<'a> {
    /// The samples.
    pub volume: &'a Volume<'a>,
    /// Opacity and colour of the samples.
    pub transfer_function: &'a TransferFunction,
    /// Lights and coefficients.
    pub shading: Option<&'a Shading>,
    /// A segmentation beside the samples.
    pub labels: Option<&'a Labels>,
    /// A field that gives the samples their colours.
    pub color: Option<CastColor<'a>>,
}

/// Draws `options.composite = over` by ray casting; sheets and oversampling of the options are not used.
pub fn raycast(
    volume: &Volume,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    sampling: RaycastOptions,
    monitor: &dyn ProgressCallback,
) -> Result<Picture> {
    let layer =
        CastLayer { volume, transfer_function: tf, shading: options.shading.as_ref(), labels: None, color: None };
    raycast_layers(&[layer], camera, options, sampling, monitor)
}

/// Like [`raycast`], for several volumes in any positions, with a segmentation beside each: at every step extinctions
/// add, and colours mix by extinction. The layers' shading is used, not the options'. Index positions of a crop
/// box are in the first volume, and shapes are lit by its lights; the volumes cast neither occlusion nor shadow on
/// them.
pub fn raycast_layers(
    layers: &[CastLayer],
    camera: &Camera,
    options: &RenderOptions,
    sampling: RaycastOptions,
    monitor: &dyn ProgressCallback,
) -> Result<Picture> {
    options.validate()?;
    let mend = "pass a step in voxels, 0.05 for a converged picture";
    if !(sampling.step >= 1e-3 && sampling.step <= 10.0) {
        return Err(Error::out_of_range("step", sampling.step, "between 0.001 and 10", mend));
    }
    let per_axis = (sampling.rays_per_pixel as f64).sqrt().round() as usize;
    if per_axis == 0 || per_axis * per_axis != sampling.rays_per_pixel || per_axis > 16 {
        let mend = "pass 1, 4, 9 or 16";
        return Err(Error::out_of_range("rays_per_pixel", sampling.rays_per_pixel, "a square number up to 256", mend));
    }
    let Some(first) = layers.first() else {
        return Err(Error::out_of_range("number of layers", 0, "1 or more", "give a volume"));
    };
    parallel::with_threads(options.n_threads, || {
        let slices: Vec<Slices> = layers.iter().map(|layer| Slices::new(layer.volume, sampling.kernel)).collect();
        let colors: Vec<Option<Slices>> =
            layers.iter().map(|layer| layer.color.map(|color| Slices::new(color.volume, sampling.kernel))).collect();
        let caster = RayCaster::new(layers, (&slices, &colors), camera, options, sampling.step)?;
        let rays = IndexRays::new(camera, first.volume.grid().index_from_world(), options.width_px, options.height_px);
        let (width_px, n_pixels) = (options.width_px, options.width_px * options.height_px);
        let progress = Progress::new(monitor, n_pixels.div_ceil(N_PIXELS));
        let parts = parallel::map(n_pixels.div_ceil(N_PIXELS), |k| {
            if progress.is_stopped() {
                return Vec::new();
            }
            let pixel = |i: usize| {
                let [x, y] = [i % width_px, i / width_px].map(|px| px as f64);
                let mut sum = [0.0; 4];
                let met = |[dx, dy]: [f64; 2]| caster.met(rays.origin(x + dx, y + dy), rays.direction(x + dx, y + dy));
                let corner = met([0.0, 0.0]);
                let has_wall = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].into_iter().any(|other| met(other) != corner);
                for s in 0..sampling.rays_per_pixel {
                    let middle = || [s % per_axis, s / per_axis].map(|cell| (cell as f64 + 0.5) / per_axis as f64);
                    let is_scattered = has_wall || !caster.shapes.is_empty();
                    let [dx, dy] = if is_scattered { scattered_position(s, per_axis) } else { middle() };
                    let (px, py) = (x + dx, y + dy);
                    let rgba = caster.cast(rays.origin(px, py), rays.direction(px, py), [px, py]);
                    (0..4).for_each(|c| sum[c] += rgba[c] / sampling.rays_per_pixel as f64);
                }
                sum.map(|c| c as f32)
            };
            let part = (k * N_PIXELS..((k + 1) * N_PIXELS).min(n_pixels)).map(pixel).collect::<Vec<_>>();
            progress.tile_done();
            part
        });
        if progress.is_stopped() {
            return Err(Error::Cancelled);
        }
        let (width_px, height_px) = (options.width_px, options.height_px);
        let mut picture = Picture { width_px, height_px, rgba: parts.concat(), depth: None, value: None };
        picture.finish(layers.iter().find_map(|layer| layer.shading), options.background);
        Ok(picture)
    })
}

struct RayCaster<'a> {
    layers: Vec<CastVolume<'a>>,
    shapes: CastShapes<'a>,
    /// Half spaces of a crop box in index positions of the first volume.
    crop: Vec<HalfSpace>,
    world_from_index: DMat3,
    step_world: f64,
    perspective: bool,
}

/// A volume that rays pass through.
struct CastVolume<'a> {
    sampler: Sampler<'a>,
    labels: Option<&'a Labels>,
    size: [usize; 3],
    /// The drawn region, in the volume's own index positions.
    region: Region,
    own_from_first: DAffine3,
    world_from_index: DMat3,
    blocks: ActiveBlocks,
    color: Option<CastField<'a>>,
}

impl CastVolume<'_> {
    /// A ray in the volume's own index positions.
    fn own_ray(&self, origin: DVec3, direction: DVec3) -> (DVec3, DVec3) {
        (self.own_from_first.transform_point3(origin), self.own_from_first.matrix3 * direction)
    }
}

impl<'a> RayCaster<'a> {
    fn new(
        layers: &[CastLayer<'a>],
        (slices, colors): (&'a [Slices<'a>], &'a [Option<Slices<'a>>]),
        camera: &'a Camera,
        options: &'a RenderOptions,
        step: f64,
    ) -> Result<Self> {
        let first = layers[0].volume.grid();
        // A crop box in index positions of the first volume is kept apart; one in the world is part of every layer's
        // region.
        let (crop, in_world) = match options.crop {
            Some(Crop::Index { lo, hi }) => (index_box(lo, hi), None),
            in_world => (Vec::new(), in_world),
        };
        let of_all = RenderOptions { crop: in_world, ..options.clone() };
        let mut volumes = Vec::new();
        for (layer, (slices, color)) in layers.iter().zip(slices.iter().zip(colors)) {
            let grid = layer.volume.grid();
            let region = match Region::new(grid, &of_all) {
                // Another layer may lie in the box.
                Err(Error::EmptyCrop { .. }) if layers.len() > 1 => continue,
                region => region?,
            };
            let sampler = Sampler::new(layer.volume, slices, layer.transfer_function, camera, layer.shading);
            volumes.push(CastVolume {
                blocks: ActiveBlocks::new(&sampler, grid.size()),
                sampler,
                labels: layer.labels,
                size: grid.size(),
                region,
                own_from_first: grid.index_from_world() * first.world_from_index(),
                world_from_index: grid.world_from_index().matrix3,
                color: layer.color.zip(color.as_ref()).map(|(of, slices)| CastField::new(of, slices, grid)),
            });
        }
        // Oblique layers share no slices: the slices of the first one count.
        let grids: Vec<_> = layers.iter().map(|layer| layer.volume.grid()).collect();
        let slices_from_world = CommonGrid::new(&grids).map_or(first.index_from_world(), |c| c.grid.index_from_world());
        let shading = layers.iter().find_map(|layer| layer.shading);
        let finest = layers.iter().map(|layer| layer.volume.grid().spacing().min_element());
        Ok(Self {
            layers: volumes,
            shapes: CastShapes::new(options, camera, shading, first.index_from_world(), slices_from_world),
            crop,
            world_from_index: first.world_from_index().matrix3,
            step_world: step * finest.fold(f64::INFINITY, f64::min),
            perspective: !matches!(camera.projection(), wavesplat_core::Projection::Orthographic { .. }),
        })
    }

    /// Interval of ray parameters of a ray in each layer; empty where the first is not below the second.
    fn drawn(&self, origin: DVec3, direction: DVec3) -> Vec<[f64; 2]> {
        let start = if self.perspective { 0.0 } else { f64::NEG_INFINITY };
        let of_crop = Region { half_spaces: self.crop.clone(), bounds: [DVec3::ZERO; 2] };
        let all = of_crop.passage(origin, direction, [start, f64::INFINITY]).ends;
        let of_layer = |layer: &CastVolume| {
            let (origin, direction) = layer.own_ray(origin, direction);
            layer.region.passage(origin, direction, all).ends
        };
        self.layers.iter().map(of_layer).collect()
    }

    /// Flags of the layers that a ray meets.
    fn met(&self, origin: DVec3, direction: DVec3) -> Vec<bool> {
        self.drawn(origin, direction).iter().map(|[t_in, t_out]| t_in < t_out).collect()
    }

    /// Associated RGBA along `origin + t · direction`, index space of the first volume, through a pixel position.
    fn cast(&self, origin: DVec3, direction: DVec3, pixel: [f64; 2]) -> [f64; 4] {
        let world = self.world_from_index * direction;
        let to_eye = -world.normalize();
        let own_ray = |layer: &CastVolume| layer.own_ray(origin, direction);
        let drawn = self.drawn(origin, direction);
        let seen = || drawn.iter().filter(|[t_in, t_out]| t_in < t_out);
        let t_in = seen().fold(f64::INFINITY, |t, own| t.min(own[0]));
        let t_out = seen().fold(f64::NEG_INFINITY, |t, own| t.max(own[1]));
        // Slices are counted along the axis that the ray runs most along.
        let slices = direction.abs().max_element();
        // Where the ray entered matter through a cut last.
        let entry = Cell::new(f64::NEG_INFINITY);
        let mixture_at = |t: f64| {
            let mut mixture = Medium::NONE;
            for (layer, [t_in, _]) in self.layers.iter().zip(&drawn).filter(|(_, [from, to])| *from <= t && t <= *to) {
                let (origin, direction) = own_ray(layer);
                let position = origin + direction * t;
                let behind = (t - t_in) * slices;
                let missing = layer.sampler.missing(position);
                let near = (2.0 - behind / f64::from(NEAR)).clamp(0.0, 1.0);
                let hole = (4.0 * missing - 1.0).clamp(0.0, 1.0);
                if near > 0.0 || hole > 0.0 {
                    let per_slice = layer.full_extinction(position) * world.length() / slices;
                    let dense = (2.0 * per_slice / f64::from(DEPTH) - 0.5).clamp(0.0, 1.0);
                    for (at, strength) in [(*t_in, dense * near), (t, dense * hole)] {
                        if strength > 0.0 {
                            entry.set(entry.get().max(at - f64::from(REACH) * (1.0 - strength) / slices));
                        }
                    }
                }
                mixture = mixture.and(&layer.medium(position, to_eye, (t - entry.get()) * slices));
            }
            mixture
        };
        let mut color = RayColor::NONE;
        let mut from = t_in;
        for hit in self.shapes.hits(pixel) {
            color.pass([from, hit.t.min(t_out)], self.step_world / world.length(), world.length(), &mixture_at);
            color.over(hit.opacity, hit.rgb);
            from = from.max(hit.t);
        }
        color.pass([from, t_out], self.step_world / world.length(), world.length(), &mixture_at);
        color.rgba()
    }
}

/// Colour of the part of a ray that was passed, front to back.
struct RayColor {
    rgb: [f64; 3],
    transmittance: f64,
}

impl RayColor {
    const NONE: Self = Self { rgb: [0.0; 3], transmittance: 1.0 };

    /// Passes the matter between two ray parameters, in even steps of at most `step`. `speed`: length of a unit of the
    /// parameter.
    fn pass(&mut self, [from, to]: [f64; 2], step: f64, speed: f64, mixture_at: &impl Fn(f64) -> Medium) {
        if from >= to {
            return;
        }
        let n_steps = ((to - from) / step).ceil();
        let dt = (to - from) / n_steps;
        for s in 0..n_steps as u64 {
            if self.is_used_up() {
                return;
            }
            let t = from + (s as f64 + 0.5) * dt;
            let mut mixture = mixture_at(t);
            if mixture.extinction.is_infinite() {
                // A single value of opacity 1 is met at a point, which has no length; a range of such values fills both
                // points beside.
                mixture = mixture_at(t - 0.25 * dt).mean(&mixture_at(t + 0.25 * dt));
            }
            if mixture.extinction > 0.0 {
                self.over(-(-mixture.extinction * dt * speed).exp_m1(), mixture.color);
            }
        }
    }

    /// Passes a surface, or a step of matter, of this opacity and straight colour.
    fn over(&mut self, opacity: f64, rgb: [f64; 3]) {
        for c in 0..3 {
            self.rgb[c] += self.transmittance * opacity * rgb[c];
        }
        self.transmittance *= 1.0 - opacity;
    }

    /// Whether matter farther along the ray cannot be seen.
    fn is_used_up(&self) -> bool {
        self.transmittance < TRANSPARENT
    }

    /// Associated colour and opacity.
    fn rgba(&self) -> [f64; 4] {
        let [r, g, b] = self.rgb;
        [r, g, b, 1.0 - self.transmittance]
    }
}

impl CastVolume<'_> {
    /// Medium at an index position: the scan, and the label medium. `behind_entry`: way from the entry of the ray, in
    /// slices.
    fn medium(&self, position: DVec3, to_eye: DVec3, behind_entry: f64) -> Medium {
        let sampler = &self.sampler;
        let mixture = self.labels.map(|labels| Mixture::new(labels, self.size, position));
        let own = mixture.as_ref().map_or(0.0, |mixture| mixture.own);
        if own == 0.0 && !self.blocks.is_active(position) {
            return Medium::NONE;
        }
        let mut known = sampler.known(position);
        if let Some(color) = &self.color {
            known = known.min(color.known(position));
        }
        if known == 0.0 {
            return Medium::NONE;
        }
        let density = sampler.density(position);
        if own == 0.0 && !sampler.may_be_seen(density) {
            return Medium::NONE;
        }
        let gradient = if sampler.needs_gradient() { sampler.gradient(position) } else { DVec3::ZERO };
        let (mut depth, mut rgb) = self.classified(position, density, gradient);
        if let Some(Mixture { scan, tint, tint_rgb, .. }) = &mixture {
            // Opacity 1 has infinite depth, of which a share of 0 is NaN: where nothing is left of the scan, it is
            // clear.
            depth = if *scan > 0.0 { depth * scan } else { 0.0 };
            if *scan > 0.0 {
                rgb = [0, 1, 2].map(|c| rgb[c] * (1.0 - tint / scan) + tint_rgb[c] / scan);
            }
        }
        let per_unit = known / sampler.opacity_unit();
        let even = sampler.even_share(behind_entry);
        let color = if depth > 0.0 { sampler.light(rgb, gradient, to_eye, sampler.vanishing, even) } else { [0.0; 3] };
        let scan = Medium { extinction: depth * per_unit, color };
        let Some(mixture) = mixture.filter(|_| own > 0.0) else { return scan };
        let vanishing = vanishing_gradient_squared(self.world_from_index, [0.0, 1.0]);
        let own_rgb = mixture.own_rgb.map(|c| c / own);
        let color = sampler.light(own_rgb, self.own_gradient(position), to_eye, vanishing, even);
        scan.and(&Medium { extinction: own * per_unit, color })
    }

    /// Optical depth per `opacity_unit` and colour of the scan at an index position, without light: by its density and
    /// gradient, or by a second field there.
    fn classified(&self, position: DVec3, density: f64, gradient: DVec3) -> (f64, [f64; 3]) {
        let sampler = &self.sampler;
        let Some(color) = &self.color else {
            return (sampler.optical_depth(density, gradient), sampler.unshaded(density, gradient));
        };
        let of_field = color.value(position);
        match sampler.tf.function_2d() {
            Some(_) => {
                let value = sampler.value(position);
                (sampler.tf.optical_depth(value, of_field), sampler.tf.color_at(value, of_field))
            }
            None => (sampler.optical_depth(density, gradient), color.rgb(of_field)),
        }
    }

    /// Extinction of the scan or the label medium, the larger, at an index position if no sample were missing.
    fn full_extinction(&self, position: DVec3) -> f64 {
        let sampler = &self.sampler;
        let gradient = if sampler.needs_gradient() { sampler.gradient(position) } else { DVec3::ZERO };
        let (depth, _) = self.classified(position, sampler.density(position), gradient);
        let Some(labels) = self.labels else { return depth / sampler.opacity_unit() };
        let Mixture { scan, own, .. } = Mixture::new(labels, self.size, position);
        let depth = if scan > 0.0 { depth * scan } else { 0.0 };
        depth.max(own) / sampler.opacity_unit()
    }

    /// Index-space gradient of the label medium by differences.
    fn own_gradient(&self, position: DVec3) -> DVec3 {
        let Some(labels) = self.labels else { return DVec3::ZERO };
        let own = |position: DVec3| Mixture::new(labels, self.size, position).own;
        let offset = labels.gradient_offset();
        let along = |axis: DVec3| (own(position + offset * axis) - own(position - offset * axis)) / (2.0 * offset);
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    }
}

/// The half spaces of an index-aligned box.
fn index_box(lo: DVec3, hi: DVec3) -> Vec<HalfSpace> {
    let sides = (0..3).flat_map(|a| [(DVec3::AXES[a], -lo[a]), (-DVec3::AXES[a], hi[a])]);
    sides.map(|(normal, offset)| HalfSpace { normal, offset }).collect()
}
