//! The state of a tile's rays between two sheets: what compositing goes on from.
//!
//! A picture can be cut into pieces by tiles and by sheets: a piece takes a state and gives the next, as plain arrays, by
//! [`Chunk`], so that they may be kept, sent to another process, or uploaded.

use wavesplat_compute::simd::Lanes;

use crate::sheet::tile_layout::Chunk;

/// What is known of the rays of a tile, chunk by chunk ([`Chunk::index`]). Arrays that an operator does not need are empty.
#[derive(Clone, Debug, Default)]
pub struct TileState {
    /// Premultiplied colour and opacity (over, first hit).
    pub rgba: Vec<[Lanes; 4]>,
    /// The extreme or the integral of the densities so far (projections).
    pub value: Vec<Lanes>,
    /// Length of the way through the volume so far (projections).
    pub length: Vec<Lanes>,
    /// Position of opacity 1/2, or of the surface, along the ray; NaN where it is not reached.
    pub s_half: Vec<Lanes>,
    /// Rays that have found what they look for, as bits (first hit, local maximum).
    pub found: Vec<u16>,
    /// Chunks of which no ray can change any more: opaque, or found.
    pub done: Vec<bool>,
}

impl TileState {
    /// An array with an entry for every chunk.
    pub fn per_chunk<T: Clone>(value: T) -> Vec<T> {
        vec![value; Chunk::N]
    }
}
