// Reconstruction kernels h(x), x in samples. Twin of crates/splat/src/kernel/weights.rs and smoothed.rs, whose heads
// have the formulas and their sources.

// Position of a texel among samples along x, y and z: `base`, a sample near it, plus `at`, which is small, so that f32
// holds it well. `last`: the volume's last sample, counted from the base.
struct Place {
    base: vec3<i32>,
    at: vec3<f32>,
    last: vec3<f32>,
}

// The samples that reach a position, and their weights along each axis.
struct Footprint {
    // Sample below the position (nearest to it, for the quadratic B-spline), counted from the base; and offset of the
    // first weight's sample from it.
    cell: vec3<i32>,
    first: vec3<i32>,
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}

fn weights(kernel: u32, t: f32) -> vec4<f32> {
    switch kernel {
        case KERNEL_CATMULL_ROM: {
            let w0 = ((-0.5f * t + 1.0f) * t - 0.5f) * t;
            let w1 = (1.5f * t - 2.5f) * t * t + 1.0f;
            let w3 = (0.5f * t - 0.5f) * t * t;
            return vec4<f32>(w0, w1, 1.0f - w0 - w1 - w3, w3);
        }
        case KERNEL_BSPLINE2: {
            let w0 = 0.5f * (0.5f - t) * (0.5f - t);
            let w2 = 0.5f * (0.5f + t) * (0.5f + t);
            return vec4<f32>(w0, 1.0f - w0 - w2, w2, 0.0f);
        }
        case KERNEL_BSPLINE3: {
            let s = 1.0f - t;
            let w0 = s * s * s * 0.16666667f;
            let w3 = t * t * t * 0.16666667f;
            let w1 = 0.6666667f + t * t * (0.5f * t - 1.0f);
            return vec4<f32>(w0, w1, 1.0f - w0 - w1 - w3, w3);
        }
        case KERNEL_GAUSSIAN: {
            // Divided by exp(-2 t^2), all four are constants times powers of exp(4 t): one exponential does for all.
            let q = exp(4.0f * t);
            let last = select(0.0f, 3.3546263e-4f * q * q, t > 0.0f);
            let w = vec4<f32>(0.13533528f / q, 1.0f, 0.13533528f * q, last);
            return w / (w.x + w.y + w.z + w.w);
        }
        default: {
            return vec4<f32>(1.0f - t, t, 0.0f, 0.0f);
        }
    }
}

fn footprint_of(kernel: u32, x: vec3<f32>) -> Footprint {
    // The taps of the quadratic B-spline are centred at the nearest sample.
    let below = floor(x + select(0.0f, 0.5f, kernel == KERNEL_BSPLINE2));
    let t = x - below;
    let first = vec3<i32>(select(-1, 0, kernel == KERNEL_LINEAR));
    return Footprint(vec3<i32>(below), first, weights(kernel, t.x), weights(kernel, t.y), weights(kernel, t.z));
}

// The `k`th of four weights.
fn weight_at(weights: vec4<f32>, k: i32) -> f32 {
    return select(select(weights.x, weights.y, k == 1), select(weights.z, weights.w, k == 3), k > 1);
}

// Weighted sum over 4 x 4 samples, given as four quads: a and b in the first two rows, c and d in the last two.
fn plane_sum(a: vec4<f32>, b: vec4<f32>, c: vec4<f32>, d: vec4<f32>, x: vec4<f32>, y: vec4<f32>) -> f32 {
    let rows = vec4<f32>(
        dot(vec4<f32>(a.xy, b.xy), x),
        dot(vec4<f32>(a.zw, b.zw), x),
        dot(vec4<f32>(c.xy, d.xy), x),
        dot(vec4<f32>(c.zw, d.zw), x),
    );
    return dot(rows, y);
}

// Cubic B-spline and its derivative.
fn bspline3(x: f32) -> vec2<f32> {
    let r = abs(x);
    let rest = max(2.0f - r, 0.0f);
    let is_near = r < 1.0f;
    let value = select(rest * rest * rest * 0.16666667f, 0.6666667f + r * r * (0.5f * r - 1.0f), is_near);
    let slope = select(-0.5f * rest * rest, r * (1.5f * r - 2.0f), is_near);
    return vec2<f32>(value, select(slope, -slope, x < 0.0f));
}

// Widened cubic B-spline and its derivative at a tap; 0 for taps beyond `n_taps`, which only complete a quad.
fn smoothed_tap(position: f32, tap: i32, n_taps: i32, per_width: f32) -> vec2<f32> {
    return select(vec2<f32>(0.0f), bspline3(position - f32(tap) * per_width), tap < n_taps);
}

// Sums of the weights of an axis, and of their derivatives, to normalise by: widened B-splines do not sum to 1
// everywhere.
fn smoothed_sums(position: f32, n_taps: i32, per_width: f32) -> vec2<f32> {
    var sums = vec2<f32>(0.0f);
    for (var tap = 0; tap < n_taps; tap++) {
        sums += smoothed_tap(position, tap, n_taps, per_width);
    }
    return sums;
}
