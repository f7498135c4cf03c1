// Projections: one density per ray, by maximum, minimum or integral, of a density that is linear between sheets. Twin of
// crates/splat/src/ray/project.rs and local_maximum.rs.

// The densities where the drawn part of a slab begins and ends, and its length; 0 where nothing is drawn.
fn segment(ray: Ray, front: f32, back: f32, s_front: f32, s_back: f32, is_whole: bool) -> vec3<f32> {
    let way = s_back - s_front;
    let begin = max((ray.interval.x - s_front) / way, 0.0f);
    let end = min((ray.interval.y - s_front) / way, 1.0f);
    let slope = back - front;
    let near = front + begin * slope;
    let far = select(front + end * slope, back, end == 1.0f);
    let is_drawn = end > begin && is_whole;
    return vec3<f32>(near, far, select(0.0f, (end - begin) * way * thickness(0u, ray), is_drawn));
}

// What is above a level, times a factor.
fn dimmed(density: f32, level: f32, factor: f32) -> f32 {
    return select(density, level + (density - level) * factor, density > level);
}

// Mean of what is positive of a density that goes evenly from one value to another.
fn mean_above(near: f32, far: f32) -> f32 {
    let lo = min(near, far);
    let hi = max(max(near, far), 0.0f);
    if lo >= 0.0f {
        return 0.5f * (near + far);
    }
    return 0.5f * hi * hi / max(hi - lo, 1e-30f);
}

// One end of a segment on the way to a local maximum.
fn climb(density: f32) {
    if gathered.y > 0.0f {
        return;
    }
    if gathered.x >= parameters.frame.number.x && density < gathered.x - ROUNDING * abs(gathered.x) {
        gathered.y = 1.0f;
        return;
    }
    gathered.x = max(gathered.x, density);
}

fn add_segment(ray: Ray, part: vec3<f32>, s_front: f32, s_back: f32) {
    if part.z <= 0.0f {
        return;
    }
    let level = parameters.frame.number.x;
    switch PROJECTION {
        case MAXIMUM: {
            gathered.x = max(gathered.x, max(part.x, part.y));
        }
        case MINIMUM: {
            gathered.x = min(gathered.x, min(part.x, part.y));
        }
        case DEPTH_SHADED: {
            let texel = vec3<f32>(1.0f, vec2<f32>(ray.texel));
            let at_zero = dot(parameters.frame.fade[0].xyz, texel);
            let per_s = dot(parameters.frame.fade[1].xyz, texel);
            let near = dimmed(part.x, level, at_zero + per_s * max(ray.interval.x, s_front));
            let far = dimmed(part.y, level, at_zero + per_s * min(ray.interval.y, s_back));
            gathered.x = max(gathered.x, max(near, far));
        }
        case X_RAY: {
            gathered.x += mean_above(part.x - level, part.y - level) * part.z;
        }
        case LOCAL_MAXIMUM: {
            climb(part.x);
            climb(part.y);
        }
        default: {
            gathered.x += 0.5f * (part.x + part.y) * part.z;
        }
    }
    if PROJECTION != LOCAL_MAXIMUM {
        gathered.y += part.z;
    }
}

fn march_ray(ray: Ray, block: u32) {
    let first = parameters.frame.slabs.x;
    let end = parameters.frame.slabs.y;
    // Each sheet is made once: behind a slab, then in front of the next.
    var in_front = 0xffffffffu;
    var front = 0.0f;
    var front_hole = false;
    for (var word = first / 32u; word * 32u < end + 1u; word++) {
        let around = sheets_around(0u, block, word, first, end);
        var sheets = around.x;
        while sheets != 0u {
            let bit = firstTrailingBit(sheets);
            sheets &= sheets - 1u;
            let number = word * 32u + bit;
            let place = place_0(ray.texel, number);
            let back = value_0(place, vec3<f32>(0.0f));
            let back_hole = is_hole_0(place);
            if ((around.y >> bit) & 1u) == 1u && in_front + 1u == number {
                let s_front = s_of(number - 1u);
                let s_back = s_of(number);
                let part = segment(ray, front, back, s_front, s_back, !front_hole && !back_hole);
                add_segment(ray, part, s_front, s_back);
                if is_done() {
                    return;
                }
            }
            front = back;
            front_hole = back_hole;
            in_front = number;
        }
    }
}

fn is_done() -> bool {
    return PROJECTION == LOCAL_MAXIMUM && gathered.y > 0.0f;
}
