//! Opacity of a voxel in looks that are chosen for a volume: a few voxels of its largest values are opaque.
//!
//! A voxel is as long as the geometric mean of the spacings, the unit of a transfer function without one. It is the only
//! length of the data that a crop, a padded copy and a stack of more slices share, so the same matter looks the same in
//! all of them. The size of the box is none: a ball in a box eight times as large was half as bright. Nor is the
//! thickness of structures, which a crop to one object changes. A microscope's voxel is fitted to what it resolves, so
//! that the finest structures are some voxels thick, and are seen.
//!
//! Boxes that are thinner than these few voxels are opaque through their whole thickness, as their maximum projection is.

/// Voxels of the largest values that are opaque together. (With 3 a stack of 14 slices is about as bright as its maximum
/// projection; docs/design/022 has the numbers.)
const N_OPAQUE: f64 = 3.0;
/// Opacity that counts as opaque.
const OPAQUE: f64 = 0.995;
/// Largest opacity that several voxels can have together without being opaque each.
const MOST: f64 = 0.9999;

/// Number of voxels of the largest values that are opaque together: three, or as many as a thinner box has.
///
/// `n_samples`, `spacing`: samples along each axis, and their distance.
pub fn opaque_after(n_samples: [usize; 3], spacing: [f64; 3]) -> f64 {
    // By logarithms, since the product of tiny spacings is 0.
    let [x, y, z] = spacing.map(f64::ln);
    let voxel = ((x + y + z) / 3.0).exp();
    let sides = n_samples.iter().zip(spacing).map(|(&n, step)| n as f64 * step);
    N_OPAQUE.min(sides.fold(f64::INFINITY, f64::min) / voxel)
}

/// Opacity of one voxel, of which `n_voxels` together have `opacity`.
pub fn opacity_of_voxel(opacity: f64, n_voxels: f64) -> f64 {
    1.0 - (1.0 - opacity.min(MOST)).powf(1.0 / n_voxels)
}

/// Opacity of a voxel whose extinction is `share` of that of the largest values, `n_voxels` of which are opaque together.
pub fn opacity_of_share(share: f64, n_voxels: f64) -> f64 {
    -((-OPAQUE).ln_1p() / n_voxels * share).exp_m1()
}

/// Opacity of a voxel at a place in a window, 0..1: extinction rises with the square of the place.
pub fn rising(place: f64, n_voxels: f64) -> f64 {
    opacity_of_share(place * place, n_voxels)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_voxels_of_the_largest_values_are_opaque() {
        assert_eq!(opaque_after([64, 64, 64], [0.5, 0.5, 2.0]), 3.0);
        assert!((1.0 - (1.0 - rising(1.0, 3.0)).powi(3) - OPAQUE).abs() < 1e-12);
        assert!((opacity_of_voxel(0.75, 2.0) - 0.5).abs() < 1e-12);
        assert_eq!(rising(0.0, 3.0), 0.0);
    }

    #[test]
    fn thin_boxes_and_tiny_spacings_have_a_thickness() {
        assert!((opaque_after([9, 9, 2], [1e-200; 3]) - 2.0).abs() < 1e-9);
    }
}
