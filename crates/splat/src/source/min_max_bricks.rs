//! Min-max bricks, for empty-space skipping: least and largest density of every brick of 4 x 4 x 4 cells (2 x 2 x 2 in
//! small volumes, 8 x 8 x 8 where memory is short).
//!
//! The bounds are built once per volume and kernel, at memory speed, and take 1/16 of a byte per sample, in small
//! volumes half a byte. For a transfer function they become one bit per brick, and a few words answer whether anything
//! is visible below a part of a sheet. Bounds hold for all positions inside a brick: they cover the samples that the
//! kernel reaches from there, widened where the kernel overshoots. They are stored as 4096 levels of the volume's
//! range, rounded outwards.

use std::ops::Range;
use std::sync::{Arc, Mutex};

use wavesplat_compute::locks::lock;
use wavesplat_compute::simd::Level;
use wavesplat_compute::{extent, parallel};
use wavesplat_core::Kernel;

use crate::kernel::weights::{overshoot, radius};
use crate::source::block_cache::{BLOCK, Blocks, DensityBox};
use crate::source::occupancy::OccupancyGrid;

/// Cells of a brick along each axis: in small volumes, as a rule, and where the bounds would take too much memory.
const SMALL_SIDE: usize = 2;
const SIDE: usize = 4;
const LARGE_SIDE: usize = 8;

/// Maximum bytes of the bounds of the smallest bricks: reached by 129 samples along each axis.
const MAX_BYTES_OF_SMALL: usize = 1 << 20;

/// Maximum bytes of the bounds of a volume in memory: enough for 800 samples along each axis.
pub const MAX_BYTES: usize = 32 << 20;

/// Number of levels of the density range.
const N_LEVELS: usize = 4096;

/// Bounds of a volume: least and largest density of every brick, `[z][y][x]`.
#[derive(Debug)]
pub struct Bricks {
    side: usize,
    n: [usize; 3],
    range: [f32; 2],
    bounds: Vec<[u16; 2]>,
    /// Latest results of [`Bricks::occupied`]: successive frames mostly ask for the same ones.
    latest: Mutex<Vec<Latest>>,
}

/// Ranges of density that pass a test, as prefix sums: how many levels below each level pass.
///
/// A range of levels then passes if the sums at its two ends differ.
#[derive(Clone, Debug, PartialEq)]
pub struct VisibleRanges(Vec<u16>);

/// A cached result: the bricks that passed a test.
#[derive(Debug)]
struct Latest {
    axes: [usize; 3],
    passing: VisibleRanges,
    occupied: Arc<OccupancyGrid>,
}

/// Maximum number of cached results: one per axis that a volume is looked along.
const N_LATEST: usize = 3;

/// Rows of samples of a grid, as densities.
pub trait DensityRows: Sync {
    /// Widens the bounds `lo..=hi` of each column by the densities of the row that begins at the index `start`.
    fn widen(&self, start: usize, lo: &mut [f32], hi: &mut [f32]);
}

/// Rows of densities in f32.
pub struct FloatRows<'a> {
    /// All densities.
    pub densities: &'a [f32],
    /// SIMD level to use.
    pub level: Level,
}

impl DensityRows for FloatRows<'_> {
    fn widen(&self, start: usize, lo: &mut [f32], hi: &mut [f32]) {
        self.level.run(
            #[inline(always)]
            || widen(&self.densities[start..], lo, hi, |d| d),
        );
    }
}

/// Widens the bounds `lo..=hi` of each column by the densities of a row. NaN changes nothing: comparisons with it are
/// false.
#[inline(always)]
pub fn widen<T: Copy>(row: &[T], lo: &mut [f32], hi: &mut [f32], density: impl Fn(T) -> f32) {
    for ((lo, hi), s) in lo.iter_mut().zip(hi).zip(row) {
        let d = density(*s);
        *lo = if d < *lo { d } else { *lo };
        *hi = if d > *hi { d } else { *hi };
    }
}

/// Function from bounds to levels of a range, rounded outwards.
fn level_in(range: [f32; 2]) -> impl Fn([f32; 2]) -> [u16; 2] + Copy + Send + Sync {
    let extent = range[1] - range[0];
    let per_density = if extent > 0.0 { (N_LEVELS - 1) as f32 / extent } else { 0.0 };
    // Rounded outwards, levels hold the true bounds: a brick may be kept for nothing, but is never dropped while
    // visible.
    let level = move |d: f32| ((d - range[0]) * per_density).clamp(0.0, (N_LEVELS - 1) as f32);
    move |[lo, hi]| [level(lo).floor() as u16, level(hi).ceil() as u16]
}

/// Smallest side of a brick, in cells, whose bounds fit the budget; the largest side if none do.
fn side_within(budget_bytes: usize, size: [usize; 3]) -> usize {
    let fits = |side: usize, peak_bytes: usize| {
        n_bricks(side, size).iter().product::<usize>() * size_of::<[u16; 2]>() <= peak_bytes
    };
    if fits(SMALL_SIDE, budget_bytes.min(MAX_BYTES_OF_SMALL)) {
        SMALL_SIDE
    } else if fits(SIDE, budget_bytes) {
        SIDE
    } else {
        LARGE_SIDE
    }
}

/// Number of bricks along each axis.
pub(super) fn n_bricks(side: usize, size: [usize; 3]) -> [usize; 3] {
    size.map(|n| (n - 1).div_ceil(side))
}

/// Samples that the bounds of a brick cover.
#[derive(Clone, Copy)]
pub(super) struct Reach {
    side: usize,
    /// Samples of the volume along x, y, z.
    size: [usize; 3],
    /// Number of samples that positions inside a brick reach before its first one, and after the last of its own.
    before: usize,
    after: usize,
    /// Overshoot of the kernel beyond the range of its samples, as a part of that range.
    overshoot: f32,
}

impl Reach {
    pub fn new(side: usize, size: [usize; 3], kernel: Kernel) -> Self {
        // Positions lie between a brick's first sample and the next brick's first one; samples within the radius of
        // them count.
        let after = radius(kernel).ceil() as usize;
        Self { side, size, before: after - 1, after, overshoot: overshoot(kernel) }
    }

    /// Number of bricks along each axis.
    pub fn n(&self) -> [usize; 3] {
        n_bricks(self.side, self.size)
    }

    /// Range of the samples that the bounds of a brick cover, along an axis.
    fn samples(&self, axis: usize, brick: usize) -> Range<usize> {
        let first = brick * self.side;
        first.saturating_sub(self.before)..(first + self.side + self.after).min(self.size[axis])
    }

    /// Range of the bricks whose bounds cover any sample of a range, along an axis.
    pub fn bricks(&self, axis: usize, samples: Range<usize>) -> Range<usize> {
        let n = self.n()[axis];
        let first = samples.start.saturating_sub(self.side + self.after - 1).div_ceil(self.side);
        first.min(n)..((samples.end - 1 + self.before) / self.side + 1).min(n)
    }

    /// Bounds of bricks, `[z][y][x]`, from rows of the samples of a box that begins at `lo`; widened where the kernel
    /// overshoots.
    fn bounds(
        &self,
        rows: &impl DensityRows,
        lo: [usize; 3],
        n: [usize; 3],
        bricks: [Range<usize>; 3],
    ) -> Vec<[f32; 2]> {
        let mut bounds = self.bounds_within(rows, lo, n, bricks);
        for bounds in &mut bounds {
            *bounds = self.widened(*bounds);
        }
        bounds
    }

    /// Bounds of the densities that the kernel may reconstruct from densities within bounds.
    fn widened(&self, [lo, hi]: [f32; 2]) -> [f32; 2] {
        let over = self.overshoot * (hi - lo);
        [lo - over, hi + over]
    }

    /// Least and largest density of bricks, `[z][y][x]`, from rows of those samples that lie in a box that begins at
    /// `lo`; infinite where there are none.
    pub fn bounds_within(
        &self,
        rows: &impl DensityRows,
        lo: [usize; 3],
        n @ [nx, ny, _]: [usize; 3],
        bricks: [Range<usize>; 3],
    ) -> Vec<[f32; 2]> {
        let within = |axis: usize, brick: usize| {
            let own = self.samples(axis, brick);
            own.start.max(lo[axis])..own.end.min(lo[axis] + n[axis])
        };
        let [bxs, bys, bzs] = bricks;
        let mut bounds = Vec::with_capacity(bxs.len() * bys.len() * bzs.len());
        let (mut least, mut largest) = (vec![0.0_f32; nx], vec![0.0_f32; nx]);
        for bz in bzs {
            for by in bys.clone() {
                least.fill(f32::INFINITY);
                largest.fill(f32::NEG_INFINITY);
                for z in within(2, bz) {
                    for y in within(1, by) {
                        rows.widen(nx * (y - lo[1] + ny * (z - lo[2])), &mut least, &mut largest);
                    }
                }
                for bx in bxs.clone() {
                    let Range { start, end } = within(0, bx);
                    let reached = start - lo[0]..end - lo[0];
                    let lo = least[reached.clone()].iter().fold(f32::INFINITY, |a, b| a.min(*b));
                    let hi = largest[reached].iter().fold(f32::NEG_INFINITY, |a, b| a.max(*b));
                    bounds.push([lo, hi]);
                }
            }
        }
        bounds
    }
}

impl Bricks {
    /// Builds the bricks; reads every row about 1.6 times, in small volumes 2.3 times. `range` bounds the densities.
    /// Bricks are larger where their bounds would take more than `budget_bytes`.
    pub fn new(
        rows: &impl DensityRows,
        size: [usize; 3],
        kernel: Kernel,
        range: [f32; 2],
        budget_bytes: usize,
    ) -> Self {
        let side = side_within(budget_bytes, size);
        let reach = Reach::new(side, size, kernel);
        let n = reach.n();
        let level = level_in(range);
        let mut bounds = vec![[0; 2]; n.iter().product()];
        parallel::for_each_chunk(&mut bounds, n[0] * n[1], |bz, layer| {
            let bounds = reach.bounds(rows, [0; 3], size, [0..n[0], 0..n[1], bz..bz + 1]);
            layer.iter_mut().zip(bounds).for_each(|(kept, bounds)| *kept = level(bounds));
        });
        Self { side, n, range, bounds, latest: Mutex::default() }
    }

    /// Bricks from the least and largest value of each, `[z][y][x]`, infinite where it has none; `density` converts a
    /// value.
    pub(super) fn of_bounds(
        side: usize,
        size: [usize; 3],
        kernel: Kernel,
        range: [f32; 2],
        values: &[[f32; 2]],
        density: impl Fn(f32) -> f32 + Sync,
    ) -> Self {
        let reach = Reach::new(side, size, kernel);
        let n = reach.n();
        let level = level_in(range);
        let mut bounds = vec![[0; 2]; n.iter().product()];
        parallel::for_each_chunk(&mut bounds, n[0] * n[1], |bz, layer| {
            for (kept, [lo, hi]) in layer.iter_mut().zip(&values[bz * n[0] * n[1]..]) {
                // Nothing is drawn where no sample is finite: any value within the range will do.
                let known = if lo <= hi { [density(*lo), density(*hi)] } else { [range[0]; 2] };
                *kept = level(reach.widened(known));
            }
        });
        Self { side, n, range, bounds, latest: Mutex::default() }
    }

    /// Builds the bricks of a volume that is decoded, decoding all of it. `range` bounds the densities; `None` where it
    /// is not known, as for spline coefficients: it is computed.
    pub fn of_blocks(
        level: Level,
        blocks: &Blocks,
        kernel: Kernel,
        range: Option<[f32; 2]>,
        budget_bytes: usize,
    ) -> Self {
        let size = blocks.size();
        let side = side_within(budget_bytes, size);
        let reach = Reach::new(side, size, kernel);
        let n = reach.n();
        let n_blocks = size.map(|n| n.div_ceil(BLOCK));
        let bricks_of = |b: usize| {
            let place = [b % n_blocks[0], b / n_blocks[0] % n_blocks[1], b / (n_blocks[0] * n_blocks[1])];
            [0, 1, 2].map(|a| (place[a] * BLOCK / side).min(n[a])..((place[a] + 1) * BLOCK / side).min(n[a]))
        };
        let of_block = parallel::map(n_blocks.iter().product(), |b| {
            let bricks = bricks_of(b);
            if bricks.iter().any(Range::is_empty) {
                return Vec::new();
            }
            let lo = [0, 1, 2].map(|a| reach.samples(a, bricks[a].start).start);
            let hi = [0, 1, 2].map(|a| reach.samples(a, bricks[a].end - 1).end);
            let mut part = DensityBox::default();
            blocks.decode(lo, hi, &mut part);
            reach.bounds(&FloatRows { densities: &part.densities, level }, lo, part.size, bricks)
        });
        let range = range.unwrap_or_else(|| {
            of_block.iter().flatten().copied().fold([f32::INFINITY, f32::NEG_INFINITY], extent::union)
        });
        let mut bounds = vec![[0; 2]; n.iter().product()];
        let level = level_in(range);
        for (b, of_block) in of_block.into_iter().enumerate() {
            let [xs, ys, zs] = bricks_of(b);
            let mut rows = of_block.chunks_exact(xs.len().max(1));
            for z in zs {
                for y in ys.clone() {
                    let Some(row) = rows.next() else { break };
                    for (x, bounds_here) in xs.clone().zip(row) {
                        bounds[(z * n[1] + y) * n[0] + x] = level(*bounds_here);
                    }
                }
            }
        }
        Self { side, n, range, bounds, latest: Mutex::default() }
    }

    /// Least and largest possible density.
    pub fn range(&self) -> [f32; 2] {
        self.range
    }

    /// Density of a level.
    fn density(&self, level: usize) -> f32 {
        self.range[0] + level as f32 / (N_LEVELS - 1) as f32 * (self.range[1] - self.range[0])
    }

    /// Ranges of density that pass a test; the test must hold for a range if it holds for a part of it.
    pub fn visible_ranges(&self, test: impl Fn([f32; 2]) -> bool) -> VisibleRanges {
        // The outermost levels stand for all densities beyond them.
        let mut passing = vec![0_u16; N_LEVELS + 1];
        for level in 0..N_LEVELS {
            let from = if level == 0 { f32::NEG_INFINITY } else { self.density(level - 1) };
            let to = if level + 1 == N_LEVELS { f32::INFINITY } else { self.density(level + 1) };
            // A level more on either side: the bounds were rounded.
            passing[level + 1] = passing[level] + u16::from(test([from, to]));
        }
        VisibleRanges(passing)
    }

    /// Occupancy of the bricks whose range of densities passes, laid out for sheets along `axes` (u, v, w).
    pub fn occupied(&self, axes: [usize; 3], passing: &VisibleRanges) -> Arc<OccupancyGrid> {
        let mut latest = lock(&self.latest);
        if let Some(known) = latest.iter().find(|known| (known.axes, &known.passing) == (axes, passing)) {
            return known.occupied.clone();
        }
        let occupied = Arc::new(self.passed(axes, &passing.0));
        latest.insert(0, Latest { axes, passing: passing.clone(), occupied: occupied.clone() });
        latest.truncate(N_LATEST);
        occupied
    }

    /// Occupancy of the bricks that pass. `passing`: prefix sums of passing levels ([`VisibleRanges`]).
    fn passed(&self, axes: [usize; 3], passing: &[u16]) -> OccupancyGrid {
        let n = axes.map(|a| self.n[a]);
        let n_words = n[0].div_ceil(64);
        let mut occupied =
            OccupancyGrid { log_side: self.side.ilog2(), n, n_words, bits: vec![0; n_words * n[1] * n[2]] };
        let [nx, ny, _] = self.n;
        for (row, bounds) in self.bounds.chunks_exact(nx).enumerate() {
            for (x, [lo, hi]) in bounds.iter().enumerate() {
                if passing[usize::from(*hi) + 1] > passing[usize::from(*lo)] {
                    let [u, v, w] = axes.map(|a| [x, row % ny, row / ny][a]);
                    occupied.bits[(w * n[1] + v) * n_words + u / 64] |= 1 << (u % 64);
                }
            }
        }
        occupied
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::weights::{mirror_index, taps, weight};
    use crate::source::slices::Slices;
    use wavesplat_testkit::Phantom;

    /// Densities reconstructed anywhere in a brick lie within its bounds, so that leaving it out changes nothing.
    #[test]
    fn bounds_hold_everywhere_in_a_brick() {
        let size = [11, 9, 14];
        let noise = |p: glam::DVec3| ((p.x * 12.9 + p.y * 78.2 + p.z * 37.7).sin() * 4375.8).fract() * 100.0;
        let phantom = Phantom::sample(size, glam::DAffine3::IDENTITY, noise);
        let volume = phantom.volume();
        for (name, kernel) in Kernel::NAMES {
            let slices = Slices::new(&volume, kernel);
            let bricks = slices.bricks().unwrap();
            for i in 0..4000 {
                let share = |k: i32| (f64::from(i * 7919 % 4001) * 0.618 * f64::from(k)).fract();
                let position: [f64; 3] = std::array::from_fn(|a| share(a as i32 + 1) * (size[a] - 1) as f64);
                let tapped = position.map(|x| taps(kernel, x));
                let mut density = 0.0;
                for t in 0..64 {
                    let which = [t % 4, t / 4 % 4, t / 16];
                    let weight: f64 = (0..3).map(|a| tapped[a].1[which[a]]).product();
                    if weight != 0.0 {
                        let index =
                            std::array::from_fn(|a| mirror_index(kernel, tapped[a].0 + which[a] as i64, size[a]));
                        density += weight * slices.at(index);
                    }
                }
                let brick: [usize; 3] = std::array::from_fn(|a| (position[a] as usize).min(size[a] - 2) / bricks.side);
                let bounds = bricks.bounds[brick[0] + bricks.n[0] * (brick[1] + bricks.n[1] * brick[2])];
                let [lo, hi] = bounds.map(|level| f64::from(bricks.density(usize::from(level))));
                // Spline coefficients of the ends are folded into the brick's own samples; f32 rounds.
                assert!(lo - 1e-5 <= density && density <= hi + 1e-5, "{name} {position:?}: {density} in {lo}..{hi}");
            }
        }
    }

    /// One sample beside a brick: it is seen in the brick if its kernel reaches there at all.
    #[test]
    fn bricks_know_of_every_sample_that_reaches_them() {
        let size = [17, 2, 2];
        for (name, kernel) in Kernel::NAMES {
            for bright in 0..size[0] {
                let mut densities = vec![0.0; 68];
                (0..4).for_each(|row| densities[row * size[0] + bright] = 1.0);
                let rows = FloatRows { densities: &densities, level: Level::best() };
                let bricks = Bricks::new(&rows, size, kernel, [0.0, 1.0], MAX_BYTES);
                let occupied = bricks.occupied([0, 1, 2], &bricks.visible_ranges(|[_, hi]| hi > 0.5));
                for brick in 0..bricks.n[0] {
                    let mut inside =
                        (1..100).map(|k| (brick * bricks.side) as f64 + 0.01 * f64::from(k) * bricks.side as f64);
                    let is_reached = inside.any(|x| weight(kernel, x - bright as f64) != 0.0);
                    let is_occupied = occupied.any([brick; 2], [0; 2], [0; 2]);
                    assert_eq!(is_occupied, is_reached, "{name}: sample {bright}, brick {brick}");
                }
            }
        }
    }

    #[test]
    fn what_was_asked_for_last_is_kept() {
        let phantom = Phantom::sample([9, 9, 9], glam::DAffine3::IDENTITY, |p| p.x);
        let slices = Slices::new(&phantom.volume(), Kernel::Linear);
        let bricks = slices.bricks().unwrap();
        let all_axes = [[0, 1, 2], [0, 2, 1], [1, 2, 0]];
        let above = |axes: [usize; 3], least: f32| bricks.occupied(axes, &bricks.visible_ranges(|[_, hi]| hi > least));
        let first = all_axes.map(|axes| above(axes, 5.0));
        for (axes, first) in all_axes.into_iter().zip(&first) {
            assert!(Arc::ptr_eq(&above(axes, 5.0), first), "{axes:?}");
        }
        let other = above([0, 1, 2], 2.0);
        assert_ne!(other.bits, first[0].bits);
        assert!(Arc::ptr_eq(&above([0, 1, 2], 2.0), &other));
        // The oldest was evicted.
        let again = above([0, 1, 2], 5.0);
        assert!(!Arc::ptr_eq(&again, &first[0]) && again.bits == first[0].bits);
    }

    #[test]
    fn bricks_are_as_small_as_their_bounds_may_take() {
        assert_eq!([129, 130].map(|n| side_within(MAX_BYTES, [n; 3])), [SMALL_SIDE, SIDE]);
        assert_eq!(side_within(MAX_BYTES, [800; 3]), SIDE);
        assert_eq!(side_within(MAX_BYTES, [1024; 3]), LARGE_SIDE);
        // 4 x 5 x 2 and 2 x 3 x 1 bricks of four bytes.
        let sides = [160, 159, 24, 23].map(|budget| side_within(budget, [9, 10, 5]));
        assert_eq!(sides, [SMALL_SIDE, SIDE, SIDE, LARGE_SIDE]);
    }

    #[test]
    fn an_occupied_brick_is_found_from_all_sides() {
        let phantom = Phantom::sample([300, 20, 9], glam::DAffine3::IDENTITY, |p| {
            if p == glam::DVec3::new(270.0, 13.0, 5.0) { 1.0 } else { 0.0 }
        });
        let slices = Slices::new(&phantom.volume(), Kernel::Linear);
        for (axes, place) in [([0, 1, 2], [270.0, 13.0, 5.0]), ([1, 2, 0], [13.0, 5.0, 270.0])] {
            let bricks = slices.bricks().unwrap();
            let occupied = bricks.occupied(axes, &bricks.visible_ranges(|[_, hi]| hi > 0.5));
            let at = |shift: f64| {
                let around = |x: f64| [x + shift - 1.5, x + shift + 1.5];
                let layer = occupied.layer(place[2] as usize);
                let (u, v) = (occupied.touched(0, around(place[0])), occupied.touched(1, around(place[1])));
                matches!((u, v), (Some(u), Some(v)) if occupied.any(u, v, [layer; 2]))
            };
            assert!(at(0.0) && !at(-7.0) && !at(100.0), "{axes:?}");
            assert!(!occupied.any([0, 0], [0, 0], [0, 0]));
        }
    }

    #[test]
    fn runs_are_looked_at_together_as_one_by_one() {
        let n = [300, 7, 3];
        let n_words = 300_usize.div_ceil(64);
        let mut occupied = OccupancyGrid { log_side: 1, n, n_words, bits: vec![0; n_words * n[1] * n[2]] };
        // One brick in fifty.
        for k in (0..n[0] * n[1] * n[2]).filter(|k| k * 7919 % 50 == 0) {
            occupied.bits[k / n[0] * n_words + k % n[0] / 64] |= 1 << (k % n[0] % 64);
        }
        let (mut n_some, mut n_none, mut n_long) = (0, 0, 0);
        for first in 0..290 {
            for length in [1, 7, 30, 90] {
                let run = |k: usize| [(first + k * length).min(n[0] - 1), (first + k * length + length).min(n[0] - 1)];
                let u = [Some(run(0)), None, Some(run(1)), Some(run(2))];
                let runs = occupied.runs(u);
                n_long += usize::from(runs.long.is_some());
                for (v, w) in [([0, 0], [0, 0]), ([2, 5], [1, 2]), ([6, 6], [2, 3])] {
                    let together = occupied.any_of(&runs, v, w);
                    assert_eq!(together, u.map(|u| u.is_some_and(|u| occupied.any(u, v, w))), "{first} {length}");
                    n_some += together.iter().filter(|is_any| **is_any).count();
                    n_none += together.iter().filter(|is_any| !**is_any).count();
                }
            }
        }
        assert!(n_some > 100 && n_none > 2000 && n_long > 100, "{n_some} {n_none} {n_long}");
    }
}
