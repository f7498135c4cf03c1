//! What a picture tells of its own error.
//!
//! Two errors add up, and neither knows much of the other: that of the sheets, along the rays, and that of the base
//! plane and the warp, across them. Each is told from the change that another effort makes: some pieces of tiles are
//! drawn once more with half or twice the sheets, mostly where there is contrast, and some rows of pixels are read once
//! more from every second and every fourth texel.
//!
//! Errors are mean square errors of the colours over black, peak 1, of the whole picture. How large they are by those
//! changes is experience with soft and hard functions on a casting, a CT, an MRI and ripples; `tests/estimate.rs`
//! and `python/tests/test_quality.py` hold it to other pictures, too.

use wavesplat_compute::parallel;
use wavesplat_compute::simd::LANES;
use wavesplat_core::{Composite, Picture, Result};

use crate::picture::base_picture::BasePicture;
use crate::picture::color_projection::color_projection;
use crate::picture::supersampling::reads_per_axis;
use crate::quality::parts::difference;
use crate::render::frame::warped_rows;
use crate::render::progress::{Progress, ProgressCallback};
use crate::render::scene::Scene;
use crate::render::tile::Piece;
use crate::sheet::tile_layout::Block;
use crate::sheet::tile_layout::{BLOCK_V, N_BLOCKS_V, N_STRIPS, TILE_U, TILE_V};

/// What a picture tells of its own error.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Along the rays.
    pub along: f64,
    /// Across the rays.
    pub across: f64,
    /// The factor by which the latter falls with half the distance of texels.
    pub across_decay: f64,
}

/// Of so many pieces that show something one is drawn once more; and of few so many.
const EVERY_PIECE: usize = 32;
const LEAST_PIECES: usize = 16;

/// A piece that has no contrast counts as much as others with this share of the mean.
const FLAT: f64 = 0.1;

/// Blocks of a strip that are a piece.
const N_BLOCKS: usize = 2;

/// The error of a picture with plain sheets is this share of what half the sheets change, with few sheets per slice and
/// with many: errors fall by 8 dB or more with twice the sheets, and both pictures have their own.
const OF_HALF: [f64; 2] = [0.15, 0.1];
const MANY_SHEETS: f64 = 3.0;

/// The error of a picture by what twice the sheets change: these have errors of their own, and share some with it.
const OF_TWICE: f64 = 1.0;

/// Fewer slabs cannot be halved.
const LEAST_SLABS_TO_HALVE: usize = 16;

/// Rows of pixels that are compared together, how many such bands are at least, and of how many one is at most.
const BAND_PX: usize = 16;
const LEAST_BANDS: usize = 8;
const EVERY_BAND: usize = 4;

/// The factor by which half the distance of texels makes the error fall: not less than this, and not more with one read
/// per pixel and with several, where colours along a ray change smoothly, where they do not, and of projections, which
/// end abruptly where the volume does.
const LEAST_DECAY: f64 = 0.63;
const MOST_DECAY: [[f64; 2]; 3] = [[0.2, 0.16], [0.3, 0.2], [0.5, 0.5]];

/// Noise of the sheets changes what is measured across the rays, too: by this share of the error along them, of what is
/// measured by that much at most, where colours along a ray change smoothly and where they do not.
const COMMON: f64 = 0.3;
const MOST_COMMON: [f64; 2] = [0.4, 0.25];

/// What is left of errors along and across the rays where a pixel is the mean of two reads along each axis, with hardly
/// more than one texel per pixel; and the factors by which that falls with twice the texels along each, since there are
/// more of them. Across the rays: where colours along a ray change smoothly, and where they do not.
const ALONG_OF_MEAN: [f64; 2] = [0.8, 0.85];
const ACROSS_OF_MEAN: [[f64; 2]; 2] = [[0.55, 0.5], [0.72, 0.66]];

/// The shares of the errors along and across the rays that are left where a pixel is the mean of several reads.
pub fn left_by_mean(composite: Composite, oversampling: f64, is_smooth: bool) -> [f64; 2] {
    if reads_per_axis(composite, oversampling) == 1 {
        return [1.0; 2];
    }
    [ALONG_OF_MEAN, ACROSS_OF_MEAN[usize::from(!is_smooth)]]
        .map(|[first, per_octave]| first * per_octave.powf(oversampling.log2()))
}

/// Measures the errors of a picture and the base planes that it is made of; `None` where nothing is seen.
pub(crate) fn errors(
    scene: &Scene,
    base_pictures: &[BasePicture],
    picture: &Picture,
    monitor: &dyn ProgressCallback,
) -> Result<Option<Errors>> {
    let n_seen = picture.rgba.iter().filter(|rgba| rgba[3] > 0.0).count();
    if n_seen == 0 {
        return Ok(None);
    }
    let share_seen = n_seen as f64 / picture.rgba.len() as f64;
    let along = share_seen * along(scene, base_pictures, monitor)?;
    let [fewer, fewest] = across(scene, base_pictures, picture).map(|error| share_seen * error);
    let (composite, oversampling) = (scene.options.composite, scene.options.oversampling);
    let is_smooth = scene.is_smooth();
    let [is_mean, is_fewer_mean] = [1.0, 0.5].map(|share| reads_per_axis(composite, share * oversampling) > 1);
    let [along_left, across_left] = left_by_mean(composite, oversampling, is_smooth);
    let kind = if composite.is_projection() { 2 } else { usize::from(!is_smooth) };
    let most_decay = MOST_DECAY[kind][usize::from(is_fewer_mean)];
    let decay = if fewest > 0.0 { (fewer / fewest).clamp(most_decay, LEAST_DECAY) } else { LEAST_DECAY };
    let across = fewer * decay * if is_fewer_mean { 1.0 } else { across_left };
    // Noise of the sheets is in both; the mean of several reads has less of it.
    let most_common = MOST_COMMON[usize::from(!is_smooth)];
    let across = across - if is_mean { 0.0 } else { (COMMON * along).min(most_common * across) };
    Ok(Some(Errors { along: along * along_left, across, across_decay: decay }))
}

/// Squares of differences of what is seen.
#[derive(Clone, Copy, Default)]
struct Difference {
    sum_of_squares: f64,
    n_seen: usize,
}

impl Difference {
    fn between(a: &[[f32; 4]], b: &[[f32; 4]]) -> Self {
        let mut all = Self::default();
        for (a, b) in a.iter().zip(b) {
            all.sum_of_squares += f64::from(difference(a, b));
            all.n_seen += usize::from(a[3] > 0.0 || b[3] > 0.0);
        }
        all
    }

    fn merge(self, other: Self) -> Self {
        Self { sum_of_squares: self.sum_of_squares + other.sum_of_squares, n_seen: self.n_seen + other.n_seen }
    }

    /// Per what is seen.
    fn mean(self) -> f64 {
        self.sum_of_squares / self.n_seen.max(1) as f64
    }
}

/// The error along the rays, per texel that is seen.
fn along(scene: &Scene, base_pictures: &[BasePicture], monitor: &dyn ProgressCallback) -> Result<f64> {
    let sheets_per_slice = scene.options.sheets_per_slice;
    let n_slabs = |picture: &BasePicture| scene.spacing(&picture.plane, sheets_per_slice).n_slabs;
    let can_halve = base_pictures.iter().all(|picture| n_slabs(picture) >= LEAST_SLABS_TO_HALVE);
    let of_half = OF_HALF[usize::from(sheets_per_slice >= MANY_SHEETS)];
    let (times, share) =
        if can_halve && sheets_per_slice >= 1.0 && scene.is_smooth() { (0.5, of_half) } else { (2.0, OF_TWICE) };
    let mut all: Vec<Place> = Vec::new();
    for (plane, picture) in base_pictures.iter().enumerate() {
        let tiles = Piece::all(&picture.plane);
        let of_tile = |k: usize| {
            let places = pieces_of(tiles[k]).map(|piece| Place::new(plane, piece, picture));
            places.filter(|place| place.n_seen > 0).collect::<Vec<_>>()
        };
        all.extend(parallel::map(tiles.len(), of_tile).into_iter().flatten());
    }
    if all.is_empty() {
        return Ok(0.0);
    }
    let floor = FLAT * all.iter().map(|place| place.contrast).sum::<f64>() / all.len() as f64 + f64::MIN_POSITIVE;
    for place in &mut all {
        place.contrast += floor;
    }
    let n_seen: usize = all.iter().map(|place| place.n_seen).sum();
    let n = (all.len() / EVERY_PIECE).max(LEAST_PIECES).min(all.len());
    let (chosen, of_all) = choose(&all, n);
    let progress = Progress::new(monitor, n);
    let mut sums = Vec::new();
    for (k, picture) in base_pictures.iter().enumerate() {
        let of_plane: Vec<&Place> = chosen.iter().filter(|place| place.plane == k).copied().collect();
        if of_plane.is_empty() {
            continue;
        }
        let mut pieces: Vec<Piece> = of_plane.iter().map(|place| place.piece).collect();
        pieces.dedup();
        let (other, ..) = scene.draw_plane(&picture.plane, times * sheets_per_slice, &pieces, &progress)?;
        sums.extend(of_plane.iter().map(|place| {
            let [own, other] = [picture, &other].map(|picture| colors_of(scene, picture, &place.piece));
            Difference::between(&own, &other).sum_of_squares * (of_all / place.contrast)
        }));
    }
    Ok(share * likely_most(&sums) / n_seen as f64)
}

/// A piece that shows something.
struct Place {
    plane: usize,
    piece: Piece,
    n_seen: usize,
    /// How much colours change from texel to texel in it.
    contrast: f64,
}

impl Place {
    fn new(plane: usize, piece: Piece, picture: &BasePicture) -> Self {
        let mut n_seen = 0;
        let mut changes = [0.0_f32; 4];
        for row in rows_of(picture, &piece) {
            n_seen += row.iter().filter(|rgba| rgba[3] > 0.0).count();
            for (a, b) in row.iter().zip(row.iter().skip(1)) {
                for c in 0..4 {
                    changes[c] += (a[c] - b[c]).powi(2);
                }
            }
        }
        let contrast = changes[0] + changes[1] + changes[2];
        Self { plane, piece, n_seen, contrast: f64::from(contrast) }
    }
}

/// Chooses pieces, those of much contrast more often than others.
fn choose(all: &[Place], n: usize) -> (Vec<&Place>, f64) {
    let sum: f64 = all.iter().map(|place| place.contrast).sum();
    let mut chosen = Vec::new();
    let mut before = 0.0;
    for place in all {
        before += place.contrast;
        while chosen.len() < n && (chosen.len() as f64 + 0.5) * sum <= before * n as f64 {
            chosen.push(place);
        }
    }
    (chosen, sum)
}

/// The pieces of a tile.
fn pieces_of(tile: Piece) -> impl Iterator<Item = Piece> {
    (0..N_STRIPS).flat_map(move |strip| {
        (0..N_BLOCKS_V).step_by(N_BLOCKS).map(move |first| {
            let mask = |block: usize| Block { strip, row: block * BLOCK_V }.mask();
            Piece { blocks: (first..first + N_BLOCKS).map(mask).sum(), ..tile }
        })
    })
}

/// The texels of a piece.
fn rows_of<'a>(picture: &'a BasePicture, piece: &Piece) -> impl Iterator<Item = &'a [[f32; 4]]> {
    let [n_u, n_v] = picture.plane.size;
    let first = Block::new(piece.blocks.trailing_zeros() as usize);
    let (i, j) = (piece.tile[0] * TILE_U + first.strip * LANES, piece.tile[1] * TILE_V + first.row);
    let columns = i.min(n_u)..(i + LANES).min(n_u);
    (j..(j + N_BLOCKS * BLOCK_V).min(n_v)).map(move |j| &picture.row(j)[columns.clone()])
}

/// What they look like.
fn colors_of(scene: &Scene, picture: &BasePicture, piece: &Piece) -> Vec<[f32; 4]> {
    let mut texels: Vec<_> = rows_of(picture, piece).flatten().copied().collect();
    let composite = scene.options.composite;
    if composite.is_projection() {
        color_projection(&mut texels, scene.grid, scene.tf, composite);
    }
    texels
}

/// The mean of numbers and its standard error: few may happen to be good ones.
fn likely_most(numbers: &[f64]) -> f64 {
    let n = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / n;
    if numbers.len() < 2 {
        return mean;
    }
    let variance = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    mean + (variance / n).sqrt()
}

/// What half the texels along each axis change, and a quarter of them, per pixel that is seen.
fn across(scene: &Scene, base_pictures: &[BasePicture], picture: &Picture) -> [f64; 2] {
    let n_bands = picture.height_px.div_ceil(BAND_PX);
    let every = (n_bands / LEAST_BANDS).clamp(1, EVERY_BAND);
    [2, 4].map(|k_texels| {
        let mut all = Difference::default();
        // Few texels may happen to lie well.
        let n_first = if n_bands < LEAST_BANDS { k_texels } else { 1 };
        let least_size = base_pictures.iter().flat_map(|picture| picture.plane.size).fold(k_texels, usize::min);
        for first in 0..n_first.min(least_size) {
            let coarser: Vec<BasePicture> =
                base_pictures.iter().map(|picture| picture.every(k_texels, first)).collect();
            let of_band = |k: usize| {
                let band = every / 2 + k * every;
                let rows = band * BAND_PX..((band + 1) * BAND_PX).min(picture.height_px);
                let own = &picture.rgba[rows.start * picture.width_px..rows.end * picture.width_px];
                let other = warped_rows(scene, &coarser, rows, scene.options.oversampling / k_texels as f64, false);
                Difference::between(own, &other.rgba)
            };
            let bands = parallel::map((n_bands - every / 2).div_ceil(every), of_band);
            all = bands.into_iter().fold(all, Difference::merge);
        }
        all.mean()
    })
}
