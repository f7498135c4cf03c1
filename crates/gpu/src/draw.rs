//! A frame: base plane by base plane, band by band, range of slabs by range of slabs. The GPU's schedule over pieces.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Instant;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::LANES;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::plan::{FamilyPlan, Operator, Plan};
use wavesplat_splat::render::plan_arrays::BasePlaneArrays;
use wavesplat_splat::render::progress::ProgressCallback;
use wavesplat_splat::sheet::tile_layout::{BLOCK_V, N_BLOCKS_V, N_STRIPS, TILE_U, TILE_V};
use wavesplat_splat::source::slices::Slices;
use wgpu::{BindGroup, BufferUsages, CommandEncoderDescriptor, ComputePassDescriptor};

use crate::band::{Band, bands};
use crate::buffers::{Buffers, bind_group, read_buffer};
use crate::device::OpenDevice;
use crate::failure::{Failure, GpuResult};
use crate::layout::{N_BLOCK, NO_POSITION};
use crate::numbers::{Numbers, is_mean};
use crate::pages::{PagedRange, n_pages, page_side, pages_by_slab, ranges};
use crate::permutation::Permutation;
use crate::pipeline::Pipeline;
use crate::report::FrameCounts;
use crate::timer::Timer;
use crate::volumes::{GpuVolume, Volumes};

/// Target duration of a dispatch in seconds: systems reset a GPU that does not answer for about 2 s, and frames are
/// cancelled between dispatches. Rays meet more further in than where they begin, so that the next one may take longer.
const AIM_SECONDS: f64 = 0.02;

/// Largest ratio of the number of slabs of a dispatch to that number of the dispatch before.
const MAX_GROWTH: usize = 4;

/// Assumed rate of the first dispatch of a frame in texels of sheets per second, for a discrete GPU, for other GPUs and
/// for a software renderer: the rate of the frame before says little, since its rays may all have ended early. A GPU of
/// a fiftieth of the rate ends the first dispatch within 1 s, half of what systems allow; an H200 has twice the rate.
const FIRST_RATES: [f64; 3] = [5e9, 5e8, 1e6];

/// Partition of a frame into dispatches and pages; the picture does not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    /// Most slabs of a dispatch; `None`: adapted, so that a dispatch takes about a fiftieth of a second.
    pub most_slabs: Option<usize>,
    /// Skip slabs in which nothing is seen.
    pub skips: bool,
    /// Use pages even where all samples fit.
    pub is_paged: bool,
    /// Count fetches and texels, for [`crate::report::GpuReport::counted`].
    pub counts: bool,
}

impl Default for Schedule {
    fn default() -> Self {
        Self { most_slabs: None, skips: true, is_paged: false, counts: false }
    }
}

/// Pipelines, volumes and buffers kept between frames.
#[derive(Default)]
pub(crate) struct GpuCache {
    pub pipelines: HashMap<Permutation, Arc<Pipeline>>,
    /// Uploaded volumes.
    pub volumes: Volumes,
    pub buffers: Buffers,
}

/// Inputs of a frame.
pub(crate) struct FrameJob<'a> {
    pub device: &'a OpenDevice,
    pub plan: &'a Plan,
    /// Slices of each layer.
    pub slices: &'a [&'a Slices<'a>],
    pub permutation: &'a Permutation,
    pub pipeline: &'a Pipeline,
    pub volumes: &'a [Arc<GpuVolume>],
    /// Field of each source behind the layers; the first of four where they are stored side by side.
    pub fields: &'a [usize],
    pub schedule: Schedule,
}

impl FrameJob<'_> {
    /// Draws all base planes.
    pub fn draw_all(
        &self,
        work: &mut GpuCache,
        callback: &dyn ProgressCallback,
        counts: &mut FrameCounts,
    ) -> GpuResult<Vec<BasePicture>> {
        let n = self.plan.families.len() as f32;
        let mut pictures = Vec::new();
        for (k, family) in self.plan.families.iter().enumerate() {
            let arrays = BasePlaneArrays::new(self.plan, k, self.slices);
            let report = |done: f32| {
                let stopped = callback.progress((k as f32 + done) / n).is_break();
                if stopped { Err(Failure::Cancelled) } else { Ok(()) }
            };
            pictures.push(self.draw(family, &arrays, work, counts, &report)?);
        }
        Ok(pictures)
    }

    fn draw(
        &self,
        family: &FamilyPlan,
        arrays: &BasePlaneArrays,
        work: &mut GpuCache,
        counts: &mut FrameCounts,
        report: &dyn Fn(f32) -> GpuResult<()>,
    ) -> GpuResult<BasePicture> {
        let begun = Instant::now();
        let mut numbers = Numbers::new(self.plan, family, arrays, self.fields);
        for (source, volume) in numbers.sources.iter_mut().zip(self.volumes) {
            source.lies_in(volume.samples.size, volume.apron.low);
        }
        // Room for the tables of pages, which are written range by range.
        for (k, slices) in self.slices.iter().enumerate().filter(|(k, _)| self.volumes[*k].pages.is_some()) {
            let [x, y, z] = n_pages(slices.grid().size());
            numbers.sources[k].pages = [x, y, z, page_side(self.volumes[k].apron)].map(|n| n as u32);
            numbers.sources[k].apron[3] = numbers.words.len() as i32;
            numbers.words.resize(numbers.words.len() + x * y * z, 0);
        }
        let mut picture = BasePicture::new(family.plane.clone(), self.plan.with_depth);
        counts.base_texels += family.plane.size.iter().product::<usize>() as u64;
        let mut bands = bands(family, arrays, self.plan.layers.len(), self.schedule.skips);
        bands.reverse();
        counts.wall.prepare += begun.elapsed().as_secs_f64();
        let mut n_done = 0;
        while let Some(band) = bands.pop() {
            let n_all = n_done + bands.len() + 1;
            let of_band = |done: f32| report((n_done as f32 + done) / n_all as f32);
            let Some(ranges) = self.ranges(family, arrays, &band) else {
                // Half as many blocks reach fewer pages.
                let Some((first, second)) = band.halves() else {
                    return Err(Failure::Memory("too little memory is allowed for the pages of one block".to_owned()));
                };
                bands.extend([second, first]);
                continue;
            };
            let begun = Instant::now();
            self.draw_band(family, &numbers, &band, &ranges, work, counts, &of_band)?;
            counts.wall.march += begun.elapsed().as_secs_f64();
            let begun = Instant::now();
            self.read_back(&band, family, work, counts, &mut picture)?;
            counts.wall.read_back += begun.elapsed().as_secs_f64();
            n_done += 1;
        }
        Ok(picture)
    }

    /// Ranges of slabs whose pages fit; a single range where there are no pages, `None` where there is too little room.
    fn ranges(&self, family: &FamilyPlan, arrays: &BasePlaneArrays, band: &Band) -> Option<Vec<PagedRange>> {
        let slots: Option<Vec<usize>> =
            self.slices.iter().zip(self.volumes).map(|(_, volume)| Some(volume.pages()?.n_slots())).collect();
        let Some(slots) = slots else {
            return Some(vec![PagedRange { end: band.slabs[1], pages: Vec::new() }]);
        };
        let reached = parallel::map(slots.len(), |k| {
            pages_by_slab(family, arrays.layer(k), band, k, self.slices[k].grid().size())
        });
        ranges(&reached, band.slabs, &slots)
    }

    /// Makes the pages of a range resident.
    fn hold(&self, range: &PagedRange, numbers: &Numbers, work: &GpuCache, counts: &mut FrameCounts) -> GpuResult<()> {
        for (k, pages) in range.pages.iter().enumerate() {
            let volume = &self.volumes[k];
            let (Some(mut held), Some(words)) = (volume.pages(), &work.buffers.words.0) else { continue };
            let textures = (&volume.samples, volume.holes.as_ref());
            counts.page_bytes += held.hold(self.device, (self.slices[k], volume.apron), textures, pages)?;
            let offset = 4 * numbers.sources[k].apron[3] as u64;
            self.device.queue.write_buffer(words, offset, bytemuck::cast_slice(&held.table()));
        }
        Ok(())
    }

    /// Marches the rays of a band through all occupied slabs.
    #[expect(clippy::too_many_arguments, reason = "what is drawn, how it is cut, and where it goes")]
    fn draw_band(
        &self,
        family: &FamilyPlan,
        numbers: &Numbers,
        band: &Band,
        ranges: &[PagedRange],
        work: &mut GpuCache,
        counts: &mut FrameCounts,
        report: &dyn Fn(f32) -> GpuResult<()>,
    ) -> GpuResult<()> {
        let n_blocks = band.blocks.len();
        let most_groups = self.device.limits.max_compute_workgroups_per_dimension as usize;
        let per_row = n_blocks.min(most_groups);
        let (mut frame, blocks) = numbers.of_band(family, band, per_row);
        let group = self.bind(numbers, band, &blocks, work, counts);
        let n_texels: u64 = band.occupied.iter().flatten().map(|word| u64::from(word.count_ones())).sum();
        counts.texels += n_texels * N_BLOCK as u64;
        let [first, end] = band.slabs;
        let n_per_slab = n_blocks * N_BLOCK;
        let mut from = first;
        let mut ranges = ranges.iter();
        let mut range_end = first;
        let kind =
            if self.device.adapter.is_discrete() { 0 } else { 1 + usize::from(self.device.adapter.is_software()) };
        let mut rate = FIRST_RATES[kind];
        let mut most = usize::MAX;
        while from < end {
            if from == range_end {
                let Some(range) = ranges.next() else { break };
                self.hold(range, numbers, work, counts)?;
                range_end = range.end;
            }
            let n_slabs = (rate * AIM_SECONDS / n_per_slab as f64).max(1.0) as usize;
            let n_slabs = self.schedule.most_slabs.unwrap_or(n_slabs.min(most));
            let to = from.saturating_add(n_slabs).min(range_end);
            // The last sheet stands for half a slab where no slab follows.
            let last = if to == end { family.spacing.n_slabs } else { to };
            (frame.slabs[0], frame.slabs[1]) = (from as u32, last as u32);
            frame.axes[1] = u32::from(from == first);
            let bytes = numbers.parameters(&frame);
            work.buffers.parameters.with(self.device, &[&bytes], BufferUsages::UNIFORM, &mut counts.bytes_moved);
            let started = Instant::now();
            let mut encoder = self.device.device.create_command_encoder(&CommandEncoderDescriptor::default());
            {
                let timestamp_writes = counts.timer.as_mut().and_then(Timer::next);
                let descriptor = ComputePassDescriptor { label: Some("march"), timestamp_writes };
                let mut pass = encoder.begin_compute_pass(&descriptor);
                pass.set_pipeline(&self.pipeline.compute);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(per_row as u32, n_blocks.div_ceil(per_row) as u32, 1);
            }
            self.device.queue.submit([encoder.finish()]);
            self.device.wait()?;
            let seconds = started.elapsed().as_secs_f64().max(1e-6);
            counts.dispatches += 1;
            counts.longest_seconds = counts.longest_seconds.max(seconds);
            most = (to - from).saturating_mul(MAX_GROWTH);
            rate = ((to - from) * n_per_slab) as f64 / seconds;
            report((to - first) as f32 / (end - first) as f32)?;
            from = to;
        }
        Ok(())
    }

    fn bind(
        &self,
        numbers: &Numbers,
        band: &Band,
        blocks: &[u32],
        work: &mut GpuCache,
        counts: &mut FrameCounts,
    ) -> BindGroup {
        let device = self.device;
        let n_rays = band.blocks.len() * N_BLOCK;
        let intervals: Vec<&[u8]> = band.intervals.iter().map(|own| bytemuck::cast_slice(own)).collect();
        let occupied: Vec<&[u8]> = band.occupied.iter().map(|own| bytemuck::cast_slice(own)).collect();
        let words = [&*numbers.words, blocks].map(bytemuck::cast_slice);
        let n_parameters = size_of_val(&numbers.frame) + size_of_val(&*numbers.layers) + size_of_val(&*numbers.sources);
        let (buffers, moved) = (&mut work.buffers, &mut counts.bytes_moved);
        let storage = BufferUsages::STORAGE;
        let state_usage = storage | BufferUsages::COPY_SRC;
        let resources = [
            buffers.parameters.of(device, n_parameters, BufferUsages::UNIFORM | BufferUsages::COPY_DST),
            buffers.words.with(device, &words, storage, moved),
            buffers.tables.with(device, &[bytemuck::cast_slice(&numbers.tables)], storage, moved),
            buffers.intervals.with(device, &intervals, storage, moved),
            buffers.occupied.with(device, &occupied, storage, moved),
            buffers.state.of(device, 16 * self.permutation.n_state() * n_rays, state_usage),
        ];
        let textures = self.volumes.iter().enumerate().flat_map(|(k, volume)| {
            let holes = volume.holes.iter().map(move |holes| (self.permutation.holes_binding(k), &holes.view));
            [(Permutation::samples_binding(k), &volume.samples.view)].into_iter().chain(holes)
        });
        bind_group(device, self.pipeline, resources, textures)
    }

    /// Reads back the state of a band and puts its texels into the base plane.
    fn read_back(
        &self,
        band: &Band,
        family: &FamilyPlan,
        work: &mut GpuCache,
        counts: &mut FrameCounts,
        picture: &mut BasePicture,
    ) -> GpuResult<()> {
        let n_state = self.permutation.n_state();
        let n_bytes = 16 * n_state * band.blocks.len() * N_BLOCK;
        let Buffers { state, read_back, .. } = &mut work.buffers;
        let Some(state) = &state.0 else { return Ok(()) };
        let read = read_back.of(self.device, n_bytes, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        counts.bytes_moved += n_bytes as u64;
        let view = read_buffer(self.device, state, read, n_bytes)?;
        let texels: &[[f32; 4]] = bytemuck::cast_slice(&view);
        if self.permutation.counted {
            for extra in texels.chunks_exact(n_state).map(|state| state[1]) {
                counts.counted[0] += extra[1] as u64;
                counts.counted[1] += extra[2] as u64;
            }
        }
        let sign = family.sign();
        let blocks_of_tiles = band.by_tile(family);
        picture.fill_tiles([TILE_U, TILE_V], |tile, own| {
            for k in blocks_of_tiles[tile].clone() {
                let [strip, row] = band.blocks[k];
                let block = &texels[k * n_state * N_BLOCK..][..n_state * N_BLOCK];
                for (v, chunk) in block.chunks_exact(n_state * LANES).enumerate() {
                    let rgba = std::array::from_fn(|i| finished(self.plan.operator, chunk[n_state * i]));
                    let w_half = std::array::from_fn(|i| w_of(chunk[n_state * i + n_state - 1][0], sign));
                    let place = [strip % N_STRIPS * LANES, row % N_BLOCKS_V * BLOCK_V + v];
                    own.put(place[0], place[1], &rgba, self.plan.with_depth.then_some(&w_half));
                }
            }
        });
        drop(view);
        read.unmap();
        Ok(())
    }
}

fn w_of(s: f32, sign: f32) -> f32 {
    if s < NO_POSITION { s * sign } else { f32::NAN }
}

/// Texel of a ray's accumulated state. Twin of the `finish` of the compositors of `crates/splat/src/ray`.
fn finished(operator: Operator, gathered: [f32; 4]) -> [f32; 4] {
    let [value, length, _, _] = gathered;
    match operator {
        Operator::Over { .. } | Operator::FirstHit { .. } => gathered,
        Operator::LocalMaximum { .. } if value > -NO_POSITION => [value, 0.0, 0.0, 1.0],
        Operator::Project { .. } if length > 0.0 => {
            [if is_mean(operator) { value / length } else { value }, length, 0.0, 1.0]
        }
        _ => [0.0; 4],
    }
}
