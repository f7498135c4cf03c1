//! A stage of a frame alone, fed with plain numbers: for the self-test, and for the stage fixtures of the tests
//! (`docs/design/012-stage-fixtures.md`).

use wgpu::{BufferDescriptor, BufferUsages, CommandEncoderDescriptor, ComputePassDescriptor};

use crate::buffers::{Buffers, bind_group, read_buffer};
use crate::device::OpenDevice;
use crate::failure::GpuResult;
use crate::numbers::Numbers;
use crate::permutation::Permutation;
use crate::pipeline::Pipeline;
use crate::samples::SampleTexture;

/// A stage and its inputs.
pub(crate) struct Stage<'a> {
    /// Permutation that the stage is a part of; it has one source without holes.
    pub permutation: &'a Permutation,
    /// WGSL of an entry point `stage`, workgroups of 64, that writes to `state`.
    pub entry: &'a str,
    /// Parameters, tables and words.
    pub numbers: &'a Numbers,
    /// Samples of the only source.
    pub texture: &'a SampleTexture,
    /// Number of vec4s that are written.
    pub n: usize,
}

impl Stage<'_> {
    /// Runs the stage and returns the vec4s that it writes.
    pub fn run(&self, device: &OpenDevice) -> GpuResult<Vec<[f32; 4]>> {
        let pipeline = Pipeline::stage(device, self.permutation, self.entry)?;
        device.guarded(|| self.run_by(device, &pipeline))
    }

    fn run_by(&self, device: &OpenDevice, pipeline: &Pipeline) -> GpuResult<Vec<[f32; 4]>> {
        let parameters = self.numbers.parameters(&self.numbers.frame);
        let (mut kept, moved, storage) = (Buffers::default(), &mut 0, BufferUsages::STORAGE);
        let Buffers { parameters: uniform, words, tables, intervals, occupied, .. } = &mut kept;
        let state = device.device.create_buffer(&BufferDescriptor {
            label: None,
            size: 16 * self.n as u64,
            usage: storage | BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let buffers = [
            uniform.with(device, &[&parameters], BufferUsages::UNIFORM, moved),
            words.with(device, &[bytemuck::cast_slice(&self.numbers.words)], storage, moved),
            tables.with(device, &[bytemuck::cast_slice(&self.numbers.tables)], storage, moved),
            intervals.of(device, 0, storage),
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
            pass.dispatch_workgroups(self.n.div_ceil(64) as u32, 1, 1);
        }
        device.queue.submit([encoder.finish()]);
        let read = kept.read_back.of(device, 16 * self.n, BufferUsages::MAP_READ | BufferUsages::COPY_DST);
        let view = read_buffer(device, &state, read, 16 * self.n)?;
        Ok(bytemuck::cast_slice(&view).to_vec())
    }
}
