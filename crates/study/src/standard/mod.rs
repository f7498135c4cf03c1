//! Standard splatting (Westover 1990): colours and opacities are splatted, where high-resolution splatting splats
//! densities.
//!
//! Every sample is classified and shaded first, with its own value, the central difference of its neighbours, and the
//! opacity of a slab one slice distance thick. Its associated colour and its opacity are then splatted with a footprint
//! into a sheet buffer, and the sheet buffers are composited with *over*, front to back. It is fast and simple, and it
//! is the technique that `wavesplat_splat` is compared with: colours are blended after classification, so edges blur,
//! and what a kernel spreads across a surface was coloured before it was known to be a surface.
//!
//! Two sheet buffers ([`Buffer`]):
//!
//! - *axis*: parallel to the slices across the axis nearest to the view, one per slice, then mapped to the view plane.
//!   There a separable kernel integrates analytically: the footprint is `h(u) h(v)`, since `∫ h(w) dw = 1`.
//! - *view*: parallel to the view plane. The samples are sorted by depth into slabs as thick as the distance from slice
//!   to slice along the view, and each is drawn whole, with a radially symmetric footprint, into the buffer of the slab
//!   that its centre lies in (Mueller and Crawfis 1998 have such sheets). A sphere in index space is an ellipse in the
//!   picture: footprints follow any grid, and in perspective the depth of each sample.
//!
//! Two thicknesses ([`StandardOptions::view_angle_correction`]). From slice to slice a ray that meets the slices at the
//! angle `θ` to their normal runs `dz / cos θ`. With the correction, opacities are for that length. Without it
//! they are for `dz` from everywhere, as if the slices were seen head-on: in buffers parallel to the slices
//! oblique views come out too clear, and in buffers parallel to the view plane, where the footprints of samples packed
//! closer by `1 / cos θ` add up, too opaque and too bright.
//!
//! Choices that the sources leave open:
//!
//! - B-spline kernels are not prefiltered: what is splatted are colours, and the coefficients of colours would be
//!   neither colours nor opacities. They smooth, as Westover's Gaussian does. Weights are normalised to sum 1 at every
//!   texel (*axis*; in front of the outermost samples they fade out, since splats are drawn whole) or on average
//!   (*view*).
//! - The sum of footprints over classified samples can leave the range of a colour: buffers parallel to the view plane
//!   hold uneven numbers of samples, and Catmull-Rom has negative weights. Before compositing, opacity is clamped to
//!   `0..=1`, and every colour channel to between 0 and the largest that opacity allows.
//! - Where texels are wider apart than samples, footprints are widened to a texel, so that no sample falls between them
//!   (Swan et al., *An anti-aliasing technique for splatting*, 1997).
//! - Crop boxes and clip planes keep the samples whose centres are inside. NaN and infinite samples are empty.
//! - In perspective, samples nearer to the eye than half a slice (*axis*) or one slab (*view*) are left out.
//!
//! The stages: densities of a tile's samples (`samples.rs`), classified and shaded (`shaded.rs`), splatted and
//! composited (`axis.rs`, `view.rs`) with tables of the kernel (`footprint.rs`). The literal twin is
//! [`crate::reference::standard`].
//!
//! Sources: Westover, *Footprint evaluation for volume rendering* (1990); Mueller, Crawfis, *Eliminating popping
//! artifacts in sheet buffer-based splatting* (1998).

mod axis;
mod footprint;
mod resample;
mod samples;
mod shaded;
mod view;

use std::sync::Arc;

use glam::DVec3;
use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{
    Camera, Composite, Error, Gradient, Grid, Kernel, Picture, Projection, RenderOptions, Result, TransferFunction,
};
use wavesplat_splat::kernel::prefilter;
use wavesplat_splat::kernel::weights::radius;
use wavesplat_splat::optics::gradient_opacity::GradientOpacity;
use wavesplat_splat::optics::shade::Shader;
use wavesplat_splat::optics::visibility_cache::TabulatedFunction;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::picture::warp::warp;
use wavesplat_splat::render::plan::brightest;
use wavesplat_splat::render::progress::{Progress, ProgressCallback};
use wavesplat_splat::source::occupancy::OccupancyGrid;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::view::base_plane::{BasePlane, base_planes};
use wavesplat_splat::view::family::{Family, IndexRays};
use wavesplat_splat::view::index_frame::world_gradient_from_index;
use wavesplat_splat::view::region::Region;

use shaded::Sight;

pub(crate) use {axis::NEAREST_SLICE, footprint::widening, view::NEAREST_SLAB};

/// Orientation of the sheet buffers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Buffer {
    /// Parallel to the slices across the axis nearest to the view.
    #[default]
    Axis,
    /// Parallel to the view plane.
    View,
}

impl Buffer {
    /// Both orientations with their public names.
    pub const NAMES: [(&'static str, Self); 2] = [("axis", Self::Axis), ("view", Self::View)];

    /// The orientation with a public name.
    pub fn from_name(name: &str) -> Result<Self> {
        let found = Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, buffer)| *buffer);
        found.ok_or_else(|| Error::UnknownName {
            what: "buffer",
            name: name.to_owned(),
            known: Self::NAMES.map(|(known, _)| known).join(", "),
        })
    }
}

/// Options of standard splatting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StandardOptions {
    /// Orientation of the sheet buffers.
    pub buffer: Buffer,
    /// Whether opacities belong to the length of a ray from slice to slice, or to the slice distance.
    pub view_angle_correction: bool,
    /// Kernel that colours are splatted with, not prefiltered.
    pub kernel: Kernel,
}

impl Default for StandardOptions {
    fn default() -> Self {
        Self { buffer: Buffer::Axis, view_angle_correction: true, kernel: Kernel::Linear }
    }
}

/// Statistics of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct StandardReport {
    /// Samples that were splatted, once for every tile of the picture that they were splatted into.
    pub n_splats: u64,
    /// Number of sheet buffers of each base plane, or of the picture.
    pub n_sheets: Vec<usize>,
    /// Samples drawn as empty because they are NaN or infinite.
    pub n_nonfinite_samples: usize,
    /// Number of threads that worked.
    pub n_threads: usize,
    /// Name of the SIMD level.
    pub simd: &'static str,
}

/// Draws a volume by standard splatting.
///
/// `slices` must be prepared with a kernel that needs no prefilter, such as [`wavesplat_core::Kernel::Linear`],
/// whatever the kernel of `standard`. Of the options, `sheets_per_slice`, `pre_integration` and `early_ray_termination`
/// have no meaning here and are not used. The picture does not depend on the number of threads.
pub fn render(
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    standard: StandardOptions,
    monitor: &dyn ProgressCallback,
) -> Result<(Picture, StandardReport)> {
    let scene = StandardScene::new(Level::best(), slices, tf, camera, options, standard)?;
    parallel::with_threads(options.n_threads, || {
        let mut report = scene.report();
        let size = [options.width_px, options.height_px];
        let rgba = match standard.buffer {
            Buffer::Axis => {
                let rays = IndexRays::new(camera, slices.grid().index_from_world(), size[0], size[1]);
                let pictures = scene.draw_base_planes(monitor, &mut report)?;
                let reads_per_axis = options.oversampling.round().max(1.0) as usize;
                warp(scene.level, &pictures, &rays, size, reads_per_axis, scene.peak, false, None).rgba
            }
            Buffer::View => view::draw(&scene, monitor, &mut report)?,
        };
        let mut picture = Picture { width_px: size[0], height_px: size[1], rgba, depth: None, value: None };
        picture.finish(options.shading.as_ref(), options.background);
        Ok((picture, report))
    })
}

/// Draws the base planes of buffers parallel to the slices, before they are mapped to the view plane.
pub fn render_base_planes(
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    standard: StandardOptions,
) -> Result<Vec<BasePicture>> {
    let scene = StandardScene::new(Level::best(), slices, tf, camera, options, standard)?;
    scene.draw_base_planes(&(), &mut scene.report())
}

/// The base planes that a picture needs, with room for splats, which reach beyond the samples.
pub(crate) fn planes(
    camera: &Camera,
    grid: &Grid,
    options: &RenderOptions,
    kernel: Kernel,
    region: &Region,
) -> Result<Vec<BasePlane>> {
    let size = [options.width_px, options.height_px];
    let rays = IndexRays::new(camera, grid.index_from_world(), size[0], size[1]);
    let reach = DVec3::splat(radius(kernel));
    let [lo, hi] = region.bounds;
    base_planes(camera, &rays, size, options.oversampling, [lo - reach, hi + reach])
}

/// Checks the options, and refuses those that standard splatting does not have.
pub(crate) fn validate(options: &RenderOptions) -> Result<()> {
    options.validate()?;
    let refuse = |what: &str, value: String, allowed, mend| Err(Error::out_of_range(what, value, allowed, mend));
    if options.composite != Composite::Over {
        let mend = "standard splatting splats colours; draw projections by high-resolution splatting";
        return refuse("composite of standard splatting", format!("{:?}", options.composite), "over", mend);
    }
    if options.with_depth {
        let mend = "sheet buffers have no surfaces; take the depth from high-resolution splatting";
        return refuse("depth of standard splatting", "wanted".to_owned(), "available", mend);
    }
    if let Some(shading) = &options.shading
        && shading.gradient != Gradient::Difference(1.0)
    {
        let mend = "samples are shaded with the differences of their neighbours; pass Shading.headlight()";
        let value = format!("{:?}", shading.gradient);
        return refuse("gradient of standard splatting", value, "differences over one voxel", mend);
    }
    if let Some(shading) = &options.shading
        && (shading.ambient_occlusion != 0.0 || shading.shadow != 0.0)
    {
        let mend = "samples are shaded before they are splatted; draw ambient occlusion and shadows by high-resolution splatting";
        let value = format!("ambient_occlusion {}, shadow {}", shading.ambient_occlusion, shading.shadow);
        return refuse("light of standard splatting", value, "without occlusion and shadow", mend);
    }
    Ok(())
}

/// Distances of neighbouring slices, in world units.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SliceDistance {
    /// Along the normal of the slices.
    pub across: f64,
    /// Along the camera's view direction.
    pub along_view: f64,
}

impl SliceDistance {
    /// The distances of the slices across the axis that a view direction runs most along.
    pub fn new(grid: &Grid, forward: DVec3) -> Self {
        let direction = grid.index_from_world().transform_vector3(forward);
        let family = Family::of(direction);
        let gradient = world_gradient_from_index(grid.world_from_index().matrix3, &family);
        Self { across: gradient.z_axis.length().recip(), along_view: family.uvw(direction)[2].abs().recip() }
    }
}

/// Parts of a scene that do not depend on the axis that rays run along.
struct StandardScene<'a> {
    level: Level,
    grid: &'a Grid,
    slices: &'a Slices<'a>,
    tf: &'a TransferFunction,
    camera: &'a Camera,
    options: &'a RenderOptions,
    standard: StandardOptions,
    classifier: TabulatedFunction,
    region: Region,
    opacity_unit: f64,
    /// Largest colour that shading can make.
    peak: f32,
}

/// Parts of a scene that depend on the axis that rays run along.
struct FamilyScene<'a> {
    scene: &'a StandardScene<'a>,
    family: Family,
    occupied: Option<Arc<OccupancyGrid>>,
    shader: Option<Shader>,
    by_gradient: Option<GradientOpacity>,
    sight: Sight,
}

impl<'a> StandardScene<'a> {
    fn new(
        level: Level,
        slices: &'a Slices<'a>,
        tf: &'a TransferFunction,
        camera: &'a Camera,
        options: &'a RenderOptions,
        standard: StandardOptions,
    ) -> Result<Self> {
        validate(options)?;
        if prefilter::pole(slices.kernel()).is_some() {
            let mend =
                "standard splatting splats samples, not spline coefficients; prepare the slices with Kernel::Linear";
            let value = format!("{:?}", slices.kernel());
            return Err(Error::out_of_range("kernel of the slices", value, "one without prefilter", mend));
        }
        let grid = slices.grid();
        let opacity_unit = tf.opacity_unit().unwrap_or(grid.default_opacity_unit());
        let thickness = grid.mean_spacing() / opacity_unit;
        let classifier = TabulatedFunction::new(slices, tf, thickness);
        let region = Region::new(grid, options)?;
        let peak = options.shading.as_ref().map_or(1.0, brightest);
        Ok(Self { level, grid, slices, tf, camera, options, standard, classifier, region, opacity_unit, peak })
    }

    fn report(&self) -> StandardReport {
        StandardReport {
            n_nonfinite_samples: self.grid.statistics().n_nonfinite,
            n_threads: parallel::n_threads(),
            simd: self.level.name(),
            ..StandardReport::default()
        }
    }

    fn draw_base_planes(
        &self,
        monitor: &dyn ProgressCallback,
        report: &mut StandardReport,
    ) -> Result<Vec<BasePicture>> {
        let planes = planes(self.camera, self.grid, self.options, self.standard.kernel, &self.region)?;
        let progress = Progress::new(monitor, planes.iter().map(axis::n_tiles).sum());
        let mut pictures = Vec::new();
        for plane in planes {
            let family = FamilyScene::new(self, plane.family);
            let (picture, n_splats) = axis::draw_plane(&family, &plane, &progress)?;
            report.n_splats += n_splats;
            report.n_sheets.push(self.grid.size()[plane.family.axes[2]]);
            pictures.push(picture);
        }
        Ok(pictures)
    }

    /// The camera's position in index space, where rays begin; `None` for parallel rays.
    fn eye(&self) -> Option<DVec3> {
        let is_parallel = matches!(self.camera.projection(), Projection::Orthographic { .. });
        (!is_parallel).then(|| self.grid.index_from_world().transform_point3(self.camera.position()))
    }
}

impl<'a> FamilyScene<'a> {
    fn new(scene: &'a StandardScene<'a>, family: Family) -> Self {
        let matrix = scene.grid.world_from_index().matrix3;
        let shader = scene.options.shading.as_ref();
        let bricks = scene.slices.bricks();
        Self {
            scene,
            family,
            occupied: bricks.map(|bricks| bricks.occupied(family.axes, scene.classifier.visible_ranges(bricks))),
            shader: shader.map(|s| Shader::new(s, scene.camera, matrix, &family, scene.slices.range())),
            by_gradient: GradientOpacity::new(scene.tf, matrix, &family, scene.grid.density_from_sample(), None),
            sight: Sight::new(scene, &family),
        }
    }

    /// Whether samples need gradients, and so their neighbours.
    fn needs_gradient(&self) -> bool {
        self.shader.is_some() || self.by_gradient.is_some()
    }

    /// Samples along u, v, w.
    fn size(&self) -> [usize; 3] {
        self.family.axes.map(|a| self.scene.grid.size()[a])
    }

    /// Index position of a sample given along u, v, w.
    fn position(&self, uvw: [f64; 3]) -> DVec3 {
        let mut position = DVec3::ZERO;
        (0..3).for_each(|c| position[self.family.axes[c]] = uvw[c]);
        position
    }
}
