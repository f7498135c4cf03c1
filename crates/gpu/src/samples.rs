//! Samples on the GPU: 2-D texture arrays, one layer per slice along z, exact. The samples that stand beyond the faces,
//! repeated or mirrored by the kernel, are baked in around them. Twin of `SliceRectangle::combine`
//! (crates/splat/src/source/window.rs).

use wavesplat_core::{Kernel, Samples};
use wavesplat_splat::kernel::weights::mirror_index;
use wavesplat_splat::source::slices::Slices;
use wavesplat_splat::source::window::Window;
use wgpu::{
    Extent3d, Origin3d, TexelCopyBufferLayout, TexelCopyTextureInfo, TextureAspect, TextureDescriptor,
    TextureDimension, TextureFormat, TextureUsages, TextureView, TextureViewDescriptor, TextureViewDimension,
};

use crate::device::OpenDevice;
use crate::failure::{Failure, GpuResult};
use crate::permutation::Format;

/// Margin of samples that are baked in along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Apron {
    /// Samples before the first.
    pub low: usize,
    /// Samples after the last.
    pub high: usize,
}

/// Bytes that are copied at once: staging takes the same amount of memory again.
const BYTES_AT_ONCE: usize = 16 << 20;

impl Format {
    /// Storage format of slices.
    pub(crate) fn of(slices: &Slices) -> Self {
        match slices.own_samples() {
            Some(Samples::U8(_)) => Self::Byte { is_signed: false },
            Some(Samples::I8(_)) => Self::Byte { is_signed: true },
            Some(Samples::U16(_)) => Self::Pair { is_signed: false },
            Some(Samples::I16(_)) => Self::Pair { is_signed: true },
            _ => Self::Float,
        }
    }

    /// Bytes of a sample.
    pub(crate) fn n_bytes(self) -> usize {
        match self {
            Self::Byte { .. } => 1,
            Self::Pair { .. } => 2,
            Self::Float => 4,
            Self::Four => 16,
        }
    }

    fn texture_format(self) -> TextureFormat {
        match self {
            Self::Byte { .. } => TextureFormat::R8Unorm,
            Self::Pair { .. } => TextureFormat::Rg8Unorm,
            Self::Float => TextureFormat::R32Float,
            Self::Four => TextureFormat::Rgba32Float,
        }
    }
}

/// A texture array of samples.
pub(crate) struct SampleTexture {
    pub view: TextureView,
    pub size: [usize; 3],
    pub n_bytes: usize,
    texture: wgpu::Texture,
    /// Bytes of a sample.
    pub n_bytes_sample: usize,
}

impl SampleTexture {
    /// An empty texture of `size` samples.
    pub fn new(device: &OpenDevice, size: [usize; 3], format: Format) -> GpuResult<Self> {
        Self::of_format(device, size, format.texture_format(), format.n_bytes())
    }

    fn of_format(
        device: &OpenDevice,
        size: [usize; 3],
        format: TextureFormat,
        n_bytes_sample: usize,
    ) -> GpuResult<Self> {
        let side = device.limits.max_texture_dimension_2d as usize;
        let n_layers = device.limits.max_texture_array_layers as usize;
        if size[0] > side || size[1] > side || size[2] > n_layers {
            let [x, y, z] = size;
            return Err(Failure::Memory(format!(
                "{x} x {y} x {z} samples are more than a texture of this GPU holds, {side} x {side} x {n_layers}"
            )));
        }
        let texture = device.device.create_texture(&TextureDescriptor {
            label: Some("samples"),
            size: extent(size),
            mip_level_count: 1,
            sample_count: 1,
            dimension: TextureDimension::D2,
            format,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let view = texture.create_view(&TextureViewDescriptor {
            dimension: Some(TextureViewDimension::D2Array),
            ..TextureViewDescriptor::default()
        });
        let n_bytes = size.iter().product::<usize>() * n_bytes_sample;
        Ok(Self { view, size, n_bytes, texture, n_bytes_sample })
    }

    /// Copies the bytes of a box of samples to `origin`.
    pub fn write(&self, device: &OpenDevice, origin: [usize; 3], size: [usize; 3], bytes: &[u8]) {
        let [x, y, z] = origin.map(|o| o as u32);
        device.queue.write_texture(
            TexelCopyTextureInfo {
                texture: &self.texture,
                mip_level: 0,
                origin: Origin3d { x, y, z },
                aspect: TextureAspect::All,
            },
            bytes,
            TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some((size[0] * self.n_bytes_sample) as u32),
                rows_per_image: Some(size[1] as u32),
            },
            extent(size),
        );
    }
}

fn extent([width, height, depth]: [usize; 3]) -> Extent3d {
    Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: depth as u32 }
}

/// A box of samples of a volume, which may extend beyond its faces.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TexelBox {
    /// Index of the first sample, before [`mirror_index`].
    pub lo: [i64; 3],
    /// Samples along x, y, z.
    pub size: [usize; 3],
}

impl TexelBox {
    /// The whole volume with an apron.
    pub fn whole(size: [usize; 3], apron: Apron) -> Self {
        Self { lo: [-(apron.low as i64); 3], size: size.map(|n| n + apron.low + apron.high) }
    }
}

/// Copies a box of samples to `to` in the texture, some slices at a time.
pub(crate) fn upload(
    device: &OpenDevice,
    slices: &[&Slices],
    texture: &SampleTexture,
    part: TexelBox,
    to: [usize; 3],
) -> GpuResult<()> {
    copy_slices(device, texture, part, to, |k, bytes| push_all(slices, part, k, bytes))
}

/// Copies a box of the hole mask to `to` in the texture: 255 where a sample is drawn as empty.
pub(crate) fn upload_holes(
    device: &OpenDevice,
    slices: &Slices,
    texture: &SampleTexture,
    part: TexelBox,
    to: [usize; 3],
) -> GpuResult<()> {
    copy_slices(device, texture, part, to, |k, bytes| push_holes(slices, part, k, bytes))
}

/// Bytes of a box of a source's samples, and of its hole mask where it has one.
pub(crate) fn bytes_of(slices: &[&Slices], part: TexelBox) -> (Vec<u8>, Option<Vec<u8>>) {
    let [mut samples, mut holes] = [Vec::new(), Vec::new()];
    for k in 0..part.size[2] {
        push_all(slices, part, k, &mut samples);
        push_holes(slices[0], part, k, &mut holes);
    }
    (samples, slices[0].has_mask().then_some(holes))
}

/// Appends the `k`th slice of a box in its storage format: of one volume, or of four fields side by side.
fn push_all(slices: &[&Slices], part: TexelBox, k: usize, bytes: &mut Vec<u8>) {
    let [only] = slices else {
        let fields: Vec<Vec<f32>> = slices.iter().map(|slices| densities_of(slices, part, k)).collect();
        for i in 0..fields[0].len() {
            for field in &fields {
                bytes.extend_from_slice(&field[i].to_ne_bytes());
            }
        }
        return;
    };
    push_slice(only, Format::of(only), part, k, bytes);
}

/// Densities of the `k`th slice of a box.
fn densities_of(slices: &Slices, part: TexelBox, k: usize) -> Vec<f32> {
    let z = mirror_index(slices.kernel(), part.lo[2] + k as i64, slices.grid().size()[2]);
    let window = |a: usize| [part.lo[a], part.lo[a] + part.size[a] as i64 - 1];
    let mut densities = Vec::new();
    slices.density_slice(z, Window { u: window(0), v: window(1) }, &mut densities);
    densities
}

/// Appends the hole mask of the `k`th slice of a box: 255 where a sample is drawn as empty.
fn push_holes(slices: &Slices, part: TexelBox, k: usize, bytes: &mut Vec<u8>) {
    let (size, kernel) = (slices.grid().size(), slices.kernel());
    let Some(holes) = slices.holes() else { return };
    let z = mirror_index(kernel, part.lo[2] + k as i64, size[2]);
    let xs = folded(kernel, part.lo[0], part.size[0], size[0]);
    for y in folded(kernel, part.lo[1], part.size[1], size[1]) {
        let row = &holes[(z * size[1] + y) * size[0]..][..size[0]];
        bytes.extend(xs.iter().map(|x| if row[*x] { u8::MAX } else { 0 }));
    }
}

/// An empty texture for a hole mask.
pub(crate) fn hole_texture(device: &OpenDevice, size: [usize; 3]) -> GpuResult<SampleTexture> {
    SampleTexture::of_format(device, size, TextureFormat::R8Unorm, 1)
}

fn copy_slices(
    device: &OpenDevice,
    texture: &SampleTexture,
    part: TexelBox,
    to: [usize; 3],
    push: impl Fn(usize, &mut Vec<u8>),
) -> GpuResult<()> {
    let [nx, ny, nz] = part.size;
    let per_slice = nx * ny * texture.n_bytes_sample;
    let at_once = (BYTES_AT_ONCE / per_slice).clamp(1, nz);
    let mut bytes = Vec::with_capacity(at_once * per_slice);
    for first in (0..nz).step_by(at_once) {
        bytes.clear();
        let n = at_once.min(nz - first);
        (first..first + n).for_each(|k| push(k, &mut bytes));
        texture.write(device, [to[0], to[1], to[2] + first], [nx, ny, n], &bytes);
        if first + n < nz {
            // Otherwise all slices would be staged at the same time.
            device.queue.submit([]);
            device.wait()?;
        }
    }
    Ok(())
}

fn folded(kernel: Kernel, first: i64, n: usize, size: usize) -> Vec<usize> {
    (first..first + n as i64).map(|i| mirror_index(kernel, i, size)).collect()
}

/// Appends the `k`th slice of a box of one volume in its storage format.
fn push_slice(slices: &Slices, format: Format, part: TexelBox, k: usize, bytes: &mut Vec<u8>) {
    let (size, kernel) = (slices.grid().size(), slices.kernel());
    let z = mirror_index(kernel, part.lo[2] + k as i64, size[2]);
    let rows = folded(kernel, part.lo[1], part.size[1], size[1]);
    let columns = folded(kernel, part.lo[0], part.size[0], size[0]);
    let row = |y: usize| (z * size[1] + y) * size[0];
    match slices.own_samples() {
        Some(Samples::U8(samples)) => {
            for y in &rows {
                bytes.extend(columns.iter().map(|x| samples[row(*y) + x]));
            }
        }
        Some(Samples::I8(samples)) => {
            let stored = |y: usize, x: usize| samples[row(y) + x] as u8 ^ 0x80;
            for y in &rows {
                bytes.extend(columns.iter().map(|x| stored(*y, *x)));
            }
        }
        Some(Samples::U16(samples)) => {
            for y in &rows {
                bytes.extend(columns.iter().flat_map(|x| samples[row(*y) + x].to_le_bytes()));
            }
        }
        Some(Samples::I16(samples)) => {
            let stored = |y: usize, x: usize| (samples[row(y) + x] as u16 ^ 0x8000).to_le_bytes();
            for y in &rows {
                bytes.extend(columns.iter().flat_map(|x| stored(*y, *x)));
            }
        }
        _ => {
            debug_assert_eq!(format, Format::Float);
            let densities = densities_of(slices, part, k);
            bytes.extend_from_slice(bytemuck::cast_slice(&densities));
        }
    }
}
