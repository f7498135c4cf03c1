//! Bands: blocks of a base plane that are drawn together, with the intervals of their rays and the slabs they occupy.

use std::ops::Range;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::LANES;
use wavesplat_splat::render::plan::FamilyPlan;
use wavesplat_splat::render::plan_arrays::{BasePlaneArrays, TileArrays};
use wavesplat_splat::sheet::tile_layout::{BLOCK_V, N_BLOCKS_V, N_STRIPS, TILE_U};

use crate::layout::N_BLOCK;

/// Most blocks that are drawn at once: 1 M texels, so that no binding exceeds what every device has, and a weak device
/// takes a few hundredths of a second for a slab of them.
const MAX_BLOCKS: usize = 1 << 13;

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
    for row in 0..n_tiles_v {
        let tiles = parallel::map(n_tiles_u, |column| arrays.tile([column, row]));
        for (column, tile) in tiles.iter().enumerate() {
            let n = tile.blocks.count_ones() as usize;
            if bands.last().is_some_and(|band| band.blocks.len() + n > most) {
                bands.push(Band::default());
            }
            if let Some(band) = bands.last_mut() {
                band.add(family, tile, [column, row], n_layers);
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

    fn add(&mut self, family: &FamilyPlan, tile: &TileArrays, [column, row]: [usize; 2], n_layers: usize) {
        if tile.blocks == 0 {
            return;
        }
        if self.blocks.is_empty() {
            self.slabs = [usize::MAX, 0];
        }
        self.intervals.resize_with(tile.intervals.len(), Vec::new);
        self.occupied.resize_with(n_layers, Vec::new);
        let n_words = n_mask_words(family);
        for block in (0..N_STRIPS * N_BLOCKS_V).filter(|block| tile.blocks >> block & 1 == 1) {
            let [strip, first_row] = [block / N_BLOCKS_V, block % N_BLOCKS_V];
            self.blocks.push([column * N_STRIPS + strip, row * N_BLOCKS_V + first_row]);
            for (all, own) in self.intervals.iter_mut().zip(&tile.intervals) {
                for v in first_row * BLOCK_V..(first_row + 1) * BLOCK_V {
                    all.extend_from_slice(&own[v * TILE_U + strip * LANES..][..LANES]);
                }
            }
            for (all, slabs) in self.occupied.iter_mut().zip(&tile.slabs) {
                let first = all.len();
                all.resize(first + n_words, 0);
                for (place, _) in slabs.iter().filter(|(_, blocks)| blocks >> block & 1 == 1) {
                    all[first + place / 32] |= 1 << (place % 32);
                    self.slabs = [self.slabs[0].min(*place), self.slabs[1].max(place + 1)];
                }
            }
        }
    }
}
