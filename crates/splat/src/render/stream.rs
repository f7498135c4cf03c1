//! Streaming: the schedule of a frame whose samples are read while it is drawn, within a memory budget.
//!
//! A base plane is cut into blocks of tiles, and each block is drawn front to back in steps. A step reads the next
//! layer of the file's chunks, keeps the few slices of the step before that footprints still reach, and draws the slabs
//! whose samples are all there. The order of the sheets fixes the order of the reads: each chunk is read once
//! per block, and chunks from which nothing visible is drawn are not read. Blocks are as large as the budget allows;
//! neighbouring blocks share chunks.
//!
//! Pieces are cut at tiles and at sheets, so the picture is bit for bit the one that a single piece gives.
//!
//! Sources of samples are the layers, and after them the fields that colour layers, in the order of the layers. All are
//! held for the same slabs, each on samples and chunks of its own.

use std::ops::Range;

use crate::ray::state::TileState;
use crate::render::plan::{FamilyPlan, Plan};
use crate::render::tile::{TileJob, n_tiles};
use crate::sheet::spacing::SheetSpacing;
use crate::sheet::tile_layout::{BLOCK_V, Chunk, TILE_U, TILE_V};
use crate::source::slices::{Slices, needed_samples};
use wavesplat_compute::parallel;
use wavesplat_compute::simd::LANES;
use wavesplat_core::{Error, Result};

/// A box of samples: ranges along x, y, z.
pub type IndexBox = [Range<usize>; 3];

/// Storage layout of the samples of a source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Storage {
    /// Size of a chunk, which is read at once: samples along x, y, z.
    pub chunk: [usize; 3],
    /// Bytes of a sample.
    pub sample_bytes: usize,
}

/// A part of a base plane that is drawn front to back on its own.
#[derive(Clone, Debug)]
pub struct StreamBlock {
    /// Number of the base plane.
    pub family: usize,
    /// Ranges of the tiles along u and along v.
    pub tiles: [Range<usize>; 2],
    /// Steps, drawn one after the other.
    pub steps: Vec<StreamStep>,
    /// Numbers of the steps that begin a segment of the rays; at least the first step.
    pub segment_starts: Vec<usize>,
    /// Per tile, row by row: chunks of rays that may see something, as bits ([`Chunk::index`]).
    seen: Vec<u128>,
}

/// A step of a block: consecutive slabs, and the samples they are drawn from.
#[derive(Clone, Debug)]
pub struct StreamStep {
    /// Spaces between two sheets, counted in the order in which rays meet them.
    pub slabs: Range<usize>,
    /// Per source: box of samples in memory, from which the slabs are drawn.
    pub held: Vec<IndexBox>,
    /// Per source: parts of `held` that the step before did not hold; some need not be read ([`StreamPlan::reads`]).
    pub new: Vec<Vec<IndexBox>>,
    /// Per source: end of the slabs that can be drawn from `held`, including slabs of later steps.
    pub served: Vec<usize>,
}

/// Plan of a stream: the blocks of all base planes, and their reads.
#[derive(Clone, Debug)]
pub struct StreamPlan {
    /// Blocks, in the order in which they are best drawn.
    pub blocks: Vec<StreamBlock>,
    storage: Vec<Storage>,
}

/// Slices of a step, approximately, where chunks are thinner and the budget allows it.
const MIN_DEPTH: usize = 32;

impl StreamBlock {
    /// Whether any ray of the block's `k`th tile can still change after `state`.
    pub fn is_alive(&self, k: usize, state: Option<&TileState>) -> bool {
        let done = state.filter(|state| !state.done.is_empty());
        let is_open = |chunk: usize| !done.is_some_and(|state| state.done[chunk]);
        (0..Chunk::N).any(|chunk| self.seen[k] >> chunk & 1 == 1 && is_open(chunk))
    }

    /// Tiles of the block, row by row.
    pub fn all_tiles(&self) -> Vec<[usize; 2]> {
        let [us, vs] = self.tiles.clone();
        vs.flat_map(|v| us.clone().map(move |u| [u, v])).collect()
    }

    /// Largest number of bytes of samples in memory: samples of a step, and samples that the next step reads meanwhile.
    pub fn peak_bytes(&self, storage: &[Storage]) -> usize {
        let bytes = |boxes: &[IndexBox]| {
            let each = boxes.iter().zip(storage).map(|(held, own)| volume_of(held) * own.sample_bytes);
            each.sum::<usize>()
        };
        let held: Vec<usize> = self.steps.iter().map(|step| bytes(&step.held)).collect();
        let pairs = held.windows(2).map(|pair| pair[0] + pair[1]).max();
        pairs.or(held.first().copied()).unwrap_or(0)
    }
}

impl StreamPlan {
    /// Plans the stream of a frame. `slices` and `storage`: per source. At most `budget_bytes` of samples are in memory
    /// at once. `n_blocks`: least number of blocks of each base plane, if it has that many tiles. `segment_slices`:
    /// length of a segment in slices; no step crosses the end of a segment.
    pub fn new(
        plan: &Plan,
        slices: &[&Slices],
        storage: &[Storage],
        budget_bytes: usize,
        n_blocks: usize,
        segment_slices: Option<usize>,
    ) -> Result<Self> {
        let mut blocks = Vec::new();
        for (k, family) in plan.families.iter().enumerate() {
            let job = TileJob::new(plan, family, slices);
            let reader = Reader::new(plan, family, &job, storage, segment_slices);
            reader.cut(k, n_blocks, budget_bytes, &mut blocks)?;
        }
        Ok(Self { blocks, storage: storage.to_vec() })
    }

    /// Smallest budget that [`StreamPlan::new`] accepts, bytes.
    pub fn smallest_budget(
        plan: &Plan,
        slices: &[&Slices],
        storage: &[Storage],
        segment_slices: Option<usize>,
    ) -> usize {
        let of_family = |family| {
            let job = TileJob::new(plan, family, slices);
            Reader::new(plan, family, &job, storage, segment_slices).smallest()
        };
        plan.families.iter().map(of_family).max().unwrap_or(0)
    }

    /// Ranges of steps, one per segment of a block.
    pub fn segments(&self, block: usize) -> Vec<Range<usize>> {
        let StreamBlock { steps, segment_starts: starts, .. } = &self.blocks[block];
        let ends = starts.iter().skip(1).copied().chain([steps.len()]);
        starts.iter().zip(ends).map(|(from, to)| *from..to).collect()
    }

    /// Boxes of a source that a step of a block reads: the chunks of its new samples (of all held ones, if it
    /// `is_first`) from which something visible is drawn. `states`: of the tiles of the block; tiles whose rays are all
    /// done need no samples.
    #[expect(clippy::too_many_arguments, reason = "the plan, and which step of it")]
    pub fn reads(
        &self,
        plan: &Plan,
        slices: &[&Slices],
        block: usize,
        step: usize,
        source: usize,
        is_first: bool,
        states: &[Option<TileState>],
    ) -> Vec<IndexBox> {
        let block = &self.blocks[block];
        let family = &plan.families[block.family];
        let job = TileJob::new(plan, family, slices);
        let reader = Reader { plan, family, job: &job, storage: &self.storage, segment_slices: None, seen: Vec::new() };
        let is_alive = |k: usize| block.is_alive(k, states.get(k).and_then(Option::as_ref));
        let Some(tiles) = hull_of(block.all_tiles().into_iter().enumerate().filter(|(k, _)| is_alive(*k))) else {
            return Vec::new();
        };
        let slabs = block.steps[step].slabs.start..block.steps[step].served[source];
        let needed = reader.needed(&tiles, &slabs, source);
        let margin = reader.margins(&tiles, &slabs, source);
        let chunk = self.storage[source].chunk;
        let is_read = |part: &IndexBox| {
            let is_needed = (0..3).all(|a| part[a].end > needed[a].start && part[a].start < needed[a].end);
            is_needed && reader.may_show(part, margin, source)
        };
        let StreamStep { held, new, .. } = &block.steps[step];
        let new = if is_first { std::slice::from_ref(&held[source]) } else { &new[source][..] };
        new.iter().flat_map(|part| runs_of_chunks(part, chunk, &is_read)).collect()
    }

    /// Storage layout of the samples of each source.
    pub fn storage(&self) -> &[Storage] {
        &self.storage
    }

    /// Number of samples of a source that all steps would read if everything were visible.
    pub fn n_samples(&self, source: usize) -> usize {
        let steps = self.blocks.iter().flat_map(|block| &block.steps);
        steps.flat_map(|step| &step.new[source]).map(volume_of).sum()
    }
}

/// Number of samples of a box.
pub fn volume_of(part: &IndexBox) -> usize {
    part.iter().map(ExactSizeIterator::len).product()
}

/// Bounding rectangle of tiles; `None` where there are none.
fn hull_of(tiles: impl Iterator<Item = (usize, [usize; 2])>) -> Option<[Range<usize>; 2]> {
    tiles.fold(None, |hull: Option<[Range<usize>; 2]>, (_, tile)| {
        Some(match hull {
            None => tile.map(|t| t..t + 1),
            Some(all) => [0, 1].map(|a| all[a].start.min(tile[a])..all[a].end.max(tile[a] + 1)),
        })
    })
}

/// Chunks of a box that pass a test, merged along x, then along y.
fn runs_of_chunks(part: &IndexBox, chunk: [usize; 3], test: &impl Fn(&IndexBox) -> bool) -> Vec<IndexBox> {
    let cells = |a: usize| {
        let range = part[a].clone();
        (range.start / chunk[a]..range.end.div_ceil(chunk[a]))
            .map(move |k| range.start.max(k * chunk[a])..range.end.min((k + 1) * chunk[a]))
    };
    let mut runs: Vec<IndexBox> = Vec::new();
    for z in cells(2) {
        for y in cells(1) {
            let mut run: Option<Range<usize>> = None;
            for x in cells(0) {
                let passes = test(&[x.clone(), y.clone(), z.clone()]);
                match &mut run {
                    Some(run) if passes => run.end = x.end,
                    None if passes => run = Some(x),
                    _ => runs.extend(run.take().map(|run| [run, y.clone(), z.clone()])),
                }
            }
            runs.extend(run.map(|run| [run, y.clone(), z.clone()]));
        }
    }
    merged(runs, 1)
}

/// Merges boxes that adjoin along an axis and are equal along the others. Looks back at 64 boxes at most, so that the
/// time stays linear.
fn merged(boxes: Vec<IndexBox>, axis: usize) -> Vec<IndexBox> {
    let mut out: Vec<IndexBox> = Vec::new();
    for part in boxes {
        let fits = |before: &IndexBox| {
            before[axis].end == part[axis].start && (0..3).all(|a| a == axis || before[a] == part[a])
        };
        match out.iter_mut().rev().take(64).find(|before| fits(before)) {
            Some(before) => before[axis].end = part[axis].end,
            None => out.push(part),
        }
    }
    out
}

/// Reader of a base plane: cuts it into blocks and steps, by the samples that they need.
struct Reader<'a> {
    plan: &'a Plan,
    family: &'a FamilyPlan,
    job: &'a TileJob<'a>,
    storage: &'a [Storage],
    segment_slices: Option<usize>,
    /// Per tile of the base plane, row by row: chunks of rays that may see something.
    seen: Vec<u128>,
}

impl<'a> Reader<'a> {
    fn new(
        plan: &'a Plan,
        family: &'a FamilyPlan,
        job: &'a TileJob<'a>,
        storage: &'a [Storage],
        segment_slices: Option<usize>,
    ) -> Self {
        let [n_u, n_v] = n_tiles(&family.plane);
        let seen = parallel::map(n_u * n_v, |k| job.chunks_that_see([k % n_u * TILE_U, k / n_u * TILE_V]));
        Self { plan, family, job, storage, segment_slices, seen }
    }

    fn spacing(&self) -> &SheetSpacing {
        &self.family.spacing
    }

    /// Cuts the base plane into blocks whose samples fit the budget.
    fn cut(&self, family: usize, n_blocks: usize, budget: usize, blocks: &mut Vec<StreamBlock>) -> Result<()> {
        let n = n_tiles(&self.family.plane);
        let mut cuts = [1, 1];
        while cuts[0] * cuts[1] < n_blocks.min(n[0] * n[1]) {
            Self::cut_once_more(&mut cuts, n, 1.0);
        }
        let chunk = self.storage[0].chunk[self.family.plane.family.axes[2]];
        // Whole layers of chunks, several where they are thin.
        let mut depth = if chunk >= MIN_DEPTH { chunk } else { MIN_DEPTH / chunk * chunk };
        let mut smallest = None;
        loop {
            let made = self.blocks(family, cuts, n, depth);
            let most = made.iter().map(|block| block.peak_bytes(self.storage)).max().unwrap_or(0);
            if most <= budget {
                blocks.extend(made);
                return Ok(());
            }
            let least = *smallest.get_or_insert_with(|| self.smallest());
            if least > budget {
                let mend = "give more memory, or store the samples in smaller chunks";
                let [needed_mib, limit_mib] = [least, budget].map(|bytes| bytes.div_ceil(1 << 20) as u64);
                return Err(Error::TooLarge { what: "the samples of the smallest step", needed_mib, limit_mib, mend });
            }
            // In this order: smaller blocks, while they are larger than the margin that chunks and shear add to them;
            // fewer layers of chunks; still smaller blocks; at last parts of layers, which are then read several times.
            let is_small = (0..2).all(|a| cuts[a] >= n[a].div_ceil(SMALL_BLOCK[a]));
            if depth > chunk && is_small {
                depth = (depth / 2 / chunk).max(1) * chunk;
            } else if cuts == n {
                depth = (depth / 2).max(1);
            } else {
                Self::cut_once_more(&mut cuts, n, most as f64 / budget as f64);
            }
        }
    }

    /// Bytes of samples that the smallest blocks need with the thinnest steps.
    fn smallest(&self) -> usize {
        let n = n_tiles(&self.family.plane);
        let blocks = self.blocks(0, n, n, 1);
        blocks.iter().map(|block| block.peak_bytes(self.storage)).max().unwrap_or(0)
    }

    /// Cuts the blocks into more parts along v, or along u if they are more than twice as long there, so that rows of
    /// samples stay long. `ratio`: bytes that the blocks need by bytes of the budget.
    fn cut_once_more(cuts: &mut [usize; 2], n: [usize; 2], ratio: f64) {
        let length = [n[0] * TILE_U / cuts[0], n[1] * TILE_V / cuts[1]];
        let axis = usize::from(2 * length[1] >= length[0] && cuts[1] < n[1] || cuts[0] >= n[0]);
        let more = (cuts[axis] as f64 * (0.25 * (ratio - 1.0)).clamp(0.0, 1.0)) as usize;
        cuts[axis] = (cuts[axis] + more.max(1)).min(n[axis]);
    }

    fn blocks(&self, family: usize, cuts: [usize; 2], n: [usize; 2], depth: usize) -> Vec<StreamBlock> {
        let part = |k: usize, a: usize| k * n[a] / cuts[a]..(k + 1) * n[a] / cuts[a];
        let made = parallel::map(cuts[0] * cuts[1], |k| {
            let all = [part(k % cuts[0], 0), part(k / cuts[0], 1)];
            let within = all[1].clone().flat_map(|v| all[0].clone().map(move |u| [u, v]));
            let seen = within.filter(|[u, v]| self.seen[v * n[0] + u] != 0).enumerate();
            let tiles = hull_of(seen)?;
            let (steps, segment_starts) = self.steps(&tiles, depth);
            let seen = tiles[1].clone().flat_map(|v| tiles[0].clone().map(move |u| self.seen[v * n[0] + u]));
            let block = StreamBlock { family, seen: seen.collect(), tiles: tiles.clone(), steps, segment_starts };
            (!block.steps.is_empty()).then_some(block)
        });
        made.into_iter().flatten().collect()
    }

    /// Steps of a block, and the numbers of those that begin a segment. A step ends where a layer of chunks of the
    /// first layer (`depth` slices) or a segment ends.
    fn steps(&self, tiles: &[Range<usize>; 2], depth: usize) -> (Vec<StreamStep>, Vec<usize>) {
        let all = self.drawn_slabs();
        let axis = self.family.plane.family.axes[2];
        let (per_step, size) = (depth, self.plan.layers[0].grid.size()[axis]);
        // A step ends with the last slab whose samples of the first layer lie before the end of a layer of chunks.
        let (_, per_w) = self.plan.layers[0].map[axis];
        let ascends = self.family.plane.family.ascending == (per_w > 0.0);
        let mut steps: Vec<StreamStep> = Vec::new();
        let mut starts = vec![0];
        let mut start = all.start;
        while start < all.end {
            let segment_end = self.segment_end(start, all.end);
            let first = self.needed(tiles, &(start..start + 1), 0)[axis].clone();
            let limit = if ascends {
                (first.end.div_ceil(per_step) * per_step).min(size)
            } else {
                first.start / per_step * per_step
            };
            let fits = |own: &Range<usize>| if ascends { own.end <= limit } else { own.start >= limit };
            let mut end = start + 1;
            // The needed samples only move on along the rays, so the last slab that fits is found by bisection.
            let mut beyond = segment_end + 1;
            while beyond - end > 1 {
                let middle = usize::midpoint(end, beyond);
                let own = &self.needed(tiles, &(middle - 1..middle), 0)[axis];
                if fits(own) { end = middle } else { beyond = middle }
            }
            let slabs = start..end;
            let (held, served): (Vec<IndexBox>, Vec<usize>) =
                (0..self.storage.len()).map(|source| self.held(tiles, &slabs, &all, source, per_step)).unzip();
            let before = steps.last().map(|step| &step.held);
            let new = held
                .iter()
                .enumerate()
                .map(|(source, held)| {
                    before.map_or(vec![held.clone()], |before| beyond_along(axis, held, &before[source]))
                })
                .collect();
            steps.push(StreamStep { slabs, held, new, served });
            start = end;
            if start == segment_end && start < all.end {
                starts.push(steps.len());
            }
        }
        (steps, starts)
    }

    /// End of the segment that a slab belongs to. Segments begin at the sheets of every `segment_slices`th slice of the
    /// frame, counted from the first one, from whichever side rays come.
    fn segment_end(&self, slab: usize, end: usize) -> usize {
        let Some(slices) = self.segment_slices else { return end };
        let spacing = self.spacing();
        let per_slice = 1.0 / spacing.step;
        let sheet =
            |segment: usize| (((segment * slices.max(1)) as f64 * per_slice).round() as usize).min(spacing.n_slabs);
        let ascending = self.family.plane.family.ascending;
        // The sheet in front of the slab, and so the segment that it lies in.
        let place = if ascending { slab } else { spacing.n_slabs - slab };
        let mut segment = (place as f64 * spacing.step / slices.max(1) as f64) as usize + 2;
        if ascending {
            while segment > 0 && sheet(segment - 1) > place {
                segment -= 1;
            }
            sheet(segment).min(end)
        } else {
            while segment > 0 && sheet(segment) >= place {
                segment -= 1;
            }
            (spacing.n_slabs - sheet(segment)).min(end)
        }
    }

    /// Range of the slabs in which rays may meet the drawn region.
    fn drawn_slabs(&self) -> Range<usize> {
        let spacing = self.spacing();
        let axis = self.family.plane.family.axes[2];
        let [mut lo, mut hi] = self.plan.region.bounds;
        if let Some(own) = &self.plan.part {
            (lo, hi) = (lo.max(own.part.lo), hi.min(own.part.hi));
        }
        let sheets = spacing.range([lo[axis].max(0.0), hi[axis]]);
        if sheets.len() < 2 {
            return 0..0;
        }
        let (first, last) = (sheets.start, sheets.end - 1);
        if self.family.plane.family.ascending { first..last } else { spacing.n_slabs - last..spacing.n_slabs - first }
    }

    /// Box of the samples of a source that slabs need.
    fn needed(&self, tiles: &[Range<usize>; 2], slabs: &Range<usize>, source: usize) -> IndexBox {
        let geometry = self.job.source(source);
        let [from, to] = texels_of(tiles);
        let reached = geometry.reached(from, to, self.ends(slabs));
        needed_samples(&reached, geometry.slices.grid(), geometry.slices.kernel())
    }

    /// Box of the samples of a source that a step holds, and the end of the slabs that it serves. Along w it is rounded
    /// to whole layers of the source's own chunks, or to `per_step` slices of the first layer where these are fewer;
    /// across w it holds what all slabs need that are drawn from these slices.
    fn held(
        &self,
        tiles: &[Range<usize>; 2],
        slabs: &Range<usize>,
        all: &Range<usize>,
        source: usize,
        per_step: usize,
    ) -> (IndexBox, usize) {
        let axis = self.family.plane.family.axes[2];
        let own = self.needed(tiles, slabs, source)[axis].clone();
        let size = self.job.source(source).slices.grid().size()[axis];
        // A source may run the other way along w than the first layer, and have other steps.
        let per_w = self.plan.map_of_source(source)[axis].1;
        let chunk = self.storage[source].chunk[axis];
        let slices = (per_step as f64 * (per_w / self.plan.layers[0].map[axis].1).abs()) as usize;
        let depth = if slices >= chunk { slices / chunk * chunk } else { slices.max(1) };
        let along = if self.family.plane.family.ascending == (per_w > 0.0) {
            own.start..(own.end.div_ceil(depth) * depth).min(size)
        } else {
            own.start / depth * depth..own.end
        };
        let mut end = slabs.end;
        while end < all.end {
            let next = &self.needed(tiles, &(end..end + 1), source)[axis];
            if next.start >= along.end || next.end <= along.start {
                break;
            }
            end += 1;
        }
        let mut held = self.needed(tiles, &(slabs.start..end), source);
        held[axis] = along;
        (held, end)
    }

    /// Whether something that samples of a box are needed for may be visible. `margin`: from [`Reader::margins`].
    fn may_show(&self, part: &IndexBox, margin: [usize; 3], source: usize) -> bool {
        let layer = self.plan.layer_of_source(source);
        let Some(occupied) = &self.family.layers[layer].occupancy else { return true };
        let around = [0, 1, 2].map(|a| [part[a].start.saturating_sub(margin[a]), part[a].end + margin[a]]);
        let (own, of_layer) = (self.plan.map_of_source(source), self.plan.map_of_source(layer));
        let last = self.plan.layers[layer].grid.size().map(|n| n.saturating_sub(2) / occupied.side());
        let [us, vs, ws] = self.family.plane.family.axes.map(|a| {
            let ends = around[a].map(|at| along(of_layer[a], (at as f64 - own[a].0) / own[a].1));
            // Positions between samples belong to the cells on both sides.
            let ends = [ends[0].min(ends[1]).floor(), ends[0].max(ends[1]).ceil()];
            ends.map(|at| (at.max(0.0) as usize / occupied.side()).min(last[a]))
        });
        occupied.any(us, vs, ws)
    }

    /// Margin around an occupied brick that holds all samples needed to draw it, along x, y, z: the extent of a block,
    /// the shear of a slab, the footprint, and the samples that densities are computed from.
    fn margins(&self, tiles: &[Range<usize>; 2], slabs: &Range<usize>, source: usize) -> [usize; 3] {
        let geometry = self.job.source(source);
        let [from, to] = texels_of(tiles);
        let ends = self.ends(slabs);
        let n_slabs = slabs.len().max(1) as f64;
        let block = [LANES, BLOCK_V];
        let mut margins = [0; 3];
        for k in 0..2 {
            let [(a, da), (b, db)] = ends.map(|w| geometry.sheet(w).0[k]);
            let at = |i: usize| (b + db * i as f64 - a - da * i as f64).abs() / n_slabs;
            let shear = at(from[k]).max(at(to[k]));
            let texels = da.abs().max(db.abs()) * block[k] as f64;
            margins[self.family.plane.family.axes[k]] = (texels + shear).ceil() as usize;
        }
        let axis = self.family.plane.family.axes[2];
        let [a, b] = ends.map(|w| geometry.own_w(w));
        margins[axis] = ((b - a).abs() / n_slabs).ceil() as usize + 1;
        // The reach of a footprint, and the samples that the density or coefficient of a single one is computed from.
        let middle = geometry.slices.grid().size().map(|n| n / 2);
        let here = middle.map(|m| m..m + 1);
        let reach = geometry.reach();
        let wide = needed_samples(&here, geometry.slices.grid(), geometry.slices.kernel());
        [0, 1, 2].map(|a| margins[a] + reach + wide[a].len())
    }

    /// Positions along w of the first and the last sheet of slabs.
    fn ends(&self, slabs: &Range<usize>) -> [f64; 2] {
        let spacing = self.spacing();
        [slabs.start, slabs.end].map(|k| {
            let k = k.min(spacing.n_slabs);
            spacing.w(if self.family.plane.family.ascending { k } else { spacing.n_slabs - k })
        })
    }
}

/// Tiles along u and v of a block that is not cut further before steps get thinner.
const SMALL_BLOCK: [usize; 2] = [8, 16];

/// Position among a source's samples, along one axis, of a position of the frame.
fn along((origin, per_step): (f64, f64), at: f64) -> f64 {
    origin + per_step * at
}

/// First and last texel of a rectangle of tiles.
fn texels_of(tiles: &[Range<usize>; 2]) -> [[usize; 2]; 2] {
    let [us, vs] = tiles;
    [[us.start * TILE_U, vs.start * TILE_V], [us.end * TILE_U - 1, vs.end * TILE_V - 1]]
}

/// Parts of a box that lie beyond another along an axis. Across that axis the other box has all that is needed: it
/// holds what any later slab needs of its slices ([`StreamStep::served`]).
fn beyond_along(axis: usize, whole: &IndexBox, before: &IndexBox) -> Vec<IndexBox> {
    let (own, held) = (whole[axis].clone(), before[axis].clone());
    let parts = [own.start..own.end.min(held.start), own.start.max(held.end)..own.end];
    let along = |range: Range<usize>| {
        let mut part = whole.clone();
        part[axis] = range;
        part
    };
    parts.into_iter().filter(|range| range.start < range.end).map(along).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_new_lies_beyond_what_is_held() {
        let whole = [0..10, 2..8, 3..9];
        assert_eq!(beyond_along(2, &whole, &[5..20, 0..9, 0..5]), vec![[0..10, 2..8, 5..9]]);
        assert_eq!(beyond_along(0, &whole, &[7..20, 0..9, 0..5]), vec![[0..7, 2..8, 3..9]]);
        assert_eq!(beyond_along(1, &whole, &[0..1, 3..4, 0..1]), vec![[0..10, 2..3, 3..9], [0..10, 4..8, 3..9]]);
        assert!(beyond_along(1, &whole, &[0..1, 0..8, 0..1]).is_empty());
    }

    #[test]
    fn chunks_that_pass_are_put_together() {
        let part = [3..40, 0..20, 5..6];
        let all = runs_of_chunks(&part, [8, 8, 8], &|_| true);
        assert_eq!(all, vec![part.clone()]);
        let some = runs_of_chunks(&part, [8, 8, 8], &|own| own[0].start >= 16 || own[1].start >= 16);
        let n: usize = some.iter().map(volume_of).sum();
        assert_eq!(n, 24 * 16 + 37 * 4);
        assert!(some.len() == 2, "{some:?}");
    }
}
