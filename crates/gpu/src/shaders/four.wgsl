// Reconstruction of four fields on the same grid at once. Twin of `FieldSheets`
// (crates/splat/src/sheet/field_sheets.rs). A template: SOURCE stands for the number of the source.

fn row_of_four_SOURCE(at: vec3<i32>, x: vec4<f32>) -> vec4<f32> {
    var sum = textureLoad(samples_SOURCE, at.xy, at.z, 0) * x.x;
    sum += textureLoad(samples_SOURCE, at.xy + vec2<i32>(1, 0), at.z, 0) * x.y;
    if KERNEL_SOURCE == KERNEL_LINEAR {
        return sum;
    }
    sum += textureLoad(samples_SOURCE, at.xy + vec2<i32>(2, 0), at.z, 0) * x.z;
    return sum + textureLoad(samples_SOURCE, at.xy + vec2<i32>(3, 0), at.z, 0) * x.w;
}

fn four_SOURCE(place: Place) -> vec4<f32> {
    let footprint = footprint_of(KERNEL_SOURCE, clamp(place.at, -vec3<f32>(place.base), place.last));
    let at = place.base + footprint.cell + footprint.first + parameters.sources[SOURCE].apron.xyz;
    let n = select(4, 2, KERNEL_SOURCE == KERNEL_LINEAR);
    var sum = vec4<f32>(0.0f);
    for (var k = 0; k < n; k++) {
        let z = weight_at(footprint.z, k);
        for (var j = 0; j < n; j++) {
            sum += row_of_four_SOURCE(at + vec3<i32>(0, j, k), footprint.x) * (weight_at(footprint.y, j) * z);
        }
    }
    return sum;
}
