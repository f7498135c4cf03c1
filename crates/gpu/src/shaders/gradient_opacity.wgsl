// Gradient opacity, and transfer functions of two dimensions. Twin of crates/splat/src/optics/gradient_opacity.rs.

fn gradient_magnitude(layer: u32, gradient: vec3<f32>) -> f32 {
    return sqrt(max(squared_gradient(parameters.layers[layer].joint_metric, gradient), 1e-36f));
}

// Factor of the optical depth by gradient magnitude.
fn gradient_factor(layer: u32, gradient: vec3<f32>) -> f32 {
    let entry = parameters.layers[layer].joint_size;
    let position = gradient_magnitude(layer, gradient) * parameters.layers[layer].joint.w;
    return look_up(parameters.layers[layer].tables.z, entry.x, position).x;
}

// Colour and optical depth by density and gradient magnitude.
fn classify_jointly(layer: u32, density: f32, gradient: vec3<f32>) -> vec4<f32> {
    let size = parameters.layers[layer].joint_size;
    let joint = parameters.layers[layer].joint;
    let magnitude = gradient_magnitude(layer, gradient);
    let position = vec2<f32>((density - joint.x) * joint.y, (magnitude - joint.z) * joint.w);
    let x = clamp(position, vec2<f32>(0.0f), vec2<f32>(size.xy - 1u));
    let cell = min(floor(x), vec2<f32>(size.xy - 2u));
    let t = x - cell;
    let place = parameters.layers[layer].tables.z + u32(cell.x) + u32(cell.y) * size.x;
    let a = tables[place];
    let b = tables[place + 1u];
    let c = tables[place + size.x];
    let d = tables[place + size.x + 1u];
    let low = a + (b - a) * t.x;
    let high = c + (d - c) * t.x;
    return low + (high - low) * t.y;
}
