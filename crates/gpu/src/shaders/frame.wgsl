// Plan of a frame as plain numbers. Twin of the structs of `layout.rs`.

struct Frame {
    // Offset of the list of blocks in `words`; number of blocks; workgroups in a row of the dispatch; words of the mask
    // of occupied slabs, per block and layer.
    blocks: vec4<u32>,
    // First slab of this dispatch and one past its last; number of all slabs; offset of the sheets' s in `words`.
    slabs: vec4<u32>,
    // The index axis called w; whether this dispatch begins the rays.
    axes: vec4<u32>,
    // Parameter of the operator: opacity at which a ray is done, iso-value, threshold, or level.
    number: vec4<f32>,
    // Colour of the first hit.
    color: vec4<f32>,
    // World vector along the ray from slice to slice: at texel (0, 0), and its change per texel along u and along v.
    to_next: array<vec4<f32>, 3>,
    // Depth shading along a ray, at s = 0 and per s: at texel (0, 0), and the changes per texel along u and along v.
    fade: array<vec4<f32>, 2>,
    // Strengths of ambient occlusion and of the shadow.
    light: vec4<f32>,
    // Lighting of the label medium.
    label_lighting: Lighting,
}

struct Lighting {
    // Ambient, diffuse, specular, exponent.
    coefficients: vec4<f32>,
    // |n.l| where there is no normal; squared gradient above which there is one; strength of even
    // light on cut faces.
    limits: vec4<f32>,
    // Quadratic form of the squared world gradient on index gradients: uu, vv, ww, uv; uw, vw.
    metric: array<vec4<f32>, 2>,
    // Offset in `tables` of the lights, and their number.
    lights: vec4<u32>,
}

struct Layer {
    // Offsets in `tables` of the colours, the segments and the table of gradients; entries of the first two.
    tables: vec4<u32>,
    // Density of the first entry, entries per density, density of the last entry, 1 / opacity unit.
    domain: vec4<f32>,
    // Densities beyond which nothing is visible; below and above which all is opaque.
    visible: vec4<f32>,
    // The only colour, and whether there is only one.
    only: vec4<f32>,
    // Table of gradients: entries along densities and magnitudes.
    joint_size: vec4<u32>,
    // First density, steps per density, first magnitude, steps per magnitude.
    joint: vec4<f32>,
    joint_metric: array<vec4<f32>, 2>,
    // Direction to the eye, a linear form on index gradients: at texel (0, 0), and its change per texel along u and v.
    to_eye: array<vec4<f32>, 3>,
    lighting: Lighting,
}

struct Source {
    // Offsets in `words` of the positions along u, along v, and of the sheets; groups along u.
    place: vec4<u32>,
    // Index of the last sample along x, y, z; groups along v.
    last: vec4<i32>,
    // Samples baked in before the first; offset in `words` of the page table.
    apron: vec4<i32>,
    // 1 / width and 1 / height of the texture; offset of differences; 1 / width in samples of the smoothing B-spline.
    texel: vec4<f32>,
    // Pages along x, y, z; texels of a page along each axis, 0 where all samples lie together.
    pages: vec4<u32>,
}

struct Parameters {
    frame: Frame,
    layers: array<Layer, N_LAYERS>,
    sources: array<Source, N_SOURCES>,
}

@group(0) @binding(0) var<uniform> parameters: Parameters;
@group(0) @binding(1) var<storage, read> words: array<u32>;
@group(0) @binding(2) var<storage, read> tables: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> intervals: array<vec2<f32>>;
@group(0) @binding(4) var<storage, read> occupied: array<u32>;
@group(0) @binding(5) var<storage, read_write> state: array<vec4<f32>>;
@group(0) @binding(6) var unfiltered: sampler;

// Quads of samples fetched, and texels of sheets reconstructed, if they are counted.
var<private> n_fetches: u32;
var<private> n_texels: u32;

// Position of a ray that never reaches opacity 1/2.
const NONE: f32 = 3.0e38;
