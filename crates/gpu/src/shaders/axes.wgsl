// Index axes called u, v, w, and x, y, z. Twin of crates/splat/src/view/family.rs.

fn to_xyz(uvw: vec3<i32>) -> vec3<i32> {
    switch parameters.frame.axes.x {
        case 0u: { return uvw.zxy; }
        case 1u: { return uvw.xzy; }
        default: { return uvw; }
    }
}

fn to_xyz_f32(uvw: vec3<f32>) -> vec3<f32> {
    switch parameters.frame.axes.x {
        case 0u: { return uvw.zxy; }
        case 1u: { return uvw.xzy; }
        default: { return uvw; }
    }
}

fn to_uvw(xyz: vec3<f32>) -> vec3<f32> {
    switch parameters.frame.axes.x {
        case 0u: { return xyz.yzx; }
        case 1u: { return xyz.xzy; }
        default: { return xyz; }
    }
}
