// Ambient occlusion, shadow, and labels. Twin of crates/splat/src/optics/modifiers.rs. The functions that read fields
// are generated for the fields of the scene (`permutation.rs`).

const LEAST: f32 = 1e-20f;

// Values of the fields at a point.
struct FieldValues {
    // Share of all light that occlusion leaves, and of the first light that shadow leaves, at full strength.
    openness: f32,
    shadow: f32,
    // Share of the scan's optical depth that labels leave; share of it that they tint, and tint colour times that.
    scan: f32,
    tint: vec4<f32>,
    // Optical depth of the label medium, and its colour times that.
    medium: vec4<f32>,
}

fn between_fields(front: FieldValues, back: FieldValues, share: f32) -> FieldValues {
    return FieldValues(
        mix_exact(front.openness, back.openness, share),
        mix_exact(front.shadow, back.shadow, share),
        mix_exact(front.scan, back.scan, share),
        front.tint + (back.tint - front.tint) * share,
        front.medium + (back.medium - front.medium) * share,
    );
}

fn mix_exact(a: f32, b: f32, share: f32) -> f32 {
    return a + (b - a) * share;
}

// Factors of all light and of the first light.
fn light_at(fields: FieldValues) -> vec2<f32> {
    let strengths = parameters.frame.light.xy;
    return max(vec2<f32>(1.0f) - strengths * (vec2<f32>(1.0f) - vec2<f32>(fields.openness, fields.shadow)), vec2<f32>(0.0f));
}

// The scan's colour, tinted by labels; the tint is divided by the share of the scan that is left.
fn tinted(rgb: vec3<f32>, fields: FieldValues) -> vec3<f32> {
    if !HAS_TINT {
        return rgb;
    }
    let of_scan = 1.0f / max(fields.scan, LEAST);
    return rgb * (1.0f - fields.tint.x * of_scan) + fields.tint.yzw * of_scan;
}

// A colour in the light that gets to a point. `even`: share of even light, near cuts.
fn lit(
    lighting: Lighting,
    is_shaded: bool,
    rgb: vec3<f32>,
    gradient: vec3<f32>,
    eye: vec3<f32>,
    light: vec2<f32>,
    even: f32,
) -> vec3<f32> {
    if is_shaded {
        return evened(lighting, rgb, shade(lighting, rgb, gradient, eye, light.y) * light.x, even);
    }
    return rgb * (light.x * light.y);
}

// Colour of the label medium, with its gradient.
fn label_medium_color(fields: FieldValues, gradient: vec3<f32>, eye: vec3<f32>, even: f32) -> vec3<f32> {
    let rgb = fields.medium.yzw / max(fields.medium.x, LEAST);
    return lit(parameters.frame.label_lighting, LABEL_MEDIUM_SHADED, rgb, gradient, eye, light_at(fields), even);
}
