//! Device that draws the base planes of a frame: the CPU, or a GPU where there is one that draws the same.

use wavesplat_core::Result;
use wavesplat_splat::picture::base_picture::BasePicture;
use wavesplat_splat::render::frame::draw_base_planes;
use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::{ProgressCallback, Report};

/// Device that should draw. Where a GPU cannot, the CPU draws, and [`DrawnBy::reason`] says why.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Device {
    /// The CPU.
    #[default]
    Cpu,
    /// The best GPU where there is one, from the second frame of a process on, as soon as it is open.
    Auto,
    /// The best GPU. Software renderers on the CPU do not count.
    Gpu,
    /// The GPU of this name, else the first whose name contains it, ignoring case.
    Named(String),
}

/// Device that drew a frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DrawnBy {
    /// "cpu", or the name of the GPU.
    pub name: String,
    /// Reason why the CPU drew in place of a GPU, or why the GPU was opened once more; `None` where the CPU was asked
    /// for.
    pub reason: Option<String>,
    /// Adapter and cost of the frame, if a GPU drew it.
    #[cfg(feature = "gpu")]
    pub gpu: Option<(wavesplat_gpu::Adapter, wavesplat_gpu::GpuReport)>,
}

impl DrawnBy {
    /// A frame drawn by the CPU. `reason`: why no GPU drew it.
    pub fn cpu(reason: Option<String>) -> Self {
        Self {
            name: "cpu".to_owned(),
            reason,
            #[cfg(feature = "gpu")]
            gpu: None,
        }
    }
}

impl Device {
    /// Draws the base planes of a plan. `slices`: one per layer.
    pub(crate) fn draw_base_planes(
        &self,
        plan: &Plan,
        slices: &[&Slices],
        callback: &dyn ProgressCallback,
    ) -> Result<(Vec<BasePicture>, Report, DrawnBy)> {
        let by_cpu = |reason: Option<String>| {
            let (pictures, report) = draw_base_planes(plan, slices, callback)?;
            Ok((pictures, report, DrawnBy::cpu(reason)))
        };
        if *self == Self::Cpu {
            return by_cpu(None);
        }
        #[cfg(feature = "gpu")]
        return match self.on_gpu(plan, slices, callback) {
            Ok(drawn) => Ok(drawn),
            Err(wavesplat_gpu::Failure::Cancelled) => Err(wavesplat_core::Error::Cancelled),
            Err(failure) => by_cpu(Some(failure.to_string())),
        };
        #[cfg(not(feature = "gpu"))]
        by_cpu(Some("this build has no GPU path".to_owned()))
    }

    #[cfg(feature = "gpu")]
    fn on_gpu(
        &self,
        plan: &Plan,
        slices: &[&Slices],
        callback: &dyn ProgressCallback,
    ) -> wavesplat_gpu::GpuResult<(Vec<BasePicture>, Report, DrawnBy)> {
        use wavesplat_gpu::{Choice, DeviceChoice, Gpus};
        let choice = match self {
            Self::Cpu => DeviceChoice::Cpu,
            Self::Auto => DeviceChoice::Auto,
            Self::Gpu => DeviceChoice::Gpu(Choice::Best),
            Self::Named(part) => DeviceChoice::Gpu(Choice::Named(part.clone())),
        };
        let drawn = Gpus::of_process().draw_base_planes(&choice, plan, slices, callback)?;
        let report = Report { n_texels: drawn.report.n_texels, ..Report::of(plan) };
        let reason = drawn.reopened.map(|why| format!("the GPU was lost and opened once more: {why}"));
        let name = drawn.adapter.name.clone();
        Ok((drawn.pictures, report, DrawnBy { name, reason, gpu: Some((drawn.adapter, drawn.report)) }))
    }
}
