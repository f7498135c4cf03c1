//! Composite operators: rules by which the densities along a ray become a pixel.
//!
//! *over* and *first hit* draw colours. The others are projections: they keep one number per ray, which the transfer
//! function colours at the end. With `v(s)` the value at world length `s` along a ray of length `L` inside the volume:
//!
//! | operator | number |
//! | --- | --- |
//! | maximum | `max v` |
//! | depth-shaded maximum | `max (black + (v − black) · (1 − strength · t))` where `v > black`, else `v`; `t` rises from 0 at the nearest to 1 at the farthest point of what is drawn, along the view |
//! | local maximum | the first local maximum of at least `threshold`; `max v` where there is none |
//! | minimum | `min v` |
//! | mean | `∫ v ds / L` |
//! | sum | `∫ v ds` |
//! | x-ray | `exp(−∫ μ ds)`, `μ = attenuation · max(0, v − clear)` |
//!
//! Sources: depth shading, Heidrich et al., *Interactive maximum projection volume rendering*, IEEE Visualization 1995,
//! as a factor, Mroz et al., *Maximum intensity projection at warp speed*, Computers & Graphics 24(3), 2000; local
//! maximum, Sato et al., *Local maximum intensity projection (LMIP): a new rendering method for vascular
//! visualization*, J. Computer Assisted Tomography 22(6), 1998; x-ray, the law of Beer and Lambert, which of CT makes a
//! digitally reconstructed radiograph.

use crate::error::{Error, Result};
use crate::options::find;

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

/// Parameters of all operators; NaN where one is not given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CompositeNumbers {
    /// First hit: iso-value.
    pub iso_value: f64,
    /// Local maximum: threshold.
    pub local_threshold: f64,
    /// Depth-shaded maximum: strength and black.
    pub depth_shading: [f64; 2],
    /// X-ray: clear and attenuation.
    pub attenuation: [f64; 2],
}

impl CompositeNumbers {
    /// No parameter is given.
    pub const NONE: Self = Self {
        iso_value: f64::NAN,
        local_threshold: f64::NAN,
        depth_shading: [f64::NAN; 2],
        attenuation: [f64::NAN; 2],
    };
}

impl Composite {
    /// Operator of a public name, with its parameters; [`Composite::validate`] refuses those that are not given.
    pub fn from_name(name: &str, numbers: &CompositeNumbers) -> Result<Self> {
        find("composite", name, &Self::named(numbers))
    }

    /// All operators with their public names.
    pub fn named(numbers: &CompositeNumbers) -> [(&'static str, Self); 9] {
        let CompositeNumbers { iso_value, local_threshold, depth_shading, attenuation } = *numbers;
        let ([strength, black], [clear, attenuation]) = (depth_shading, attenuation);
        [
            ("over", Self::Over),
            ("maximum", Self::Maximum),
            ("depth-shaded-maximum", Self::DepthShadedMaximum { strength, black }),
            ("local-maximum", Self::LocalMaximum { threshold: local_threshold }),
            ("minimum", Self::Minimum),
            ("mean", Self::Mean),
            ("sum", Self::Sum),
            ("x-ray", Self::XRay { clear, attenuation }),
            ("first-hit", Self::FirstHit { iso_value }),
        ]
    }

    /// Whether the result is one number per pixel, coloured at the end.
    pub fn is_projection(self) -> bool {
        !matches!(self, Self::Over | Self::FirstHit { .. })
    }

    /// Checks ranges.
    pub fn validate(self) -> Result<()> {
        let finite = |what: &str, value: f64, mend| {
            let ok = value.is_finite();
            if ok { Ok(()) } else { Err(Error::out_of_range(what, value, "a finite number", mend)) }
        };
        match self {
            Self::FirstHit { iso_value } => {
                let mend = "pass iso_value, the sample value of the surface";
                finite("iso_value of composite \"first-hit\"", iso_value, mend)
            }
            Self::LocalMaximum { threshold } => {
                let mend = "pass local_threshold, the least sample value of a maximum that is shown";
                finite("local_threshold of composite \"local-maximum\"", threshold, mend)
            }
            Self::DepthShadedMaximum { strength, black } => {
                if !(0.0..=1.0).contains(&strength) {
                    let mend = "pass 0 to dim nothing, 1 to dim the farthest point to black";
                    let what = "depth_shading of composite \"depth-shaded-maximum\"";
                    return Err(Error::out_of_range(what, strength, "between 0 and 1", mend));
                }
                let mend = "pass the sample value that values are dimmed towards";
                finite("black of composite \"depth-shaded-maximum\"", black, mend)
            }
            Self::XRay { clear, attenuation } => {
                let mend = "pass (clear, attenuation): a sample value that absorbs nothing, -1000 for Hounsfield units";
                finite("clear value of the attenuation of composite \"x-ray\"", clear, mend)?;
                if !(attenuation.is_finite() && attenuation > 0.0) {
                    let mend = "pass (clear, attenuation): absorption per world length and sample unit, \
                                2e-5 for Hounsfield units and millimetres";
                    let what = "attenuation of composite \"x-ray\"";
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
    fn names_give_operators_and_unknown_ones_list_the_known() {
        let numbers = CompositeNumbers {
            iso_value: 1.0,
            local_threshold: 2.0,
            depth_shading: [0.5, 3.0],
            attenuation: [-1000.0, 2e-5],
        };
        for (name, operator) in Composite::named(&numbers) {
            assert_eq!(Composite::from_name(name, &numbers), Ok(operator));
            assert_eq!(operator.validate(), Ok(()));
            assert_eq!(operator.is_projection(), name != "over" && name != "first-hit");
        }
        let message = Composite::from_name("add", &numbers).unwrap_err().to_string();
        assert!(message.contains("add") && message.contains("maximum, depth-shaded-maximum"), "{message}");
    }

    #[test]
    fn numbers_that_are_missing_or_cannot_work_are_named() {
        let check = |numbers: CompositeNumbers, name: &str, word: &str| {
            let message = Composite::from_name(name, &numbers).unwrap().validate().unwrap_err().to_string();
            assert!(message.contains(word) && message.contains(name), "{message}");
        };
        let none = CompositeNumbers::NONE;
        check(none, "first-hit", "iso_value");
        check(none, "local-maximum", "local_threshold");
        check(CompositeNumbers { local_threshold: f64::INFINITY, ..none }, "local-maximum", "inf");
        check(none, "depth-shaded-maximum", "depth_shading");
        check(CompositeNumbers { depth_shading: [1.5, 0.0], ..none }, "depth-shaded-maximum", "between 0 and 1");
        check(CompositeNumbers { depth_shading: [1.0, f64::NAN], ..none }, "depth-shaded-maximum", "black");
        check(none, "x-ray", "clear");
        for attenuation in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            check(CompositeNumbers { attenuation: [0.0, attenuation], ..none }, "x-ray", "positive");
        }
    }
}
