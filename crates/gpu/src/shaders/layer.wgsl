// One of several layers. Twin of crates/splat/src/ray/over_layers.rs. A template: LAYER stands for the number of the
// layer.

fn interval_LAYER(block: u32, texel: vec2<u32>) -> vec2<f32> {
    let ray = block * 128u + (texel.y & 7u) * 16u + (texel.x & 15u);
    return intervals[(LAYERu + 1u) * parameters.frame.blocks.y * 128u + ray];
}

// Whether the layer occupies a slab.
fn has_LAYER(block: u32, slab: u32) -> bool {
    return ((occupied_word(LAYERu, block, slab / 32u) >> (slab & 31u)) & 1u) == 1u;
}

// The layer's colour in the light that gets to a point.
fn shaded_LAYER(rgb: vec3<f32>, gradient: vec3<f32>, eye: vec3<f32>, fields: FieldValues, even: f32) -> vec3<f32> {
    var color = rgb;
    if IS_FIRST_LAYER {
        color = tinted(rgb, fields);
    }
    let light = select(vec2<f32>(1.0f), light_at(fields), HAS_LIGHT_LAYER);
    return lit(parameters.layers[LAYER].lighting, IS_SHADED_LAYER, color, gradient, eye, light, even);
}

fn add_sheet_LAYER(ray: Ray, block: u32, sheet: u32, ends: bool, begin: f32, end: f32, sum: ptr<function, vec4<f32>>) -> bool {
    let goes_on = sheet < parameters.frame.slabs.z && has_LAYER(block, sheet);
    let is_behind = sheet > 0u && has_LAYER(block, sheet - 1u);
    if select(goes_on, is_behind && !goes_on, ends) == false {
        return false;
    }
    let own = interval_LAYER(block, ray.texel);
    if !(own.x < own.y) {
        return false;
    }
    let place = place_LAYER(ray.texel, sheet);
    let density = value_LAYER(place, vec3<f32>(0.0f));
    let part = extent(own, begin, end);
    let missing = missing_LAYER(place);
    let full_length = part.y * thickness(LAYERu, ray);
    let length = full_length * known_share(missing);
    if full_length <= 0.0f {
        return false;
    }
    let eye = to_eye(LAYERu, ray);
    let at = part.x + 0.5f * part.y;
    var fields: FieldValues;
    if HAS_FIELDS_LAYER {
        fields = fields_at(ray.texel, sheet);
    }
    var any = false;
    if is_visible(LAYERu, density, density) {
        var color = classify(LAYERu, density);
        var gradient = vec3<f32>(0.0f);
        if IS_SHADED_LAYER || BY_GRADIENT_LAYER != BY_NOTHING {
            gradient = gradient_LAYER(place);
        }
        if BY_GRADIENT_LAYER == BY_FACTOR {
            color.w *= gradient_factor(LAYERu, gradient);
        } else if BY_GRADIENT_LAYER == BY_BOTH {
            color = classify_jointly(LAYERu, density, gradient);
        }
        if IS_FIRST_LAYER && HAS_SCAN {
            color.w *= fields.scan;
        }
        let even = even_share(own.x, part.x, part.y, color.w * full_length, at, missing);
        *sum = with_medium(*sum, shaded_LAYER(color.xyz, gradient, eye, fields, even), color.w * length);
        any = true;
    }
    if IS_FIRST_LAYER && HAS_LABEL_MEDIUM && fields.medium.x > 0.0f {
        let own_depth = max(fields.medium.x, 0.0f);
        let even = even_share(own.x, part.x, part.y, own_depth * full_length, at, missing);
        *sum = with_medium(*sum, label_medium_color(fields, label_medium_gradient(ray.texel, sheet), eye, even), own_depth * length);
        any = true;
    }
    return any;
}

// Passage by a transfer function of two dimensions, which has no integral table: the optical depths on both sheets
// count, linear in between.
fn joint_passage_LAYER(front: vec4<f32>, back: vec4<f32>, cuts: vec3<f32>) -> Passage {
    let middles = (cuts.xy + cuts.yz) * 0.5f;
    let depths = (vec2<f32>(front.w) + middles * (back.w - front.w)) * (cuts.yz - cuts.xy);
    return Passage(cuts.x, cuts.z, 0.5f, depths);
}

fn add_slab_LAYER(ray: Ray, block: u32, slab: u32, mixture: ptr<function, Mixture>) {
    if !has_LAYER(block, slab) {
        return;
    }
    let own = interval_LAYER(block, ray.texel);
    if !(own.x < own.y) {
        return;
    }
    let front_place = place_LAYER(ray.texel, slab);
    let back_place = place_LAYER(ray.texel, slab + 1u);
    let front = value_LAYER(front_place, vec3<f32>(0.0f));
    let back = value_LAYER(back_place, vec3<f32>(0.0f));
    let s_front = s_of(slab);
    let way = s_of(slab + 1u) - s_front;
    let part = extent(own, s_front, s_front + way);
    if part.y <= 0.0f {
        return;
    }
    // Shares of the way where the layer's drawn part begins and ends, and where it is cut in two: in the middle of the
    // slab.
    let begin = (part.x - s_front) / way;
    let end = begin + part.y / way;
    let cuts = vec3<f32>(begin, clamp(0.5f, begin, end), end);
    let whole_length = way * thickness(LAYERu, ray);
    let missing = missing_LAYER(front_place);
    let more_missing = missing_LAYER(back_place) - missing;
    let most_missing = missing + max(more_missing, 0.0f);
    let eye = to_eye(LAYERu, ray);
    var front_fields: FieldValues;
    var back_fields: FieldValues;
    if HAS_FIELDS_LAYER {
        front_fields = fields_at(ray.texel, slab);
        back_fields = fields_at(ray.texel, slab + 1u);
    }
    if is_visible(LAYERu, min(front, back), max(front, back)) {
        var front_gradient = vec3<f32>(0.0f);
        var back_gradient = vec3<f32>(0.0f);
        if IS_SHADED_LAYER || BY_GRADIENT_LAYER != BY_NOTHING {
            front_gradient = gradient_LAYER(front_place);
            back_gradient = gradient_LAYER(back_place);
        }
        var passage: Passage;
        var joint_color = vec3<f32>(0.0f);
        if BY_GRADIENT_LAYER == BY_BOTH {
            let on_front = classify_jointly(LAYERu, front, front_gradient);
            let on_back = classify_jointly(LAYERu, back, back_gradient);
            passage = joint_passage_LAYER(on_front, on_back, cuts);
            joint_color = mix3(on_front.xyz, on_back.xyz, on_back.w / max(on_front.w + on_back.w, MIN_DEPTH));
        } else {
            passage = preintegrate_parts(LAYERu, front, back, cuts);
        }
        // Factors at the middle of the visible part stand for the whole of it.
        let middle = (passage.first + passage.last) * 0.5f;
        var length = whole_length * known_share(missing + middle * more_missing);
        // As if no sample were missing: the matter that a cut makes a face of.
        var shown_length = whole_length;
        if IS_FIRST_LAYER && HAS_SCAN {
            let left = between_fields(front_fields, back_fields, middle).scan;
            length *= left;
            shown_length *= left;
        }
        if BY_GRADIENT_LAYER == BY_FACTOR {
            let factor = gradient_factor(LAYERu, mix3(front_gradient, back_gradient, middle));
            length *= factor;
            shown_length *= factor;
        }
        let full_depth = (passage.depths.x + passage.depths.y) * shown_length;
        // Mean position that the layer's own light comes from; it colours the layer.
        let depths = passage.depths * length;
        let near = one_minus_exp_neg(depths.x);
        let far = (1.0f - near) * one_minus_exp_neg(depths.y);
        let means = 1.0f / (2.0f + 0.75f * depths);
        let starts = max(cuts.xy, vec2<f32>(passage.first));
        let places = starts + means * max(min(cuts.yz, vec2<f32>(passage.last)) - starts, vec2<f32>(0.0f));
        let alpha = near + far;
        var at = select(middle, (near * places.x + far * places.y) / max(alpha, 1e-30f), alpha > 0.0f);
        let own_front = front + begin * (back - front);
        let own_back = front + end * (back - front);
        if BY_GRADIENT_LAYER != BY_BOTH && meets_opaque_end(LAYERu, own_front, own_back) {
            // The parts are common to all layers; the layer's own meet where its densities get opaque.
            let whole = preintegrate(LAYERu, own_front, own_back);
            let mean = light_of(whole, whole.depths * ((end - begin) * length)).y;
            at = begin + (whole.first + mean * (whole.last - whole.first)) * (end - begin);
        }
        var color = joint_color;
        if BY_GRADIENT_LAYER != BY_BOTH {
            color = color_of(LAYERu, front + at * (back - front));
        }
        let gradient = mix3(front_gradient, back_gradient, at);
        let visible = select(s_front + passage.first * way, part.x, passage.first <= begin);
        let even = even_share(own.x, visible, part.y, full_depth, s_front + at * way, most_missing);
        let rgb = shaded_LAYER(color, gradient, eye, between_fields(front_fields, back_fields, at), even);
        (*mixture).near = with_medium((*mixture).near, rgb, depths.x);
        (*mixture).far = with_medium((*mixture).far, rgb, depths.y);
        (*mixture).only = vec4<f32>(rgb, alpha);
        (*mixture).only_extent = at * 2.0f * way;
        (*mixture).n += 1u;
    }
    if IS_FIRST_LAYER && HAS_LABEL_MEDIUM && max(front_fields.medium.x, back_fields.medium.x) > 0.0f {
        let middle = (begin + end) * 0.5f;
        let fields = between_fields(front_fields, back_fields, middle);
        let on_front = label_medium_gradient(ray.texel, slab);
        let gradient = mix3(on_front, label_medium_gradient(ray.texel, slab + 1u), middle);
        let known = known_share(missing + middle * more_missing);
        let lengths = (cuts.yz - cuts.xy) * (max(fields.medium.x, 0.0f) * whole_length * known);
        let own_depth = max(fields.medium.x, 0.0f) * (end - begin) * whole_length;
        let even = even_share(own.x, part.x, part.y, own_depth, s_front + middle * way, most_missing);
        let rgb = label_medium_color(fields, gradient, eye, even);
        (*mixture).near = with_medium((*mixture).near, rgb, lengths.x);
        (*mixture).far = with_medium((*mixture).far, rgb, lengths.y);
        (*mixture).n += 2u;
    }
}
