// The missing share of a place: the weight that the linear kernel gives to missing samples, whatever the kernel of the
// densities. Twin of `Sheet::missing` (crates/splat/src/sheet/missing.rs). A template: SOURCE stands for the number of
// the source.

@group(0) @binding(MASK_BINDING_SOURCE) var holes_SOURCE: texture_2d_array<f32>;

fn holes_quad_SOURCE(at: vec3<i32>) -> vec4<f32> {
    return vec4<f32>(
        textureLoad(holes_SOURCE, at.xy, at.z, 0).x,
        textureLoad(holes_SOURCE, at.xy + vec2<i32>(1, 0), at.z, 0).x,
        textureLoad(holes_SOURCE, at.xy + vec2<i32>(0, 1), at.z, 0).x,
        textureLoad(holes_SOURCE, at.xy + vec2<i32>(1, 1), at.z, 0).x,
    );
}

fn missing_SOURCE(place: Place) -> f32 {
    let footprint = footprint_of(KERNEL_LINEAR, clamp(place.at, -vec3<f32>(place.base), place.last));
    let cell = place.base + footprint.cell;
    let at = cell + origin_SOURCE(cell);
    let quad = holes_quad_SOURCE(at) * footprint.z.x + holes_quad_SOURCE(at + vec3<i32>(0, 0, 1)) * footprint.z.y;
    let rows = quad.xz * footprint.x.x + quad.yw * footprint.x.y;
    return rows.x * footprint.y.x + rows.y * footprint.y.y;
}
