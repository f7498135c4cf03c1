//! State of the rays of a block of tiles between two steps of a stream, with bytes to keep or to send to another
//! process.

use wavesplat_splat::ray::state::TileState;
use wavesplat_splat::render::tile::Work;

/// State of the rays of a block.
#[derive(Clone, Debug, Default)]
pub struct BlockState {
    /// State of each tile, row by row; `None` where nothing was seen yet. Empty before the first step.
    pub tiles: Vec<Option<TileState>>,
    /// Work done so far.
    pub work: Work,
}

/// First bytes of a state, which identify the format.
const MAGIC: &[u8; 8] = b"wsblock2";

impl BlockState {
    /// The state as bytes, little-endian; tiles without a state take no bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        for n in [self.work.n_texels, self.work.n_skipped, self.tiles.len() as u64] {
            bytes.extend_from_slice(&n.to_le_bytes());
        }
        for (k, tile) in self.tiles.iter().enumerate() {
            if let Some(tile) = tile {
                let own = tile.to_bytes();
                for n in [k as u64, own.len() as u64] {
                    bytes.extend_from_slice(&n.to_le_bytes());
                }
                bytes.extend_from_slice(&own);
            }
        }
        bytes
    }

    /// Reads a state that [`BlockState::to_bytes`] wrote; `None` for other bytes, or for more than `most_tiles` tiles.
    pub fn from_bytes(bytes: &[u8], most_tiles: usize) -> Option<Self> {
        let mut rest = bytes.strip_prefix(MAGIC)?;
        let number = |rest: &mut &[u8]| {
            let (own, others) = rest.split_first_chunk::<8>()?;
            *rest = others;
            Some(u64::from_le_bytes(*own))
        };
        let [n_texels, n_skipped, n_tiles] = [number(&mut rest)?, number(&mut rest)?, number(&mut rest)?];
        let n_tiles = usize::try_from(n_tiles).ok().filter(|n| *n <= most_tiles)?;
        let mut tiles = vec![None; n_tiles];
        while !rest.is_empty() {
            let [k, length] =
                [number(&mut rest)?, number(&mut rest)?].map(|n| usize::try_from(n).unwrap_or(usize::MAX));
            let (own, others) = rest.split_at_checked(length)?;
            *tiles.get_mut(k)? = Some(TileState::from_bytes(own)?);
            rest = others;
        }
        Some(Self { tiles, work: Work { n_texels, n_skipped } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_read_back() {
        let done = TileState { done: TileState::per_chunk(true), ..TileState::default() };
        let work = Work { n_texels: 12, n_skipped: 3 };
        let state = BlockState { tiles: vec![None, Some(done), None], work };
        let bytes = state.to_bytes();
        let read = BlockState::from_bytes(&bytes, 3).unwrap();
        assert!(read.tiles[0].is_none() && read.tiles[1].as_ref().unwrap().done[5] && read.work.n_texels == 12);
        assert_eq!(read.to_bytes(), bytes);
        assert!(BlockState::from_bytes(&bytes, 2).is_none(), "more tiles than there are");
        for n in 0..bytes.len() {
            // Cut before its only tile, the bytes are still a valid state.
            assert!(n == 32 || BlockState::from_bytes(&bytes[..n], 3).is_none(), "{n}");
        }
    }
}
