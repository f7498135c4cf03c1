//! The whole way from volume to picture: the one place that knows the order of the stages.

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Picture, RenderOptions, Result, TransferFunction};

use crate::optics::visibility_cache::VisibilityCache;
use crate::picture::base_picture::BasePicture;
use crate::picture::color_projection::color_projection;
use crate::picture::supersampling::reads_per_axis;
use crate::picture::warp::warp;
use crate::render::layer::Layer;
use crate::render::progress::{Progress, ProgressCallback};
use crate::render::report::Report;
use crate::render::scene::{Scene, brightest, with_scene};
use crate::render::tile::Piece;
use crate::source::slices::Slices;
use crate::view::base_plane::{BasePlane, base_planes};
use crate::view::family::IndexRays;

/// Draws a volume.
///
/// `slices` are those of the options' kernel; keep them for the next picture.
pub fn render(
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    monitor: &dyn ProgressCallback,
) -> Result<(Picture, Report)> {
    let layer = Layer { slices, transfer_function: tf, labels: None, cache: &VisibilityCache::default() };
    render_layer(&layer, camera, options, monitor)
}

/// As [`render`], with labels, and with what was kept of frames before.
pub fn render_layer(
    layer: &Layer,
    camera: &Camera,
    options: &RenderOptions,
    monitor: &dyn ProgressCallback,
) -> Result<(Picture, Report)> {
    parallel::with_threads(options.n_threads, || {
        with_scene(Level::best(), layer, camera, options, |scene| {
            let (picture, report) = drawn(scene, monitor)?;
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
    monitor: &dyn ProgressCallback,
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
    monitor: &dyn ProgressCallback,
) -> Result<(Vec<BasePicture>, Report)> {
    let layer = Layer { slices, transfer_function: tf, labels: None, cache: &VisibilityCache::default() };
    parallel::with_threads(options.n_threads, || {
        with_scene(level, &layer, camera, options, |scene| draw(scene, monitor))
    })
}

/// Draws the base planes.
pub(crate) fn draw(scene: &Scene, monitor: &dyn ProgressCallback) -> Result<(Vec<BasePicture>, Report)> {
    let options = scene.options;
    let planes = planes(scene)?;
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

/// The base planes, not drawn yet.
pub(crate) fn planes(scene: &Scene) -> Result<Vec<BasePlane>> {
    let options = scene.options;
    let size = [options.width_px, options.height_px];
    base_planes(scene.camera, &rays(scene), size, options.oversampling, scene.region.bounds)
}

/// The picture before it is [`finished`].
pub(crate) fn drawn(scene: &Scene, monitor: &dyn ProgressCallback) -> Result<(Picture, Report)> {
    let (base_pictures, report) = draw(scene, monitor)?;
    let options = scene.options;
    let whole = PixelRectangle { first: [0, 0], size: [options.width_px, options.height_px] };
    let reads = reads_per_axis(options.composite, options.oversampling);
    Ok((warped(scene, &base_pictures, whole, reads, options.with_depth), report))
}

/// The rays of the whole picture.
pub(crate) fn rays(scene: &Scene) -> IndexRays {
    let options = scene.options;
    IndexRays::new(scene.camera, scene.grid.index_from_world(), options.width_px, options.height_px)
}

/// Pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PixelRectangle {
    /// Column and row of the first.
    pub first: [usize; 2],
    /// Columns and rows.
    pub size: [usize; 2],
}

/// A rectangle of the picture, of base planes that hold what it needs; depth as parameters of the rays. `reads`: of a pixel
/// along x, and as many along y.
pub(crate) fn warped(
    scene: &Scene,
    base_pictures: &[BasePicture],
    PixelRectangle { first, size }: PixelRectangle,
    reads: usize,
    with_depth: bool,
) -> Picture {
    let options = scene.options;
    let is_projection = options.composite.is_projection();
    let peak = if is_projection { f32::MAX } else { options.shading.as_ref().map_or(1.0, brightest) };
    let rays = rays(scene).part(first);
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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use wavesplat_core::{Kernel, Projection};
    use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

    #[test]
    fn twice_the_texels_smooth_edges() {
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
        let [as_many, twice] = [1.0, 2.0].map(|oversampling| error(&draw(oversampling)));
        assert!(twice < 0.3 * as_many, "{twice} {as_many}");
    }
}
