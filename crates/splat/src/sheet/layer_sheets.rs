//! The sheets of a layer as a tile goes from slab to slab: the front one, the back one, and their samples.

use std::cell::RefCell;

use crate::sheet::buffer::Sheet;
use crate::sheet::tile_layout::{Block, BlockMask, Chunk};
use crate::sheet::tile_rays::Rays;
use crate::source::geometry::SheetGeometry;
use crate::source::transposed::TransposedSlices;

/// Largest number of sheets that a thread keeps for its next tiles. New ones would be zeroed for every tile, mostly
/// 100 kB.
const MAX_SPARE: usize = 16;

thread_local! {
    static SPARE: RefCell<Vec<Sheet>> = const { RefCell::new(Vec::new()) };
}

/// A sheet, of an earlier tile where there is one: nothing is read of a sheet that was not made for its place.
fn spare_sheet() -> Sheet {
    SPARE.with_borrow_mut(Vec::pop).unwrap_or_default()
}

/// The sheets of a layer on both sides of a slab.
pub struct LayerSheets<'a> {
    /// Position of the sheets among the layer's samples.
    pub geometry: &'a SheetGeometry<'a>,
    /// Samples that both sheets are made of.
    pub transposed: TransposedSlices,
    /// The sheet in front.
    pub front: Sheet,
    /// The sheet behind.
    pub back: Sheet,
    /// Rays clipped to the layer's own box; `None` where they are the tile's, as for a single volume.
    pub rays: Option<Rays>,
    /// Blocks of the slab in which something of the layer may be visible.
    pub blocks: BlockMask,
    /// Blocks, among `blocks`, whose back sheet is not the front of another slab.
    pub last: BlockMask,
}

impl<'a> LayerSheets<'a> {
    /// Sheets of a layer, none made yet.
    pub fn new(geometry: &'a SheetGeometry<'a>, rays: Option<Rays>) -> Self {
        Self {
            geometry,
            transposed: TransposedSlices::default(),
            front: spare_sheet(),
            back: spare_sheet(),
            rays,
            blocks: 0,
            last: 0,
        }
    }

    /// Makes the gradient of a block ready on the front (0) or back (1) sheet.
    #[inline(always)]
    pub fn prepare_gradient(&mut self, which: usize, block: Block) {
        let sheet = if which == 0 { &mut self.front } else { &mut self.back };
        sheet.prepare_gradient(self.geometry, &self.transposed, block);
    }

    /// The front (0) or back (1) sheet.
    #[inline(always)]
    pub fn sheet(&self, which: usize) -> &Sheet {
        if which == 0 { &self.front } else { &self.back }
    }

    /// Whether something of the layer may be visible in a block of the slab.
    #[inline(always)]
    pub fn has(&self, block: Block) -> bool {
        self.blocks & block.mask() != 0
    }

    /// Whether something of the layer may be visible in a chunk of the slab. `rays`: of the tile.
    #[inline(always)]
    pub fn draws(&self, rays: &Rays, chunk: Chunk) -> bool {
        self.has(chunk.block()) && !self.rays.as_ref().unwrap_or(rays).draws_nothing(chunk)
    }

    /// Whether no slab of the layer follows in a block.
    #[inline(always)]
    pub fn is_last(&self, block: Block) -> bool {
        self.last & block.mask() != 0
    }
}

impl Drop for LayerSheets<'_> {
    fn drop(&mut self) {
        let sheets = [&mut self.front, &mut self.back].map(std::mem::take);
        // A thread that ends has no store any more.
        let _ = SPARE.try_with(|spare| {
            let mut spare = spare.borrow_mut();
            let room = MAX_SPARE.saturating_sub(spare.len());
            spare.extend(sheets.into_iter().filter(Sheet::is_small).take(room));
        });
    }
}
