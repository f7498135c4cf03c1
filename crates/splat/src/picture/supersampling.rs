//! Supersampling: the number of reads of the base plane that a pixel is the mean of.

use wavesplat_core::Composite;

/// Largest number of texels per pixel along each axis for which a single read suffices.
const MAX_OF_ONE_READ: f64 = 1.05;

/// Reads of a pixel per axis: about one per texel, so that a pixel is the mean over its area. Projections show samples
/// to the bit where rays run through them: their pixels are read once. Where a wall passes through a pixel, `edges`
/// reads it.
pub fn reads_per_axis(composite: Composite, oversampling: f64) -> usize {
    if composite.is_projection() { 1 } else { (oversampling + 1.0 - MAX_OF_ONE_READ).ceil().max(1.0) as usize }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_read_as_often_as_it_has_texels() {
        for (oversampling, n) in
            [(0.02, 1), (0.5, 1), (1.0, 1), (1.04, 1), (1.1, 2), (2.0, 2), (2.5, 3), (3.0, 3), (4.0, 4)]
        {
            assert_eq!(reads_per_axis(Composite::Over, oversampling), n);
            assert_eq!(reads_per_axis(Composite::Maximum, oversampling), 1, "projections show samples");
        }
    }
}
