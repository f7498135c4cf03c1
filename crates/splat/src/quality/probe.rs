//! A-posteriori error estimate: pilot tiles drawn with several samplings, compared after the warp.
//!
//! The error of a picture is the sum of that along the rays, from the sheets, and that across them, from the texels and
//! from pixels that are means of few reads. Both are measured on a few tiles of this very picture: with half the sheets
//! and with three times the sheets, and with subsets of the texels of a tile that has twice the texels along each axis.
//! Pixels are compared, not texels.
//!
//! The places of the tiles are chosen by a coarse overview of the picture, with a probability by local contrast, and
//! the error of the whole picture is a ratio estimate: squares of errors per contrast, times the contrast of the
//! picture (Cochran, *Sampling Techniques*, 1977, ch. 6). The spread among the tiles gives the uncertainty of the
//! estimate.
//!
//! Errors are mean square errors of the colours over black, peak 1, of the whole picture.

use wavesplat_compute::parallel;
use wavesplat_core::{RenderOptions, Result};

use crate::picture::base_picture::BasePicture;
use crate::picture::supersampling::reads_per_axis;
use crate::quality::error_model::{Errors, Sampling};
use crate::quality::sampled::SampledFrame;
use crate::render::frame::{PixelRectangle, draw_base_plane, draw_base_planes, finish, slices_of, warped};
use crate::render::progress::{Progress, ProgressCallback};
use crate::sheet::tile_layout::{TILE_U, TILE_V};
use crate::view::base_plane::BasePlane;
use crate::view::family::{Family, IndexRays};

/// Texels of a pilot tile, along u and v, at twice the oversampling that is measured: whole tiles of a base plane. The
/// wider a tile, the smaller the share of its margin.
const TILE: [usize; 2] = [TILE_U, 2 * TILE_V];

/// Share of the picture's work that the pilot tiles take, approximately; and least and largest number of tiles.
const BUDGET: f64 = 0.2;
const N_TILES: [usize; 2] = [12, 48];

/// Sheets of the stand-in for the converged picture, as a multiple of those that are measured.
const FINER_SHEETS: f64 = 3.0;

/// Least side of a cell of the overview in pixels, and maximum number of cells along the longer side.
const MIN_CELL_PX: usize = 4;
const MAX_CELLS: usize = 128;

/// Weight of a visible cell without contrast, as a share of the mean contrast.
const CONTRAST_FLOOR: f64 = 0.2;

/// Generators of the *R2 sequence* (Roberts 2018): the fractional parts of their multiples fill a square evenly.
const PLASTIC: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];

/// Overview of a picture: where something is seen, and how much contrast it has there.
pub(crate) struct Overview {
    cell_px: usize,
    /// Cells along x and y.
    n: [usize; 2],
    /// Weight per cell, row by row: its contrast and a floor; zero where nothing is seen.
    weights: Vec<f64>,
}

impl Overview {
    /// Draws the overview; `None` where nothing is seen.
    pub fn draw(frame: &SampledFrame, callback: &dyn ProgressCallback) -> Result<Option<Self>> {
        let size = [frame.options.width_px, frame.options.height_px];
        let [smaller, larger] = [size[0].min(size[1]), size[0].max(size[1])];
        let cell_px = if smaller < 8 * MIN_CELL_PX { 1 } else { larger.div_ceil(MAX_CELLS).max(MIN_CELL_PX) };
        let n = size.map(|px| px.div_ceil(cell_px));
        let sheets_per_slice = frame.options.sheets_per_slice.min(1.0);
        let options = RenderOptions {
            width_px: n[0],
            height_px: n[1],
            sheets_per_slice,
            oversampling: 1.0,
            with_depth: false,
            ..frame.options.clone()
        };
        let overview = frame.with_options(options)?;
        let (base_pictures, _) = draw_base_planes(&overview.plan, &slices_of(overview.layers), callback)?;
        let picture = finish(&overview.plan, &base_pictures);
        let at = |x: usize, y: usize| picture.rgba[y.min(n[1] - 1) * n[0] + x.min(n[0] - 1)];
        let contrast = |x: usize, y: usize| {
            let around = [[x + 1, y], [x, y + 1], [x.saturating_sub(1), y], [x, y.saturating_sub(1)]];
            around.iter().map(|[i, j]| f64::from(difference(&at(x, y), &at(*i, *j)))).sum::<f64>()
        };
        let mut weights: Vec<f64> = (0..n[0] * n[1]).map(|k| contrast(k % n[0], k / n[0])).collect();
        let is_seen: Vec<bool> = weights.iter().zip(&picture.rgba).map(|(w, rgba)| *w > 0.0 || rgba[3] > 0.0).collect();
        let n_seen = is_seen.iter().filter(|seen| **seen).count();
        let flat = CONTRAST_FLOOR * weights.iter().sum::<f64>() / n_seen.max(1) as f64 + f64::MIN_POSITIVE.sqrt();
        for (weight, is_seen) in weights.iter_mut().zip(&is_seen) {
            *weight += if *is_seen { flat } else { 0.0 };
        }
        Ok((n_seen > 0).then_some(Self { cell_px, n, weights }))
    }

    /// Number of pixels that show something.
    fn n_seen_px(&self) -> f64 {
        let n_seen = self.weights.iter().filter(|weight| **weight > 0.0).count();
        (n_seen * self.cell_px * self.cell_px) as f64
    }

    /// Weight of the cell of a pixel.
    fn weight(&self, [x, y]: [usize; 2]) -> f64 {
        self.weights[y / self.cell_px * self.n[0] + x / self.cell_px]
    }

    /// Mean weight of all cells.
    fn mean_weight(&self) -> f64 {
        self.weights.iter().sum::<f64>() / self.weights.len() as f64
    }

    /// Chooses `n` pixels, evenly spread over the cumulative weight of the cells, row by row, there and back. They lie
    /// anywhere in their cells, so that an edge along the cells is met as often as any other.
    fn choose(&self, n: usize) -> Vec<[usize; 2]> {
        let [n_x, n_y] = self.n;
        let cells = (0..n_y).flat_map(|y| (0..n_x).map(move |x| [if y % 2 == 0 { x } else { n_x - 1 - x }, y]));
        let sum: f64 = self.weights.iter().sum();
        let mut chosen = Vec::new();
        let mut before = 0.0;
        for [x, y] in cells {
            before += self.weights[y * n_x + x];
            while chosen.len() < n && (chosen.len() as f64 + 0.5) * sum <= before * n as f64 {
                let within = PLASTIC.map(|number| (chosen.len() as f64 * number).fract());
                chosen.push([0, 1].map(|axis| ((([x, y][axis] as f64) + within[axis]) * self.cell_px as f64) as usize));
            }
        }
        chosen
    }
}

/// Squared errors of a tile, divided by the sum of its weights.
#[derive(Clone, Copy, Debug)]
struct TileErrors {
    /// Errors along the rays, laid out as [`Errors::along`].
    along: [[f64; 2]; 2],
    /// Errors across the rays, laid out as [`Errors::across`].
    across: [f64; 3],
}

/// Measures the errors of a picture with a sampling and with coarser ones; `None` where the tiles show nothing.
pub(crate) fn errors(
    frame: &SampledFrame,
    overview: &Overview,
    at: Sampling,
    callback: &dyn ProgressCallback,
) -> Result<Option<Errors>> {
    let Sampling { sheets_per_slice, oversampling } = at;
    let options = [0.5, 1.0, FINER_SHEETS].map(|times| RenderOptions {
        sheets_per_slice: times * sheets_per_slice,
        oversampling,
        with_depth: false,
        ..frame.options.clone()
    });
    let [half, own, finer] = options;
    let frames = [frame.with_options(half)?, frame.with_options(own)?, frame.with_options(finer)?];
    let planes: Vec<&BasePlane> = frames[1].plan.families.iter().map(|family| &family.plane).collect();
    let rays = &frame.plan.rays;
    let n_fine = (TILE[0] * TILE[1]) as f64;
    let per_tile = n_fine * (0.5 + 0.25 * (0.5 + 1.0 + FINER_SHEETS));
    let of_picture = overview.n_seen_px() * oversampling.powi(2);
    let n = ((BUDGET * of_picture / per_tile) as usize).clamp(N_TILES[0], N_TILES[1]);
    let tiles: Vec<PilotTile> =
        overview.choose(n).into_iter().filter_map(|px| PilotTile::around(px, frame, &planes, rays)).collect();
    // Each draws two tiles of fine texels, and one tile of coarser ones twice.
    let progress = Progress::new(callback, 4 * tiles.len());
    let measured = parallel::map(tiles.len(), |k| tiles[k].measure(&frames, overview, &progress));
    let per_weight: Vec<TileErrors> = measured.into_iter().collect::<Result<Vec<_>>>()?.into_iter().flatten().collect();
    Ok((!per_weight.is_empty()).then(|| summary(&per_weight, overview.mean_weight())))
}

/// Pilot tile: a part of a base plane, and the pixels that it serves.
struct PilotTile {
    /// The part, with twice the measured texels along each axis.
    plane: BasePlane,
    pixels: PixelRectangle,
    /// Per pixel of the rectangle, row by row: do its reads lie within the tile at every level?
    is_served: Vec<bool>,
}

/// Distance in texels that a read must keep from the edge of a tile: what the cubic needs around it.
const READ_TEXELS: f64 = 1.01;

impl PilotTile {
    /// Tile around a pixel; `None` where the pixel is beyond all base planes, or the tile serves no pixel as a whole.
    fn around([x, y]: [usize; 2], frame: &SampledFrame, planes: &[&BasePlane], rays: &IndexRays) -> Option<Self> {
        let [x, y] = [x.min(frame.options.width_px - 1), y.min(frame.options.height_px - 1)];
        let middle = [x, y].map(|px| px as f64 + 0.5);
        let family = Family::of(rays.direction(middle[0], middle[1]));
        let plane = planes.iter().find(|plane| plane.family == family)?;
        let center = plane.texel_from_pixel(rays, middle[0], middle[1]);
        // The tile begins a multiple of 12 of its texels from the first pixel's: every second, third and fourth texel
        // are then those that the picture would have, and lie to the pixels as they do there.
        let first_px = plane.texel_from_pixel(rays, 0.5, 0.5);
        let anchor = if first_px.is_finite() { first_px.round() } else { glam::DVec2::ZERO };
        let first = [0, 1].map(|axis| {
            let first = center[axis] - (TILE[axis] / 4) as f64;
            (anchor[axis] + 6.0 * ((first - anchor[axis]) / 6.0).round()) as i64
        });
        let plane = plane.window(first, 2, 4, TILE);
        // A box around the pixels that the tile can serve: at most as many as it has texels.
        let reach = TILE[0].max(TILE[1]);
        let columns = x.saturating_sub(reach)..(x + reach).min(frame.options.width_px);
        let rows = y.saturating_sub(reach)..(y + reach).min(frame.options.height_px);
        // The coarsest level has every fourth texel.
        let inside = |[x, y]: [f64; 2]| {
            let at = plane.texel_from_pixel(rays, x, y) / 4.0;
            let is_in = |axis: usize| (READ_TEXELS..=(TILE[axis] / 4) as f64 - 1.0 - READ_TEXELS).contains(&at[axis]);
            Family::of(rays.direction(x, y)) == family && is_in(0) && is_in(1)
        };
        let served = |x: usize, y: usize| {
            let [x, y] = [x as f64, y as f64];
            [[x, y], [x + 1.0, y], [x, y + 1.0], [x + 1.0, y + 1.0]].into_iter().all(inside)
        };
        let all: Vec<[usize; 2]> =
            rows.flat_map(|y| columns.clone().map(move |x| [x, y])).filter(|[x, y]| served(*x, *y)).collect();
        let lo = all.iter().copied().reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])])?;
        let hi = all.iter().copied().reduce(|a, b| [a[0].max(b[0]), a[1].max(b[1])])?;
        let size = [hi[0] - lo[0] + 1, hi[1] - lo[1] + 1];
        let mut is_served = vec![false; size[0] * size[1]];
        for [x, y] in all {
            is_served[(y - lo[1]) * size[0] + x - lo[0]] = true;
        }
        Some(Self { plane, pixels: PixelRectangle { first: lo, size }, is_served })
    }

    /// Measures the squared errors of the tile, divided by its weights in the overview; `None` where these are 0.
    /// `frames`: with half the measured sheets, with all of them, and with more.
    fn measure(
        &self,
        frames: &[SampledFrame; 3],
        overview: &Overview,
        progress: &Progress,
    ) -> Result<Option<TileErrors>> {
        let draw = |plane: &BasePlane, frame: &SampledFrame| {
            let family = frame.plan.family(plane.clone(), frame.layers);
            Ok(draw_base_plane(&frame.plan, &family, &slices_of(frame.layers), progress)?.0)
        };
        let [half, own, finer] = frames;
        let coarser = self.plane.every(2, 0);
        // One sheet per slice is enough across the rays.
        let fine_has_half = half.options.sheets_per_slice >= 1.0;
        let fine = draw(&self.plane, if fine_has_half { half } else { own })?;
        let other = draw(&coarser, if fine_has_half { own } else { half })?;
        let finer = draw(&coarser, finer)?;
        let every = [2, 3, 4].map(|k| fine.every(k, 0));
        let (half, own) = if fine_has_half { (&every[0], &other) } else { (&other, &every[0]) };
        let frame = &frames[1];
        let composite = frame.options.composite;
        let oversampling = frame.options.oversampling;
        let read = |picture: &BasePicture, reads: usize| {
            warped(&frame.plan, std::slice::from_ref(picture), self.pixels, reads, false).rgba
        };
        let weights: f64 = self.served().map(|(_, pixel)| overview.weight(pixel)).sum();
        let mean_square = |a: &[[f32; 4]], b: &[[f32; 4]]| {
            self.served().map(|(k, _)| f64::from(difference(&a[k], &b[k]))).sum::<f64>() / weights
        };
        let along = [1, reads_per_axis(composite, oversampling)].map(|reads| {
            let converged = read(&finer, reads);
            [half, own].map(|picture| mean_square(&read(picture, reads), &converged))
        });
        let converged = read(&fine, reads_per_axis(composite, 2.0 * oversampling));
        let across = [4, 3, 2].map(|k| {
            let reads = reads_per_axis(composite, 2.0 * oversampling / k as f64);
            mean_square(&read(&every[k - 2], reads), &converged)
        });
        let along = [0, 1].map(|level| [along[0][level], along[1][level]]);
        Ok((weights > 0.0).then_some(TileErrors { along, across }))
    }

    /// Pixels that the tile serves: their number in its rectangle, and their place in the picture.
    fn served(&self) -> impl Iterator<Item = (usize, [usize; 2])> {
        let PixelRectangle { first, size } = self.pixels;
        let served = self.is_served.iter().enumerate().filter(|(_, is_served)| **is_served);
        served.map(move |(k, _)| (k, [first[0] + k % size[0], first[1] + k / size[0]]))
    }
}

/// Mean square difference of two colours over black.
fn difference(a: &[f32; 4], b: &[f32; 4]) -> f32 {
    (0..3).map(|c| (a[c].clamp(0.0, 1.0) - b[c].clamp(0.0, 1.0)).powi(2)).sum::<f32>() / 3.0
}

/// Errors of the picture, from those of the tiles, which are per weight.
fn summary(tiles: &[TileErrors], mean_weight: f64) -> Errors {
    let mean = |of: &dyn Fn(&TileErrors) -> f64| tiles.iter().map(of).sum::<f64>() / tiles.len() as f64;
    let along = [0, 1].map(|level| [0, 1].map(|reads| mean_weight * mean(&|tile| tile.along[level][reads])));
    let across = [0, 1, 2].map(|level| mean_weight * mean(&|tile| tile.across[level]));
    // Spread among the tiles, in the middle of what is measured: all sheets, two thirds of the texels.
    let total = |tile: &TileErrors| tile.along[1][1] + tile.across[1];
    let whole = mean(&total);
    let variance = mean(&|tile| (total(tile) - whole).powi(2));
    let deviation = (variance / (tiles.len() as f64 - 1.0).max(1.0)).sqrt() / whole.max(f64::MIN_POSITIVE);
    Errors::measured(along, across, deviation)
}
