// Classification: colour and optical depth of a density, once per texel, after reconstruction; and the opacity of a
// slab. Twin of crates/splat/src/optics/classify.rs.

// Value of a table at a position, linear between entries.
fn look_up(first: u32, n_entries: u32, position: f32) -> vec4<f32> {
    let inside = clamp(position, 0.0f, f32(n_entries - 2u));
    let cell = u32(inside);
    let below = tables[first + cell];
    return below + (tables[first + cell + 1u] - below) * (inside - f32(cell));
}

fn table_position(layer: u32, density: f32) -> f32 {
    let domain = parameters.layers[layer].domain;
    return (density - domain.x) * domain.y;
}

// Red, green, blue, optical depth per opacity unit.
fn classify(layer: u32, density: f32) -> vec4<f32> {
    let places = parameters.layers[layer].tables;
    return look_up(places.x, places.w, table_position(layer, density));
}

// Colour of a density; undefined where its opacity is 0.
fn color_of(layer: u32, density: f32) -> vec3<f32> {
    let only = parameters.layers[layer].only;
    if only.w > 0.0f {
        return only.xyz;
    }
    return classify(layer, density).xyz;
}

// Whether any density from `lo` to `hi` may be visible.
fn is_visible(layer: u32, lo: f32, hi: f32) -> bool {
    let visible = parameters.layers[layer].visible;
    return visible.x <= hi && lo <= visible.y;
}

// 1 - exp(-x) for x >= 0, by x = n ln 2 + r and a Taylor series of exp(-r) - 1. The last line forms
// 1 - 2^-n - 2^-n (exp(-r) - 1), so that nothing cancels for small x, where n = 0. ln 2 is split in two for an exact r.
fn one_minus_exp_neg(depth: f32) -> f32 {
    let x = min(depth, 80.0f);
    let n = round(x * 1.442695f);
    let y = n * -2.1219444e-4f - (x - n * 0.6933594f);
    var series = 1.0f / 720.0f + y * (1.0f / 5040.0f);
    series = 1.0f / 24.0f + y * (1.0f / 120.0f + y * series);
    series = 0.5f + y * (1.0f / 6.0f + y * series);
    series = y + y * y * series;
    let power = bitcast<f32>(u32(127 - i32(n)) << 23u);
    return (1.0f - power) - power * series;
}
