//! The state of a tile's rays between two sheets, from which compositing can be continued.
//!
//! A picture can be cut into pieces by tiles and by sheets: a piece takes a state and returns the next, as plain arrays
//! by [`Chunk`], so that states can be kept, sent to another process, or uploaded.

use wavesplat_compute::simd::{LANES, Lanes};

use crate::sheet::tile_layout::Chunk;

/// Bytes of the lengths of the nine arrays.
const HEAD: usize = 36;

/// State of the rays of a tile, chunk by chunk ([`Chunk::index`]).
///
/// Arrays that an operator does not need are empty.
#[derive(Clone, Debug, Default)]
pub struct TileState {
    /// Premultiplied colour and opacity (over, first hit).
    pub rgba: Vec<[Lanes; 4]>,
    /// The extreme or the integral of the densities so far (projections).
    pub value: Vec<Lanes>,
    /// Length of the way through the volume so far (projections).
    pub length: Vec<Lanes>,
    /// Optical depth in front of the next sheet (attenuated maxima).
    pub absorbed: Vec<Lanes>,
    /// Position of opacity 1/2, of the surface, or of the extreme, along the ray; NaN where there is none.
    pub s_half: Vec<Lanes>,
    /// Where rays entered matter through a cut last, in s ([`crate::ray::cut_faces`]).
    pub entries: Vec<Lanes>,
    /// Rays that have found their surface or maximum, as bits (first hit, local maximum).
    pub found: Vec<u16>,
    /// Chunks in which no ray can change any more: all are opaque, or have found.
    pub done: Vec<bool>,
    /// Number of surfaces of shapes that each ray has passed; empty where there are none.
    pub passed: Vec<[u8; LANES]>,
}

impl TileState {
    /// Serialises the state, little-endian.
    ///
    /// The lengths of the nine arrays, then the arrays in the order of the fields. [`TileState::from_bytes`] reads them
    /// back.
    pub fn to_bytes(&self) -> Vec<u8> {
        let Self { rgba, value, length, absorbed, s_half, entries, found, done, passed } = self;
        let of_lanes = [value, length, absorbed, s_half, entries];
        let lens =
            [rgba.len()].into_iter().chain(of_lanes.map(Vec::len)).chain([found.len(), done.len(), passed.len()]);
        let n_lanes = 4 * rgba.len() + of_lanes.iter().map(|own| own.len()).sum::<usize>();
        let mut bytes = Vec::with_capacity(HEAD + 4 * LANES * n_lanes);
        for n in lens {
            bytes.extend_from_slice(&(n as u32).to_le_bytes());
        }
        let lanes = rgba.as_flattened().iter().chain(of_lanes.into_iter().flatten());
        lanes.flat_map(|lanes| lanes.0).for_each(|x| bytes.extend_from_slice(&x.to_le_bytes()));
        for bits in found {
            bytes.extend_from_slice(&bits.to_le_bytes());
        }
        bytes.extend(done.iter().map(|done| u8::from(*done)));
        bytes.extend(passed.as_flattened());
        bytes
    }

    /// Reads the output of [`TileState::to_bytes`]; `None` where the bytes are not a state.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let (head, rest) = bytes.split_at_checked(HEAD)?;
        let (head, _) = head.as_chunks::<4>();
        let n: Vec<usize> = head.iter().map(|n| u32::from_le_bytes(*n) as usize).collect();
        if n.iter().any(|n| *n != 0 && *n != Chunk::N) {
            return None;
        }
        let n_lanes = 4 * n[0] + n[1..6].iter().sum::<usize>();
        let (lanes, rest) = rest.split_at_checked(4 * LANES * n_lanes)?;
        let (found, rest) = rest.split_at_checked(2 * n[6])?;
        let (done, passed) = rest.split_at_checked(n[7])?;
        if passed.len() != LANES * n[8] {
            return None;
        }
        let mut lanes = lanes.chunks_exact(4 * LANES).map(|own| {
            let (numbers, _) = own.as_chunks::<4>();
            Lanes(std::array::from_fn(|i| f32::from_le_bytes(numbers[i])))
        });
        let mut take = |n: usize| lanes.by_ref().take(n).collect::<Vec<_>>();
        let rgba = take(4 * n[0]).as_chunks::<4>().0.to_vec();
        let [value, length, absorbed, s_half, entries] = [n[1], n[2], n[3], n[4], n[5]].map(&mut take);
        let found = found.as_chunks::<2>().0.iter().map(|bits| u16::from_le_bytes(*bits)).collect();
        let done = done.iter().map(|done| *done != 0).collect();
        let passed = passed.as_chunks::<LANES>().0.to_vec();
        Some(Self { rgba, value, length, absorbed, s_half, entries, found, done, passed })
    }

    /// An array with `value` for every chunk.
    pub fn per_chunk<T: Clone>(value: T) -> Vec<T> {
        vec![value; Chunk::N]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_read_back() {
        let lanes = |x: f32| TileState::per_chunk(Lanes::splat(x));
        let state = TileState {
            rgba: TileState::per_chunk([0.1, 0.2, 0.3, 0.4].map(Lanes::splat)),
            s_half: lanes(f32::NAN),
            entries: lanes(-1.5),
            found: TileState::per_chunk(0xA5A5),
            done: TileState::per_chunk(true),
            passed: TileState::per_chunk([7; LANES]),
            ..TileState::default()
        };
        let bytes = state.to_bytes();
        assert_eq!(TileState::from_bytes(&bytes).unwrap().to_bytes(), bytes);
        let other = TileState { value: lanes(2.0), length: lanes(3.0), absorbed: lanes(0.5), ..TileState::default() };
        let read = TileState::from_bytes(&other.to_bytes()).unwrap();
        assert!(read.value[5].0[3] == 2.0 && read.length[127].0[15] == 3.0 && read.rgba.is_empty());
        assert!(read.absorbed[9].0[1] == 0.5 && read.s_half.is_empty());
        for n in [0, HEAD - 1, bytes.len() - 1] {
            assert!(TileState::from_bytes(&bytes[..n]).is_none(), "{n}");
        }
        assert!(TileState::from_bytes(&[bytes.as_slice(), &[0]].concat()).is_none());
    }
}
