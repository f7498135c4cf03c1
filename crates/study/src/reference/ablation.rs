//! Ablation study: the choices of high-resolution splatting, each with the form that it improves on, so that a study
//! can show what each of them buys. The default is the method as it is.
//!
//! | choice | on, or default | off, or other |
//! | --- | --- | --- |
//! | view-angle correction | slabs are `dz / cos θ` thick along a ray | they are `dz` thick, whatever the angle |
//! | kernel slicing | a sheet is made of all slices within the kernel's radius | of the nearest slice alone |
//! | gradient | central differences over an exact distance | forward; or of texels and sheets, as three sheet buffers give them |
//! | footprint | exact weights | weights of the nearest entry of a table, with or without noise on the samples |
//!
//! Source: "High Resolution Image Splatting", IJACEN 2(7), 2014.

use wavesplat_core::{Error, MAX_GRADIENT_OFFSET, Result};

/// Placement of the differences for the gradient; `d` is the offset of [`wavesplat_core::Gradient::Difference`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum GradientScheme {
    /// Central differences `[V(x + d) − V(x − d)] / 2d` along the index axes at every texel, by footprints.
    #[default]
    Footprint,
    /// Forward differences `[V(x + d) − V(x)] / d`, towards larger indices, by footprints.
    FootprintForward,
    /// Like [`GradientScheme::Footprint`], but between existing texels and sheets: `d` becomes the nearest whole number
    /// of texels along x and y and of sheets along z, at least one.
    SheetCentral,
    /// Like [`GradientScheme::FootprintForward`], between existing texels and sheets.
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

    /// Whether differences are taken between existing texels and sheets.
    pub fn uses_texel_steps(self) -> bool {
        matches!(self, Self::SheetCentral | Self::SheetForward)
    }

    /// Both ends of a difference, relative to its position. `offset`: `d`; `step`: distance of the texels or sheets.
    pub fn ends(self, offset: f64, step: f64) -> [f64; 2] {
        let end = if self.uses_texel_steps() { whole_steps(offset, step) } else { offset };
        let is_forward = matches!(self, Self::FootprintForward | Self::SheetForward);
        [if is_forward { 0.0 } else { -end }, end]
    }
}

/// The whole number of steps, at least one, nearest to an offset; as an offset, at most [`MAX_GRADIENT_OFFSET`].
fn whole_steps(offset: f64, step: f64) -> f64 {
    let step = step.abs();
    // Where a sheet passes the eye all its texels coincide.
    let whole = if step > 0.0 { (offset / step).round().max(1.0) * step } else { offset };
    whole.min(MAX_GRADIENT_OFFSET)
}

/// Source of the weights of a footprint.
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
    /// The nearest entry, with every sample of a sheet displaced by up to half an entry, which turns the stairs into
    /// grain.
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

/// Choice of the parts of the method that are left out or changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Ablation {
    /// Off: a sheet stands for `dz` of a ray at any angle.
    pub view_angle_correction: bool,
    /// Off: a sheet holds the samples of the nearest slice, so that sheets between two slices repeat them.
    pub kernel_slicing: bool,
    /// Placement of the differences for gradients.
    pub gradient: GradientScheme,
    /// Source of the weights within a sheet.
    pub footprint: FootprintTable,
}

impl Default for Ablation {
    fn default() -> Self {
        Self::NONE
    }
}

impl Ablation {
    /// The method as it is.
    pub const NONE: Self = Self {
        view_angle_correction: true,
        kernel_slicing: true,
        gradient: GradientScheme::Footprint,
        footprint: FootprintTable::Exact,
    };

    /// Checks the range of the number of table entries.
    pub fn validate(&self) -> Result<()> {
        let (FootprintTable::Nearest { per_sample } | FootprintTable::NearestNoise { per_sample }) = self.footprint
        else {
            return Ok(());
        };
        if !(2..=1024).contains(&per_sample) {
            let mend = "pass 4 to see the table, 64 for one that hardly differs from exact weights";
            return Err(Error::out_of_range("footprint_entries", per_sample, "between 2 and 1024", mend));
        }
        Ok(())
    }
}

/// The value with a public name.
fn find<T: Copy>(what: &'static str, name: &str, known: &[(&'static str, T)]) -> Result<T> {
    known.iter().find(|(n, _)| *n == name).map(|&(_, value)| value).ok_or_else(|| Error::UnknownName {
        what,
        name: name.to_owned(),
        known: known.iter().map(|(n, _)| *n).collect::<Vec<_>>().join(", "),
    })
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
                let ablation = Ablation { footprint, ..Ablation::default() };
                let message = ablation.validate().unwrap_err().to_string();
                assert!(
                    message.contains("footprint_entries is") && message.contains("between 2 and 1024"),
                    "{message}"
                );
            }
        }
        assert_eq!(Ablation::default().validate(), Ok(()));
    }

    #[test]
    fn offsets_become_whole_steps() {
        for (offset, step, want) in [
            (0.01, 0.25, 0.25),
            (0.6, 0.25, 0.5),
            (1.0, -0.25, 1.0),
            (1.0, 0.3, 0.9),
            (1.0, 3.0, 3.0),
            (1.0, 9.0, MAX_GRADIENT_OFFSET),
            (0.5, 0.0, 0.5),
        ] {
            let got = whole_steps(offset, step);
            assert!((got - want).abs() < 1e-12, "{offset} in steps of {step}: {got}");
        }
        assert_eq!(GradientScheme::SheetForward.ends(0.2, 0.5), [0.0, 0.5]);
        assert_eq!(GradientScheme::FootprintForward.ends(0.2, 0.5), [0.0, 0.2]);
        assert_eq!(GradientScheme::Footprint.ends(0.2, 0.5), [-0.2, 0.2]);
    }
}
