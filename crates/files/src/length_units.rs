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
const NAMES: [(&str, &str); 29] = [
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

/// Longest name of a unit, in letters.
pub const LONGEST_NAME: usize = 24;

/// Escapes of `ImageJ` for letters that are not ASCII, and the letters.
const ESCAPES: [(&str, &str); 4] =
    [("\\u00B5", "\u{b5}"), ("\\u00b5", "\u{b5}"), ("\\u03BC", "\u{3bc}"), ("\\u00C5", "\u{c5}")];

/// Our name of a unit that a file names ("Micrometers", "µm"); one that is unknown as it is; none where none is named.
pub fn canonical(text: &str) -> Option<String> {
    let trimmed = trim(trim(text).trim_matches('\0'));
    let name = ESCAPES.iter().fold(trimmed.to_owned(), |name, (escape, letter)| name.replace(escape, letter));
    let folded = name.to_lowercase().replace("metre", "meter");
    if NONE.contains(&folded.as_str()) {
        return None;
    }
    // A capital M and P are mega and peta, small ones milli and pico.
    if name == "Mm" || name == "Pm" {
        return Some(name);
    }
    let singular = if folded.chars().count() > 3 { folded.strip_suffix('s').unwrap_or(&folded) } else { &folded };
    let known = |wanted: &str| {
        let ours = METRES.iter().map(|unit| unit.0).chain(FOREIGN.iter().map(|unit| unit.0));
        let ours = ours.filter(|name| *name != "Mm").find(|name| *name == wanted);
        ours.or_else(|| NAMES.iter().find(|(name, _)| *name == wanted).map(|(_, ours)| *ours)).map(str::to_owned)
    };
    known(&folded).or_else(|| known(singular)).or_else(|| Some(name.chars().take(LONGEST_NAME).collect()))
}

/// A text without white space at its ends, and without the separators of ASCII.
fn trim(text: &str) -> &str {
    text.trim_matches(|sign: char| sign.is_whitespace() || ('\x1c'..='\x1f').contains(&sign))
}

/// The size of a unit by our name, metres; none where it has none that we know.
pub fn metres(unit: &str) -> Option<f64> {
    let foreign = FOREIGN.iter().find(|(name, ..)| *name == unit).map(|(_, size, _)| *size);
    foreign.or_else(|| METRES.iter().find(|(name, _)| *name == unit).map(|(_, size)| *size))
}

/// The unit in which lengths in a unit are reported: another one for inch, megametre and their like.
pub fn reported(unit: &str) -> &str {
    FOREIGN.iter().find(|(name, ..)| *name == unit).map_or(unit, |(_, _, reported)| reported)
}

/// The factor from lengths in one unit to another; none if a named unit is unknown.
///
/// Where one of them names none, the lengths stay as they are.
pub fn factor(own: Option<&str>, wanted: Option<&str>) -> Option<f64> {
    match (own, wanted) {
        (Some(own), Some(wanted)) if own != wanted => Some(twelve_digits(metres(own)? / metres(wanted)?)),
        _ => Some(1.0),
    }
}

/// One unit for axes x, y, z (the first that has a size), and the factors that bring each axis to it.
///
/// An axis of an unknown unit keeps its numbers, which is a guess ([`guesses`]).
pub fn in_one_unit(units: &[Option<String>; 3]) -> (Option<String>, [f64; 3]) {
    let sized = units.each_ref().map(|unit| unit.as_deref().filter(|unit| metres(unit).is_some()));
    let Some(first) = sized.iter().flatten().next() else {
        let mut named = units.iter().flatten();
        let one = named.next().filter(|one| named.all(|other| other == *one));
        return (one.cloned(), [1.0; 3]);
    };
    let common = reported(first);
    let factors = sized.map(|unit| factor(unit.or(Some(first)), Some(common)).unwrap_or(1.0));
    (Some(common.to_owned()), factors)
}

/// A sentence for each unknown unit of axes x, y, z, with what [`in_one_unit`] assumes; axes without a unit aside.
pub fn guesses(units: &[Option<String>; 3]) -> Vec<String> {
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
    let meant = common.as_ref().map_or_else(|| "as their numbers are".to_owned(), |unit| format!("in {unit}"));
    let sentence = |unit: &&String| {
        format!("distances along {} {meant}: their unit in the file, {}, is unknown", axes_of(unit), quoted(unit))
    };
    strange.iter().map(sentence).collect()
}

/// A name in single quotes or, where it has one of these, in double ones, without control characters.
fn quoted(name: &str) -> String {
    let quote = if name.contains('\'') && !name.contains('"') { '"' } else { '\'' };
    let escaped = |sign: char| match sign {
        '\\' => "\\\\".to_owned(),
        _ if sign == quote => format!("\\{sign}"),
        _ if sign.is_control() => sign.escape_default().to_string(),
        _ => sign.to_string(),
    };
    format!("{quote}{}{quote}", name.chars().map(escaped).collect::<String>())
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
