//! The choices of high-resolution splatting, each with the form that it improves on, so that a study can show what each
//! of them buys. The default is the renderer as it is.
//!
//! | switch | on, or default | off, or other |
//! | --- | --- | --- |
//! | view angle | slabs are `dz / cos θ` thick along a ray | they are `dz` thick, whatever the angle |
//! | kernel slicing | a sheet is made of all slices within the kernel's radius | of the nearest slice alone |
//! | gradient | differences over an exact distance | forward; or of texels and sheets, as three sheet buffers give them |
//! | footprint | exact weights | those of the nearest entry of a table, with or without noise on the samples |
//!
//! Source: "High Resolution Image Splatting", IJACEN 2(7), 2014.

use crate::error::{Error, Result};
use crate::options::find;

/// Largest distance of the gradient's differences, samples.
pub const MAX_GRADIENT_OFFSET: f64 = 4.0;

/// Where the differences for the gradient are taken; `d` is [`crate::Shading::gradient_offset`], in samples.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum GradientScheme {
    /// `[V(x + d) − V(x − d)] / 2d` along the index axes at every texel, by footprints.
    #[default]
    Footprint,
    /// `[V(x + d) − V(x)] / d`, towards larger indices, by footprints.
    FootprintForward,
    /// As [`GradientScheme::Footprint`], but of the texels and sheets that there are: `d` becomes the nearest whole number
    /// of texels along x and y and of sheets along z, at least one.
    SheetCentral,
    /// As [`GradientScheme::FootprintForward`], of texels and sheets.
    SheetForward,
}

impl GradientScheme {
    /// All schemes with their public names.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("footprint", Self::Footprint),
        ("footprint-forward", Self::FootprintForward),
        ("sheet-central", Self::SheetCentral),
        ("sheet-forward", Self::SheetForward),
    ];

    /// The scheme with a public name.
    pub fn from_name(name: &str) -> Result<Self> {
        find("gradient", name, &Self::NAMES)
    }

    /// Whether differences go to one side only.
    pub fn is_forward(self) -> bool {
        matches!(self, Self::FootprintForward | Self::SheetForward)
    }

    /// Whether differences are those of texels and sheets.
    pub fn is_of_sheets(self) -> bool {
        matches!(self, Self::SheetCentral | Self::SheetForward)
    }
}

/// Where the weights of a footprint come from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FootprintTable {
    /// The kernel itself.
    #[default]
    Exact,
    /// The nearest entry of a table, which aliases: slopes become stairs.
    Nearest {
        /// Entries per sample distance.
        per_sample: u32,
    },
    /// The same with every sample of a sheet displaced by up to half an entry, which turns the stairs into grain. Slow.
    NearestNoise {
        /// Entries per sample distance.
        per_sample: u32,
    },
}

impl FootprintTable {
    /// The table with a public name; `per_sample` counts its entries where it has any.
    pub fn from_name(name: &str, per_sample: u32) -> Result<Self> {
        let known = [
            ("exact", Self::Exact),
            ("nearest", Self::Nearest { per_sample }),
            ("nearest-noise", Self::NearestNoise { per_sample }),
        ];
        find("footprint", name, &known)
    }
}

/// How high-resolution splatting is carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    /// Off: a sheet stands for `dz` of a ray at any angle.
    pub view_angle_correction: bool,
    /// Off: a sheet holds the samples of the nearest slice, so that sheets between two slices repeat them.
    pub kernel_slicing: bool,
    /// Where gradients come from.
    pub gradient: GradientScheme,
    /// Where weights within a sheet come from.
    pub footprint: FootprintTable,
}

impl Default for Variant {
    fn default() -> Self {
        Self {
            view_angle_correction: true,
            kernel_slicing: true,
            gradient: GradientScheme::default(),
            footprint: FootprintTable::default(),
        }
    }
}

impl Variant {
    /// Whether the space between two sheets may be pre-integrated, which follows a ray through a linear density: without
    /// view-angle correction its way there does not count, without kernel slicing the density jumps on it.
    pub fn may_pre_integrate(&self) -> bool {
        self.view_angle_correction && self.kernel_slicing
    }

    /// Checks ranges.
    pub fn validate(&self) -> Result<()> {
        let (FootprintTable::Nearest { per_sample } | FootprintTable::NearestNoise { per_sample }) = self.footprint
        else {
            return Ok(());
        };
        if !(2..=1024).contains(&per_sample) {
            let mend = "pass 4 to see the table, 64 for one that is hardly told from exact weights";
            return Err(Error::out_of_range("footprint_entries", per_sample, "between 2 and 1024", mend));
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip_and_unknown_ones_list_the_known() {
        for (name, scheme) in GradientScheme::NAMES {
            assert_eq!(GradientScheme::from_name(name), Ok(scheme));
        }
        assert_eq!(FootprintTable::from_name("nearest", 7), Ok(FootprintTable::Nearest { per_sample: 7 }));
        let message = GradientScheme::from_name("central").unwrap_err().to_string();
        assert!(message.contains("gradient") && message.contains("sheet-central"), "{message}");
        let message = FootprintTable::from_name("linear", 7).unwrap_err().to_string();
        assert!(message.contains("exact, nearest, nearest-noise"), "{message}");
    }

    #[test]
    fn tables_have_entries() {
        for per_sample in [0, 1, 1025] {
            for footprint in [FootprintTable::Nearest { per_sample }, FootprintTable::NearestNoise { per_sample }] {
                let variant = Variant { footprint, ..Variant::default() };
                let message = variant.validate().unwrap_err().to_string();
                assert!(
                    message.contains("footprint_entries is") && message.contains("between 2 and 1024"),
                    "{message}"
                );
            }
        }
        assert_eq!(Variant::default().validate(), Ok(()));
    }
}
