//! Division of a base plane's tile: strips of vector width, blocks of rows, and chunks, which kernels work on.

use std::ops::Range;

use wavesplat_compute::simd::LANES;

/// Number of strips of a tile.
pub const N_STRIPS: usize = 4;

/// Texels of a tile along u.
pub const TILE_U: usize = N_STRIPS * LANES;

/// Texels of a tile along v.
pub const TILE_V: usize = 32;

/// Rows of a block: a strip's rows are examined, and left out, in blocks.
pub const BLOCK_V: usize = 8;

/// Mask of the blocks of a tile, strip by strip, as bits.
pub type BlockMask = u16;

/// Blocks of a tile along v.
pub const N_BLOCKS_V: usize = TILE_V / BLOCK_V;

/// Blocks of a tile.
pub const N_BLOCKS: usize = N_STRIPS * N_BLOCKS_V;

/// A row of a strip: [`LANES`] texels.
#[derive(Clone, Copy, Debug)]
pub struct Chunk {
    /// Strip of the tile.
    pub strip: usize,
    /// Row of the tile.
    pub row: usize,
}

impl Chunk {
    /// Number of chunks of a tile.
    pub const N: usize = N_STRIPS * TILE_V;

    /// All chunks of a tile, in the order of their places.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..Self::N).map(|index| Self { strip: index / TILE_V, row: index % TILE_V })
    }

    /// The block that the chunk belongs to.
    #[inline(always)]
    pub fn block(self) -> Block {
        Block { strip: self.strip, row: self.row / BLOCK_V * BLOCK_V }
    }

    /// Place among the chunks of a tile.
    #[inline(always)]
    pub fn index(self) -> usize {
        self.strip * TILE_V + self.row
    }
}

/// [`BLOCK_V`] rows of a strip, which are examined together.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Strip of the tile.
    pub strip: usize,
    /// First row of the block, counted from the tile's first.
    pub row: usize,
}

impl Block {
    /// A block by its place among the blocks of a tile.
    pub fn new(place: usize) -> Self {
        Self { strip: place / N_BLOCKS_V, row: place % N_BLOCKS_V * BLOCK_V }
    }

    /// Place among the blocks of a tile.
    #[inline(always)]
    pub fn place(self) -> usize {
        self.strip * N_BLOCKS_V + self.row / BLOCK_V
    }

    /// The mask of this block alone.
    #[inline(always)]
    pub fn mask(self) -> BlockMask {
        1 << self.place()
    }

    /// Chunks of the block.
    #[inline(always)]
    pub fn chunks(self) -> impl Iterator<Item = Chunk> {
        (self.row..self.row + BLOCK_V).map(move |row| Chunk { strip: self.strip, row })
    }

    /// Chunks of the block, two by two.
    #[inline(always)]
    pub fn pairs(self) -> impl Iterator<Item = [Chunk; 2]> {
        let chunk = move |row| Chunk { strip: self.strip, row };
        (self.row..self.row + BLOCK_V).step_by(2).map(move |row| [chunk(row), chunk(row + 1)])
    }

    #[inline(always)]
    pub fn rows(self) -> Range<usize> {
        self.row..self.row + BLOCK_V
    }
}

/// Rows of a tile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TilePart {
    /// Number of the tile, row by row.
    pub tile: usize,
    /// Rows of texels, counted from the tile's first; whole rows of blocks.
    pub rows: Range<usize>,
}

impl TilePart {
    /// The blocks in these rows.
    pub fn blocks(&self) -> BlockMask {
        let of_strip = (self.rows.start / BLOCK_V..self.rows.end.div_ceil(BLOCK_V)).fold(0, |all, b| all | 1 << b);
        (0..N_STRIPS).fold(0, |all, strip| all | of_strip << (strip * N_BLOCKS_V))
    }
}

/// Rows of blocks that contain any block of a mask.
pub fn block_rows(blocks: BlockMask) -> impl Iterator<Item = usize> + Clone {
    (0..N_BLOCKS_V).filter(move |b| blocks & (first_row_mask() << b) != 0)
}

/// Mask of the first block of every strip.
pub const fn first_row_mask() -> BlockMask {
    let mut mask = 0;
    let mut strip = 0;
    while strip < N_STRIPS {
        mask |= 1 << (strip * N_BLOCKS_V);
        strip += 1;
    }
    mask
}

/// Mask of the blocks that contain a live chunk.
pub fn blocks_with(is_alive: impl Fn(Chunk) -> bool) -> BlockMask {
    let mut blocks = 0;
    for strip in 0..N_STRIPS {
        for row in 0..TILE_V {
            blocks |= BlockMask::from(is_alive(Chunk { strip, row })) << (strip * N_BLOCKS_V + row / BLOCK_V);
        }
    }
    blocks
}
