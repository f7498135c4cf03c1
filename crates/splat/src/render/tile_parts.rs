//! Parts of tiles: with many threads, the most expensive tiles are cut along rows of blocks, and expensive parts are
//! begun first.
//!
//! A picture of 512 x 512 pixels has about fifty tiles that do the work, and the most expensive takes a twentieth of
//! all time: on 64 threads most threads would wait for it. Footprints reach beyond the rows of a part, so the rows at a
//! cut are combined twice and two halves cost more than the whole: only tiles that would keep a thread busy for long
//! are cut. Short parts, begun last, fill the gaps that long ones leave at the end (Graham 1969).

use crate::sheet::tile_layout::{BLOCK_V, N_BLOCKS_V, TilePart};

/// Fewest threads for which tiles are begun in the order of their cost: with fewer, none waits long for the last tile.
const MIN_THREADS_TO_ORDER: usize = 8;

/// Fewest threads for which tiles are cut.
const MIN_THREADS_TO_CUT: usize = 16;

/// Largest cost of a part, as a share of the cost that each thread has if all have the same: numerator and denominator.
/// By `make bench-threads BENCH_THREADS=--simulate`: smaller parts cost more, by the rows that they share, than they
/// save.
const LARGEST_PART: [usize; 2] = [2, 3];

/// Parts of tiles in the order in which they are begun, by the tiles' estimated costs; `None` where whole tiles, row by
/// row, are as good.
///
/// The order of a base plane's rows ends with few and unlike tiles: a tile at the edge of a volume may cost nothing,
/// one in its middle a twentieth of the picture.
pub fn parts_for(n_threads: usize, costs: impl FnOnce() -> Vec<usize>) -> Option<Vec<TilePart>> {
    if n_threads < MIN_THREADS_TO_ORDER {
        return None;
    }
    let costs = costs();
    let most = if n_threads < MIN_THREADS_TO_CUT {
        usize::MAX
    } else {
        LARGEST_PART[0] * costs.iter().sum::<usize>() / (LARGEST_PART[1] * n_threads)
    };
    let mut parts: Vec<(usize, TilePart)> = Vec::new();
    for (tile, cost) in costs.into_iter().enumerate() {
        let n_parts = [1, 2].into_iter().find(|n| cost / n <= most).unwrap_or(N_BLOCKS_V);
        let n_rows = N_BLOCKS_V * BLOCK_V / n_parts;
        parts.extend((0..n_parts).map(|k| (cost / n_parts, TilePart { tile, rows: k * n_rows..(k + 1) * n_rows })));
    }
    parts.sort_by_key(|(cost, _)| std::cmp::Reverse(*cost));
    Some(parts.into_iter().map(|(_, part)| part).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sheet::tile_layout::{BlockMask, TILE_V};

    #[test]
    fn parts_of_a_tile_are_its_rows_once() {
        let costs = vec![0, 700, 20, 90, 7, 300];
        for n_threads in [8, 16, 64] {
            let parts = parts_for(n_threads, || costs.clone()).unwrap();
            for tile in 0..costs.len() {
                let mut own: Vec<_> = parts.iter().filter(|part| part.tile == tile).collect();
                own.sort_by_key(|part| part.rows.start);
                assert_eq!(
                    own.iter().flat_map(|part| part.rows.clone()).collect::<Vec<_>>(),
                    (0..TILE_V).collect::<Vec<_>>()
                );
                assert_eq!(own.iter().fold(0, |all, part| all | part.blocks()), BlockMask::MAX);
                assert_eq!(own.iter().map(|part| part.blocks().count_ones()).sum::<u32>(), BlockMask::BITS);
            }
        }
        assert_eq!(parts_for(4, || costs.clone()), None);
    }

    #[test]
    fn dear_tiles_are_cut_for_many_threads() {
        let n_of_dearest = |n_threads| {
            let parts = parts_for(n_threads, || vec![5, 60, 10, 25]).unwrap();
            assert_eq!(parts[0].tile, 1);
            parts.iter().filter(|part| part.tile == 1).count()
        };
        assert_eq!([8, 16, 64].map(n_of_dearest), [1, N_BLOCKS_V, N_BLOCKS_V]);
        assert_eq!(parts_for(16, || vec![100; 16]).unwrap().len(), 32);
        assert_eq!(parts_for(16, || vec![10; 64]).unwrap().len(), 64);
    }
}
