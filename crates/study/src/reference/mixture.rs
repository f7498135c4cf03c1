//! Effect of the labels at a position: shares of the scan that are left and tinted, and the labels' own matter, by the
//! coverage of every label there.

use glam::DVec3;
use wavesplat_splat::optics::labels::{Labels, own_depth};

use super::reached_samples::for_each_tap;

/// Effect of the labels at a position.
#[derive(Default)]
pub struct Mixture {
    /// Share of the scan that is left; `tint` is the tinted part of it.
    pub scan: f64,
    pub tint: f64,
    pub tint_rgb: [f64; 3],
    /// Optical depth of the label medium; `own_rgb` is its colour times that.
    pub own: f64,
    pub own_rgb: [f64; 3],
}

impl Mixture {
    /// The mixture by the coverage of every label at an index position.
    pub fn new(labels: &Labels, size: [usize; 3], position: DVec3) -> Self {
        let mut mixture = Self::default();
        for_each_tap(labels.kernel, size, position, |[x, y, z], weight| {
            let look = &labels.looks[labels.codes.get((z * size[1] + y) * size[0] + x)];
            let (tint, own) = (weight * look.scan * look.tint, weight * own_depth(look));
            mixture.scan += weight * look.scan;
            mixture.tint += tint;
            mixture.own += own;
            for c in 0..3 {
                mixture.tint_rgb[c] += tint * look.rgb[c];
                mixture.own_rgb[c] += own * look.rgb[c];
            }
        });
        mixture
    }
}
