//! The whole way from volume to picture: the one place that knows the order of the stages.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_compute::simd::{LANES, Level};
use wavesplat_core::{Camera, Composite, Error, Grid, Picture, RenderOptions, Result, Shading, TransferFunction};

use crate::base_picture::BasePicture;
use crate::base_plane::{BasePlane, base_planes};
use crate::bricks::Occupied;
use crate::by_gradient::ByGradient;
use crate::classify::Classifier;
use crate::composite::{Compositor, Over};
use crate::extras::Extras;
use crate::fade::Fade;
use crate::family::IndexRays;
use crate::fields::Field;
use crate::first_hit::FirstHit;
use crate::interval::Region;
use crate::labels::Labels;
use crate::light::{Dimness, LightTerms};
use crate::local_maximum::LocalMaximum;
use crate::noise::keeps_bounds;
use crate::project::Project;
use crate::rays::RayGeometry;
use crate::shade::{Shader, light_direction};
use crate::sheet::{Chunk, N_STRIPS, SheetGeometry, TILE_U, TILE_V};
use crate::slices::Slices;
use crate::tile::{SheetSpacing, TileJob, Work};
use crate::warp::warp;

/// Told about progress from worker threads; may stop the work.
pub trait Monitor: Sync {
    /// `fraction` of the work that is done, `0..=1`. `Break` stops; the result is then [`Error::Cancelled`].
    fn progress(&self, fraction: f32) -> ControlFlow<()>;
}

/// A monitor that does not mind.
impl Monitor for () {
    fn progress(&self, _: f32) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// What a picture took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// Texels that were reconstructed, all sheets.
    pub n_texels: u64,
    /// Sheets of tiles left out because nothing in them is visible.
    pub n_skipped_sheets: u64,
    /// Base planes drawn: one for parallel rays, up to six for perspective.
    pub n_base_planes: usize,
    /// Texels of the base planes.
    pub n_base_texels: u64,
    /// Sheets of each base plane.
    pub n_sheets: Vec<usize>,
    /// Samples drawn as empty because they are NaN or infinite.
    pub n_nonfinite_samples: usize,
    /// Threads that worked.
    pub n_threads: usize,
    /// Vectors that were used.
    pub simd: &'static str,
}

/// Draws a volume.
///
/// `slices` are those of the options' kernel; keep them for the next picture.
pub fn render(
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    monitor: &dyn Monitor,
) -> Result<(Picture, Report)> {
    render_labelled(slices, None, tf, camera, options, monitor)
}

/// As [`render`], with a segmentation beside the scan.
pub fn render_labelled(
    slices: &Slices,
    labels: Option<&Labels>,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    monitor: &dyn Monitor,
) -> Result<(Picture, Report)> {
    let whole = Part::whole(options);
    let (mut pictures, report) = render_parts(slices, labels, tf, camera, options, &[whole], monitor)?;
    Ok((pictures.remove(0), report))
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub first_px: [usize; 2],
    pub size_px: [usize; 2],
}

impl Part {
    fn whole(options: &RenderOptions) -> Self {
        Self { first_px: [0, 0], size_px: [options.width_px, options.height_px] }
    }

    /// The rays of its pixels.
    fn rays(&self, grid: &Grid, camera: &Camera, options: &RenderOptions) -> IndexRays {
        let whole = IndexRays::new(camera, grid.index_from_world(), options.width_px, options.height_px);
        whole.part(self.first_px)
    }
}

/// Draws parts of the picture as they are in the whole, but that each has texels of its own: in perspective they lie as
/// the part's own pixels do.
pub(crate) fn render_parts(
    slices: &Slices,
    labels: Option<&Labels>,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    parts: &[Part],
    monitor: &dyn Monitor,
) -> Result<(Vec<Picture>, Report)> {
    parallel::with_threads(options.n_threads, || {
        let full = [options.width_px, options.height_px];
        let (base_pictures, mut report) =
            draw_base_planes(Level::best(), (slices, labels), tf, camera, options, parts, monitor)?;
        report.n_threads = parallel::n_threads();
        // One read per texel that a pixel covers along each axis.
        let reads = if options.composite.is_projection() { 1 } else { options.oversampling.round().max(1.0) as usize };
        let peak = if options.composite.is_projection() {
            f32::INFINITY
        } else {
            options.shading.as_ref().map_or(1.0, brightest)
        };
        let draw = |(part, base_pictures): (&Part, &Vec<BasePicture>)| {
            let Part { first_px, size_px: size } = part;
            let rays = part.rays(slices.grid(), camera, options);
            let warped = warp(Level::best(), base_pictures, &rays, *size, reads, peak, options.with_depth);
            let mut picture =
                Picture { width_px: size[0], height_px: size[1], rgba: warped.rgba, depth: None, value: None };
            if options.composite.is_projection() {
                color_projection(&mut picture, slices.grid(), tf, options.composite);
            }
            picture.depth = warped.ray_parameter.map(|parameters| {
                // The ray's direction has unit length along the view; its world length differs per pixel in perspective.
                let world_length = |i: usize| {
                    let [x, y] = [i % size[0] + first_px[0], i / size[0] + first_px[1]].map(|px| px as f64 + 0.5);
                    camera.ray(x, y, full[0], full[1]).direction.length()
                };
                parameters.iter().enumerate().map(|(i, t)| (f64::from(*t) * world_length(i)) as f32).collect()
            });
            if let Some(background) = options.background {
                picture.over_background(background);
            }
            picture
        };
        Ok((parts.iter().zip(&base_pictures).map(draw).collect(), report))
    })
}

/// Largest colour that shading makes of white.
pub(crate) fn brightest(shading: &Shading) -> f32 {
    let channel = |c: usize| shading.lights.iter().map(|l| l.rgb[c]).sum::<f32>();
    let light = (0..3).map(channel).fold(0.0, f32::max);
    (shading.ambient + (shading.diffuse + shading.specular) * light).max(1.0)
}

/// Draws the base planes, before the warp.
pub fn render_base_planes(
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    monitor: &dyn Monitor,
) -> Result<(Vec<BasePicture>, Report)> {
    render_base_planes_at(Level::best(), slices, tf, camera, options, monitor)
}

/// As [`render_base_planes`], with the vectors of a level; all levels give the same bits.
pub fn render_base_planes_at(
    level: Level,
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    monitor: &dyn Monitor,
) -> Result<(Vec<BasePicture>, Report)> {
    let (mut pictures, report) =
        draw_base_planes(level, (slices, None), tf, camera, options, &[Part::whole(options)], monitor)?;
    Ok((pictures.remove(0), report))
}

/// Draws the base planes of parts of the picture.
fn draw_base_planes(
    level: Level,
    (slices, labels): (&Slices, Option<&Labels>),
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    parts: &[Part],
    monitor: &dyn Monitor,
) -> Result<(Vec<Vec<BasePicture>>, Report)> {
    options.validate()?;
    let region = Region::new(slices.grid(), options)?;
    let planes = |part: &Part| {
        let rays = part.rays(slices.grid(), camera, options);
        base_planes(camera, &rays, part.size_px, options.oversampling, region.bounds)
    };
    let planes: Vec<_> = parts.iter().map(planes).collect::<Result<_>>()?;
    let mut scene = Scene::new(level, slices, tf, camera, options);
    let light = scene.light(labels)?;
    scene.set_fields(labels, light.as_ref())?;
    let mut report = Report {
        n_nonfinite_samples: slices.grid().statistics().n_nonfinite,
        n_base_planes: planes.iter().map(Vec::len).sum(),
        simd: level.name(),
        ..Report::default()
    };
    let n_tiles = |p: &BasePlane| p.size[0].div_ceil(TILE_U) * p.size[1].div_ceil(TILE_V);
    let progress = Progress::new(monitor, planes.iter().flatten().map(n_tiles).sum());
    // Parts are small: each is drawn on one thread for the most part.
    let drawn = parallel::map(parts.len(), |part| {
        let draw = |plane: &BasePlane| scene.draw_plane(plane, &region, &progress);
        planes[part].iter().map(draw).collect::<Result<Vec<_>>>()
    });
    let mut pictures = Vec::new();
    for drawn in drawn {
        let mut of_part = Vec::new();
        for (picture, work, n_sheets) in drawn? {
            report.n_texels += work.n_texels;
            report.n_skipped_sheets += work.n_skipped;
            report.n_sheets.push(n_sheets);
            report.n_base_texels += picture.plane.size.iter().product::<usize>() as u64;
            of_part.push(picture);
        }
        pictures.push(of_part);
    }
    Ok((pictures, report))
}

/// Change of a slab's opacity or colour, over all densities, from which slabs are pre-integrated.
const STEEP: f32 = 0.35;

/// A ray stops when less than this share of light comes through: a tenth of a grey level of 1024.
const OPAQUE_ENOUGH: f32 = 1.0 - 1e-4;

/// The same where the picture is to be that of the method's plain sheets: an eighth of a 16-bit grey level.
const OPAQUE: f32 = 1.0 - 2e-6;

/// Whether a transfer function can change opacity or colour by a visible amount within a voxel; of a coarser level,
/// within one of the finest: its pictures are smaller, and a smooth function is as smooth on it.
pub fn is_steep(grid: &Grid, tf: &TransferFunction) -> bool {
    let thickness = slab_of_the_finest(grid, tf);
    let classifier = Classifier::new(tf, grid.density_from_sample(), grid.density_range(), thickness);
    classifier.variation(thickness) >= STEEP
}

/// Thickness of a slab of two sheets a slice, of a coarser level one of the finest, in `opacity_unit`s.
fn slab_of_the_finest(grid: &Grid, tf: &TransferFunction) -> f64 {
    0.5 * grid.default_opacity_unit() / tf.opacity_unit().unwrap_or(grid.default_opacity_unit())
}

/// Everything that does not depend on the base plane.
struct Scene<'a> {
    level: Level,
    grid: &'a Grid,
    slices: &'a Slices<'a>,
    camera: &'a Camera,
    options: &'a RenderOptions,
    tf: &'a TransferFunction,
    classifier: Classifier,
    opacity_unit: f64,
    /// Of a typical slab, in `opacity_unit`s.
    slab_thickness: f64,
    labels: Option<&'a Labels>,
    fields: Vec<Field<'a>>,
    light: Option<LightTerms>,
}

/// Shares of light that get to the cells of a coarse volume.
struct Light {
    dimness: Dimness,
    openness: Option<Vec<f32>>,
    shadow: Option<Vec<f32>>,
}

impl<'a> Scene<'a> {
    fn new(
        level: Level,
        slices: &'a Slices<'a>,
        tf: &'a TransferFunction,
        camera: &'a Camera,
        options: &'a RenderOptions,
    ) -> Self {
        let grid = slices.grid();
        let opacity_unit = tf.opacity_unit().unwrap_or(grid.default_opacity_unit());
        let slab_thickness = grid.mean_spacing() / options.sheets_per_slice / opacity_unit;
        let classifier = Classifier::new(tf, grid.density_from_sample(), slices.range(), slab_thickness);
        let (labels, fields, light) = (None, Vec::new(), None);
        Self {
            level,
            grid,
            slices,
            camera,
            options,
            tf,
            classifier,
            opacity_unit,
            slab_thickness,
            labels,
            fields,
            light,
        }
    }

    /// What is held off of the light, where that is wanted.
    fn light(&self, labels: Option<&Labels>) -> Result<Option<Light>> {
        let shading = self.options.shading.as_ref().filter(|_| self.options.composite == Composite::Over);
        let Some(shading) = shading.filter(|s| s.ambient_occlusion > 0.0 || s.shadow > 0.0) else { return Ok(None) };
        let dimness = Dimness::new(self.slices, &self.classifier, self.opacity_unit, labels)?;
        let size = self.grid.size();
        let sides = self.grid.spacing() * DVec3::from_array(size.map(|n| n as f64));
        let radius = shading.occlusion_radius.unwrap_or(0.1 * sides.max_element());
        let openness = (shading.ambient_occlusion > 0.0).then(|| dimness.openness(radius));
        let first = shading.lights.first().filter(|_| shading.shadow > 0.0);
        let shadow = first.map(|light| dimness.shadow(light_direction(self.camera, light)));
        Ok(Some(Light { dimness, openness, shadow }))
    }

    /// Lists the fields of light and labels.
    fn set_fields(&mut self, labels: Option<&'a Labels>, light: Option<&'a Light>) -> Result<()> {
        self.labels = labels.filter(|_| self.options.composite == Composite::Over);
        if let (Some(light), Some(shading)) = (light, &self.options.shading) {
            let mut terms = LightTerms::default();
            if let Some(openness) = &light.openness {
                terms.openness = Some((self.fields.len(), shading.ambient_occlusion));
                self.fields.push(light.dimness.field(openness)?);
            }
            if let Some(shadow) = &light.shadow {
                terms.shadow = Some((self.fields.len(), shading.shadow));
                self.fields.push(light.dimness.field(shadow)?);
            }
            self.light = Some(terms);
        }
        Ok(())
    }

    fn draw_plane(
        &self,
        plane: &BasePlane,
        region: &Region,
        progress: &Progress,
    ) -> Result<(BasePicture, Work, usize)> {
        let world_from_index = self.grid.world_from_index();
        let shaded = !self.options.composite.is_projection();
        let shading = self.options.shading.as_ref().filter(|_| shaded);
        let shader_for =
            |range| shading.map(|s| Shader::new(s, self.camera, world_from_index.matrix3, &plane.family, range));
        let shader = shader_for(self.slices.range());
        let mut extras = Extras::default();
        let mut label_fields = Vec::new();
        if self.options.composite == Composite::Over {
            let map = self.grid.density_from_sample();
            extras.by_gradient = ByGradient::new(self.tf, world_from_index.matrix3, &plane.family, map);
            extras.light = self.light;
            if let Some(labels) = self.labels {
                extras.labels = Some(labels.terms().after(self.fields.len()));
                extras.label_shader = shader_for([0.0, 1.0]);
                label_fields = labels.fields();
            }
        }
        let gradient_offset = shading.map(|s| s.gradient_offset);
        let gradient_offset =
            gradient_offset.or(extras.by_gradient.as_ref().map(|_| Shading::default().gradient_offset));
        let size = self.grid.size();
        let spacing = SheetSpacing::new(size[plane.family.axes[2]], self.options.sheets_per_slice);
        let axes = plane.family.axes;
        let bricks = self.slices.bricks();
        let variant = &self.options.variant;
        let fade = match self.options.composite {
            Composite::DepthShadedMaximum { strength, .. } => {
                Some(Fade::new(strength, self.camera, self.grid, region.bounds))
            }
            _ => None,
        };
        let density = |value: f64| {
            let (offset, scale) = self.grid.density_from_sample();
            ((value - offset) * scale) as f32
        };
        let job = |opacity_unit: f64, occupied: Option<Arc<Occupied>>| TileJob {
            geometry: SheetGeometry::new(self.level, plane, self.slices, size, gradient_offset, variant, spacing.step),
            rays: RayGeometry {
                plane,
                region,
                world_from_index,
                opacity_unit,
                view_angle_correction: variant.view_angle_correction,
                fade,
            },
            spacing,
            occupied: occupied.filter(|_| keeps_bounds(variant, self.slices.kernel())),
            fields: self
                .fields
                .iter()
                .chain(&label_fields)
                .map(|f| SheetGeometry::of_field(self.level, plane, f))
                .collect(),
        };
        let with_depth = self.options.with_depth;
        let (picture, work) = match self.options.composite {
            Composite::Over => {
                let plain = !(self.options.refined && variant.may_pre_integrate());
                let varies = |thickness| self.classifier.variation(thickness) >= STEEP;
                let is_steep = !plain
                    && varies(self.slab_thickness)
                    && (self.grid.coarseness() <= 1.0 || varies(slab_of_the_finest(self.grid, self.tf)));
                // A function of two dimensions has no integral along a slab.
                let is_steep = is_steep && !extras.by_gradient.as_ref().is_some_and(ByGradient::decides_color);
                let opaque = if plain { OPAQUE } else { OPAQUE_ENOUGH };
                let mut occupied = Some(bricks.occupied(axes, |[lo, hi]| self.classifier.any_opacity(lo, hi)));
                if let Some(field) = extras.matter_field() {
                    let matter = label_fields[field - self.fields.len()].slices.bricks();
                    let covered = matter.occupied(axes, |[_, hi]| hi > 0.0);
                    occupied = occupied.and_then(|occupied| occupied.or(&covered)).map(Arc::new);
                }
                let (classifier, shader) = (&self.classifier, shader.as_ref());
                let job = job(self.opacity_unit, occupied);
                if extras.any() {
                    let over = || Over::<true>::new(classifier, shader, &extras, is_steep, opaque, with_depth);
                    draw_tiles(&job, progress, with_depth, over)
                } else {
                    let over = || Over::<false>::new(classifier, shader, &extras, is_steep, opaque, with_depth);
                    draw_tiles(&job, progress, with_depth, over)
                }
            }
            Composite::FirstHit { iso_value } => {
                let iso = density(iso_value);
                // A surface needs densities on both sides.
                let occupied = bricks.occupied(axes, |[lo, hi]| lo < iso && hi >= iso);
                let first_hit = || FirstHit::new(iso, &self.classifier, shader.as_ref());
                draw_tiles(&job(self.opacity_unit, Some(occupied)), progress, with_depth, first_hit)
            }
            Composite::LocalMaximum { threshold } => {
                draw_tiles(&job(1.0, None), progress, with_depth, || LocalMaximum::new(density(threshold)))
            }
            projection @ (Composite::Maximum
            | Composite::DepthShadedMaximum { .. }
            | Composite::Minimum
            | Composite::Mean
            | Composite::Sum
            | Composite::XRay { .. }) => {
                // Lengths of projections are world lengths.
                draw_tiles(&job(1.0, None), progress, with_depth, || Project::new(projection, density))
            }
        }?;
        Ok((picture, work, spacing.n_slabs + 1))
    }
}

/// Runs all tiles of a base plane, each on its own, and puts them together.
fn draw_tiles<C: Compositor>(
    job: &TileJob,
    progress: &Progress,
    with_depth: bool,
    compositor: impl Fn() -> C + Sync + Send,
) -> Result<(BasePicture, Work)> {
    let plane = job.geometry.plane;
    let [n_tiles_u, n_tiles_v] = job.n_tiles();
    // Positions along rays and along w differ by this sign.
    let sign = if plane.family.ascending { 1.0 } else { -1.0 };
    let all = Mutex::new((BasePicture::new(plane.clone(), with_depth), Work::default()));
    parallel::for_each(n_tiles_u * n_tiles_v, |t| {
        if progress.is_stopped() {
            return;
        }
        let mut tile_work = Work::default();
        let (tile_u, tile_v) = (t % n_tiles_u, t / n_tiles_u);
        let drawn = job.run([tile_u, tile_v], &compositor, &mut tile_work);
        let mut all = all.lock().unwrap_or_else(PoisonError::into_inner);
        let (picture, work) = &mut *all;
        work.n_texels += tile_work.n_texels;
        work.n_skipped += tile_work.n_skipped;
        if let Some(compositor) = drawn {
            for strip in 0..N_STRIPS {
                for row in 0..TILE_V {
                    let (i, j) = (tile_u * TILE_U + strip * LANES, tile_v * TILE_V + row);
                    if i < plane.size[0] && j < plane.size[1] {
                        let texels = compositor.finish(Chunk { strip, row });
                        let w_half = texels.s_half.map(|s| s.map(|s| s * sign));
                        picture.put(i, j, &texels.rgba, w_half.as_ref());
                    }
                }
            }
        }
        drop(all);
        progress.tile_done();
    });
    if progress.is_stopped() {
        return Err(Error::Cancelled);
    }
    Ok(all.into_inner().unwrap_or_else(PoisonError::into_inner))
}

/// Tells a monitor of tiles that are done, and remembers that it asked to stop.
pub(crate) struct Progress<'a> {
    monitor: &'a dyn Monitor,
    n_done: AtomicUsize,
    n_all: usize,
    stopped: AtomicBool,
}

impl<'a> Progress<'a> {
    /// Of this many tiles.
    pub(crate) fn new(monitor: &'a dyn Monitor, n_all: usize) -> Self {
        Self { monitor, n_done: AtomicUsize::new(0), n_all, stopped: AtomicBool::new(false) }
    }

    /// Whether the monitor asked to stop.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed)
    }

    /// One more is done.
    pub(crate) fn tile_done(&self) {
        let done = self.n_done.fetch_add(1, Ordering::Relaxed) + 1;
        if self.monitor.progress(done as f32 / self.n_all as f32).is_break() {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }
}

/// Turns density and coverage into values and colours: one look-up per pixel, after the warp.
fn color_projection(picture: &mut Picture, grid: &Grid, tf: &TransferFunction, composite: Composite) {
    let (offset, scale) = grid.density_from_sample();
    let mut values = Vec::with_capacity(picture.rgba.len());
    for pixel in &mut picture.rgba {
        let coverage = f64::from(pixel[3]);
        if coverage <= 0.0 {
            values.push(f32::NAN);
            *pixel = [0.0; 4];
            continue;
        }
        let density = f64::from(pixel[0]) / coverage;
        // A sum of densities lacks the offset once per unit of length.
        let length = if composite == Composite::Sum { f64::from(pixel[1]) / coverage } else { 1.0 };
        let value = match composite {
            // What is above the clear value has no offset.
            Composite::XRay { attenuation, .. } => (-attenuation * density / scale).exp(),
            _ => density / scale + offset * length,
        };
        let [r, g, b] = tf.color(value);
        let opacity = tf.opacity(value) * coverage;
        values.push(value as f32);
        *pixel = [r * opacity, g * opacity, b * opacity, opacity].map(|c| c as f32);
    }
    picture.value = Some(values);
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DAffine3;
    use wavesplat_core::{ColorNode, OpacityNode, Statistics};

    #[test]
    fn a_smooth_function_is_smooth_on_every_level() {
        let statistics = Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
        let grid = |spacing: f64| {
            Grid::new("", [9; 3], DAffine3::from_scale(DVec3::splat(spacing)), statistics, false).unwrap()
        };
        let finest = grid(1.0);
        let level = grid(4.0).as_level_of(finest.default_opacity_unit(), finest.bounds());
        let curve = |nodes: [(f64, f64); 2], unit: Option<f64>| {
            let opacity = nodes.map(|(value, opacity)| OpacityNode { value, opacity }).to_vec();
            TransferFunction::new(opacity, vec![ColorNode { value: 0.0, rgb: [1.0; 3] }], unit).unwrap()
        };
        let (soft, hard) = (curve([(0.0, 0.0), (1.0, 0.3)], None), curve([(0.5, 0.0), (0.51, 1.0)], None));
        for grid in [&finest, &level] {
            assert!(!is_steep(grid, &soft) && is_steep(grid, &hard));
        }
        // The same samples as a volume of their own have voxels four times as thick.
        assert!(is_steep(&grid(4.0), &curve([(0.0, 0.0), (1.0, 0.3)], Some(1.0))));
    }
}
