//! One tile of a base plane, all its sheets front to back, without leaving the cache.

use std::ops::Range;

use glam::DAffine3;

use crate::composite::{Compositor, RayRow, Slab, Texel};
use crate::interval::Region;
use crate::sheet::{Row, Sheet, SheetGeometry, SheetRow, TILE_U, TILE_V};

/// Where the sheets of a family lie: `n + 1` sheets from the first slice to the last, evenly spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SheetSpacing {
    /// Slabs between the sheets.
    pub n_slabs: usize,
    /// Slice distances between sheets.
    pub step: f64,
}

impl SheetSpacing {
    /// About `sheets_per_slice` sheets per slice distance, with one on the first and one on the last slice.
    pub fn new(n_slices: usize, sheets_per_slice: f64) -> Self {
        let last = (n_slices - 1) as f64;
        let n_slabs = (last * sheets_per_slice).round().max(1.0);
        Self { n_slabs: n_slabs as usize, step: last / n_slabs }
    }

    /// Position of a sheet.
    pub fn w(&self, sheet_idx: usize) -> f64 {
        sheet_idx as f64 * self.step
    }

    /// Sheets whose slab meets an interval of w. Clamps at the faces, where nothing is drawn beyond.
    fn range(&self, [lo, hi]: [f64; 2]) -> Range<usize> {
        if lo >= hi {
            return 0..0;
        }
        let n = self.n_slabs as f64;
        let first = (lo / self.step - 0.5).ceil().clamp(0.0, n);
        let last = (hi / self.step + 0.5).floor().clamp(0.0, n);
        first as usize..last as usize + 1
    }
}

/// What all tiles of a base plane share.
pub struct TileJob<'a> {
    pub geometry: SheetGeometry<'a>,
    pub region: &'a Region,
    pub spacing: SheetSpacing,
    pub world_from_index: DAffine3,
    pub opacity_unit: f64,
}

/// Numbers for the report.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Texels that were reconstructed.
    pub n_texels: u64,
    /// Sheets of tiles left out because nothing in them is visible.
    pub n_skipped: u64,
}

impl TileJob<'_> {
    /// Tiles along u and v.
    pub fn n_tiles(&self) -> [usize; 2] {
        let [n_u, n_v] = self.geometry.plane.size;
        [n_u.div_ceil(TILE_U), n_v.div_ceil(TILE_V)]
    }

    /// Runs one tile and returns its texels, row by row, `TILE_U` wide.
    pub fn run(&self, tile: [usize; 2], compositor: &mut impl Compositor) -> (Vec<Texel>, Work) {
        let first = [tile[0] * TILE_U, tile[1] * TILE_V];
        let n_rows = TILE_V.min(self.geometry.plane.size[1] - first[1]);
        let (rays, span) = self.rays(first, n_rows);
        let mut work = Work::default();
        let mut sheet = Sheet::default();
        let mut row_buffer = SheetRow::default();
        let ascending = self.geometry.plane.family.ascending;
        let range = self.spacing.range(span);
        for k in 0..range.len() {
            let sheet_idx = if ascending { range.start + k } else { range.end - 1 - k };
            if (0..n_rows).all(|row| compositor.is_done(row)) {
                break;
            }
            let w = self.spacing.w(sheet_idx);
            let density_range = sheet.combine(&self.geometry, w, first, n_rows);
            if !compositor.wants(density_range) {
                compositor.skip();
                work.n_skipped += 1;
                continue;
            }
            sheet.upsample_u(&self.geometry, w);
            let slab = self.slab(w);
            for (row, rays) in rays.iter().enumerate() {
                if compositor.is_done(row) {
                    continue;
                }
                sheet.density_row(row, &mut row_buffer);
                if !compositor.wants(bounds(&row_buffer.density)) {
                    continue;
                }
                if compositor.wants_gradient() {
                    sheet.gradient_row(row, &mut row_buffer);
                }
                compositor.add(row, rays, &slab, &row_buffer);
                work.n_texels += TILE_U as u64;
            }
        }
        let mut texels = vec![Texel::default(); TILE_U * n_rows];
        for (row, out) in texels.chunks_exact_mut(TILE_U).enumerate() {
            compositor.finish(row, out);
        }
        (texels, work)
    }

    fn slab(&self, w: f64) -> Slab {
        let half = 0.5 * self.spacing.step;
        let sign = if self.geometry.plane.family.ascending { 1.0 } else { -1.0 };
        Slab { w: w as f32, interval: [(w - half) as f32, (w + half) as f32], step: (sign * self.spacing.step) as f32 }
    }

    /// The rays of a tile, and the interval of w that any of them needs.
    fn rays(&self, [i0, j0]: [usize; 2], n_rows: usize) -> (Vec<RayRow>, [f64; 2]) {
        let plane = self.geometry.plane;
        let sign = if plane.family.ascending { 1.0 } else { -1.0 };
        let columns = plane.family.axes.map(|a| self.world_from_index.matrix3.col(a));
        let empty: Row = [0.0; TILE_U];
        let blank = RayRow { interval: [empty; 2], thickness: empty, to_eye: [empty; 3] };
        let mut span = [f64::INFINITY, f64::NEG_INFINITY];
        let mut rows = vec![blank; n_rows];
        for (j, row) in rows.iter_mut().enumerate() {
            for i in 0..TILE_U {
                let ray = plane.ray((i0 + i) as f64, (j0 + j) as f64);
                let [lo, hi] = self.region.texel_interval(plane, &ray);
                if lo < hi {
                    span = [span[0].min(lo), span[1].max(hi)];
                    row.interval[0][i] = lo as f32;
                    row.interval[1][i] = hi as f32;
                }
                let per_slice = columns[0] * ray.slope[0] + columns[1] * ray.slope[1] + columns[2];
                let length = per_slice.length();
                row.thickness[i] = (length / self.opacity_unit) as f32;
                let to_eye = per_slice * (-sign / length);
                for c in 0..3 {
                    row.to_eye[c][i] = to_eye[c] as f32;
                }
            }
        }
        (rows, span)
    }
}

#[inline(always)]
fn bounds(row: &Row) -> [f32; 2] {
    let (mut lo, mut hi) = (f32::INFINITY, f32::NEG_INFINITY);
    for &d in row {
        lo = if d < lo { d } else { lo };
        hi = if d > hi { d } else { hi };
    }
    [lo, hi]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sheets_lie_on_the_first_and_the_last_slice() {
        for (n, per_slice) in [(2, 1.0), (2, 0.1), (111, 2.0), (84, 0.5), (7, 1.3)] {
            let spacing = SheetSpacing::new(n, per_slice);
            assert_eq!(spacing.w(0), 0.0);
            assert!((spacing.w(spacing.n_slabs) - (n - 1) as f64).abs() < 1e-9);
        }
    }

    #[test]
    fn every_slab_that_meets_the_interval_is_visited() {
        let spacing = SheetSpacing::new(11, 2.0);
        assert_eq!(spacing.range([0.0, 10.0]), 0..21);
        assert_eq!(spacing.range([0.3, 0.6]), 1..2);
        assert_eq!(spacing.range([0.2, 0.8]), 0..3);
        assert_eq!(spacing.range([3.0, 3.0]), 0..0);
    }
}
