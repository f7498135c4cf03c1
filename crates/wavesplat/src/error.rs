//! Errors on opening a level of a volume. Drawing fails with [`wavesplat_core::Error`].

use wavesplat_wavelet::WaveletError;

/// Error on opening a level of wavelet coefficients.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LevelError {
    /// There is no such level, or the weights do not fit the levels.
    #[error(transparent)]
    Coefficients(#[from] WaveletError),
    /// The affine gives no valid grid.
    #[error(transparent)]
    Grid(#[from] wavesplat_core::Error),
}
