//! Where the picture's pixels are read from their base planes.

use wavesplat_core::Composite;

/// How pixels are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reads {
    /// The mean of so many reads along x and as many along y, evenly spread in the pixel: of 1 that of its middle.
    Grid(usize),
    /// The middle and the corners (`quincunx.rs`).
    Quincunx,
    /// One of so many pixels along x and along y, others put between them (`enlarge.rs`).
    OneOf(usize),
}

/// Texels per pixel along each axis that a pixel's middle does for, but for what is as good as none.
const MOST_OF_MIDDLE: f64 = 1.05;

/// Those that its corners do for. Up to here they leave hardly more error than four reads, in less time.
const MOST_OF_QUINCUNX: f64 = 1.3;

impl Reads {
    /// For so many texels per pixel along each axis: about as many along each. Projections end abruptly where the volume
    /// does: their pixels are read once.
    pub fn of_texels(composite: Composite, oversampling: f64) -> Self {
        if composite.is_projection() || oversampling <= MOST_OF_MIDDLE {
            Self::Grid(1)
        } else if oversampling <= MOST_OF_QUINCUNX {
            Self::Quincunx
        } else {
            Self::Grid((oversampling + 1.0 - MOST_OF_MIDDLE).ceil() as usize)
        }
    }

    /// Whether a pixel is the mean of several reads.
    pub fn is_mean(self) -> bool {
        matches!(self, Self::Quincunx | Self::Grid(2..))
    }

    /// How many pixels along each axis share a read.
    pub fn pixels_per_read(self) -> usize {
        if let Self::OneOf(n) = self { n } else { 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_is_read_as_often_as_it_has_texels() {
        let [one, two, three, four] = [1, 2, 3, 4].map(Reads::Grid);
        let pairs = [(0.5, one), (1.0, one), (1.04, one), (1.1, Reads::Quincunx), (1.2, Reads::Quincunx)];
        for (oversampling, reads) in
            pairs.into_iter().chain([(1.4, two), (2.0, two), (2.5, three), (3.0, three), (4.0, four)])
        {
            assert_eq!(Reads::of_texels(Composite::Over, oversampling), reads);
            assert_eq!(Reads::of_texels(Composite::Maximum, oversampling), one, "projections end abruptly");
            assert_eq!(reads.is_mean(), oversampling > 1.05);
        }
    }
}
