//! A frame of a scene: prepared, planned, drawn, warped.

use std::ops::ControlFlow;
use std::sync::Mutex;

use wavesplat_compute::locks::{lock, unlocked};
use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Composite, DepthColors, Error, Kernel, LADDER, Picture, RenderOptions, Result};
use wavesplat_splat::quality::ladder::{Ladder, Sampling};
use wavesplat_splat::quality::target_psnr::{Estimate, render_to_psnr};
use wavesplat_splat::render::frame::{finish, slices_of};
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{ColorField, Layer, ProgressCallback, Report};

use crate::device::{Device, DrawnBy};
use crate::quality::{self, Effort, Quality};
use crate::scene::{Scene, SceneLayer, SceneVolume};

/// Options of a frame.
#[derive(Clone, Debug)]
pub struct FrameOptions {
    /// Reconstruction kernel between samples.
    pub kernel: Kernel,
    /// Composite operator along the rays.
    pub composite: Composite,
    /// Sampling, or the quality or PSNR that determines it.
    pub effort: Effort,
    /// Whether the picture has depth.
    pub with_depth: bool,
    /// Hues by the place of the extreme, for projections that have one.
    pub depth_colors: Option<DepthColors>,
    /// Whether slabs between sheets are pre-integrated where the transfer function is steep.
    pub pre_integration: bool,
    /// Whether rays stop at a transmittance of 1e-4; else they continue until nothing more can be seen.
    pub early_ray_termination: bool,
    /// Device that should draw.
    pub device: Device,
    /// Number of threads; `None` keeps the caller's, by default all processors. The picture does not depend on it.
    pub n_threads: Option<usize>,
    /// Clock in seconds from any moment on, for [`Frame::times`].
    pub clock: Option<fn() -> f64>,
}

impl Default for FrameOptions {
    fn default() -> Self {
        Self {
            kernel: Kernel::Linear,
            composite: Composite::Over,
            effort: Effort::Named(Quality::Normal),
            with_depth: false,
            depth_colors: None,
            pre_integration: true,
            early_ray_termination: true,
            device: Device::Cpu,
            n_threads: None,
            clock: None,
        }
    }
}

/// A picture and its report.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Premultiplied RGBA, depth, values of projections.
    pub picture: Picture,
    /// Work that the frame took.
    pub report: Report,
    /// Device that drew the frame.
    pub drawn_by: DrawnBy,
    /// Sheets per slice and texels per pixel of the frame.
    pub sampling: Sampling,
    /// Estimate of the error, with [`Effort::Psnr`].
    pub estimate: Option<Estimate>,
    /// Seconds that the stages took, with [`FrameOptions::clock`].
    pub times: Option<StageTimes>,
}

/// Seconds that the stages of a frame took.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StageTimes {
    /// Preparing the samples for the kernel: min-max bricks, spline coefficients; next to nothing after the first
    /// frame.
    pub prepare: f64,
    /// Planning: base planes, tables, occupancy, ambient occlusion.
    pub plan: f64,
    /// Drawing of the base planes. With a wanted PSNR: pilots, plan, base planes and warp.
    pub draw: f64,
    /// Warp, and colours of projections.
    pub warp: f64,
}

impl Scene<'_> {
    /// Draws a picture of `[width, height]` pixels.
    ///
    /// # Errors
    ///
    /// [`Error`] if an option is out of its range, nothing is left of the volume, or the picture needs too much memory.
    pub fn render(&self, camera: &Camera, size_px: [usize; 2], options: &FrameOptions) -> Result<Frame> {
        self.render_with_progress(camera, size_px, options, &())
    }

    /// Draws like [`Scene::render`]; `callback` is called from worker threads, and may cancel ([`Error::Cancelled`]).
    pub fn render_with_progress(
        &self,
        camera: &Camera,
        size_px: [usize; 2],
        options: &FrameOptions,
        callback: &dyn ProgressCallback,
    ) -> Result<Frame> {
        let fixed = match options.effort {
            Effort::Named(quality) => Some(self.sampling(quality.name(), options.composite, camera, size_px[1])?),
            Effort::Fixed(sampling) => Some(sampling),
            Effort::Psnr(_) => None,
        };
        let render_options = self.render_options(size_px, options, fixed);
        render_options.validate()?;
        if self.sources().any(|volume| matches!(volume, SceneVolume::Lazy(_))) {
            let mend = "draw it with Scene::stream, which takes boxes as they are read";
            return Err(Error::out_of_range("layers of a picture in one go", "a lazy one", "in memory", mend));
        }
        self.check_colors()?;
        parallel::with_threads(options.n_threads, || self.draw(camera, options, &render_options, fixed, callback))
    }

    /// Sampling of a named quality for this scene, seen by a camera in a picture `height_px` pixels high: the finest of
    /// its layers' samplings. Projections, whose values are measured, have whole texels.
    pub fn sampling(&self, quality: &str, composite: Composite, camera: &Camera, height_px: usize) -> Result<Sampling> {
        let mut finest = Sampling::NONE;
        for SceneLayer { volume, transfer_function: tf, shading, .. } in &self.layers {
            let needs_preintegration = volume.needs_preintegration(tf, shading.as_ref())?;
            let own = Quality::sampling(quality, volume.grid(), tf, needs_preintegration, camera, height_px)?;
            finest = finest.max(own);
        }
        Ok(if composite.is_projection() { finest.with_whole_texels() } else { finest })
    }

    /// Samplings from which a picture of a wanted PSNR is chosen: for each rung the finest of the layers'.
    fn ladder(&self, camera: &Camera, height_px: usize) -> Result<Ladder> {
        let mut finest = [Sampling::NONE; LADDER.len()];
        for SceneLayer { volume, transfer_function: tf, shading, .. } in &self.layers {
            let needs_preintegration = volume.needs_preintegration(tf, shading.as_ref())?;
            let own = quality::ladder(volume.grid(), tf, needs_preintegration, camera, height_px);
            for (finest, own) in finest.iter_mut().zip(own) {
                *finest = finest.max(own);
            }
        }
        Ok(finest)
    }

    fn draw(
        &self,
        camera: &Camera,
        options: &FrameOptions,
        render_options: &RenderOptions,
        fixed: Option<Sampling>,
        callback: &dyn ProgressCallback,
    ) -> Result<Frame> {
        let now = || options.clock.map_or(0.0, |clock| clock());
        let start = now();
        let slices: Vec<_> = self.layers.iter().map(|layer| layer.volume.slices(options.kernel)).collect();
        let colors: Vec<_> = self
            .layers
            .iter()
            .map(|layer| layer.color.as_ref().map(|color| color.volume.slices(options.kernel)))
            .collect();
        let prepared = now();
        let mut times = StageTimes { prepare: prepared - start, ..StageTimes::default() };
        let frame = self.with_layers(options, &slices, &colors, |layers| {
            if let Effort::Psnr(wanted) = options.effort {
                let ladder = self.ladder(camera, render_options.height_px)?;
                let drawn_by = Mutex::new(DrawnBy::default());
                let draw = |plan: &Plan, slices: &[&Slices], callback: &dyn ProgressCallback| {
                    let (pictures, report, by) = options.device.draw_base_planes(plan, slices, callback)?;
                    *lock(&drawn_by) = by;
                    Ok((pictures, report))
                };
                let (picture, report, estimate) =
                    render_to_psnr(layers, camera, render_options, (&ladder, &wanted), &draw, callback)?;
                times.draw = now() - prepared;
                return Ok(Frame {
                    picture,
                    report,
                    drawn_by: unlocked(drawn_by),
                    sampling: estimate.sampling,
                    estimate: Some(estimate),
                    times: None,
                });
            }
            let plan = Plan::new(Level::best(), layers, camera, render_options)?;
            let planned = now();
            let (base_pictures, report, drawn_by) =
                options.device.draw_base_planes(&plan, &slices_of(layers), callback)?;
            let drawn = now();
            let picture = finish(&plan, &base_pictures);
            (times.plan, times.draw, times.warp) = (planned - prepared, drawn - planned, now() - drawn);
            let sampling = fixed.unwrap_or_else(|| sampling_of(render_options));
            Ok(Frame { picture, report, drawn_by, sampling, estimate: None, times: None })
        })?;
        match callback.progress(1.0) {
            ControlFlow::Continue(()) => Ok(Frame { times: options.clock.map(|_| times), ..frame }),
            ControlFlow::Break(()) => Err(Error::Cancelled),
        }
    }

    /// Refuses fields that colour layers where either is not in memory as samples.
    fn check_colors(&self) -> Result<()> {
        let is_in_memory = |volume: &SceneVolume| matches!(volume, SceneVolume::Samples(..));
        let mut pairs = self.layers.iter().filter_map(|layer| layer.color.as_ref().map(|color| (layer, color)));
        if pairs.any(|(layer, color)| !is_in_memory(&layer.volume) || !is_in_memory(&color.volume)) {
            let mend =
                "open the layer and the field that colours it in memory, at a coarser level where they are large";
            return Err(Error::out_of_range("layer of two fields", "read as it is drawn", "in memory", mend));
        }
        Ok(())
    }

    /// Calls `work` with the layers as they are drawn. `slices`: one per layer; `colors`: of the fields that colour
    /// layers.
    pub(crate) fn with_layers<T>(
        &self,
        options: &FrameOptions,
        slices: &[Slices<'_>],
        colors: &[Option<Slices<'_>>],
        work: impl FnOnce(&[Layer]) -> Result<T>,
    ) -> Result<T> {
        let look =
            |layer: &SceneLayer| layer.volume.look(&layer.transfer_function, options.composite, layer.shading.as_ref());
        let looks = self.layers.iter().map(look).collect::<Result<Vec<_>>>()?;
        let layers: Vec<Layer> = self
            .layers
            .iter()
            .zip(slices.iter().zip(&looks))
            .enumerate()
            .map(|(k, (layer, (slices, look)))| Layer {
                slices,
                transfer_function: look,
                shading: layer.shading.as_ref(),
                labels: self.labels.as_deref().filter(|_| k == 0),
                color: colors.get(k).and_then(Option::as_ref).zip(layer.color.as_ref()).map(|(slices, color)| {
                    ColorField { slices, transfer_function: &color.transfer_function, cache: color.volume.visibility() }
                }),
                cache: layer.volume.visibility(),
            })
            .collect();
        work(&layers)
    }

    pub(crate) fn render_options(
        &self,
        [width_px, height_px]: [usize; 2],
        options: &FrameOptions,
        fixed: Option<Sampling>,
    ) -> RenderOptions {
        let defaults = RenderOptions::default();
        let Sampling { sheets_per_slice, oversampling } = fixed.unwrap_or_else(|| sampling_of(&defaults));
        RenderOptions {
            width_px,
            height_px,
            composite: options.composite,
            shading: self.layers.iter().find_map(|layer| layer.shading.clone()),
            sheets_per_slice,
            oversampling,
            pre_integration: options.pre_integration,
            early_ray_termination: options.early_ray_termination,
            crop: self.crop.map(|crop| self.layers.first().map_or(crop, |first| first.volume.crop_on_level(crop))),
            clip_planes: self.clip_planes.clone(),
            background: self.background,
            with_depth: options.with_depth,
            depth_colors: options.depth_colors.clone(),
            shapes: self.shapes.clone(),
            n_threads: options.n_threads,
        }
    }
}

fn sampling_of(options: &RenderOptions) -> Sampling {
    Sampling { sheets_per_slice: options.sheets_per_slice, oversampling: options.oversampling }
}
