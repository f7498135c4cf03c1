// Even light on cut faces. Twin of crates/splat/src/ray/cut_faces.rs.

// Where the ray entered matter through a cut last, in s; NO_ENTRY where it did not.
var<private> entry: f32;

// Share of even light at `at` for matter whose visible part begins at `begin`, on a ray that begins at `start`.
// `extent_s`: extent of its drawn part, in s. `depth`: its optical depth if no sample were missing. `missing`: the
// largest missing share in it.
fn even_share(start: f32, begin: f32, extent_s: f32, depth: f32, at: f32, missing: f32) -> f32 {
    if !EVENS_CUTS {
        return 0.0f;
    }
    let dense = saturate(2.0f * depth / max(CUT_DEPTH * extent_s, 1.2e-38f) - 0.5f);
    let near = dense * saturate(2.0f - (begin - start) / NEAR_CUT);
    if near > 0.0f {
        entry = max(entry, start + (near - 1.0f) * EVEN_REACH);
    }
    let hole = dense * saturate(4.0f * missing - 1.0f);
    if hole > 0.0f {
        entry = max(entry, at + (hole - 1.0f) * EVEN_REACH);
    }
    return clamp((entry + EVEN_REACH - at) * EVEN_PER_SLICE, 0.0f, 1.0f);
}

// A lit colour mixed with the same colour in even light, which no normal, occlusion or shadow changes.
fn evened(lighting: Lighting, rgb: vec3<f32>, lit: vec3<f32>, even: f32) -> vec3<f32> {
    let share = even * lighting.limits.z;
    if share <= 0.0f {
        return lit;
    }
    var sum = vec3<f32>(0.0f);
    for (var k = 0u; k < lighting.lights.y; k++) {
        sum += tables[lighting.lights.x + 3u * k + 2u].xyz;
    }
    let light = lighting.coefficients.x + lighting.coefficients.y * lighting.limits.x * sum;
    return lit + share * (rgb * light - lit);
}
