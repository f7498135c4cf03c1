// Reconstruction of a texel of a sheet: density and gradient. Twin of crates/splat/src/sheet/buffer.rs and
// kernel/footprint.rs. A template: SOURCE stands for the number of the source.

fn place_SOURCE(texel: vec2<u32>, sheet: u32) -> Place {
    if COUNTED && SOURCE < N_LAYERS {
        n_texels += 1u;
    }
    let source = parameters.sources[SOURCE];
    let u = source.place.x + 2u * (sheet * source.place.w + texel.x / 16u);
    let v = source.place.y + 2u * (sheet * u32(source.last.w) + texel.y / 16u);
    let w = source.place.z + 4u * sheet;
    let step = vec2<f32>(bitcast<f32>(words[w + 2u]), bitcast<f32>(words[w + 3u]));
    let lane = vec2<f32>(texel & vec2<u32>(15u));
    let base = to_xyz(vec3<i32>(bitcast<i32>(words[u]), bitcast<i32>(words[v]), bitcast<i32>(words[w])));
    let start = vec3<f32>(bitcast<f32>(words[u + 1u]), bitcast<f32>(words[v + 1u]), bitcast<f32>(words[w + 1u]));
    let at = start + vec3<f32>(lane * step, 0.0f);
    return Place(base, to_xyz_f32(at), vec3<f32>(source.last.xyz - base));
}

fn plane_SOURCE(at: vec3<i32>, x: vec4<f32>, y: vec4<f32>) -> f32 {
    let a = quad_SOURCE(at);
    let b = quad_SOURCE(at + vec3<i32>(2, 0, 0));
    let c = quad_SOURCE(at + vec3<i32>(0, 2, 0));
    let d = quad_SOURCE(at + vec3<i32>(2, 2, 0));
    return plane_sum(a, b, c, d, x, y);
}

// Density at a place plus a shift; positions are clamped to the first and the last sample.
fn value_SOURCE(place: Place, shift: vec3<f32>) -> f32 {
    let first = -vec3<f32>(place.base);
    let x = clamp(clamp(place.at, first, place.last) + shift, first, place.last);
    let footprint = footprint_of(KERNEL_SOURCE, x);
    let cell = place.base + footprint.cell;
    let at = cell + origin_SOURCE(cell) + footprint.first;
    if KERNEL_SOURCE == KERNEL_LINEAR {
        let quad = quad_SOURCE(at) * footprint.z.x + quad_SOURCE(at + vec3<i32>(0, 0, 1)) * footprint.z.y;
        let rows = quad.xz * footprint.x.x + quad.yw * footprint.x.y;
        return rows.x * footprint.y.x + rows.y * footprint.y.y;
    }
    let z = footprint.z;
    var sum = plane_SOURCE(at, footprint.x, footprint.y) * z.x;
    sum += plane_SOURCE(at + vec3<i32>(0, 0, 1), footprint.x, footprint.y) * z.y;
    sum += plane_SOURCE(at + vec3<i32>(0, 0, 2), footprint.x, footprint.y) * z.z;
    if KERNEL_SOURCE == KERNEL_BSPLINE2 {
        return sum;
    }
    return sum + plane_SOURCE(at + vec3<i32>(0, 0, 3), footprint.x, footprint.y) * z.w;
}

// Derivatives along u, v and w, per index step.
fn gradient_SOURCE(place: Place) -> vec3<f32> {
    if GRADIENT_SOURCE == GRADIENT_DIFFERENCE {
        // One call of a large function in a loop, since six calls take compilers long.
        var sum = vec3<f32>(0.0f);
        for (var k = 0; k < 6; k++) {
            let along = select(vec3<f32>(0.0f), vec3<f32>(1.0f), vec3<i32>(k >> 1u) == vec3<i32>(0, 1, 2));
            let towards = select(along, -along, (k & 1) == 1);
            sum += value_SOURCE(place, towards * parameters.sources[SOURCE].texel.z) * towards;
        }
        return to_uvw(sum * (1.0f / (2.0f * parameters.sources[SOURCE].texel.z)));
    }
    let x = clamp(place.at, -vec3<f32>(place.base), place.last);
    let nearest = floor(x + select(0.0f, 0.5f, KERNEL_SOURCE == KERNEL_BSPLINE2));
    let before = f32(BEFORE_SOURCE);
    let per_width = parameters.sources[SOURCE].texel.w;
    let position = (x - nearest + before) * per_width;
    let cell = place.base + vec3<i32>(nearest);
    let at = cell + origin_SOURCE(cell) - BEFORE_SOURCE;
    // Sums of samples times weights along all axes, and with the weight's derivative along one of them.
    var value = 0.0f;
    var slope = vec3<f32>(0.0f);
    for (var k = 0; k < N_SMOOTHED_SOURCE; k++) {
        let z = smoothed_tap(position.z, k, N_SMOOTHED_SOURCE, per_width);
        for (var j = 0; j < N_SMOOTHED_SOURCE; j += 2) {
            let y0 = smoothed_tap(position.y, j, N_SMOOTHED_SOURCE, per_width);
            let y1 = smoothed_tap(position.y, j + 1, N_SMOOTHED_SOURCE, per_width);
            // Values and derivatives along x, of both rows.
            var values = vec2<f32>(0.0f);
            var slopes = vec2<f32>(0.0f);
            for (var i = 0; i < N_SMOOTHED_SOURCE; i += 2) {
                let x0 = smoothed_tap(position.x, i, N_SMOOTHED_SOURCE, per_width);
                let x1 = smoothed_tap(position.x, i + 1, N_SMOOTHED_SOURCE, per_width);
                let quad = quad_SOURCE(at + vec3<i32>(i, j, k));
                values += quad.xz * x0.x + quad.yw * x1.x;
                slopes += quad.xz * x0.y + quad.yw * x1.y;
            }
            let on_slice = values.x * y0.x + values.y * y1.x;
            value += on_slice * z.x;
            slope.x += (slopes.x * y0.x + slopes.y * y1.x) * z.x;
            slope.y += (values.x * y0.y + values.y * y1.y) * z.x;
            slope.z += on_slice * z.y;
        }
    }
    let of_x = smoothed_sums(position.x, N_SMOOTHED_SOURCE, per_width);
    let of_y = smoothed_sums(position.y, N_SMOOTHED_SOURCE, per_width);
    let of_z = smoothed_sums(position.z, N_SMOOTHED_SOURCE, per_width);
    let sums = vec3<f32>(of_x.x, of_y.x, of_z.x);
    let changes = vec3<f32>(of_x.y, of_y.y, of_z.y);
    let share = per_width / (sums.x * sums.y * sums.z);
    return to_uvw((slope - changes / sums * value) * share);
}
