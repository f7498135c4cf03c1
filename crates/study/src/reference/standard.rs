//! Standard splatting, sample by sample, in double precision and without tables:
//!
//! ```text
//! for each sheet buffer, front to back
//!     clear it
//!     for each sample that belongs to it
//!         look up colour and opacity; shade
//!         for each texel within the footprint
//!             add the footprint times colour and opacity
//!     clamp, and composite it into the picture (over)
//! ```
//!
//! The sheet buffers, and the choices that the sources leave open, are as in [`crate::standard`].
//! Source: Westover, *Footprint evaluation for volume rendering* (1990).

use glam::{DVec2, DVec3};
use wavesplat_core::{Camera, Grid, Kernel, Projection, RenderOptions, Result, Shading, TransferFunction, Volume};
use wavesplat_splat::kernel::weights::{radius, weight};
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::view::base_plane::BasePlane;
use wavesplat_splat::view::region::Region;

use super::sampler::Sampler;
use crate::standard::widening;
use crate::standard::{Buffer, NEAREST_SLAB, NEAREST_SLICE, SliceDistance, StandardOptions, planes, validate};

/// Samples, with the inputs of classification and shading.
struct LiteralSamples<'a> {
    volume: &'a Volume<'a>,
    slices: &'a Slices<'a>,
    sampler: Sampler<'a>,
    camera: &'a Camera,
    region: Region,
    distance: SliceDistance,
    standard: StandardOptions,
    peak: f64,
}

impl<'a> LiteralSamples<'a> {
    fn new(
        volume: &'a Volume<'a>,
        slices: &'a Slices<'a>,
        tf: &'a TransferFunction,
        camera: &'a Camera,
        options: &'a RenderOptions,
        standard: StandardOptions,
    ) -> Result<Self> {
        validate(options)?;
        let white = |s: &Shading| {
            let light = |c: usize| s.lights.iter().map(|l| f64::from(l.rgb[c])).sum::<f64>();
            let light = (0..3).map(light).fold(0.0, f64::max);
            (f64::from(s.ambient) + f64::from(s.diffuse + s.specular) * light).max(1.0)
        };
        Ok(Self {
            volume,
            slices,
            sampler: Sampler::new(volume, slices, tf, camera, options.shading.as_ref()),
            camera,
            region: Region::new(volume.grid(), options)?,
            distance: SliceDistance::new(volume.grid(), camera.forward()),
            standard,
            peak: options.shading.as_ref().map_or(1.0, white),
        })
    }

    fn grid(&self) -> &Grid {
        self.volume.grid()
    }

    fn world(&self, index: [usize; 3]) -> DVec3 {
        self.grid().world_from_index().transform_point3(position(index))
    }

    /// Unit vector from the eye to a sample.
    fn ray(&self, index: [usize; 3]) -> DVec3 {
        match self.camera.projection() {
            Projection::Orthographic { .. } => self.camera.forward(),
            Projection::Perspective { .. } => (self.world(index) - self.camera.position()).normalize(),
        }
    }

    /// Central differences of the neighbours, which stop at the faces.
    fn gradient(&self, index: [usize; 3]) -> DVec3 {
        let mut gradient = DVec3::ZERO;
        for axis in 0..3 {
            let (mut before, mut after) = (index, index);
            before[axis] = index[axis].saturating_sub(1);
            after[axis] = (index[axis] + 1).min(self.grid().size()[axis] - 1);
            gradient[axis] = (self.slices.at(after) - self.slices.at(before)) / 2.0;
        }
        gradient
    }

    /// Associated colour and opacity of a sample; `w`: the axis across the slices.
    fn rgba(&self, index: [usize; 3], w: usize) -> [f64; 4] {
        if self.slices.is_hole(index) || !self.region.contains(position(index)) {
            return [0.0; 4];
        }
        let ray = self.ray(index);
        let thickness = match (self.standard.buffer, self.standard.view_angle_correction) {
            (Buffer::Axis, true) => 1.0 / self.grid().index_from_world().transform_vector3(ray)[w].abs(),
            (Buffer::Axis, false) => 1.0 / self.grid().index_from_world().matrix3.transpose().col(w).length(),
            (Buffer::View, true) => self.distance.along_view / ray.dot(self.camera.forward()),
            (Buffer::View, false) => self.distance.across,
        };
        let density = self.slices.at(index);
        let gradient = self.gradient(index);
        let depth = self.sampler.optical_depth(density, gradient);
        // NaN is infinite depth times 0, which is clear.
        if depth.is_nan() || depth <= 0.0 {
            return [0.0; 4];
        }
        let alpha = -(-depth * thickness / self.sampler.opacity_unit()).exp_m1();
        let [r, g, b] = self.sampler.shade(density, gradient, -ray);
        [alpha * r, alpha * g, alpha * b, alpha]
    }

    /// Clamps a sheet buffer to valid colours, and composites it.
    fn composite(&self, image: &mut [[f64; 4]], sheet: &[[f64; 4]]) {
        for (pixel, sum) in image.iter_mut().zip(sheet) {
            let through = 1.0 - pixel[3];
            let alpha = sum[3].clamp(0.0, 1.0);
            (0..3).for_each(|c| pixel[c] += through * sum[c].clamp(0.0, self.peak * alpha));
            pixel[3] += through * alpha;
        }
    }
}

/// Associated RGBA of every texel of a base plane, before the warp, of buffers parallel to the slices.
pub fn base_plane(
    volume: &Volume,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    standard: StandardOptions,
    plane: &BasePlane,
) -> Result<Vec<[f64; 4]>> {
    let slices = Slices::new(volume, Kernel::Linear);
    let source = LiteralSamples::new(volume, &slices, tf, camera, options, standard)?;
    let [u, v, w] = plane.family.axes;
    let size = volume.grid().size();
    let mut image = vec![[0.0; 4]; plane.size[0] * plane.size[1]];
    for k in 0..size[w] {
        let slice = if plane.family.ascending { k } else { size[w] - 1 - k };
        let sign = if plane.family.ascending { 1.0 } else { -1.0 };
        if plane.eye_w().is_some_and(|eye| sign * (slice as f64 - eye) < NEAREST_SLICE) {
            continue;
        }
        let layout = plane.sheet(slice as f64);
        // Weight of a sample at a texel along an axis (0: u, 1: v).
        let footprint = |axis: usize, texel: usize, sample: usize| {
            let (origin, step) = layout[axis];
            let x = origin + step * texel as f64;
            let at = |i: f64| weight(standard.kernel, (x - i) / widening(step));
            let reach = radius(standard.kernel) * widening(step) + 1.0;
            let all = (x - reach).floor() as i64..=(x + reach).ceil() as i64;
            at(sample as f64) / all.map(|i| at(i as f64)).sum::<f64>()
        };
        let table = |axis: usize, n: usize| -> Vec<Vec<f64>> {
            let row = |texel| (0..size[[u, v][axis]]).map(|i| footprint(axis, texel, i)).collect();
            (0..n).map(row).collect()
        };
        let (of_u, of_v) = (table(0, plane.size[0]), table(1, plane.size[1]));
        let mut sheet = vec![[0.0; 4]; image.len()];
        for j in 0..size[v] {
            for i in 0..size[u] {
                let mut index = [0; 3];
                (index[u], index[v], index[w]) = (i, j, slice);
                let rgba = source.rgba(index, w);
                for (t, texel) in sheet.iter_mut().enumerate() {
                    let weight = of_u[t % plane.size[0]][i] * of_v[t / plane.size[0]][j];
                    (0..4).for_each(|c| texel[c] += weight * rgba[c]);
                }
            }
        }
        source.composite(&mut image, &sheet);
    }
    Ok(image)
}

/// The base planes that buffers parallel to the slices are drawn on.
pub fn base_planes(
    volume: &Volume,
    camera: &Camera,
    options: &RenderOptions,
    kernel: Kernel,
) -> Result<Vec<BasePlane>> {
    planes(camera, volume.grid(), options, kernel, &Region::new(volume.grid(), options)?)
}

/// Associated RGBA of every pixel, of buffers parallel to the view plane with a texel per pixel.
pub fn view_picture(
    volume: &Volume,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    standard: StandardOptions,
) -> Result<Vec<[f64; 4]>> {
    let slices = Slices::new(volume, Kernel::Linear);
    let source = LiteralSamples::new(volume, &slices, tf, camera, options, standard)?;
    let size = volume.grid().size();
    let depth = |index: [usize; 3]| camera.forward().dot(source.world(index) - camera.position());
    let is_parallel = matches!(camera.projection(), Projection::Orthographic { .. });
    let slab = source.distance.along_view;
    let mut samples = Vec::new();
    for i in 0..size.iter().product() {
        let index = [i % size[0], i / size[0] % size[1], i / (size[0] * size[1])];
        // Half a slab on either side of the sample 0, 0, 0, and so on; what lies on a border belongs behind it.
        let place = ((depth(index) - depth([0; 3])) / slab + 0.5 + 1e-6).floor() as i64;
        if is_parallel || depth(index) >= NEAREST_SLAB * slab {
            samples.push((place, index));
        }
    }
    samples.sort_by_key(|sample| sample.0);
    let mass = mass(standard.kernel);
    let mut image = vec![[0.0; 4]; options.width_px * options.height_px];
    for sheet in samples.chunk_by(|a, b| a.0 == b.0) {
        let mut buffer = vec![[0.0; 4]; image.len()];
        for (_, index) in sheet {
            let rgba = source.rgba(*index, 2);
            if rgba[3] == 0.0 {
                continue;
            }
            let seen = Seen::new(&source, options, *index, depth(*index));
            for (p, pixel) in buffer.iter_mut().enumerate() {
                let at = DVec2::new((p % options.width_px) as f64 + 0.5, (p / options.width_px) as f64 + 0.5);
                let weight = seen.weight * footprint(standard.kernel, seen.squared(at)) / mass;
                (0..4).for_each(|c| pixel[c] += weight * rgba[c]);
            }
        }
        source.composite(&mut image, &buffer);
    }
    Ok(image)
}

/// Place of a sample in the picture, and the ellipse of its kernel.
struct Seen {
    at: DVec2,
    /// Main axes of the ellipse, of unit length, and samples per pixel along them.
    axes: [(DVec2, f64); 2],
    weight: f64,
}

impl Seen {
    fn new(source: &LiteralSamples, options: &RenderOptions, index: [usize; 3], depth: f64) -> Self {
        let camera = source.camera;
        let (width, height) = (options.width_px as f64, options.height_px as f64);
        let half_height = match camera.projection() {
            Projection::Orthographic { parallel_scale } => parallel_scale,
            Projection::Perspective { view_angle_rad } => depth * (view_angle_rad / 2.0).tan(),
        };
        let offset = source.world(index) - camera.position();
        let [right, up] = [camera.right(), camera.up()].map(|axis| axis.dot(offset) / half_height);
        let at = DVec2::new(0.5 * (width + height * right), 0.5 * (height - height * up));
        // Index offsets of a pixel's step, less the part along the ray.
        let pixel = 2.0 * half_height / height;
        let into = source.grid().index_from_world();
        let ray = into.transform_vector3(source.ray(index)).normalize();
        let steps = [camera.right() * pixel, -camera.up() * pixel].map(|step| {
            let step = into.transform_vector3(step);
            step - ray * ray.dot(step)
        });
        let [xx, xy, yy] = [steps[0].dot(steps[0]), steps[0].dot(steps[1]), steps[1].dot(steps[1])];
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        let axes = [angle, angle + std::f64::consts::FRAC_PI_2].map(|angle| {
            let axis = DVec2::from_angle(angle);
            let per_pixel = (steps[0] * axis.x + steps[1] * axis.y).length();
            (axis, per_pixel.min(1.0))
        });
        let volume = source.grid().world_from_index().matrix3.determinant().abs();
        let slab =
            if source.standard.view_angle_correction { source.distance.along_view } else { source.distance.across };
        Self { at, axes, weight: volume / (slab * pixel * pixel) * axes[0].1 * axes[1].1 }
    }

    /// Squared distance of a pixel's ray from the sample, in samples.
    fn squared(&self, pixel: DVec2) -> f64 {
        self.axes.iter().map(|(axis, per_pixel)| (axis.dot(pixel - self.at) * per_pixel).powi(2)).sum()
    }
}

/// Integral of the kernel along a ray at a squared distance from its middle, not normalised; of Catmull-Rom, the
/// kernel.
fn footprint(kernel: Kernel, squared: f64) -> f64 {
    if squared >= radius(kernel).powi(2) {
        return 0.0;
    }
    if kernel == Kernel::CatmullRom {
        return weight(kernel, squared.sqrt());
    }
    let step = 0.01;
    (-200..200).map(|i| step * weight(kernel, (squared + ((f64::from(i) + 0.5) * step).powi(2)).sqrt())).sum()
}

/// Integral of the footprint over the plane: over shells of the kernel, and over rings of Catmull-Rom's.
fn mass(kernel: Kernel) -> f64 {
    let step = 1e-4;
    let ring = |i: i32| {
        let r = (f64::from(i) + 0.5) * step;
        let of_ring =
            if kernel == Kernel::CatmullRom { std::f64::consts::TAU } else { 2.0 * std::f64::consts::TAU * r };
        step * of_ring * r * weight(kernel, r)
    };
    (0..20_000).map(ring).sum()
}

fn position(index: [usize; 3]) -> DVec3 {
    DVec3::from_array(index.map(|i| i as f64))
}
