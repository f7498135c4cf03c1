//! Composite operators: rules by which the densities along a ray become a pixel.
//!
//! *over* and *first hit* draw colours. The others are projections: they keep one number per ray, which the transfer
//! function colours at the end. With `v(s)` the value at world length `s` along a ray of length `L` inside the volume:
//!
//! | operator | number |
//! | --- | --- |
//! | maximum | `max v` |
//! | depth-shaded maximum | `max (black + (v − black) · (1 − strength · t))` where `v > black`, else `v`; `t` rises from 0 at the nearest to 1 at the farthest point of what is drawn, along the view |
//! | attenuated maximum | `max (black + (v − black) · exp(−attenuation ∫ b ds))` where `v > black`, else `v`; the integral goes from the eye, `b` rises from 0 at `black` to 1 at `white` |
//! | local maximum | the first local maximum of at least `threshold`; `max v` where there is none |
//! | minimum | `min v` |
//! | mean | `∫ v ds / L` |
//! | sum | `∫ v ds` |
//! | x-ray | `exp(−∫ μ ds)`, `μ = attenuation · max(0, v − clear)` |
//!
//! Sources: depth shading, Heidrich et al., *Interactive maximum projection volume rendering*, IEEE Visualization 1995,
//! as a factor, Mroz et al., *Maximum intensity projection at warp speed*, Computers & Graphics 24(3), 2000;
//! attenuated maximum, napari's `attenuated_mip`, which sums samples; here the integral is exact between sheets; local
//! maximum, Sato et al., *Local maximum intensity projection (LMIP): a new rendering method for vascular
//! visualization*, J. Computer Assisted Tomography 22(6), 1998; x-ray, the law of Beer and Lambert, which of CT makes a
//! digitally reconstructed radiograph.

use crate::error::{Error, Result};

/// Composite operator along the rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Composite {
    /// Emission and absorption, front to back (Porter & Duff 1984).
    Over,
    /// Largest value along the ray (maximum intensity projection).
    Maximum,
    /// Largest value along the ray after dimming by depth, so that near matter looks brighter.
    DepthShadedMaximum {
        /// Dimming at the farthest point that is drawn, `0..=1`; 0 at the nearest.
        strength: f64,
        /// Sample value towards which values are dimmed.
        black: f64,
    },
    /// Largest value along the ray after dimming by the bright matter in front of it.
    AttenuatedMaximum {
        /// Sample value that dims nothing, and towards which values are dimmed.
        black: f64,
        /// Sample value from which on matter dims most, above `black`.
        white: f64,
        /// Optical depth of matter at `white`, per world length, `>= 0`.
        attenuation: f64,
    },
    /// The first local maximum along the ray of at least `threshold`; the largest value where there is none.
    LocalMaximum {
        /// Least sample value of the maximum.
        threshold: f64,
    },
    /// Smallest value along the ray.
    Minimum,
    /// Mean value along the ray's path inside the volume.
    Mean,
    /// Integral of the value over the ray's path, sample value x world length.
    Sum,
    /// Share of light that an absorbing volume transmits, `0..=1`: a radiograph.
    XRay {
        /// Sample value at and below which nothing is absorbed; −1000 for Hounsfield units.
        clear: f64,
        /// Absorption per world length and sample unit above `clear`, `> 0`.
        attenuation: f64,
    },
    /// The first surface where the density crosses `iso_value`, shaded.
    FirstHit {
        /// Sample value of the surface.
        iso_value: f64,
    },
}

impl Composite {
    /// Whether the result is one number per pixel, coloured at the end.
    pub fn is_projection(self) -> bool {
        !matches!(self, Self::Over | Self::FirstHit { .. })
    }

    /// Whether the result is an extreme, which has a place on the ray.
    pub fn has_places(self) -> bool {
        match self {
            Self::Maximum
            | Self::DepthShadedMaximum { .. }
            | Self::AttenuatedMaximum { .. }
            | Self::LocalMaximum { .. }
            | Self::Minimum => true,
            Self::Over | Self::FirstHit { .. } | Self::Mean | Self::Sum | Self::XRay { .. } => false,
        }
    }

    /// Checks ranges.
    pub fn validate(self) -> Result<()> {
        let finite = |what: &str, value: f64, mend| {
            let ok = value.is_finite();
            if ok { Ok(()) } else { Err(Error::out_of_range(what, value, "a finite number", mend)) }
        };
        match self {
            Self::FirstHit { iso_value } => {
                finite("iso value of a first hit", iso_value, "give the sample value of the surface")
            }
            Self::LocalMaximum { threshold } => {
                let mend = "give the least sample value of a maximum that is shown";
                finite("threshold of local maxima", threshold, mend)
            }
            Self::DepthShadedMaximum { strength, black } => {
                if !(0.0..=1.0).contains(&strength) {
                    let mend = "0 dims nothing, 1 dims the farthest point to black";
                    let what = "strength of depth shading";
                    return Err(Error::out_of_range(what, strength, "between 0 and 1", mend));
                }
                finite("black of depth shading", black, "give the sample value that values are dimmed towards")
            }
            Self::AttenuatedMaximum { black, white, attenuation } => {
                finite("black of attenuated maxima", black, "give the sample value that dims nothing")?;
                if !(white.is_finite() && white > black) {
                    let mend = "give a sample value above black: there matter dims most what is behind it";
                    return Err(Error::out_of_range("white of attenuated maxima", white, "above black", mend));
                }
                if !(attenuation.is_finite() && attenuation >= 0.0) {
                    let what = "attenuation of attenuated maxima";
                    let mend = "give the optical depth of white matter per world length; 0 dims nothing";
                    return Err(Error::out_of_range(what, attenuation, "a number of at least 0", mend));
                }
                Ok(())
            }
            Self::XRay { clear, attenuation } => {
                let mend = "give a sample value that absorbs nothing, -1000 for Hounsfield units";
                finite("clear value of an x-ray", clear, mend)?;
                if !(attenuation.is_finite() && attenuation > 0.0) {
                    let mend = "give the absorption per world length and sample unit, 2e-5 for Hounsfield units and \
                                millimetres";
                    let what = "attenuation of an x-ray";
                    return Err(Error::out_of_range(what, attenuation, "a positive number", mend));
                }
                Ok(())
            }
            Self::Over | Self::Maximum | Self::Minimum | Self::Mean | Self::Sum => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn over_and_first_hits_draw_colours_and_all_others_are_projections() {
        assert!(!Composite::Over.is_projection() && !Composite::FirstHit { iso_value: 1.0 }.is_projection());
        let projections = [
            Composite::Maximum,
            Composite::DepthShadedMaximum { strength: 0.5, black: 3.0 },
            Composite::AttenuatedMaximum { black: 1.0, white: 9.0, attenuation: 0.2 },
            Composite::LocalMaximum { threshold: 2.0 },
            Composite::Minimum,
            Composite::Mean,
            Composite::Sum,
            Composite::XRay { clear: -1000.0, attenuation: 2e-5 },
        ];
        assert!(projections.iter().all(|operator| operator.is_projection() && operator.validate().is_ok()));
    }

    #[test]
    fn numbers_that_cannot_work_are_named() {
        let check = |operator: Composite, words: [&str; 2]| {
            let message = operator.validate().unwrap_err().to_string();
            assert!(words.iter().all(|word| message.contains(word)), "{message}");
        };
        check(Composite::FirstHit { iso_value: f64::NAN }, ["iso value", "surface"]);
        check(Composite::LocalMaximum { threshold: f64::INFINITY }, ["threshold", "inf"]);
        check(Composite::DepthShadedMaximum { strength: 1.5, black: 0.0 }, ["strength", "between 0 and 1"]);
        check(Composite::DepthShadedMaximum { strength: 1.0, black: f64::NAN }, ["black", "dimmed"]);
        check(Composite::XRay { clear: f64::NAN, attenuation: 1.0 }, ["clear", "Hounsfield"]);
        let attenuated = |black, white, attenuation| Composite::AttenuatedMaximum { black, white, attenuation };
        check(attenuated(f64::NAN, 1.0, 1.0), ["black", "dims nothing"]);
        check(attenuated(1.0, 1.0, 1.0), ["white", "above black"]);
        check(attenuated(0.0, 1.0, -1.0), ["attenuation", "at least 0"]);
        for attenuation in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            check(Composite::XRay { clear: 0.0, attenuation }, ["attenuation", "positive"]);
        }
    }
}
