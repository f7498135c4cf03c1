// Samples of a source, exact: fetched as they are stored, decoded to whole numbers, never filtered by the hardware.
// Twin of `Slices::combine` (crates/splat/src/source/slices.rs). A template: SOURCE stands for the number of the
// source.

@group(0) @binding(BINDING_SOURCE) var samples_SOURCE: texture_2d_array<f32>;

// Offset from the index of a sample near `cell` to its texel.
fn origin_SOURCE(cell: vec3<i32>) -> vec3<i32> {
    let apron = parameters.sources[SOURCE].apron;
    // Not a constant: the shader is the same for whole and paged volumes, and so are the bytes of the picture.
    let side = i32(parameters.sources[SOURCE].pages.w);
    if side == 0 {
        return apron.xyz;
    }
    let n = vec3<i32>(parameters.sources[SOURCE].pages.xyz);
    let page = clamp(cell >> vec3<u32>(6u), vec3<i32>(0), n - 1);
    let slot = words[u32(apron.w) + u32(page.x + n.x * (page.y + n.y * page.z))];
    let corner = vec3<i32>(vec3<u32>(slot & 0x3ffu, (slot >> 10u) & 0x3ffu, slot >> 20u)) * side;
    return corner + apron.xyz - (page << vec3<u32>(6u));
}

// Densities of a quad of samples: (0, 0), (1, 0), (0, 1) and (1, 1) from a texel on.
fn quad_SOURCE(at: vec3<i32>) -> vec4<f32> {
    if FORMAT_SOURCE == FORMAT_FLOAT {
        return channel_SOURCE(at, 0u);
    }
    let low = round(channel_SOURCE(at, 0u) * 255.0f);
    if FORMAT_SOURCE == FORMAT_BYTE {
        return low - BIAS_SOURCE;
    }
    return fma(vec4<f32>(256.0f), round(channel_SOURCE(at, 1u) * 255.0f), low - BIAS_SOURCE);
}

fn channel_SOURCE(at: vec3<i32>, channel: u32) -> vec4<f32> {
    if COUNTED {
        n_fetches += 1u;
    }
    if GATHER {
        // Aim at the corner that the four texels share: half a texel away from any other quad, so that rounding cannot
        // choose that one.
        let corner = (vec2<f32>(at.xy) + 1.0f) * parameters.sources[SOURCE].texel.xy;
        if channel == 0u {
            return textureGather(0, samples_SOURCE, unfiltered, corner, at.z).wzxy;
        }
        return textureGather(1, samples_SOURCE, unfiltered, corner, at.z).wzxy;
    }
    let a = textureLoad(samples_SOURCE, at.xy, at.z, 0);
    let b = textureLoad(samples_SOURCE, at.xy + vec2<i32>(1, 0), at.z, 0);
    let c = textureLoad(samples_SOURCE, at.xy + vec2<i32>(0, 1), at.z, 0);
    let d = textureLoad(samples_SOURCE, at.xy + vec2<i32>(1, 1), at.z, 0);
    if channel == 0u {
        return vec4<f32>(a.x, b.x, c.x, d.x);
    }
    return vec4<f32>(a.y, b.y, c.y, d.y);
}
