//! Buffers that are kept from frame to frame, bind groups, and reading back.

use std::time::Duration;

use wgpu::{
    BindGroup, BindGroupDescriptor, BindGroupEntry, BindingResource, Buffer, BufferDescriptor, BufferUsages,
    BufferView, CommandEncoderDescriptor, FilterMode, MapMode, SamplerDescriptor, TextureView,
};

use crate::device::OpenDevice;
use crate::failure::{Failure, GpuResult};
use crate::pipeline::Pipeline;

/// Minimum size of a buffer in bytes: an empty one cannot be bound.
const MIN_BYTES: u64 = 256;

/// The buffers of a dispatch, kept from frame to frame.
#[derive(Default)]
pub(crate) struct Buffers {
    pub parameters: GrowingBuffer,
    pub words: GrowingBuffer,
    pub tables: GrowingBuffer,
    pub intervals: GrowingBuffer,
    pub occupied: GrowingBuffer,
    pub state: GrowingBuffer,
    pub read_back: GrowingBuffer,
}

/// A buffer that grows.
#[derive(Default)]
pub(crate) struct GrowingBuffer(pub Option<Buffer>);

impl GrowingBuffer {
    /// The buffer, with room for `n_bytes`; made anew where it is too small or more than 8 times too large.
    pub fn of(&mut self, device: &OpenDevice, n_bytes: usize, usage: BufferUsages) -> &Buffer {
        let size = (n_bytes as u64).next_multiple_of(16).max(MIN_BYTES);
        let fits = self.0.as_ref().is_some_and(|own| own.size() >= size && own.size() <= 8 * size);
        if !fits {
            self.0 = None;
        }
        self.0.get_or_insert_with(|| {
            device.device.create_buffer(&BufferDescriptor { label: None, size, usage, mapped_at_creation: false })
        })
    }

    /// The buffer, filled with parts, one behind the other; the number of their bytes is added to `moved`.
    pub fn with(&mut self, device: &OpenDevice, parts: &[&[u8]], usage: BufferUsages, moved: &mut u64) -> &Buffer {
        let n_bytes = parts.iter().map(|part| part.len()).sum();
        let buffer = self.of(device, n_bytes, usage | BufferUsages::COPY_DST);
        let mut offset = 0;
        for part in parts {
            device.queue.write_buffer(buffer, offset, part);
            offset += part.len() as u64;
        }
        *moved += offset;
        buffer
    }
}

/// Reads a buffer through `by`, which can be mapped; the caller unmaps `by` when done with the view.
pub(crate) fn read_buffer(device: &OpenDevice, from: &Buffer, by: &Buffer, n_bytes: usize) -> GpuResult<BufferView> {
    let mut encoder = device.device.create_command_encoder(&CommandEncoderDescriptor::default());
    encoder.copy_buffer_to_buffer(from, 0, by, 0, Some(n_bytes as u64));
    device.queue.submit([encoder.finish()]);
    let (sender, receiver) = std::sync::mpsc::channel();
    by.map_async(MapMode::Read, ..n_bytes as u64, move |mapped| {
        let _ = sender.send(mapped);
    });
    device.wait()?;
    // The callback may run on another thread that waits for the device.
    match receiver.recv_timeout(Duration::from_secs(10)) {
        Ok(Ok(())) => {}
        Ok(Err(error)) => return Err(Failure::Refused(error.to_string())),
        Err(_) => return Err(Failure::Lost("what it drew never came back".to_owned())),
    }
    by.get_mapped_range(..n_bytes as u64).map_err(|error| Failure::Refused(error.to_string()))
}

/// Bind group of a shader: buffers at bindings 0 to 5, the sampler at 6, and textures.
pub(crate) fn bind_group<'a>(
    device: &OpenDevice,
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
