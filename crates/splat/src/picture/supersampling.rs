//! Supersampling: the number of reads of the base plane that a pixel is the mean of.

use wavesplat_core::Composite;

/// Smallest number of texels per pixel along each axis for which pixels are means of several reads. With one texel a
/// pixel, the mean of 2 x 2 reads has 1.0 dB (steep functions) to 1.6 dB (smooth ones) more than a single read has.
const MIN_OF_TWO_READS: f64 = 0.95;

/// Reads of a pixel per axis: two for one texel, and about one per texel beyond two, so that a pixel is the mean over
/// its area. Projections show samples to the bit where rays run through them: their pixels are read once. Where a wall
/// passes through a pixel, `edges` reads it.
pub fn reads_per_axis(composite: Composite, oversampling: f64) -> usize {
    if composite.is_projection() || oversampling < MIN_OF_TWO_READS {
        return 1;
    }
    ((oversampling - 0.05).ceil() as usize).max(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_read_as_often_as_it_has_texels() {
        for (oversampling, n) in
            [(0.02, 1), (0.5, 1), (0.9, 1), (1.0, 2), (1.1, 2), (2.0, 2), (2.5, 3), (3.0, 3), (4.0, 4)]
        {
            assert_eq!(reads_per_axis(Composite::Over, oversampling), n);
            assert_eq!(reads_per_axis(Composite::Maximum, oversampling), 1, "projections show samples");
        }
    }
}
