//! Schedule of a frame on the CPU: planned, drawn piece by piece, one per tile, and warped.

use std::sync::atomic::{AtomicU64, Ordering};

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Composite, Error, Picture, RenderOptions, Result, TransferFunction};

use crate::optics::visibility_cache::VisibilityCache;
use crate::picture::base_picture::{BasePicture, TileTexels};
use crate::picture::color_projection::color_projection;
use crate::picture::edges::{Edges, Scaling};
use crate::picture::warp::warp;
use crate::render::layer::Layer;
use crate::render::piece::{draw_surfaces, draw_tile};
use crate::render::plan::{FamilyPlan, Operator, Plan, brightest};
use crate::render::progress::{Progress, ProgressCallback};
use crate::render::report::Report;
use crate::render::tile::{Piece, TileJob, Work, n_tiles};
use crate::render::tile_parts::parts_for;
use crate::sheet::tile_layout::{BlockMask, TILE_U, TILE_V, TilePart};
use crate::source::slices::Slices;

/// Draws a volume.
///
/// Keep `slices` for the next picture; [`render_layers`] also takes a cache of the transfer function's tables.
pub fn render(
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    callback: &dyn ProgressCallback,
) -> Result<(Picture, Report)> {
    let (shading, cache) = (options.shading.as_ref(), VisibilityCache::default());
    let layer = Layer { slices, transfer_function: tf, shading, labels: None, color: None, cache: &cache };
    render_layers(&[layer], camera, options, callback)
}

/// Draws several volumes, with labels, and with the caches of earlier frames. Each layer has its own
/// shading; the shading of the options is not used.
pub fn render_layers(
    layers: &[Layer],
    camera: &Camera,
    options: &RenderOptions,
    callback: &dyn ProgressCallback,
) -> Result<(Picture, Report)> {
    parallel::with_threads(options.n_threads, || {
        let plan = Plan::new(Level::best(), layers, camera, options)?;
        let (base_pictures, report) = draw_base_planes(&plan, &slices_of(layers), callback)?;
        Ok((finish(&plan, &base_pictures), report))
    })
}

/// Draws the base planes, before the warp.
pub fn render_base_planes(
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    callback: &dyn ProgressCallback,
) -> Result<(Vec<BasePicture>, Report)> {
    render_base_planes_at(Level::best(), slices, tf, camera, options, callback)
}

/// Draws the base planes with the vectors of a SIMD level; all levels give the same bits.
pub fn render_base_planes_at(
    level: Level,
    slices: &Slices,
    tf: &TransferFunction,
    camera: &Camera,
    options: &RenderOptions,
    callback: &dyn ProgressCallback,
) -> Result<(Vec<BasePicture>, Report)> {
    let (shading, cache) = (options.shading.as_ref(), VisibilityCache::default());
    let layer = Layer { slices, transfer_function: tf, shading, labels: None, color: None, cache: &cache };
    parallel::with_threads(options.n_threads, || {
        draw_base_planes(&Plan::new(level, &[layer], camera, options)?, &[slices], callback)
    })
}

/// Samples of the layers, in their order, then samples of the fields that colour layers.
pub fn slices_of<'a>(layers: &[Layer<'a>]) -> Vec<&'a Slices<'a>> {
    let colors = layers.iter().filter_map(|layer| layer.color.map(|color| color.slices));
    layers.iter().map(|layer| layer.slices).chain(colors).collect()
}

/// Draws the base planes of a plan, tile by tile, each through all its sheets. `slices`: per layer.
pub fn draw_base_planes(
    plan: &Plan,
    slices: &[&Slices],
    callback: &dyn ProgressCallback,
) -> Result<(Vec<BasePicture>, Report)> {
    let mut report = Report::of(plan);
    let n_all = plan.families.iter().map(|family| n_tiles(&family.plane).iter().product::<usize>()).sum();
    let progress = Progress::new(callback, n_all);
    let mut pictures = Vec::new();
    for family in &plan.families {
        let (picture, work) = draw_base_plane(plan, family, slices, &progress)?;
        report.n_texels += work.n_texels;
        report.n_skipped_slabs += work.n_skipped;
        pictures.push(picture);
    }
    Ok((pictures, report))
}

/// Draws a base plane, tile by tile.
pub(crate) fn draw_base_plane(
    plan: &Plan,
    family: &FamilyPlan,
    slices: &[&Slices],
    progress: &Progress,
) -> Result<(BasePicture, Work)> {
    let job = TileJob::new(plan, family, slices);
    let mut picture = BasePicture::new(family.plane.clone(), plan.with_depth);
    let (n_texels, n_skipped) = (AtomicU64::new(0), AtomicU64::new(0));
    let draw = |tile: usize, blocks: BlockMask, texels: &mut TileTexels| {
        if progress.is_stopped() {
            return;
        }
        let work = draw_blocks(plan, &job, tile, blocks, texels);
        n_texels.fetch_add(work.n_texels, Ordering::Relaxed);
        n_skipped.fetch_add(work.n_skipped, Ordering::Relaxed);
    };
    match parts_for(parallel::n_threads(), || costs(&job)) {
        None => picture.fill_tiles([TILE_U, TILE_V], |tile, texels| {
            draw(tile, BlockMask::MAX, texels);
            progress.tile_done();
        }),
        Some(parts) => picture.fill_parts([TILE_U, TILE_V], &parts, |part, texels| {
            draw(part.tile, part.blocks(), texels);
            // Each tile has one part that begins with its first row.
            if part.rows.start == 0 {
                progress.tile_done();
            }
        }),
    }
    if progress.is_stopped() {
        return Err(Error::Cancelled);
    }
    Ok((picture, Work { n_texels: n_texels.into_inner(), n_skipped: n_skipped.into_inner() }))
}

/// Draws blocks of a tile, given by its number.
fn draw_blocks(plan: &Plan, job: &TileJob, tile: usize, blocks: BlockMask, texels: &mut TileTexels) -> Work {
    let [n_tiles_u, _] = n_tiles(&job.family.plane);
    let piece = Piece { blocks, ..Piece::whole([tile % n_tiles_u, tile / n_tiles_u]) };
    draw_tile(plan, job, &piece, texels)
}

/// Draws a part of a tile of a base plane. `slices`: per layer.
pub fn draw_part(plan: &Plan, family: usize, slices: &[&Slices], part: &TilePart, texels: &mut TileTexels) -> Work {
    let job = TileJob::new(plan, &plan.families[family], slices);
    draw_blocks(plan, &job, part.tile, part.blocks(), texels)
}

/// Estimated costs of the tiles of a base plane, row by row: numbers of occupied bricks below them. `slices`: per
/// layer.
pub fn tile_costs(plan: &Plan, family: usize, slices: &[&Slices]) -> Vec<usize> {
    costs(&TileJob::new(plan, &plan.families[family], slices))
}

fn costs(job: &TileJob) -> Vec<usize> {
    let [n_tiles_u, n_tiles_v] = n_tiles(&job.family.plane);
    parallel::map(n_tiles_u * n_tiles_v, |k| job.cost([k % n_tiles_u, k / n_tiles_u]))
}

/// Makes the picture from drawn base planes: warped, coloured, over the background.
pub fn finish(plan: &Plan, base_pictures: &[BasePicture]) -> Picture {
    let whole = PixelRectangle { first: [0; 2], size: plan.size_px };
    let mut picture = warped(plan, base_pictures, whole, plan.reads_per_axis, plan.with_depth);
    if plan.shapes.is_some() && plan.operator.projection().is_some() {
        put_over(plan, &mut picture);
    }
    depth_as_length(&plan.camera, &mut picture);
    picture.finish(plan.shading(), plan.background);
    picture
}

/// Share of a projection that shows through opaque surfaces of shapes. A projection counts as lying in front of shapes
/// and is mostly opaque, so at full strength it would hide them.
pub const SHOWS_THROUGH: f32 = 0.25;

/// Puts the surfaces of shapes over a projection, which shows through them.
fn put_over(plan: &Plan, picture: &mut Picture) {
    let surfaces: Vec<_> = plan.families.iter().map(|family| draw_surfaces(family, false)).collect();
    let peak = plan.shapes.as_ref().map_or(1.0, |shapes| brightest(&shapes.shading));
    let warped = warp(plan.simd, &surfaces, &plan.rays, plan.size_px, plan.reads_per_axis, peak, false, None);
    for (rgba, surface) in picture.rgba.iter_mut().zip(warped.rgba) {
        let share = 1.0 - SHOWS_THROUGH * rgba[3].clamp(0.0, 1.0);
        let left = 1.0 - share * surface[3];
        for c in 0..4 {
            rgba[c] = share * surface[c] + left * rgba[c];
        }
    }
}

/// A rectangle of pixels of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PixelRectangle {
    /// Column and row of the first pixel.
    pub first: [usize; 2],
    /// Number of columns and rows.
    pub size: [usize; 2],
}

/// Warps a rectangle of the picture from base planes that hold what it needs; depth is in parameters of the rays.
/// `reads`: per pixel along x, and the same number along y.
pub(crate) fn warped(
    plan: &Plan,
    base_pictures: &[BasePicture],
    PixelRectangle { first, size }: PixelRectangle,
    reads: usize,
    with_depth: bool,
) -> Picture {
    let scaling = match plan.operator {
        Operator::Over { .. } => Scaling::Opacity,
        Operator::Project { composite: Composite::Sum | Composite::XRay { .. }, .. } => Scaling::Sum,
        _ => Scaling::None,
    };
    let is_projection = plan.operator.projection().is_some();
    let edges = Edges { silhouette: &plan.silhouette, scaling, is_projection };
    // Shapes go on beyond the walls of volumes.
    let edges = Some(edges).filter(|_| plan.shapes.is_none());
    let rays = plan.rays.part(first);
    let warped = warp(plan.simd, base_pictures, &rays, size, reads, plan.peak, with_depth, edges);
    let [width_px, height_px] = size;
    let mut picture = Picture { width_px, height_px, rgba: warped.rgba, depth: warped.ray_parameter, value: None };
    if let Some(composite) = plan.operator.projection() {
        let layer = &plan.layers[0];
        picture.value = Some(color_projection(&mut picture.rgba, &layer.grid, &layer.transfer_function, composite));
        if let Some(colors) = &plan.depth_colors {
            colors.color(&mut picture, &plan.camera, &layer.transfer_function);
        }
    }
    picture
}

/// Converts depth from parameters of the rays to world lengths.
fn depth_as_length(camera: &Camera, picture: &mut Picture) {
    let size = [picture.width_px, picture.height_px];
    for (i, depth) in picture.depth.iter_mut().flatten().enumerate() {
        // The ray's direction has unit length along the view; its world length differs per pixel in perspective.
        let [x, y] = [i % size[0], i / size[0]].map(|px| px as f64 + 0.5);
        *depth = (f64::from(*depth) * camera.ray(x, y, size[0], size[1]).direction.length()) as f32;
    }
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
