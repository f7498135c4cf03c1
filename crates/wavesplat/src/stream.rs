//! A frame whose samples are read while it is drawn, step by step ([`wavesplat_splat::render::stream`]).
//!
//! The caller reads the samples: files, networks and other processes are none of this crate's business. Blocks are
//! independent, so that several machines can share a frame, and may be cut into segments that are folded afterwards.

use std::ops::Range;
use std::sync::Mutex;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::Level;
use wavesplat_core::{Camera, Error, Kernel, Picture, Result, Samples};
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::quality::ladder::Sampling;
use wavesplat_splat::ray::state::TileState;
use wavesplat_splat::render::frame::finish;
use wavesplat_splat::render::part_plan::PartPlan;
use wavesplat_splat::render::piece::{draw_piece, finish_tile, unseen_picture};
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::render::segments::{can_fold, fold};
use wavesplat_splat::render::stream::{IndexBox, Storage, StreamPlan, volume_of};
use wavesplat_splat::render::tile::n_tiles;
use wavesplat_splat::sheet::tile_layout::{TILE_U, TILE_V};
use wavesplat_splat::source::slices::{Slices, VolumeBox};
use wavesplat_splat::view::part::Part;
use wavesplat_splat::{ProgressCallback, Report};

use crate::block_state::BlockState;
use crate::device::{Device, DrawnBy};
use crate::frame::{Frame, FrameOptions};
use crate::quality::Effort;
use crate::scene::{Scene, SceneVolume};

/// Options of a streamed frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamOptions {
    /// Budget for samples in bytes: for a step, and for the next one, which is read meanwhile.
    pub budget_bytes: usize,
    /// Minimum number of blocks in each base plane, one for each machine that takes part.
    pub n_blocks: usize,
    /// Slices per segment, counted from the first slice; rays are composited segment by segment, and the segments
    /// folded afterwards. `None`: from front to back in one go. Both are right; they differ in where rays stop, by 2e-4
    /// of full light at most.
    pub segment_slices: Option<usize>,
    /// Part of space that is drawn, where processes hold a part of the samples each; `None`: all.
    pub part: Option<Part>,
}

impl Default for StreamOptions {
    fn default() -> Self {
        Self { budget_bytes: 1 << 30, n_blocks: 1, segment_slices: None, part: None }
    }
}

/// A planned frame, and its base planes as far as they are drawn.
pub struct Stream {
    plan: Plan,
    steps: StreamPlan,
    slices: Vec<Slices<'static>>,
    sampling: Sampling,
    segment_slices: Option<usize>,
    n_threads: Option<usize>,
    pictures: Vec<BasePicture>,
    report: Report,
    drawn_by: DrawnBy,
}

impl Scene<'static> {
    /// Plans a frame of lazy volumes.
    ///
    /// # Errors
    ///
    /// The errors of [`Scene::render`]; and where a layer, or a field that colours one, is not lazy, a PSNR is wanted, rays cannot be cut into
    /// segments, or the budget is too small for the smallest step.
    pub fn stream(
        &self,
        camera: &Camera,
        size_px: [usize; 2],
        options: &FrameOptions,
        streaming: &StreamOptions,
    ) -> Result<Stream> {
        let Planned { plan, slices, storage, sampling } = self.planned(camera, size_px, options, streaming)?;
        let of_slices: Vec<&Slices> = slices.iter().collect();
        let StreamOptions { budget_bytes, n_blocks, segment_slices, .. } = *streaming;
        let cut = || StreamPlan::new(&plan, &of_slices, &storage, budget_bytes, n_blocks, segment_slices);
        let steps = parallel::with_threads(options.n_threads, cut)?;
        let pictures = (0..plan.families.len()).map(|family| unseen_picture(&plan, family)).collect();
        let reason = "what is read as it is drawn is drawn by the CPU";
        let drawn_by = DrawnBy::cpu((options.device != Device::Cpu).then(|| reason.to_owned()));
        let report = parallel::with_threads(options.n_threads, || Report::of(&plan));
        let n_threads = options.n_threads;
        Ok(Stream { plan, steps, slices, sampling, segment_slices, n_threads, pictures, report, drawn_by })
    }

    /// Smallest [`StreamOptions::budget_bytes`] that [`Scene::stream`] accepts.
    ///
    /// # Errors
    ///
    /// The errors of [`Scene::stream`], but for the budget.
    pub fn smallest_budget(
        &self,
        camera: &Camera,
        size_px: [usize; 2],
        options: &FrameOptions,
        streaming: &StreamOptions,
    ) -> Result<usize> {
        let Planned { plan, slices, storage, .. } = self.planned(camera, size_px, options, streaming)?;
        let of_slices: Vec<&Slices> = slices.iter().collect();
        let least = || StreamPlan::smallest_budget(&plan, &of_slices, &storage, streaming.segment_slices);
        Ok(parallel::with_threads(options.n_threads, least))
    }

    /// Plan of a stream, without its schedule of reads.
    fn planned(
        &self,
        camera: &Camera,
        size_px: [usize; 2],
        options: &FrameOptions,
        streaming: &StreamOptions,
    ) -> Result<Planned> {
        let sampling = match options.effort {
            Effort::Named(quality) => self.sampling(quality.name(), options.composite, camera, size_px[1])?,
            Effort::Fixed(sampling) => sampling,
            Effort::Psnr(_) => {
                let mend = "give a named quality, or how many sheets and texels there are";
                return Err(Error::out_of_range("effort of a streamed picture", "a PSNR", "a sampling", mend));
            }
        };
        let render_options = self.render_options(size_px, options, Some(sampling));
        render_options.validate()?;
        let mut storage = Vec::new();
        for volume in self.sources() {
            let SceneVolume::Lazy(volume) = volume else {
                let mend = "make all layers, and the fields that colour them, lazy, or none";
                return Err(Error::out_of_range("layers of a streamed picture", "one in memory", "lazy volumes", mend));
            };
            storage.push(volume.storage());
        }
        let slices: Vec<Slices<'static>> = self.sources().map(|volume| volume.slices(options.kernel)).collect();
        if slices.iter().any(|own| own.kernel() != options.kernel) {
            let mend = "look through the samples for the kernel that they are drawn with";
            return Err(Error::out_of_range("kernel of a lazy volume", "another one", "the picture's", mend));
        }
        let (of_layers, of_colors) = slices.split_at(self.layers.len());
        let mut of_colors = of_colors.iter().cloned();
        let colors: Vec<_> = self.layers.iter().map(|layer| layer.color.as_ref().and(of_colors.next())).collect();
        let plan = parallel::with_threads(options.n_threads, || {
            self.with_layers(options, of_layers, &colors, |layers| {
                Plan::new(Level::best(), layers, camera, &render_options)
            })
        })?;
        let plan = if streaming.segment_slices.is_some() { plan.without_even_cuts() } else { plan };
        let of_whole = |part| PartPlan::new(part, slices[0].clone(), plan.layers[0].tables.clone());
        let part = streaming.part.map(of_whole);
        let plan = Plan { part, ..plan };
        let is_cut = streaming.segment_slices.is_some() || streaming.part.is_some();
        if is_cut && !can_fold(&plan) {
            let mend = "draw it without segments and parts, or without depth, surfaces, lines and points";
            return Err(Error::out_of_range("segments of rays of this operator", "several", "one", mend));
        }
        Ok(Planned { plan, slices, storage, sampling })
    }
}

/// Plan of a streamed frame, and storage of its samples.
struct Planned {
    plan: Plan,
    slices: Vec<Slices<'static>>,
    storage: Vec<Storage>,
    sampling: Sampling,
}

impl Stream {
    /// Number of sources of samples: layers, and after them the fields that colour layers, in the order of these.
    pub fn n_sources(&self) -> usize {
        self.slices.len()
    }

    /// Number of blocks.
    pub fn n_blocks(&self) -> usize {
        self.steps.blocks.len()
    }

    /// Number of steps of a block.
    pub fn n_steps(&self, block: usize) -> usize {
        self.steps.blocks[block].steps.len()
    }

    /// Steps of each segment of a block, front to back; one range of all steps without segments.
    pub fn segments(&self, block: usize) -> Vec<Range<usize>> {
        self.steps.segments(block)
    }

    /// Slices per segment, where rays are cut into segments.
    pub fn segment_slices(&self) -> Option<usize> {
        self.segment_slices
    }

    /// Box of samples that a step of a block is drawn from, per source.
    pub fn held(&self, block: usize, step: usize) -> &[IndexBox] {
        &self.steps.blocks[block].steps[step].held
    }

    /// Boxes of samples that a step of a block reads, per source: those that show something and that the step before did
    /// not hold (all that show something, where it `is_first`). `state`: state of the rays; rays that are done need
    /// nothing.
    pub fn reads(&self, block: usize, step: usize, is_first: bool, state: &BlockState) -> Vec<Vec<IndexBox>> {
        let slices: Vec<&Slices> = self.slices.iter().collect();
        let reads = |source| self.steps.reads(&self.plan, &slices, block, step, source, is_first, &state.tiles);
        (0..slices.len()).map(reads).collect()
    }

    /// Whether all rays of a block are done after a state.
    pub fn is_done(&self, block: usize, state: &BlockState) -> bool {
        let own = &self.steps.blocks[block];
        let is_alive = |k: usize| own.is_alive(k, state.tiles.get(k).and_then(Option::as_ref));
        !(0..own.tiles.iter().map(ExactSizeIterator::len).product()).any(is_alive)
    }

    /// Bytes that each block reads if no ray ends early.
    pub fn bytes_to_read(&self) -> Vec<u64> {
        let nothing = BlockState::default();
        let of_step = |block: usize, step: usize| {
            let reads = self.reads(block, step, step == 0, &nothing);
            let bytes = reads.iter().zip(self.steps.storage()).map(|(boxes, own)| {
                let n: usize = boxes.iter().map(volume_of).sum();
                (n * own.sample_bytes) as u64
            });
            bytes.sum::<u64>()
        };
        parallel::with_threads(self.n_threads, || {
            parallel::map(self.n_blocks(), |block| (0..self.n_steps(block)).map(|step| of_step(block, step)).sum())
        })
    }

    /// Number of boxes that all steps read if no ray ends early.
    pub fn n_boxes(&self) -> usize {
        let nothing = BlockState::default();
        let of_block = |block| {
            let of_step = |step| self.reads(block, step, step == 0, &nothing).iter().map(Vec::len).sum::<usize>();
            (0..self.n_steps(block)).map(of_step).sum::<usize>()
        };
        let n = || parallel::map(self.n_blocks(), of_block).into_iter().sum();
        parallel::with_threads(self.n_threads, n)
    }

    /// Number of rays of a block.
    pub fn n_rays(&self, block: usize) -> u64 {
        let tiles = &self.steps.blocks[block].tiles;
        (tiles.iter().map(ExactSizeIterator::len).product::<usize>() * TILE_U * TILE_V) as u64
    }

    /// Most bytes of samples that are held while a block is drawn.
    pub fn peak_sample_bytes(&self, block: usize) -> u64 {
        self.steps.blocks[block].peak_bytes(self.steps.storage()) as u64
    }

    /// Texels of a block over all slabs.
    pub fn n_texels(&self, block: usize) -> u64 {
        let own = &self.steps.blocks[block];
        let texels: usize = own.tiles.iter().map(ExactSizeIterator::len).product::<usize>() * TILE_U * TILE_V;
        own.steps.iter().map(|step| (texels * step.slabs.len()) as u64).sum()
    }

    /// Draws a step of a block from the samples of the boxes of [`Stream::held`], one array per source; samples that
    /// need not be read may have any value. Takes the state after the step before, at first the default, and returns
    /// the next.
    ///
    /// # Errors
    ///
    /// [`Error::SampleCount`] where a box has another size; [`Error::Cancelled`].
    pub fn draw(
        &self,
        block: usize,
        step: usize,
        samples: &[Samples<'_>],
        state: &BlockState,
        callback: &dyn ProgressCallback,
    ) -> Result<BlockState> {
        let own = &self.steps.blocks[block];
        let held = &own.steps[step].held;
        let boxes = held.iter().zip(samples).zip(&self.slices).map(|((held, samples), slices)| {
            let size = held.each_ref().map(Range::len);
            let expected = size.iter().product();
            if samples.len() != expected {
                let shape_zyx = [size[2], size[1], size[0]];
                let name = "box of samples".to_owned();
                return Err(Error::SampleCount { name, shape_zyx, expected, actual: samples.len() });
            }
            let part = VolumeBox { lo: held.each_ref().map(|r| r.start), size, samples: *samples };
            Ok(Slices::of_box(&part, slices.grid(), slices.kernel(), slices.range()))
        });
        parallel::with_threads(self.n_threads, || {
            let boxes = boxes.collect::<Result<Vec<_>>>()?;
            let slices: Vec<&Slices> = boxes.iter().collect();
            let slabs = &own.steps[step].slabs;
            let tiles = own.all_tiles();
            let drawn = draw_piece(&self.plan, own.family, &tiles, slabs, &slices, &state.tiles, callback);
            drawn.map(|(tiles, work)| BlockState { tiles, work: state.work.and(work) })
        })
    }

    /// State of a block after its segments, which are given front to back.
    pub fn fold(&self, segments: Vec<BlockState>) -> BlockState {
        let mut segments = segments.into_iter();
        let mut all = segments.next().unwrap_or_default();
        for behind in segments {
            let pairs = all.tiles.into_iter().zip(behind.tiles);
            let tiles = pairs.map(|(front, back)| fold(self.plan.operator, front, back)).collect();
            all = BlockState { tiles, work: all.work.and(behind.work) };
        }
        all
    }

    /// Number of base planes.
    pub fn n_planes(&self) -> usize {
        self.pictures.len()
    }

    /// Number of the base plane of a block, and the state of the block as one of all tiles of that plane. States of
    /// several parts of space have other blocks, and the same planes.
    pub fn plane_state(&self, block: usize, state: BlockState) -> (usize, BlockState) {
        let own = &self.steps.blocks[block];
        let [n_u, n_v] = n_tiles(&self.plan.families[own.family].plane);
        let mut tiles = vec![None; n_u * n_v];
        for ([u, v], state) in own.all_tiles().into_iter().zip(state.tiles) {
            tiles[v * n_u + u] = state;
        }
        (own.family, BlockState { tiles, work: state.work })
    }

    /// Puts the final state of a block into its base plane.
    pub fn put(&mut self, block: usize, state: BlockState) {
        let [us, vs] = self.steps.blocks[block].tiles.clone();
        let (plane, state) = self.plane_state(block, state);
        self.fill(plane, state, |[u, v], _| us.contains(&u) && vs.contains(&v));
    }

    /// Puts the final state of tiles of a base plane, row by row, into it; tiles that saw nothing stay.
    pub fn put_plane(&mut self, plane: usize, state: BlockState) {
        self.fill(plane, state, |_, state| state.is_some());
    }

    /// Puts the final state of those tiles of a base plane that pass a test.
    fn fill(
        &mut self,
        plane: usize,
        state: BlockState,
        is_put: impl Fn([usize; 2], Option<&TileState>) -> bool + Sync + Send,
    ) {
        let plan = &self.plan;
        let [n_tiles_u, _] = n_tiles(&plan.families[plane].plane);
        let states: Vec<Mutex<Option<TileState>>> = state.tiles.into_iter().map(Mutex::new).collect();
        self.pictures[plane].fill_tiles([TILE_U, TILE_V], |k, texels| {
            let tile = [k % n_tiles_u, k / n_tiles_u];
            let state = states.get(k).and_then(|state| state.lock().ok()?.take());
            if is_put(tile, state.as_ref()) {
                finish_tile(plan, plane, tile, state, texels);
            }
        });
        self.report.n_texels += state.work.n_texels;
        self.report.n_skipped_slabs += state.work.n_skipped;
    }

    /// Picture of all blocks that were put.
    pub fn picture(&self) -> Frame {
        let picture: Picture = parallel::with_threads(self.n_threads, || finish(&self.plan, &self.pictures));
        let (report, sampling, drawn_by) = (self.report.clone(), self.sampling, self.drawn_by.clone());
        Frame { picture, report, drawn_by, sampling, estimate: None, times: None }
    }

    /// Reconstruction kernel.
    pub fn kernel(&self) -> Kernel {
        self.slices[0].kernel()
    }
}
