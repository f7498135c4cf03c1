// Samples that are drawn as empty: where a hole has a weight of either sign. Twin of `Sheet::hole`
// (crates/splat/src/sheet/buffer.rs). A template: SOURCE stands for the number of the source.

@group(0) @binding(MASK_BINDING_SOURCE) var holes_SOURCE: texture_2d_array<f32>;

fn holes_quad_SOURCE(at: vec3<i32>) -> vec4<f32> {
    return vec4<f32>(
        textureLoad(holes_SOURCE, at.xy, at.z, 0).x,
        textureLoad(holes_SOURCE, at.xy + vec2<i32>(1, 0), at.z, 0).x,
        textureLoad(holes_SOURCE, at.xy + vec2<i32>(0, 1), at.z, 0).x,
        textureLoad(holes_SOURCE, at.xy + vec2<i32>(1, 1), at.z, 0).x,
    );
}

fn holes_plane_SOURCE(at: vec3<i32>, x: vec4<f32>, y: vec4<f32>) -> f32 {
    let a = holes_quad_SOURCE(at);
    let b = holes_quad_SOURCE(at + vec3<i32>(2, 0, 0));
    let c = holes_quad_SOURCE(at + vec3<i32>(0, 2, 0));
    let d = holes_quad_SOURCE(at + vec3<i32>(2, 2, 0));
    return plane_sum(a, b, c, d, x, y);
}

fn is_hole_SOURCE(place: Place) -> bool {
    let footprint = footprint_of(KERNEL_SOURCE, clamp(place.at, -vec3<f32>(place.base), place.last));
    let x = abs(footprint.x);
    let y = abs(footprint.y);
    let z = abs(footprint.z);
    let cell = place.base + footprint.cell;
    let at = cell + origin_SOURCE(cell) + footprint.first;
    if KERNEL_SOURCE == KERNEL_LINEAR {
        let sum = holes_quad_SOURCE(at) * z.x + holes_quad_SOURCE(at + vec3<i32>(0, 0, 1)) * z.y;
        return dot(sum, vec4<f32>(x.x * y.x, x.y * y.x, x.x * y.y, x.y * y.y)) > LEAST_HOLE_WEIGHT;
    }
    let sum = holes_plane_SOURCE(at, x, y) * z.x + holes_plane_SOURCE(at + vec3<i32>(0, 0, 1), x, y) * z.y
        + holes_plane_SOURCE(at + vec3<i32>(0, 0, 2), x, y) * z.z
        + holes_plane_SOURCE(at + vec3<i32>(0, 0, 3), x, y) * z.w;
    return sum > LEAST_HOLE_WEIGHT;
}
