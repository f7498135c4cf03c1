//! Named views: the sides from which data are seen.

use wavesplat_core::{Error, Result};

/// Name, azimuth and elevation, degrees, of the named views; the planes `xy`, `xz` and `yz` are those of data other
/// than bodies. Superior and inferior have the patient's front at the top; inferior is how radiologists look at an
/// axial slice.
pub const VIEWS: [(&str, f64, f64); 14] = [
    ("anterior", 0.0, 0.0),
    ("posterior", 180.0, 0.0),
    ("left", 90.0, 0.0),
    ("right", -90.0, 0.0),
    ("superior", 180.0, 90.0),
    ("inferior", 0.0, -90.0),
    ("front", 0.0, 0.0),
    ("back", 180.0, 0.0),
    ("top", 180.0, 90.0),
    ("bottom", 0.0, -90.0),
    ("xy", 180.0, -90.0),
    ("xz", 180.0, 180.0),
    ("yz", -90.0, 180.0),
    ("isometric", 150.0, 30.0),
];

/// Azimuth and elevation, degrees, of a named view. `is_anatomical`: the axes of the world are a patient's (RAS), whose
/// planes are shown as radiologists read them.
///
/// # Errors
///
/// [`Error::UnknownName`] if there is no view of that name.
pub fn view_angles(name: &str, is_anatomical: bool) -> Result<(f64, f64)> {
    let own = match name {
        "xy" if is_anatomical => "inferior",
        "xz" if is_anatomical => "anterior",
        "yz" if is_anatomical => "left",
        _ => name,
    };
    let found = VIEWS.iter().find(|(known, ..)| *known == own);
    found.map(|&(_, azimuth, elevation)| (azimuth, elevation)).ok_or_else(|| {
        let known = VIEWS.map(|(known, ..)| known).join(", ");
        Error::UnknownName { what: "view", name: name.to_owned(), known }
    })
}

/// Azimuth and elevation, degrees, of a view that there is.
pub(crate) fn known_angles(name: &'static str, is_anatomical: bool) -> (f64, f64) {
    view_angles(name, is_anatomical).expect("a name in VIEWS")
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::rotation::orbit_axes;

    #[test]
    fn views_look_from_the_side_that_they_name() {
        let expected = [
            ("anterior", DVec3::Y, DVec3::Z),
            ("posterior", DVec3::NEG_Y, DVec3::Z),
            ("left", DVec3::NEG_X, DVec3::Z),
            ("right", DVec3::X, DVec3::Z),
            ("superior", DVec3::Z, DVec3::Y),
            ("inferior", DVec3::NEG_Z, DVec3::Y),
        ];
        for (name, back, up) in expected {
            let (azimuth, elevation) = view_angles(name, true).unwrap();
            let axes = orbit_axes(azimuth, elevation);
            assert_eq!((axes.back, axes.up), (back, up), "{name}");
        }
    }

    #[test]
    fn planes_of_arrays_have_their_first_axis_to_the_right_and_their_second_downwards() {
        for (name, right, down) in [("xy", DVec3::X, DVec3::Y), ("xz", DVec3::X, DVec3::Z), ("yz", DVec3::Y, DVec3::Z)]
        {
            let (azimuth, elevation) = view_angles(name, false).unwrap();
            let axes = orbit_axes(azimuth, elevation);
            assert_eq!((axes.right, axes.up), (right, -down), "{name}");
        }
        assert_eq!(view_angles("xy", true), view_angles("inferior", false));
    }

    #[test]
    fn an_unknown_name_is_told_the_known_ones() {
        let message = view_angles("behind", false).unwrap_err().to_string();
        assert!(message.starts_with("unknown view \"behind\"; use one of: anterior, posterior"), "{message}");
    }
}
