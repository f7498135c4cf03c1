//! The whole way from volume to picture: the one place that knows the order of the stages.

use std::ops::{ControlFlow, Range};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Composite, Grid, Picture, RenderOptions, Result, TransferFunction};

use crate::base_picture::BasePicture;
use crate::base_plane::base_planes;
use crate::family::IndexRays;
use crate::labels::Labels;
use crate::parts::Parts;
use crate::reads::Reads;
use crate::scene::{Scene, brightest, with_scene};
use crate::slices::Slices;
use crate::tile::Piece;
use crate::warp::warp;

/// Told about progress from worker threads; may stop the work.
pub trait Monitor: Sync {
    /// `fraction` of the work that is done, `0..=1`. `Break` stops; the result is then
    /// [`wavesplat_core::Error::Cancelled`].
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

impl Report {
    /// With the work of a finer picture of the same; base planes and sheets are those of that.
    #[must_use]
    pub(crate) fn and(self, finer: Self) -> Self {
        let n_texels = self.n_texels + finer.n_texels;
        Self { n_texels, n_skipped_sheets: self.n_skipped_sheets + finer.n_skipped_sheets, ..finer }
    }
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
    parallel::with_threads(options.n_threads, || {
        with_scene(Level::best(), (slices, labels), tf, camera, options, |scene| {
            let (picture, report) = drawn(scene, None, monitor)?;
            Ok((finished(camera, options, picture), report))
        })
    })
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
    parallel::with_threads(options.n_threads, || {
        with_scene(level, (slices, None), tf, camera, options, |scene| draw(scene, None, monitor))
    })
}

/// Draws the base planes of the whole picture, or of parts of it.
pub(crate) fn draw(
    scene: &Scene,
    parts: Option<&Arc<Parts>>,
    monitor: &dyn Monitor,
) -> Result<(Vec<BasePicture>, Report)> {
    let options = scene.options;
    let size = [options.width_px, options.height_px];
    let mut planes = base_planes(scene.camera, &rays(scene), size, options.oversampling, scene.region.bounds)?;
    for plane in &mut planes {
        plane.parts = parts.cloned();
    }
    let mut report = Report {
        n_nonfinite_samples: scene.grid.statistics().n_nonfinite,
        n_base_planes: planes.len(),
        n_threads: parallel::n_threads(),
        simd: scene.level.name(),
        ..Report::default()
    };
    let pieces: Vec<Vec<Piece>> = planes.iter().map(Piece::all).collect();
    let progress = Progress::new(monitor, pieces.iter().map(Vec::len).sum());
    let mut pictures = Vec::new();
    for (plane, pieces) in planes.iter().zip(&pieces) {
        let (picture, work, n_sheets) = scene.draw_plane(plane, options.sheets_per_slice, pieces, &progress)?;
        report.n_texels += work.n_texels;
        report.n_skipped_sheets += work.n_skipped;
        report.n_sheets.push(n_sheets);
        report.n_base_texels += plane.size.iter().product::<usize>() as u64;
        pictures.push(picture);
    }
    Ok((pictures, report))
}

/// The picture, or parts of it, before it is [`finished`].
pub(crate) fn drawn(scene: &Scene, parts: Option<&Arc<Parts>>, monitor: &dyn Monitor) -> Result<(Picture, Report)> {
    let (base_pictures, report) = draw(scene, parts, monitor)?;
    Ok((warped(scene, &base_pictures, scene.options.with_depth), report))
}

/// The rays of the whole picture.
fn rays(scene: &Scene) -> IndexRays {
    let options = scene.options;
    IndexRays::new(scene.camera, scene.grid.index_from_world(), options.width_px, options.height_px)
}

/// The whole picture; depth as parameters of the rays.
pub(crate) fn warped(scene: &Scene, base_pictures: &[BasePicture], with_depth: bool) -> Picture {
    let options = scene.options;
    warped_rows(scene, base_pictures, 0..options.height_px, options.oversampling, with_depth)
}

/// Some rows of the picture, of base planes of so many texels per pixel.
pub(crate) fn warped_rows(
    scene: &Scene,
    base_pictures: &[BasePicture],
    rows: Range<usize>,
    oversampling: f64,
    with_depth: bool,
) -> Picture {
    let options = scene.options;
    let size = [options.width_px, rows.len()];
    let is_projection = options.composite.is_projection();
    let reads = Reads::of_texels(options.composite, oversampling);
    let peak = if is_projection { f32::MAX } else { options.shading.as_ref().map_or(1.0, brightest) };
    let rays = rays(scene).part([0, rows.start]);
    let warped = warp(scene.level, base_pictures, &rays, size, reads, peak, with_depth);
    let [width_px, height_px] = size;
    let mut picture = Picture { width_px, height_px, rgba: warped.rgba, depth: warped.ray_parameter, value: None };
    if is_projection {
        picture.value = Some(color_projection(&mut picture.rgba, scene.grid, scene.tf, options.composite));
    }
    picture
}

/// The whole picture with depth as a length and the background behind it.
pub(crate) fn finished(camera: &Camera, options: &RenderOptions, mut picture: Picture) -> Picture {
    let size = [picture.width_px, picture.height_px];
    for (i, depth) in picture.depth.iter_mut().flatten().enumerate() {
        // The ray's direction has unit length along the view; its world length differs per pixel in perspective.
        let [x, y] = [i % size[0], i / size[0]].map(|px| px as f64 + 0.5);
        *depth = (f64::from(*depth) * camera.ray(x, y, size[0], size[1]).direction.length()) as f32;
    }
    if let Some(background) = options.background {
        picture.over_background(background);
    }
    picture
}

/// Turns density and coverage into values and colours: one look-up per pixel, after the warp.
pub(crate) fn color_projection(
    rgba: &mut [[f32; 4]],
    grid: &Grid,
    tf: &TransferFunction,
    composite: Composite,
) -> Vec<f32> {
    let (offset, scale) = grid.density_from_sample();
    let mut color = |pixel: &mut [f32; 4]| {
        let coverage = f64::from(pixel[3]);
        if coverage <= 0.0 {
            *pixel = [0.0; 4];
            return f32::NAN;
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
        *pixel = [r * opacity, g * opacity, b * opacity, opacity].map(|c| c as f32);
        value as f32
    };
    rgba.iter_mut().map(&mut color).collect()
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use wavesplat_core::{Kernel, Projection};
    use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

    #[test]
    fn edges_are_smoother_with_few_texels_more_than_pixels() {
        let phantom = Phantom::ripples(24);
        let volume = phantom.volume();
        let slices = Slices::new(&volume, Kernel::Linear);
        let hard = opacity_ramp(&[(127.0, 0.0), (128.0, 1.0)], None);
        let projection = Projection::Orthographic { parallel_scale: 17.0 };
        let camera = camera_towards(phantom.centre(), DVec3::new(0.7, 0.6, 0.5), 60.0, projection);
        let plain = RenderOptions { width_px: 150, height_px: 140, ..RenderOptions::default() };
        let draw = |oversampling: f64| {
            let options = RenderOptions { sheets_per_slice: 8.0, oversampling, ..plain.clone() };
            render(&slices, &hard, &camera, &options, &()).unwrap().0.rgba
        };
        let many = draw(6.0);
        let error = |rgba: &[[f32; 4]]| {
            let squares = rgba.as_flattened().iter().zip(many.as_flattened()).map(|(a, b)| (a - b).powi(2));
            f64::from(squares.sum::<f32>())
        };
        let [as_many, few_more, many_more] = [1.0, 1.1, 2.0].map(|oversampling| error(&draw(oversampling)));
        // More than texels that are closer by 1.1 would do alone.
        assert!(few_more < 0.7 * as_many, "{few_more} {as_many}");
        assert!(many_more < 0.5 * few_more, "{many_more} {few_more}");

        // Two reads for each pixel leave hardly more than four do.
        let options = RenderOptions { sheets_per_slice: 8.0, oversampling: 1.1, ..plain };
        let (pictures, _) = render_base_planes(&slices, &hard, &camera, &options, &()).unwrap();
        let rays = IndexRays::new(&camera, slices.grid().index_from_world(), 150, 140);
        let read = |reads| error(&warp(Level::best(), &pictures, &rays, [150, 140], reads, 1.0, false).rgba);
        let [corners_too, four] = [Reads::Quincunx, Reads::Grid(2)].map(read);
        assert!(corners_too < 1.05 * four, "{corners_too} {four}");
    }
}
