//! Cache of the densities of a volume that is decoded: all of them, or blocks of 32 x 32 x 32, decoded on demand.
//!
//! The cached blocks stay below a budget, so volumes larger than memory can be drawn; the least recently used blocks
//! are evicted first. Blocks hold the values that the kernel works on: densities, or spline coefficients.

use std::ops::Range;
use std::sync::{Arc, Mutex, OnceLock};

use wavesplat_compute::locks::lock;
use wavesplat_compute::parallel;
use wavesplat_core::{Decoder, Grid, Kernel};

use crate::kernel::prefilter;

/// Side of a block, in samples.
pub const BLOCK: usize = 32;

/// Bytes of a block.
const BLOCK_BYTES: usize = BLOCK * BLOCK * BLOCK * size_of::<f32>();

/// Samples along x, y, z, approximately, of the boxes that [`samples_every`] decodes.
const PIECE: [usize; 3] = [64, 64, 32];

/// A box of densities, `[z][y][x]`.
#[derive(Clone, Debug, Default)]
pub struct DensityBox {
    /// Index of its first sample.
    pub lo: [usize; 3],
    /// Samples along x, y, z.
    pub size: [usize; 3],
    /// The densities.
    pub densities: Vec<f32>,
}

impl DensityBox {
    /// Sets the box to `lo..hi`; its densities are to be filled in.
    fn resize(&mut self, lo: [usize; 3], hi: [usize; 3]) {
        self.lo = lo;
        self.size = [0, 1, 2].map(|a| hi[a] - lo[a]);
        let n = self.size.iter().product();
        if self.densities.len() < n {
            self.densities.resize(n, 0.0);
        }
    }

    fn row_mut(&mut self, y: usize, z: usize) -> &mut [f32] {
        let [nx, ny, _] = self.size;
        &mut self.densities[(z * ny + y) * nx..][..nx]
    }
}

/// Cache of decoded blocks of a volume, for one kernel.
pub struct Blocks {
    decoder: Arc<dyn Decoder>,
    /// Map from samples to densities: `(offset, scale)` of `(sample − offset) · scale`.
    map: (f64, f64),
    pole: Option<f64>,
    size: [usize; 3],
    n: [usize; 3],
    budget_bytes: usize,
    held: Mutex<Held>,
}

type CachedBlock = Arc<OnceLock<Vec<f32>>>;

#[derive(Default)]
struct Held {
    slots: Vec<Slot>,
    n_blocks: usize,
    /// Number of requests so far.
    now: u64,
}

#[derive(Clone, Default)]
struct Slot {
    block: Option<CachedBlock>,
    last_used: u64,
}

impl Blocks {
    /// Empty cache: nothing is decoded yet.
    pub fn new(decoder: Arc<dyn Decoder>, grid: &Grid, kernel: Kernel, budget_bytes: usize) -> Self {
        let size = grid.size();
        let n = size.map(|n| n.div_ceil(BLOCK));
        let held = Held { slots: vec![Slot::default(); n.iter().product()], ..Held::default() };
        let map = grid.density_from_sample();
        Self { decoder, map, pole: prefilter::pole(kernel), size, n, budget_bytes, held: Mutex::new(held) }
    }

    /// Samples along x, y, z.
    pub fn size(&self) -> [usize; 3] {
        self.size
    }

    /// Decodes a box, bypassing the cache.
    pub fn decode(&self, lo: [usize; 3], hi: [usize; 3], part: &mut DensityBox) {
        part.resize(lo, hi);
        let Some(z) = self.pole else {
            self.decoder.decode(lo, hi, &mut part.densities);
            to_densities(&mut part.densities, self.map);
            return;
        };
        let needed = [0, 1, 2].map(|a| prefilter::needed(&(lo[a]..hi[a]), self.size[a]));
        let (from, to) = (needed.each_ref().map(|r| r.start), needed.each_ref().map(|r| r.end));
        let n @ [nx, ny, _] = [0, 1, 2].map(|a| to[a] - from[a]);
        let mut wide = vec![0.0; n.iter().product()];
        self.decoder.decode(from, to, &mut wide);
        to_densities(&mut wide, self.map);
        prefilter::prefilter_box(&mut wide, from, n, z);
        let first = [0, 1, 2].map(|a| lo[a] - from[a]);
        for k in 0..part.size[2] {
            for j in 0..part.size[1] {
                let row = &wide[((first[2] + k) * ny + first[1] + j) * nx + first[0]..];
                let out = part.row_mut(j, k);
                out.copy_from_slice(&row[..out.len()]);
            }
        }
    }

    /// Fills a box from cached blocks, decoding those that are missing.
    pub fn load(&self, lo: [usize; 3], hi: [usize; 3], part: &mut DensityBox) {
        part.resize(lo, hi);
        let touched = [0, 1, 2].map(|a| lo[a] / BLOCK..hi[a].div_ceil(BLOCK));
        let mut blocks = self.request(touched.clone()).into_iter();
        for bz in touched[2].clone() {
            for by in touched[1].clone() {
                for bx in touched[0].clone() {
                    let first = [bx * BLOCK, by * BLOCK, bz * BLOCK];
                    let [nx, ny, _] = self.block_size(first);
                    let Some(block) = blocks.next() else { return };
                    let densities = block.get_or_init(|| {
                        let mut block = DensityBox::default();
                        let size = self.block_size(first);
                        self.decode(first, [0, 1, 2].map(|a| first[a] + size[a]), &mut block);
                        block.densities
                    });
                    let from = [0, 1, 2].map(|a| lo[a].max(first[a]));
                    let to = [0, 1, 2].map(|a| hi[a].min(first[a] + BLOCK));
                    for z in from[2]..to[2] {
                        for y in from[1]..to[1] {
                            let row = ((z - first[2]) * ny + y - first[1]) * nx;
                            let row = &densities[row + from[0] - first[0]..row + to[0] - first[0]];
                            part.row_mut(y - lo[1], z - lo[2])[from[0] - lo[0]..][..row.len()].copy_from_slice(row);
                        }
                    }
                }
            }
        }
    }

    /// Samples along x, y, z of the block that begins at `lo`.
    fn block_size(&self, lo: [usize; 3]) -> [usize; 3] {
        [0, 1, 2].map(|a| BLOCK.min(self.size[a] - lo[a]))
    }

    /// Blocks by their ranges along x, y, z, z slowest; new ones are empty. May evict others.
    fn request(&self, [xs, ys, zs]: [Range<usize>; 3]) -> Vec<CachedBlock> {
        let mut held = lock(&self.held);
        held.now += 1;
        let now = held.now;
        let mut blocks = Vec::with_capacity(xs.len() * ys.len() * zs.len());
        let mut n_new = 0;
        for bz in zs {
            for by in ys.clone() {
                for bx in xs.clone() {
                    let slot = &mut held.slots[(bz * self.n[1] + by) * self.n[0] + bx];
                    slot.last_used = now;
                    n_new += usize::from(slot.block.is_none());
                    blocks.push(slot.block.get_or_insert_default().clone());
                }
            }
        }
        held.n_blocks += n_new;
        if held.n_blocks * BLOCK_BYTES > self.budget_bytes {
            // Finding the oldest blocks takes a pass over all slots: evicting a quarter at once pays it once for many
            // blocks. A block that another thread still reads lives on in that thread.
            held.drop_oldest(self.budget_bytes / BLOCK_BYTES * 3 / 4);
        }
        blocks
    }
}

impl Held {
    /// Evicts down to `n_left` blocks, the least recently used first.
    fn drop_oldest(&mut self, n_left: usize) {
        let mut times: Vec<u64> = self.slots.iter().filter(|s| s.block.is_some()).map(|s| s.last_used).collect();
        let n_gone = times.len().saturating_sub(n_left);
        if n_gone > 0 {
            let (_, last, _) = times.select_nth_unstable(n_gone - 1);
            for slot in self.slots.iter_mut().filter(|slot| slot.last_used <= *last) {
                slot.block = None;
            }
        }
        self.n_blocks = self.slots.iter().filter(|s| s.block.is_some()).count();
    }
}

/// Decodes every `step`-th sample along each axis; returns how many there are along x, y, z, and the samples,
/// `[z][y][x]`. No sample is decoded twice.
pub fn samples_every(decoder: &dyn Decoder, step: usize) -> ([usize; 3], Vec<f32>) {
    let size = decoder.size();
    let n @ [nx, ny, _] = size.map(|n| n.div_ceil(step));
    // Range of the wanted samples in the `k`th piece of an axis.
    let piece = |a: usize, k: usize| (k * PIECE[a]).div_ceil(step)..((k + 1) * PIECE[a]).div_ceil(step).min(n[a]);
    let n_pieces = [0, 1, 2].map(|a| size[a].div_ceil(PIECE[a]));
    let mut all = vec![0.0; n.iter().product()];
    let mut rest = all.as_mut_slice();
    // Layer by layer of pieces, so that hardly anything is in memory twice.
    for layer in 0..n_pieces[2] {
        let zs = piece(2, layer);
        let pieces = parallel::map(n_pieces[0] * n_pieces[1], |p| {
            let wanted = [piece(0, p % n_pieces[0]), piece(1, p / n_pieces[0]), zs.clone()];
            let samples = decoded_every(decoder, step, &wanted);
            (wanted, samples)
        });
        let (slices, behind) = rest.split_at_mut(zs.len() * nx * ny);
        rest = behind;
        parallel::for_each_chunk(slices, nx * ny, |z, slice| {
            for ([xs, ys, _], samples) in &pieces {
                let rows = samples.chunks_exact(xs.len().max(1)).skip(z * ys.len());
                for (y, row) in ys.clone().zip(rows) {
                    slice[y * nx..][xs.clone()].copy_from_slice(row);
                }
            }
        });
    }
    (n, all)
}

/// Decodes a box of every `step`-th sample. `wanted`: its ranges, counted in steps.
fn decoded_every(decoder: &dyn Decoder, step: usize, wanted: &[Range<usize>; 3]) -> Vec<f32> {
    if wanted.iter().any(Range::is_empty) {
        return Vec::new();
    }
    let [lo, hi] = [wanted.each_ref().map(|w| w.start * step), wanted.each_ref().map(|w| (w.end - 1) * step + 1)];
    let [nx, ny, nz] = [0, 1, 2].map(|a| hi[a] - lo[a]);
    let mut samples = vec![0.0; nx * ny * nz];
    decoder.decode(lo, hi, &mut samples);
    if step == 1 {
        return samples;
    }
    let mut out = Vec::with_capacity(wanted.iter().map(ExactSizeIterator::len).product());
    for z in (0..nz).step_by(step) {
        for y in (0..ny).step_by(step) {
            out.extend(samples[(z * ny + y) * nx..][..nx].iter().step_by(step));
        }
    }
    out
}

/// Bytes that all densities of a volume of this size take.
pub fn bytes_of_all(size: [usize; 3]) -> usize {
    size.iter().product::<usize>() * size_of::<f32>()
}

/// Decodes all densities, `[z][y][x]`.
pub fn all_densities(decoder: &dyn Decoder, grid: &Grid) -> Vec<f32> {
    let (_, mut densities) = samples_every(decoder, 1);
    let [nx, ny, _] = grid.size();
    parallel::for_each_chunk(&mut densities, nx * ny, |_, slice| to_densities(slice, grid.density_from_sample()));
    densities
}

fn to_densities(samples: &mut [f32], (offset, scale): (f64, f64)) {
    for s in samples {
        *s = ((f64::from(*s) - offset) * scale) as f32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DAffine3;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use wavesplat_core::Statistics;

    /// Decoder with a different number for every sample; counts its calls.
    struct Numbers(AtomicUsize);

    const SIZE: [usize; 3] = [70, 40, 65];

    fn number(p: [usize; 3]) -> f32 {
        (p[0] + 100 * p[1] + 10_000 * p[2]) as f32
    }

    impl Decoder for Numbers {
        fn size(&self) -> [usize; 3] {
            SIZE
        }

        fn decode(&self, lo: [usize; 3], hi: [usize; 3], out: &mut [f32]) {
            self.0.fetch_add(1, Ordering::Relaxed);
            let mut out = out.iter_mut();
            for z in lo[2]..hi[2] {
                for y in lo[1]..hi[1] {
                    for x in lo[0]..hi[0] {
                        *out.next().unwrap() = number([x, y, z]);
                    }
                }
            }
        }
    }

    fn blocks(budget_blocks: usize) -> (Arc<Numbers>, Blocks) {
        let numbers = Arc::new(Numbers(AtomicUsize::new(0)));
        let statistics = Statistics { min: 0.0, max: 1.0, n_nonfinite: 0 };
        let grid = Grid::new("numbers", SIZE, DAffine3::IDENTITY, statistics, false).unwrap();
        (numbers.clone(), Blocks::new(numbers, &grid, Kernel::Linear, budget_blocks * BLOCK_BYTES))
    }

    fn check(blocks: &Blocks, lo: [usize; 3], hi: [usize; 3]) {
        let mut part = DensityBox::default();
        blocks.load(lo, hi, &mut part);
        let [nx, ny, nz] = part.size;
        for i in 0..nx * ny * nz {
            let want = number([lo[0] + i % nx, lo[1] + i / nx % ny, lo[2] + i / (nx * ny)]);
            assert_eq!(part.densities[i], want, "{i} of {lo:?} to {hi:?}");
        }
    }

    #[test]
    fn a_box_is_put_together_from_blocks() {
        let (numbers, blocks) = blocks(100);
        check(&blocks, [30, 31, 0], [66, 33, 65]);
        let n_decoded = numbers.0.load(Ordering::Relaxed);
        assert_eq!(n_decoded, 3 * 2 * 3);
        check(&blocks, [0, 0, 0], SIZE);
        assert_eq!(numbers.0.load(Ordering::Relaxed), n_decoded, "blocks are kept");
    }

    #[test]
    fn every_nth_sample_is_found() {
        let decoder = Numbers(AtomicUsize::new(0));
        for step in [1, 2, 3, 7, 70] {
            let (n @ [nx, ny, _], samples) = samples_every(&decoder, step);
            assert_eq!(n, SIZE.map(|n| n.div_ceil(step)));
            for (i, got) in samples.iter().enumerate() {
                assert_eq!(*got, number([i % nx, i / nx % ny, i / (nx * ny)].map(|i| i * step)), "{step} {i}");
            }
        }
    }

    #[test]
    fn what_is_kept_stays_within_the_budget() {
        let (numbers, blocks) = blocks(4);
        for _ in 0..3 {
            check(&blocks, [0, 0, 0], SIZE);
            assert!(blocks.held.lock().unwrap().n_blocks <= 4);
        }
        assert!(numbers.0.load(Ordering::Relaxed) > 18, "blocks that went are decoded again");
    }
}
