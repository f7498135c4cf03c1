//! Looks by name: ours, and those of 3D Slicer.
//!
//! A preset for data without fixed units cannot name samples, so its nodes are places on a
//! [`Scale`](crate::scale::Scale) of the volume's own values. Where Slicer has a preset of the same name as ours,
//! `slicer-` before it means Slicer's.

mod ours;
mod preset;
mod slicer;
mod slicer_tables;

pub use self::preset::{OpacityUnit, Preset};
pub use self::slicer::SlicerPreset;
use crate::look::Look;
use crate::scale::Span;
use crate::texts::plain;
use wavesplat_core::{Error, Result};

/// Kinds of data that presets are for, in the order of lists, and their titles.
pub const GROUPS: [(&str, &str); 7] = [
    ("ct", "CT, in Hounsfield units"),
    ("mr", "Magnetic resonance, in any units"),
    ("pet", "PET and SPECT, in any units"),
    ("microscopy", "Microscopy, in any units"),
    ("simulation", "Simulation, in any units"),
    ("any", "Any data"),
    ("slicer", "3D Slicer's presets: their points and light"),
];
/// Text before the names of Slicer's presets.
pub const SLICER_PREFIX: &str = "slicer-";
/// Ours, in groups, in alphabetical order in each.
pub fn ours() -> &'static [Preset] {
    &ours::PRESETS
}

/// 3D Slicer's, in its order.
pub fn slicers() -> &'static [SlicerPreset] {
    &slicer_tables::SLICER
}

/// The name of one of Slicer's among all presets: with `slicer-` before it where ours has the same one.
pub fn slicer_name(preset: &SlicerPreset) -> String {
    let is_ours = ours().iter().any(|one| plain(one.name) == plain(preset.name));
    format!("{}{}", if is_ours { SLICER_PREFIX } else { "" }, preset.name)
}

/// Names of all presets: ours, then Slicer's.
pub fn names() -> impl Iterator<Item = String> {
    ours().iter().map(|preset| preset.name.to_owned()).chain(slicers().iter().map(slicer_name))
}

impl Look {
    /// The look of a preset whose values are absolute: those for CT in Hounsfield units, and 3D Slicer's.
    ///
    /// Case, and `-`, `_` or a blank between words, do not matter. Slicer's gradients are for samples of one unit.
    ///
    /// # Errors
    ///
    /// If there is no preset of that name, or it is fitted to the values of a volume: see [`Look::preset_over`].
    pub fn preset(name: &str) -> Result<Self> {
        Self::of_preset(name, None)
    }

    /// The look of a preset over the values of a volume, on the preset's [`Scale`](crate::scale::Scale).
    ///
    /// # Errors
    ///
    /// If there is no preset of that name, or the values do not grow.
    pub fn preset_over(name: &str, span: Span) -> Result<Self> {
        Self::of_preset(name, Some(span))
    }

    fn of_preset(name: &str, span: Option<Span>) -> Result<Self> {
        let wanted = plain(name);
        if let Some(preset) = ours().iter().find(|preset| plain(preset.name) == wanted) {
            return preset.look(span);
        }
        let bare = wanted.strip_prefix(SLICER_PREFIX).unwrap_or(&wanted);
        let Some(preset) = slicers().iter().find(|preset| plain(preset.name) == bare) else {
            let known = names().collect::<Vec<_>>().join(", ");
            return Err(Error::UnknownName { what: "preset", name: name.to_owned(), known });
        };
        Ok(Self { name: slicer_name(preset), ..preset.look(1.0)? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scale::Scale;

    const SPAN: Span = Span { low: 1.0, high: 100.0, longest_side: 50.0 };

    #[test]
    fn every_preset_makes_a_look_that_can_be_drawn() {
        for name in names() {
            let look = Look::preset_over(&name, SPAN).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(!look.reason.is_empty() && look.shading.is_none_or(|light| light.validate().is_ok()), "{name}");
        }
        assert_eq!(names().count(), 56);
    }

    #[test]
    fn spellings_of_a_name_are_alike() {
        let looks = ["ct-bone", " CT Bone", "ct__bone"].map(|name| Look::preset(name).unwrap());
        assert!(looks.iter().all(|look| *look == looks[0]));
        assert_eq!(looks[0].transfer_function.opacity_unit(), Some(1.0));
        assert_ne!(Look::preset("slicer-ct-bone").unwrap().transfer_function, looks[0].transfer_function);
        assert_eq!(Look::preset("Slicer CT AAA").unwrap().name, "CT-AAA");
    }

    #[test]
    fn relative_presets_need_a_span_and_unknown_names_are_refused() {
        let told = |found: Result<Look>| found.unwrap_err().to_string();
        assert!(told(Look::preset("mr-head")).contains("preset_over"));
        assert!(told(Look::preset("ct-bon")).contains("unknown preset \"ct-bon\"; use one of: ct-angio, ct-bone"));
        assert!(told(Look::preset_over("log", Span { low: 0.0, ..SPAN })).contains("growing"));
    }

    #[test]
    fn places_become_values() {
        let nodes = [[0.0, 0.0], [0.5, 0.2], [1.0, 1.0]];
        assert_eq!(Scale::Fraction.placed(&nodes, 10.0, 30.0), [[10.0, 0.0], [20.0, 0.2], [30.0, 1.0]]);
        assert_eq!(Scale::Fraction.widened(&nodes, 10.0, 30.0)[1], [10.0, 0.2]);
        let log = Scale::Log.placed(&nodes, 1.0, 100.0);
        assert_eq!((log.len(), log[0], log[64]), (65, [1.0, 0.0], [100.0, 1.0]));
        assert!((log[32][0] - 10.0).abs() < 1e-12 && (log[32][1] - 0.2).abs() < 1e-12);
    }
}
