//! An open GPU: its device, what was made and uploaded before, and the door to drawing.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use wavesplat_core::Gradient;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::render::progress::ProgressCallback;
use wavesplat_splat::source::slices::Slices;

use crate::adapter::{Adapter, Choice};
use crate::device::Device;
use crate::draw::{Buffers, Counts, Job};
use crate::failure::{Failure, Result};
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
    budget_bytes: usize,
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
}

/// The samples of a source.
pub(crate) struct GpuVolume {
    pub samples: SampleTexture,
    pub holes: Option<SampleTexture>,
    pub apron: Apron,
}

impl GpuVolume {
    fn n_bytes(&self) -> usize {
        self.samples.n_bytes + self.holes.as_ref().map_or(0, |holes| holes.n_bytes)
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
        let gpu = Self { device, gather, budget_bytes, work: Mutex::default() };
        test_picture(&gpu)?;
        *gpu.work() = Work::default();
        Ok(gpu)
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
        self.budget_bytes
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
        if let Some(why) = self.lost() {
            return Err(Failure::Lost(why));
        }
        let permutation = permutation_of(plan, slices, self.gather)?;
        let work = &mut *self.work();
        let volumes = self.device.guarded(|| self.upload_all(work, &permutation, &sources_of(plan, slices)))?;
        let pipeline = match work.pipelines.get(&permutation) {
            Some(pipeline) => pipeline.clone(),
            None => {
                let made = Arc::new(Pipeline::new(&self.device, &permutation)?);
                work.pipelines.insert(permutation.clone(), made.clone());
                made
            }
        };
        let n_sample_bytes = volumes.iter().map(|volume| volume.n_bytes() as u64).sum();
        let mut counts = Counts::default();
        let job = Job { device: &self.device, plan, permutation: &permutation, pipeline: &pipeline, volumes: &volumes };
        let pictures = self.device.guarded(|| job.draw_all(slices, work, callback, &mut counts))?;
        Ok((pictures, GpuReport { n_sample_bytes, ..counts.report() }))
    }

    /// The samples of all sources; what was not used for longest makes room.
    fn upload_all(
        &self,
        work: &mut Work,
        permutation: &Permutation,
        sources: &[(&Slices, Option<Gradient>)],
    ) -> Result<Vec<Arc<GpuVolume>>> {
        let keys: Vec<VolumeKey> = sources
            .iter()
            .zip(&permutation.sources)
            .map(|((slices, _), kind)| VolumeKey { id: slices.id(), apron: apron_of(kind) })
            .collect();
        let needed: usize = sources.iter().zip(&permutation.sources).map(|((s, _), kind)| whole_bytes(s, kind)).sum();
        if needed > self.budget_bytes {
            let [needed, budget] = [needed, self.budget_bytes].map(|n| n as f64 / 1e6);
            return Err(Failure::Memory(format!(
                "the samples take {needed:.1} MB on the GPU, and {budget:.1} MB are allowed"
            )));
        }
        // What this frame does not need makes room, the oldest first.
        let mut kept: usize = work.volumes.iter().map(|(_, volume)| volume.n_bytes()).sum();
        let is_needed = |key: &VolumeKey| keys.contains(key);
        let missing: usize = sources
            .iter()
            .zip(&permutation.sources)
            .zip(&keys)
            .filter(|(_, key)| !work.volumes.iter().any(|(own, _)| own == *key))
            .map(|((source, kind), _)| whole_bytes(source.0, kind))
            .sum();
        while kept + missing > self.budget_bytes {
            let Some(oldest) = work.volumes.iter().position(|(key, _)| !is_needed(key)) else { break };
            kept -= work.volumes.remove(oldest).1.n_bytes();
        }
        let mut volumes = Vec::new();
        for (((slices, _), kind), key) in sources.iter().zip(&permutation.sources).zip(&keys) {
            let found = work.volumes.iter().position(|(own, _)| own == key);
            let (key, volume) = match found {
                Some(place) => work.volumes.remove(place),
                None => (*key, Arc::new(self.upload_whole(slices, kind)?)),
            };
            volumes.push(volume.clone());
            work.volumes.push((key, volume));
        }
        Ok(volumes)
    }

    fn upload_whole(&self, slices: &Slices, kind: &SourceKind) -> Result<GpuVolume> {
        let apron = apron_of(kind);
        let part = SampleBox::whole(slices.grid().size(), apron);
        let samples = SampleTexture::new(&self.device, part.size, kind.format)?;
        upload(&self.device, slices, &samples, part, [0; 3])?;
        let mut holes = None;
        if kind.has_holes {
            let texture = hole_texture(&self.device, part.size)?;
            upload_holes(&self.device, slices, &texture, part, [0; 3])?;
            holes = Some(texture);
        }
        Ok(GpuVolume { samples, holes, apron })
    }
}

/// Bytes of all samples of a source with what is around them.
fn whole_bytes(slices: &Slices, kind: &SourceKind) -> usize {
    let part = SampleBox::whole(slices.grid().size(), apron_of(kind));
    part.size.iter().product::<usize>() * (kind.format.n_bytes() + usize::from(kind.has_holes))
}
