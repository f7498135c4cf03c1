//! What is uploaded of a plan, as the shaders read it. Twins of the structs of `shaders/frame.wgsl`; a test holds their
//! layouts together.

use bytemuck::{Pod, Zeroable};

/// `Lighting` of `frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct GpuLighting {
    /// Ambient, diffuse, specular, exponent.
    pub coefficients: [f32; 4],
    /// |n·l| without a normal; squared gradient from which on there is one.
    pub limits: [f32; 4],
    /// uu, vv, ww, uv; uw, vw.
    pub metric: [[f32; 4]; 2],
    /// Place of the lights in the tables, and how many.
    pub lights: [u32; 4],
}

/// `Layer` of `frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct GpuLayer {
    /// Places of the colours, the segments and the table of gradients; entries of the first two.
    pub tables: [u32; 4],
    /// First density, entries per density, last density, 1 / opacity unit.
    pub domain: [f32; 4],
    /// Densities beyond which nothing is visible.
    pub visible: [f32; 4],
    /// The only colour, and whether there is only one.
    pub only: [f32; 4],
    /// Entries along densities and magnitudes.
    pub joint_size: [u32; 4],
    /// First density, steps per density, first magnitude, steps per magnitude.
    pub joint: [f32; 4],
    /// As of the lighting.
    pub joint_metric: [[f32; 4]; 2],
    /// Towards the eye, as a form on index gradients, affine in the texel.
    pub to_eye: [[f32; 4]; 3],
    /// Lights.
    pub lighting: GpuLighting,
}

/// `Source` of `frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct GpuSource {
    /// Places of the positions along u, along v, and of the sheets; groups along u.
    pub place: [u32; 4],
    /// Position of the last sample along x, y, z; groups along v.
    pub last: [i32; 4],
    /// Samples before the first; place of the page table.
    pub apron: [i32; 4],
    /// 1 / width, 1 / height; half distance of differences; taps per width of smoothed gradients.
    pub texel: [f32; 4],
    /// Pages along x, y, z; texels of a page along each axis, 0 where all samples lie together.
    pub pages: [u32; 4],
}

impl GpuSource {
    /// Says how large the texture is that its samples lie in, and how many samples lie there before the first.
    pub fn lies_in(&mut self, size: [usize; 3], before: usize) {
        self.apron = [before as i32; 4];
        (self.texel[0], self.texel[1]) = (1.0 / size[0] as f32, 1.0 / size[1] as f32);
    }
}

/// `Frame` of `frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub struct GpuFrame {
    /// Place of the list of blocks, how many, workgroups in a row, words of the masks per block.
    pub blocks: [u32; 4],
    /// First slab and one past the last of this dispatch, all slabs, place of the sheets' s.
    pub slabs: [u32; 4],
    /// The axis called w; 1 where this dispatch begins the rays.
    pub axes: [u32; 4],
    /// What the operator needs.
    pub number: [f32; 4],
    /// Colour of the first hit.
    pub color: [f32; 4],
    /// The way from slice to slice, world, affine in the texel.
    pub to_next: [[f32; 4]; 3],
    /// Depth shading at s = 0 and per s, affine in the texel.
    pub fade: [[f32; 4]; 2],
    /// Strengths of ambient occlusion and of the shadow.
    pub light: [f32; 4],
    /// Light on the label medium.
    pub label_lighting: GpuLighting,
}

/// Texels of a block along u and v, which a workgroup draws.
pub const BLOCK: [usize; 2] = [16, 8];

/// Texels of a block.
pub const N_BLOCK: usize = BLOCK[0] * BLOCK[1];

/// Bindings of the buffers and of the sampler; textures follow.
pub const FIRST_TEXTURE: u32 = 8;

/// Positions of opacity 1/2 from which on there is none (`NONE` of `frame.wgsl`).
pub const NO_PLACE: f32 = 1e38;
