// Rays: their drawn intervals, the thickness of slabs along them, and the direction to the eye. Twin of
// crates/splat/src/sheet/tile_rays.rs. Positions are s: the slice coordinate with the sign that makes it grow away from
// the eye.

struct Ray {
    texel: vec2<u32>,
    // Drawn interval, in s.
    interval: vec2<f32>,
    // World length of the way from slice to slice.
    length: f32,
}

fn s_of(sheet: u32) -> f32 {
    return bitcast<f32>(words[parameters.frame.slabs.w + sheet]);
}

// Value at a texel of a vector that is affine in the texel.
fn affine(forms: array<vec4<f32>, 3>, texel: vec2<u32>) -> vec3<f32> {
    return forms[0].xyz + forms[1].xyz * f32(texel.x) + forms[2].xyz * f32(texel.y);
}

// Length of the way from slice to slice, in a layer's opacity units.
fn thickness(layer: u32, ray: Ray) -> f32 {
    return ray.length * parameters.layers[layer].domain.w;
}

fn to_eye(layer: u32, ray: Ray) -> vec3<f32> {
    return affine(parameters.layers[layer].to_eye, ray.texel) / ray.length;
}

// Begin and length of the part of an interval from `begin` to `end`.
fn extent(interval: vec2<f32>, begin: f32, end: f32) -> vec2<f32> {
    let first = max(begin, interval.x);
    return vec2<f32>(first, max(min(end, interval.y) - first, 0.0f));
}
