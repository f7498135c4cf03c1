// One thread marches the ray of one base-plane texel through a range of slabs, from a state to the next. Twin of
// `TileJob::run` (crates/splat/src/render/tile.rs). A workgroup is one of the CPU's blocks.

@compute @workgroup_size(16, 8)
fn march(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let block = group.x + group.y * parameters.frame.blocks.z;
    if block >= parameters.frame.blocks.y {
        return;
    }
    let place = words[parameters.frame.blocks.x + block];
    let texel = vec2<u32>((place & 0xffffu) * 16u + local.x, (place >> 16u) * 8u + local.y);
    let index = block * 128u + local.y * 16u + local.x;
    if parameters.frame.axes.y == 1u {
        gathered = vec4<f32>(FIRST_VALUE, 0.0f, 0.0f, 0.0f);
        s_half = NONE;
        entry = NO_ENTRY;
    } else {
        gathered = state[index * N_STATE];
        if N_STATE == 2u {
            let before = state[index * N_STATE + 1u];
            s_half = before.x;
            n_fetches = u32(before.y);
            n_texels = u32(before.z);
            entry = before.w;
        }
    }
    let interval = intervals[index];
    if interval.x < interval.y && !is_done() {
        let length = length(affine(parameters.frame.to_next, texel));
        march_ray(Ray(texel, interval, length), block);
    }
    state[index * N_STATE] = gathered;
    if N_STATE == 2u {
        state[index * N_STATE + 1u] = vec4<f32>(s_half, f32(n_fetches), f32(n_texels), entry);
    }
}
