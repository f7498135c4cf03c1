//! Sheet buffers parallel to the slices: one per slice, texels on the rays of a base plane
//! ([`wavesplat_splat::view::base_plane`]), so that mapping all of them to the view plane is one warp at the end.
//!
//! The footprint `h(u) h(v)` is separable, so the samples of a row are splatted along u together, and the row along v.
//! Work is cut into tiles, each with all its sheets front to back; chunks are rows of 16 texels.

use std::sync::Mutex;

use wavesplat_compute::locks::{lock, unlocked};
use wavesplat_compute::parallel;
use wavesplat_compute::simd::{LANES, Lanes, Simd, VectorKernel};
use wavesplat_core::{Error, Result};
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::progress::Progress;
use wavesplat_splat::sheet::tile_layout::{Chunk, N_STRIPS, TILE_U, TILE_V};
use wavesplat_splat::view::base_plane::BasePlane;

use super::FamilyScene;
use super::footprint::{AxisFootprint, KernelTable, reach};
use super::samples::{Densities, visible_layers};
use super::shaded::Shaded;

/// Opacity at which a ray stops: what is left is a tenth of a grey level of 1024.
pub const OPAQUE_ENOUGH: f32 = 1.0 - 1e-4;

/// Distance from the eye within which nothing is drawn, in slices.
pub const NEAREST_SLICE: f64 = 0.5;

/// Number of tiles of a base plane.
pub fn n_tiles(plane: &BasePlane) -> usize {
    plane.size[0].div_ceil(TILE_U) * plane.size[1].div_ceil(TILE_V)
}

/// Draws a base plane; returns it with the number of samples that were splatted.
pub fn draw_plane(family: &FamilyScene, plane: &BasePlane, progress: &Progress) -> Result<(BasePicture, u64)> {
    let table = KernelTable::new(family.scene.standard.kernel);
    let all = Mutex::new((BasePicture::new(plane.clone(), false), 0));
    let n_tiles_u = plane.size[0].div_ceil(TILE_U);
    parallel::for_each(n_tiles(plane), |t| {
        if progress.is_stopped() {
            return;
        }
        let first = [t % n_tiles_u * TILE_U, t / n_tiles_u * TILE_V];
        if let Some((tile, n_splats)) = draw_tile(family, plane, &table, first) {
            let mut all = lock(&all);
            let (picture, n_all) = &mut *all;
            *n_all += n_splats;
            for strip in 0..N_STRIPS {
                for row in 0..TILE_V {
                    let (i, j) = (first[0] + strip * LANES, first[1] + row);
                    if i < plane.size[0] && j < plane.size[1] {
                        picture.put(i, j, &tile.texels(Chunk { strip, row }), None);
                    }
                }
            }
        }
        progress.tile_done();
    });
    if progress.is_stopped() {
        return Err(Error::Cancelled);
    }
    Ok(unlocked(all))
}

/// Associated colour and opacity of a tile, chunk by chunk.
struct AxisTile {
    rgba: Vec<[Lanes; 4]>,
    /// Chunks that are opaque or beyond the base plane.
    done: Vec<bool>,
}

impl AxisTile {
    /// An empty tile; chunks beyond the base plane are done.
    fn new(plane: &BasePlane, [i0, j0]: [usize; 2]) -> Self {
        let mut tile = Self { rgba: vec![[Lanes::splat(0.0); 4]; Chunk::N], done: vec![false; Chunk::N] };
        for strip in 0..N_STRIPS {
            for row in 0..TILE_V {
                let is_beyond = i0 + strip * LANES >= plane.size[0] || j0 + row >= plane.size[1];
                tile.done[Chunk { strip, row }.index()] = is_beyond;
            }
        }
        tile
    }

    fn texels(&self, chunk: Chunk) -> [[f32; 4]; LANES] {
        let [r, g, b, a] = &self.rgba[chunk.index()];
        std::array::from_fn(|i| [r.0[i], g.0[i], b.0[i], a.0[i]])
    }
}

/// Draws the tile whose first texel is given, and counts its splats; `None` where nothing is seen.
fn draw_tile(
    family: &FamilyScene,
    plane: &BasePlane,
    table: &KernelTable,
    first: [usize; 2],
) -> Option<(AxisTile, u64)> {
    let kernel = family.scene.standard.kernel;
    let [n_u, n_v, _] = family.size();
    let is_ahead = |w: f64| {
        let sign = if family.family.ascending { 1.0 } else { -1.0 };
        plane.eye_w().is_none_or(|eye| sign * (w - eye) >= NEAREST_SLICE)
    };
    let layers = visible_layers(family, |w| {
        let [(u0, du), (v0, dv)] = plane.sheet(w);
        let hull = |origin: f64, step: f64, first: usize, n: usize| {
            let (a, b) = (origin + step * first as f64, origin + step * (first + n - 1) as f64);
            [a.min(b) - reach(kernel, step), a.max(b) + reach(kernel, step)]
        };
        is_ahead(w).then(|| [hull(u0, du, first[0], TILE_U), hull(v0, dv, first[1], TILE_V)])
    });
    if layers.is_empty() {
        return None;
    }
    let mut tile = AxisTile::new(plane, first);
    let (mut densities, mut shaded, mut sheet) = (Densities::default(), Shaded::default(), ColorSheet::default());
    let mut n_splats = 0;
    for (k, layer) in layers.iter().enumerate() {
        let [(u0, du), (v0, dv)] = plane.sheet(layer.slice as f64);
        family.scene.level.run(
            #[inline(always)]
            || {
                sheet.u.build(table, u0 + du * first[0] as f64, du, N_STRIPS, n_u);
                sheet.v.build(table, v0 + dv * first[1] as f64, dv, TILE_V / LANES, n_v);
            },
        );
        densities.cover(family, &layers, k);
        // Texels may lie a kernel's radius beyond the samples on either side, and read whole vectors there.
        let n_splats_here = shaded.fill(family, &densities, layer, 2 * sheet.u.n_taps + LANES);
        if n_splats_here == 0 {
            continue;
        }
        n_splats += n_splats_here as u64;
        let origin = [layer.window.u[0], layer.window.v[0]];
        let (peak, n_rows) = (family.scene.peak, layer.window.n_v());
        let composite = CompositeChunks { sheet: &mut sheet, shaded: &shaded, origin, n_rows, peak, tile: &mut tile };
        family.scene.level.dispatch(composite);
        if !tile.done.contains(&false) {
            break;
        }
    }
    Some((tile, n_splats))
}

/// Work space of a sheet buffer: the footprints of its texels, and the sample rows of a strip splatted along u.
#[derive(Default)]
struct ColorSheet {
    u: AxisFootprint,
    v: AxisFootprint,
    rows: Vec<[Lanes; 4]>,
    is_visible: Vec<bool>,
}

/// Splats the samples of a slice into the sheet buffer, and composites it.
struct CompositeChunks<'a> {
    sheet: &'a mut ColorSheet,
    shaded: &'a Shaded,
    /// First sample along u and v.
    origin: [i64; 2],
    n_rows: usize,
    peak: f32,
    tile: &'a mut AxisTile,
}

impl VectorKernel for CompositeChunks<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Self { sheet: ColorSheet { u, v, rows, is_visible }, shaded, origin, n_rows, peak, tile } = self;
        rows.resize(n_rows, [Lanes::default(); 4]);
        is_visible.resize(n_rows, false);
        for strip in 0..N_STRIPS {
            // Sample rows that the unfinished rows of texels reach.
            let alive = |row: &usize| !tile.done[Chunk { strip, row: *row }.index()];
            let firsts = (0..TILE_V).filter(alive).map(|row| v.first(row) - origin[1]);
            let hull = |[lo, hi]: [i64; 2], first: i64| [lo.min(first), hi.max(first + v.n_taps as i64)];
            let [from, to] = firsts.fold([i64::MAX, i64::MIN], hull);
            let (from, to) = (from.clamp(0, n_rows as i64) as usize, to.clamp(0, n_rows as i64) as usize);
            let [reached_lo, reached_hi] = u.reached(strip).map(|sample| sample - origin[0]);
            let mut any = false;
            for row in from..to {
                let span = shaded.span(row);
                is_visible[row] = span.is_some_and(|[lo, hi]| reached_lo <= hi as i64 && lo as i64 <= reached_hi);
                if is_visible[row] {
                    any = true;
                    for c in 0..4 {
                        let first = origin[0] - shaded.padding() as i64;
                        s.store(u.sum(s, strip, shaded.row(c, row), first), &mut rows[row][c].0);
                    }
                }
            }
            if !any {
                continue;
            }
            for row in 0..TILE_V {
                let chunk = Chunk { strip, row }.index();
                if tile.done[chunk] {
                    continue;
                }
                let first = v.first(row) - origin[1];
                let mut sums = [s.splat(0.0); 4];
                let mut any = false;
                for t in 0..v.n_taps {
                    let sample_row = first + t as i64;
                    if sample_row < from as i64 || sample_row >= to as i64 || !is_visible[sample_row as usize] {
                        continue;
                    }
                    any = true;
                    let weight = s.splat(v.weight(row, t));
                    for c in 0..4 {
                        sums[c] = s.add_mul(sums[c], weight, s.load(&rows[sample_row as usize][c].0));
                    }
                }
                if any {
                    tile.done[chunk] = over(s, &mut tile.rgba[chunk], sums, peak);
                }
            }
        }
    }
}

/// Clamps sums of splats to valid colours, and composites them; returns whether all of the chunk is opaque.
#[inline(always)]
fn over<S: Simd>(s: S, rgba: &mut [Lanes; 4], sums: [S::F; 4], peak: f32) -> bool {
    let zero = s.splat(0.0);
    let alpha = s.min(s.max(sums[3], zero), s.splat(1.0));
    let brightest = s.mul(alpha, s.splat(peak));
    let before = s.load(&rgba[3].0);
    let through = s.sub(s.splat(1.0), before);
    for c in 0..3 {
        let color = s.min(s.max(sums[c], zero), brightest);
        s.store(s.add_mul(s.load(&rgba[c].0), through, color), &mut rgba[c].0);
    }
    let after = s.add_mul(before, through, alpha);
    s.store(after, &mut rgba[3].0);
    s.bits(s.le(s.splat(OPAQUE_ENOUGH), after)) == u16::MAX
}
