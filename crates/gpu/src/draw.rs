//! A frame: base plane by base plane, band by band, range of slabs by range of slabs. The GPU's schedule over pieces.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use wavesplat_compute::parallel;
use wavesplat_compute::simd::LANES;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::plan::{FamilyPlan, Operator, Plan};
use wavesplat_splat::render::plan_arrays::{BasePlaneArrays, TileArrays};
use wavesplat_splat::render::progress::ProgressCallback;
use wavesplat_splat::sheet::tile_layout::{BLOCK_V, N_BLOCKS_V, N_STRIPS, TILE_U};
use wavesplat_splat::source::slices::Slices;
use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferDescriptor, BufferUsages,
    BufferView, CommandEncoderDescriptor, ComputePassDescriptor, FilterMode, MapMode, SamplerDescriptor, TextureView,
};

use crate::device::Device;
use crate::failure::{Failure, Result};
use crate::gpu::{GpuReport, GpuVolume, Schedule, Work};
use crate::layout::{BLOCK, GpuFrame, GpuLayer, GpuSource, NO_PLACE};
use crate::numbers::{Numbers, is_mean};
use crate::pages::{PagedRange, n_pages, pages_by_slab, ranges};
use crate::permutation::Permutation;
use crate::pipeline::Pipeline;
use crate::samples::SampleTexture;

/// Texels of a block.
const N_BLOCK: usize = BLOCK[0] * BLOCK[1];

/// Blocks that are drawn at once at most: 2 M texels, so that no binding exceeds what every device has.
const MOST_BLOCKS: usize = 1 << 14;

/// Seconds that a dispatch is to take at most: systems reset a GPU that answers to nothing for longer than about 2 s, and
/// frames are cancelled between dispatches.
const MOST_SECONDS: f64 = 0.05;

/// Texels of sheets per second that are taken for granted before any was timed, of a GPU and of a program on the processor.
const FIRST_RATES: [f64; 2] = [1e9, 1e6];

/// Words of a table that nothing is in.
const LEAST_BYTES: u64 = 256;

/// What a frame needs.
pub(crate) struct Job<'a> {
    pub device: &'a Device,
    pub plan: &'a Plan,
    /// Of each layer.
    pub slices: &'a [&'a Slices<'a>],
    pub permutation: &'a Permutation,
    pub pipeline: &'a Pipeline,
    pub volumes: &'a [Arc<GpuVolume>],
    pub schedule: Schedule,
}

/// What a frame took.
#[derive(Default)]
pub(crate) struct Counts {
    n_base_texels: u64,
    n_texels: u64,
    n_dispatches: u64,
    n_bytes_moved: u64,
    n_page_bytes: u64,
}

impl Counts {
    pub fn report(&self) -> GpuReport {
        GpuReport {
            n_base_texels: self.n_base_texels,
            n_texels: self.n_texels,
            n_dispatches: self.n_dispatches,
            n_bytes_moved: self.n_bytes_moved,
            n_page_bytes: self.n_page_bytes,
            ..GpuReport::default()
        }
    }
}

/// Buffers, kept from frame to frame, as large as they had to be.
#[derive(Default)]
pub(crate) struct Buffers {
    parameters: Kept,
    words: Kept,
    tables: Kept,
    intervals: Kept,
    occupied: Kept,
    state: Kept,
    read_back: Kept,
}

/// A buffer that grows.
#[derive(Default)]
struct Kept(Option<Buffer>);

impl Kept {
    /// With room for so many bytes.
    fn of(&mut self, device: &Device, n_bytes: usize, usage: BufferUsages) -> &Buffer {
        let size = (n_bytes as u64).next_multiple_of(16).max(LEAST_BYTES);
        let fits = self.0.as_ref().is_some_and(|own| own.size() >= size && own.size() <= 8 * size);
        if !fits {
            self.0 = None;
        }
        self.0.get_or_insert_with(|| {
            device.device.create_buffer(&BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
        })
    }

    /// With these bytes.
    fn with(&mut self, device: &Device, bytes: &[u8], usage: BufferUsages, counts: &mut Counts) -> &Buffer {
        let buffer = self.of(device, bytes.len(), usage | BufferUsages::COPY_DST);
        device.queue.write_buffer(buffer, 0, bytes);
        counts.n_bytes_moved += bytes.len() as u64;
        buffer
    }
}

/// Some rows of tiles of a base plane.
#[derive(Default)]
pub(crate) struct Band {
    /// Strip, and row of blocks, of each block.
    pub blocks: Vec<[usize; 2]>,
    /// What each of its rays draws, block by block; of all layers together, then, where there are several, of each.
    intervals: Vec<Vec<[f32; 2]>>,
    /// Slabs that have something, layer by layer and block by block, as bits.
    occupied: Vec<Vec<u32>>,
    /// Slabs before the first that has something, and one past the last.
    slabs: [usize; 2],
}

impl Job<'_> {
    /// Draws all base planes.
    pub fn draw_all(
        &self,
        work: &mut Work,
        callback: &dyn ProgressCallback,
        counts: &mut Counts,
    ) -> Result<Vec<BasePicture>> {
        let n = self.plan.families.len() as f32;
        let mut pictures = Vec::new();
        for (k, family) in self.plan.families.iter().enumerate() {
            let arrays = BasePlaneArrays::new(self.plan, k, self.slices);
            let told = |done: f32| {
                let stopped = callback.progress((k as f32 + done) / n).is_break();
                if stopped { Err(Failure::Cancelled) } else { Ok(()) }
            };
            pictures.push(self.draw(family, &arrays, work, counts, &told)?);
        }
        Ok(pictures)
    }

    fn draw(
        &self,
        family: &FamilyPlan,
        arrays: &BasePlaneArrays,
        work: &mut Work,
        counts: &mut Counts,
        told: &dyn Fn(f32) -> Result<()>,
    ) -> Result<BasePicture> {
        let mut numbers = Numbers::new(self.plan, family, arrays);
        for (source, volume) in numbers.sources.iter_mut().zip(self.volumes) {
            source.apron = [volume.apron.low as i32; 4];
            let size = volume.samples.size;
            (source.texel[0], source.texel[1]) = (1.0 / size[0] as f32, 1.0 / size[1] as f32);
        }
        // Room for the tables of pages, which are written range by range.
        for (k, slices) in self.slices.iter().enumerate().filter(|(k, _)| self.volumes[*k].pages.is_some()) {
            let [x, y, z] = n_pages(slices.grid().size());
            numbers.sources[k].pages = [x, y, z, 0].map(|n| n as u32);
            numbers.sources[k].apron[3] = numbers.words.len() as i32;
            numbers.words.resize(numbers.words.len() + x * y * z, 0);
        }
        let mut picture = BasePicture::new(family.plane.clone(), self.plan.with_depth);
        counts.n_base_texels += family.plane.size.iter().product::<usize>() as u64;
        let mut bands = bands(family, arrays, self.plan.layers.len(), self.schedule.skips);
        bands.reverse();
        let mut n_done = 0;
        while let Some(band) = bands.pop() {
            let n_all = n_done + bands.len() + 1;
            let of_band = |done: f32| told((n_done as f32 + done) / n_all as f32);
            let Some(ranges) = self.ranges(family, arrays, &band) else {
                // Half as many blocks reach fewer pages.
                let Some((first, second)) = band.halves() else {
                    return Err(Failure::Memory("too little memory is allowed for the pages of one block".to_owned()));
                };
                bands.extend([second, first]);
                continue;
            };
            self.draw_band(family, &numbers, &band, &ranges, work, counts, &of_band)?;
            self.read_back(&band, family, work, counts, &mut picture)?;
            n_done += 1;
        }
        Ok(picture)
    }

    /// Ranges of slabs whose pages fit; one of all slabs where there are no pages, `None` where there is too little room.
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
    fn hold(&self, range: &PagedRange, numbers: &Numbers, work: &Work, counts: &mut Counts) -> Result<()> {
        for (k, pages) in range.pages.iter().enumerate() {
            let volume = &self.volumes[k];
            let (Some(mut held), Some(words)) = (volume.pages(), &work.buffers.words.0) else { continue };
            let textures = (&volume.samples, volume.holes.as_ref());
            counts.n_page_bytes += held.hold(self.device, (self.slices[k], volume.apron), textures, pages)?;
            let offset = 4 * numbers.sources[k].apron[3] as u64;
            self.device.queue.write_buffer(words, offset, bytemuck::cast_slice(&held.table()));
        }
        Ok(())
    }

    /// Marches the rays of a band through all slabs that have something.
    #[expect(clippy::too_many_arguments, reason = "what is drawn, how it is cut, and where it goes")]
    fn draw_band(
        &self,
        family: &FamilyPlan,
        numbers: &Numbers,
        band: &Band,
        ranges: &[PagedRange],
        work: &mut Work,
        counts: &mut Counts,
        told: &dyn Fn(f32) -> Result<()>,
    ) -> Result<()> {
        let n_blocks = band.blocks.len();
        let most_groups = self.device.limits.max_compute_workgroups_per_dimension as usize;
        let per_row = n_blocks.min(most_groups);
        let mut frame = numbers.frame;
        frame.blocks = [numbers.words.len(), n_blocks, per_row, n_mask_words(family)].map(|n| n as u32);
        let mut words = numbers.words.clone();
        words.extend(band.blocks.iter().map(|[strip, row]| (strip | row << 16) as u32));
        let group = self.bind(numbers, band, &words, work, counts);
        let n_texels: u64 = band.occupied.iter().flatten().map(|word| u64::from(word.count_ones())).sum();
        counts.n_texels += n_texels * N_BLOCK as u64;
        let [first, end] = band.slabs;
        let n_per_slab = n_blocks * N_BLOCK;
        let mut from = first;
        let mut ranges = ranges.iter();
        let mut range_end = first;
        while from < end {
            if from == range_end {
                let Some(range) = ranges.next() else { break };
                self.hold(range, numbers, work, counts)?;
                range_end = range.end;
            }
            let is_software = self.device.adapter.is_software();
            let rate = work.rate.unwrap_or(FIRST_RATES[usize::from(is_software)]);
            let n_slabs = (rate * MOST_SECONDS / n_per_slab as f64).max(1.0) as usize;
            let n_slabs = self.schedule.most_slabs.unwrap_or(n_slabs);
            let to = from.saturating_add(n_slabs).min(range_end);
            // The last sheet stands for half a slab where no slab follows.
            let last = if to == end { family.spacing.n_slabs } else { to };
            (frame.slabs[0], frame.slabs[1]) = (from as u32, last as u32);
            frame.axes[1] = u32::from(from == first);
            let mut bytes = bytemuck::bytes_of(&frame).to_vec();
            bytes.extend_from_slice(bytemuck::cast_slice(&numbers.layers));
            bytes.extend_from_slice(bytemuck::cast_slice(&numbers.sources));
            work.buffers.parameters.with(self.device, &bytes, BufferUsages::UNIFORM, counts);
            let started = Instant::now();
            let mut encoder = self.device.device.create_command_encoder(&CommandEncoderDescriptor::default());
            {
                let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
                pass.set_pipeline(&self.pipeline.compute);
                pass.set_bind_group(0, &group, &[]);
                pass.dispatch_workgroups(per_row as u32, n_blocks.div_ceil(per_row) as u32, 1);
            }
            self.device.queue.submit([encoder.finish()]);
            self.device.wait()?;
            let seconds = started.elapsed().as_secs_f64().max(1e-6);
            counts.n_dispatches += 1;
            let now = ((to - from) * n_per_slab) as f64 / seconds;
            // The first time compiles, and the latest frames count most.
            work.rate = Some(work.rate.map_or(now, |before| 0.5 * (before + now)));
            told((to - first) as f32 / (end - first) as f32)?;
            from = to;
        }
        Ok(())
    }

    fn bind(&self, numbers: &Numbers, band: &Band, words: &[u32], work: &mut Work, counts: &mut Counts) -> BindGroup {
        let device = self.device;
        let n_rays = band.blocks.len() * N_BLOCK;
        let intervals = band.intervals.concat();
        let occupied = band.occupied.concat();
        let n_parameters = size_of_val(&numbers.frame) + size_of_val(&*numbers.layers) + size_of_val(&*numbers.sources);
        let buffers = &mut work.buffers;
        let storage = BufferUsages::STORAGE;
        let state_usage = storage | BufferUsages::COPY_SRC;
        let resources = [
            buffers.parameters.of(device, n_parameters, BufferUsages::UNIFORM | BufferUsages::COPY_DST),
            buffers.words.with(device, bytemuck::cast_slice(words), storage, counts),
            buffers.tables.with(device, bytemuck::cast_slice(&numbers.tables), storage, counts),
            buffers.intervals.with(device, bytemuck::cast_slice(&intervals), storage, counts),
            buffers.occupied.with(device, bytemuck::cast_slice(&occupied), storage, counts),
            buffers.state.of(device, 16 * self.permutation.n_state() * n_rays, state_usage),
        ];
        let textures = self.volumes.iter().enumerate().flat_map(|(k, volume)| {
            let holes = volume.holes.iter().map(move |holes| (self.permutation.holes_binding(k), &holes.view));
            [(Permutation::samples_binding(k), &volume.samples.view)].into_iter().chain(holes)
        });
        bind_group(device, self.pipeline, resources, textures)
    }

    /// Puts what was drawn of a band into the base plane.
    fn read_back(
        &self,
        band: &Band,
        family: &FamilyPlan,
        work: &mut Work,
        counts: &mut Counts,
        picture: &mut BasePicture,
    ) -> Result<()> {
        let n_state = self.permutation.n_state();
        let n_bytes = 16 * n_state * band.blocks.len() * N_BLOCK;
        let Buffers { state, read_back, .. } = &mut work.buffers;
        let Some(state) = &state.0 else { return Ok(()) };
        let read = read_back.of(self.device, n_bytes, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        counts.n_bytes_moved += n_bytes as u64;
        let view = read_buffer(self.device, state, read, n_bytes)?;
        let texels: &[[f32; 4]] = bytemuck::cast_slice(&view);
        let sign = family.sign();
        for ([strip, row], own) in band.blocks.iter().zip(texels.chunks_exact(n_state * N_BLOCK)) {
            for (v, chunk) in own.chunks_exact(n_state * LANES).enumerate() {
                let rgba = std::array::from_fn(|i| finished(self.plan.operator, chunk[n_state * i]));
                let w_half = std::array::from_fn(|i| w_of(chunk[n_state * i + n_state - 1][0], sign));
                let j = row * BLOCK_V + v;
                if j < family.plane.size[1] {
                    picture.put(strip * LANES, j, &rgba, (n_state > 1).then_some(&w_half));
                }
            }
        }
        drop(view);
        read.unmap();
        Ok(())
    }
}

/// What a buffer holds, by one that can be mapped; to be unmapped when it was read.
fn read_buffer(device: &Device, from: &Buffer, by: &Buffer, n_bytes: usize) -> Result<BufferView> {
    let mut encoder = device.device.create_command_encoder(&CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(from, 0, by, 0, Some(n_bytes as u64));
    device.queue.submit([encoder.finish()]);
    let (tell, told) = std::sync::mpsc::channel();
    by.map_async(MapMode::Read, ..n_bytes as u64, move |mapped| {
        let _ = tell.send(mapped);
    });
    device.wait()?;
    match told.try_recv() {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(Failure::Refused(error.to_string())),
        Err(_) => return Err(Failure::Lost("what it drew never came back".to_owned())),
    }
    by.get_mapped_range(..n_bytes as u64).map_err(|error| Failure::Refused(error.to_string()))
}

fn bind_group<'a>(
    device: &Device,
    pipeline: &Pipeline,
    buffers: [&Buffer; 6],
    textures: impl Iterator<Item = (u32, &'a TextureView)>,
) -> BindGroup {
    let sampler = device.device.create_sampler(&SamplerDescriptor {
        mag_filter: FilterMode::Nearest,
        min_filter: FilterMode::Nearest,
        ..SamplerDescriptor::default()
    });
    let mut entries: Vec<BindGroupEntry> = buffers
        .iter()
        .enumerate()
        .map(|(k, buffer)| BindGroupEntry { binding: k as u32, resource: buffer.as_entire_binding() })
        .collect();
    entries.push(BindGroupEntry { binding: 6, resource: BindingResource::Sampler(&sampler) });
    entries.extend(
        textures.map(|(binding, view)| BindGroupEntry { binding, resource: BindingResource::TextureView(view) }),
    );
    device.device.create_bind_group(&BindGroupDescriptor { label: None, layout: &pipeline.layout, entries: &entries })
}

/// What the self-test asks a device.
pub(crate) struct Probe<'a> {
    /// Where quads of the texture begin.
    pub places: &'a [[usize; 3]],
    pub exponents: &'a [f32],
    pub texture: &'a SampleTexture,
}

impl Probe<'_> {
    /// Four samples of each place; then the exponentials.
    pub fn run(&self, device: &Device, pipeline: &Pipeline) -> Result<Vec<[f32; 4]>> {
        let n = self.places.len() + self.exponents.len();
        let frame = GpuFrame { blocks: [0, self.places.len() as u32, 1, 1], ..GpuFrame::default() };
        let [width, height, _] = self.texture.size;
        let source = GpuSource { texel: [1.0 / width as f32, 1.0 / height as f32, 0.0, 0.0], ..GpuSource::default() };
        let mut parameters = bytemuck::bytes_of(&frame).to_vec();
        parameters.extend_from_slice(bytemuck::bytes_of(&GpuLayer::default()));
        parameters.extend_from_slice(bytemuck::bytes_of(&source));
        let places: Vec<u32> = self.places.as_flattened().iter().map(|i| *i as u32).collect();
        let exponents: Vec<[f32; 2]> = self.exponents.iter().map(|x| [*x, 0.0]).collect();
        let (mut kept, counts) = (Buffers::default(), &mut Counts::default());
        let storage = BufferUsages::STORAGE;
        let Buffers { parameters: uniform, words, tables, intervals, occupied, .. } = &mut kept;
        let state = device.device.create_buffer(&BufferDescriptor {
            label: None,
            size: 16 * n as u64,
            usage: storage | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let buffers = [
            uniform.with(device, &parameters, BufferUsages::UNIFORM, counts),
            words.with(device, bytemuck::cast_slice(&places), storage, counts),
            tables.of(device, 0, storage),
            intervals.with(device, bytemuck::cast_slice(&exponents), storage, counts),
            occupied.of(device, 0, storage),
            &state,
        ];
        let texture = [(Permutation::samples_binding(0), &self.texture.view)];
        let group = bind_group(device, pipeline, buffers, texture.into_iter());
        let mut encoder = device.device.create_command_encoder(&CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&ComputePassDescriptor::default());
            pass.set_pipeline(&pipeline.compute);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups(n.div_ceil(64) as u32, 1, 1);
        }
        device.queue.submit([encoder.finish()]);
        let read = kept.read_back.of(device, 16 * n, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        let view = read_buffer(device, &state, read, 16 * n)?;
        Ok(bytemuck::cast_slice(&view).to_vec())
    }
}

fn w_of(s: f32, sign: f32) -> f32 {
    if s < NO_PLACE { s * sign } else { f32::NAN }
}

/// What a ray has gathered as a texel. Twin of the `finish` of the compositors of `crates/splat/src/ray`.
fn finished(operator: Operator, gathered: [f32; 4]) -> [f32; 4] {
    let [value, length, _, _] = gathered;
    match operator {
        Operator::Over { .. } | Operator::FirstHit { .. } => gathered,
        Operator::LocalMaximum { .. } if value > -NO_PLACE => [value, 0.0, 0.0, 1.0],
        Operator::Project { .. } if length > 0.0 => {
            [if is_mean(operator) { value / length } else { value }, length, 0.0, 1.0]
        }
        _ => [0.0; 4],
    }
}

/// Words of the slabs of a block, as bits, with one bit more for the sheet behind the last.
fn n_mask_words(family: &FamilyPlan) -> usize {
    (family.spacing.n_slabs + 1).div_ceil(32)
}

/// A base plane as bands of blocks that something may be seen in.
fn bands(family: &FamilyPlan, arrays: &BasePlaneArrays, n_layers: usize, skips: bool) -> Vec<Band> {
    let [n_tiles_u, n_tiles_v] = arrays.n_tiles();
    let mut bands = vec![Band::default()];
    for row in 0..n_tiles_v {
        let tiles = parallel::map(n_tiles_u, |column| arrays.tile([column, row]));
        for (column, tile) in tiles.iter().enumerate() {
            let n = tile.blocks.count_ones() as usize;
            if bands.last().is_some_and(|band| band.blocks.len() + n > MOST_BLOCKS) {
                bands.push(Band::default());
            }
            if let Some(band) = bands.last_mut() {
                band.add(family, tile, [column, row], n_layers);
            }
        }
    }
    bands.retain(|band| !band.blocks.is_empty());
    if !skips {
        bands.iter_mut().for_each(|band| band.occupy_all(family));
    }
    bands
}

impl Band {
    /// Whether a block has something of a layer in a slab.
    pub fn is_occupied(&self, layer: usize, block: usize, slab: usize) -> bool {
        let words = &self.occupied[layer];
        let n_words = words.len() / self.blocks.len();
        words[block * n_words + slab / 32] >> (slab % 32) & 1 == 1
    }

    /// Takes everything for occupied.
    fn occupy_all(&mut self, family: &FamilyPlan) {
        let n_words = n_mask_words(family);
        self.slabs = [0, family.spacing.n_slabs];
        for (k, word) in self.occupied.iter_mut().flat_map(|words| words.iter_mut().enumerate()) {
            let first = k % n_words * 32;
            let n = family.spacing.n_slabs.saturating_sub(first).min(32);
            *word = if n == 32 { u32::MAX } else { (1 << n) - 1 };
        }
    }

    /// Both halves of its blocks, where it has more than one.
    fn halves(&self) -> Option<(Self, Self)> {
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
