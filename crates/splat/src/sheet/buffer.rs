//! The sheet buffer of a tile: densities, and their gradient, at every texel of a plane parallel to the slices.
//!
//! Separable: slices are combined along w at sample resolution, then rows along u, then columns along v, so a tricubic
//! kernel costs 4 + 4 + 4 taps per texel at most, and less where texels are denser than samples. The gradient comes
//! from difference footprints along each axis; through the sheet it needs no neighbouring sheet. A smoothed gradient
//! also smooths across each derivative, with footprints of its own: slices are combined, and rows upsampled, once more
//! for it.
//!
//! A tile is cut into strips of [`LANES`] texels along u; a strip's row, a *chunk*, is what kernels work on at once.
//! Chunks are reconstructed when they are first needed, their gradient only where something is seen.

use std::ops::Range;
use wavesplat_compute::simd::{FAR_ROOM, LANES, Lanes, Simd, Wide};

use crate::kernel::footprint::AxisFootprints;
use crate::sheet::missing::MissingShares;
use crate::sheet::tile_layout::{BLOCK_V, Block, BlockMask, Chunk, N_BLOCKS, N_BLOCKS_V, N_STRIPS, TILE_V, block_rows};
use crate::sheet::upsample::{DoneRows, MakeDensities, UpsampleGradients, blend};
use crate::source::geometry::SheetGeometry;
use crate::source::transposed::TransposedSlices;
use crate::source::window::Window;

/// Numbers that pad each row of combined slices, so that whole vectors can be read from any sample on.
pub(super) const PADDING: usize = FAR_ROOM;

/// Work space and result of one tile's sheet. Made once per tile, reused for all its sheets.
#[derive(Default)]
pub struct Sheet {
    pub(super) w: f64,
    pub(super) u: AxisFootprints,
    pub(super) v: AxisFootprints,
    /// The part of the tile's samples that is combined.
    part: Option<SampleRectangle>,
    pub(super) stride: usize,
    pub(super) n_v: usize,
    /// Combined slices at sample resolution: density, derivative through the sheet, density for smoothed gradients.
    pub(super) density: Vec<f32>,
    pub(super) through: Vec<f32>,
    pub(super) smooth: Vec<f32>,
    pub(super) has_through: bool,
    /// Combined slices upsampled along u, strip by strip, and the derivative along u.
    pub(super) density_u: Vec<Lanes>,
    pub(super) along_u: Vec<Lanes>,
    pub(super) through_u: Vec<Lanes>,
    pub(super) smooth_u: Vec<Lanes>,
    /// Missing shares, of volumes with missing samples.
    missing: MissingShares,
    /// Sample rows of each strip that have been upsampled: densities, derivatives.
    pub(super) density_rows: [DoneRows; N_STRIPS],
    pub(super) gradient_rows: [DoneRows; N_STRIPS],
    /// Densities of the texels, chunk by chunk, and the least and largest of each column of a block, block by block.
    pub(super) texels: Vec<Lanes>,
    pub(super) extremes: Vec<[Lanes; 2]>,
    /// Blocks whose sample rows have been upsampled.
    pub(super) has_density: BlockMask,
    pub(super) has_gradient: BlockMask,
}

/// Rows and columns of combined slices, counted from the tile's first sample.
#[derive(Clone)]
struct SampleRectangle {
    u: Range<usize>,
    v: Range<usize>,
}

impl Sheet {
    /// Combines the slices that reach the sheet at `w` for those `blocks` of the tile whose first texel is `first`.
    pub fn combine(
        &mut self,
        geometry: &SheetGeometry,
        transposed: &TransposedSlices,
        w: f64,
        first: [usize; 2],
        blocks: BlockMask,
    ) {
        self.combine_with(geometry, transposed, None, w, first, blocks);
    }

    /// Like [`Sheet::combine`], with the weights of a sheet at the same place ([`SheetGeometry::has_weights_of`]).
    pub fn combine_with(
        &mut self,
        geometry: &SheetGeometry,
        transposed: &TransposedSlices,
        weights: Option<&Self>,
        w: f64,
        [i0, j0]: [usize; 2],
        blocks: BlockMask,
    ) {
        self.has_density = 0;
        self.has_gradient = 0;
        let ([(u0, du), (v0, dv)], w) = geometry.sheet(w);
        self.w = w;
        let [axis_u, axis_v, axis_w] = &geometry.axes;
        let strips = (0..N_STRIPS).filter(|s| blocks >> (s * N_BLOCKS_V) & ((1 << N_BLOCKS_V) - 1) != 0);
        let rows = block_rows(blocks);
        match weights {
            Some(weights) => {
                self.u.copy(axis_u, &weights.u);
                self.v.copy(axis_v, &weights.v);
            }
            None => geometry.level.run(
                #[inline(always)]
                || {
                    let groups_v = rows.clone().fold(0, |all, b| all | 1 << (b * BLOCK_V / LANES));
                    let groups_u = strips.clone().fold(0, |all, s| all | 1 << s);
                    self.u.build(axis_u, [u0 + du * i0 as f64, du], N_STRIPS, groups_u);
                    self.v.build(axis_v, [v0 + dv * j0 as f64, dv], TILE_V / LANES, groups_v);
                },
            ),
        }
        let n_u = (self.u.window[1] - self.u.window[0] + 1) as usize;
        self.n_v = (self.v.window[1] - self.v.window[0] + 1) as usize;
        self.stride = n_u.next_multiple_of(LANES) + PADDING.next_multiple_of(LANES);
        for rows in [&mut self.density_u, &mut self.along_u, &mut self.through_u, &mut self.smooth_u] {
            rows.resize(N_STRIPS * self.n_v, Lanes::default());
        }
        self.density_rows.iter_mut().chain(&mut self.gradient_rows).for_each(DoneRows::clear);
        self.texels.resize(Chunk::N, Lanes::default());
        self.extremes.resize(N_BLOCKS, Default::default());
        self.density.resize(self.stride * self.n_v, 0.0);
        self.has_through = false;
        // Positions rise or fall with the texel, so that the ends of strips and blocks reach furthest.
        let columns = strips.clone().flat_map(|s| [s * LANES, s * LANES + LANES - 1]);
        let rows_of_texels = rows.clone().flat_map(|b| [b * BLOCK_V, b * BLOCK_V + BLOCK_V - 1]);
        let part = SampleRectangle { u: reached(&self.u, columns), v: reached(&self.v, rows_of_texels) };
        let taps = axis_w.slice_taps(w);
        let axes = geometry.plane.family.axes;
        let (first, window) = self.place(&part);
        let density = &mut self.density[first..];
        if !transposed.combine(geometry, &taps, window, density, self.stride) {
            let soon = geometry.slice_behind(&taps);
            geometry.slices.combine(geometry.level, axes, &taps, soon, window, density, self.stride);
        }
        if geometry.slices.has_mask() {
            let places = [[u0 + du * i0 as f64, du], [v0 + dv * j0 as f64, dv]];
            self.missing.combine(geometry, places, w, strips, rows);
        }
        self.part = Some(part);
    }

    /// Offset of a part in the combined slices, and its window of samples.
    fn place(&self, part: &SampleRectangle) -> (usize, Window) {
        let window = |axis: &AxisFootprints, range: &Range<usize>| {
            [axis.window[0] + range.start as i64, axis.window[0] + range.end as i64 - 1]
        };
        let first = part.v.start * self.stride + part.u.start;
        (first, Window { u: window(&self.u, &part.u), v: window(&self.v, &part.v) })
    }

    /// Upsamples the slices that [`Sheet::combine`] combined to the densities of all texels of blocks, where they are not
    /// there yet.
    pub fn prepare(&mut self, geometry: &SheetGeometry, blocks: BlockMask) {
        let blocks = blocks & !self.has_density;
        if blocks == 0 {
            return;
        }
        self.has_density |= blocks;
        geometry.level.dispatch(MakeDensities { sheet: self, blocks });
        if geometry.slices.has_mask() {
            self.missing.prepare(geometry, blocks);
        }
    }

    /// Computes the gradient at all texels of a block, where it is not there yet. Needs the densities of
    /// [`Sheet::prepare`].
    #[inline(always)]
    pub fn prepare_gradient(&mut self, geometry: &SheetGeometry, transposed: &TransposedSlices, block: Block) {
        if self.has_gradient & block.mask() == 0 {
            self.make_gradient(geometry, transposed, block);
        }
    }

    /// Makes the gradient of a block. Not inlined, so that compositing stays small and keeps more of its data in
    /// registers.
    #[inline(never)]
    fn make_gradient(&mut self, geometry: &SheetGeometry, transposed: &TransposedSlices, block: Block) {
        self.has_gradient |= block.mask();
        if !self.has_through {
            self.combine_through(geometry, transposed);
            geometry.level.run(
                #[inline(always)]
                || {
                    self.u.make_difference();
                    self.v.make_difference();
                },
            );
        }
        geometry.level.dispatch(UpsampleGradients { sheet: self, block });
    }

    /// Whether its arrays take less than about a megabyte, so that threads may keep it.
    pub fn is_small(&self) -> bool {
        self.density.len() <= 1 << 16
    }

    /// Whether gradients have footprints of their own across the derivatives.
    pub(super) fn is_smoothed(&self) -> bool {
        self.v.smooth.n_taps > 0
    }

    /// Densities of one chunk or two. After [`Sheet::prepare`].
    #[inline(always)]
    pub fn density<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> W::F {
        w.load_from(&self.texels, chunks.map(Chunk::index))
    }

    /// Missing shares of one chunk or two, of volumes with missing samples. After [`Sheet::prepare`].
    #[inline(always)]
    pub fn missing<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> W::F {
        self.missing.share(w, chunks)
    }

    /// Derivatives of one chunk or two along u, v, w per index step, where the geometry has a gradient. After
    /// [`Sheet::prepare_gradient`].
    #[inline(always)]
    pub fn gradient<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> [W::F; 3] {
        let first = chunks[0].strip * self.n_v;
        let (rows, of_value) =
            if self.is_smoothed() { (&self.smooth_u, &self.v.smooth) } else { (&self.density_u, &self.v.value) };
        let [along_u, through] = blend(w, [&self.along_u[first..], &self.through_u[first..]], of_value, chunks);
        let [along_v] = blend(w, [&rows[first..]], &self.v.difference, chunks);
        [along_u, along_v, through]
    }

    /// Least and largest density of each column of a block. After [`Sheet::prepare`].
    #[inline(always)]
    pub fn extremes<S: Simd>(&self, s: S, block: Block) -> [S::F; 2] {
        let [least, most] = &self.extremes[block.place()];
        [s.load(&least.0), s.load(&most.0)]
    }

    /// Combines slices for the derivative through the sheet, and for smoothed gradients along it.
    fn combine_through(&mut self, geometry: &SheetGeometry, transposed: &TransposedSlices) {
        let Some(part) = self.part.clone() else { return };
        self.has_through = true;
        let (first, window) = self.place(&part);
        let axis = &geometry.axes[2];
        let smooth = axis.slice_smooth_taps(self.w).map(|taps| (taps, &mut self.smooth));
        for (taps, combined) in
            [Some((axis.slice_difference_taps(self.w), &mut self.through)), smooth].into_iter().flatten()
        {
            combined.resize(self.stride * self.n_v, 0.0);
            let combined = &mut combined[first..];
            if !transposed.combine(geometry, &taps, window, combined, self.stride) {
                let soon = geometry.slice_behind(&taps);
                let axes = geometry.plane.family.axes;
                geometry.slices.combine(geometry.level, axes, &taps, soon, window, combined, self.stride);
            }
        }
    }
}

/// Samples that the value and difference footprints of any of the positions reach.
pub(super) fn reached(axis: &AxisFootprints, positions: impl Iterator<Item = usize>) -> Range<usize> {
    let (mut start, mut end) = (usize::MAX, 0);
    for i in positions {
        let reached = axis.reached(i);
        (start, end) = (start.min(reached.start), end.max(reached.end));
    }
    start.min(end)..end
}
