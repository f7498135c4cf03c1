//! Segmentation labels: colour and opacity of a label, and its effect on the scan.

use crate::error::{Error, Result};

/// Appearance of a label, or of samples without one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LabelLook {
    /// Red, green, blue, `0..=1`.
    pub rgb: [f64; 3],
    /// Opacity of the label medium per `opacity_unit`, `0..=1`; 0: no medium.
    pub opacity: f64,
    /// Factor of the scan's optical depth inside, `0..=1`; 0 hides the scan there.
    pub scan: f64,
    /// Share of the scan's colour inside that the label's colour replaces, `0..=1`.
    pub tint: f64,
}

impl LabelLook {
    /// Appearance of samples without a label: the scan, unchanged.
    pub const NONE: Self = Self { rgb: [0.0; 3], opacity: 0.0, scan: 1.0, tint: 0.0 };

    /// Checks all numbers. `name` appears in messages only.
    pub fn validate(&self, name: &str) -> Result<()> {
        let [r, g, b] = self.rgb;
        let numbers = [("red", r), ("green", g), ("blue", b), ("opacity", self.opacity), ("scan", self.scan)];
        for (what, number) in numbers.into_iter().chain([("tint", self.tint)]) {
            if !(0.0..=1.0).contains(&number) {
                let what = format!("label {name:?}: {what}");
                return Err(Error::out_of_range(what, number, "between 0 and 1", "scale it to 0..1"));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_beyond_one_are_refused() {
        assert!(LabelLook::NONE.validate("none").is_ok());
        for bad in [1.5, -0.1, f64::NAN] {
            assert!(LabelLook { opacity: bad, ..LabelLook::NONE }.validate("bad").is_err());
            assert!(LabelLook { rgb: [0.0, bad, 0.0], ..LabelLook::NONE }.validate("bad").is_err());
        }
    }
}
