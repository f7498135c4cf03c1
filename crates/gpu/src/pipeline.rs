//! Pipelines: compiled shaders and their bind group layouts, made at first use.

use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, BufferBindingType, ComputePipeline,
    ComputePipelineDescriptor, PipelineCompilationOptions, PipelineLayoutDescriptor, SamplerBindingType,
    ShaderModuleDescriptor, ShaderSource, ShaderStages, TextureSampleType, TextureViewDimension,
};

use crate::device::OpenDevice;
use crate::failure::GpuResult;
use crate::permutation::Permutation;

/// A compiled shader.
pub(crate) struct Pipeline {
    pub layout: BindGroupLayout,
    pub compute: ComputePipeline,
}

impl Pipeline {
    /// Compiles the pipeline that marches the rays of all pictures of one shader variant.
    pub fn new(device: &OpenDevice, permutation: &Permutation) -> GpuResult<Self> {
        Self::of(device, permutation, permutation.text(), "march")
    }

    /// Pipeline of a stage alone: an entry point `stage`.
    pub fn stage(device: &OpenDevice, permutation: &Permutation, entry: &str) -> GpuResult<Self> {
        Self::of(device, permutation, permutation.stage_text(entry), "stage")
    }

    fn of(device: &OpenDevice, permutation: &Permutation, text: String, entry_point: &str) -> GpuResult<Self> {
        device.guarded(|| {
            let module = device.device.create_shader_module(ShaderModuleDescriptor {
                label: Some(entry_point),
                source: ShaderSource::Wgsl(text.into()),
            });
            let layout = device.device.create_bind_group_layout(&BindGroupLayoutDescriptor {
                label: Some(entry_point),
                entries: &entries(permutation),
            });
            let pipeline_layout = device.device.create_pipeline_layout(&PipelineLayoutDescriptor {
                label: Some(entry_point),
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            });
            let compute = device.device.create_compute_pipeline(&ComputePipelineDescriptor {
                label: Some(entry_point),
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: PipelineCompilationOptions::default(),
                cache: None,
            });
            Ok(Self { layout, compute })
        })
    }
}

fn entries(permutation: &Permutation) -> Vec<BindGroupLayoutEntry> {
    let entry = |binding: u32, ty: BindingType| BindGroupLayoutEntry {
        binding,
        visibility: ShaderStages::COMPUTE,
        ty,
        count: None,
    };
    let buffer = |ty: BufferBindingType| BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None };
    let texture = BindingType::Texture {
        sample_type: TextureSampleType::Float { filterable: false },
        view_dimension: TextureViewDimension::D2Array,
        multisampled: false,
    };
    let read = BufferBindingType::Storage { read_only: true };
    let mut entries = vec![entry(0, buffer(BufferBindingType::Uniform))];
    entries.extend((1..5).map(|binding| entry(binding, buffer(read))));
    entries.push(entry(5, buffer(BufferBindingType::Storage { read_only: false })));
    entries.push(entry(6, BindingType::Sampler(SamplerBindingType::NonFiltering)));
    for (k, source) in permutation.sources.iter().enumerate() {
        entries.push(entry(Permutation::samples_binding(k), texture));
        if source.has_holes {
            entries.push(entry(permutation.holes_binding(k), texture));
        }
    }
    entries
}
