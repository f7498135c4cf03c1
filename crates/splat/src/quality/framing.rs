//! Framing of a volume by a picture: decides what the errors of one view say about another.

use wavesplat_core::{Camera, Grid, RenderOptions};

use crate::view::family::{Family, IndexRays};

/// Framing of a volume by a picture: distances of the rays and of the slices, in the middle of the volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing {
    /// Distance between rays of neighbouring pixels, in samples: 0.01 to 100.
    pub pixel_in_samples: f64,
    /// Length of a ray from slice to slice, in samples: 1 to 1.9.
    pub slice_in_samples: f64,
    /// Share of the pixels that a square as wide as the volume's diagonal would cover, `0..=1`: how much is seen, from
    /// any side.
    pub covered: f64,
}

impl Framing {
    pub fn new(grid: &Grid, camera: &Camera, options: &RenderOptions) -> Self {
        let size_px = [options.width_px, options.height_px];
        let [first, last] = grid.bounds();
        let rays = IndexRays::new(camera, grid.index_from_world(), size_px[0], size_px[1]);
        let middle = size_px.map(|n| 0.5 * n as f64);
        let pixel_in_samples = rays.distance_at(0.5 * (first + last), middle).clamp(0.01, 100.0);
        let direction = rays.direction(middle[0], middle[1]);
        let [_, _, across] = Family::of(direction).uvw(direction);
        let n_covered = ((last - first).length() / pixel_in_samples).powi(2);
        let covered = (n_covered / (size_px[0] * size_px[1]) as f64).min(1.0);
        Self { pixel_in_samples, slice_in_samples: direction.length() / across.abs(), covered }
    }
}
