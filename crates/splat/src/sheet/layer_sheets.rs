//! The sheets of a layer as a tile goes from slab to slab: the one in front, the one behind, and what they are made of.

use crate::sheet::buffer::Sheet;
use crate::sheet::tile_layout::{Block, BlockMask};
use crate::sheet::tile_rays::Rays;
use crate::source::geometry::SheetGeometry;
use crate::source::transposed::TransposedSlices;

/// The sheets of a layer on both sides of a slab.
pub struct LayerSheets<'a> {
    /// Where they lie among the layer's samples.
    pub geometry: &'a SheetGeometry<'a>,
    /// Samples that both sheets are made of.
    pub transposed: TransposedSlices,
    /// The sheet in front.
    pub front: Sheet,
    /// The sheet behind.
    pub back: Sheet,
    /// What of the rays lies in the layer; of a volume alone they are those of the tile.
    pub rays: Option<Rays>,
    /// Blocks of the slab in which something of the layer may be visible.
    pub blocks: BlockMask,
    /// Blocks of these in which no slab follows whose front the sheet behind would be.
    pub last: BlockMask,
}

impl<'a> LayerSheets<'a> {
    /// Nothing made yet.
    pub fn new(geometry: &'a SheetGeometry<'a>, rays: Option<Rays>) -> Self {
        Self {
            geometry,
            transposed: TransposedSlices::default(),
            front: Sheet::default(),
            back: Sheet::default(),
            rays,
            blocks: 0,
            last: 0,
        }
    }

    /// Makes the gradient of a block ready on the sheet in front (0) or that behind (1).
    #[inline(always)]
    pub fn prepare_gradient(&mut self, which: usize, block: Block) {
        let sheet = if which == 0 { &mut self.front } else { &mut self.back };
        sheet.prepare_gradient(self.geometry, &self.transposed, block);
    }

    /// The sheet in front (0) or that behind (1).
    #[inline(always)]
    pub fn sheet(&self, which: usize) -> &Sheet {
        if which == 0 { &self.front } else { &self.back }
    }

    /// Whether something of the layer may be visible in a block of the slab.
    #[inline(always)]
    pub fn has(&self, block: Block) -> bool {
        self.blocks & block.mask() != 0
    }

    /// Whether no slab of the layer follows in a block.
    #[inline(always)]
    pub fn is_last(&self, block: Block) -> bool {
        self.last & block.mask() != 0
    }
}
