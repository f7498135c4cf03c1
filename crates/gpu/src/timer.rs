//! Duration of passes, by the GPU's own clock.

use wgpu::{
    Buffer, BufferDescriptor, BufferUsages, CommandEncoder, CommandEncoderDescriptor, ComputePassTimestampWrites,
    QuerySet, QuerySetDescriptor, QueryType,
};

use crate::buffers::read_buffer;
use crate::device::OpenDevice;
use crate::failure::GpuResult;

/// Most passes that are timed.
const MAX_PASSES: u32 = 128;

/// Bytes of a timestamp.
const TIME: u64 = 8;

/// Timestamps of passes.
pub(crate) struct Timer {
    queries: QuerySet,
    n: u32,
}

impl Timer {
    /// An empty timer; `None` where the GPU has no timestamps.
    pub fn new(device: &OpenDevice) -> Option<Self> {
        let descriptor = QuerySetDescriptor { label: None, ty: QueryType::Timestamp, count: 2 * MAX_PASSES };
        device.has_timestamps.then(|| Self { queries: device.device.create_query_set(&descriptor), n: 0 })
    }

    /// Timestamps of the next pass; `None` beyond [`MAX_PASSES`].
    pub fn next(&mut self) -> Option<ComputePassTimestampWrites<'_>> {
        self.n += 1;
        let first = 2 * (self.n - 1);
        (self.n <= MAX_PASSES).then_some(ComputePassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    /// Seconds of all passes together; `None` where there are none, or more than [`MAX_PASSES`].
    pub fn seconds(&self, device: &OpenDevice) -> GpuResult<Option<f64>> {
        if self.n == 0 || self.n > MAX_PASSES {
            return Ok(None);
        }
        let size = u64::from(2 * self.n) * TIME;
        let buffer = |usage: BufferUsages| -> Buffer {
            device.device.create_buffer(&BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
        };
        let resolved = buffer(BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC);
        let read = buffer(BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        let mut encoder: CommandEncoder = device.device.create_command_encoder(&CommandEncoderDescriptor::default());
        encoder.resolve_query_set(&self.queries, 0..2 * self.n, &resolved, 0);
        device.queue.submit([encoder.finish()]);
        let view = read_buffer(device, &resolved, &read, size as usize)?;
        let times: &[u64] = bytemuck::cast_slice(&view);
        let ticks: u64 = times.as_chunks::<2>().0.iter().map(|[begin, end]| end.saturating_sub(*begin)).sum();
        Ok(Some(ticks as f64 * f64::from(device.queue.get_timestamp_period()) * 1e-9))
    }
}
