// First hit, a shaded isosurface: the first crossing of an iso-value along a ray. Twin of
// crates/splat/src/ray/first_hit.rs.

fn march_ray(ray: Ray, block: u32) {
    let first = parameters.frame.slabs.x;
    let end = parameters.frame.slabs.y;
    let iso = parameters.frame.number.x;
    var in_front = 0xffffffffu;
    var front = 0.0f;
    var front_hole = false;
    var front_place: Place;
    for (var word = first / 32u; word * 32u < end; word++) {
        var slabs = within(occupied_word(0u, block, word), word, first, end);
        while slabs != 0u {
            let slab = word * 32u + firstTrailingBit(slabs);
            slabs &= slabs - 1u;
            if in_front != slab {
                front_place = place_0(ray.texel, slab);
                front = value_0(front_place, vec3<f32>(0.0f));
                front_hole = is_hole_0(front_place);
            }
            let back_place = place_0(ray.texel, slab + 1u);
            let back = value_0(back_place, vec3<f32>(0.0f));
            let back_hole = is_hole_0(back_place);
            let a = front - iso;
            let b = back - iso;
            if (a < 0.0f) != (b < 0.0f) && !front_hole && !back_hole {
                let s_front = s_of(slab);
                let at = a / (a - b);
                let place = s_front + (s_of(slab + 1u) - s_front) * at;
                if place >= ray.interval.x && place <= ray.interval.y {
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
            front_hole = back_hole;
            front_place = back_place;
            in_front = slab + 1u;
        }
    }
}

fn is_done() -> bool {
    return gathered.w > 0.0f;
}
