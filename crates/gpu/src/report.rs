//! Cost of a frame on a GPU.

use crate::device::OpenDevice;
use crate::failure::GpuResult;
use crate::timer::Timer;

/// Cost of a frame on a GPU.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GpuReport {
    /// Texels of base planes.
    pub n_base_texels: u64,
    /// Texels of occupied slabs, block by block, whether or not rays get that far.
    pub n_texels: u64,
    /// Number of dispatches.
    pub n_dispatches: u64,
    /// Whether samples are uploaded in pages, visible ones only.
    pub is_paged: bool,
    /// Bytes of the pages that were uploaded.
    pub n_page_bytes: u64,
    /// Bytes of samples on the GPU.
    pub n_sample_bytes: u64,
    /// Bytes that were uploaded for this frame, samples excluded, and read back.
    pub n_bytes_moved: u64,
    /// Seconds of the longest dispatch, including the wait for it.
    pub longest_seconds: f64,
    /// Quads of samples that were fetched, and texels of sheets that were reconstructed, if they were counted.
    pub counted: Option<[u64; 2]>,
    /// Seconds on the GPU's clock, where passes can be timed.
    pub seconds: Option<f64>,
    /// Seconds of the parts of the frame.
    pub wall: WallSeconds,
}

/// Wall-clock seconds of the parts of a frame that lie between its plan and its warp.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct WallSeconds {
    /// On the CPU: intervals of rays, masks of occupied slabs, and tables.
    pub prepare: f64,
    /// Uploads, and dispatches with the wait for each.
    pub march: f64,
    /// Copying texels from the GPU into base planes.
    pub read_back: f64,
}

/// Running counts of a frame.
#[derive(Default)]
pub(crate) struct FrameCounts {
    pub base_texels: u64,
    pub texels: u64,
    pub dispatches: u64,
    pub longest_seconds: f64,
    pub bytes_moved: u64,
    pub counted: [u64; 2],
    pub page_bytes: u64,
    pub timer: Option<Timer>,
    pub wall: WallSeconds,
}

impl FrameCounts {
    /// Zero counts, with a timer where the device has one.
    pub fn new(device: &OpenDevice) -> Self {
        Self { timer: Timer::new(device), ..Self::default() }
    }

    /// Report of these counts, without samples and pages.
    pub fn report(&self, device: &OpenDevice) -> GpuResult<GpuReport> {
        let seconds = self.timer.as_ref().map(|timer| timer.seconds(device)).transpose()?.flatten();
        Ok(GpuReport {
            n_base_texels: self.base_texels,
            n_texels: self.texels,
            n_dispatches: self.dispatches,
            longest_seconds: self.longest_seconds,
            n_bytes_moved: self.bytes_moved,
            n_page_bytes: self.page_bytes,
            counted: (self.counted[1] > 0).then_some(self.counted),
            seconds,
            wall: self.wall,
            ..GpuReport::default()
        })
    }
}
