//! Bands: blocks of a base plane that are drawn together, with the intervals of their rays and the slabs they occupy.

use std::ops::Range;

use wavesplat_compute::parallel;
use wavesplat_splat::render::plan::FamilyPlan;
use wavesplat_splat::render::plan_arrays::{BasePlaneArrays, TileArrays};
use wavesplat_splat::render::tile::n_tiles;
use wavesplat_splat::sheet::tile_layout::{N_BLOCKS_V, N_STRIPS};

use crate::layout::N_BLOCK;

/// Largest number of blocks that are drawn at once: 1 M texels, so that no binding exceeds what every device has, and a
/// weak device takes a few hundredths of a second for a slab of them.
const MAX_BLOCKS: usize = 1 << 13;

/// Tiles that are computed at once, on all threads: a single row of tiles would keep few threads busy, and all tiles of
/// a large base plane would take much memory.
const N_TILES: usize = 512;

/// Blocks of a base plane that are drawn together.
#[derive(Default)]
pub(crate) struct Band {
    /// Strip, and row of blocks, of each block.
    pub blocks: Vec<[usize; 2]>,
    /// Drawn interval of each ray in s, block by block: of all layers together, then, where there are several, of each.
    pub intervals: Vec<Vec<[f32; 2]>>,
    /// Occupied slabs as bit masks, layer by layer and block by block.
    pub occupied: Vec<Vec<u32>>,
    /// First slab that any block occupies, and one past the last.
    pub slabs: [usize; 2],
}

/// Words of the slab mask of a block, with one bit more for the sheet behind the last slab.
pub(crate) fn n_mask_words(family: &FamilyPlan) -> usize {
    (family.spacing.n_slabs + 1).div_ceil(32)
}

/// Cuts a base plane into bands of the blocks that may show something. `skips`: leave out empty slabs.
pub(crate) fn bands(family: &FamilyPlan, arrays: &BasePlaneArrays, n_layers: usize, skips: bool) -> Vec<Band> {
    let [n_tiles_u, n_tiles_v] = arrays.n_tiles();
    // Several layers have an interval each, and one for all.
    let most = MAX_BLOCKS / if n_layers > 1 { n_layers + 1 } else { 1 };
    let mut bands = vec![Band::default()];
    let n_tiles = n_tiles_u * n_tiles_v;
    for first in (0..n_tiles).step_by(N_TILES) {
        let tiles = parallel::map(N_TILES.min(n_tiles - first), |k| {
            let tile = [(first + k) % n_tiles_u, (first + k) / n_tiles_u];
            Band::of_tile(family, &arrays.tile(tile), tile, n_layers)
        });
        for tile in tiles.into_iter().filter(|tile| !tile.blocks.is_empty()) {
            match bands.last_mut() {
                Some(band) if band.blocks.len() + tile.blocks.len() <= most => band.append(tile),
                _ => bands.push(tile),
            }
        }
    }
    bands.retain(|band| !band.blocks.is_empty());
    if !skips {
        for band in &mut bands {
            band.occupy_all(family);
        }
    }
    bands
}

impl Band {
    /// Whether a layer occupies a slab in a block.
    pub fn is_occupied(&self, layer: usize, block: usize, slab: usize) -> bool {
        let words = &self.occupied[layer];
        let n_words = words.len() / self.blocks.len();
        words[block * n_words + slab / 32] >> (slab % 32) & 1 == 1
    }

    /// For each tile of the base plane, row by row, the places of its blocks in the band.
    pub fn by_tile(&self, family: &FamilyPlan) -> Vec<Range<usize>> {
        let n_tiles = n_tiles(&family.plane);
        let tile = |[strip, row]: [usize; 2]| row / N_BLOCKS_V * n_tiles[0] + strip / N_STRIPS;
        let mut places = vec![0..0; n_tiles[0] * n_tiles[1]];
        let mut first = 0;
        // The blocks of a tile lie side by side.
        for own in self.blocks.chunk_by(|a, b| tile(*a) == tile(*b)) {
            places[tile(own[0])] = first..first + own.len();
            first += own.len();
        }
        places
    }

    /// Marks all slabs of all blocks as occupied.
    fn occupy_all(&mut self, family: &FamilyPlan) {
        let n_words = n_mask_words(family);
        self.slabs = [0, family.spacing.n_slabs];
        for (k, word) in self.occupied.iter_mut().flat_map(|words| words.iter_mut().enumerate()) {
            let first = k % n_words * 32;
            let n = family.spacing.n_slabs.saturating_sub(first).min(32);
            *word = if n == 32 { u32::MAX } else { (1 << n) - 1 };
        }
    }

    /// The band in two halves, where it has more than one block.
    pub fn halves(&self) -> Option<(Self, Self)> {
        let n = self.blocks.len() / 2;
        (n > 0).then(|| (self.part(0..n), self.part(n..self.blocks.len())))
    }

    fn part(&self, blocks: Range<usize>) -> Self {
        let of = |n: usize| blocks.start * n..blocks.end * n;
        let intervals = self.intervals.iter().map(|own| own[of(N_BLOCK)].to_vec());
        let n_words = |words: &[u32]| words.len() / self.blocks.len();
        let occupied = self.occupied.iter().map(|words| words[of(n_words(words))].to_vec());
        Self {
            intervals: intervals.collect(),
            occupied: occupied.collect(),
            blocks: self.blocks[blocks.clone()].to_vec(),
            slabs: self.slabs,
        }
    }

    /// The drawn blocks of a tile.
    fn of_tile(family: &FamilyPlan, tile: &TileArrays, [column, row]: [usize; 2], n_layers: usize) -> Self {
        let mut band = Self::default();
        if tile.blocks == 0 {
            return band;
        }
        let n_words = n_mask_words(family);
        let drawn = || (0..N_STRIPS * N_BLOCKS_V).filter(|block| tile.blocks >> block & 1 == 1);
        let n_blocks = tile.blocks.count_ones() as usize;
        band.slabs = [usize::MAX, 0];
        band.blocks.extend(drawn().map(|block| {
            let [strip, first_row] = [block / N_BLOCKS_V, block % N_BLOCKS_V];
            [column * N_STRIPS + strip, row * N_BLOCKS_V + first_row]
        }));
        band.intervals.extend(tile.intervals.iter().map(|all| {
            let mut own = Vec::with_capacity(n_blocks * N_BLOCK);
            drawn().for_each(|block| own.extend_from_slice(&all[block * N_BLOCK..][..N_BLOCK]));
            own
        }));
        band.occupied.resize_with(n_layers, || vec![0; n_blocks * n_words]);
        for (words, slabs) in band.occupied.iter_mut().zip(&tile.slabs) {
            for (slab, blocks) in slabs {
                band.slabs = [band.slabs[0].min(*slab), band.slabs[1].max(slab + 1)];
                for (k, _) in drawn().enumerate().filter(|(_, block)| blocks >> block & 1 == 1) {
                    words[k * n_words + slab / 32] |= 1 << (slab % 32);
                }
            }
        }
        band
    }

    /// Adds the blocks of another band of the same base plane.
    fn append(&mut self, mut other: Self) {
        if self.blocks.is_empty() {
            *self = other;
            return;
        }
        self.blocks.append(&mut other.blocks);
        self.intervals.iter_mut().zip(&mut other.intervals).for_each(|(all, own)| all.append(own));
        self.occupied.iter_mut().zip(&mut other.occupied).for_each(|(all, own)| all.append(own));
        self.slabs = [self.slabs[0].min(other.slabs[0]), self.slabs[1].max(other.slabs[1])];
    }
}
