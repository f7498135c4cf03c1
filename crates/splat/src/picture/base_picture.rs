//! A finished base plane: premultiplied texels, put into it tile by tile.

use std::ops::Range;

use glam::DVec2;
use wavesplat_compute::simd::LANES;
use wavesplat_compute::{pages, parallel};

use crate::sheet::tile_layout::TilePart;
use crate::view::base_plane::BasePlane;

/// Texels that share an entry of [`BasePicture::drawn_cells`], along u and v.
pub const CELL: [usize; 2] = [LANES, 8];

/// Width of the empty margin on all sides, in texels: the reach of the filter from an empty position.
pub const MARGIN: usize = 3;

/// A finished base plane.
pub struct BasePicture {
    /// Layout of the texels.
    pub plane: BasePlane,
    /// Rows of texels, the margin included: associated RGBA; projections: density, length of the path, 0, coverage.
    texels: Vec<[f32; 4]>,
    /// w at which each texel's ray reaches opacity ½, NaN where it does not; empty where no depth is wanted.
    pub w_half: Vec<f32>,
    /// The flags of [`BasePicture::drawn_cells`].
    drawn: Vec<bool>,
}

impl BasePicture {
    /// An empty picture.
    pub fn new(plane: BasePlane, with_depth: bool) -> Self {
        let [n_u, n_v] = plane.size;
        let cells = n_cells(&plane);
        let mut texels = vec![[0.0; 4]; (n_u + 2 * MARGIN) * (n_v + 2 * MARGIN)];
        pages::prefer_large(&mut texels);
        Self {
            plane,
            texels,
            w_half: vec![f32::NAN; if with_depth { n_u * n_v } else { 0 }],
            drawn: vec![false; cells[0] * cells[1]],
        }
    }

    /// Whether nothing can be seen in the picture.
    pub fn is_empty(&self) -> bool {
        !self.drawn.contains(&true)
    }

    /// All texels, row by row, with [`MARGIN`] on all sides; and the number of texels per row.
    pub fn with_margin(&self) -> (&[[f32; 4]], usize) {
        (&self.texels, self.pitch())
    }

    /// Flags of the cells of [`CELL`] texels, row by row: drawn in, or next to a cell that was; and the number of cells
    /// per row.
    pub fn drawn_cells(&self) -> (&[bool], usize) {
        (&self.drawn, n_cells(&self.plane)[0])
    }

    fn pitch(&self) -> usize {
        self.plane.size[0] + 2 * MARGIN
    }

    /// Rows of texels: associated RGBA; projections: density, length of the path, 0, coverage.
    pub fn texels(&self) -> Vec<[f32; 4]> {
        (0..self.plane.size[1]).flat_map(|j| self.row(j)).copied().collect()
    }

    /// A row of texels, as in [`BasePicture::texels`].
    pub fn row(&self, j: usize) -> &[[f32; 4]] {
        &self.texels[(j + MARGIN) * self.pitch() + MARGIN..][..self.plane.size[0]]
    }

    /// Every `k`th texel along u and along v, from the `first`th on.
    #[must_use]
    pub fn every(&self, k: usize, first: usize) -> Self {
        let mut coarser = Self::new(self.plane.every(k, first), false);
        let [n_u, n_v] = coarser.plane.size;
        for j in 0..n_v {
            let row = self.row(first + k * j);
            for i in (0..n_u).step_by(LANES) {
                let chunk = std::array::from_fn(|lane| row.get(first + k * (i + lane)).copied().unwrap_or_default());
                coarser.put(i, j, &chunk, None);
            }
        }
        coarser
    }

    /// Calls `work` with the number of every tile of `tile_size` texels, counted row by row, and its texels, on all
    /// threads.
    ///
    /// Tiles are disjoint, so no thread waits for another.
    pub fn fill_tiles(&mut self, tile_size: [usize; 2], work: impl Fn(usize, &mut TileTexels) + Sync + Send) {
        let n_tiles = [0, 1].map(|axis| self.plane.size[axis].div_ceil(tile_size[axis]));
        let whole = |tile| TilePart { tile, rows: 0..tile_size[1] };
        let all: Vec<TilePart> = (0..n_tiles.iter().product()).map(whole).collect();
        self.fill_parts(tile_size, &all, |part, texels| work(part.tile, texels));
    }

    /// Calls `work` with every part of a tile and its texels, on all threads; parts are begun in their order. `parts`:
    /// disjoint.
    pub fn fill_parts(
        &mut self,
        tile_size: [usize; 2],
        parts: &[TilePart],
        work: impl Fn(&TilePart, &mut TileTexels) + Sync + Send,
    ) {
        let [n_u, n_v] = self.plane.size;
        let [tile_u, tile_v] = tile_size;
        let n_tiles_u = n_u.div_ceil(tile_u);
        let mut tiles: Vec<TileTexels> = Vec::new();
        tiles.resize_with(n_tiles_u * n_v.div_ceil(tile_v), TileTexels::default);
        let pitch = self.pitch();
        for (j, row) in self.texels.chunks_exact_mut(pitch).skip(MARGIN).take(n_v).enumerate() {
            for (texels, tile) in row[MARGIN..MARGIN + n_u].chunks_mut(tile_u).zip(&mut tiles[j / tile_v * n_tiles_u..])
            {
                tile.rows.push(texels);
            }
        }
        for (j, row) in self.w_half.chunks_exact_mut(n_u.max(1)).enumerate() {
            for (places, tile) in row.chunks_mut(tile_u).zip(&mut tiles[j / tile_v * n_tiles_u..]) {
                tile.w_half.push(places);
            }
        }
        let mut parts: Vec<(&TilePart, TileTexels)> =
            parts.iter().map(|part| (part, tiles[part.tile].take(&part.rows))).collect();
        parallel::for_each_chunk(&mut parts, 1, |_, part| work(part[0].0, &mut part[0].1));
        let cells: Vec<(usize, Vec<[usize; 2]>)> =
            parts.into_iter().map(|(part, texels)| (part.tile, texels.drawn)).collect();
        for (k, cells) in cells {
            let first = [k % n_tiles_u * tile_u / CELL[0], k / n_tiles_u * tile_v / CELL[1]];
            for [u, v] in cells {
                self.mark_drawn(first[0] + u, first[1] + v);
            }
        }
    }

    /// Marks a cell and its neighbours as drawn: the filter reaches two texels further.
    fn mark_drawn(&mut self, u: usize, v: usize) {
        let [n_cells_u, n_cells_v] = n_cells(&self.plane);
        for v in v.saturating_sub(1)..(v + 2).min(n_cells_v) {
            self.drawn[v * n_cells_u + u.saturating_sub(1)..v * n_cells_u + (u + 2).min(n_cells_u)].fill(true);
        }
    }

    /// Writes the texels of a chunk, with `w_half`, from `(i, j)` on; texels beyond the base plane are skipped, and so
    /// is a chunk without opacity.
    pub fn put(&mut self, i: usize, j: usize, chunk: &[[f32; 4]; LANES], w_half: Option<&[f32; LANES]>) {
        if chunk.iter().all(|rgba| rgba[3] == 0.0) {
            return;
        }
        let [n_u, _] = self.plane.size;
        let n = LANES.min(n_u - i);
        let first = (j + MARGIN) * self.pitch() + i + MARGIN;
        self.texels[first..][..n].copy_from_slice(&chunk[..n]);
        if let (Some(w_half), false) = (w_half, self.w_half.is_empty()) {
            self.w_half[j * n_u + i..][..n].copy_from_slice(&w_half[..n]);
        }
        self.mark_drawn(i / CELL[0], j / CELL[1]);
    }

    /// w of opacity ½ at a texel position: linear where the four texels around it lie on one surface.
    pub fn w_half(&self, position: DVec2) -> f32 {
        /// Largest difference of w, in slices, within which neighbouring texels lie on one surface.
        const ONE_SURFACE: f32 = 2.0;
        let [n_u, n_v] = self.plane.size;
        let floor = position.floor();
        let (i, j) = (floor.x as i64, floor.y as i64);
        let at = |i: i64, j: i64| {
            let inside = i >= 0 && j >= 0 && (i as usize) < n_u && (j as usize) < n_v;
            if inside { self.w_half[j as usize * n_u + i as usize] } else { f32::NAN }
        };
        let corners = [at(i, j), at(i + 1, j), at(i, j + 1), at(i + 1, j + 1)];
        let lo = corners.iter().copied().fold(f32::INFINITY, f32::min);
        let hi = corners.iter().copied().fold(f32::NEG_INFINITY, f32::max);
        if corners.iter().any(|w| w.is_nan()) || hi - lo > ONE_SURFACE {
            let nearest = position.round();
            return at(nearest.x as i64, nearest.y as i64);
        }
        let (tu, tv) = ((position.x - floor.x) as f32, (position.y - floor.y) as f32);
        let near = corners[0] + tu * (corners[1] - corners[0]);
        let far = corners[2] + tu * (corners[3] - corners[2]);
        near + tv * (far - near)
    }
}

/// The texels of a tile of a base plane, or of some of its rows, to be written to by one thread.
#[derive(Default)]
pub struct TileTexels<'a> {
    /// Row of the tile that is the first here.
    first_row: usize,
    rows: Vec<&'a mut [[f32; 4]]>,
    /// Rows of [`BasePicture::w_half`]; empty where no depth is wanted.
    w_half: Vec<&'a mut [f32]>,
    /// Cells of the tile that were drawn in, with repetitions.
    drawn: Vec<[usize; 2]>,
}

impl TileTexels<'_> {
    /// Takes the texels of some rows out of a whole tile. Rows beyond the base plane have none.
    fn take(&mut self, rows: &Range<usize>) -> Self {
        fn taken<'a, T>(all: &mut [&'a mut [T]], rows: &Range<usize>) -> Vec<&'a mut [T]> {
            let end = rows.end.min(all.len());
            all[rows.start.min(end)..end].iter_mut().map(std::mem::take).collect()
        }
        let (texels, w_half) = (taken(&mut self.rows, rows), taken(&mut self.w_half, rows));
        Self { first_row: rows.start, rows: texels, w_half, drawn: Vec::new() }
    }

    /// Like [`BasePicture::put`], with the column and row of the tile. Rows that are not here are skipped.
    pub fn put(&mut self, i: usize, j: usize, chunk: &[[f32; 4]; LANES], w_half: Option<&[f32; LANES]>) {
        let Some(row) = j.checked_sub(self.first_row) else { return };
        let Some(texels) = self.rows.get_mut(row).and_then(|row| row.get_mut(i..)) else { return };
        if texels.is_empty() || chunk.iter().all(|rgba| rgba[3] == 0.0) {
            return;
        }
        let n = LANES.min(texels.len());
        texels[..n].copy_from_slice(&chunk[..n]);
        if let (Some(w_half), Some(places)) = (w_half, self.w_half.get_mut(row)) {
            places[i..i + n].copy_from_slice(&w_half[..n]);
        }
        let cell = [i / CELL[0], j / CELL[1]];
        if self.drawn.last() != Some(&cell) {
            self.drawn.push(cell);
        }
    }
}

fn n_cells(plane: &BasePlane) -> [usize; 2] {
    [0, 1].map(|axis| plane.size[axis].div_ceil(CELL[axis]))
}
