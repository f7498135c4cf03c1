// Phong shading with the reflection vector, two-sided. Twin of crates/splat/src/optics/shade.rs.

fn squared_gradient(metric: array<vec4<f32>, 2>, g: vec3<f32>) -> f32 {
    let sums = metric[0].xyz * g * g;
    return sums.x + sums.y + sums.z + metric[0].w * g.x * g.y + metric[1].x * g.x * g.z + metric[1].y * g.y * g.z;
}

// Power of a base from 0 to 1; by repeated squaring where the exponent is an integer.
fn raise(base: f32, power: f32) -> f32 {
    if fract(power) != 0.0f {
        return select(0.0f, pow(max(base, 1e-30f), power), base > 1e-30f);
    }
    var result = 1.0f;
    var square = base;
    for (var left = u32(power); left != 0u; left >>= 1u) {
        result = select(result, result * square, (left & 1u) == 1u);
        square = square * square;
    }
    return result;
}

// Colour in the light of all lights. `to_eye`: a linear form on gradients. `first`: share of the first light that
// arrives.
fn shade(lighting: Lighting, rgb: vec3<f32>, gradient: vec3<f32>, to_eye: vec3<f32>, first: f32) -> vec3<f32> {
    let squared = squared_gradient(lighting.metric, gradient);
    let exists = squared > lighting.limits.y;
    let inverse = select(0.0f, inverseSqrt(max(squared, 1e-36f)), exists);
    let n_v = dot(gradient, to_eye) * inverse;
    var lit = vec3<f32>(lighting.coefficients.x);
    var highlight = vec3<f32>(0.0f);
    for (var k = 0u; k < lighting.lights.y; k++) {
        let on_gradient = tables[lighting.lights.x + 3u * k];
        let on_view = tables[lighting.lights.x + 3u * k + 1u];
        let color = tables[lighting.lights.x + 3u * k + 2u].xyz;
        let is_at_eye = on_gradient.w > 0.0f;
        let n_l = select(dot(on_gradient.xyz, gradient) * inverse, n_v, is_at_eye);
        let l_v = select(dot(on_view.xyz, to_eye), 1.0f, is_at_eye);
        let reflected = select(0.0f, max(2.0f * n_l * n_v - l_v, 0.0f), exists);
        let share = select(1.0f, first, k == 0u);
        let diffuse = lighting.coefficients.y * select(lighting.limits.x, abs(n_l), exists) * share;
        let specular = lighting.coefficients.z * raise(min(reflected, 1.0f), lighting.coefficients.w) * share;
        lit += diffuse * color;
        highlight += specular * color;
    }
    return rgb * lit + highlight;
}
