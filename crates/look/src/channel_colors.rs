//! The usual colour of a microscope's channel: from the file, else by its emission wavelength or its dye.
//!
//! White is what writers put where they know no colour, so that several channels that are all white have none.
//! Dyes and proteins are known by their names; of names with a number, such as "Alexa 568" or "488 nm", the number is the
//! line that excites, whose light is about 30 nm longer.

use crate::colors::Rgb;
use crate::texts::is_blank;

/// Conventional colours of channels without a colour, and of unknown light: green, magenta, cyan, yellow, red, blue,
/// white, orange.
pub const CHANNEL_COLORS: [Rgb; 8] = [
    [0.0, 1.0, 0.0],
    [1.0, 0.0, 1.0],
    [0.0, 1.0, 1.0],
    [1.0, 1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 0.0, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, 0.65, 0.0],
];
/// Lighter ones for pictures in space, in the same order.
pub const CHANNEL_COLORS_IN_SPACE: [Rgb; 8] = [
    [0.35, 1.0, 0.45],
    [1.0, 0.35, 0.95],
    [0.3, 0.9, 1.0],
    [1.0, 0.9, 0.3],
    [1.0, 0.35, 0.3],
    [0.35, 0.5, 1.0],
    [1.0, 1.0, 1.0],
    [1.0, 0.6, 0.25],
];
/// Longest wavelength of the light, nanometres, and its usual colour: blue, cyan, green, yellow, orange, red; longer ones
/// are far red.
const COLORS_OF_LIGHT: [(f64, Rgb); 6] = [
    (470.0, [0.0, 0.0, 1.0]),
    (495.0, [0.0, 1.0, 1.0]),
    (545.0, [0.0, 1.0, 0.0]),
    (565.0, [1.0, 1.0, 0.0]),
    (590.0, [1.0, 0.5, 0.0]),
    (640.0, [1.0, 0.2, 0.0]),
];
/// Magenta, since the eye hardly sees far red.
const FAR_RED: Rgb = [1.0, 0.0, 1.0];
const WHITE: Rgb = [1.0, 1.0, 1.0];
/// Wavelengths that detectors of microscopes see, nanometres.
const LIGHT_NM: std::ops::RangeInclusive<f64> = 300.0..=1000.0;
/// Dyes and fluorescent proteins by the peak of their light, nanometres (`FPbase`, and the makers' data sheets).
const DYES: [(f64, &[&str]); 7] = [
    (460.0, &["dapi", "hoechst", "bfp", "tagbfp"]),
    (480.0, &["cfp", "cerulean", "turquoise", "tfp"]),
    (512.0, &["gfp", "fitc", "fluorescein", "neongreen", "clover", "staygold", "gcamp", "cy2", "calcein"]),
    (550.0, &["yfp", "venus", "citrine"]),
    (580.0, &["cy3", "tritc", "rhodamine", "tamra", "tomato", "dsred", "rfp", "tagrfp", "orange", "dii"]),
    (610.0, &["cherry", "scarlet", "ruby", "texasred", "txred", "jred", "rcamp", "propidium"]),
    (670.0, &["cy5", "cy7", "sir", "draq5", "plum", "irfp", "farred"]),
];
/// Nothing, and prefixes of the names in [`DYES`]: monomeric, enhanced, superfolder, tandem dimer and others.
const BEFORE_DYES: [&str; 9] = ["", "em", "me", "sf", "td", "d", "e", "j", "m"];
/// Names of channels of transmitted light.
const TRANSMITTED: [&str; 9] =
    ["brightfield", "bf", "dic", "phase", "transmitted", "tl", "esid", "tpmt", "phasecontrast"];
/// Names of colours: Leica's files name channels after their look-up tables.
const NAMES_OF_COLORS: [(&str, Rgb); 9] = [
    ("blue", [0.0, 0.0, 1.0]),
    ("cyan", [0.0, 1.0, 1.0]),
    ("green", [0.0, 1.0, 0.0]),
    ("yellow", [1.0, 1.0, 0.0]),
    ("red", [1.0, 0.0, 0.0]),
    ("magenta", [1.0, 0.0, 1.0]),
    ("gray", WHITE),
    ("grey", WHITE),
    ("white", WHITE),
];
/// Excitation lines, by which dyes are numbered, nanometres.
const LINES: [u32; 59] = [
    350, 355, 365, 375, 385, 395, 405, 430, 440, 445, 450, 458, 470, 473, 475, 476, 477, 480, 485, 488, 490, 491, 505,
    514, 515, 532, 543, 546, 549, 550, 552, 555, 560, 561, 565, 568, 590, 594, 610, 620, 630, 633, 635, 637, 638, 640,
    642, 646, 647, 649, 650, 660, 680, 700, 730, 740, 750, 785, 790,
];
/// Lines whose number always means a dye or a laser, as in "actin 568".
const COMMON_LINES: [u32; 12] = [405, 488, 514, 532, 546, 555, 561, 568, 594, 633, 640, 647];
/// Stokes shift from a line to the emission of its dye, nanometres.
const STOKES_NM: f64 = 30.0;
/// Words that stand beside the number of a dye or of a wavelength; others make it a number of something else.
const BESIDE_NUMBERS: [&str; 36] = [
    "a",
    "abberior",
    "af",
    "alexa",
    "alexafluor",
    "atto",
    "bodipy",
    "c",
    "cam",
    "camera",
    "cf",
    "ch",
    "channel",
    "confocal",
    "dylight",
    "em",
    "emission",
    "ex",
    "excitation",
    "fluor",
    "janelia",
    "jf",
    "laser",
    "led",
    "lp",
    "nm",
    "phalloidin",
    "plus",
    "sim",
    "star",
    "sted",
    "t",
    "tirf",
    "track",
    "widefield",
    "wf",
];
/// Colours that differ by less in every share count as the same.
const SAME_COLOR: f64 = 0.1;

/// A channel as a file describes it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ChannelFacts<'a> {
    /// Its name, "" where there is none.
    pub name: &'a str,
    /// The colour that the file gives it.
    pub color: Option<Rgb>,
    /// Peak of its light, nanometres.
    pub emission_nm: Option<f64>,
}

/// The colour of a channel among all of its file: the file's, else the usual one of its light; `None` without either.
///
/// White beside other colours was chosen by somebody, and so was the white of a single channel.
pub fn color_of(channel: &ChannelFacts<'_>, channels: &[ChannelFacts<'_>]) -> Option<Rgb> {
    let mut n_given = 0;
    let mut are_white = true;
    for color in channels.iter().filter_map(|one| one.color) {
        n_given += 1;
        are_white &= is_same_color(color, WHITE);
    }
    channel.color.filter(|_| n_given < 2 || !are_white).or_else(|| usual_color(channel))
}

/// The colour of a channel's light, by its wavelength, else by the name of its dye, or of a colour; else `None`.
pub fn usual_color(channel: &ChannelFacts<'_>) -> Option<Rgb> {
    let name = channel.name.to_lowercase();
    let Some(wavelength) = channel.emission_nm.or_else(|| wavelength_of(&name)) else {
        if words(&name).iter().any(|word| TRANSMITTED.contains(&word.as_str())) {
            return Some(WHITE);
        }
        let bare = name.trim_matches(is_blank);
        return NAMES_OF_COLORS.iter().find(|(known, _)| *known == bare).map(|&(_, color)| color);
    };
    let of_light = || COLORS_OF_LIGHT.iter().find(|(longest, _)| wavelength < *longest).map_or(FAR_RED, |&(_, c)| c);
    LIGHT_NM.contains(&wavelength).then(of_light)
}

/// A colour for each channel: the wanted one, else its own if no other channel has it, else a conventional one.
///
/// Own colours are given before the others, so that none is taken by a channel that has none.
pub fn distinct_colors(wanted: &[Option<Rgb>], own: &[Option<Rgb>]) -> Vec<Rgb> {
    let mut found = wanted.to_vec();
    let is_taken = |color: Rgb, found: &[Option<Rgb>]| found.iter().flatten().any(|&other| is_same_color(color, other));
    for (k, &color) in own.iter().enumerate() {
        if let (None, Some(color)) = (found[k], color)
            && !is_taken(color, &found)
        {
            found[k] = Some(color);
        }
    }
    for k in 0..found.len() {
        if found[k].is_none() {
            let free = CHANNEL_COLORS.into_iter().find(|&one| !is_taken(one, &found));
            found[k] = Some(free.unwrap_or(CHANNEL_COLORS[k % CHANNEL_COLORS.len()]));
        }
    }
    found.into_iter().flatten().collect()
}

/// Whether two colours look the same.
fn is_same_color(color: Rgb, other: Rgb) -> bool {
    color.iter().zip(other).all(|(a, b)| (a - b).abs() < SAME_COLOR)
}

/// Runs of small letters, each with the number behind it, and where `has_numbers` runs of digits too.
fn runs(name: &str, has_numbers: bool, joins_numbers: bool) -> Vec<&str> {
    let bytes = name.as_bytes();
    let end_of = |from: usize, is_in: fn(&u8) -> bool| from + bytes[from..].iter().take_while(|b| is_in(b)).count();
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let letters = end_of(at, u8::is_ascii_lowercase);
        let end = if letters > at && !joins_numbers { letters } else { end_of(letters, u8::is_ascii_digit) };
        if letters > at || (end > at && has_numbers) {
            found.push(&name[at..end]);
        }
        at = end.max(at + 1);
    }
    found
}

/// Words of a name in small letters, also without the number at their ends, and each two that stand side by side.
fn words(name: &str) -> Vec<String> {
    let words = runs(name, false, true);
    let bare = words.iter().map(|word| word.trim_end_matches(|c: char| c.is_ascii_digit()).to_owned());
    let mut found: Vec<String> = words.iter().map(|&word| word.to_owned()).chain(bare).collect();
    found.extend(runs(name, true, true).windows(2).map(<[&str]>::concat));
    found
}

/// The emission wavelength of the dye that a name in small letters contains, in nanometres; `None` if it contains no dye.
fn wavelength_of(name: &str) -> Option<f64> {
    let peak = |dye: &str| DYES.iter().find(|(_, names)| names.contains(&dye)).map(|&(peak, _)| peak);
    for word in words(name) {
        let found = BEFORE_DYES.iter().find_map(|before| peak(word.strip_prefix(before)?));
        if found.is_some() {
            return found;
        }
    }
    let parts = runs(name, true, false);
    let number_of = |part: &str| part.parse::<u32>().ok();
    let is_number = |part: &str| part.as_bytes()[0].is_ascii_digit();
    let is_alone = parts.iter().all(|part| is_number(part) || BESIDE_NUMBERS.contains(part));
    for number in parts.iter().filter(|part| is_number(part) && part.len() == 3).filter_map(|part| number_of(part)) {
        if COMMON_LINES.contains(&number) || (is_alone && LINES.contains(&number)) {
            return Some(f64::from(number) + STOKES_NM);
        }
        if is_alone && LIGHT_NM.contains(&f64::from(number)) {
            return Some(f64::from(number));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(name: &str) -> Option<Rgb> {
        usual_color(&ChannelFacts { name, ..ChannelFacts::default() })
    }

    #[test]
    fn names_of_dyes_and_lines_have_the_colour_of_their_light() {
        let cases = [("DAPI", 0), ("mEGFP", 2), ("Alexa Fluor 568", 5), ("tdTomato", 4), ("actin 488 nm", 2)];
        for (name, place) in cases {
            assert_eq!(named(name), Some(COLORS_OF_LIGHT[place].1), "{name}");
        }
        assert_eq!(named("Cy5"), Some(FAR_RED));
        assert_eq!(named("T-PMT"), Some(WHITE));
        assert_eq!([named("plate 350"), named(""), named("42")], [None; 3]);
    }

    #[test]
    fn channels_that_are_all_white_have_the_colour_of_their_light() {
        let white = Some(WHITE);
        let both = ["DAPI", "GFP"].map(|name| ChannelFacts { name, color: white, emission_nm: None });
        assert_eq!(color_of(&both[0], &both), Some([0.0, 0.0, 1.0]));
        assert_eq!(color_of(&both[0], &both[..1]), white);
    }

    #[test]
    fn no_two_of_eight_channels_have_one_colour() {
        let own = [Some([0.0, 0.98, 0.0]), None, Some([0.0, 1.0, 0.05])];
        let found = distinct_colors(&[None; 3], &own);
        assert_eq!(found, [[0.0, 0.98, 0.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0]]);
    }
}
