// Projections: one density per ray, by maximum, minimum or integral, of a density that is linear between sheets. Twin
// of crates/splat/src/ray/project.rs and local_maximum.rs.

// The drawn part of a slab.
struct Segment {
    // Densities where the part begins and ends.
    near: f32,
    far: f32,
    // Positions s where it begins and ends.
    s_near: f32,
    s_far: f32,
    // Length in opacity units; 0 where nothing is drawn.
    length: f32,
}

// Drawn part of a slab. `missing`: the missing shares on both sheets.
fn segment(ray: Ray, front: f32, back: f32, s_front: f32, s_back: f32, missing: vec2<f32>) -> Segment {
    let way = s_back - s_front;
    let known = known_part(missing.x, missing.y);
    let begin = max(max((ray.interval.x - s_front) / way, 0.0f), known.x);
    let end = min(min((ray.interval.y - s_front) / way, 1.0f), known.y);
    let slope = back - front;
    let near = front + begin * slope;
    let far = select(front + end * slope, back, end == 1.0f);
    var s_near = max(ray.interval.x, s_front);
    var s_far = min(ray.interval.y, s_back);
    if HAS_HOLES_0 {
        s_near = s_front + begin * way;
        s_far = s_front + end * way;
    }
    let length = select(0.0f, (end - begin) * way * thickness(0u, ray), end > begin);
    return Segment(near, far, s_near, s_far, length);
}

// Density whose excess over a level is multiplied by a factor.
fn dimmed(density: f32, level: f32, factor: f32) -> f32 {
    return select(density, level + (density - level) * factor, density > level);
}

// Mean of max(density, 0) for a density that goes evenly from one value to another.
fn mean_above(near: f32, far: f32) -> f32 {
    let lo = min(near, far);
    let hi = max(max(near, far), 0.0f);
    if lo >= 0.0f {
        return 0.5f * (near + far);
    }
    return 0.5f * hi * hi / max(hi - lo, 1e-30f);
}

// Keeps a density and its position if it is more extreme than what was met before.
fn keep(density: f32, s: f32, is_more: bool) {
    if is_more {
        gathered.x = density;
        s_half = s;
    }
}

// Keeps the larger of the densities at the ends of a segment.
fn keep_larger(near: f32, far: f32, part: Segment) {
    keep(near, part.s_near, near > gathered.x);
    keep(far, part.s_far, far > gathered.x);
}

// Takes the density at one end of a segment on the way to a local maximum; a drop of more than rounding ends the ray.
fn climb(density: f32, s: f32) {
    if gathered.y > 0.0f {
        return;
    }
    if gathered.x >= parameters.frame.number.x && density < gathered.x - ROUNDING * abs(gathered.x) {
        gathered.y = 1.0f;
        return;
    }
    keep(density, s, density > gathered.x);
}

fn add_segment(ray: Ray, part: Segment) {
    if part.length <= 0.0f {
        return;
    }
    let level = parameters.frame.number.x;
    switch PROJECTION {
        case MAXIMUM: {
            keep_larger(part.near, part.far, part);
        }
        case MINIMUM: {
            keep(part.near, part.s_near, part.near < gathered.x);
            keep(part.far, part.s_far, part.far < gathered.x);
        }
        case DEPTH_SHADED: {
            let texel = vec3<f32>(1.0f, vec2<f32>(ray.texel));
            let at_zero = dot(parameters.frame.fade[0].xyz, texel);
            let per_s = dot(parameters.frame.fade[1].xyz, texel);
            let near = dimmed(part.near, level, at_zero + per_s * part.s_near);
            let far = dimmed(part.far, level, at_zero + per_s * part.s_far);
            keep_larger(near, far, part);
        }
        case ATTENUATED: {
            let white = parameters.frame.number.y;
            let mean = mean_above(part.near - level, part.far - level) - mean_above(part.near - white, part.far - white);
            let here = max(mean * (parameters.frame.number.z / (white - level)) * part.length, 0.0f);
            let behind = gathered.z + here;
            let near = dimmed(part.near, level, 1.0f - one_minus_exp_neg(gathered.z));
            let far = dimmed(part.far, level, 1.0f - one_minus_exp_neg(behind));
            gathered.z = behind;
            keep_larger(near, far, part);
        }
        case X_RAY: {
            gathered.x += mean_above(part.near - level, part.far - level) * part.length;
        }
        case LOCAL_MAXIMUM: {
            climb(part.near, part.s_near);
            climb(part.far, part.s_far);
        }
        default: {
            gathered.x += 0.5f * (part.near + part.far) * part.length;
        }
    }
    if PROJECTION != LOCAL_MAXIMUM {
        gathered.y += part.length;
    }
}

fn march_ray(ray: Ray, block: u32) {
    let first = parameters.frame.slabs.x;
    let end = parameters.frame.slabs.y;
    // Each sheet is reconstructed once: as the back of a slab, then as the front of the next.
    var in_front = 0xffffffffu;
    var front = 0.0f;
    var front_missing = 0.0f;
    for (var word = first / 32u; word * 32u < end + 1u; word++) {
        let around = sheets_around(0u, block, word, first, end);
        var sheets = around.x;
        while sheets != 0u {
            let bit = firstTrailingBit(sheets);
            sheets &= sheets - 1u;
            let number = word * 32u + bit;
            let place = place_0(ray.texel, number);
            let back = value_0(place, vec3<f32>(0.0f));
            let back_missing = missing_0(place);
            if ((around.y >> bit) & 1u) == 1u && in_front + 1u == number {
                let s_front = s_of(number - 1u);
                let s_back = s_of(number);
                let part = segment(ray, front, back, s_front, s_back, vec2<f32>(front_missing, back_missing));
                add_segment(ray, part);
                if is_done() {
                    return;
                }
            }
            front = back;
            front_missing = back_missing;
            in_front = number;
        }
    }
}

fn is_done() -> bool {
    return PROJECTION == LOCAL_MAXIMUM && gathered.y > 0.0f;
}
