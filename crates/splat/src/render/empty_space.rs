//! Empty-space skipping of a tile: layers of bricks below it, then slabs and blocks in which something is visible.

use std::ops::Range;

use wavesplat_compute::simd::LANES;

use crate::render::tile::{LayerJob, TileJob};
use crate::sheet::spacing::SheetSpacing;
use crate::sheet::tile_layout::{BLOCK_V, BlockMask, N_BLOCKS_V, N_STRIPS, TILE_U, TILE_V, first_row_mask};

/// A slab of a tile, and the blocks in which it is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct ActiveSlab {
    /// Number of the slab in the order of the rays.
    pub place: usize,
    /// Numbers of the sheets in front of the slab and behind it, as the rays meet them.
    pub sheets: [usize; 2],
    /// Blocks in which something may be visible.
    pub blocks: BlockMask,
}

impl TileJob<'_> {
    /// Estimated cost of a tile: its needed blocks, times the layers of bricks below it in which something is visible.
    pub(super) fn cost(&self, [tile_u, tile_v]: [usize; 2]) -> usize {
        let first = [tile_u * TILE_U, tile_v * TILE_V];
        let n_blocks = self.needed_blocks(first).count_ones() as usize;
        if n_blocks == 0 {
            return 0;
        }
        let n_layers = |layer: &LayerJob| layer.active_layers(first).iter().filter(|is_active| **is_active).count();
        n_blocks * self.layers.iter().map(n_layers).sum::<usize>()
    }

    /// Blocks of a tile, given by its first texel, that the picture needs.
    pub(super) fn needed_blocks(&self, [i0, j0]: [usize; 2]) -> BlockMask {
        let plane = &self.family.plane;
        let mut blocks = 0;
        if !plane.is_needed([i0, j0], [i0 + TILE_U - 1, j0 + TILE_V - 1]) {
            return blocks;
        }
        for strip in 0..N_STRIPS {
            for block in 0..N_BLOCKS_V {
                let (i, j) = (i0 + strip * LANES, j0 + block * BLOCK_V);
                let is_needed = plane.is_needed([i, j], [i + LANES - 1, j + BLOCK_V - 1]);
                blocks |= BlockMask::from(is_needed) << (strip * N_BLOCKS_V + block);
            }
        }
        blocks
    }
}

impl LayerJob<'_> {
    /// Functions from texels `from..=to` to the range of sample positions that they span on two sheets, along u and
    /// along v. Texels that are drawn beyond the walls show the samples at the wall.
    fn hulls(&self, w: [f64; 2]) -> [impl Fn([usize; 2]) -> [f64; 2]; 2] {
        let [a, b] = w.map(|w| self.geometry.sheet(w).0);
        [0, 1].map(|axis| {
            let ((a, da), (b, db)) = (a[axis], b[axis]);
            let last = self.geometry.axes[axis].last();
            let beyond = self.geometry.plane.beyond * da.abs().max(db.abs());
            move |[from, to]: [usize; 2]| {
                let (from, to) = (from as f64, to as f64);
                // Sample positions are linear in the texel and in w, so the four corners bound all positions in
                // between.
                let [p, q, r, s] = [a + da * from, a + da * to, b + db * from, b + db * to];
                let [lo, hi] = [p.min(q).min(r.min(s)), p.max(q).max(r.max(s))];
                [
                    if lo > last && lo - last <= beyond { last } else { lo },
                    if hi < 0.0 && hi >= -beyond { 0.0 } else { hi },
                ]
            }
        })
    }

    /// Per layer of bricks along w: is any of its bricks below the tile occupied? A single `true` if every brick
    /// counts.
    pub(super) fn active_layers(&self, [i0, j0]: [usize; 2]) -> Vec<bool> {
        let n_cells = self.geometry.axes[2].n_samples - 1;
        let Some(occupied) = &self.family.occupancy else { return vec![true] };
        let side = occupied.side();
        let layer_is_active = |layer: usize| {
            let cells = [layer * side, (layer * side + side - 1).min(n_cells - 1)];
            let w = [cells[0] as f64, cells[1] as f64 + 1.0].map(|own| self.geometry.w_of_own(own));
            let [along_u, along_v] = self.hulls(w);
            let u = occupied.touched(0, along_u([i0, i0 + TILE_U - 1]));
            let v = occupied.touched(1, along_v([j0, j0 + TILE_V - 1]));
            matches!((u, v), (Some(u), Some(v)) if occupied.any(u, v, [layer; 2]))
        };
        (0..n_cells.div_ceil(side)).map(layer_is_active).collect()
    }

    /// Slabs among `wanted` in which something may be visible in blocks of `alive`, in the order of the rays. `wanted`
    /// counts slabs in that order; `range`: sheets between which the slabs lie; `layers`: from `active_layers`.
    pub(super) fn active_slabs(
        &self,
        spacing: &SheetSpacing,
        [i0, j0]: [usize; 2],
        range: Range<usize>,
        wanted: &Range<usize>,
        layers: &[bool],
        alive: BlockMask,
    ) -> Vec<ActiveSlab> {
        let ascending = self.geometry.plane.family.ascending;
        let mut slabs = Vec::new();
        let last = self.geometry.axes[2].n_samples - 2;
        for k in 1..range.len() {
            let near = if ascending { range.start + k - 1 } else { range.end - k };
            let place = if ascending { near } else { spacing.n_slabs - near };
            if !wanted.contains(&place) {
                continue;
            }
            let sheets = if ascending { [near, near + 1] } else { [near, near - 1] };
            let w = sheets.map(|sheet| spacing.w(sheet));
            let own = w.map(|w| self.geometry.own_w(w));
            let [lo, hi] = [own[0].min(own[1]), own[0].max(own[1])];
            // The slab lies in these cells; a sheet on a slice belongs to the cells on both sides.
            let cells = [(lo as usize).min(last), (hi.ceil() as usize).saturating_sub(1).min(last)];
            let mut blocks = alive;
            if let Some(occupied) = &self.family.occupancy {
                let reached = cells.map(|cell| occupied.layer(cell));
                if !layers[reached[0]..=reached[1]].contains(&true) {
                    continue;
                }
                let [along_u, along_v] = self.hulls(w);
                let u: [_; N_STRIPS] = std::array::from_fn(|strip| {
                    let i = i0 + strip * LANES;
                    occupied.touched(0, along_u([i, i + LANES - 1]))
                });
                let runs = occupied.runs(u);
                blocks = 0;
                for block in 0..N_BLOCKS_V {
                    if alive & (first_row_mask() << block) == 0 {
                        continue;
                    }
                    let j = j0 + block * BLOCK_V;
                    let Some(v) = occupied.touched(1, along_v([j, j + BLOCK_V - 1])) else { continue };
                    for (strip, is_active) in occupied.any_of(&runs, v, reached).into_iter().enumerate() {
                        blocks |= BlockMask::from(is_active) << (strip * N_BLOCKS_V + block);
                    }
                }
                blocks &= alive;
            }
            if blocks != 0 {
                slabs.push(ActiveSlab { place, sheets, blocks });
            }
        }
        slabs
    }
}
