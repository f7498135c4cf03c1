//! All that one dispatch reads, as bytes: for hosts other than this crate, such as browsers, whose WebGPU runs the same
//! shaders.

use wavesplat_splat::render::plan::Plan;
use wavesplat_splat::render::plan_arrays::BasePlaneArrays;
use wavesplat_splat::source::slices::Slices;

use crate::band::bands;
use crate::failure::{Failure, GpuResult};
use crate::layout::N_BLOCK;
use crate::numbers::Numbers;
use crate::permutation::{Format, Permutation};
use crate::samples::{TexelBox, bytes_of};
use crate::scene_kind::{apron_of, permutation_of, sources_of};

/// A dispatch that draws a base plane from its first slab to its last.
pub struct Capture {
    /// WGSL; its entry point is `march`.
    pub shader: String,
    /// Contents of the bindings 0 to 4: parameters (uniform), words, tables, intervals, occupied (read-only storage).
    pub buffers: [Vec<u8>; 5],
    /// Bytes of binding 5, the state that is written: block by block, row by row, one or two vec4s per texel.
    pub n_state_bytes: usize,
    /// Textures; binding 6 is a sampler that filters nothing.
    pub textures: Vec<CapturedTexture>,
    /// Workgroups along x and y.
    pub groups: [usize; 2],
    /// First texel of each block along u and v; a block has 16 x 8 texels.
    pub blocks: Vec<[usize; 2]>,
}

/// A texture array of samples.
pub struct CapturedTexture {
    /// Binding of the texture.
    pub binding: u32,
    /// Texture format by its WebGPU name.
    pub format: &'static str,
    /// Width, height, layers.
    pub size: [usize; 3],
    /// Texels, layer by layer, row by row.
    pub bytes: Vec<u8>,
}

/// Captures the dispatch of a plan that has one base plane of one band. `slices`: one per layer.
pub fn capture(plan: &Plan, slices: &[&Slices]) -> GpuResult<Capture> {
    let permutation = permutation_of(plan, slices, true)?;
    let [family] = &plan.families[..] else {
        return Err(Failure::DrawnByCpu("a capture has one base plane".to_owned()));
    };
    let arrays = BasePlaneArrays::new(plan, 0, slices);
    let sources = sources_of(plan, slices);
    let fields: Vec<usize> = sources.iter().filter_map(|source| source.field).collect();
    let mut numbers = Numbers::new(plan, family, &arrays, &fields);
    let mut textures = Vec::new();
    for (k, (source, kind)) in sources.iter().zip(&permutation.sources).enumerate() {
        let apron = apron_of(kind);
        let part = TexelBox::whole(source.first().grid().size(), apron);
        numbers.sources[k].lies_in(part.size, apron.low);
        let (samples, holes) = bytes_of(&source.slices, part);
        let format = match kind.format {
            Format::Byte { .. } => "r8unorm",
            Format::Pair { .. } => "rg8unorm",
            Format::Float => "r32float",
            Format::Four => "rgba32float",
        };
        let texture = |binding: u32, format: &'static str, bytes: Vec<u8>| CapturedTexture {
            binding,
            format,
            size: part.size,
            bytes,
        };
        textures.push(texture(Permutation::samples_binding(k), format, samples));
        textures.extend(holes.map(|bytes| texture(permutation.holes_binding(k), "r8unorm", bytes)));
    }
    let bands = bands(family, &arrays, plan.layers.len(), true);
    let [band] = &bands[..] else { return Err(Failure::DrawnByCpu("a capture has one band".to_owned())) };
    let n_blocks = band.blocks.len();
    let (mut frame, blocks) = numbers.of_band(family, band, n_blocks);
    (frame.slabs[0], frame.slabs[1], frame.axes[1]) = (band.slabs[0] as u32, family.spacing.n_slabs as u32, 1);
    let bytes = |words: &[u32]| bytemuck::cast_slice(words).to_vec();
    Ok(Capture {
        shader: permutation.text(),
        buffers: [
            numbers.parameters(&frame),
            [bytes(&numbers.words), bytes(&blocks)].concat(),
            bytemuck::cast_slice(&numbers.tables).to_vec(),
            bytemuck::cast_slice(&band.intervals.concat()).to_vec(),
            bytes(&band.occupied.concat()),
        ],
        n_state_bytes: 16 * permutation.n_state() * n_blocks * N_BLOCK,
        textures,
        groups: [n_blocks, 1],
        blocks: band.blocks.iter().map(|[strip, row]| [strip * 16, row * 8]).collect(),
    })
}
