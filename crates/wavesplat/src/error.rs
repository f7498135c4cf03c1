//! What can go wrong when a level of a volume is opened. Drawing fails with [`wavesplat_core::Error`].

use wavesplat_wavelet::WaveletError;

/// Why a level of wavelet coefficients cannot be opened.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LevelError {
    /// There is no such level, or the weights do not fit the levels.
    #[error(transparent)]
    Coefficients(#[from] WaveletError),
    /// The samples cannot lie as the affine has it.
    #[error(transparent)]
    Grid(#[from] wavesplat_core::Error),
}
