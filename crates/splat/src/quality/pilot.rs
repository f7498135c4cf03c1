//! Pilot tiles: small parts of the picture that are drawn with several samplings and compared after the warp.
//!
//! The whole picture, drawn with the cheapest sampling, shows where something is seen, and how much contrast it has
//! there. Tiles are chosen with a probability by contrast, which is largest along the edges of the volume, cut faces
//! and silhouettes; tiles with much of all contrast are always among them. The error of the whole picture is the sum of
//! the tiles' errors, each divided by the tile's probability: a tile that is chosen one time in ten stands for ten, so
//! the sum is right on average (Horvitz & Thompson 1952). The spread among the tiles gives its uncertainty.
//!
//! A tile is a square of a base plane: with 1.5 texels a pixel, the texels that its pixels read fit into one vector, so
//! that little is drawn besides.
//!
//! Errors are mean square errors of the colours over black, peak 1, of the whole picture.

use std::collections::BTreeMap;
use std::sync::Arc;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::LANES;
use wavesplat_core::Result;

use crate::picture::base_picture::BasePicture;
use crate::picture::edges::SQUARE_PX;
use crate::quality::sampled::SampledFrame;
use crate::render::frame::{PixelRectangle, draw_base_plane, draw_base_planes, slices_of, warped};
use crate::render::plan::{FamilyPlan, Plan};
use crate::render::progress::{Progress, ProgressCallback};
use crate::render::tile::n_tiles;
use crate::shapes::fragments::Fragments;
use crate::view::base_plane::BasePlane;
use crate::view::family::{Family, IndexRays};

/// Side of a tile in texels, with [`TEXELS_PER_PIXEL`]: a vector, less the four texels that the warp's filter reads
/// around a position, and the two by which pixels reach beyond their middles.
const SIDE: f64 = LANES as f64 - 6.0;

/// Texels per pixel along each axis for which tiles are cut.
const TEXELS_PER_PIXEL: f64 = 1.5;

/// Number of tiles: this share of the tiles that show something, within limits.
const SHARE: f64 = 0.1;
const N_TILES: [usize; 2] = [24, 128];

/// Weight of a visible pixel without contrast, as a share of the mean contrast.
const CONTRAST_FLOOR: f64 = 0.5;

/// Tile of the picture, with the probability with which it was chosen.
struct Tile {
    /// Pixels whose middles lie in the tile.
    pixels: Vec<[usize; 2]>,
    /// Rectangle around them.
    around: PixelRectangle,
    family: Family,
    probability: f64,
}

/// Tiles of a picture from which the error of the whole picture is estimated.
pub(crate) struct PilotTiles {
    tiles: Vec<Tile>,
    n_pixels: usize,
    /// Number of tiles that show something.
    n_seen: usize,
}

/// Colours of the tiles' pixels with a sampling.
pub(crate) type TileColors = Vec<Vec<[f32; 4]>>;

/// Mean square error of a picture, with its relative standard deviation.
pub(crate) struct MeanSquare {
    pub mean: f64,
    pub deviation: f64,
}

impl PilotTiles {
    /// Chooses tiles by the whole picture; returns them with their colours in it, or `None` where nothing is seen.
    pub fn choose(frame: &SampledFrame, callback: &dyn ProgressCallback) -> Result<Option<(Self, TileColors)>> {
        let plan = &frame.plan;
        let (base_pictures, _) = draw_base_planes(plan, &slices_of(frame.layers), callback)?;
        let size = plan.size_px;
        let rgba = colors_of(plan, &base_pictures, PixelRectangle { first: [0; 2], size });
        let Some(weights) = weights_of(&rgba, size) else { return Ok(None) };
        // Tiles in an order in which neighbours in the list are neighbours in the picture: row by row, there and back.
        let mut all: BTreeMap<(usize, i64, i64), Vec<[usize; 2]>> = BTreeMap::new();
        for (k, weight) in weights.iter().enumerate() {
            let pixel = [k % size[0], k / size[0]];
            if let Some((family, [i, j])) = tile_of(frame, pixel).filter(|_| *weight > 0.0) {
                all.entry((family, j, if j % 2 == 0 { i } else { -i })).or_default().push(pixel);
            }
        }
        let at = |[x, y]: [usize; 2]| y * size[0] + x;
        let all: Vec<(usize, Vec<[usize; 2]>)> =
            all.into_iter().map(|((family, ..), pixels)| (family, pixels)).collect();
        let tile_weights: Vec<f64> =
            all.iter().map(|(_, pixels)| pixels.iter().map(|pixel| weights[at(*pixel)]).sum()).collect();
        let n_wanted = ((SHARE * all.len() as f64) as usize).clamp(N_TILES[0], N_TILES[1]);
        let tiles: Vec<Tile> = systematic_sample(&tile_weights, n_wanted)
            .into_iter()
            .map(|(k, probability)| {
                let (family, pixels) = (plan.families[all[k].0].plane.family, all[k].1.clone());
                Tile { around: squares_around(&pixels, size), pixels, family, probability }
            })
            .collect();
        let colors = tiles.iter().map(|tile| tile.pixels.iter().map(|pixel| rgba[at(*pixel)]).collect()).collect();
        Ok(Some((Self { tiles, n_pixels: size[0] * size[1], n_seen: all.len() }, colors)))
    }

    /// Draws the tiles with the sampling of a frame.
    pub fn draw(&self, frame: &SampledFrame, callback: &dyn ProgressCallback) -> Result<TileColors> {
        let plan = &frame.plan;
        let slices = slices_of(frame.layers);
        let windows = self.tiles.iter().map(|tile| {
            let family = plan.families.iter().find(|family| family.plane.family == tile.family)?;
            Some((family, window(&family.plane, &plan.rays, &tile.pixels)?))
        });
        let windows: Vec<Option<(&FamilyPlan, BasePlane)>> = windows.collect();
        // A window of many texels a pixel has several tiles of its base plane.
        let n_all = windows.iter().flatten().map(|(_, plane)| n_tiles(plane).iter().product::<usize>()).sum();
        let progress = Progress::new(callback, n_all);
        let draw_tile = |tile: &Tile, window: &Option<(&FamilyPlan, BasePlane)>| {
            let drawn = window.as_ref().map(|(family, plane)| {
                let fragments = family.fragments.as_ref().map(|all| Arc::new(window_of(all, &family.plane, plane)));
                let family = FamilyPlan { plane: plane.clone(), fragments, ..(*family).clone() };
                draw_base_plane(plan, &family, &slices, &progress)
            });
            let drawn = drawn.transpose()?;
            let pictures: Vec<BasePicture> = drawn.into_iter().map(|(picture, _)| picture).collect();
            let PixelRectangle { first, size } = tile.around;
            let rgba = colors_of(plan, &pictures, tile.around);
            Ok(tile.pixels.iter().map(|[x, y]| rgba[(y - first[1]) * size[0] + x - first[0]]).collect())
        };
        parallel::map(self.tiles.len(), |k| draw_tile(&self.tiles[k], &windows[k])).into_iter().collect()
    }

    /// Mean square difference of the whole picture from the colours of the tiles with two samplings.
    pub fn difference(&self, a: &TileColors, b: &TileColors) -> MeanSquare {
        let squares = a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| square(a, b)).sum::<f64>());
        let parts: Vec<(f64, f64)> =
            squares.zip(&self.tiles).map(|(sum, tile)| (sum / tile.probability, tile.probability)).collect();
        let whole: f64 = parts.iter().map(|(part, _)| part).sum();
        // Tiles that are always chosen add no uncertainty. The others are evenly spread, so that what counts is how
        // much neighbours differ (Cochran, *Sampling Techniques*, 1977, section 8.11).
        let sampled: Vec<f64> = parts.iter().filter(|(_, p)| *p < 1.0).map(|(part, _)| *part).collect();
        let n = sampled.len() as f64;
        let changes = sampled.windows(2).map(|pair| (pair[0] - pair[1]).powi(2)).sum::<f64>();
        let variance = changes / (2.0 * (n - 1.0)).max(1.0);
        let left_out = 1.0 - n / (self.n_seen - (parts.len() - sampled.len())).max(1) as f64;
        let deviation = (n * variance * left_out).sqrt() / whole.max(f64::MIN_POSITIVE);
        MeanSquare { mean: whole / self.n_pixels as f64, deviation }
    }
}

/// Surfaces of shapes on a window of a base plane.
fn window_of(all: &Fragments, plane: &BasePlane, window: &BasePlane) -> Fragments {
    let first = ((window.origin - plane.origin) / plane.step).round();
    all.window([first.x as i64, first.y as i64], window.size)
}

/// Chooses `n` of the items: each with a probability that is proportional to its weight. Items with more than the `n`th
/// part of all weight are always chosen, the others evenly spread over the cumulative weight. Returns numbers of items
/// and their probabilities.
fn systematic_sample(weights: &[f64], n: usize) -> Vec<(usize, f64)> {
    let mut is_certain = vec![false; weights.len()];
    let rest = loop {
        let left =
            || weights.iter().zip(&is_certain).filter(|(_, is_certain)| !**is_certain).map(|(weight, _)| *weight);
        let n_left = n.saturating_sub(is_certain.iter().filter(|is| **is).count());
        let (sum, n_others) = (left().sum::<f64>(), left().count());
        if n_left >= n_others {
            return (0..weights.len()).map(|k| (k, 1.0)).collect();
        }
        let is_large = |k: usize| !is_certain[k] && weights[k] * n_left as f64 >= sum;
        let large: Vec<usize> = (0..weights.len()).filter(|k| is_large(*k)).collect();
        if large.is_empty() {
            break (n_left, sum);
        }
        for k in large {
            is_certain[k] = true;
        }
    };
    let (n_left, sum) = rest;
    let mut chosen = Vec::new();
    let (mut before, mut n_passed) = (0.0, 0.5);
    for (k, weight) in weights.iter().enumerate() {
        if is_certain[k] {
            chosen.push((k, 1.0));
            continue;
        }
        before += weight * n_left as f64 / sum;
        if before >= n_passed {
            n_passed += 1.0;
            chosen.push((k, weight * n_left as f64 / sum));
        }
    }
    chosen
}

/// Colours of a rectangle of pixels as the picture shows them, before the background.
fn colors_of(plan: &Plan, base_pictures: &[BasePicture], pixels: PixelRectangle) -> Vec<[f32; 4]> {
    let mut picture = warped(plan, base_pictures, pixels, plan.reads_per_axis, false);
    picture.finish(plan.shading(), None);
    picture.rgba
}

/// The tile of a pixel: the number of its base plane, and its place there; `None` beyond all base planes, and where
/// a pixel reads two base planes, since a tile lies on one.
fn tile_of(frame: &SampledFrame, [x, y]: [usize; 2]) -> Option<(usize, [i64; 2])> {
    let rays = &frame.plan.rays;
    let [x, y] = [x as f64, y as f64];
    let corners = [[x, y], [x + 1.0, y], [x, y + 1.0], [x + 1.0, y + 1.0]];
    let [family, others @ ..] = corners.map(|[x, y]| Family::of(rays.direction(x, y)));
    if others.iter().any(|other| *other != family) {
        return None;
    }
    let [x, y] = [x + 0.5, y + 0.5];
    let number = frame.plan.families.iter().position(|other| other.plane.family == family)?;
    let texel = frame.plan.families[number].plane.texel_from_pixel(rays, x, y);
    let side = SIDE * frame.options.oversampling / TEXELS_PER_PIXEL;
    Some((number, [texel.x, texel.y].map(|at| (at / side).floor() as i64)))
}

/// The smallest rectangle around pixels that is made of squares in which the warp looks for walls: in others it finds
/// other ones.
fn squares_around(pixels: &[[usize; 2]], size_px: [usize; 2]) -> PixelRectangle {
    let first = pixels.iter().copied().reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])]).unwrap_or_default();
    let last = pixels.iter().copied().reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])]).unwrap_or_default();
    let first = first.map(|at| at / SQUARE_PX * SQUARE_PX);
    let end = [0, 1].map(|axis| ((last[axis] / SQUARE_PX + 1) * SQUARE_PX).min(size_px[axis]));
    PixelRectangle { first, size: [0, 1].map(|axis| end[axis] - first[axis]) }
}

/// The part of a base plane that some of its pixels read; `None` where it has none of these texels.
fn window(plane: &BasePlane, rays: &IndexRays, pixels: &[[usize; 2]]) -> Option<BasePlane> {
    let corners = pixels.iter().flat_map(|[x, y]| [[*x, *y], [x + 1, *y], [*x, y + 1], [x + 1, y + 1]]);
    let read = corners.map(|[x, y]| plane.texel_from_pixel(rays, x as f64, y as f64));
    let bounds = read.filter(|texel| texel.is_finite()).map(|texel| (texel, texel));
    let (lo, hi) = bounds.reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))?;
    // The cubic reads from a texel before to two after. Nothing is shown far beyond the base plane.
    let bound = |at: f64, axis: usize| at.clamp(-MARGIN_TEXELS, plane.size[axis] as f64 + MARGIN_TEXELS) as i64;
    let first = [0, 1].map(|axis| bound(lo[axis].floor() - 1.0, axis));
    let last = [0, 1].map(|axis| bound(hi[axis].floor() + 2.0, axis));
    Some(plane.window(first, [0, 1].map(|axis| (last[axis] - first[axis]) as usize + 1)))
}

/// Texels beyond a base plane that a part of it may have.
const MARGIN_TEXELS: f64 = 4.0;

/// Weights of the pixels: their contrast to neighbours and a floor, zero where nothing is seen; `None` where nothing is
/// seen anywhere.
fn weights_of(rgba: &[[f32; 4]], size: [usize; 2]) -> Option<Vec<f64>> {
    let at = |x: usize, y: usize| &rgba[y.min(size[1] - 1) * size[0] + x.min(size[0] - 1)];
    let contrast = |k: usize| {
        let (x, y) = (k % size[0], k / size[0]);
        let around = [[x + 1, y], [x, y + 1], [x.saturating_sub(1), y], [x, y.saturating_sub(1)]];
        around.iter().map(|[i, j]| square(at(x, y), at(*i, *j))).sum::<f64>()
    };
    let mut weights: Vec<f64> = (0..rgba.len()).map(contrast).collect();
    let is_seen: Vec<bool> = weights.iter().zip(rgba).map(|(weight, rgba)| *weight > 0.0 || rgba[3] > 0.0).collect();
    let n_seen = is_seen.iter().filter(|seen| **seen).count();
    let flat = CONTRAST_FLOOR * weights.iter().sum::<f64>() / n_seen.max(1) as f64 + f64::MIN_POSITIVE.sqrt();
    for (weight, is_seen) in weights.iter_mut().zip(&is_seen) {
        *weight += if *is_seen { flat } else { 0.0 };
    }
    (n_seen > 0).then_some(weights)
}

/// Mean square difference of two colours over black.
fn square(a: &[f32; 4], b: &[f32; 4]) -> f64 {
    f64::from((0..3).map(|c| (a[c].clamp(0.0, 1.0) - b[c].clamp(0.0, 1.0)).powi(2)).sum::<f32>() / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use wavesplat_core::{Composite, Kernel, Projection, RenderOptions, Shading};
    use wavesplat_testkit::{Phantom, camera_towards, opacity_ramp};

    use crate::optics::visibility_cache::VisibilityCache;
    use crate::quality::ladder::Sampling;
    use crate::render::frame::render_layers;
    use crate::render::layer::Layer;
    use crate::source::slices::Slices;

    #[test]
    fn tiles_are_parts_of_the_picture() {
        let phantom = Phantom::ripples(24);
        let volume = phantom.volume();
        let slices = Slices::new(&volume, Kernel::Linear);
        let tf = opacity_ramp(&[(100.0, 0.0), (180.0, 0.3)], None);
        let (shading, cache) = (Shading::default(), VisibilityCache::default());
        let layers = [Layer {
            slices: &slices,
            transfer_function: &tf,
            shading: Some(&shading),
            labels: None,
            color: None,
            cache: &cache,
        }];
        for (projection, distance, towards, composite) in [
            (Projection::Orthographic { parallel_scale: 17.0 }, 90.0, DVec3::new(0.7, 0.6, 0.5), Composite::Over),
            (Projection::Orthographic { parallel_scale: 17.0 }, 90.0, DVec3::X, Composite::Over),
            (Projection::Orthographic { parallel_scale: 17.0 }, 90.0, DVec3::new(0.7, 0.6, 0.5), Composite::Maximum),
            (Projection::Perspective { view_angle_rad: 1.2 }, 14.0, DVec3::new(0.7, 0.6, 0.65), Composite::Over),
        ] {
            let camera = camera_towards(phantom.centre(), towards, distance, projection);
            let options = RenderOptions { width_px: 90, height_px: 75, composite, ..RenderOptions::default() };
            let at = |sheets_per_slice, oversampling| Sampling { sheets_per_slice, oversampling };
            let frame = SampledFrame::new(&layers, &camera, &options, at(1.0, 0.5)).unwrap();
            let (tiles, _) = PilotTiles::choose(&frame, &()).unwrap().unwrap();
            for (sheets_per_slice, oversampling) in [(1.0, 0.5), (2.0, 1.0), (4.0, 1.5), (6.0, 3.0)] {
                let options = RenderOptions { sheets_per_slice, oversampling, ..options.clone() };
                let drawn = tiles.draw(&frame.with_options(options.clone()).unwrap(), &()).unwrap();
                let (picture, _) = render_layers(&layers, &camera, &options, &()).unwrap();
                for (tile, colors) in tiles.tiles.iter().zip(&drawn) {
                    let of_whole = tile.pixels.iter().map(|[x, y]| &picture.rgba[y * 90 + x]);
                    let off: f64 = of_whole.zip(colors).map(|(a, b)| square(a, b)).sum();
                    // Walls are looked for in larger rectangles of the whole picture, where few pixels differ a little.
                    assert!(
                        off < 5e-5 * colors.len() as f64,
                        "{composite:?} {projection:?}, {oversampling}, {:?}: {off}",
                        tile.around
                    );
                }
            }
        }
    }

    #[test]
    fn items_are_chosen_as_often_as_their_weights_say() {
        let weights = [1.0, 3.0, 200.0, 2.0, 1.0, 1.0, 4.0, 1.0, 3.0, 2.0];
        let chosen = systematic_sample(&weights, 4);
        assert_eq!(chosen.len(), 4);
        assert!(chosen.contains(&(2, 1.0)), "most of the weight is always chosen: {chosen:?}");
        for (k, probability) in &chosen {
            assert!(*k == 2 || (probability - 3.0 * weights[*k] / 18.0).abs() < 1e-12, "{chosen:?}");
        }
        assert_eq!(systematic_sample(&weights, 12).len(), 10, "all of them");
    }
}
