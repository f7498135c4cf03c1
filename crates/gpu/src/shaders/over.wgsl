// Compositing by over, front to back: sheets that stand for slabs, or slabs of linear density, pre-integrated. Twin of
// crates/splat/src/ray/over.rs.

// A texel of a sheet: density, and gradient and fields, which are reconstructed when first needed.
struct Sheet {
    place: Place,
    density: f32,
    missing: f32,
    gradient: vec3<f32>,
    has_gradient: bool,
    fields: FieldValues,
    has_fields: bool,
}

fn sheet_at(ray: Ray, sheet: u32) -> Sheet {
    var made: Sheet;
    made.place = place_0(ray.texel, sheet);
    made.density = value_0(made.place, vec3<f32>(0.0f));
    made.missing = missing_0(made.place);
    made.has_gradient = false;
    made.has_fields = false;
    if HAS_LABEL_MEDIUM {
        made.fields = fields_at(ray.texel, sheet);
        made.has_fields = true;
    }
    return made;
}

fn with_gradient(sheet: ptr<function, Sheet>) {
    if (IS_SHADED_0 || BY_GRADIENT_0 != 0u) && !(*sheet).has_gradient {
        (*sheet).gradient = gradient_0((*sheet).place);
        (*sheet).has_gradient = true;
    }
}

fn with_fields(sheet: ptr<function, Sheet>, ray: Ray, number: u32) {
    // With a label medium, every sheet has its fields already.
    if HAS_FIELDS && !HAS_LABEL_MEDIUM && !(*sheet).has_fields {
        (*sheet).fields = fields_at(ray.texel, number);
        (*sheet).has_fields = true;
    }
}

// Mixes the label medium into the scan's colour and opacity in the same space; `scan_depth`: the scan's optical
// depth. Colours mix by extinction: where both are opaque, opacities would say half and half.
fn with_label_medium(
    scan: vec4<f32>,
    scan_depth: f32,
    fields: FieldValues,
    gradient: vec3<f32>,
    length: f32,
    eye: vec3<f32>,
    even: f32,
) -> vec4<f32> {
    let own_depth = max(fields.medium.x, 0.0f) * length;
    let own = one_minus_exp_neg(own_depth);
    let color = label_medium_color(fields, gradient, eye, even);
    let sum = scan_depth + own_depth;
    let share = select(0.0f, own_depth / max(sum, 1e-30f), sum > 0.0f);
    return vec4<f32>(scan.xyz + share * (color - scan.xyz), scan.w + own - scan.w * own);
}

// Composites a sheet, taken as constant from position `begin` to `end`.
fn add_sheet(ray: Ray, number: u32, begin: f32, end: f32) {
    var sheet = sheet_at(ray, number);
    let sees_scan = is_visible(0u, sheet.density, sheet.density);
    let sees_label_medium = HAS_LABEL_MEDIUM && sheet.fields.medium.x > 0.0f;
    if !(sees_scan || sees_label_medium) {
        return;
    }
    let part = extent(ray.interval, begin, end);
    let full_length = part.y * thickness(0u, ray);
    let length = full_length * known_share(sheet.missing);
    if full_length <= 0.0f {
        return;
    }
    with_fields(&sheet, ray, number);
    var color = vec4<f32>(0.0f);
    if sees_scan {
        color = classify(0u, sheet.density);
        with_gradient(&sheet);
        if BY_GRADIENT_0 == BY_FACTOR {
            color.w *= gradient_factor(0u, sheet.gradient);
        } else if BY_GRADIENT_0 == BY_BOTH {
            color = classify_jointly(0u, sheet.density, sheet.gradient);
        }
        color.w *= select(1.0f, sheet.fields.scan, HAS_SCAN);
    }
    let at = part.x + 0.5f * part.y;
    let even = even_share(ray.interval.x, part.x, part.y, color.w * full_length, at, sheet.missing);
    let scan_depth = color.w * length;
    color.w = one_minus_exp_neg(scan_depth);
    let eye = to_eye(0u, ray);
    if sees_scan && (color.w > 0.0f || sees_label_medium) {
        color = vec4<f32>(scan_color(color.xyz, sheet.gradient, sheet.fields, eye, even), color.w);
    }
    if sees_label_medium {
        let own_depth = max(sheet.fields.medium.x, 0.0f) * full_length;
        let even = even_share(ray.interval.x, part.x, part.y, own_depth, at, sheet.missing);
        color = with_label_medium(color, scan_depth, sheet.fields, label_medium_gradient(ray.texel, number), length, eye, even);
    }
    add_fragment(color.xyz, color.w, part.x, part.y);
}

fn scan_color(rgb: vec3<f32>, gradient: vec3<f32>, fields: FieldValues, eye: vec3<f32>, even: f32) -> vec3<f32> {
    if !HAS_FIELDS {
        if IS_SHADED_0 {
            let lighting = parameters.layers[0].lighting;
            return evened(lighting, rgb, shade(lighting, rgb, gradient, eye, 1.0f), even);
        }
        return rgb;
    }
    return lit(parameters.layers[0].lighting, IS_SHADED_0, tinted(rgb, fields), gradient, eye, light_at(fields), even);
}

// Composites the slab between two sheets, with a density that is linear in between.
fn add_slab(ray: Ray, front: ptr<function, Sheet>, back: ptr<function, Sheet>, number: u32) {
    let lo = min((*front).density, (*back).density);
    let hi = max((*front).density, (*back).density);
    let sees_scan = is_visible(0u, lo, hi);
    let sees_label_medium = HAS_LABEL_MEDIUM && max((*front).fields.medium.x, (*back).fields.medium.x) > 0.0f;
    if !(sees_scan || sees_label_medium) {
        return;
    }
    let s_front = s_of(number);
    let s_back = s_of(number + 1u);
    let part = extent(ray.interval, s_front, s_back);
    if part.y <= 0.0f {
        return;
    }
    with_fields(front, ray, number);
    with_fields(back, ray, number + 1u);
    // The densities where the drawn part begins and ends.
    let per_s = 1.0f / (s_back - s_front);
    let change = (*back).density - (*front).density;
    let begin = (part.x - s_front) * per_s;
    let share = part.y * per_s;
    let end = begin + share;
    let missing = (*front).missing;
    let more_missing = (*back).missing - missing;
    let most_missing = max(missing, (*back).missing);
    let full_length = part.y * thickness(0u, ray);
    // The known share is linear: its mean over a part is its value in the middle.
    let whole_length = full_length * known_share(missing + (begin + 0.5f * share) * more_missing);
    let eye = to_eye(0u, ray);
    var color = vec4<f32>(0.0f);
    var visible = part;
    var scan_depth = 0.0f;
    if sees_scan {
        let passage = preintegrate(0u, (*front).density + begin * change, (*front).density + end * change);
        let visible_middle = begin + (passage.first + passage.last) * 0.5f * share;
        var length = full_length * known_share(missing + visible_middle * more_missing);
        // As if no sample were missing: the matter that a cut makes a face of.
        var shown_length = full_length;
        with_gradient(front);
        with_gradient(back);
        if BY_GRADIENT_0 == BY_FACTOR {
            // Factors at the middle of the visible part stand for the whole of it.
            let factor = gradient_factor(0u, mix3((*front).gradient, (*back).gradient, visible_middle));
            length *= factor;
            shown_length *= factor;
        }
        if HAS_SCAN {
            let left = between_fields((*front).fields, (*back).fields, visible_middle).scan;
            length *= left;
            shown_length *= left;
        }
        let depths = passage.depths * length;
        scan_depth = depths.x + depths.y;
        let light = light_of(passage, depths);
        let alpha = light.x;
        let mean = light.y;
        let at = begin + (passage.first + mean * (passage.last - passage.first)) * share;
        let place = s_front + at * (s_back - s_front);
        let full_depth = (passage.depths.x + passage.depths.y) * shown_length;
        let even = even_share(ray.interval.x, part.x + passage.first * part.y, part.y, full_depth, place, most_missing);
        color.w = alpha;
        if alpha > 0.0f || sees_label_medium {
            var gradient = vec3<f32>(0.0f);
            if IS_SHADED_0 {
                gradient = mix3((*front).gradient, (*back).gradient, at);
            }
            let rgb = color_of(0u, (*front).density + at * change);
            let fields = between_fields((*front).fields, (*back).fields, at);
            color = vec4<f32>(scan_color(rgb, gradient, fields, eye, even), alpha);
        }
        visible = vec2<f32>(part.x + passage.first * part.y, (passage.last - passage.first) * part.y * 2.0f * mean);
    }
    if sees_label_medium {
        let middle = begin + 0.5f * share;
        let fields = between_fields((*front).fields, (*back).fields, middle);
        let on_front = label_medium_gradient(ray.texel, number);
        let gradient = mix3(on_front, label_medium_gradient(ray.texel, number + 1u), middle);
        let own_depth = max(fields.medium.x, 0.0f) * full_length;
        let place = s_front + middle * (s_back - s_front);
        let even = even_share(ray.interval.x, part.x, part.y, own_depth, place, most_missing);
        color = with_label_medium(color, scan_depth, fields, gradient, whole_length, eye, even);
        visible = part;
    }
    add_fragment(color.xyz, color.w, visible.x, visible.y);
}

fn mix3(a: vec3<f32>, b: vec3<f32>, share: f32) -> vec3<f32> {
    return a + (b - a) * share;
}

fn is_done() -> bool {
    return gathered.w >= parameters.frame.number.x;
}

// Marches a ray through the occupied slabs. Twin of `TileJob::run_slabs` (crates/splat/src/render/tile.rs).
fn march_ray(ray: Ray, block: u32) {
    let first = parameters.frame.slabs.x;
    let end = parameters.frame.slabs.y;
    if !PRE_INTEGRATED {
        // The sheet behind the last slab stands for half a slab.
        let last = select(end, end + 1u, end == parameters.frame.slabs.z);
        for (var word = first / 32u; word * 32u < last; word++) {
            let own = occupied_word(0u, block, word);
            var sheets = within(own | behind(0u, block, word, own), word, first, last);
            while sheets != 0u {
                let bit = firstTrailingBit(sheets);
                sheets &= sheets - 1u;
                let sheet = word * 32u + bit;
                let s = s_of(sheet);
                if ((own >> bit) & 1u) == 1u {
                    let half = 0.5f * (s_of(sheet + 1u) - s);
                    add_sheet(ray, sheet, s - half, s + half);
                } else {
                    add_sheet(ray, sheet, s - 0.5f * (s - s_of(sheet - 1u)), s);
                }
                if is_done() {
                    return;
                }
            }
        }
        return;
    }
    // Each sheet is reconstructed once: as the back of a slab, then as the front of the next.
    var front: Sheet;
    var in_front = 0xffffffffu;
    for (var word = first / 32u; word * 32u < end + 1u; word++) {
        let around = sheets_around(0u, block, word, first, end);
        var sheets = around.x;
        while sheets != 0u {
            let bit = firstTrailingBit(sheets);
            sheets &= sheets - 1u;
            let number = word * 32u + bit;
            var back = sheet_at(ray, number);
            if ((around.y >> bit) & 1u) == 1u && in_front + 1u == number {
                add_slab(ray, &front, &back, number - 1u);
                if is_done() {
                    return;
                }
            }
            front = back;
            in_front = number;
        }
    }
}
