//! Units of length that files name: our names of them, and their sizes.

/// Our name of a unit and its size in metres.
const METRES: [(&str, f64); 9] = [
    ("km", 1e3),
    ("m", 1.0),
    ("dm", 1e-1),
    ("cm", 1e-2),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("nm", 1e-9),
    ("angstrom", 1e-10),
    ("pm", 1e-12),
];

/// Other units: their name, size in metres, and the unit that lengths in them are converted to.
const FOREIGN: [(&str, f64, &str); 12] = [
    ("inch", 0.0254, "mm"),
    ("foot", 0.3048, "m"),
    ("yard", 0.9144, "m"),
    ("mile", 1609.344, "km"),
    ("thou", 2.54e-5, "um"),
    ("line", 0.0254 / 12.0, "mm"),
    ("point", 0.0254 / 72.0, "mm"),
    ("Mm", 1e6, "km"),
    ("hm", 1e2, "m"),
    ("dam", 1e1, "m"),
    ("fm", 1e-15, "pm"),
    ("bohr", 5.291_772_109_03e-11, "angstrom"),
];

/// Other names in files, in lower case, and our names.
const NAMES: [(&str, &str); 31] = [
    ("megameter", "Mm"),
    ("kilometer", "km"),
    ("hectometer", "hm"),
    ("decameter", "dam"),
    ("dekameter", "dam"),
    ("meter", "m"),
    ("decimeter", "dm"),
    ("centimeter", "cm"),
    ("millimeter", "mm"),
    ("micrometer", "um"),
    ("micron", "um"),
    ("\u{b5}m", "um"),  // the sign
    ("\u{3bc}m", "um"), // the Greek letter
    ("nanometer", "nm"),
    ("\u{e5}", "angstrom"),
    ("\u{e5}ngstr\u{f6}m", "angstrom"),
    ("ang", "angstrom"),
    ("picometer", "pm"),
    ("femtometer", "fm"),
    ("in", "inch"),
    ("inches", "inch"),
    ("\"", "inch"),
    ("ft", "foot"),
    ("feet", "foot"),
    ("yd", "yard"),
    ("mi", "mile"),
    ("mil", "thou"),
    ("li", "line"),
    ("pt", "point"),
    ("\\u00b5m", "um"), // as ImageJ writes what is not ASCII
    ("\\u03bcm", "um"),
];

/// Names in files that mean no unit.
const NONE: [&str; 12] = [
    "",
    "pixel",
    "pixels",
    "px",
    "voxel",
    "voxels",
    "unknown",
    "none",
    "null",
    "arbitrary",
    "reference frame",
    "index",
];

const LONGEST_NAME: usize = 24;

/// Our name of a unit that a file names ("Micrometers", "µm"); one that is unknown as it is; none where none is named.
pub(crate) fn canonical(text: &str) -> Option<String> {
    let name = text.trim().trim_matches('\0').trim();
    let folded = name.to_lowercase().replace("metre", "meter");
    if NONE.contains(&folded.as_str()) {
        return None;
    }
    // A capital M and P are mega and peta, small ones milli and pico.
    if name == "Mm" || name == "Pm" {
        return Some(name.to_owned());
    }
    let singular = if folded.chars().count() > 3 { folded.strip_suffix('s').unwrap_or(&folded) } else { &folded };
    let known = |wanted: &str| {
        let ours = METRES.iter().map(|unit| unit.0).chain(FOREIGN.iter().map(|unit| unit.0));
        let ours = ours.filter(|name| *name != "Mm").find(|name| *name == wanted);
        ours.or_else(|| NAMES.iter().find(|(name, _)| *name == wanted).map(|(_, ours)| *ours)).map(str::to_owned)
    };
    known(&folded).or_else(|| known(singular)).or_else(|| Some(name.chars().take(LONGEST_NAME).collect()))
}

fn metres(unit: &str) -> Option<f64> {
    let foreign = FOREIGN.iter().find(|(name, ..)| *name == unit).map(|(_, size, _)| *size);
    foreign.or_else(|| METRES.iter().find(|(name, _)| *name == unit).map(|(_, size)| *size))
}

/// One unit for axes x, y, z (the first that has a size), and the factors that bring each axis to it.
pub(crate) fn in_one_unit(units: &[Option<String>; 3]) -> (Option<String>, [f64; 3]) {
    let sized = |unit: &Option<String>| unit.as_deref().filter(|unit| metres(unit).is_some()).map(str::to_owned);
    let Some(first) = units.iter().find_map(sized) else {
        let mut named: Vec<_> = units.iter().flatten().collect();
        named.sort_unstable();
        named.dedup();
        return (if named.len() == 1 { Some(named[0].clone()) } else { None }, [1.0; 3]);
    };
    let foreign = FOREIGN.iter().find(|(name, ..)| *name == first).map(|(_, _, shown)| (*shown).to_owned());
    let common = foreign.unwrap_or_else(|| first.clone());
    let of_common = metres(&common).unwrap_or(1.0);
    let factors = [0, 1, 2].map(|a| {
        let own = sized(&units[a]).unwrap_or_else(|| first.clone());
        if own == common { 1.0 } else { twelve_digits(metres(&own).unwrap_or(of_common) / of_common) }
    });
    (Some(common), factors)
}

/// Sentences for unknown units of axes x, y, z, with what [`in_one_unit`] assumes.
pub(crate) fn guesses(units: &[Option<String>; 3]) -> Vec<String> {
    let (common, _) = in_one_unit(units);
    let mut strange: Vec<_> = units.iter().flatten().filter(|unit| metres(unit).is_none()).collect();
    strange.sort_unstable();
    strange.dedup();
    if strange.is_empty() || (strange.len() == 1 && common.as_ref() == Some(strange[0])) {
        return Vec::new(); // one unknown unit for all: its name is shown
    }
    let axes_of = |unit: &String| {
        let axes = ["x", "y", "z"].iter().zip(units).filter(|(_, own)| own.as_ref() == Some(unit));
        axes.map(|(axis, _)| *axis).collect::<Vec<_>>().join(", ")
    };
    let meant = common.map_or_else(|| "as their numbers are".to_owned(), |unit| format!("in {unit}"));
    let sentence = |unit: &&String| {
        format!("distances along {} {meant}: their unit in the file, '{unit}', is unknown", axes_of(unit))
    };
    strange.iter().map(sentence).collect()
}

/// A number rounded to twelve significant digits, so that 1e-3 / 1e-6 is 1000.
fn twelve_digits(number: f64) -> f64 {
    format!("{number:.11e}").parse().unwrap_or(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_units() {
        for (name, ours) in [
            ("Micrometers", Some("um")),
            ("millimetres", Some("mm")),
            ("\u{b5}m", Some("um")),
            ("inches", Some("inch")),
            ("Mm", Some("Mm")),
            ("MM", Some("mm")),
            ("pixels", None),
            ("", None),
            ("kpc", Some("kpc")),
        ] {
            assert_eq!(canonical(name).as_deref(), ours, "{name}");
        }
    }

    #[test]
    fn axes_in_one_unit() {
        let units = |names: [&str; 3]| names.map(canonical);
        assert_eq!(in_one_unit(&units(["mm", "mm", "um"])), (Some("mm".into()), [1.0, 1.0, 0.001]));
        assert_eq!(in_one_unit(&units(["inch", "mm", ""])), (Some("mm".into()), [25.4, 1.0, 25.4]));
        assert_eq!(in_one_unit(&units(["kpc", "kpc", "kpc"])), (Some("kpc".into()), [1.0; 3]));
        assert_eq!(guesses(&units(["mm", "kpc", "mm"])).len(), 1);
        assert!(guesses(&units(["kpc", "kpc", "kpc"])).is_empty());
    }
}
