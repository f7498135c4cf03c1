// State of a ray: colour and opacity, composited front to back. Twin of crates/splat/src/ray/accumulator.rs.

// Associated colour and opacity. Projections: the density or its integral, then the length of the way; a local maximum
// has 1 there once the ray has ended; then the optical depth so far, of attenuated maxima.
var<private> gathered: vec4<f32>;
// Position of opacity 1/2, of the surface or of the extreme; NONE where there is none.
var<private> s_half: f32;

// Composites a fragment of unassociated colour behind the state; its opacity grows evenly over `length` from `begin`.
fn add_fragment(rgb: vec3<f32>, alpha: f32, begin: f32, length: f32) {
    let before = gathered.w;
    let weight = (1.0f - before) * alpha;
    gathered = vec4<f32>(gathered.xyz + weight * rgb, before + weight);
    if before < 0.5f && gathered.w >= 0.5f {
        s_half = begin + (0.5f - before) / max(weight, 1e-30f) * length;
    }
}
