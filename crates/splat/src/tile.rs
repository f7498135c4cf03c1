//! One tile of a base plane, all its sheets front to back, without leaving the cache.

use std::ops::Range;

use glam::DAffine3;

use crate::composite::{Between, Compositor, RayRow, Slab, Texel};
use crate::interval::Region;
use crate::sheet::{Row, Sheet, SheetGeometry, TILE_U, TILE_V};

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

    /// Sheets from the last one before an interval of w to the first one after it.
    fn range(&self, [lo, hi]: [f64; 2]) -> Range<usize> {
        if lo >= hi {
            return 0..0;
        }
        let n = self.n_slabs as f64;
        let first = (lo / self.step).floor().clamp(0.0, n - 1.0);
        let last = (hi / self.step).ceil().clamp(first + 1.0, n);
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
    /// Sheets that a compositor may ask for between two sheets.
    pub n_between: usize,
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
        let range = self.spacing.range(span);
        let sign = self.sign();
        let w = |k: usize| {
            // Front to back: the k-th sheet a ray meets.
            let sheet_idx = if sign > 0.0 { range.start + k } else { range.end - 1 - k };
            self.spacing.w(sheet_idx)
        };
        // Reconstruction runs one sheet ahead of shading.
        let (mut front, mut back) = (Sheet::default(), Sheet::default());
        let mut between = Between::default();
        let mut front_range =
            if range.is_empty() { [0.0; 2] } else { front.combine(&self.geometry, w(0), first, n_rows) };
        for k in 1..range.len() {
            if (0..n_rows).all(|row| compositor.is_done(row)) {
                break;
            }
            let back_range = back.combine(&self.geometry, w(k), first, n_rows);
            let both = [front_range[0].min(back_range[0]), front_range[1].max(back_range[1])];
            if compositor.wants(both) {
                between.reset(self.n_between);
                let mut slab = Slab {
                    s: [(sign * w(k - 1)) as f32, (sign * w(k)) as f32],
                    range: both,
                    is_last: k + 1 == range.len(),
                    sheets: [&mut front, &mut back],
                    between: &mut between,
                    geometry: &self.geometry,
                    place: (first, n_rows),
                };
                for (row, rays) in rays.iter().enumerate() {
                    if !compositor.is_done(row) {
                        compositor.add(row, rays, &mut slab);
                        work.n_texels += TILE_U as u64;
                    }
                }
            } else {
                work.n_skipped += 1;
            }
            std::mem::swap(&mut front, &mut back);
            front_range = back_range;
        }
        let mut texels = vec![Texel::default(); TILE_U * n_rows];
        for (row, out) in texels.chunks_exact_mut(TILE_U).enumerate() {
            compositor.finish(row, out);
            // Compositors count along the ray; the rest of the world counts along w.
            for texel in out {
                texel.w_half *= sign as f32;
            }
        }
        (texels, work)
    }

    fn sign(&self) -> f64 {
        if self.geometry.plane.family.ascending { 1.0 } else { -1.0 }
    }

    /// The rays of a tile, and the interval of w that any of them needs.
    fn rays(&self, [i0, j0]: [usize; 2], n_rows: usize) -> (Vec<RayRow>, [f64; 2]) {
        let plane = self.geometry.plane;
        let sign = self.sign();
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
                    let (near, far) = if sign > 0.0 { (lo, hi) } else { (-hi, -lo) };
                    row.interval[0][i] = near as f32;
                    row.interval[1][i] = far as f32;
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
    fn the_sheets_enclose_the_interval() {
        let spacing = SheetSpacing::new(11, 2.0);
        assert_eq!(spacing.range([0.0, 10.0]), 0..21);
        assert_eq!(spacing.range([0.3, 0.4]), 0..2);
        assert_eq!(spacing.range([0.2, 0.8]), 0..3);
        assert_eq!(spacing.range([0.5, 1.0]), 1..3);
        assert_eq!(spacing.range([10.0 - 1e-9, 10.0]), 19..21);
        assert_eq!(spacing.range([3.0, 3.0]), 0..0);
    }
}
