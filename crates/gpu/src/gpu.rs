//! An open GPU: its device, the pipelines and volumes that it keeps, and the entry points of drawing.

use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard};

use wavesplat_compute::locks::lock;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::render::progress::ProgressCallback;
use wavesplat_splat::source::slices::Slices;

use crate::adapter::{Adapter, Choice};
use crate::device::OpenDevice;
use crate::draw::{FrameJob, GpuCache, Schedule};
use crate::failure::{Failure, GpuResult};
use crate::numbers::Numbers;
use crate::permutation::Permutation;
use crate::pipeline::Pipeline;
use crate::report::{FrameCounts, GpuReport};
use crate::scene_kind::{permutation_of, sources_of};
use crate::self_test::{test_picture, test_samples};
use crate::stage::Stage;
use crate::volumes::uploaded;

/// Default budget for samples in bytes: no driver reports how much memory is free.
pub const DEFAULT_BUDGET_BYTES: usize = 3 << 29;

/// Most pipelines that are kept.
const MAX_PIPELINES: usize = 64;

/// Guard of a thread that draws on a GPU: a frame that its callback draws in turn would wait for itself.
struct Drawing;

thread_local! {
    static IS_DRAWING: Cell<bool> = const { Cell::new(false) };
}

impl Drawing {
    fn begin() -> GpuResult<Self> {
        if IS_DRAWING.replace(true) {
            let why = "a picture that is drawn while the same thread draws another one is drawn by the CPU";
            return Err(Failure::DrawnByCpu(why.to_owned()));
        }
        Ok(Self)
    }
}

impl Drop for Drawing {
    fn drop(&mut self) {
        IS_DRAWING.set(false);
    }
}

/// An open GPU. Draws one frame at a time.
pub struct Gpu {
    device: OpenDevice,
    gather: bool,
    budget_bytes: AtomicUsize,
    /// Upper bound of the budget, lowered after the driver has refused memory.
    peak_bytes: AtomicUsize,
    work: Mutex<GpuCache>,
}

impl Gpu {
    /// Opens a GPU with a budget for samples, and tests it: one that does not draw what the CPU draws is refused.
    pub fn open(choice: &Choice, budget_bytes: usize) -> GpuResult<Self> {
        Self::open_with(choice, budget_bytes, false)
    }

    /// Opens a GPU as [`Gpu::open`] does; `fails`: the self-test is made to fail.
    pub fn open_with(choice: &Choice, budget_bytes: usize, fails: bool) -> GpuResult<Self> {
        let device = OpenDevice::open(choice)?;
        let gather = test_samples(&device, fails)?;
        let gpu = Self {
            device,
            gather,
            budget_bytes: AtomicUsize::new(budget_bytes),
            peak_bytes: AtomicUsize::new(usize::MAX),
            work: Mutex::default(),
        };
        let draw = |plan: &Plan, slices: &[&Slices]| gpu.draw_base_planes(plan, slices, &()).map(|drawn| drawn.0);
        test_picture(&gpu.adapter().name, draw)?;
        *gpu.work() = GpuCache::default();
        Ok(gpu)
    }

    /// Limits of the device: texels of a texture's side, layers of a texture, bytes of a storage buffer.
    pub fn limits(&self) -> [u64; 3] {
        let limits = &self.device.limits;
        let [side, layers] = [limits.max_texture_dimension_2d, limits.max_texture_array_layers].map(u64::from);
        [side, layers, limits.max_storage_buffer_binding_size]
    }

    /// Whether passes can be timed.
    pub fn has_timestamps(&self) -> bool {
        self.device.has_timestamps
    }

    /// Whether shaders fetch four samples at once.
    pub fn gathers(&self) -> bool {
        self.gather
    }

    /// Destroys the device, as a driver may at any time; for tests of a lost device.
    pub fn destroy(&self) {
        self.device.device.destroy();
    }

    /// The adapter, as reported by its driver.
    pub fn adapter(&self) -> &Adapter {
        &self.device.adapter
    }

    /// Budget for samples in bytes.
    pub fn budget_bytes(&self) -> usize {
        self.budget_bytes.load(Ordering::Relaxed)
    }

    /// Sets the budget for samples in bytes, for the next frames.
    pub fn set_budget(&self, budget_bytes: usize) {
        self.budget_bytes.store(budget_bytes, Ordering::Relaxed);
    }

    /// Reason of the loss, if the device is lost.
    pub fn lost(&self) -> Option<String> {
        self.device.lost()
    }

    fn work(&self) -> MutexGuard<'_, GpuCache> {
        lock(&self.work)
    }

    /// Draws the base planes of a plan, as the CPU's `draw_base_planes` does. `slices`: one per layer.
    pub fn draw_base_planes(
        &self,
        plan: &Plan,
        slices: &[&Slices],
        callback: &dyn ProgressCallback,
    ) -> GpuResult<(Vec<BasePicture>, GpuReport)> {
        self.draw_base_planes_by(Schedule::default(), plan, slices, callback)
    }

    /// Draws the base planes of a plan, cut by a schedule.
    pub fn draw_base_planes_by(
        &self,
        schedule: Schedule,
        plan: &Plan,
        slices: &[&Slices],
        callback: &dyn ProgressCallback,
    ) -> GpuResult<(Vec<BasePicture>, GpuReport)> {
        if let Some(why) = self.lost() {
            return Err(Failure::Lost(why));
        }
        let mut permutation = permutation_of(plan, slices, self.gather)?;
        permutation.counted = schedule.counts;
        let n_textures = permutation.sources.iter().map(|source| 1 + usize::from(source.has_holes)).sum::<usize>();
        let most = self.device.limits.max_sampled_textures_per_shader_stage as usize;
        if n_textures > most {
            return Err(Failure::DrawnByCpu(format!(
                "{n_textures} volumes and fields are more than the {most} of this GPU"
            )));
        }
        let _drawing = Drawing::begin()?;
        let work = &mut *self.work();
        let sources = sources_of(plan, slices);
        let fields: Vec<usize> = sources.iter().filter_map(|source| source.field).collect();
        let budget = self.budget_bytes().min(self.peak_bytes.load(Ordering::Relaxed));
        let mut placed =
            work.volumes.place_all(&self.device, &permutation, &sources, plan.layers.len(), budget, schedule.is_paged);
        if matches!(placed, Err(Failure::Refused(_) | Failure::Allocation(_))) {
            // How much memory other programs use is unknown: try half the budget, which stays the limit from now on.
            *work = GpuCache::default();
            self.device.queue.submit([]);
            self.device.wait()?;
            self.peak_bytes.store(budget / 2, Ordering::Relaxed);
            let half = budget / 2;
            placed = work.volumes.place_all(&self.device, &permutation, &sources, plan.layers.len(), half, true);
        }
        let volumes = placed?;
        let pipeline = if let Some(pipeline) = work.pipelines.get(&permutation) {
            pipeline.clone()
        } else {
            let made = Arc::new(Pipeline::new(&self.device, &permutation)?);
            if work.pipelines.len() >= MAX_PIPELINES {
                work.pipelines.clear();
            }
            work.pipelines.insert(permutation.clone(), made.clone());
            made
        };
        let n_sample_bytes = volumes.iter().map(|volume| volume.n_bytes() as u64).sum();
        let is_paged = volumes.iter().any(|volume| volume.pages.is_some());
        let mut counts = self.device.guarded(|| Ok(FrameCounts::new(&self.device)))?;
        let job = FrameJob {
            device: &self.device,
            plan,
            slices,
            permutation: &permutation,
            pipeline: &pipeline,
            volumes: &volumes,
            fields: &fields,
            schedule,
        };
        let drawn = self.device.guarded(|| job.draw_all(work, callback, &mut counts));
        if drawn.as_ref().is_err_and(|failure| *failure != Failure::Cancelled) {
            // A resource that the device refused may be kept as if it were valid.
            *work = GpuCache::default();
        }
        let pictures = drawn?;
        let report = self.device.guarded(|| counts.report(&self.device))?;
        Ok((pictures, GpuReport { is_paged, n_sample_bytes, ..report }))
    }

    /// Runs a stage of a frame alone, for the stage fixtures. `entry`: WGSL of an entry point `stage`, in workgroups of
    /// 64, that writes `n` vec4s to `state`; `slices`: the samples of the only source, whose apron `numbers` need not
    /// know.
    pub fn run_stage(
        &self,
        permutation: &Permutation,
        entry: &str,
        numbers: &Numbers,
        slices: &Slices,
        n: usize,
    ) -> GpuResult<Vec<[f32; 4]>> {
        let kind = &permutation.sources[0];
        let volume = self.device.guarded(|| uploaded(&self.device, &[slices], kind, None))?;
        let mut numbers = numbers.clone();
        for source in &mut numbers.sources {
            source.lies_in(volume.samples.size, volume.apron.low);
        }
        Stage { permutation, entry, numbers: &numbers, texture: &volume.samples, n }.run(&self.device)
    }
}
