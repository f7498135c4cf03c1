//! The samples that the kernel reaches from a position, with their weights.

use glam::DVec3;
use wavesplat_core::Kernel;
use wavesplat_splat::kernel::weights::{MAX_TAPS, mirror_index, n_taps, taps};

/// Calls `work` with every sample that a position, clamped to the volume, reaches, and its weight.
pub fn for_each_tap(kernel: Kernel, size: [usize; 3], position: DVec3, mut work: impl FnMut([usize; 3], f64)) {
    let n = n_taps(kernel);
    let mut weights = [[0.0; MAX_TAPS]; 3];
    let mut index = [[0; MAX_TAPS]; 3];
    for axis in 0..3 {
        let x = position[axis].clamp(0.0, (size[axis] - 1) as f64);
        let (first, along) = taps(kernel, x);
        weights[axis] = along;
        for t in 0..n {
            index[axis][t] = mirror_index(kernel, first + t as i64, size[axis]);
        }
    }
    for tz in 0..n {
        for ty in 0..n {
            let weight_zy = weights[2][tz] * weights[1][ty];
            for tx in 0..n {
                work([index[0][tx], index[1][ty], index[2][tz]], weight_zy * weights[0][tx]);
            }
        }
    }
}
