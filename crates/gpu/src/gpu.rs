//! An open GPU: its device, what was made and uploaded before, and the door to drawing.

use std::collections::HashMap;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use wavesplat_core::Gradient;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::render::progress::ProgressCallback;
use wavesplat_splat::source::slices::Slices;

use crate::adapter::{Adapter, Choice};
use crate::buffers::Buffers;
use crate::device::Device;
use crate::draw::{Counts, Job};
use crate::failure::{Failure, Result};
use crate::pages::{Pages, n_pages, page_bytes, page_side, page_textures};
use crate::permutation::{Permutation, SourceKind};
use crate::pipeline::Pipeline;
use crate::samples::{Apron, SampleBox, SampleTexture, hole_texture, upload, upload_holes};
use crate::scene_kind::{apron_of, permutation_of, sources_of};
use crate::self_test::{test_picture, test_samples};

/// Memory for samples, unless told otherwise: no driver says how much is free.
pub const DEFAULT_BUDGET_BYTES: usize = 3 << 29;

/// An open GPU. Draws one frame at a time.
pub struct Gpu {
    device: Device,
    gather: bool,
    budget_bytes: AtomicUsize,
    work: Mutex<Work>,
}

/// What is kept between frames.
#[derive(Default)]
pub(crate) struct Work {
    pub pipelines: HashMap<Permutation, Arc<Pipeline>>,
    /// The volumes that were uploaded, the latest last.
    volumes: Vec<(VolumeKey, Arc<GpuVolume>)>,
    pub buffers: Buffers,
    /// Texels of sheets per second, as the last frames had them.
    pub rate: Option<f64>,
}

/// What tells uploaded volumes apart.
#[derive(Clone, Copy, PartialEq, Eq)]
struct VolumeKey {
    id: u64,
    apron: Apron,
    /// Pages that there is room for; `None`: all samples lie together.
    slots: Option<usize>,
}

/// The samples of a source.
pub(crate) struct GpuVolume {
    pub samples: SampleTexture,
    pub holes: Option<SampleTexture>,
    pub apron: Apron,
    pub pages: Option<Mutex<Pages>>,
}

impl GpuVolume {
    fn n_bytes(&self) -> usize {
        self.samples.n_bytes + self.holes.as_ref().map_or(0, |holes| holes.n_bytes)
    }

    /// Where its pages are, if it has some.
    pub fn pages(&self) -> Option<MutexGuard<'_, Pages>> {
        self.pages.as_ref().map(|pages| pages.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// How a frame is cut; the picture does not depend on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    /// Slabs of a dispatch at most; `None`: as many as take a twentieth of a second.
    pub most_slabs: Option<usize>,
    /// Leave out what nothing is seen of.
    pub skips: bool,
    /// Pages even where all samples fit.
    pub is_paged: bool,
}

impl Default for Schedule {
    fn default() -> Self {
        Self { most_slabs: None, skips: true, is_paged: false }
    }
}

/// What a frame took on a GPU.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GpuReport {
    /// Texels of base planes, and of these, with all sheets of occupied slabs, what was looked at at most.
    pub n_base_texels: u64,
    /// Texels of sheets.
    pub n_texels: u64,
    /// Dispatches that the frame was cut into.
    pub n_dispatches: u64,
    /// Whether the samples are there in pages, of those alone that are seen.
    pub is_paged: bool,
    /// Pages that were uploaded.
    pub n_page_bytes: u64,
    /// Bytes of samples on the GPU.
    pub n_sample_bytes: u64,
    /// Bytes that were uploaded for this frame, samples excluded, and read back.
    pub n_bytes_moved: u64,
    /// Seconds of the GPU, where it tells them.
    pub seconds: Option<f64>,
}

impl Gpu {
    /// Opens a GPU, for at most so many bytes of samples, and tests it: one that does not draw what the CPU draws is refused.
    pub fn open(choice: &Choice, budget_bytes: usize) -> Result<Self> {
        Self::open_with(choice, budget_bytes, false)
    }

    /// The same; `fails`: its self-test is made to fail.
    pub fn open_with(choice: &Choice, budget_bytes: usize, fails: bool) -> Result<Self> {
        let device = Device::open(choice)?;
        let gather = test_samples(&device, fails)?;
        let gpu = Self { device, gather, budget_bytes: AtomicUsize::new(budget_bytes), work: Mutex::default() };
        test_picture(&gpu)?;
        *gpu.work() = Work::default();
        Ok(gpu)
    }

    /// Texels of a texture's side, its layers, and bytes of a buffer, at most.
    pub fn limits(&self) -> [u64; 3] {
        let limits = &self.device.limits;
        let [side, layers] = [limits.max_texture_dimension_2d, limits.max_texture_array_layers].map(u64::from);
        [side, layers, limits.max_storage_buffer_binding_size]
    }

    /// Whether it tells how long it took.
    pub fn has_timestamps(&self) -> bool {
        self.device.has_timestamps
    }

    /// Whether it fetches four samples at once.
    pub fn gathers(&self) -> bool {
        self.gather
    }

    /// Ends the device, as a driver may at any time: what tests of such an end do.
    pub fn destroy(&self) {
        self.device.device.destroy();
    }

    /// What its driver tells.
    pub fn adapter(&self) -> &Adapter {
        &self.device.adapter
    }

    /// Most bytes of samples.
    pub fn budget_bytes(&self) -> usize {
        self.budget_bytes.load(Ordering::Relaxed)
    }

    /// Sets that, for the next frames.
    pub fn set_budget(&self, budget_bytes: usize) {
        self.budget_bytes.store(budget_bytes, Ordering::Relaxed);
    }

    /// Why it cannot draw any more, if so.
    pub fn lost(&self) -> Option<String> {
        self.device.lost()
    }

    fn work(&self) -> MutexGuard<'_, Work> {
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Draws the base planes of a plan: as `draw_base_planes` of the CPU does. `slices`: of each layer.
    pub fn draw_base_planes(
        &self,
        plan: &Plan,
        slices: &[&Slices],
        callback: &dyn ProgressCallback,
    ) -> Result<(Vec<BasePicture>, GpuReport)> {
        self.draw_base_planes_by(Schedule::default(), plan, slices, callback)
    }

    /// The same, cut as a schedule says.
    pub fn draw_base_planes_by(
        &self,
        schedule: Schedule,
        plan: &Plan,
        slices: &[&Slices],
        callback: &dyn ProgressCallback,
    ) -> Result<(Vec<BasePicture>, GpuReport)> {
        if let Some(why) = self.lost() {
            return Err(Failure::Lost(why));
        }
        let mut permutation = permutation_of(plan, slices, self.gather)?;
        let n_textures = permutation.sources.iter().map(|source| 1 + usize::from(source.has_holes)).sum::<usize>();
        let most = self.device.limits.max_sampled_textures_per_shader_stage as usize;
        if n_textures > most {
            return Err(Failure::NotOnGpu(format!(
                "{n_textures} volumes and fields are more than the {most} of this GPU"
            )));
        }
        let work = &mut *self.work();
        let sources = sources_of(plan, slices);
        let budget = self.budget_bytes();
        let mut placed = self.place_all(work, &mut permutation, &sources, plan.layers.len(), budget, schedule.is_paged);
        if matches!(placed, Err(Failure::Memory(_))) && !work.volumes.is_empty() {
            // What others are using is not known; half as much may still be there.
            work.volumes.clear();
            placed = self.place_all(work, &mut permutation, &sources, plan.layers.len(), budget / 2, true);
        }
        let volumes = placed?;
        let pipeline = if let Some(pipeline) = work.pipelines.get(&permutation) {
            pipeline.clone()
        } else {
            let made = Arc::new(Pipeline::new(&self.device, &permutation)?);
            work.pipelines.insert(permutation.clone(), made.clone());
            made
        };
        let n_sample_bytes = volumes.iter().map(|volume| volume.n_bytes() as u64).sum();
        let is_paged = volumes.iter().any(|volume| volume.pages.is_some());
        let mut counts = Counts::new(&self.device);
        let job = Job {
            device: &self.device,
            plan,
            slices,
            permutation: &permutation,
            pipeline: &pipeline,
            volumes: &volumes,
            schedule,
        };
        let pictures = self.device.guarded(|| job.draw_all(work, callback, &mut counts))?;
        let report = self.device.guarded(|| counts.report(&self.device))?;
        Ok((pictures, GpuReport { is_paged, n_sample_bytes, ..report }))
    }

    /// The samples of all sources, in pages where they do not fit; what was not used for longest makes room.
    fn place_all(
        &self,
        work: &mut Work,
        permutation: &mut Permutation,
        sources: &[(&Slices, Option<Gradient>)],
        n_layers: usize,
        budget_bytes: usize,
        is_paged: bool,
    ) -> Result<Vec<Arc<GpuVolume>>> {
        let megabytes = |n: usize| n as f64 / 1e6;
        let whole: Vec<usize> =
            sources.iter().zip(&permutation.sources).map(|((slices, _), kind)| whole_bytes(slices, kind)).collect();
        let (of_layers, of_fields): (usize, usize) = (whole[..n_layers].iter().sum(), whole[n_layers..].iter().sum());
        let fits = |k: usize| {
            let size = SampleBox::whole(sources[k].0.grid().size(), apron_of(&permutation.sources[k])).size;
            let [side, deep] =
                [self.device.limits.max_texture_dimension_2d, self.device.limits.max_texture_array_layers];
            size[0].max(size[1]) <= side as usize && size[2] <= deep as usize
        };
        let is_paged = is_paged || of_layers + of_fields > budget_bytes || !(0..n_layers).all(fits);
        let mut keys = Vec::new();
        for (k, ((slices, _), kind)) in sources.iter().zip(&mut permutation.sources).enumerate() {
            let apron = apron_of(kind);
            let mut slots = None;
            if is_paged && k < n_layers {
                let share = whole[k] as f64 / of_layers as f64;
                let room = (budget_bytes.saturating_sub(of_fields) as f64 * share) as usize;
                let n = (room / page_bytes(kind, apron)).min(n_pages(slices.grid().size()).iter().product());
                if n == 0 {
                    return Err(Failure::Memory(format!(
                        "{:.1} MB are allowed on the GPU, not enough for a page of the samples, of {:.1} MB",
                        megabytes(budget_bytes),
                        megabytes(page_bytes(kind, apron))
                    )));
                }
                slots = Some(n);
                kind.page_side = Some(page_side(apron));
            }
            keys.push(VolumeKey { id: slices.id(), apron, slots });
        }
        if of_fields > budget_bytes {
            return Err(Failure::Memory(format!(
                "labels and light take {:.1} MB on the GPU, and {:.1} MB are allowed",
                megabytes(of_fields),
                megabytes(budget_bytes)
            )));
        }
        // What this frame does not need makes room, the oldest first.
        let bytes_of = |k: usize| match keys[k].slots {
            Some(n) => n * page_bytes(&permutation.sources[k], keys[k].apron),
            None => whole[k],
        };
        let mut kept: usize = work.volumes.iter().map(|(_, volume)| volume.n_bytes()).sum();
        let is_there = |work: &Work, key: &VolumeKey| work.volumes.iter().any(|(own, _)| own == key);
        let missing: usize = (0..keys.len()).filter(|k| !is_there(work, &keys[*k])).map(bytes_of).sum();
        while kept + missing > budget_bytes {
            let Some(oldest) = work.volumes.iter().position(|(key, _)| !keys.contains(key)) else { break };
            kept -= work.volumes.remove(oldest).1.n_bytes();
        }
        let mut volumes = Vec::new();
        for (((slices, _), kind), key) in sources.iter().zip(&permutation.sources).zip(&keys) {
            let found = work.volumes.iter().position(|(own, _)| own == key);
            let (key, volume) = match found {
                Some(place) => work.volumes.remove(place),
                None => (*key, Arc::new(self.device.guarded(|| self.upload(slices, kind, *key))?)),
            };
            volumes.push(volume.clone());
            work.volumes.push((key, volume));
        }
        Ok(volumes)
    }

    fn upload(&self, slices: &Slices, kind: &SourceKind, key: VolumeKey) -> Result<GpuVolume> {
        let (size, apron) = (slices.grid().size(), key.apron);
        if let Some(n) = key.slots {
            let pages = Pages::new(&self.device, size, apron, n);
            let (samples, holes) = page_textures(&self.device, kind, &pages)?;
            return Ok(GpuVolume { samples, holes, apron, pages: Some(Mutex::new(pages)) });
        }
        let part = SampleBox::whole(size, apron);
        let samples = SampleTexture::new(&self.device, part.size, kind.format)?;
        upload(&self.device, slices, &samples, part, [0; 3])?;
        let mut holes = None;
        if kind.has_holes {
            let texture = hole_texture(&self.device, part.size)?;
            upload_holes(&self.device, slices, &texture, part, [0; 3])?;
            holes = Some(texture);
        }
        Ok(GpuVolume { samples, holes, apron, pages: None })
    }
}

/// Bytes of all samples of a source with what is around them.
fn whole_bytes(slices: &Slices, kind: &SourceKind) -> usize {
    let part = SampleBox::whole(slices.grid().size(), apron_of(kind));
    part.size.iter().product::<usize>() * (kind.format.n_bytes() + usize::from(kind.has_holes))
}
