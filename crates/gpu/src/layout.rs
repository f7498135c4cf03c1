//! Memory layout of a plan as the shaders read it. Twins of the structs of `shaders/frame.wgsl`; a test compares the
//! layouts.

use bytemuck::{Pod, Zeroable};

/// `Lighting` of `frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct GpuLighting {
    /// Ambient, diffuse, specular, exponent.
    pub coefficients: [f32; 4],
    /// |n·l| where there is no normal; squared gradient above which there is one.
    pub limits: [f32; 4],
    /// Quadratic form of the squared world gradient on index gradients: uu, vv, ww, uv; uw, vw.
    pub metric: [[f32; 4]; 2],
    /// Offset of the lights in the tables, and their number.
    pub lights: [u32; 4],
}

/// `Layer` of `frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct GpuLayer {
    /// Offsets of the colours, the segments and the table of gradients; entries of the first two.
    pub tables: [u32; 4],
    /// First density, entries per density, last density, 1 / opacity unit.
    pub domain: [f32; 4],
    /// Densities beyond which nothing is visible; below and above which all is opaque.
    pub visible: [f32; 4],
    /// The only colour, and whether there is only one.
    pub only: [f32; 4],
    /// Entries of the table of gradients along densities and magnitudes.
    pub joint_size: [u32; 4],
    /// First density, steps per density, first magnitude, steps per magnitude.
    pub joint: [f32; 4],
    /// Quadratic form of the squared world gradient, as in [`GpuLighting::metric`].
    pub joint_metric: [[f32; 4]; 2],
    /// Direction to the eye as a linear form on index gradients, affine in the texel.
    pub to_eye: [[f32; 4]; 3],
    /// Lighting of the layer.
    pub lighting: GpuLighting,
}

/// `Source` of `frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct GpuSource {
    /// Offsets of the positions along u, along v, and of the sheets; groups along u.
    pub place: [u32; 4],
    /// Index of the last sample along x, y, z; groups along v.
    pub last: [i32; 4],
    /// Samples baked in before the first; offset of the page table.
    pub apron: [i32; 4],
    /// 1 / width, 1 / height of the texture; offset of differences; 1 / width in samples of the smoothing B-spline.
    pub texel: [f32; 4],
    /// Pages along x, y, z; texels of a page along each axis, 0 where all samples lie together.
    pub pages: [u32; 4],
}

impl GpuSource {
    /// Sets the size of the texture, and the number of samples baked in before the first.
    pub fn lies_in(&mut self, size: [usize; 3], before: usize) {
        self.apron = [before as i32; 4];
        (self.texel[0], self.texel[1]) = (1.0 / size[0] as f32, 1.0 / size[1] as f32);
    }
}

/// `Frame` of `frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct GpuFrame {
    /// Offset of the list of blocks, their number, workgroups in a row, words of a block's mask.
    pub blocks: [u32; 4],
    /// First slab and one past the last of this dispatch, number of all slabs, offset of the sheets' s.
    pub slabs: [u32; 4],
    /// The axis called w; 1 where this dispatch begins the rays.
    pub axes: [u32; 4],
    /// Parameters of the operator: opacity at which a ray is done, iso-value, threshold, or the two levels of a
    /// projection; then the rate of attenuated maxima.
    pub number: [f32; 4],
    /// Colour of the first hit.
    pub color: [f32; 4],
    /// World vector along the ray from slice to slice, affine in the texel.
    pub to_next: [[f32; 4]; 3],
    /// Depth shading at s = 0 and per s, affine in the texel.
    pub fade: [[f32; 4]; 2],
    /// Strengths of ambient occlusion and of the shadow.
    pub light: [f32; 4],
    /// Lighting of the label medium.
    pub label_lighting: GpuLighting,
}

/// Texels of a block along u and v, which a workgroup draws.
pub const BLOCK: [usize; 2] = [16, 8];

/// Texels of a block.
pub const N_BLOCK: usize = BLOCK[0] * BLOCK[1];

/// First binding of the textures, behind the buffers and the sampler.
pub const FIRST_TEXTURE: u32 = 8;

/// Bound of |s|: greater values, such as `NONE` of `frame.wgsl`, mean that there is no position or density.
pub const NO_POSITION: f32 = 1e38;
