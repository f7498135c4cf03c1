// First hit, a shaded isosurface: the first crossing of an iso-value along a ray. Twin of
// crates/splat/src/ray/first_hit.rs.

fn march_ray(ray: Ray, block: u32) {
    let first = parameters.frame.slabs.x;
    let end = parameters.frame.slabs.y;
    let iso = parameters.frame.number.x;
    // Each sheet is reconstructed once: as the back of a slab, then as the front of the next.
    var in_front = 0xffffffffu;
    var front = 0.0f;
    var front_missing = 0.0f;
    var front_place: Place;
    for (var word = first / 32u; word * 32u < end + 1u; word++) {
        let around = sheets_around(0u, block, word, first, end);
        var sheets = around.x;
        while sheets != 0u {
            let bit = firstTrailingBit(sheets);
            sheets &= sheets - 1u;
            let number = word * 32u + bit;
            let back_place = place_0(ray.texel, number);
            let back = value_0(back_place, vec3<f32>(0.0f));
            let back_missing = missing_0(back_place);
            let a = front - iso;
            let b = back - iso;
            let is_slab = ((around.y >> bit) & 1u) == 1u && in_front + 1u == number;
            if is_slab && (a < 0.0f) != (b < 0.0f) {
                let s_front = s_of(number - 1u);
                let at = a / (a - b);
                let place = s_front + (s_of(number) - s_front) * at;
                let is_known = front_missing + (back_missing - front_missing) * at < MISSING;
                if is_known && place >= ray.interval.x && place <= ray.interval.y {
                    var rgb = parameters.frame.color.xyz;
                    if IS_SHADED_0 {
                        let on_front = gradient_0(front_place);
                        let gradient = on_front + (gradient_0(back_place) - on_front) * at;
                        rgb = shade(parameters.layers[0].lighting, rgb, gradient, to_eye(0u, ray), 1.0f);
                    }
                    gathered = vec4<f32>(rgb, 1.0f);
                    s_half = place;
                    return;
                }
            }
            front = back;
            front_missing = back_missing;
            front_place = back_place;
            in_front = number;
        }
    }
}

fn is_done() -> bool {
    return gathered.w > 0.0f;
}
