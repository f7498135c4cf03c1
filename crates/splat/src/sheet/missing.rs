//! Missing shares at the texels of a sheet ([`crate::source::nonfinite`]): the mask of missing samples, reconstructed
//! with the linear kernel, whatever the kernel of the densities.

use std::ops::Range;
use wavesplat_compute::simd::{LANES, Lanes, Simd, VectorKernel, Wide};
use wavesplat_core::Kernel;

use crate::kernel::footprint::{Axis, AxisFootprints};
use crate::kernel::footprint_table::bits;
use crate::sheet::buffer::{PADDING, reached};
use crate::sheet::tile_layout::{BLOCK_V, Block, BlockMask, Chunk, N_STRIPS, TILE_V};
use crate::sheet::upsample::{DoneRows, SliceRows, blend_block, block_of, reached_by, upsample};
use crate::source::geometry::SheetGeometry;
use crate::source::window::Window;

/// Missing shares of a tile's sheet. Only made for volumes with missing samples.
#[derive(Default)]
pub(super) struct MissingShares {
    u: AxisFootprints,
    v: AxisFootprints,
    stride: usize,
    n_v: usize,
    /// Combined slices at sample resolution.
    slices: Vec<f32>,
    /// Combined slices upsampled along u, strip by strip.
    rows: Vec<Lanes>,
    done: [DoneRows; N_STRIPS],
    /// Shares at the texels, chunk by chunk; blended ahead, since the code of compositors is large enough without that.
    texels: Vec<Lanes>,
}

impl MissingShares {
    /// Combines the slices around the sheet at `w`, a position among the samples, for texels at `places`: position of
    /// the tile's first texel and change per texel, along u and v.
    pub(super) fn combine(
        &mut self,
        geometry: &SheetGeometry,
        places: [[f64; 2]; 2],
        w: f64,
        strips: impl Iterator<Item = usize> + Clone,
        rows: impl Iterator<Item = usize> + Clone,
    ) {
        let [axis_u, axis_v, axis_w] =
            [0, 1, 2].map(|a| Axis { kernel: Kernel::Linear, gradient: None, ..geometry.axes[a] });
        let groups_u = strips.clone().fold(0, |all, s| all | 1 << s);
        let groups_v = rows.clone().fold(0, |all, b| all | 1 << (b * BLOCK_V / LANES));
        self.u.build(&axis_u, places[0], N_STRIPS, groups_u);
        self.v.build(&axis_v, places[1], TILE_V / LANES, groups_v);
        let n_u = (self.u.window[1] - self.u.window[0] + 1) as usize;
        self.n_v = (self.v.window[1] - self.v.window[0] + 1) as usize;
        self.stride = n_u.next_multiple_of(LANES) + PADDING.next_multiple_of(LANES);
        self.rows.resize(N_STRIPS * self.n_v, Lanes::default());
        self.done.iter_mut().for_each(DoneRows::clear);
        self.slices.resize(self.stride * self.n_v, 0.0);
        self.texels.resize(Chunk::N, Lanes::default());
        let part_u = reached(&self.u, strips.flat_map(|s| [s * LANES, s * LANES + LANES - 1]));
        let part_v = reached(&self.v, rows.flat_map(|b| [b * BLOCK_V, b * BLOCK_V + BLOCK_V - 1]));
        let window = |axis: &AxisFootprints, range: &Range<usize>| {
            [axis.window[0] + range.start as i64, axis.window[0] + range.end as i64 - 1]
        };
        let first = part_v.start * self.stride + part_u.start;
        let window = Window { u: window(&self.u, &part_u), v: window(&self.v, &part_v) };
        let axes = geometry.plane.family.axes;
        let out = &mut self.slices[first..];
        geometry.slices.combine_mask(geometry.level, axes, &axis_w.slice_taps(w), window, out, self.stride);
    }

    /// Makes the shares of blocks ready.
    pub(super) fn prepare(&mut self, geometry: &SheetGeometry, blocks: BlockMask) {
        geometry.level.dispatch(UpsampleShares { shares: self, blocks });
    }

    /// Shares of one chunk or two. After [`MissingShares::prepare`].
    #[inline(always)]
    pub(super) fn share<W: Wide>(&self, w: W, chunks: [Chunk; 2]) -> W::F {
        w.load_from(&self.texels, chunks.map(Chunk::index))
    }
}

/// Kernel that upsamples the rows of blocks along u, where that is not done yet, and blends them at the texels.
struct UpsampleShares<'a> {
    shares: &'a mut MissingShares,
    blocks: BlockMask,
}

impl VectorKernel for UpsampleShares<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, s: S) {
        let Self { shares, blocks } = self;
        for block in bits(blocks).map(Block::new) {
            let group = shares.u.value.group(block.strip);
            let out = &mut shares.rows[block.strip * shares.n_v..][..shares.n_v];
            let slices = SliceRows { samples: &shares.slices, stride: shares.stride };
            for rows in shares.done[block.strip].missing(reached_by(&shares.v.value, block.rows())) {
                upsample(s, slices, rows, &group, out);
            }
            blend_block(s, out, &shares.v.value, block.row, block_of(&mut shares.texels, block));
        }
    }
}
