// Pre-integration of the space between two sheets, where the density is linear in between. Twin of
// crates/splat/src/optics/preintegrate.rs.

// Integral of the optical depth up to a density, and the nearest visible densities above and below it.
fn integral(layer: u32, density: f32) -> vec3<f32> {
    let places = parameters.layers[layer].tables;
    let domain = parameters.layers[layer].domain;
    let found = look_up(places.y, places.w, table_position(layer, density));
    // Beyond the table the optical depth is constant.
    let depth_lo = tables[places.y].w;
    let depth_hi = tables[places.y + places.w - 1u].w;
    let under = min(density - domain.x, 0.0f);
    let over = max(density - domain.z, 0.0f);
    let above = select(found.y, found.y + under, depth_lo > 0.0f);
    let below = select(found.z, found.z + over, depth_hi > 0.0f);
    return vec3<f32>(found.x + under * depth_lo + over * depth_hi, above, below);
}

// Visible part of the way from one density to another.
struct Passage {
    // Shares of the way where the first visible density is met, and where the last one is left.
    first: f32,
    last: f32,
    // Share of the visible part where its two parts meet.
    split: f32,
    // Optical depths of the two parts, for a way of one opacity unit.
    depths: vec2<f32>,
}

// Opacity of the visible part, and the mean place that its light comes from, as a share of it: the middle of a thin part,
// the front of an opaque one. 1 / (2 + 0.75 depth) approximates that place for even extinction, as a share of a part's
// length: 1/depth - 1/(exp(depth) - 1).
fn light_of(passage: Passage, depths: vec2<f32>) -> vec2<f32> {
    let near = one_minus_exp_neg(depths.x);
    let far = (1.0f - near) * one_minus_exp_neg(depths.y);
    let means = 1.0f / (2.0f + 0.75f * depths);
    let moment = near * passage.split * means.x + far * (passage.split + (1.0f - passage.split) * means.y);
    let alpha = near + far;
    return vec2<f32>(alpha, select(0.5f, moment / max(alpha, 1e-30f), alpha > 0.0f));
}

// Whether the way enters or leaves the densities that are opaque up to an end of the curve.
fn meets_opaque_end(layer: u32, begin: f32, end: f32) -> bool {
    let ends = parameters.layers[layer].visible.zw;
    let lo = min(begin, end);
    let hi = max(begin, end);
    return (lo < ends.x && ends.x < hi) || (lo < ends.y && ends.y < hi);
}

fn preintegrate(layer: u32, begin: f32, end: f32) -> Passage {
    let change = end - begin;
    let domain = parameters.layers[layer].domain;
    if abs(change) < LEVEL / domain.y {
        // Nearly equal densities, whose difference of integrals would cancel: the optical depth in the middle.
        let depth = classify(layer, (begin + end) * 0.5f).w * 0.5f;
        return Passage(0.0f, 1.0f, 0.5f, vec2<f32>(depth));
    }
    let inverse = 1.0f / change;
    let rises = change > 0.0f;
    let at_begin = integral(layer, begin);
    let at_end = integral(layer, end);
    let first = clamp((select(at_begin.z, at_begin.y, rises) - begin) * inverse, 0.0f, 1.0f);
    let last = clamp((select(at_end.y, at_end.z, rises) - begin) * inverse, 0.0f, 1.0f);
    // The middle, or where the way enters or leaves the densities that are opaque up to an end of the curve.
    var split = 0.5f;
    for (var k = 0u; k < 2u; k++) {
        let end = select(parameters.layers[layer].visible.z, parameters.layers[layer].visible.w, k == 1u);
        let share = ((end - begin) * inverse - first) / (last - first);
        if share > 0.0f && share < 1.0f {
            split = share;
        }
    }
    let middle = integral(layer, begin + (first + split * (last - first)) * change).x;
    let depths = vec2<f32>(middle - at_begin.x, at_end.x - middle) * inverse;
    return Passage(first, last, split, max(depths, vec2<f32>(0.0f)));
}

// Passage in two parts of the way, cut at the three rising shares `cuts`.
fn preintegrate_parts(layer: u32, begin: f32, end: f32, cuts: vec3<f32>) -> Passage {
    let change = end - begin;
    let domain = parameters.layers[layer].domain;
    if abs(change) < LEVEL * 3.0f / domain.y {
        let depth = classify(layer, (begin + end) * 0.5f).w;
        return Passage(cuts.x, cuts.z, 0.5f, depth * (cuts.yz - cuts.xy));
    }
    let inverse = 1.0f / change;
    let rises = change > 0.0f;
    let at_begin = integral(layer, begin + cuts.x * change);
    let at_end = integral(layer, begin + cuts.z * change);
    let middle = integral(layer, begin + cuts.y * change).x;
    let first = clamp((select(at_begin.z, at_begin.y, rises) - begin) * inverse, cuts.x, cuts.z);
    let last = clamp((select(at_end.y, at_end.z, rises) - begin) * inverse, cuts.x, cuts.z);
    let depths = vec2<f32>(middle - at_begin.x, at_end.x - middle) * inverse;
    return Passage(first, last, 0.5f, max(depths, vec2<f32>(0.0f)));
}
