//! One tile of a base plane, all its sheets front to back, without leaving the cache.
//!
//! Bricks of the volume that nothing is seen of are left out: first whole layers of the tile, then blocks of a strip
//! between two sheets. What is left is reconstructed chunk by chunk as the compositor asks for it.

use std::ops::Range;
use std::sync::Arc;

use wavesplat_compute::simd::{Kernel, LANES, Simd};

use crate::kernel::footprint::bits;
use crate::ray::compositor::Compositor;
use crate::ray::compositor::Slab;
use crate::sheet::buffer::Sheet;
use crate::sheet::field_sheets::{FieldSheets, FieldSlices};
use crate::sheet::spacing::SheetSpacing;
use crate::sheet::tile_layout::{BLOCK_V, BlockMask, N_BLOCKS_V, N_STRIPS, TILE_U, TILE_V, rows_mask};
use crate::sheet::tile_layout::{Block, blocks_with};
use crate::sheet::tile_rays::{RayGeometry, Rays};
use crate::source::geometry::SheetGeometry;
use crate::source::occupancy::OccupancyGrid;
use crate::source::transposed::TransposedSlices;
use crate::view::base_plane::BasePlane;

/// What all tiles of a base plane share.
pub struct TileJob<'a> {
    pub geometry: SheetGeometry<'a>,
    pub rays: RayGeometry<'a>,
    pub spacing: SheetSpacing,
    /// Bricks that change anything; `None`: all.
    pub occupied: Option<Arc<OccupancyGrid>>,
    /// Where the fields lie.
    pub fields: Vec<SheetGeometry<'a>>,
}

/// Blocks of a tile that are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// The tile's number along u and along v.
    pub tile: [usize; 2],
    pub blocks: BlockMask,
}

impl Piece {
    /// All tiles of a base plane.
    pub fn all(plane: &BasePlane) -> Vec<Self> {
        let [n_u, n_v] = plane.size;
        let (n_tiles_u, n_tiles_v) = (n_u.div_ceil(TILE_U), n_v.div_ceil(TILE_V));
        let piece = |k: usize| Self { tile: [k % n_tiles_u, k / n_tiles_u], blocks: BlockMask::MAX };
        (0..n_tiles_u * n_tiles_v).map(piece).collect()
    }
}

/// Numbers for the report.
#[derive(Clone, Copy, Debug, Default)]
pub struct Work {
    /// Texels that were looked at, all sheets.
    pub n_texels: u64,
    /// Slabs of tiles left out because nothing in them is visible.
    pub n_skipped: u64,
}

/// A slab of a tile and the blocks that are looked at in it.
#[derive(Clone, Copy, Debug)]
struct ActiveSlab {
    /// The sheets in front of it and behind it, as the rays meet them.
    sheets: [usize; 2],
    blocks: BlockMask,
}

impl TileJob<'_> {
    /// Runs one tile; `None` where nothing is seen.
    pub fn run<C: Compositor>(&self, piece: &Piece, compositor: impl FnOnce() -> C, work: &mut Work) -> Option<C> {
        let first = [piece.tile[0] * TILE_U, piece.tile[1] * TILE_V];
        let needed = self.needed_blocks(first) & piece.blocks;
        let layers = if needed == 0 { Vec::new() } else { self.active_layers(first) };
        if !layers.contains(&true) {
            work.n_skipped += self.spacing.n_slabs as u64;
            return None;
        }
        let level = self.geometry.level;
        let (rays, span) = Rays::new(&self.rays, level, first);
        let mut alive = needed & blocks_with(|chunk| rays.missed(chunk) != u16::MAX);
        let slabs = self.active_slabs(first, self.spacing.range(span), &layers, alive);
        work.n_skipped += (self.spacing.n_slabs - slabs.len()) as u64;
        if slabs.is_empty() {
            return None;
        }
        let mut compositor = compositor();
        let sign = if self.geometry.plane.family.ascending { 1.0 } else { -1.0 };
        let (mut front, mut back) = (Sheet::default(), Sheet::default());
        let (mut front_fields, mut back_fields) = (FieldSheets::default(), FieldSheets::default());
        let mut in_front = None;
        let mut panel = TransposedSlices::default();
        let mut field_panels = FieldSlices::new(self.fields.len());
        for (k, slab) in slabs.iter().enumerate() {
            let blocks = slab.blocks & alive;
            if blocks == 0 {
                continue;
            }
            let w = slab.sheets.map(|sheet| self.spacing.w(sheet));
            let texels = |serves: &dyn Fn(f64) -> bool| {
                let is_served = |slab: &&ActiveSlab| slab.sheets.iter().all(|s| serves(self.spacing.w(*s)));
                let n_served = slabs[k..].iter().take_while(is_served);
                // The last sheet that it serves is prepared for the slab after it too.
                let ahead = slabs[k..].iter().take(n_served.count() + 1);
                // The sheet in front may still be that of the slab before.
                let before = if k > 0 { slabs[k - 1].blocks } else { 0 };
                let blocks = before | ahead.fold(0, |all, slab| all | slab.blocks) & alive;
                let strips = bits(blocks).map(|b| b / N_BLOCKS_V);
                let rows = bits(blocks).map(|b| b % N_BLOCKS_V);
                let from = [strips.clone().min(), rows.clone().min()].map(Option::unwrap_or_default);
                let to = [strips.max(), rows.max()].map(Option::unwrap_or_default);
                [
                    [first[0] + from[0] * LANES, first[1] + from[1] * BLOCK_V],
                    [first[0] + (to[0] + 1) * LANES - 1, first[1] + (to[1] + 1) * BLOCK_V - 1],
                ]
            };
            panel.cover(&self.geometry, w, texels);
            field_panels.cover(&self.fields, w, texels);
            if in_front != Some(slab.sheets[0]) {
                front.combine(&self.geometry, &panel, w[0], first, blocks);
                front_fields.place(self.fields.len(), w[0], first, blocks);
            }
            // What is behind this slab is in front of the next.
            let next = slabs.get(k + 1).filter(|next| next.sheets[0] == slab.sheets[1]);
            let next = next.map_or(0, |next| next.blocks & alive);
            back.combine(&self.geometry, &panel, w[1], first, blocks | next);
            back_fields.place(self.fields.len(), w[1], first, blocks | next);
            front.prepare(&self.geometry, blocks);
            back.prepare(&self.geometry, if compositor.looks_behind() { blocks } else { blocks & !next });
            for block in bits(blocks) {
                let done = level.dispatch(AddBlock {
                    compositor: &mut compositor,
                    rays: &rays,
                    slab: Slab {
                        s: w.map(|w| (sign * w) as f32),
                        is_last: next >> block & 1 == 0,
                        front: &mut front,
                        back: &mut back,
                        geometry: &self.geometry,
                        panel: &panel,
                        fields: [&mut front_fields, &mut back_fields],
                        field_geometries: &self.fields,
                        field_panels: &field_panels,
                    },
                    block: Block::new(block),
                });
                work.n_texels += (LANES * BLOCK_V) as u64;
                if done {
                    alive &= !Block::new(block).mask();
                }
            }
            std::mem::swap(&mut front, &mut back);
            std::mem::swap(&mut front_fields, &mut back_fields);
            in_front = Some(slab.sheets[1]);
        }
        Some(compositor)
    }

    /// The blocks that the picture needs.
    fn needed_blocks(&self, [i0, j0]: [usize; 2]) -> BlockMask {
        let plane = self.geometry.plane;
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

    /// Where texels `from..=to` lie on two sheets, along u and along v.
    fn hulls(&self, w: [f64; 2]) -> [impl Fn([usize; 2]) -> [f64; 2]; 2] {
        let [a, b] = w.map(|w| self.geometry.plane.sheet(w));
        [0, 1].map(|axis| {
            let ((a, da), (b, db)) = (a[axis], b[axis]);
            move |[from, to]: [usize; 2]| {
                let (from, to) = (from as f64, to as f64);
                let [p, q, r, s] = [a + da * from, a + da * to, b + db * from, b + db * to];
                [p.min(q).min(r.min(s)), p.max(q).max(r.max(s))]
            }
        })
    }

    /// Which layers of bricks have something below the tile; a single one where everything counts.
    fn active_layers(&self, [i0, j0]: [usize; 2]) -> Vec<bool> {
        let n_cells = self.geometry.axes[2].n_samples - 1;
        let Some(occupied) = &self.occupied else { return vec![true] };
        let side = occupied.side();
        let layer_is_active = |layer: usize| {
            let cells = [layer * side, (layer * side + side - 1).min(n_cells - 1)];
            let w = [cells[0] as f64, cells[1] as f64 + 1.0];
            let [along_u, along_v] = self.hulls(w);
            let u = occupied.touched(0, along_u([i0, i0 + TILE_U - 1]));
            let v = occupied.touched(1, along_v([j0, j0 + TILE_V - 1]));
            matches!((u, v), (Some(u), Some(v)) if occupied.any(u, v, [layer; 2]))
        };
        (0..n_cells.div_ceil(side)).map(layer_is_active).collect()
    }

    /// The slabs between the sheets of a range, in the order of the rays, that have something in blocks that are alive.
    fn active_slabs(
        &self,
        [i0, j0]: [usize; 2],
        range: Range<usize>,
        layers: &[bool],
        alive: BlockMask,
    ) -> Vec<ActiveSlab> {
        let ascending = self.geometry.plane.family.ascending;
        let mut slabs = Vec::new();
        for k in 1..range.len() {
            let near = if ascending { range.start + k - 1 } else { range.end - k };
            let sheets = if ascending { [near, near + 1] } else { [near, near - 1] };
            let w = sheets.map(|sheet| self.spacing.w(sheet));
            let [lo, hi] = [w[0].min(w[1]), w[0].max(w[1])];
            // The slab lies in these cells; a sheet on a slice belongs to the cells on both sides.
            let last = self.geometry.axes[2].n_samples - 2;
            let cells = [(lo as usize).min(last), (hi.ceil() as usize).saturating_sub(1).min(last)];
            let mut blocks = alive;
            if let Some(occupied) = &self.occupied {
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
                    if alive & (rows_mask() << block) == 0 {
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
                slabs.push(ActiveSlab { sheets, blocks });
            }
        }
        slabs
    }
}

/// Adds the space between two sheets to the rays of a block; whether all of them are done.
struct AddBlock<'a, 'b, C> {
    compositor: &'a mut C,
    rays: &'a Rays,
    slab: Slab<'b>,
    block: Block,
}

impl<C: Compositor> Kernel for AddBlock<'_, '_, C> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(mut self, s: S) -> bool {
        self.compositor.add(s, self.block, self.rays, &mut self.slab);
        self.block.chunks().all(|chunk| self.rays.none(chunk) || self.compositor.is_done(chunk))
    }
}
